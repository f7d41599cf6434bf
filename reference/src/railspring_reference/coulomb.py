"""Signorini's and Coulomb's conditions at the end of a time step.

Node by node, each against the forces of the others, in sweeps until all rest: non-smooth contact dynamics (M. Jean,
"The non-smooth contact dynamics method", Comput. Methods Appl. Mech. Eng. 177 (1999)).
"""

import numpy as np

from .body import Floats
from .iteration import NotConverged

SWEEPS = 20_000
"""Most sweeps over all nodes."""
SWEEPS_END = 1e-10
"""Change of a force in a sweep that ends them, in the largest normal force."""


def contact_forces(compliance: Floats, free: Floats, friction: float, start: Floats) -> Floats:
    """Forces, N, normal, across and along, one direction of all nodes after the other.

    ``compliance``: relative displacements per force, m/N. ``free``: gaps and slips without forces, m. ``start``: forces to
    begin with.
    """
    count = len(free) // 3
    forces = start.copy()
    forces[:count] = np.maximum(forces[:count], 0.0)
    own = np.diag(compliance)
    # no less than the larger eigenvalue of the two tangential directions, so that no sweep overshoots
    slopes = [max(own[i], own[k]) + abs(compliance[i, k]) for i, k in _tangential(count)]
    change = np.inf
    for _ in range(SWEEPS):
        change = 0.0
        for node, (i, k) in enumerate(_tangential(count)):
            was = forces[node]
            normal = max(0.0, was - (compliance[node] @ forces + free[node]) / own[node])
            forces[node] = normal
            change = max(change, abs(normal - was))
            bound = friction * normal
            if bound == 0.0:
                across = along = 0.0
            else:
                across = forces[i] - (compliance[i] @ forces + free[i]) / slopes[node]
                along = forces[k] - (compliance[k] @ forces + free[k]) / slopes[node]
                size = np.hypot(across, along)
                if size > bound:
                    across, along = across * bound / size, along * bound / size
            change = max(change, abs(across - forces[i]), abs(along - forces[k]))
            forces[i], forces[k] = across, along
        if change <= SWEEPS_END * forces[:count].max(initial=0.0):
            return forces
    raise NotConverged("contact forces", SWEEPS, change, SWEEPS_END, "N", count)


def _tangential(count: int) -> list[tuple[int, int]]:
    """Places of the tangential forces of every node."""
    return [(count + node, 2 * count + node) for node in range(count)]
