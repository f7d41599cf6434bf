"""Reads an Abaqus or CalculiX deck: nodes, elements, sets and surfaces, each whole or refused with its line.

Cards of one name add up, as both programs have it; sets may name other sets. What is generated, included or given in
other axes is refused. Everything else (materials, steps, loads) is left alone.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from numpy.typing import NDArray

from .abaqus_cards import Card, cards
from .refusal import at_line, elsewhere

Ints = NDArray[np.int64]

KINDS = [
    (r"(C3D8|DC3D8|AC3D8|F3D8)[A-Z]*", "hexahedron", 8),
    (r"(C3D20|DC3D20)[A-Z]*", "hexahedron20", 20),
    (r"C3D27[A-Z]*", "hexahedron27", 27),
    (r"(C3D4|DC3D4)[A-Z]*", "tetra", 4),
    (r"(C3D10|DC3D10)[A-Z]*", "tetra10", 10),
    (r"(C3D6|DC3D6)[A-Z]*", "wedge", 6),
    (r"(C3D15|DC3D15)[A-Z]*", "wedge15", 15),
    (r"C3D5[A-Z]*", "pyramid", 5),
    (r"(S|STRI|M3D|R3D|SFM3D|DS|CPS|CPE|CAX)3[A-Z]*", "triangle", 3),
    (r"(S|M3D|R3D|SFM3D|DS|CPS|CPE|CAX)4[A-Z0-9]*", "quad", 4),
    (r"(S|STRI|M3D|SFM3D|DS|CPS|CPE|CAX)6[A-Z0-9]*", "triangle6", 6),
    (r"(S|M3D|SFM3D|DS|CPS|CPE|CAX)8[A-Z0-9]*", "quad8", 8),
    (r"(B|T|PIPE|FRAME)[23].*|SPRING.*|DASHPOT.*|GAP.*|CONN.*|MASS|ROTARYI|HEATCAP|D|JOINTC|RB3D2|R3D2", "line", 0),
]
"""Types of elements, what meshio calls them, and their nodes; lines and points are of no use here."""
FACES = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
"""Nodes of the faces S1 to S6 of a hexahedron."""
GENERATED = {"NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY"}
"""Cards that make nodes and elements out of others."""


@dataclass
class Member:
    """An entry of a set or surface: what it says, on which line of which card."""

    card: Card
    line: int
    fields: list[str]


@dataclass
class Scope:
    """What one part, instance or assembly has: elements by number, and the cards of its sets."""

    name: str = ""
    nodes: dict[int, int] = field(default_factory=dict)
    """Place of a node among all, by its number."""
    elements: dict[int, int] = field(default_factory=dict)
    """The same of an element."""
    sets: dict[str, dict[str, list[Member]]] = field(
        default_factory=lambda: {"node set": {}, "element set": {}, "surface": {}}
    )
    spelled: dict[str, str] = field(default_factory=dict)
    """Names as the deck writes them first."""
    inner: "dict[str, Scope]" = field(default_factory=dict)
    """Instances of the assembly."""

    def of(self, kind: str, name: str) -> list[Member]:
        """The entries of a set, to be added to."""
        key = name.casefold()
        self.spelled.setdefault(key, name)
        return self.sets[kind].setdefault(key, [])


class Lazy(Mapping[str, Any]):
    """Values by names that are worked out when they are asked for: a set that nobody names need not be sound."""

    def __init__(self, makers: dict[str, Callable[[], Any]]) -> None:
        self._makers = makers

    def __getitem__(self, name: str) -> Any:
        return self._makers[name]()

    def __iter__(self) -> Iterator[str]:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)


class Deck:
    """A deck as far as it has been read."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.points: list[list[float]] = []
        self.kinds: list[str] = []
        self.cells: list[list[int]] = []
        self.top = Scope()
        self.parts: dict[str, list[Card]] = {}
        self._faces: dict[frozenset[int], int] | None = None

    def read(self) -> None:
        """Reads the whole deck."""
        part: list[Card] | None = None
        instance: tuple[Card, list[Card]] | None = None
        for card in cards(self.path):
            word = card.keyword.partition("=")[0]
            if word.startswith("INCLUDE") or "INPUT" in card.parameters:
                raise elsewhere(self.path, f"line {card.line}: *{card.keyword}")
            if word in GENERATED:
                raise card.refused(
                    f"*{word}", "nodes and elements that are written out", "write the mesh with all nodes and elements"
                )
            if word == "SYSTEM" and card.data:
                raise card.refused(
                    "*SYSTEM", "nodes in the axes of the deck", "write the nodes in global Cartesian coordinates"
                )
            if word == "PART":
                part = self.parts.setdefault(card.name("NAME").casefold(), [])
            elif word == "END PART":
                part = None
            elif word == "INSTANCE":
                instance = (card, [])
            elif word == "END INSTANCE" and instance:
                self.instantiate(*instance)
                instance = None
            elif instance:
                instance[1].append(card)
            elif part is not None:
                part.append(card)
            else:
                self.take(self.top, card)
        if instance:
            raise instance[0].refused("*INSTANCE without an end", "*END INSTANCE", "write the deck again")
        if self.parts and not self.top.inner:
            # CalculiX and others know parts without an assembly: the body is where its part is
            for name, of_part in self.parts.items():
                scope = self.top.inner[name] = Scope(name)
                for card in of_part:
                    self.take(scope, card)

    def take(self, scope: Scope, card: Card) -> None:
        """Takes what a card adds to a scope."""
        match card.keyword:
            case "NODE":
                self.nodes(scope, card)
            case "ELEMENT":
                self.elements(scope, card)
            case "NSET":
                members = scope.of("node set", card.name("NSET"))
                members.extend(Member(card, line, entry) for line, entry in card.data)
                if "ELSET" in card.parameters:
                    members.append(Member(card, card.line, []))
            case "ELSET":
                members = scope.of("element set", card.name("ELSET"))
                members.extend(Member(card, line, entry) for line, entry in card.data)
            case "SURFACE":
                name = card.name("NAME")
                members = scope.of("surface", name)
                if members:
                    raise card.refused(
                        f'surface "{name}" again, after line {members[0].card.line}',
                        "one *SURFACE card for each name",
                        "put the faces of both cards under one",
                    )
                members.extend(Member(card, line, entry) for line, entry in card.data)

    def nodes(self, scope: Scope, card: Card) -> None:
        """The nodes of a card."""
        if card.parameters.get("SYSTEM", "R").upper() != "R":
            raise card.refused(
                f"SYSTEM={card.parameters['SYSTEM']}", "Cartesian coordinates", "write the nodes in Cartesian coordinates"
            )
        numbers = []
        for line, entry in card.data:
            number = card.whole(line, entry[0])
            point = [card.real(line, text) for text in (entry[1:4] + ["", "", ""])[:3]]
            known = scope.nodes.get(number)
            if known is None:
                scope.nodes[number] = len(self.points)
                self.points.append(point)
            elif self.points[known] != point:
                raise card.refused(
                    f"node {number} again, at another place", "one place for every node", "number the nodes anew", line
                )
            numbers.append(Member(card, line, [str(number)]))
        if "NSET" in card.parameters:
            scope.of("node set", card.name("NSET")).extend(numbers)

    def elements(self, scope: Scope, card: Card) -> None:
        """The elements of a card."""
        type_ = card.name("TYPE").upper()
        found = next(((kind, n) for pattern, kind, n in KINDS if re.fullmatch(pattern, type_)), None)
        if found is None:
            raise card.refused(
                f"elements of the type {type_}",
                "hexahedra with eight nodes (C3D8), surface elements, springs, beams or points",
                "leave these elements out of the file, or mesh their part with C3D8",
            )
        kind, count = found
        numbers: list[Member] = []
        entry: list[str] = []
        begin = 0
        for line, more in card.data:
            begin = begin if entry else line
            # an empty field at the end says that the element goes on
            entry += more[:-1] if more[-1] == "" else more
            if len(entry) - 1 < count or (count == 0 and more[-1] == ""):
                continue
            self.element(scope, card, begin, entry, (kind, count or len(entry) - 1, type_))
            numbers.append(Member(card, begin, [entry[0]]))
            entry = []
        if entry:
            self.short(card, begin, entry, count, type_)
        if "ELSET" in card.parameters:
            scope.of("element set", card.name("ELSET")).extend(numbers)

    def short(self, card: Card, line: int, entry: list[str], count: int, type_: str) -> None:
        """Refuses an element with another number of nodes than its type has."""
        raise card.refused(
            f"element {entry[0]} with {len(entry) - 1} nodes",
            f"{count} nodes of a {type_}",
            "write the element with all its nodes",
            line,
        )

    def element(self, scope: Scope, card: Card, line: int, entry: list[str], of: tuple[str, int, str]) -> None:
        """One element."""
        kind, count, type_ = of
        if len(entry) - 1 != count:
            self.short(card, line, entry, count, type_)
        number, *corners = (card.whole(line, text) for text in entry)
        if number in scope.elements:
            raise card.refused(
                f"element {number} again", "one element for every number", "number the elements anew", line
            )
        if kind == "line":
            corners = []
        missing = next((v for v in corners if v not in scope.nodes), None)
        if missing is not None:
            raise card.refused(
                f"node {missing} of element {number}, which no *NODE card before it has",
                "nodes that the deck has",
                "put the *NODE cards before the elements, and write them all into the file",
                line,
            )
        scope.elements[number] = len(self.cells)
        self.kinds.append(kind)
        self.cells.append([scope.nodes[v] for v in corners])

    def instantiate(self, card: Card, own: list[Card]) -> None:
        """Puts a part into the assembly."""
        name = card.name("NAME")
        part = card.parameters.get("PART")
        if part is not None and part.casefold() not in self.parts:
            raise card.refused(f'part "{part}"', "a part that stands before the assembly", "write the part into the file")
        scope = self.top.inner[name.casefold()] = Scope(name)
        begin = len(self.points)
        for each in [*(self.parts[part.casefold()] if part else []), *own]:
            self.take(scope, each)
        if len(card.data) > 2:
            raise card.refused(
                "an instance with more than two data lines", "its translation and its rotation", "write the deck again"
            )
        points = np.array(self.points[begin:], dtype=float).reshape(-1, 3)
        for count, (line, entry) in zip((3, 7), card.data, strict=False):
            values = np.array([card.real(line, text) for text in entry if text != "" or count == 3])
            values = np.append(values, np.zeros(max(0, 3 - len(values)))) if count == 3 else values
            if len(values) != count:
                raise card.refused(
                    f"{len(values)} numbers for the place of the instance", f"{count} numbers", "write the deck again", line
                )
            points = points + values if count == 3 else turned(points, values)
        self.points[begin:] = points.tolist()

    def scope(self, top: Scope, member: Member) -> Scope:
        """The scope that the entries of a set are of."""
        instance = member.card.parameters.get("INSTANCE")
        if instance is None:
            return top
        found = top.inner.get(instance.casefold())
        if found is None:
            raise member.card.refused(f'instance "{instance}"', "an instance of the assembly", "name one that the deck has")
        return found

    def entry(self, scope: Scope, member: Member, text: str) -> tuple[Scope, str]:
        """The scope of an entry, which may be that of an instance (``INSTANCE.NAME``), and what it is there."""
        instance, dot, rest = text.partition(".")
        inner = self.scope(scope, member)
        if dot and instance.casefold() in inner.inner:
            return inner.inner[instance.casefold()], rest
        return inner, text

    def numbers(self, scope: Scope, kind: str, name: str, around: tuple[Any, ...] = ()) -> list[int]:
        """The nodes of a node set, or the elements of an element set, by their places among all."""
        here = (id(scope), kind, name.casefold())
        members = scope.sets[kind][name.casefold()]
        if here in around:
            raise members[0].card.refused(f'{kind} "{name}" that has itself', "sets of others", "write the set out")
        found: list[int] = []
        for member in members:
            if member.card.keyword == "NSET" and not member.fields:
                inner = self.scope(scope, member)
                cells = self.named(inner, member, "element set", member.card.name("ELSET"), (*around, here))
                found += (v for e in cells for v in self.cells[e])
            elif "GENERATE" in member.card.parameters:
                found += self.generated(scope, kind, member)
            else:
                for text in member.fields:
                    if text:
                        found += self.named(scope, member, kind, text, (*around, here))
        return found

    def named(self, scope: Scope, member: Member, kind: str, text: str, around: tuple[Any, ...] = ()) -> list[int]:
        """What an entry names: a number, or another set."""
        scope, text = self.entry(scope, member, text)
        known = scope.nodes if kind == "node set" else scope.elements
        what = kind.partition(" ")[0]
        if re.fullmatch(r"[+-]?\d+", text):
            if int(text) in known:
                return [known[int(text)]]
            found = f"{what} {text} in *{member.card.keyword}, which the deck does not have"
        elif text.casefold() in scope.sets[kind]:
            return self.numbers(scope, kind, text, around)
        else:
            found = f'"{text}" in *{member.card.keyword}, which is no {kind} of the deck'
        raise member.card.refused(
            found, f"{what} numbers and {kind}s of the deck", "correct the entry, or write what it names into the file",
            member.line,
        )

    def generated(self, scope: Scope, kind: str, member: Member) -> list[int]:
        """The numbers of a range: first, last and step."""
        card, line = member.card, member.line
        entry = [text for text in member.fields if text]
        values = [card.whole(line, text) for text in entry]
        if len(values) not in (2, 3) or (len(values) == 3 and values[2] <= 0) or values[1] < values[0]:
            raise card.refused(
                ", ".join(entry) + " with GENERATE", "first number, last number and increment", "correct the range", line
            )
        first, last, step = (*values, 1)[:3]
        inner = self.scope(scope, member)
        known = inner.nodes if kind == "node set" else inner.elements
        found = [known[v] for v in range(first, last + 1, step) if v in known]
        if len(found) != len(range(first, last + 1, step)):
            what = kind.partition(" ")[0]
            raise card.refused(
                f"{len(range(first, last + 1, step)) - len(found)} of the {what}s from {first} to {last} are not in the deck",
                f"a range of {what}s that the deck has",
                "correct the range, or write the numbers out",
                line,
            )
        return found

    def surface(self, scope: Scope, name: str) -> list[int]:
        """The nodes of a surface."""
        members = scope.sets["surface"][name.casefold()]
        found: list[int] = []
        for member in members:
            card, line = member.card, member.line
            kind = card.parameters.get("TYPE", "ELEMENT").upper()
            if kind not in ("ELEMENT", "NODE") or {"COMBINE", "CROP"} & set(card.parameters):
                raise card.refused(
                    f'surface "{name}" of another form', "*SURFACE, TYPE=ELEMENT or TYPE=NODE", "name a node set"
                )
            if kind == "NODE":
                found += self.named(scope, member, "node set", member.fields[0])
                continue
            cells = self.named(scope, member, "element set", member.fields[0])
            side = (member.fields + [""])[1].upper()
            for e in cells:
                found += self.face(card, line, e, side)
        return found

    def face(self, card: Card, line: int, element: int, side: str) -> list[int]:
        """The nodes of a face of an element; without a side those of all its outer faces."""
        nodes, kind = self.cells[element], self.kinds[element]
        if kind[:4] in ("quad", "tria") and side in ("", "SPOS", "SNEG"):
            return nodes
        if kind == "hexahedron" and re.fullmatch("S[1-6]", side):
            return [nodes[k] for k in FACES[int(side[1]) - 1]]
        if kind == "hexahedron" and side == "":
            if self._faces is None:
                self._faces = {}
                for other, of in zip(self.cells, self.kinds, strict=True):
                    for corners in FACES if of == "hexahedron" else ():
                        face = frozenset(other[k] for k in corners)
                        self._faces[face] = self._faces.get(face, 0) + 1
            faces = (frozenset(nodes[k] for k in corners) for corners in FACES)
            return [v for face in faces if self._faces[face] == 1 for v in face]
        raise card.refused(
            f'face "{side}" of a {kind}', "faces S1 to S6 of hexahedra, or shells", "correct the *SURFACE card", line
        )

    def named_sets(self, kind: str) -> dict[str, Callable[[], Ints]]:
        """The sets of a kind: by their names in the assembly or in a flat deck, by ``INSTANCE.NAME``, and by the name
        alone where one instance has it and the assembly has not."""
        work = self.surface if kind == "surface" else lambda scope, key: self.numbers(scope, kind, key)

        def maker(scope: Scope, key: str) -> Callable[[], Ints]:
            return lambda: np.unique(np.array(work(scope, key), dtype=np.int64))

        found = {self.top.spelled[key]: maker(self.top, key) for key in self.top.sets[kind]}
        taken: dict[str, list[tuple[Scope, str]]] = {}
        for scope in self.top.inner.values():
            for key in scope.sets[kind]:
                found[f"{scope.name}.{scope.spelled[key]}"] = maker(scope, key)
                taken.setdefault(key, []).append((scope, key))
        for key, owners in taken.items():
            if len(owners) == 1 and key not in self.top.sets[kind]:
                scope, _ = owners[0]
                found[scope.spelled[key]] = maker(scope, key)
        return found


def turned(points: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points turned about the axis through two points, by an angle in degrees (formula of Rodrigues)."""
    start, axis, angle = values[:3], values[3:6] - values[:3], np.radians(values[6])
    axis = axis / np.linalg.norm(axis)
    arm = points - start
    along = np.outer(arm @ axis, axis)
    return start + along + np.cos(angle) * (arm - along) + np.sin(angle) * np.cross(axis, arm)


def read(path: Path) -> meshio.Mesh:
    """The mesh of a deck; its surfaces are in ``info``, by their names."""
    deck = Deck(path)
    deck.read()
    if not deck.points:
        raise at_line(path, 1, "no *NODE card", "an Abaqus or CalculiX deck with nodes and elements", "check the file")
    # blocks of one kind, in the order in which the kinds come first
    kinds = list(dict.fromkeys(kind for kind in deck.kinds if kind != "line"))
    of = np.array([kinds.index(kind) if kind != "line" else -1 for kind in deck.kinds], dtype=np.int64)
    place = np.zeros(len(of), dtype=np.int64)
    blocks = []
    for k, kind in enumerate(kinds):
        members = np.flatnonzero(of == k)
        place[members] = np.arange(len(members))
        blocks.append((kind, np.array([deck.cells[e] for e in members], dtype=np.int64)))
    mesh = meshio.Mesh(np.array(deck.points, dtype=float), blocks)

    def by_block(make: Callable[[], Ints]) -> Callable[[], list[Ints]]:
        def blocks_of() -> list[Ints]:
            cells = make()
            return [place[cells[of[cells] == k]] for k in range(len(kinds))]

        return blocks_of

    mesh.point_sets = Lazy(deck.named_sets("node set"))
    mesh.cell_sets = Lazy({name: by_block(make) for name, make in deck.named_sets("element set").items()})
    mesh.info = {"surfaces": Lazy(deck.named_sets("surface"))}
    return mesh


