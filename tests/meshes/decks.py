"""Writes a mesh of Gmsh as Abaqus decks: ``python decks.py rail-60e1.msh FOLDER``.

In ``FOLDER`` appear ``cards.inp`` (nodes and the set "foot" in two cards each, the second one with a set of its own, a name in quotes),
``part.inp`` (a part and its instance, moved; the contact surface as faces) and ``missing.inp`` (a set with a node that is not there).
"""

import sys
from pathlib import Path

import meshio
import numpy as np

SHIFT = np.array([1.0, 2.0, -4.0])
"""The part of the second deck stands so far off its place, mm."""


def rows(first: int, table: np.ndarray) -> list[str]:
    """Numbered lines."""
    return [f"{first + k}, " + ", ".join(repr(v) for v in row) for k, row in enumerate(table.tolist())]


def main(source: Path, folder: Path) -> None:
    """Writes the files."""
    mesh = meshio.read(source)
    points, hexes = mesh.points, mesh.cells_dict["hexahedron"] + 1
    quads = mesh.cells_dict["quad"] + 1
    tags = mesh.cell_data_dict["gmsh:physical"]["quad"]
    sets = {name: np.unique(quads[tags == mesh.field_data[name][0]]) for name in ("running surface", "foot")}
    bricks = ["*ELEMENT, TYPE=C3D8, ELSET=rail", *rows(1, hexes)]

    def numbers(nodes: np.ndarray) -> list[str]:
        return [", ".join(map(str, nodes[k : k + 16].tolist())) for k in range(0, len(nodes), 16)]

    half, foot = len(points) // 2, sets["foot"]
    nodes = ["*NODE", *rows(1, points[:half]), "*NODE, NSET=more", *rows(half + 1, points[half:])]
    running = ['*NSET, NSET="running surface"', *numbers(sets["running surface"])]
    two = ["*NSET, NSET=rest", *numbers(foot[200:]), "*NSET, NSET=foot", *numbers(foot[:200]), "*NSET, NSET=Foot", "rest"]
    (folder / "cards.inp").write_text("\n".join([*nodes, *bricks, *running, *two, ""]))
    (folder / "missing.inp").write_text("\n".join([*nodes, *bricks, *running, "*NSET, NSET=foot", "1, 999999", ""]))
    faces = ["*SURFACE, NAME=running surface, TYPE=ELEMENT"]
    top = set(sets["running surface"].tolist())
    sides = [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    for k, brick in enumerate(hexes.tolist(), 1):
        faces += [f"{k}, S{s}" for s, side in enumerate(sides, 1) if all(brick[c] in top for c in side)]
    part = ["*PART, NAME=rail", "*NODE", *rows(1, points - SHIFT), *bricks, *faces, "*NSET, NSET=foot", *numbers(foot), "*END PART"]
    instance = ["*ASSEMBLY, NAME=all", "*INSTANCE, NAME=rail-1, PART=rail", ", ".join(map(repr, SHIFT.tolist())), "*END INSTANCE"]
    (folder / "part.inp").write_text("\n".join([*part, *instance, "*END ASSEMBLY", ""]))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
