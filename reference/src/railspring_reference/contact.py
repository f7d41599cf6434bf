"""The wheel pressed on the rail: mortar contact as a quadratic programme.

Normal forces: at a given lowering of the hub they minimise the complementary
energy under non-negativity; its Cholesky form is a non-negative least-squares
problem (C.L. Lawson, R.J. Hanson, "Solving Least Squares Problems", 1974).
The lowering is the root of the load balance. Friction: tangential forces
minimise the same energy on discs of radius mu times normal force, by
accelerated projected gradients (A. Beck, M. Teboulle, SIAM J. Imaging Sci. 2
(2009)); normal and tangential problems alternate until both rest.
"""

import copy
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray
from scipy.optimize import brentq, nnls

from .body import Body, Floats, Ints
from .exchange import Side
from .iteration import BeyondCandidates, NotConverged
from .surface import Graph, bilinear, functionals, rail_gap, shape_rows, wheel_points

Flags = NDArray[np.bool_]
Progress = Callable[[str, int, int], None]
Carrier = Literal["rail", "wheel"]

STEP_FOR_TANGENT = 1e-3
"""Relative load step of the tangent."""
NNLS_ROUNDS = 100
"""Most rounds of the non-negative least squares for every multiplier."""
ALTERNATIONS = 200
"""Most alternations of normal and tangential forces."""
ALTERNATION_END = 1e-7
"""Change of a tangential force that ends them, in the largest normal force."""
PROJECTIONS = 20000
"""Most projected gradients of the tangential forces."""
PROJECTION_END = 1e-11
"""Change of a tangential force that ends them, in the largest bound of friction."""


@dataclass(frozen=True)
class State:
    """Equilibrium under one load."""

    load: float
    lowering: float
    """Vertical displacement of the hub from just touching, m."""
    normal: Floats
    """Normal forces of the multipliers, N."""
    tangential: Floats
    """Tangential forces, one row a multiplier, N."""
    slip: Floats
    """Total tangential separation, one row a multiplier, m."""


class Contact:
    """A wheel above a rail, condensed to the multipliers.

    ``carrier``: the body whose surface nodes carry the multipliers. ``reach``: its nodes with a smaller vertical
    gap when the bodies just touch are candidates, m. ``tangential``: whether friction will be asked for.
    """

    def __init__(
        self,
        wheel: Body,
        rail: Body,
        sides: tuple[Side, Side],
        tangential: bool,
        reach: float,
        progress: Progress,
        carrier: Carrier = "rail",
    ) -> None:
        wheel_side, rail_side = sides
        self.friction = 0.0
        around = self._touch(wheel, wheel_side, rail_side)
        self.wheel_curve = Graph(wheel_side.curve, around)
        self.rail_curve = Graph(rail_side.curve, around + wheel_side.origin[0] - rail_side.origin[0])
        self.rail_origin = rail_side.origin
        self.wheel_origin, self.radius = wheel_side.origin, wheel_side.radius
        index, faces = (
            self._on_wheel(wheel, wheel_side, reach)
            if carrier == "wheel"
            else self._on_rail(rail, rail_side, wheel, wheel_side, reach)
        )
        self.points = wheel_points(wheel, wheel_side, self.wheel_curve, faces)
        count = int(index.max()) + 1
        gap, met = rail_gap(self.points, self.rail_curve, self.rail_origin, 0.0)
        along = self.points.position[0] + gap * self.points.normal[0]
        rail_cell, rail_local, outside = self._locate(rail, rail_side, along, met)
        (row, column), local = (self.points.cell, self.points.local) if carrier == "wheel" else (rail_cell, rail_local)
        phi = [(index[row + a, column + b], w * self.points.weight) for a, b, w in bilinear(local)]
        self.phi = phi
        self.area = self._sum(np.ones_like(gap), count)
        self.at_edge = self._sum(outside.astype(float), count) > 0
        normal = self.points.normal
        across = np.array([np.zeros_like(gap), normal[2], -normal[1]])
        across /= np.linalg.norm(across, axis=0)
        directions = [normal, across, np.cross(normal.T, across.T).T]
        if not tangential:
            directions = directions[:1]
        self.vertical, self.lateral = (
            np.concatenate([self._sum(d[axis], count) / self.area for d in directions]) for axis in (2, 1)
        )
        self.compliance = np.zeros((len(directions) * count,) * 2)
        for name, body, side, cell, local in (
            ("wheel", wheel, wheel_side, self.points.cell, self.points.local),
            ("rail", rail, rail_side, rail_cell, rail_local),
        ):
            dofs, values = shape_rows(body, side, cell, local)
            loads = [functionals(body, dofs, values, d, phi, count) for d in directions]
            for j, block in enumerate(loads):
                u = body.solve(block, partial(progress, f"{name}, compliance {j + 1}"), refined=False)
                for i, other in enumerate(loads):
                    rows, columns = (slice(k * count, (k + 1) * count) for k in (i, j))
                    self.compliance[rows, columns] += (other.T @ u) / np.outer(self.area, self.area)
            if body.order == 2:
                body.release()  # two factors of this size need more memory than many computers have
        self.compliance = 0.5 * (self.compliance + self.compliance.T)
        self.count = count
        self._root = la.cholesky(self.compliance[:count, :count], lower=True)

    def with_friction(self, coefficient: float) -> "Contact":
        """The same contact with Coulomb friction."""
        other = copy.copy(self)
        other.friction = coefficient
        return other

    def _touch(self, wheel: Body, wheel_side: Side, rail_side: Side) -> float:
        """Lateral coordinate, in the wheel's profile frame, where the gap of the profiles is smallest."""
        w = wheel_side.curve + wheel_side.origin
        r = rail_side.curve + rail_side.origin
        order = np.argsort(r[:, 0], kind="stable")
        gap = np.interp(w[:, 0], r[order, 0], r[order, 1], left=np.inf, right=np.inf) - w[:, 1]
        inside = wheel.points[wheel_side.grid.nodes[:, 0], 1]
        gap[(wheel_side.curve[:, 0] < inside.min()) | (wheel_side.curve[:, 0] > inside.max())] = np.inf
        return float(wheel_side.curve[int(np.argmin(gap)), 0])

    def _on_wheel(self, wheel: Body, side: Side, reach: float) -> tuple[Ints, Ints]:
        """Multiplier of every node of the wheel's grid (-1: none) and the wheel's faces around the multipliers."""
        p = wheel.points[side.grid.nodes]
        y = p[..., 1] + side.origin[0] - self.rail_origin[0]
        z = p[..., 2] + side.origin[1] - side.radius - self.rail_origin[1]
        graph = (y > self.rail_curve.low) & (y < self.rail_curve.high)
        graph &= (p[..., 1] > self.wheel_curve.low) & (p[..., 1] < self.wheel_curve.high)
        gap = np.where(graph, self.rail_curve.z(np.clip(y, self.rail_curve.low, self.rail_curve.high)) - z, np.inf)
        index = self._chosen(gap < reach)
        touched = index >= 0
        touched = touched[:-1, :-1] | touched[1:, :-1] | touched[:-1, 1:] | touched[1:, 1:]
        return index, np.array(np.nonzero(touched))

    def _on_rail(
        self, rail: Body, side: Side, wheel: Body, wheel_side: Side, reach: float
    ) -> tuple[Ints, Ints]:
        """Multiplier of every node of the rail's grid (-1: none) and the wheel's faces above their patches."""
        p = rail.points[side.grid.nodes]
        x, y = p[..., 0], p[..., 1] - self.wheel_origin[0]
        graph = (y > self.wheel_curve.low) & (y < self.wheel_curve.high)
        graph &= (p[..., 1] > self.rail_curve.low) & (p[..., 1] < self.rail_curve.high)
        rho = self.radius + self.wheel_curve.z(np.clip(y, self.wheel_curve.low, self.wheel_curve.high))
        below = rho > np.abs(x)
        height = np.sqrt(np.where(below, rho**2 - x**2, 0.0)) - self.radius + self.wheel_origin[1]
        index = self._chosen(np.where(graph & below, p[..., 2] - height, np.inf) < reach)
        rows, columns = np.nonzero(index >= 0)
        low_y, high_y = p[rows.min() - 1, 0, 1], p[rows.max() + 1, 0, 1]
        low_x, high_x = p[0, columns.min() - 1, 0], p[0, columns.max() + 1, 0]
        w = wheel.points[wheel_side.grid.nodes]
        w_x, w_y = w[..., 0], w[..., 1] + self.wheel_origin[0]
        over = (w_y[1:, 1:] > low_y) & (w_y[:-1, :-1] < high_y) & (w_x[1:, 1:] > low_x) & (w_x[:-1, :-1] < high_x)
        return index, np.array(np.nonzero(over))

    def _chosen(self, near: Flags) -> Ints:
        """Numbers of the nodes that are near; -1 for the others and on the border, where patches are cut."""
        chosen = near.copy()
        chosen[[0, -1], :] = False
        chosen[:, [0, -1]] = False
        if not chosen.any():
            raise ValueError("wheel and rail do not come near each other: no candidate for contact")
        self.rim_of = (chosen & ~_interior(chosen))[chosen]
        return np.where(chosen, np.cumsum(chosen).reshape(chosen.shape) - 1, -1)

    def _locate(self, rail: Body, side: Side, x: Floats, y: Floats) -> tuple[Ints, Floats, Flags]:
        """Rail face and local coordinates under points; which lie outside the grid."""
        lines = rail.points[side.grid.nodes[:, 0], 1]
        rows, u, out_y = _cells(lines, y)
        columns, v, out_x = _cells(side.grid.track, x)
        return np.array([rows, columns]), np.array([u, v]), out_x | out_y

    def _sum(self, values: Floats, count: int) -> Floats:
        total = np.zeros(count)
        for index, weight in self.phi:
            keep = index >= 0
            np.add.at(total, index[keep], (weight * values)[keep])
        return total

    def gap(self, lowering: float) -> Floats:
        """Mean gap at every multiplier with the wheel lowered as a rigid body, m."""
        gap, _ = rail_gap(self.points, self.rail_curve, self.rail_origin, lowering)
        return self._sum(gap, self.count) / self.area

    def _normal_forces(self, gap: Floats) -> Floats:
        rhs = -la.solve_triangular(self._root, gap, lower=True)
        scale = float(np.abs(self._root).max())
        rounds = round(NNLS_ROUNDS * self.count)
        try:
            return nnls(self._root.T / scale, rhs, maxiter=rounds)[0] / scale
        except RuntimeError as cause:  # SciPy gives no number
            raise NotConverged("normal forces by non-negative least squares", rounds, np.nan, 0.0, "N", self.count) from cause

    def _balance(self, load: float, extra_gap: Floats, carried: float, guess: float) -> tuple[float, Floats]:
        """Lowering and normal forces that carry ``load`` less ``carried``."""
        last: dict[str, Floats] = {}

        def excess(lowering: float) -> float:
            last["f"] = self._normal_forces(self.gap(lowering) + extra_gap)
            return float(last["f"] @ self.vertical[: self.count]) + carried - load

        high = max(guess, 1e-6)
        while excess(high) < 0.0:
            high *= 1.5
            if high > 0.01:
                raise ValueError(f"the load {load:.4g} N is not reached with the wheel lowered by {high:.3g} m")
        low = 0.7 * high
        while excess(low) > 0.0:
            if low < 1e-9:
                raise ValueError(f"the tangential forces alone exceed the load {load:.4g} N")
            low *= 0.7
        root, report = brentq(excess, low, high, xtol=1e-13, rtol=1e-12, full_output=True, disp=False)
        if not report.converged:
            what, carrying = f"lowering of the wheel under {load:.4g} N", int((last["f"] > 0.0).sum())
            raise NotConverged(what, report.iterations, abs(excess(root)), 0.0, "N", carrying)
        excess(root)
        return float(root), last["f"]

    def press(self, load: float, before: State | None) -> State:
        """Equilibrium under ``load``, grown from ``before``."""
        n = self.count
        guess = before.lowering * (load / before.load) if before else 1e-5
        if self.friction == 0.0:
            lowering, normal = self._balance(load, np.zeros(n), 0.0, guess)
            self._check(normal, load)
            return State(load, lowering, normal, np.zeros((n, 2)), np.zeros((n, 2)))
        normal_tangential = self.compliance[:n, n:]
        tangential = before.tangential.T.ravel() if before else np.zeros(2 * n)
        old_slip = before.slip.T.ravel() if before else np.zeros(2 * n)
        vertical = self.vertical[n:]
        for _ in range(ALTERNATIONS):
            lowering, normal = self._balance(load, normal_tangential @ tangential, float(vertical @ tangential), guess)
            guess = lowering * 1.0001
            free = normal_tangential.T @ normal - vertical * lowering - old_slip
            new = self._friction_forces(free, normal, tangential)
            change = float(np.abs(new - tangential).max())
            tangential = new
            limit = ALTERNATION_END * float(normal.max())
            if change < limit:
                break
        else:
            carrying = int((normal > 0.0).sum())
            raise NotConverged(f"friction under {load:.4g} N", ALTERNATIONS, change, limit, "N", carrying)
        self._check(normal, load)
        slip = free + old_slip + self.compliance[n:, n:] @ tangential
        return State(load, lowering, normal, tangential.reshape(2, n).T, slip.reshape(2, n).T)

    def _friction_forces(self, free: Floats, normal: Floats, start: Floats) -> Floats:
        n = self.count
        on = np.flatnonzero(normal > 0.0)
        rows = np.concatenate([on, n + on])
        matrix = self.compliance[n:, n:][np.ix_(rows, rows)]
        limit = self.friction * normal[on]
        step = 1.0 / float(la.eigvalsh(matrix, subset_by_index=[len(rows) - 1, len(rows) - 1])[0])

        def project(force: Floats) -> Floats:
            pair = force.reshape(2, -1)
            size = np.maximum(np.hypot(*pair), 1e-300)
            return (pair * np.minimum(1.0, limit / size)).ravel()

        force = project(start[rows])
        ahead, speed = force, 1.0
        end = PROJECTION_END * float(limit.max())
        for _ in range(PROJECTIONS):
            new = project(ahead - step * (matrix @ ahead + free[rows]))
            moved = new - force
            if (ahead - new) @ moved > 0.0:
                ahead, speed = new, 1.0  # restart where the momentum points uphill
            else:
                faster = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * speed * speed))
                ahead = new + (speed - 1.0) / faster * moved
                speed = faster
            force = new
            change = float(np.abs(moved).max())
            if change < end:
                break
        else:
            what = "tangential forces under given normal forces"
            raise NotConverged(what, PROJECTIONS, change, end, "N", len(on))
        full = np.zeros(2 * n)
        full[rows] = force
        return full

    def _check(self, normal: Floats, load: float) -> None:
        if ((normal > 0.0) & (self.rim_of | self.at_edge)).any():
            raise BeyondCandidates(f"the contact reaches the edge of the candidates under {load:.4g} N")

    def tangent(self, state: State) -> float:
        """Tangent stiffness dP/d(lowering), N/m, for growing load."""
        n = self.count
        if self.friction == 0.0:
            on = np.flatnonzero(state.normal > 0.0)
            slope = (self.gap(state.lowering * (1 + 1e-6)) - self.gap(state.lowering * (1 - 1e-6))) / (
                2e-6 * state.lowering
            )
            change = la.solve(self.compliance[np.ix_(on, on)], -slope[on], assume_a="pos")
            return float(self.vertical[:n][on] @ change)
        more = self.press(state.load * (1.0 + STEP_FOR_TANGENT), state)
        return STEP_FOR_TANGENT * state.load / (more.lowering - state.lowering)

    def horizontal_stiffness(self, state: State) -> float:
        """Lateral force over lateral displacement of the hub, N/m: all multipliers that carry load stick, and the
        vertical force stays as it is."""
        if len(self.vertical) == self.count:
            raise ValueError("a horizontal stiffness asks for tangential multipliers")
        on = np.tile(state.normal > 0.0, 3)
        moved = np.array([self.lateral[on], self.vertical[on]]).T
        stiffness = moved.T @ la.solve(self.compliance[np.ix_(on, on)], moved, assume_a="pos")
        return float(1.0 / la.inv(stiffness)[0, 0])

    def contact_area(self, state: State) -> float:
        """Area of the multipliers that carry load, m2."""
        return float(self.area[state.normal > 0.0].sum())


def _interior(chosen: Flags) -> Flags:
    """Nodes whose four neighbours are chosen too."""
    inner = np.zeros_like(chosen)
    inner[1:-1, 1:-1] = chosen[:-2, 1:-1] & chosen[2:, 1:-1] & chosen[1:-1, :-2] & chosen[1:-1, 2:]
    return inner


def _cells(lines: Floats, at: Floats) -> tuple[Ints, Floats, Flags]:
    cell = np.clip(np.searchsorted(lines, at, side="right") - 1, 0, len(lines) - 2)
    local = (at - lines[cell]) / (lines[cell + 1] - lines[cell])
    return cell, np.clip(local, 0.0, 1.0), (local < -1e-9) | (local > 1.0 + 1e-9)
