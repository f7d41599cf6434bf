"""Reads a mesh of Gmsh (.msh, versions 2 and 4.1, as text or binary) with every element in all of its physical groups."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
from numpy.typing import NDArray

from .refusal import Refused, at_line

Ints = NDArray[np.int64]

KINDS = {
    15: ("vertex", 1),
    1: ("line", 2),
    2: ("triangle", 3),
    3: ("quad", 4),
    4: ("tetra", 4),
    5: ("hexahedron", 8),
    6: ("wedge", 6),
    7: ("pyramid", 5),
    8: ("line3", 3),
    9: ("triangle6", 6),
    10: ("quad9", 9),
    11: ("tetra10", 10),
    12: ("hexahedron27", 27),
    13: ("wedge18", 18),
    14: ("pyramid14", 14),
    16: ("quad8", 8),
    17: ("hexahedron20", 20),
    18: ("wedge15", 15),
    19: ("pyramid13", 13),
    21: ("triangle10", 10),
    26: ("line4", 4),
    29: ("tetra20", 20),
    36: ("quad16", 16),
    92: ("hexahedron64", 64),
}
"""What meshio calls the types of elements, and their numbers of nodes."""
DIMENSIONS = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2}
"""Dimension of the kinds, by the beginning of their names; all others are volumes."""
REMEDY = "write the mesh again as .msh of version 4.1 or 2.2"


class Source:
    """The bytes of a file from a place on, as text or binary."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.data = path.read_bytes()
        self.at = 0
        self.binary = False
        self.size = np.dtype("<u8")
        self._words: list[bytes] | None = None
        self._word = 0

    def line(self) -> bytes:
        """The next line."""
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        text, self.at = self.data[self.at : end], end + 1
        return text.strip()

    def number(self, at: int) -> int:
        """The number of the line that a place is in."""
        return self.data.count(b"\n", 0, at) + 1

    def refused(self, at: int, found: str, expected: str, remedy: str = REMEDY) -> Refused:
        """Refuses what stands at a place."""
        return at_line(self.path, self.number(at), found, expected, remedy)

    def section(self, name: bytes) -> bytes:
        """The text of a section from here to its end."""
        end = self.data.find(b"$End" + name, self.at)
        if end < 0:
            begins = self.data.rfind(b"$" + name, 0, self.at)
            raise self.refused(begins, f"${name.decode()} without an end", f"$End{name.decode()}")
        text = self.data[self.at : end]
        self.at = end
        self.line()
        return text

    def begin(self, name: bytes) -> None:
        """Begins to take numbers out of a section."""
        if not self.binary:
            self._words, self._word = self.section(name).split(), 0

    def take(self, kind: Any, count: int) -> NDArray[Any]:
        """The next numbers of a section."""
        count = int(count)
        if self._words is not None:
            part = self._words[self._word : self._word + count]
            self._word += count
            found = np.array(part or np.zeros(0)).astype(np.float64 if np.dtype(kind).kind == "f" else np.int64)
        else:
            kind = np.dtype(kind)
            found = np.frombuffer(self.data, kind, min(count, (len(self.data) - self.at) // kind.itemsize), self.at)
            self.at += count * kind.itemsize
        if len(found) != count:
            raise ValueError("it ends too early")
        return found

    def end(self, name: bytes) -> None:
        """Ends a section."""
        if self._words is None:
            self.section(name)
        elif self._word != len(self._words):
            raise ValueError("it has more numbers than it says")
        self._words = None


class Mesh:
    """A mesh as far as it has been read."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.names: dict[tuple[int, int], str] = {}
        """Of the physical groups, by dimension and number."""
        self.of_entity: dict[tuple[int, int], list[int]] = {}
        """Physical groups of an entity, by its dimension and number."""
        self.tags: list[Ints] = []
        self.points: list[NDArray[np.float64]] = []
        self.blocks: list[tuple[int, Ints, list[tuple[int, int]]]] = []
        """Type of the elements, their nodes by number, and their groups: dimension and number."""

    def read(self) -> None:
        """Reads all sections."""
        source, version = self.source, ""
        while source.at < len(source.data):
            start = source.at
            head = source.line()
            if not head:
                continue
            if not head.startswith(b"$"):
                raise source.refused(start, head[:40].decode(errors="replace"), "a section of a .msh file")
            name = head[1:]
            if name == b"MeshFormat":
                version = self.format(start)
                continue
            if not version:
                raise source.refused(start, head[:40].decode(errors="replace"), "$MeshFormat first")
            sections = self.old() if version.startswith("2") else self.new()
            if name == b"PartitionedEntities":
                raise source.refused(start, "$PartitionedEntities", "a mesh in one piece", "unpartition the mesh in Gmsh")
            reader = sections.get(name)
            if reader is None:
                source.section(name)
                continue
            try:
                reader(name)
            except (ValueError, OverflowError, IndexError, UnicodeDecodeError) as error:
                raise source.refused(
                    start, f"${name.decode()} cannot be read: {error}", "a section as Gmsh writes it"
                ) from None

    def format(self, start: int) -> str:
        """Version and kind of the file."""
        source = self.source
        version, kind, size = (source.line().decode(errors="replace").split() + ["", "", ""])[:3]
        known = version in ("2", "2.0", "2.1", "2.2", "4.1") or version == "4"
        if not known or kind not in ("0", "1") or size not in ("4", "8"):
            raise source.refused(start + 12, f"version {version or 'missing'}", "version 4.1 or 2.2")
        source.binary = kind == "1"
        source.size = np.dtype("<u" + size)
        if source.binary and source.take("<i4", 1)[0] != 1:
            raise source.refused(start + 12, "big-endian numbers", "little-endian numbers, or text")
        source.section(b"MeshFormat")
        return version

    def old(self) -> dict[bytes, Any]:
        """Readers of the sections of version 2."""
        return {
            b"PhysicalNames": self.physical_names,
            b"Nodes": self.old_nodes,
            b"ParametricNodes": self.old_nodes,
            b"Elements": self.old_elements,
        }

    def new(self) -> dict[bytes, Any]:
        """Readers of the sections of version 4.1."""
        return {
            b"PhysicalNames": self.physical_names,
            b"Entities": self.entities,
            b"Nodes": self.nodes,
            b"Elements": self.elements,
        }

    def physical_names(self, name: bytes) -> None:
        """Names of the groups, which are text in every file."""
        lines = [text for text in self.source.section(name).decode().splitlines() if text.strip()]
        for text in lines[1:]:
            dimension, number, quoted = text.split(maxsplit=2)
            self.names[int(dimension), int(number)] = quoted.strip().strip('"').strip()

    def entities(self, name: bytes) -> None:
        """Groups of the entities; a surface taken with the opposite side outside has a negative number of its group."""
        source = self.source
        source.begin(name)
        for dimension, count in enumerate(source.take(source.size, 4)):
            for _ in range(int(count)):
                (tag,) = source.take("<i4", 1)
                source.take("<f8", 3 if dimension == 0 else 6)
                groups = source.take("<i4", source.take(source.size, 1)[0])
                self.of_entity[dimension, int(tag)] = [abs(int(group)) for group in groups]
                if dimension:
                    source.take("<i4", source.take(source.size, 1)[0])
        source.end(name)

    def nodes(self, name: bytes) -> None:
        """Nodes of version 4.1, with their parameters on curves and surfaces left out."""
        source = self.source
        source.begin(name)
        for _ in range(int(source.take(source.size, 4)[0])):
            dimension, _, parametric = (int(v) for v in source.take("<i4", 3))
            count = int(source.take(source.size, 1)[0])
            self.tags.append(source.take(source.size, count).astype(np.int64))
            width = 3 + (dimension if parametric else 0)
            self.points.append(source.take("<f8", width * count).reshape(count, width)[:, :3])
        source.end(name)

    def elements(self, name: bytes) -> None:
        """Elements of version 4.1."""
        source = self.source
        source.begin(name)
        for _ in range(int(source.take(source.size, 4)[0])):
            dimension, entity, kind = (int(v) for v in source.take("<i4", 3))
            count = int(source.take(source.size, 1)[0])
            width = 1 + self.width(kind)
            nodes = source.take(source.size, width * count).astype(np.int64).reshape(count, width)[:, 1:]
            groups = [(dimension, group) for group in self.of_entity.get((dimension, entity), [])]
            self.blocks.append((kind, nodes, groups))
        source.end(name)

    def width(self, kind: int) -> int:
        """Number of nodes of a type of elements."""
        if kind not in KINDS:
            raise ValueError(f"elements of the type {kind}, which is not known")
        return KINDS[kind][1]

    def old_nodes(self, name: bytes) -> None:
        """Nodes of version 2, with or without parameters."""
        source = self.source
        if source.binary:
            if name != b"Nodes":
                raise ValueError("binary nodes with parameters")
            count = int(source.line())
            table = source.take(np.dtype([("tag", "<i4"), ("point", "<f8", 3)]), count)
            self.tags.append(table["tag"].astype(np.int64))
            self.points.append(table["point"])
            source.section(name)
            return
        count, *lines = source.section(name).split(b"\n")
        rows = [words[:4] for words in map(bytes.split, lines) if words]
        if len(rows) != int(count):
            raise ValueError(f"{len(rows)} nodes in place of {int(count)}")
        self.tags.append(np.array([int(row[0]) for row in rows], dtype=np.int64))
        self.points.append(np.array([[float(v) for v in row[1:]] for row in rows], dtype=float).reshape(-1, 3))

    def old_elements(self, name: bytes) -> None:
        """Elements of version 2, whose first tag is their group; an element of two groups stands there twice."""
        source = self.source
        found: dict[tuple[int, int], list[list[int]]] = {}
        if source.binary:
            count = int(source.line())
            while count > 0:
                kind, number, tags = (int(v) for v in source.take("<i4", 3))
                width = 1 + tags + self.width(kind)
                table = source.take("<i4", width * number).reshape(number, width).astype(int)
                for row in table.tolist():
                    group = abs(row[1]) if tags else 0
                    found.setdefault((kind, group), []).append(row[1 + tags :])
                count -= number
                if number <= 0:
                    raise ValueError("a block without elements")
            source.section(name)
        else:
            said, *lines = source.section(name).split(b"\n")
            rows = [[int(v) for v in words] for words in map(bytes.split, lines) if words]
            if len(rows) != int(said):
                raise ValueError(f"{len(rows)} elements in place of {int(said)}")
            for row in rows:
                kind, tags = row[1], row[2]
                nodes = row[3 + tags :]
                if len(nodes) != self.width(kind):
                    raise ValueError(f"element {row[0]} has {len(nodes)} nodes in place of {self.width(kind)}")
                found.setdefault((kind, abs(row[3]) if tags else 0), []).append(nodes)
        for (kind, group), cells in found.items():
            kind_name = KINDS[kind][0]
            dimension = next((d for start, d in DIMENSIONS.items() if kind_name.startswith(start)), 3)
            self.blocks.append((kind, np.array(cells, dtype=np.int64), [(dimension, group)] if group else []))

    def result(self) -> meshio.Mesh:
        """The mesh: one block for each kind of element, every element once, and sets of all groups with a name."""
        source = self.source
        tags = np.concatenate(self.tags) if self.tags else np.zeros(0, dtype=np.int64)
        if not len(tags) or not self.blocks:
            raise source.refused(0, "no $Nodes or no $Elements", "a mesh with nodes and elements")
        place = {tag: k for k, tag in enumerate(tags.tolist())}
        cells: list[tuple[str, Ints]] = []
        members: dict[str, list[Ints]] = {name: [] for name in self.names.values()}
        for kind in dict.fromkeys(kind for kind, _, _ in self.blocks):
            seen: dict[tuple[int, ...], int] = {}
            of: dict[str, list[int]] = {name: [] for name in members}
            for other, nodes, groups in self.blocks:
                if other != kind:
                    continue
                numbers = [seen.setdefault(tuple(row), len(seen)) for row in nodes.tolist()]
                for group in groups:
                    if group in self.names:
                        of[self.names[group]] += numbers
            missing = next((v for row in seen for v in row if v not in place), None)
            if missing is not None:
                raise source.refused(0, f"node {missing} of an element", "nodes that the file has")
            cells.append((KINDS[kind][0], np.array([[place[v] for v in row] for row in seen], dtype=np.int64)))
            for name, numbers in of.items():
                members[name].append(np.unique(np.array(numbers, dtype=np.int64)))
        mesh = meshio.Mesh(np.concatenate(self.points), cells)
        mesh.info = {"physical groups": members}
        return mesh


def read(path: Path) -> meshio.Mesh:
    """The mesh of a file; its physical groups are in ``info``: by their names, the elements of every block of cells."""
    mesh = Mesh(Source(path))
    mesh.read()
    return mesh.result()
