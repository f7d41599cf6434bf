"""Abaqus and CalculiX decks: every set whole, or refused with its line."""

from pathlib import Path

import numpy as np
import pytest

from railspring_reference.mesh_in import Refused, collect

POINTS = np.array(np.meshgrid([0.0, 1.0, 2.5], [0.0, 0.1], [0.0, 0.4], indexing="ij")).reshape(3, -1).T
"""Nodes of two bricks."""
BRICKS = ["1, 1, 5, 7, 3, 2, 6, 8, 4", "2, 5, 9, 11, 7, 6, 10, 12, 8"]
"""Their cards."""
NODES = [f"{k + 1}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in enumerate(POINTS.tolist())]
HEAD = ["*HEADING", "bricks", "*NODE", *NODES, "*ELEMENT, TYPE=C3D8, ELSET=all", *BRICKS]
"""The deck without sets; its next line is the nineteenth."""
TOP = [0, 2, 4, 6, 8, 10]
"""Nodes with z = 0, counted from zero."""
END = [0, 1, 2, 3]
"""Nodes with x = 0."""
TOP_SET = ["*NSET, NSET=top", "1, 3, 5, 7, 9, 11"]
END_SET = ["*NSET, NSET=end", "1, 2, 3, 4"]


def read(path: Path, lines: list[str], top: str = "top", end: str = "end", groups: tuple[str, ...] = ()) -> list[list[float]]:
    """Points, nodes of both names, and the group of every brick."""
    (path / "a.inp").write_text("\n".join([*lines, ""]))
    header, data = collect(path / "a.inp", top, end, list(groups))
    numbers = np.frombuffer(data[24 * header["nodes"] :], dtype="<i8")[8 * header["hexes"] :]
    parts = np.split(numbers, np.cumsum([header["contact"], header["held"]]))
    points = np.frombuffer(data[: 24 * header["nodes"]], dtype="<f8").reshape(-1, 3)
    return [points.tolist(), *(part.tolist() for part in parts)]


def refused(path: Path, lines: list[str], groups: tuple[str, ...] = ()) -> str:
    """The message about a deck."""
    with pytest.raises(Refused) as caught:
        read(path, lines, groups=groups)
    return str(caught.value)


WHOLE = {
    "two cards": [*TOP_SET, "*NSET, NSET=end", "1, 2", "*nset, nset=END", "3, 4"],
    "set of sets and numbers": [*TOP_SET, "*NSET, NSET=end", "half, 3", "4", "*NSET, NSET=half", "1, 2,"],
    "generate without increment": [*TOP_SET, "*NSET, NSET=end, GENERATE", "1, 4"],
    "two ranges": [*TOP_SET, "*NSET, NSET=end, GENERATE", "1, 3, 2", "2, 4, 2"],
    "quotes and blanks": ['*NSET, NSET="top"', "1, 3, 5, 7, 9, 11", '*NSET , nset = " end "', "** no line", "1,2,3,", "4"],
    "keyword over two lines": [*TOP_SET, "*NSET,", " NSET=end", "1, 2, 3, 4"],
    "faces": ["*SURFACE, NAME=top, TYPE=ELEMENT", "all, S1", *END_SET],
    "faces of elements, without a type": ["*SURFACE, NAME=top", "1, S1", "2, S1", *END_SET],
    "surface of nodes": [*TOP_SET, "*SURFACE, NAME=end, TYPE=NODE", "half, 1.", "3", "4", "*NSET, NSET=half", "1, 2"],
    "set of nodes and its surface": [*TOP_SET, "*SURFACE, NAME=top", "all, S1", *END_SET],
    "shells": ["*ELEMENT, TYPE=S4, ELSET=top", "3, 1, 5, 7, 3", "*ELEMENT, TYPE=S4", "4, 5, 9, 11, 7", "*ELSET, ELSET=top",
               "4", *END_SET],
    "nodes of an element set": ["*ELEMENT, TYPE=M3D4, ELSET=face", "3, 1, 2, 4, 3", "*NSET, NSET=end, ELSET=face", *TOP_SET],
}  # fmt: skip
"""Sets in forms of which some were read in part before."""


@pytest.mark.parametrize("form", WHOLE)
def test_sets_are_read_whole(form: str, tmp_path: Path) -> None:
    """Goal: the same nodes in every form."""
    points, top, end, _ = read(tmp_path, [*HEAD, *WHOLE[form]])
    assert points == POINTS.tolist()
    assert top == TOP
    assert end == END


def test_nodes_in_two_cards_are_all_read(tmp_path: Path) -> None:
    """Goal: a second *NODE card adds nodes, and names a set."""
    lines = ["*NODE, NSET=end", *NODES[:4], "*NODE", *NODES[4:], *HEAD[15:], *TOP_SET]
    points, top, end, _ = read(tmp_path, lines)
    assert (points, top, end) == (POINTS.tolist(), TOP, END)


def test_element_sets_of_several_cards_are_groups(tmp_path: Path) -> None:
    """Goal: sets of *ELEMENT and *ELSET cards of one name add up; sets of sets."""
    more = ["*ELEMENT, TYPE=C3D8, ELSET=one", BRICKS[1], *TOP_SET, *END_SET]
    lines = [*HEAD[:15], "*ELEMENT, TYPE=C3D8, ELSET=one", BRICKS[0], *more]
    assert read(tmp_path, lines, groups=("one",))[3] == [0, 0]
    lines = [*HEAD, *TOP_SET, *END_SET, "*ELSET, ELSET=b", "2", "*ELSET, ELSET=c", "b", "*ELSET, ELSET=a, GENERATE", "1, 1"]
    assert read(tmp_path, lines, groups=("c", "A"))[3] == [1, 0]


def test_parts_are_put_in_their_place(tmp_path: Path) -> None:
    """Goal: translation, then rotation by 90 degrees about the z axis: (x, y, z) to (-y - 2, x + 1, z + 3); sets of the part and of the
    assembly."""
    part = ["*PART, NAME=rail", *HEAD[2:], *TOP_SET, "*END PART"]
    instance = ["*ASSEMBLY, NAME=a", "*INSTANCE, NAME=rail-1, PART=Rail", "1., 2., 3.", "0., 0., 0., 0., 0., 1., 90.", "*END INSTANCE"]
    sets = ["*NSET, NSET=end, INSTANCE=rail-1", "1, 2", "*NSET, NSET=end", "rail-1.3, rail-1.4", "*END ASSEMBLY"]
    points, top, end, _ = read(tmp_path, [*part, *instance, *sets])
    x, y, z = POINTS.T
    assert np.allclose(points, np.transpose([-y - 2, x + 1, z + 3]), atol=1e-14)
    assert (top, end) == (TOP, END)
    assert read(tmp_path, [*part, *instance, *sets], top="rail-1.top")[1] == TOP
    assert read(tmp_path, [part[0], *HEAD[2:], *TOP_SET, *END_SET, "*END PART"])[1:3] == [TOP, END]


REFUSED = {
    "a node that is missing": (["*NSET, NSET=top", "1, 99", *END_SET], "line 20: node 99 in *NSET, which the deck does not"),
    "a range with gaps": (["*NSET, NSET=top, GENERATE", "9, 14", *END_SET], "line 20: 2 of the nodes from 9 to 14"),
    "no range": (["*NSET, NSET=top, GENERATE", "9", *END_SET], "line 20: 9 with GENERATE"),
    "an unknown set": (["*NSET, NSET=top", "1, no", *END_SET], 'line 20: "no" in *NSET, which is no node set'),
    "a set of itself": (["*NSET, NSET=top", "1, top", *END_SET], 'node set "top" that has itself'),
    "a set without a name": (["*NSET", "1"], "line 19: *NSET without NSET="),
    "two surfaces": (["*SURFACE, NAME=top", "1, S1", "*SURFACE, NAME=top", "2, S1"], 'line 21: surface "top" again'),
    "another face": (["*SURFACE, NAME=top", "1, S7", *END_SET], 'line 20: face "S7" of a hexahedron'),
    "other nodes of the same name": (
        ["*NSET, NSET=top", "1", "*SURFACE, NAME=top", "all, S1", *END_SET],
        '"top" (node set of 1 nodes and surface of 6 nodes)',
    ),
    "a node at two places": (["*NODE", "1, 5., 5., 5."], "line 20: node 1 again, at another place"),
    "an element twice": (["*ELEMENT, TYPE=C3D8", BRICKS[0]], "line 20: element 1 again"),
    "an element that is short": (["*ELEMENT, TYPE=C3D8", "3, 1, 2, 3"], "line 20: element 3 with 3 nodes"),
    "an element without a node": (["*ELEMENT, TYPE=S3", "3, 1, 2, 88"], "line 20: node 88 of element 3"),
    "an unknown type": (["*ELEMENT, TYPE=U1", "3, 1, 2"], "line 19: elements of the type U1"),
    "generated nodes": (["*NGEN", "1, 9, 2"], "line 19: *NGEN"),
    "other axes": (["*NODE, SYSTEM=C", "99, 1., 2., 3."], "line 19: SYSTEM=C"),
    "no number": (["*NODE", "99, <x>, 2., 3."], 'line 20: "<x>" in *NODE'),
    "an instance of no part": (["*INSTANCE, NAME=a, PART=b", "*END INSTANCE"], 'line 19: part "b"'),
    "an open instance": (["*INSTANCE, NAME=a"], "line 19: *INSTANCE without an end"),
}
"""Cards after the deck's elements, and what is said of them."""


@pytest.mark.parametrize("fault", REFUSED)
def test_what_cannot_be_read_is_refused_with_its_line(fault: str, tmp_path: Path) -> None:
    """Goal: the line and what stands there."""
    lines, said = REFUSED[fault]
    text = refused(tmp_path, [*HEAD, *lines])
    assert said in text and "a.inp" in text or "contact_surface" in text and said in text, text
