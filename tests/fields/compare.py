"""Compares the fields of two calibrations: ``python compare.py DOWN UP``.

Both folders have the files of the same study, with the z axis down and up. Prints, as JSON, for every collection (``rail``, ``wheel``,
``contact``) the parameters and numbers of its files, and how far the files are from each other's turned by half a turn about x.
"""

import json
import sys
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np

TURN = np.diag([1.0, -1.0, -1.0])
"""Half a turn about the track."""
CORNERS = [[0, 1, 3, 4], [6, 5, 7, 2]]
"""Two corners of a hexahedron, each with its neighbours in the order of a right-handed frame."""
TENSOR = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]
"""Components of a symmetric tensor in the order of VTK."""


def entries(collection: Path) -> list[tuple[float, Path]]:
    """Parameters and files of a collection."""
    found = ElementTree.parse(collection).getroot().iter("DataSet")
    return [(float(e.get("timestep")), collection.parent / e.get("file")) for e in found]


def turned(values: np.ndarray) -> np.ndarray:
    """Scalars, vectors or symmetric tensors in the turned axes."""
    if values.ndim == 1:
        return values
    if values.shape[1] == 3:
        return values @ TURN.T
    full = np.empty((len(values), 3, 3))
    for k, (i, j) in enumerate(TENSOR):
        full[:, i, j] = full[:, j, i] = values[:, k]
    full = TURN @ full @ TURN.T
    return np.stack([full[:, i, j] for i, j in TENSOR], axis=1)


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference over the largest value."""
    largest = np.abs(a).max(initial=0.0)
    return float(np.abs(a - b).max(initial=0.0) / largest) if largest > 0.0 else float(np.abs(b).max(initial=0.0))


def smallest_volume(mesh: meshio.Mesh) -> float | None:
    """Smallest triple product of the edges at two corners of a hexahedron; none without hexahedra."""
    if "hexahedron" not in mesh.cells_dict:
        return None
    points = mesh.points[mesh.cells_dict["hexahedron"]]
    volumes = []
    for origin, *ends in CORNERS:
        a, b, c = (points[:, end] - points[:, origin] for end in ends)
        volumes.append(np.einsum("ij,ij->i", np.cross(a, b), c).min())
    return float(min(volumes))


def compare(down: Path, up: Path, stem: str) -> dict:
    """The files of one collection."""
    pairs = list(zip(entries(down / f"{stem}.pvd"), entries(up / f"{stem}.pvd"), strict=True))
    assert all(a[0] == b[0] for a, b in pairs), "the same loads"
    result = {"loads": [a[0] for a, _ in pairs], "points": [], "differences": {}, "volumes": [], "largest": {}}
    for (_, first), (_, second) in pairs:
        a, b = meshio.read(first), meshio.read(second)
        result["points"].append(len(a.points))
        result["volumes"].append([smallest_volume(a), smallest_volume(b)])
        assert [c.type for c in a.cells] == [c.type for c in b.cells]
        assert all(np.array_equal(x.data, y.data) for x, y in zip(a.cells, b.cells, strict=True))
        fields = {"points": (a.points, b.points)}
        assert sorted(a.point_data) == sorted(b.point_data)
        fields |= {name: (a.point_data[name], b.point_data[name]) for name in a.point_data}
        for name, (x, y) in fields.items():
            worst = result["differences"].get(name, 0.0)
            result["differences"][name] = max(worst, difference(turned(x), y))
            result["largest"].setdefault(name, []).append(float(np.abs(x).max(initial=0.0)))
    return result


if __name__ == "__main__":
    print(json.dumps({stem: compare(Path(sys.argv[1]), Path(sys.argv[2]), stem) for stem in ["rail", "wheel", "contact"]}))
