"""Writes a mesh of ``railspring mesh`` in other formats: ``python rewrite.py rail.vtu FOLDER``.

In ``FOLDER`` appear, named as the source, meshes in mm with the groups "running surface" and "held": ``.msh`` (Gmsh
4.1, physical groups), ``.inp`` (Abaqus, node sets) and ``-mask.vtu`` (masks of cells on faces).
"""

import sys
from pathlib import Path

import meshio
import numpy as np

FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
"""Faces of a hexahedron."""
GROUPS = {"running surface": "contact", "held": "held"}
"""Names of the groups, and of the masks that they come from."""


def main(source: Path, folder: Path) -> None:
    """Writes the files."""
    mesh = meshio.read(source)
    points, hexes = 1e3 * mesh.points, mesh.cells_dict["hexahedron"]
    sets = {name: np.flatnonzero(mesh.point_data[mask]) for name, mask in GROUPS.items()}
    quads = hexes[:, FACES].reshape(-1, 4)
    faces = [quads[np.isin(quads, nodes).all(axis=1)] for nodes in sets.values()]
    target = folder / source.stem
    meshio.Mesh(points, [("hexahedron", hexes)], point_sets=sets).write(target.with_suffix(".inp"))
    blocks = [("hexahedron", hexes), *(("quad", quad) for quad in faces)]
    masks = {
        name: [np.full(len(cells), float(k == block)) for block, (_, cells) in enumerate(blocks)]
        for k, name in enumerate(GROUPS, start=1)
    }
    meshio.Mesh(points, blocks, cell_data=masks).write(folder / f"{source.stem}-mask.vtu")
    gmsh(target.with_suffix(".msh"), points, [(3, 5, hexes, "solid"), *((2, 3, q, n) for q, n in zip(faces, GROUPS))])


def gmsh(path: Path, points: np.ndarray, blocks: list) -> None:
    """Gmsh 4.1 as text, every block an entity with a physical group; the numbers of the nodes have gaps."""
    number = lambda v: 3 * v + 7  # noqa: E731
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(blocks))]
    lines += [f'{dim} {k} "{name}"' for k, (dim, _, _, name) in enumerate(blocks, start=1)]
    lines += ["$EndPhysicalNames", "$Entities", f"0 0 {len(blocks) - 1} 1"]
    order = sorted(range(len(blocks)), key=lambda k: blocks[k][0])
    lines += [f"{k + 1} 0 0 0 0 0 0 1 {k + 1} 0" for k in order]
    lines += ["$EndEntities", "$Nodes", f"1 {len(points)} {number(0)} {number(len(points) - 1)}"]
    lines.append(f"3 1 0 {len(points)}")
    lines += [str(number(v)) for v in range(len(points))]
    lines += [" ".join(repr(float(x)) for x in p) for p in points]
    count = sum(len(cells) for _, _, cells, _ in blocks)
    lines += ["$EndNodes", "$Elements", f"{len(blocks)} {count} 1 {count}"]
    first = 1
    for k, (dim, kind, cells, _) in enumerate(blocks, start=1):
        lines.append(f"{dim} {k} {kind} {len(cells)}")
        for e, cell in enumerate(cells, start=first):
            lines.append(" ".join([str(e), *(str(number(v)) for v in cell)]))
        first += len(cells)
    path.write_text("\n".join([*lines, "$EndElements", ""]), encoding="ascii")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
