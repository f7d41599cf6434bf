"""Mortar integrals between a wheel and a rail on their smooth profile curves.

Multipliers live on the nodes of one surface, bilinear between them.
Every wheel face carries a fixed, dense Gauss rule; no intersections of faces
are formed. The gap runs along the wheel's own normal to the rail's curve.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.interpolate import CubicSpline

from .body import Body, Floats, Ints
from .exchange import Side
from .iteration import NotConverged

GAUSS = 14
"""Gauss points a direction on every face."""
STEEPEST = 6.0
"""Largest slope at which a profile is taken as a graph z(y)."""
PROJECTIONS = 50
"""Most steps of Newton's method for a gap."""
GAP_END = 1e-15
"""Change of a gap that ends them, m."""


class Graph:
    """A profile curve as z(y) around the point where the bodies touch."""

    def __init__(self, points: Floats, around: float) -> None:
        y, z = points.T
        slope_ok = (np.diff(y) > 0) & (np.abs(np.diff(z)) < STEEPEST * np.diff(y))
        if not slope_ok.any():
            raise ValueError("the profile is nowhere a graph over the lateral coordinate")
        middle = int(np.argmin(np.where(slope_ok, np.abs(y[:-1] - around), np.inf)))
        first = last = middle
        while first > 0 and slope_ok[first - 1]:
            first -= 1
        while last < len(slope_ok) and slope_ok[last]:
            last += 1
        self.low, self.high = float(y[first]), float(y[last])
        self.z = CubicSpline(y[first : last + 1], z[first : last + 1])


@dataclass(frozen=True)
class Points:
    """Integration points on the wheel's surface, bodies just touching."""

    position: Floats
    """World position, 3 x points."""
    normal: Floats
    """Outward unit normal of the wheel, 3 x points."""
    weight: Floats
    """Area, m2."""
    cell: Ints
    """Wheel face (row, column), 2 x points."""
    local: Floats
    """Local coordinates (0..1) on that face, 2 x points."""


def rail_gap(points: Points, rail: Graph, origin: Floats, lowered: float) -> tuple[Floats, Floats]:
    """Distance along the wheel's normal to the rail with the wheel lowered, and the lateral position met."""
    y = points.position[1] - origin[0]
    z = points.position[2] + lowered - origin[1]
    _, ny, nz = points.normal
    gap = np.zeros_like(y)
    for _ in range(PROJECTIONS):
        at = np.clip(y + gap * ny, rail.low, rail.high)
        step = (z + gap * nz - rail.z(at)) / (nz - ny * rail.z(at, 1))
        gap -= step
        change = float(np.abs(step).max())
        if change < GAP_END:
            break
    else:
        raise NotConverged("gap along the wheel's normal", PROJECTIONS, change, GAP_END, "m", len(gap))
    return gap, y + gap * ny + origin[0]


def wheel_points(body: Body, side: Side, curve: Graph, faces: Ints) -> Points:
    """Integration points of the given wheel faces (2 x faces)."""
    x, w = np.polynomial.legendre.leggauss(GAUSS)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    u, v = (g.ravel() for g in np.meshgrid(x, x, indexing="ij"))
    uv_weight = np.outer(w, w).ravel()
    row, column = faces
    y0, y1 = (body.points[side.grid.nodes[r, 0], 1] for r in (row, row + 1))
    t0, t1 = side.grid.track[column], side.grid.track[column + 1]
    y = (y0[:, None] * (1 - u) + y1[:, None] * u).ravel()
    angle = (t0[:, None] * (1 - v) + t1[:, None] * v).ravel()
    area = (np.outer((y1 - y0) * (t1 - t0), uv_weight)).ravel()
    z, slope = curve.z(y), curve.z(y, 1)
    rho, length = side.radius + z, np.hypot(1.0, slope)
    position = np.array(
        [rho * np.sin(angle), y + side.origin[0], side.origin[1] - side.radius + rho * np.cos(angle)]
    )
    normal = np.array([np.sin(angle), -slope, np.cos(angle)]) / length
    count = len(u)
    return Points(
        position,
        normal,
        area * rho * length,
        np.repeat(faces, count, axis=1),
        np.array([np.tile(u, len(row)), np.tile(v, len(row))]),
    )


def bilinear(local: Floats) -> list[tuple[int, int, Floats]]:
    """Corner offsets (row, column) and bilinear weights."""
    u, v = local
    return [(0, 0, (1 - u) * (1 - v)), (0, 1, (1 - u) * v), (1, 0, u * (1 - v)), (1, 1, u * v)]


def shape_rows(body: Body, side: Side, cell: Ints, local: Floats) -> tuple[Ints, Floats]:
    """Scalar shape functions at points on faces: (degree of freedom of direction 0..2, value) by function and point.

    Evaluated in the hexahedron behind the face, so that it serves every order of element.
    """
    row, column = cell
    corners = [(a, b, side.grid.nodes[row + a, column + b]) for a, b in ((0, 0), (0, 1), (1, 0), (1, 1))]
    faces, first, inverse = np.unique(np.array([row, column]), axis=1, return_index=True, return_inverse=True)
    inverse = np.ravel(inverse)
    owners: dict[int, set[int]] = {}
    wanted = np.unique(np.concatenate([c[first] for _, _, c in corners]))
    elements = np.flatnonzero(np.isin(body.mesh.t, wanted).sum(axis=0) >= 4)
    for e in elements:
        for node in body.mesh.t[:, e]:
            owners.setdefault(int(node), set()).add(int(e))
    element = np.empty(faces.shape[1], dtype=np.int64)
    reference = np.empty((4, 3, faces.shape[1]))
    locations = skfem_corners(body)
    for f in range(faces.shape[1]):
        nodes = [int(c[first[f]]) for _, _, c in corners]
        common = set.intersection(*(owners[n] for n in nodes))
        if len(common) != 1:
            raise ValueError(f"surface face with nodes {nodes} belongs to {len(common)} hexahedra, expected one")
        element[f] = common.pop()
        for k, node in enumerate(nodes):
            reference[k, :, f] = locations[int(np.flatnonzero(body.mesh.t[:, element[f]] == node)[0])]
    weights = [w for _, _, w in bilinear(local)]
    inside = sum(reference[k][:, inverse] * weights[k] for k in range(4))
    values = np.array([body.element.lbasis(inside, i)[0] for i in range(len(body.element.doflocs))])
    dofs = 3 * body.basis.element_dofs[:, None, element[inverse]] + np.arange(3)[:, None]
    return dofs, values


def skfem_corners(body: Body) -> Floats:
    """Reference position of every local corner of scikit-fem's hexahedron."""
    return np.asarray(type(body.mesh).elem().doflocs)


def functionals(
    body: Body, dofs: Ints, values: Floats, direction: Floats, phi: list[tuple[Ints, Floats]], count: int
) -> sp.csc_matrix:
    """Columns of weighted surface displacements in ``direction``: one for every multiplier.

    ``phi``: multiplier index (negative: none) and weight, area included, of every point.
    """
    rows, columns, data = [], [], []
    for index, weight in phi:
        keep = np.flatnonzero(index >= 0)
        for axis in range(3):
            part = values[:, keep] * (weight[keep] * direction[axis, keep])
            rows.append(dofs[:, axis, keep].ravel())
            columns.append(np.broadcast_to(index[keep], part.shape).ravel())
            data.append(part.ravel())
    matrix = sp.coo_matrix(
        (np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=(body.degrees_of_freedom, count)
    )
    return matrix.tocsc()
