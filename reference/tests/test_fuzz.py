"""Mutated mesh files: whatever the bytes, they are read or refused with what a study's message needs, and in time.

A case has its number as seed. The input of a fault is kept, and its path is said. ``RAILSPRING_FUZZ_SECONDS`` is the time for each format.
"""

import io
import json
import os
import random
import signal
import sys
import tempfile
import time
from pathlib import Path

import meshio
import numpy as np
import pytest
from test_mesh_in import BRICKS, END, POINTS, TOP, masks

from railspring_reference.mesh_in import main

SECONDS = float(os.environ.get("RAILSPRING_FUZZ_SECONDS", "1"))
"""Time for each format."""
HANGS = 60
"""A case that takes longer hangs, s; it takes milliseconds."""
TOKENS = (
    b"nan inf -1 0 1e999 1e308 9223372036854775808 4294967295 -9223372036854775808 0x10 1_0 true * ** , ; = \" ' < > </ /> & $ $End $Nodes *NODE *ELEMENT "
    b"*NSET, *INCLUDE \n \r\n \t \0 \xff\xfe %s {} [] 1e-320"
).split(b" ")
"""What may stand anywhere."""


def seeds(folder: Path) -> dict[str, bytes]:
    """Two bricks with both groups in the formats that a study takes."""
    cells = [("hexahedron", BRICKS), ("quad", np.array([[0, 4, 6, 2], [4, 8, 10, 6]])), ("quad", np.array([[0, 1, 3, 2]]))]
    tags = [np.full(len(c), tag) for (_, c), tag in zip(cells, (1, 1, 2), strict=True)]
    names = {"steel": np.array([1, 3]), "top": np.array([1, 2]), "end": np.array([2, 2])}
    plain = meshio.Mesh(POINTS, cells[:1], point_data=masks())
    groups = meshio.Mesh(POINTS, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=names)
    sets = meshio.Mesh(POINTS, cells[:1], point_sets={"top": TOP, "end": END})
    meshio.write(folder / "binary.vtu", plain)
    meshio.write(folder / "text.vtu", plain, binary=False)
    meshio.write(folder / "text.vtk", plain, binary=False)
    meshio.write(folder / "text.msh", groups, file_format="gmsh22", binary=False)
    meshio.write(folder / "binary.msh", groups, file_format="gmsh22", binary=True)
    sets.write(folder / "deck.inp")
    meshio.write(folder / "deck.bdf", meshio.Mesh(POINTS, cells[:2]))
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def mutated(content: bytes, dice: random.Random) -> bytes:
    """The bytes with some changes."""
    data = bytearray(content)
    for _ in range(dice.randint(1, 6)):
        at = dice.randrange(len(data) + 1)
        match dice.randrange(7):
            case 0 if at < len(data):
                data[at] = dice.randrange(256)
            case 1 if at < len(data):
                data[at] ^= 1 << dice.randrange(8)
            case 2:
                data[at:at] = dice.choice(TOKENS)
            case 3:
                del data[at : at + dice.randint(1, 60)]
            case 4:
                data[at:at] = data[at : at + dice.randint(1, 200)] * dice.randint(1, 3)
            case 5:  # a number or a word
                end = at
                while end < len(data) and data[end : end + 1].isalnum():
                    end += 1
                data[at:end] = dice.choice(TOKENS)
            case _ if dice.random() < 0.2:
                del data[at:]
    return bytes(data)


class Answer(io.StringIO):
    """A standard output that keeps bytes."""

    def __init__(self) -> None:
        super().__init__()
        self.buffer = io.BytesIO()


def wrong(path: Path, monkeypatch: pytest.MonkeyPatch, whole: bool = False) -> str | None:
    """What is wrong with the answer on a file; nothing if it is read or, unless it has to be ``whole``, refused in words."""
    out = Answer()
    with monkeypatch.context() as patched:
        patched.setattr(sys, "stdout", out)
        try:
            code = main([str(path), "--contact", "top", "--held", "end"])
        except BaseException as error:
            return f"uncaught {type(error).__name__}: {error}"
    line, data = out.buffer.getvalue().split(b"\n", 1)
    header = json.loads(line)
    if code:
        error = header["error"]
        if whole:
            return f"refused: {error}"
        return None if set(error) == {"key", "value", "expected", "remedy"} and all(error.values()) else f"refused without a word: {error}"
    nodes, hexes, contact, held = (header[name] for name in ("nodes", "hexes", "contact", "held"))
    if len(data) != 8 * (3 * nodes + 8 * hexes + contact + held):
        return f"{len(data)} bytes for {header}"
    points = np.frombuffer(data[: 24 * nodes], dtype="<f8")
    numbers = np.frombuffer(data[24 * nodes :], dtype="<i8")
    if not np.isfinite(points).all() or numbers.min(initial=0) < 0 or numbers.max(initial=0) >= nodes:
        return "a place that is no number, or a node that is not there"
    return None


def hangs(*_: object) -> None:
    """What the alarm does."""
    raise TimeoutError(f"takes longer than {HANGS} s")


@pytest.mark.parametrize("name", ["binary.vtu", "text.vtu", "text.vtk", "text.msh", "binary.msh", "deck.inp", "deck.bdf"])
def test_mutated_files_are_read_or_refused(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Goal: no error that is not caught, no hang, no node that the file does not have; the file as it is gives an answer, too."""
    content = seeds(tmp_path)[name]
    path = tmp_path / name
    faults, number, end = [], 0, time.monotonic() + SECONDS
    alarms = hasattr(signal, "SIGALRM")
    if alarms:
        signal.signal(signal.SIGALRM, hangs)
    # meshio writes no names into a Nastran deck
    assert wrong(path, monkeypatch, whole=name != "deck.bdf") is None
    while time.monotonic() < end and len(faults) < 10:
        path.write_bytes(mutated(content, random.Random(number)))
        if alarms:
            signal.alarm(HANGS)
        if fault := wrong(path, monkeypatch):
            kept = Path(tempfile.gettempdir()) / "railspring-faults" / f"{number}-{name}"
            kept.parent.mkdir(exist_ok=True)
            kept.write_bytes(path.read_bytes())
            faults.append(f"{number}: {fault}; its input is {kept}")
        number += 1
    if alarms:
        signal.alarm(0)
    print(f"{name}: {number} cases")
    assert not faults, "\n".join(faults)
    assert number > 3
