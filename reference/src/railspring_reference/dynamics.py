"""An elastic body in time, by the generalised-alpha method.

J. Chung, G.M. Hulbert, "A time integration algorithm for structural dynamics with improved numerical dissipation: the
generalized-alpha method", J. Appl. Mech. 60 (1993). All nodes have their mass, those of the contact too; what they
would ring with from step to step is damped by the method.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import skfem

from .body import COLUMNS_AT_ONCE, Body, Floats, Ints
from .factor import factored

AT_INFINITY = 0.5
"""What a step leaves of a motion that it does not resolve."""


@dataclass(frozen=True)
class Motion:
    """Displacement, velocity and acceleration of all unknowns."""

    displacement: Floats
    velocity: Floats
    acceleration: Floats

    @classmethod
    def at_rest(cls, unknowns: int) -> "Motion":
        """No motion."""
        return cls(*(np.zeros(unknowns) for _ in range(3)))


class Scheme:
    """The method with a step of the length ``step``, s."""

    def __init__(self, step: float) -> None:
        rho = AT_INFINITY
        self.step = step
        self.of_inertia = (2.0 * rho - 1.0) / (rho + 1.0)
        """Share of the beginning of a step in the inertia."""
        self.of_forces = rho / (rho + 1.0)
        """Share of the beginning in all other forces."""
        shift = self.of_forces - self.of_inertia
        self.gamma = 0.5 + shift
        self.beta = 0.25 * (1.0 + shift) ** 2

    def matrix(self, mass: sp.spmatrix, damping: sp.spmatrix, stiffness: sp.spmatrix) -> sp.csc_matrix:
        """Forces at the end of a step per displacement there."""
        end = 1.0 - self.of_forces
        inertia = (1.0 - self.of_inertia) / (self.beta * self.step**2)
        return (inertia * mass + end * self.gamma / (self.beta * self.step) * damping + end * stiffness).tocsc()

    def carried(self, m: Motion) -> tuple[Floats, Floats, Floats]:
        """What mass, damping and stiffness are multiplied by for the forces that a step begins with."""
        h, beta, gamma, end = self.step, self.beta, self.gamma, 1.0 - self.of_forces
        inertia = (m.displacement + h * m.velocity) / (beta * h**2) + (0.5 / beta - 1.0) * m.acceleration
        speed = gamma / (beta * h) * m.displacement - (1.0 - gamma / beta) * m.velocity
        speed -= h * (1.0 - 0.5 * gamma / beta) * m.acceleration
        return (
            (1.0 - self.of_inertia) * inertia - self.of_inertia * m.acceleration,
            end * speed - self.of_forces * m.velocity,
            -self.of_forces * m.displacement,
        )

    def later(self, before: Motion, displacement: Floats) -> Motion:
        """The motion at the end of a step, from its displacement there."""
        h, beta, gamma = self.step, self.beta, self.gamma
        moved = displacement - before.displacement
        acceleration = (moved - h * before.velocity) / (beta * h**2) - (0.5 / beta - 1.0) * before.acceleration
        velocity = before.velocity + h * ((1.0 - gamma) * before.acceleration + gamma * acceleration)
        return Motion(displacement, velocity, acceleration)


@dataclass(frozen=True)
class Suspended:
    """A mass on a vertical spring and damper over the hub; kg, N/m, N s/m."""

    mass: float
    stiffness: float
    damping: float


class Moving:
    """A body in time, with the displacements of some surface nodes under forces on them.

    ``density`` by material, kg/m3; ``damping``: forces of damping over those of elasticity per rate, s. Held nodes stay;
    with something ``suspended`` they follow a hub instead: its motions along y and z, and that of the mass on its
    suspension, are the last three unknowns.
    """

    def __init__(
        self, body: Body, density: Floats, damping: float, surface: Ints, step: float, suspended: Suspended | None
    ) -> None:
        self.scheme = Scheme(step)
        self._axes = body.free % 3
        reduction = _reduction(body, suspended is not None)
        mass = reduction.T @ _mass(body, density) @ reduction
        stiffness = reduction.T @ body.stiffness @ reduction
        viscous = damping * stiffness
        if suspended is not None:
            spring = np.array([[1.0, -1.0], [-1.0, 1.0]])
            mass = _with_last(mass, np.diag([0.0, suspended.mass]))
            stiffness = _with_last(stiffness, suspended.stiffness * spring)
            viscous = _with_last(viscous, suspended.damping * spring)
        self._mass, self._damping, self._stiffness = mass.tocsr(), viscous.tocsr(), stiffness.tocsr()
        self._solve: Callable[[Floats], Floats] = factored(self.scheme.matrix(mass, viscous, stiffness))
        rows = reduction.tocsr()[(3 * surface[:, None] + np.arange(3)).ravel()]
        rows.resize(rows.shape[0], self.unknowns)
        self.on_surface: sp.csr_matrix = rows
        """Displacements of the surface nodes from those of all unknowns."""
        self._under_unit_forces = self._columns()
        self.flexibility: Floats = self.on_surface @ self._under_unit_forces
        """Displacements of the surface nodes at the end of a step per force on them, m/N."""

    @property
    def unknowns(self) -> int:
        """Number of all unknowns."""
        return self._mass.shape[0]

    @property
    def hub(self) -> tuple[int, int, int]:
        """Unknowns of the hub along y and z, and of the suspended mass, of a body that has them."""
        return self.unknowns - 3, self.unknowns - 2, self.unknowns - 1

    def uniform(self, axis: int) -> Floats:
        """The whole body with its hub, without what is suspended, moved by one along y (1) or z (2)."""
        return np.append(self._axes == axis, [axis == 1, axis == 2, False]).astype(float)

    @property
    def mass(self) -> float:
        """Mass of a body with a hub, kg; without what is suspended."""
        body = self.uniform(2)
        return float(body @ (self._mass @ body))

    def weight(self, gravity: float) -> Floats:
        """Forces of an acceleration downwards (m/s2) on the body and on what is suspended, N."""
        down = self.uniform(2)
        down[-1] = 1.0
        return gravity * (self._mass @ down)

    def accelerated(self, forces: Floats) -> Floats:
        """Accelerations of the rigid body and of the suspended mass under forces on hub and suspended mass, m/s2."""
        y, z, top = self.hub
        acceleration = (forces[y] * self.uniform(1) + forces[z] * self.uniform(2)) / self.mass
        if self._mass[top, top] > 0.0:
            acceleration[top] = forces[top] / self._mass[top, top]
        return acceleration

    def free(self, before: Motion, forces: tuple[Floats, Floats]) -> Floats:
        """Displacements at the end of a step under given forces at its beginning and end, without those of the contact."""
        inertia, speed, moved = self.scheme.carried(before)
        start, end = forces
        share = self.scheme.of_forces
        carried = self._mass @ inertia + self._damping @ speed + self._stiffness @ moved
        return self._solve(carried + (1.0 - share) * end + share * start)

    def under(self, free: Floats, nodal: Floats) -> Floats:
        """Displacements at the end of a step with forces on the surface nodes."""
        acting = np.flatnonzero(nodal)
        return free + self._under_unit_forces[:, acting] @ nodal[acting]

    def _columns(self) -> Floats:
        loads = self.on_surface.T.tocsc()
        chunks = range(0, loads.shape[1], COLUMNS_AT_ONCE)
        return np.hstack([self._solve(loads[:, first : first + COLUMNS_AT_ONCE].toarray()) for first in chunks])


def _mass(body: Body, density: Floats) -> sp.csr_matrix:
    """The mass of all degrees of freedom; ``density`` by material, kg/m3."""
    at_points = np.broadcast_to(density[body.groups][:, None], body.basis.dx.shape)
    scalar = skfem.BilinearForm(lambda u, v, w: w.density * u * v).assemble(body.basis, density=at_points)
    return sp.kron(scalar, sp.eye(3), format="csr")


def _reduction(body: Body, follows: bool) -> sp.csr_matrix:
    """Degrees of freedom from the free ones, and from the motions along y and z of the hub that the others follow."""
    rows, columns = [body.free], [np.arange(len(body.free))]
    count = len(body.free)
    if follows:
        for axis in (1, 2):
            rows.append(body.nodal_dofs[axis, body.held])
            columns.append(np.full(len(body.held), count))
            count += 1
    entries = (np.ones(sum(map(len, rows))), (np.concatenate(rows), np.concatenate(columns)))
    return sp.csr_matrix(entries, shape=(body.degrees_of_freedom, count))


def _with_last(matrix: sp.spmatrix, corner: Floats) -> sp.csr_matrix:
    """The matrix with one more unknown, and a matrix added to its last two."""
    size = matrix.shape[0] + 1
    last = np.arange(size - 2, size)
    larger = matrix.tocsr().copy()
    larger.resize(size, size)
    return larger + sp.csr_matrix((corner.ravel(), (np.repeat(last, 2), np.tile(last, 2))), shape=(size, size))
