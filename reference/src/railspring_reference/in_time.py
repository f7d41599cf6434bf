"""A load case in time: the wheel, free along y and z, on the rail between its ends.

The bodies go by :mod:`.dynamics`. The contact is found anew at the end of every step where the deformed surfaces then
are (:mod:`.moving_surfaces`), by Newton's method over the displacements; its forces fulfil Signorini's and Coulomb's
conditions (:mod:`.coulomb`), with slips counted from step to step.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .body import Floats, Ints
from .coulomb import contact_forces
from .dynamics import Motion, Moving
from .iteration import BeyondCandidates, NotConverged
from .moving_surfaces import Facing, Pairs

MARGIN = 20e-6
"""Mean gap up to which a node may come to carry load in a look at the surfaces, m."""
LOOKS = 25
"""Most looks at the surfaces in a step."""
LOOK_END = 1e-9
"""Change of the displacements that ends them, m: a hundred-thousandth of the approach of a loaded wheel."""

Bodies = tuple[Moving, Moving]
"""Wheel and rail."""


@dataclass(frozen=True)
class Harmonic:
    """A force ``mean + amplitude * sin(2 pi frequency t + phase)``, N."""

    mean: float
    amplitude: float
    frequency: float
    phase: float

    def at(self, t: float) -> float:
        """Value at a time, s."""
        return self.mean + self.amplitude * float(np.sin(2.0 * np.pi * self.frequency * t + self.phase))


@dataclass(frozen=True)
class Case:
    """What happens to the wheel."""

    steps: int
    time_step: float
    friction: float
    gravity: float
    vertical: Harmonic
    """On the suspended mass."""
    lateral: Harmonic
    """On the hub, positive to the field side."""


@dataclass(frozen=True)
class Row:
    """The end of a time step."""

    time: float
    vertical: float
    """Force of the wheel on the rail, positive down, N."""
    lateral: float
    """The same, positive to the field side, N."""
    hub: tuple[float, float]
    """Displacement of the hub along y and z, m."""


@dataclass(frozen=True)
class Contact:
    """The contact at the end of a step."""

    forces: Floats
    """On the nodes of the rail's grid: normal, across and along, 3 x nodes, N."""
    nodal: tuple[Floats, Floats]
    """On the degrees of freedom of both surfaces, N."""

    @property
    def on_wheel(self) -> Floats:
        """Resultant on the wheel, N."""
        return self.nodal[0].reshape(-1, 3).sum(axis=0)


def run(bodies: Bodies, facing: Facing, case: Case, inner: int, progress: Callable[[int], None]) -> list[Row]:
    """The load case from just touching and at rest, each time step of ``inner`` steps of the bodies."""
    wheel, rail = bodies
    y, z, _ = wheel.hub
    loads = (_on_wheel(wheel, case, 0.0), np.zeros(rail.unknowns))
    rest = Motion.at_rest
    motions = (Motion(*(np.zeros(wheel.unknowns) for _ in range(2)), wheel.accelerated(loads[0])), rest(rail.unknowns))
    contact = Contact(np.zeros((3, len(facing.rail.nodes))), (np.zeros(0), np.zeros(0)))
    rows = [Row(0.0, 0.0, 0.0, (0.0, 0.0))]
    for step in range(1, case.steps * inner + 1):
        t = step * case.time_step / inner
        later = (_on_wheel(wheel, case, t), loads[1])
        free = tuple(b.free(m, ends) for b, m, ends in zip(bodies, motions, zip(loads, later), strict=True))
        contact = _contact(bodies, facing, case.friction, (motions, free), contact, t)
        motions = tuple(
            body.scheme.later(motion, body.under(u, nodal))
            for body, motion, u, nodal in zip(bodies, motions, free, contact.nodal, strict=True)
        )
        loads = later
        if step % inner == 0:
            force, at = contact.on_wheel, motions[0].displacement
            rows.append(Row(t, float(-force[2]), float(-force[1]), (float(at[y]), float(at[z]))))
            progress(step // inner)
    return rows


def _on_wheel(wheel: Moving, case: Case, t: float) -> Floats:
    """Given forces on all unknowns of the wheel."""
    y, _, top = wheel.hub
    forces = wheel.weight(case.gravity)
    forces[y] += case.lateral.at(t)
    forces[top] += case.vertical.at(t)
    return forces


def _contact(
    bodies: Bodies,
    facing: Facing,
    friction: float,
    step: tuple[tuple[Motion, Motion], tuple[Floats, Floats]],
    last: Contact,
    t: float,
) -> Contact:
    """The contact at the end of a ``step``: motions at its beginning, displacements at its end without contact."""
    before = [body.on_surface @ motion.displacement for body, motion in zip(bodies, step[0], strict=True)]
    free = [body.on_surface @ u for body, u in zip(bodies, step[1], strict=True)]
    now, contact = free, last
    for _ in range(LOOKS):
        loaded = np.flatnonzero(contact.forces[0] > 0.0)
        pairs = facing.pairs(now[0].reshape(-1, 3), now[1].reshape(-1, 3), MARGIN, loaded)
        forces = _forces(pairs, bodies, friction, (now, free, before), contact.forces)
        if ((forces[0] > 0.0) & pairs.at_edge).any():
            raise BeyondCandidates(f"the contact reaches the end of the meshed surfaces at {1e3 * t:.4g} ms")
        nodal = (pairs.motion[0].T @ forces.ravel(), -(pairs.motion[1].T @ forces.ravel()))
        then = [u + body.flexibility @ f for body, u, f in zip(bodies, free, nodal, strict=True)]
        change = max(float(np.abs(a - b).max()) for a, b in zip(then, now, strict=True))
        everywhere = np.zeros_like(contact.forces)
        everywhere[:, pairs.nodes] = forces
        now, contact = then, Contact(everywhere, nodal)
        if change < LOOK_END:
            return contact
    raise NotConverged(f"places of the contact at {1e3 * t:.4g} ms", LOOKS, change, LOOK_END, "m", len(pairs.nodes))


def _forces(
    pairs: Pairs, bodies: Bodies, friction: float, displacements: tuple[list[Floats], ...], start: Floats
) -> Floats:
    """Forces of the pairs, 3 x pairs, with gaps that are linear in the displacements from ``now`` on."""
    now, free, before = displacements
    n = len(pairs.nodes)
    if n == 0:
        return np.zeros((3, 0))

    def moved(to: list[Floats], since: list[Floats]) -> Floats:
        wheel, rail = pairs.motion
        return wheel @ (to[0] - since[0]) - rail @ (to[1] - since[1])

    gap = pairs.gap + moved(free, now)[:n]
    slip = moved(free, before)[n:]
    compliance = sum(m @ (body.flexibility @ m.T.toarray()) for m, body in zip(pairs.motion, bodies, strict=True))
    forces = contact_forces(compliance, np.concatenate([gap, slip]), friction, start[:, pairs.nodes].ravel())
    return forces.reshape(3, n)
