"""Meshes of Gmsh and Nastran: every element in all of its groups."""

from pathlib import Path

import numpy as np
import pytest

from railspring_reference.mesh_in import Refused, collect

POINTS = np.array(np.meshgrid([0.0, 1.0, 2.5], [0.0, 0.1], [0.0, 0.4], indexing="ij")).reshape(3, -1).T
"""Nodes of two bricks."""
BRICKS = [[1, 5, 7, 3, 2, 6, 8, 4], [5, 9, 11, 7, 6, 10, 12, 8]]
TOPS = [[1, 5, 7, 3], [5, 9, 11, 7]]
"""Their faces with z = 0."""
ENDS = [[1, 2, 4, 3]]
"""The face with x = 0."""
NAMES = ["$PhysicalNames", "4", '2 7 "top"', '2 8 "half"', '2 9 "end"', '3 7 "top"', "$EndPhysicalNames"]
"""Groups of which a surface and a volume have one name."""


def read(path: Path, contact: str = "top", groups: tuple[str, ...] = ()) -> tuple[list[int], list[int], list[int]]:
    """Nodes of the contact surface and of the held nodes, and the group of every brick."""
    header, data = collect(path, contact, "end", list(groups))
    numbers = np.frombuffer(data[24 * header["nodes"] :], dtype="<i8")[8 * header["hexes"] :]
    parts = np.split(numbers, np.cumsum([header["contact"], header["held"]]))
    assert np.array_equal(np.frombuffer(data[: 24 * header["nodes"]], dtype="<f8").reshape(-1, 3), POINTS)
    return tuple(part.tolist() for part in parts)  # type: ignore[return-value]


def words(*values: object) -> str:
    """Values with blanks between them."""
    return " ".join(map(str, values))


def new(parametric: bool) -> list[str]:
    """Version 4.1: a surface in two groups, one of them with the other side outside; a curve in none."""
    box = "0 0 0 1 1 1"
    surfaces = [f"1 {box} 1 7 0", f"2 {box} 2 -7 8 0", f"3 {box} 1 9 0"]
    entities = ["$Entities", "0 1 3 1", f"1 {box} 0 0", *surfaces, f"1 {box} 1 7 0", "$EndEntities"]
    half = [words(*p, *([0.5, 0.5] if parametric else [])) for p in POINTS[:4].tolist()]
    nodes = ["$Nodes", "2 12 1 12", f"2 3 {int(parametric)} 4", "1", "2", "3", "4", *half]
    nodes += ["3 1 0 8", *map(str, range(5, 13)), *(words(*p) for p in POINTS[4:].tolist()), "$EndNodes"]
    elements = ["$Elements", "5 6 1 6", "1 1 1 1", "1 1 5", "2 1 3 1", words(2, *TOPS[0]), "2 2 3 1", words(3, *TOPS[1])]
    elements += ["2 3 3 1", words(4, *ENDS[0]), "3 1 5 2", *(words(5 + k, *b) for k, b in enumerate(BRICKS)), "$EndElements"]
    return ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", *NAMES, *entities, *nodes, *elements, ""]


def old(parametric: bool) -> list[str]:
    """Version 2.2: the face in two groups stands there twice."""
    name = "ParametricNodes" if parametric else "Nodes"
    more = [2, 3, 0.5, 0.5] if parametric else []
    nodes = [f"${name}", "12", *(words(k + 1, *p, *more) for k, p in enumerate(POINTS.tolist())), f"$End{name}"]
    faces = [(7, TOPS[0]), (7, TOPS[1]), (8, TOPS[1]), (9, ENDS[0])]
    rows = [words(k + 1, 3, 2, group, 1, *face) for k, (group, face) in enumerate(faces)]
    rows += [words(k + 5, 5, 2, 7, 1, *brick) for k, brick in enumerate(BRICKS)]
    return ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", *NAMES, *nodes, "$Elements", "6", *rows, "$EndElements", ""]


@pytest.mark.parametrize("version", [new, old])
@pytest.mark.parametrize("parametric", [False, True])
def test_a_surface_may_be_in_two_groups(version: object, parametric: bool, tmp_path: Path) -> None:
    """Goal: both groups are whole, with either side outside; a volume of the same name is a material; parameters of the nodes on a surface
    are no coordinates."""
    path = tmp_path / "a.msh"
    path.write_text("\n".join(version(parametric)))  # type: ignore[operator]
    assert read(path, groups=("top",)) == ([0, 2, 4, 6, 8, 10], [0, 1, 2, 3], [0, 0])
    assert read(path, "half")[0] == [4, 6, 8, 10]


FAULTS = [
    (new, "4.1 0 8", "4.0 0 8", "line 2: version 4.0"),
    (new, "$EndElements", "", "$Elements without an end"),
    (new, "5 6 1 6", "6 6 1 6", "line 48: $Elements cannot be read: it ends too early"),
    (new, "3 1 5 2", "3 1 77 2", "elements of the type 77"),
    (old, "1 3 2 7 1 1 5 7 3", "1 3 2 7 1 1 5 7", "line 26: $Elements cannot be read: element 1 has 3 nodes"),
    (old, "1 3 2 7 1 1 5 7 3", "1 3 2 7 1 1 5 7 33", "node 33 of an element"),
]


@pytest.mark.parametrize("fault", range(len(FAULTS)))
def test_broken_files_are_refused_with_their_line(fault: int, tmp_path: Path) -> None:
    """Goal: the line of the section and what is wrong."""
    version, right, wrong, said = FAULTS[fault]
    text = "\n".join(version(False))
    assert right in text
    (tmp_path / "a.msh").write_text(text.replace(right, wrong, 1))
    with pytest.raises(Refused) as caught:
        read(tmp_path / "a.msh")
    assert said in str(caught.value), caught.value


def bulk(system: str = "") -> str:
    """The bricks as bulk data of Nastran in free format."""
    lines = ["CEND", "BEGIN BULK", *(f"GRID,{k + 1},{system},{x},{y},{z}" for k, (x, y, z) in enumerate(POINTS.tolist()))]
    faces = [(3, TOPS[0]), (3, TOPS[1]), (4, ENDS[0])]
    lines += [f"CQUAD4,{k + 1},{group},{','.join(map(str, face))}" for k, (group, face) in enumerate(faces)]
    for k, brick in enumerate(BRICKS):
        lines += [f"CHEXA,{k + 10},{k + 1},{','.join(map(str, brick[:6]))},+", f"+,{brick[6]},{brick[7]}"]
    return "\n".join([*lines, "ENDDATA", ""])


def test_properties_of_nastran_are_groups(tmp_path: Path) -> None:
    """Goal: a property of surface elements as contact surface, and properties of solids as materials; other coordinate systems are
    refused."""
    path = tmp_path / "a.bdf"
    path.write_text(bulk())
    header, data = collect(path, "PID 3", "PID 4", ["PID 2", "PID 1"])
    numbers = np.frombuffer(data[24 * header["nodes"] + 64 * header["hexes"] :], dtype="<i8").tolist()
    assert numbers == [0, 2, 4, 6, 8, 10, 0, 1, 2, 3, 1, 0]
    other = {
        "line 3: a GRID card in the coordinate system 5": bulk("5"),
        "line 15: INCLUDE": bulk().replace("CQUAD4,1", "INCLUDE 'more.bdf'\nCQUAD4,1"),
        r"line 18: the card CHEXA\*": bulk().replace("CHEXA,10", "CHEXA*,10"),
        "line 3: the card GRDSET": bulk().replace("GRID,1,", "GRDSET,,5\nGRID,1,"),
    }
    for said, text in other.items():
        path.write_text(text)
        with pytest.raises(Refused, match=said):
            collect(path, "PID 3", "PID 4")
