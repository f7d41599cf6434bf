"""Reads bulk data of Nastran with meshio; what meshio leaves out in silence is refused with its line."""

import re
from pathlib import Path

import meshio
import numpy as np

from .refusal import at_line, elsewhere

GROUP = "nastran:ref"
"""What meshio calls the property of an element, and the coordinate system of a node."""
ELEMENT = re.compile(r"C(HEX|TETR|PENT|PYR|QUAD|TRI|SHEAR|RAC)[A-Z0-9]*\*?", re.IGNORECASE)
"""Cards of solids and surface elements."""
KNOWN = {
    *("CHEXA", "CTETRA", "CPENTA", "CPYRAM", "CPYRA"),
    *("CQUAD4", "CQUAD8", "CQUAD9", "CQUADR", "CTRIA3", "CTRIA6", "CTRIAR", "CSHEAR"),
}
"""Those that meshio reads."""


def check(path: Path) -> list[int]:
    """Refuses cards that would be left out; returns the lines of the nodes."""
    grids = []
    bulk = False
    with path.open(encoding="utf-8", errors="replace") as file:
        for number, line in enumerate(file, 1):
            word = re.split(r"[\s,]", line[:16].strip() + " ", maxsplit=1)[0]
            if word.upper() == "INCLUDE":
                raise elsewhere(path, f"line {number}: INCLUDE")
            bulk |= line.strip().upper().startswith("BEGIN BULK")
            if not bulk:
                continue
            if line.upper().startswith("ENDDATA"):
                break
            if word.upper().rstrip("*") == "GRID":
                grids.append(number)
            # a field of eight columns may touch the next one
            card = ELEMENT.match(line[:8].partition(",")[0].strip())
            if word.upper() == "GRDSET" or (card and card.group() not in KNOWN):
                found = card.group() if card else "GRDSET"
                raise at_line(
                    path,
                    number,
                    f"the card {found}",
                    "GRID cards, and elements in small or free fields with names in capitals (CHEXA, CQUAD4)",
                    "write these cards in another form",
                )
    return grids


def read(path: Path) -> meshio.Mesh:
    """The mesh of a file, with its properties as element sets ``PID NUMBER``."""
    grids = check(path)
    mesh = meshio.read(path, "nastran")
    systems = np.asarray(mesh.point_data.pop(GROUP, ()))
    if np.any(systems):
        first = int(np.flatnonzero(systems)[0])
        raise at_line(
            path,
            grids[first],
            f"a GRID card in the coordinate system {systems[first]}",
            "nodes in the basic coordinate system",
            "write the mesh with global coordinates",
        )
    of = mesh.cell_data.pop(GROUP, ())
    for number in sorted({int(v) for values in of for v in values}):
        mesh.cell_sets[f"PID {number}"] = [np.flatnonzero(np.asarray(values) == number) for values in of]
    return mesh
