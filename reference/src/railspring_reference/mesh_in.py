"""Reads a mesh that a user brings: Abaqus decks and Gmsh files with the modules of this package, all others with meshio.

``python -m railspring_reference.mesh_in FILE --contact NAME --held NAME [--material NAME]...`` writes to its standard
output one line of JSON and then raw little-endian data: coordinates in the file's unit (``<f8``, three a node), nodes
of the hexahedra in the order of VTK (``<i8``, eight each), the contact nodes and the held nodes (``<i8``, ascending),
and, with materials, the number of the one that every hexahedron has (``<i8``). The line of JSON has
their numbers, or under ``error`` what is wrong with the file: ``key`` (of the study, without its section), ``value``,
``expected`` and ``remedy``.

The order of the nodes is that of the file; nodes that belong to no hexahedron (centres of arcs, for instance) are left
out. Whether the elements are sound, and what the names enclose, is for the tool to check.
"""

import argparse
import contextlib
import json
import os
import sys
import sysconfig
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from numpy.typing import NDArray

from . import abaqus, gmsh, nastran
from .refusal import Refused, elsewhere

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FORMAT = 2
"""Version of the output."""
HEXAHEDRON = "hexahedron"
"""meshio's name of the hexahedron with eight nodes."""
TO_HEXAHEDRA = (
    "mesh with eight-node hexahedra of first order: in Gmsh extrude or revolve the section with `Recombine` and "
    "`Layers`, with Mesh.RecombineAll = 1 (or transfinite surfaces and volumes) and Mesh.ElementOrder = 1; in Abaqus "
    "C3D8 on swept or structured regions"
)
"""Advice for meshes of other elements."""
REFERRING = {".xdmf", ".xmf"}
"""Endings of files that have their data elsewhere."""
HDF5 = b"\x89HDF\r\n\x1a\n"
"""Beginning of files whose groups and data may lie in other files."""
CODE = {".py", ".pyc", ".pyd", ".so", ".dll", ".dylib"}
"""Endings of what Python itself opens when it imports a module."""
DIMENSION = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2, "polygon": 2}
"""Dimension of the cells that carry names at most, by the beginning of their names; all others are volumes."""


class OneFile:
    """Refuses every other file that is opened while a mesh is read: the study's hash would not see a change in it.

    Python reports each opening before it happens, however the mesh file names the other one.
    """

    def __init__(self) -> None:
        self._mesh: Path | None = None
        self._other: str | None = None
        self._installed = False
        folders = {sys.prefix, sys.base_prefix, *(sysconfig.get_paths()[k] for k in ("stdlib", "purelib", "platlib"))}
        self._python = [Path(folder).resolve() for folder in folders]

    @contextlib.contextmanager
    def only(self, path: Path) -> Iterator[None]:
        """Within this context ``path`` alone can be read."""
        if not self._installed:  # a hook stays for the life of the process
            sys.addaudithook(self._hook)
            self._installed = True
        self._other, self._mesh = None, path.resolve()
        try:
            yield
        finally:
            self._mesh = None
        if self._other:  # a reader may have gone on without it
            raise elsewhere(path, self._other)

    def _hook(self, event: str, arguments: tuple[Any, ...]) -> None:
        mesh = self._mesh
        if event != "open" or mesh is None or isinstance(arguments[0], int):
            return
        self._mesh = None  # what follows may open files too
        try:
            opened = Path(os.fsdecode(arguments[0])).resolve()
            code = opened.suffix in CODE and any(opened.is_relative_to(folder) for folder in self._python)
            if opened != mesh and not code:
                self._other = opened.name
                raise elsewhere(mesh, opened.name)
        finally:
            self._mesh = mesh


ONE_FILE = OneFile()


def whole(path: Path) -> None:
    """Refuses files that name others, as far as can be seen before they are read."""
    if path.suffix.lower() in REFERRING:
        other = "its data in another file"
    else:
        with path.open("rb") as file:
            other = "HDF5, which may have its data in other files" if file.read(len(HDF5)) == HDF5 else None
    if other:
        raise elsewhere(path, other)


def read(path: Path) -> meshio.Mesh:
    """The mesh of a file, by its ending."""
    try:
        whole(path)
        reader = READERS.get(path.suffix.lower(), meshio.read)
        # meshio prints what it could not read, and ends the program
        with contextlib.redirect_stdout(sys.stderr), ONE_FILE.only(path):
            mesh = reader(path)
        numbered(mesh, path)
        return mesh
    except Refused:
        raise
    except (SystemExit, Exception) as error:  # readers stumble over broken files in many ways
        raise unreadable(path, error) from None


def numbered(mesh: meshio.Mesh, path: Path) -> None:
    """Refuses cells and groups with numbers that no node or cell has: -1 would be the last one without a word."""

    def within(numbers: Any, count: int, what: str, of: str) -> None:
        given = np.asarray(numbers)
        outside = given[(given < 0) | (given >= count)] if given.size and given.dtype.kind in "iuf" else given[:0]
        if outside.size:
            raise Refused(
                "mesh_file",
                f'"{path.name}" ({what} with {of} number {outside.ravel()[0]})',
                f"numbers of the {count} {of}s that the file has, counted from 0",
                "correct the number, or write the mesh again",
            )

    for block in mesh.cells:
        within(block.data, len(mesh.points), f"a {block.type}", "node")
    for name, nodes in mesh.point_sets.items():
        within(nodes, len(mesh.points), f'the node set "{name}"', "node")
    for name, blocks in mesh.cell_sets.items():
        for block, cells in zip(mesh.cells, blocks, strict=False):
            if cells is not None:
                within(cells, len(block.data), f'the element set "{name}"', "cell")


def unreadable(path: Path, error: BaseException) -> Refused:
    """Refuses a file that a reader stumbles over."""
    # the text of a KeyError is but the key
    said = "" if isinstance(error, (SystemExit, KeyError)) else " ".join(str(error).split())
    return Refused(
        "mesh_file",
        f'"{path.name}" (it cannot be read in the format of its ending{": " + said if said else ""})',
        "a mesh that can be read, for instance Gmsh (.msh), Abaqus (.inp) or VTU",
        "check the file and its ending, or write it in another format",
    )


def msh(path: Path) -> meshio.Mesh:
    """A file that ends in ``.msh``: mostly Gmsh's, but Fluent has the same ending."""
    with path.open("rb") as file:
        of_gmsh = file.read(1) in (b"$", b"")
    return gmsh.read(path) if of_gmsh else meshio.read(path)


READERS = {".inp": abaqus.read, ".msh": msh, ".bdf": nastran.read, ".nas": nastran.read, ".fem": nastran.read}
"""Readers by the ending of the file; all others are meshio's."""


def dimension(kind: str) -> int:
    """Dimension of a kind of cell."""
    return next((d for name, d in DIMENSION.items() if kind.startswith(name)), 3)


def hexahedra(mesh: meshio.Mesh, file: str) -> Ints:
    """Nodes of all hexahedra; any other volume element is refused."""
    count: dict[str, int] = {}
    for block in mesh.cells:
        if dimension(block.type) == 3 and len(block.data):
            count[block.type] = count.get(block.type, 0) + len(block.data)
    others = {kind: n for kind, n in count.items() if kind != HEXAHEDRON}
    if others:
        found = ", ".join(f"{n} {kind}" for kind, n in sorted(count.items()))
        raise Refused("mesh_file", f'"{file}" ({found})', "hexahedra with eight nodes only", TO_HEXAHEDRA)
    if not count:
        found = ", ".join(sorted({block.type for block in mesh.cells})) or "no cells"
        raise Refused(
            "mesh_file",
            f'"{file}" ({found}, no hexahedra)',
            "a mesh of hexahedra with eight nodes",
            "save the volume too: in Gmsh give it a physical volume; " + TO_HEXAHEDRA,
        )
    return np.vstack([block.data for block in mesh.cells if block.type == HEXAHEDRON]).astype(np.int64)


def of_cells(mesh: meshio.Mesh, chosen: list[Any], key: str, name: str) -> Ints:
    """Nodes of the chosen cells of every block; a group of volumes is refused."""
    nodes: list[Ints] = [np.zeros(0, dtype=np.int64)]
    for block, cells in zip(mesh.cells, chosen, strict=False):
        picked = np.asarray(block.data)[np.asarray([] if cells is None else cells, dtype=np.int64)]
        if len(picked) and dimension(block.type) == 3:
            raise Refused(
                key,
                f'"{name}" ({len(picked)} {block.type})',
                "a group of nodes or of surface elements",
                "name the surface, not the volume: its inner nodes would belong to the group too",
            )
        nodes.append(picked.ravel().astype(np.int64))
    return np.unique(np.concatenate(nodes))


def groups(mesh: meshio.Mesh, nodes: bool = True) -> dict[str, list[str]]:
    """Names of all groups, and of what kinds each is. ``nodes``: those of nodes too."""
    found: dict[str, list[str]] = {}

    def add(names: Any, kind: str) -> None:
        for name in names:
            found.setdefault(str(name), []).append(kind)

    add(mesh.point_sets if nodes else (), "node set")
    add(mesh.info.get("surfaces", ()) if nodes and mesh.info else (), "surface")
    add(mesh.info.get("physical groups", ()) if mesh.info else (), "physical group")
    add(mesh.cell_sets, "element set")
    add((name for name, values in mesh.point_data.items() if nodes and scalar(values)), "node mask")
    add((name for name, blocks in mesh.cell_data.items() if all(scalar(b) for b in blocks)), "cell mask")
    return found


def scalar(values: Any) -> bool:
    """Whether there is one number for every node or cell, as in a mask."""
    return np.ndim(values) == 1 or np.shape(values)[1:] == (1,)


def inside(values: Any) -> Ints:
    """Where a mask is not zero; what is not a number counts as outside."""
    return np.flatnonzero(np.nan_to_num(np.ravel(values), nan=0.0)).astype(np.int64)


def name_in_file(known: dict[str, list[str]], key: str, name: str, remedy: str) -> str:
    """The name as the file has it, of one of the ``known`` groups."""
    # upper and lower case are the same in Abaqus
    alike = [other for other in known if other.casefold() == name.casefold()]
    found = name if name in known else alike[0] if len(alike) == 1 else None
    if found is None:
        names = ", ".join(f'"{other}" ({" and ".join(kinds)})' for other, kinds in sorted(known.items())) or "no names at all"
        raise Refused(key, f'"{name}"', f"a name that the mesh file has: {names}", remedy)
    return found


def cells_of(mesh: meshio.Mesh, kind: str, name: str) -> list[Any]:
    """Cells of a group of cells, of every block."""
    match kind:
        case "physical group":
            return list(mesh.info["physical groups"][name])
        case "element set":
            return list(mesh.cell_sets[name])
        case _:
            return [inside(values) for values in mesh.cell_data[name]]


def group(mesh: meshio.Mesh, key: str, name: str) -> Ints:
    """Nodes of the group ``name``, ascending."""
    known = groups(mesh)
    remedy = (
        "name a Gmsh physical surface, an Abaqus node set or surface (or element set of surface elements), a property "
        "of Nastran's surface elements, or a mask of point or cell data that is not zero on the group"
    )
    found = name_in_file(known, key, name, remedy)
    kinds = known[found]
    if len(kinds) > 1:  # a set of solid elements beside a set of nodes has the name for other uses
        kinds = [kind for kind in kinds if kind in NODES or not of_volumes(mesh, kind, found)] or kinds
    by_kind = {kind: nodes_of(mesh, key, kind, found) for kind in kinds}
    first, *others = by_kind
    nodes = by_kind[first]
    for kind in others:
        if not np.array_equal(by_kind[kind], nodes):
            raise Refused(
                key,
                f'"{found}" ({first} of {len(nodes)} nodes and {kind} of {len(by_kind[kind])} nodes)',
                "one group of this name",
                "rename one of the two",
            )
    if len(nodes) == 0:
        raise Refused(key, f'"{found}" ({first}, empty)', "a group with nodes", EMPTY)
    return nodes


EMPTY = "check what the group encloses; Gmsh leaves all groups out of version 2.2 with Mesh.SaveAll = 1"
"""Advice for groups without members."""
NODES = ("node set", "node mask", "surface")
"""Kinds of groups that have nodes, not cells."""


def of_volumes(mesh: meshio.Mesh, kind: str, name: str) -> bool:
    """Whether a group has volumes."""
    chosen = zip(mesh.cells, cells_of(mesh, kind, name), strict=False)
    return any(dimension(block.type) == 3 and cells is not None and len(cells) for block, cells in chosen)


def nodes_of(mesh: meshio.Mesh, key: str, kind: str, name: str) -> Ints:
    """Nodes of a group of one kind, ascending."""
    match kind:
        case "node set":
            return np.unique(np.asarray(mesh.point_sets[name], dtype=np.int64))
        case "surface":
            return np.unique(np.asarray(mesh.info["surfaces"][name], dtype=np.int64))
        case "node mask":
            return inside(mesh.point_data[name])
        case "physical group":  # a surface and a volume may have the same name
            chosen = cells_of(mesh, kind, name)
            below = [cells if dimension(b.type) < 3 else None for b, cells in zip(mesh.cells, chosen, strict=True)]
            return of_cells(mesh, below if any(cells is not None and len(cells) for cells in below) else chosen, key, name)
        case _:
            return of_cells(mesh, cells_of(mesh, kind, name), key, name)


def materials(mesh: meshio.Mesh, points: Floats, hexes: Ints, names: list[str]) -> Ints:
    """The number of the material of every hexahedron, among the groups of hexahedra ``names``; nothing without names."""
    if not names:
        return np.zeros(0, dtype=np.int64)
    known = groups(mesh, nodes=False)
    remedy = (
        "name a Gmsh physical volume, an Abaqus element set of solid elements, a property of Nastran's solids, or a mask "
        "of cells that is not zero on the group"
    )
    starts = np.cumsum([0, *(len(block.data) if block.type == HEXAHEDRON else 0 for block in mesh.cells)])
    of = np.full(len(hexes), -1, dtype=np.int64)

    def place(element: int) -> str:
        return "(" + ", ".join(f"{x:g}" for x in points[hexes[element]].mean(axis=0)) + ") in the file"

    for number, name in enumerate(names):
        key = f"materials.{name}"
        found = name_in_file(known, key, name, remedy)
        inside_blocks = [
            start + np.asarray(cells, dtype=np.int64)
            for block, start, cells in zip(mesh.cells, starts, cells_of(mesh, known[found][0], found), strict=False)
            if block.type == HEXAHEDRON and cells is not None and len(cells)
        ]
        inside_group = np.unique(np.concatenate(inside_blocks)) if inside_blocks else np.zeros(0, dtype=np.int64)
        if len(inside_group) == 0:
            raise Refused(key, f'"{found}" ({known[found][0]}, no hexahedron)', "a group of hexahedra", f"{remedy}; {EMPTY}")
        twice = inside_group[of[inside_group] >= 0]
        if len(twice):
            raise Refused(
                key,
                f'"{found}" ({len(twice)} of its hexahedra are in "{names[of[twice[0]]]}" too, the first around '
                f"{place(twice[0])})",
                "groups that have no hexahedron in common",
                "give every hexahedron one material",
            )
        of[inside_group] = number
    without = np.flatnonzero(of < 0)
    if len(without):
        raise Refused(
            "materials",
            f"{len(without)} of {len(hexes)} hexahedra in none of the groups named, the first around "
            f"{place(without[0])}",
            "a material for every hexahedron",
            "add the groups that are missing; one without keys has the material of its body. The file has "
            + ", ".join(f'"{other}"' for other in sorted(known)),
        )
    return of


def used_only(points: Floats, hexes: Ints, named: dict[str, tuple[str, Ints]]) -> tuple[Floats, Ints, list[Ints]]:
    """The nodes that belong to hexahedra, numbered anew in their order; groups must have no others."""
    used = np.zeros(len(points), dtype=bool)
    used[hexes] = True
    for key, (name, nodes) in named.items():
        outside = int((~used[nodes]).sum())
        if outside:
            raise Refused(
                key,
                f'"{name}" ({outside} of its {len(nodes)} nodes belong to no hexahedron)',
                "a group of nodes of the hexahedra",
                "mesh the surface together with the volume, so that both have the same nodes, and take reference "
                "points out of the group",
            )
    number = np.cumsum(used) - 1
    return points[used], number[hexes], [number[nodes] for _, nodes in named.values()]


def collect(path: Path, contact: str, held: str, groups: list[str] | None = None) -> tuple[dict[str, Any], bytes]:
    """The line of JSON and the raw data of a file; ``groups``: those of hexahedra with a material."""
    mesh = read(path)
    points = np.asarray(mesh.points, dtype=np.float64)
    hexes = hexahedra(mesh, path.name)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise Refused(
            "mesh_file", f'"{path.name}"', "three finite coordinates a node", "write the mesh again in three dimensions"
        )
    material = materials(mesh, points, hexes, groups or [])
    surfaces = {
        "contact_surface": (contact, group(mesh, "contact_surface", contact)),
        "held_nodes": (held, group(mesh, "held_nodes", held)),
    }
    points, hexes, (contact_nodes, held_nodes) = used_only(points, hexes, surfaces)
    header = {
        "format": FORMAT,
        "nodes": len(points),
        "hexes": len(hexes),
        "contact": len(contact_nodes),
        "held": len(held_nodes),
        "groups": len(material),
    }
    integers = [np.ascontiguousarray(part, dtype="<i8").tobytes() for part in (hexes, contact_nodes, held_nodes, material)]
    return header, b"".join([np.ascontiguousarray(points, dtype="<f8").tobytes(), *integers])


def main(arguments: list[str] | None = None) -> int:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--contact", required=True, help="name of the contact surface")
    parser.add_argument("--held", required=True, help="name of the held nodes")
    parser.add_argument("--material", action="append", help="name of a group of hexahedra with a material")
    chosen = parser.parse_args(arguments)
    payload = b""
    try:
        header, payload = collect(chosen.file, chosen.contact, chosen.held, chosen.material)
    except Refused as refused:
        header = {"error": refused.message}
    except Exception as error:  # what a reader has left inconsistent is an error of the file, too
        header = {"error": unreadable(chosen.file, error).message}
    sys.stdout.buffer.write(json.dumps(header).encode() + b"\n" + payload)
    sys.stdout.buffer.flush()
    return 1 if "error" in header else 0


if __name__ == "__main__":
    sys.exit(main())
