"""Where a deformed wheel and a deformed rail face each other: gaps, and the nodes that carry the forces there.

Both surfaces are their smooth profiles, moved by the displacements of their nodes, bilinear between these. Every face
of the wheel has a fixed Gauss rule, whose points are taken to the nearest place on the rail's profile. Forces live on the
nodes of the rail.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from .body import Body, Floats, Ints
from .curve import Curve
from .exchange import Side
from .iteration import NotConverged
from .surface import bilinear

GAUSS = 8
"""Gauss points a direction on every face."""
REACH = 1.0e-3
"""Gap of a node up to which the faces around it are looked at, m: between the nodes the surfaces are nearer by a part of it."""
FOOT_ROUNDS = 12
"""Most corrections of a place on the rail for the rail's own displacement there."""
FOOT_END = 1e-10
"""Change of that place which ends them, m."""
BESIDE = 1e-6
"""Way along the rail's tangent to a point that has a nearest place within the profile, m; beyond an end it is longer."""
TURN_REACH = 25e-3
"""Distance from the patch up to which nodes say how the railhead turns, m: most of a railhead, little of which is patch."""

Flags = NDArray[np.bool_]
Weights = list[tuple[Ints, Floats]]
"""The four nodes around each of some points, with their bilinear weights."""


class Surface:
    """The contact surface of a body, bodies just touching; the nodes of its grid row by row."""

    def __init__(self, body: Body, side: Side) -> None:
        self.curve = Curve(side.curve)
        self.radius, self.origin = side.radius, side.origin
        self.track = side.grid.track
        self.shape = side.grid.nodes.shape
        self.nodes = side.grid.nodes.ravel()
        self.lines = self.curve.nearest(self._profile(body.points[side.grid.nodes[:, 0]]))
        self.rest = self.position(np.repeat(self.lines, self.shape[1]), np.tile(self.track, self.shape[0]))

    def _profile(self, points: Floats) -> Floats:
        """Points of the mesh as points of the profile."""
        x, y, z = points.T
        if self.radius == 0.0:
            return np.array([y - self.origin[0], z - self.origin[1]]).T
        return np.array([y, np.hypot(x, z) - self.radius]).T

    def position(self, s: Floats, t: Floats) -> Floats:
        """World points at arc lengths and places along the track, one row each, m."""
        y, z = self.curve.at(s).T
        if self.radius == 0.0:
            return np.array([t, y + self.origin[0], z + self.origin[1]]).T
        rho = self.radius + z
        return np.array([rho * np.sin(t), y + self.origin[0], self.origin[1] - self.radius + rho * np.cos(t)]).T

    def around(self, row: Ints, column: Ints, local: Floats) -> Weights:
        """The nodes around points of cells."""
        return [((row + a) * self.shape[1] + column + b, w) for a, b, w in bilinear(local)]

    def cells(self, s: Floats, t: Floats) -> tuple[Weights, Flags]:
        """The nodes around places, and which of these lie outside the grid."""
        row, u, out = _cells(self.lines, s)
        column, v, beyond = _cells(self.track, t)
        return self.around(row, column, np.array([u, v])), out | beyond


def _cells(lines: Floats, at: Floats) -> tuple[Ints, Floats, Flags]:
    cell = np.clip(np.searchsorted(lines, at, side="right") - 1, 0, len(lines) - 2)
    local = (at - lines[cell]) / (lines[cell + 1] - lines[cell])
    return cell, np.clip(local, 0.0, 1.0), (local < -1e-9) | (local > 1.0 + 1e-9)


def between(weights: Weights, nodal: Floats) -> Floats:
    """Values at points, one row each, from those at the nodes."""
    return sum(w[:, None] * nodal[n] for n, w in weights)


@dataclass(frozen=True)
class Points:
    """Gauss points of the wheel and what they face."""

    wheel: Weights
    rail: Weights
    gap: Floats
    """Distance from the rail along its normal, m."""
    weight: Floats
    """Area, m2; none where a point faces no rail."""
    place: Floats
    """Arc length on the rail, m."""
    tangent: Floats
    """Unit tangent of the rail there, at rest."""
    outside: Flags
    """Which face no rail."""


@dataclass(frozen=True)
class Pairs:
    """Nodes of the rail that may carry load."""

    nodes: Ints
    """Numbers on its grid."""
    gap: Floats
    """Mean gaps, m."""
    at_edge: Flags
    """Whose surroundings are cut by the end of a surface."""
    motion: tuple[sp.csr_matrix, sp.csr_matrix]
    """Mean displacements of wheel and rail at the nodes, in the directions normal (out of the rail), across and along
    the track, from the displacements of their grids."""


class Facing:
    """A wheel over a rail."""

    def __init__(self, wheel: Surface, rail: Surface) -> None:
        self.wheel, self.rail = wheel, rail
        x, w = np.polynomial.legendre.leggauss(GAUSS)
        x, w = 0.5 * (x + 1.0), 0.5 * w
        local = np.array([g.ravel() for g in np.meshgrid(x, x, indexing="ij")])
        rows, columns = (n - 1 for n in wheel.shape)
        faces = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
        row, column = (np.repeat(g.ravel(), local.shape[1]) for g in faces)
        local = np.tile(local, rows * columns)
        ds, dt = np.diff(wheel.lines)[row], np.diff(wheel.track)[column]
        s, t = wheel.lines[row] + local[0] * ds, wheel.track[column] + local[1] * dt
        self._at = wheel.position(s, t)
        self._around = wheel.around(row, column, local)
        self._weight = np.tile(np.outer(w, w).ravel(), rows * columns) * ds * dt * (wheel.radius + wheel.curve.at(s)[:, 1])

    def pairs(self, on_wheel: Floats, on_rail: Floats, margin: float, always: Ints) -> Pairs:
        """Nodes with a mean gap below ``margin`` (m), and the nodes ``always``, at displacements of both grids (one row a
        node, m)."""
        points = self._points(on_wheel, on_rail)
        count = len(self.rail.nodes)

        def total(values: Floats) -> Floats:
            return sum(np.bincount(n, w * values, count) for n, w in points.rail)

        area = total(points.weight)
        cut = total((points.outside & (points.gap < REACH)).astype(float)) > 0.0
        mean = total(points.weight * points.gap) / np.where(area > 0.0, area, 1.0)
        chosen = mean < margin
        chosen[always] = True
        nodes = np.flatnonzero(chosen & (area > 0.0))
        return Pairs(nodes, mean[nodes], cut[nodes], self._motion(points, nodes, area[nodes], on_rail))

    def _near(self, on_wheel: Floats, on_rail: Floats) -> Ints:
        """Gauss points of the faces near the rail."""
        # the railhead moves by less than the reach; which part of it how far matters little here
        place = (self.wheel.rest + on_wheel)[:, 1:] - on_rail[:, 1:].mean(axis=0) - self.rail.origin
        gap, beside, *_ = self._over(place)
        near = (gap < REACH) & (beside < BESIDE)
        return np.flatnonzero(np.any([near[n] for n, _ in self._around], axis=0))

    def _over(self, place: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Of points (y, z): height over the rail at rest, distance beside its end, nearest place and tangent there."""
        s = self.rail.curve.nearest(place)
        tangent = self.rail.curve.tangent(s)
        off = place - self.rail.curve.at(s)
        height = off[:, 0] * tangent[:, 1] - off[:, 1] * tangent[:, 0]
        return height, np.abs(np.einsum("pi,pi->p", off, tangent)), s, tangent

    def _points(self, on_wheel: Floats, on_rail: Floats) -> Points:
        chosen = self._near(on_wheel, on_rail)
        wheel = [(n[chosen], w[chosen]) for n, w in self._around]
        at = self._at[chosen] + between(wheel, on_wheel)
        of_rail = np.broadcast_to(on_rail.mean(axis=0), at.shape)
        before = np.full(len(chosen), np.inf)
        for _ in range(FOOT_ROUNDS):
            place = at - of_rail
            gap, beside, s, tangent = self._over(place[:, 1:] - self.rail.origin)
            rail, outside = self.rail.cells(s, place[:, 0])
            of_rail = between(rail, on_rail)
            change = float(np.abs(s - before).max(initial=0.0))
            before = s
            if change < FOOT_END:
                break
        else:
            raise NotConverged("places on the rail", FOOT_ROUNDS, change, FOOT_END, "m", len(chosen))
        outside |= beside > BESIDE
        weight = np.where(outside, 0.0, self._weight[chosen])
        return Points(wheel, rail, gap, weight, s, tangent, outside)

    def _motion(self, points: Points, nodes: Ints, area: Floats, on_rail: Floats) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        count = len(nodes)
        slot = np.full(len(self.rail.nodes), -1)
        slot[nodes] = np.arange(count)
        used = np.flatnonzero(np.any([slot[n] >= 0 for n, _ in points.rail], axis=0))
        turn = self._turn(points.place[used], points.weight[used], on_rail)
        y, z = points.tangent[used].T
        across = np.array([y - turn * z, z + turn * y]) / np.hypot(1.0, turn)
        directions = [{1: across[1], 2: -across[0]}, {1: across[0], 2: across[1]}, {0: np.ones(len(used))}]
        share = [(slot[n[used]], w[used] * points.weight[used]) for n, w in points.rail]
        motion = []
        for surface, weights in ((self.wheel, points.wheel), (self.rail, points.rail)):
            entries: list[tuple[Floats, Ints, Ints]] = []
            for number, direction in enumerate(directions):
                for axis, part in direction.items():
                    for index, phi in share:
                        on = index >= 0
                        scaled = phi[on] * part[on] / area[index[on]]
                        row = number * count + index[on]
                        entries += [(scaled * w[used][on], row, 3 * node[used][on] + axis) for node, w in weights]
            data, row, column = (np.concatenate(part) for part in zip(*entries, strict=True))
            total = sp.csr_matrix((data, (row, column)), shape=(3 * count, 3 * len(surface.nodes)))
            motion.append(total)
        return motion[0], motion[1]

    def _turn(self, place: Floats, weight: Floats, on_rail: Floats) -> float:
        """Turn of the railhead around some points, from y towards z, rad: the rigid one nearest to the displacements of its
        nodes."""
        if weight.sum() == 0.0:
            return 0.0
        near = np.abs(self.rail.lines - np.average(place, weights=weight)) < TURN_REACH
        keep = np.repeat(near, self.rail.shape[1])
        at, moved = self.rail.rest[keep, 1:], on_rail[keep, 1:]
        at, moved = at - at.mean(axis=0), moved - moved.mean(axis=0)
        return float((at[:, 0] * moved[:, 1] - at[:, 1] * moved[:, 0]).sum()) / float((at**2).sum())
