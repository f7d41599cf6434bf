"""Reading meshes: groups of every kind, and what is refused."""

import contextlib
import json
import struct
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from railspring_reference import mesh_in
from railspring_reference.mesh_in import Refused, collect, main

AXES = [np.array([0.0, 1.0, 2.5]), np.array([0.0, 0.1]), np.array([0.0, 1.0 / 3.0])]
"""Planes of nodes of two bricks; a third has no exact digits."""
BRICKS = np.array([[0, 4, 6, 2, 1, 5, 7, 3], [4, 8, 10, 6, 5, 9, 11, 7]])
"""Their nodes in the order of VTK."""
POINTS = np.array(np.meshgrid(*AXES, indexing="ij")).reshape(3, -1).T
TOP = np.flatnonzero(POINTS[:, 2] == 0.0)
END = np.flatnonzero(POINTS[:, 0] == 0.0)


def block(**more: Any) -> meshio.Mesh:
    """Two bricks with more data."""
    return meshio.Mesh(POINTS, [("hexahedron", BRICKS)], **more)


def answer(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Points, hexahedra and both groups out of the raw data."""
    header, data = collect(path, "top", "end")
    count = 3 * header["nodes"]
    points = np.array(struct.unpack(f"<{count}d", data[: 8 * count])).reshape(-1, 3)
    numbers = np.frombuffer(data[8 * count :], dtype="<i8")
    hexes, contact_nodes, held_nodes = np.split(numbers, np.cumsum([8 * header["hexes"], header["contact"]]))
    assert len(held_nodes) == header["held"]
    return points, hexes.reshape(-1, 8), contact_nodes, held_nodes


def refused(path: Path, contact: str = "top", held: str = "end") -> str:
    """The message about a file."""
    with pytest.raises(Refused) as caught:
        collect(path, contact, held)
    return str(caught.value)


def masks(n: int = len(POINTS)) -> dict[str, np.ndarray]:
    """Masks of the nodes of both groups."""
    return {name: np.isin(np.arange(n), nodes).astype(float) for name, nodes in (("top", TOP), ("end", END))}


def test_coordinates_and_masks_come_back_bit_for_bit(tmp_path: Path) -> None:
    """Goal: node masks of a VTU file; a value that is not a number is outside."""
    data = masks()
    data["top"][END[-1]] = np.nan
    block(point_data=data).write(tmp_path / "a.vtu")
    points, hexes, contact, held = answer(tmp_path / "a.vtu")
    assert np.array_equal(points, POINTS)
    assert np.array_equal(hexes, BRICKS)
    assert np.array_equal(contact, TOP)
    assert np.array_equal(held, END)


def test_node_sets_do_not_tell_capitals(tmp_path: Path) -> None:
    """Goal: node sets of an Abaqus file under a name in other letters."""
    block(point_sets={"TOP": TOP, "End": END}).write(tmp_path / "a.inp")
    points, _, contact, held = answer(tmp_path / "a.inp")
    assert np.array_equal(points, POINTS)
    assert np.array_equal(contact, TOP)
    assert np.array_equal(held, END)


@pytest.mark.parametrize("kind", ["physical", "mask", "elset"])
def test_groups_of_faces_give_their_nodes(kind: str, tmp_path: Path) -> None:
    """Goal: physical surfaces, masks of cells and sets of surface elements; a point that is in no brick is left out."""
    points = np.vstack([[[9.0, 9.0, 9.0]], POINTS])
    faces = [np.array([[0, 4, 6, 2], [4, 8, 10, 6]]) + 1, np.array([[0, 1, 3, 2]]) + 1]
    cells = [("hexahedron", BRICKS + 1), ("quad", faces[0]), ("quad", faces[1]), ("vertex", np.array([[0]]))]
    if kind == "physical":
        tags = [np.full(len(c), tag) for (_, c), tag in zip(cells, (1, 1, 2, 3), strict=True)]
        # the same number for the volume and for a surface: groups of different dimensions
        groups = {"steel": np.array([1, 3]), "top": np.array([1, 2]), "end": np.array([2, 2])}
        data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
        mesh = meshio.Mesh(points, cells, cell_data=data, field_data=groups)
        meshio.write(tmp_path / "a.msh", mesh, file_format="gmsh22")
        path = tmp_path / "a.msh"
    elif kind == "mask":
        on = lambda k: [np.full(len(c), float(b == k)) for b, (_, c) in enumerate(cells)]  # noqa: E731
        path = tmp_path / "a.vtu"
        meshio.Mesh(points, cells, cell_data={"top": on(1), "end": on(2)}).write(path)
    else:
        path = tmp_path / "a.inp"
        lines = ["*NODE", *(f"{k + 1}, {', '.join(map(repr, map(float, p)))}" for k, p in enumerate(points))]
        number = 0
        for (_, data_), head in zip(cells[:3], ("C3D8", "S4, ELSET=top", "S4, ELSET=end"), strict=False):
            lines.append(f"*ELEMENT, TYPE={head}")
            for cell in data_:
                number += 1
                lines.append(", ".join(str(v) for v in [number, *(cell + 1)]))
        path.write_text("\n".join([*lines, ""]))
    found, hexes, contact, held = answer(path)
    assert np.array_equal(found, POINTS)
    assert np.array_equal(hexes, BRICKS)
    assert np.array_equal(contact, TOP)
    assert np.array_equal(held, END)


def test_other_elements_are_refused_with_their_number(tmp_path: Path) -> None:
    """Goal: tetrahedra, wedges among bricks and bricks with twenty nodes, with advice how to make hexahedra."""
    path = tmp_path / "a.vtu"
    meshio.Mesh(POINTS, [("tetra", BRICKS[:, [0, 1, 3, 4]])]).write(path)
    text = refused(path)
    assert text.startswith('mesh_file = "a.vtu" (2 tetra): expected hexahedra with eight nodes only'), text
    assert "Recombine" in text and "ElementOrder = 1" in text and "C3D8" in text
    meshio.Mesh(POINTS, [("hexahedron", BRICKS[:1]), ("wedge", BRICKS[1:, :6])]).write(path)
    assert "(1 hexahedron, 1 wedge)" in refused(path)
    pairs = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]])
    corners = POINTS[BRICKS[0]]
    points = np.vstack([corners, corners[pairs].mean(axis=1)])
    meshio.Mesh(points, [("hexahedron20", np.arange(20)[None])]).write(path)
    assert "(1 hexahedron20)" in refused(path)
    meshio.Mesh(POINTS, [("quad", BRICKS[:, :4])]).write(path)
    assert "(quad, no hexahedra)" in refused(path) and "physical volume" in refused(path)


def test_names_that_cannot_be_used_are_refused(tmp_path: Path) -> None:
    """Goal: unknown, empty and unused groups, and groups of volumes."""
    path = tmp_path / "a.vtu"
    more = {"nothing": np.zeros(len(POINTS)), "vectors": np.zeros((len(POINTS), 3))}
    block(point_data=masks() | more, cell_data={"bricks": [np.ones(2)]}).write(path)
    unknown = refused(path, "Running")
    assert 'contact_surface = "Running": expected a name that the mesh file has: "bricks" (cell mask), ' in unknown
    assert '"top" (node mask)' in unknown and "vectors" not in unknown
    assert refused(path, held="nothing").startswith('held_nodes = "nothing" (node mask, empty)')
    assert refused(path, held="bricks").startswith('held_nodes = "bricks" (2 hexahedron): expected a group of nodes')
    block().write(path)
    assert "no names at all" in refused(path)
    loose = np.vstack([POINTS, [[5.0, 5.0, 5.0]]])
    sets = {"top": np.append(TOP, len(POINTS)), "end": END}
    meshio.Mesh(loose, [("hexahedron", BRICKS)], point_sets=sets).write(tmp_path / "a.inp")
    assert 'contact_surface = "top" (1 of its 7 nodes belong to no hexahedron)' in refused(tmp_path / "a.inp")


def test_files_that_cannot_be_read_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Goal: no traceback, and one line of JSON for the tool."""
    broken = {"a.msh": "$MeshFormat\n4.1 0 8\n", "a.inp": "*NODE\n1, x\n", "a.abc": "", "a.vtu": "<"}
    for name, content in broken.items():
        (tmp_path / name).write_text(content)
        text = refused(tmp_path / name)
        assert text.startswith(f'mesh_file = "{name}" (') and "\n" not in text, text
    (tmp_path / "b.inp").write_text("*INCLUDE, INPUT=other.inp\n")
    capsys.readouterr()
    assert main([str(tmp_path / "b.inp"), "--contact", "top", "--held", "end"]) == 1
    error = json.loads(capsys.readouterr().out)["error"]
    assert set(error) == {"key", "value", "expected", "remedy"}


INCLUDES = [
    "*INCLUDE, INPUT=other.inp",
    " *INCLUDE, INPUT=other.inp",
    "\t*include ,input = other.inp",
    "*Include,Input=other.inp",
    "* INCLUDE, INPUT=other.inp",
    "*INCLUDE,\nINPUT=other.inp",
    "*INCLUDE=other.inp",
    "*NSET, NSET=top, INPUT=other.inp",
]
"""Lines that Abaqus or another reader may follow into another file."""


@pytest.mark.parametrize("line", INCLUDES)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_included_decks_are_refused_in_every_spelling(line: str, end: str, tmp_path: Path) -> None:
    """Goal: no deck is read with parts of another, which the hash of the study would not see; the line is named."""
    block(point_sets={"top": TOP, "end": END}).write(tmp_path / "other.inp")
    (tmp_path / "a.inp").write_bytes(f"*HEADING\nrail\n{line}\n".replace("\n", end).encode())
    text = refused(tmp_path / "a.inp")
    assert '"a.inp" (line 3: *' in text and "expected a file that has the whole mesh" in text, text


def test_no_other_file_is_opened(tmp_path: Path) -> None:
    """Goal: the opening of another file itself is refused, with a reader of two files (TetGen); afterwards files can be
    opened again."""
    (tmp_path / "b.node").write_text("1 3 0 0\n1 0 0 0\n")
    (tmp_path / "b.ele").write_text("0 4 0\n")
    assert '"b.node" (b.ele): expected' in refused(tmp_path / "b.node")
    assert (tmp_path / "b.ele").read_text()


def test_a_reader_that_goes_on_without_the_other_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Goal: a refused opening counts even where the reader catches it."""
    path = tmp_path / "a.vtu"
    block(point_data=masks()).write(path)
    plain = meshio.read

    def tolerant(file: Path) -> meshio.Mesh:
        with contextlib.suppress(Exception):
            (tmp_path / "more.dat").open("rb")
        return plain(file)

    assert answer(path)[0].shape == POINTS.shape
    monkeypatch.setattr(meshio, "read", tolerant)
    assert '"a.vtu" (more.dat): expected a file that has the whole mesh' in refused(path)


def test_files_that_may_refer_to_others_are_refused(tmp_path: Path) -> None:
    """Goal: XDMF by its ending and HDF5 by its first bytes, whatever their content."""
    for name, content in {"a.xdmf": b"<Xdmf/>", "a.med": mesh_in.HDF5 + b"...", "a.cgns": mesh_in.HDF5}.items():
        (tmp_path / name).write_bytes(content)
        text = refused(tmp_path / name)
        assert text.startswith(f'mesh_file = "{name}" (') and "expected a file that has the whole mesh" in text, text


@pytest.mark.parametrize("kind", ["physical", "mask", "elset"])
def test_groups_of_hexahedra_have_materials(kind: str, tmp_path: Path) -> None:
    """Goal: the number of every brick's material, in the order asked for, from physical volumes, masks of cells and
    element sets, with other cells before and between the bricks."""
    faces = np.array([[0, 4, 6, 2], [0, 1, 3, 2]])
    cells = [("quad", faces[:1]), ("hexahedron", BRICKS[1:]), ("quad", faces[1:]), ("hexahedron", BRICKS[:1])]
    data = {name: [np.full(len(c), float(b == k)) for b, (_, c) in enumerate(cells)] for name, k in
            (("top", 0), ("end", 2), ("rubber", 1), ("steel", 3))}
    path = tmp_path / "a.vtu"
    if kind == "physical":
        path = tmp_path / "a.msh"
        tags = [np.full(len(c), tag) for (_, c), tag in zip(cells, (1, 1, 2, 2), strict=True)]
        groups = {n: np.array(v) for n, v in
                  (("top", (1, 2)), ("rubber", (1, 3)), ("end", (2, 2)), ("steel", (2, 3)))}
        mesh = meshio.Mesh(POINTS, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=groups)
        meshio.write(path, mesh, file_format="gmsh22")
    elif kind == "mask":
        meshio.Mesh(POINTS, cells, cell_data=data).write(path)
    else:
        path = tmp_path / "a.inp"
        lines = ["*NODE", *(f"{k + 1}, {', '.join(map(repr, map(float, p)))}" for k, p in enumerate(POINTS))]
        number = 0
        heads = ("S4, ELSET=top", "C3D8, ELSET=Rubber", "S4, ELSET=end", "C3D8, ELSET=steel")
        for (_, block_), head in zip(cells, heads, strict=True):
            lines.append(f"*ELEMENT, TYPE={head}")
            for cell in block_:
                number += 1
                lines.append(", ".join(str(v) for v in [number, *(cell + 1)]))
        path.write_text("\n".join([*lines, ""]))
    for names in (["rubber", "steel"], ["steel", "rubber"]):
        header, raw = collect(path, "top", "end", names)
        assert header["groups"] == 2
        assert np.frombuffer(raw[-16:], dtype="<i8").tolist() == [names.index("rubber"), names.index("steel")]
    header, _ = collect(path, "top", "end")
    assert header["groups"] == 0


def test_groups_that_are_no_materials_are_refused(tmp_path: Path) -> None:
    """Goal: unknown names, groups of nodes or faces, bricks in two groups and in none, with name, number and place."""
    path = tmp_path / "a.vtu"
    data = {"one": [np.array([1.0, 0.0])], "two": [np.array([0.0, 1.0])], "both": [np.ones(2)]}
    block(point_data=masks(), cell_data=data).write(path)

    def said(*names: str) -> str:
        with pytest.raises(Refused) as caught:
            collect(path, "top", "end", list(names))
        return str(caught.value)

    unknown = said("one", "three")
    assert unknown.startswith('materials.three = "three": expected a name that the mesh file has: "both" (cell mask), ')
    assert "top" not in unknown, "a mask of nodes has no hexahedra"
    twice = said("one", "both")
    assert twice.startswith('materials.both = "both" (1 of its hexahedra are in "one" too, the first around (0.5, '), twice
    without = said("one")
    assert without.startswith("materials = 1 of 2 hexahedra in none of the groups named, the first around (1.75, "), without
    assert '"both", "one", "two"' in without
    cells = [("hexahedron", BRICKS), ("quad", np.array([[0, 4, 6, 2]]))]
    faces = {"face": [np.zeros(2), np.ones(1)], "all": [np.ones(2), np.zeros(1)]}
    meshio.Mesh(POINTS, cells, point_data=masks(), cell_data=faces).write(path)
    assert said("all", "face").startswith('materials.face = "face" (cell mask, no hexahedron)')


@pytest.mark.parametrize(("wrong", "what"), [(-1, "node number -1"), (8, "node number 8")])
def test_numbers_of_no_node_are_refused(wrong: int, what: str) -> None:
    """Source: a cube with one node number that is none. Goal: it is refused with the number and the count of the nodes, in a cell and in a set of nodes; numpy takes
    -1 for the last node without a word."""
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    nodes = np.array([[0, 2, 3, 1, 4, 6, 7, 5]])
    sound = meshio.Mesh(cube, [("hexahedron", nodes)], point_sets={"top": np.array([1, 3])})
    mesh_in.numbered(sound, Path("a.vtu"))
    of_cell = nodes.copy()
    of_cell[0, 3] = wrong
    for mesh in (
        meshio.Mesh(cube, [("hexahedron", of_cell)]),
        meshio.Mesh(cube, [("hexahedron", nodes)], point_sets={"top": np.array([1, wrong])}),
    ):
        with pytest.raises(Refused) as refused:
            mesh_in.numbered(mesh, Path("a.vtu"))
        said = str(refused.value.message)
        assert what in said and "8 nodes" in said
