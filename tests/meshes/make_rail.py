"""Meshes a rail in Gmsh: ``python make_rail.py rail.vtu rail-60e1.msh``.

``rail.vtu`` is a mesh that ``railspring mesh`` has written, with elements of 2 mm in the contact zone; only the outline
of its section is taken from it. Section, sizes, layers and numbering are Gmsh's. Needs the packages gmsh, meshio and
numpy; the tests only read what this script has written.
"""

import sys

import gmsh
import meshio
import numpy as np

HALF = 277.5
"""Half the length of the rail, mm."""
TOUCH = np.array([753.2, 0.0])
"""Where the wheel touches (y, z), mm; elements grow away from there."""
LAYERS = [0.0, 2.2, 4.4, 6.6, 9.0, 12.3, 20.0, 40.0, 80.0, 150.0, HALF]
"""Distances of the planes of nodes from the middle, mm."""
CORNER = 25.0
"""Turn of the outline that separates two curves, degrees."""


def size(point):
    """Edge of the elements at a point of the section, mm."""
    return float(min(9.0, 2.6 + 0.2 * max(0.0, np.linalg.norm(point - TOUCH) - 12.0)))


def outline(path):
    """Points (y, z) around the section, mm, beginning with those of the running surface, and how many these are."""
    mesh = meshio.read(path)
    points = 1e3 * mesh.points
    end = [hexa[:4] for hexa in mesh.cells_dict["hexahedron"] if np.abs(points[hexa[:4], 0] + HALF).max() < 1e-9]
    edges = {(a, b) for quad in end for a, b in zip(quad, np.roll(quad, -1), strict=True)}
    following = {a: b for a, b in edges if (b, a) not in edges}
    loop = [min(following)]
    while following[loop[-1]] != loop[0]:
        loop.append(following[loop[-1]])
    around = points[loop, 1:]
    contact = points[(mesh.point_data["contact"] > 0) & (np.abs(points[:, 0]) < 1e-9), 1:]
    running = np.array([np.linalg.norm(contact - p, axis=1).min() < 1e-6 for p in around])
    count = int(running.sum())
    first = next(i for i in range(len(around)) if running[i] and not running[i - 1])
    around = np.roll(around, -first, axis=0)
    assert np.roll(running, -first)[:count].all()
    return around, count


def main(source, target):
    """Writes the mesh."""
    around, count = outline(source)
    gmsh.initialize()
    geometry = gmsh.model.geo
    points = [geometry.addPoint(-HALF, *p) for p in around]
    # behind the running surface the outline is cut at its corners
    rest = [*range(count - 1, len(around)), 0]
    turn = [0.0]
    for a, b, c in zip(rest, rest[1:], rest[2:], strict=False):
        before, after = around[b] - around[a], around[c] - around[b]
        turn.append(abs(np.degrees(np.arctan2(before[0] * after[1] - before[1] * after[0], before @ after))))
    corners = [0, *(i for i, angle in enumerate(turn) if angle > CORNER), len(rest) - 1]
    pieces = [list(range(count)), *(rest[a : b + 1] for a, b in zip(corners, corners[1:], strict=False))]
    curves = [geometry.addSpline([points[i] for i in piece]) for piece in pieces]
    section = geometry.addPlaneSurface([geometry.addCurveLoop(curves)])
    geometry.synchronize()
    for curve, piece in zip(curves, pieces, strict=True):
        length = np.linalg.norm(np.diff(around[piece], axis=0), axis=1).sum()
        step = 2.4 if curve == curves[0] else size(around[piece[len(piece) // 2]])
        gmsh.model.mesh.setTransfiniteCurve(curve, 1 + 2 * max(1, round(0.5 * length / step)))
    gmsh.model.mesh.setSizeCallback(lambda dim, tag, x, y, z, old: size(np.array([y, z])))
    for option, value in {
        "Mesh.MeshSizeExtendFromBoundary": 0,
        "Mesh.MeshSizeFromPoints": 0,
        "Mesh.Algorithm": 8,
        "Mesh.RecombineAll": 1,
        "Mesh.MshFileVersion": 4.1,
    }.items():
        gmsh.option.setNumber(option, value)
    planes = sorted({0.5 * (1.0 + side * x / HALF) for side in (-1, 1) for x in LAYERS})[1:]
    swept = geometry.extrude([(2, section)], 2.0 * HALF, 0.0, 0.0, [1] * len(planes), planes, recombine=True)
    geometry.synchronize()
    sides = [tag for dimension, tag in swept[2:] if dimension == 2]
    widths = [np.ptp(around[piece][:, 0]) if abs(np.ptp(around[piece][:, 1])) < 5.0 else 0.0 for piece in pieces]
    gmsh.model.addPhysicalGroup(3, [swept[1][1]], name="rail")
    gmsh.model.addPhysicalGroup(2, [sides[0]], name="running surface")
    gmsh.model.addPhysicalGroup(2, [sides[int(np.argmax(widths))]], name="foot")
    gmsh.model.mesh.generate(3)
    gmsh.write(target)
    gmsh.finalize()


if __name__ == "__main__":
    main(*sys.argv[1:])
