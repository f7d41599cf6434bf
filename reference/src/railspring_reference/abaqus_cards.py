"""The cards of an Abaqus or CalculiX deck, with their lines: keyword, parameters and fields of the data lines."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from .refusal import Refused, at_line


@dataclass
class Card:
    """A keyword with its parameters and data lines."""

    path: Path
    line: int
    """Of the keyword, counted from one."""
    keyword: str
    """In capitals, with single blanks."""
    parameters: dict[str, str]
    """By their names in capitals; without quotes."""
    data: list[tuple[int, list[str]]] = field(default_factory=list)
    """Line and fields of every data line; an empty field at its end says that the record goes on."""

    def refused(self, found: str, expected: str, remedy: str, line: int | None = None) -> Refused:
        """Refuses the card, or a line of it."""
        return at_line(self.path, line or self.line, found, expected, remedy)

    def name(self, parameter: str) -> str:
        """The value of a parameter that the card needs."""
        value = self.parameters.get(parameter, "")
        if not value:
            raise self.refused(
                f"*{self.keyword} without {parameter}=", f"{parameter}=NAME on the line", "give the name"
            )
        return value

    def whole(self, line: int, text: str) -> int:
        """A whole number of a data line."""
        try:
            return int(text)
        except ValueError:
            raise self.refused(
                f'"{text}" in *{self.keyword}',
                "a whole number",
                "write the numbers out: parameters and expressions are not read",
                line,
            ) from None

    def real(self, line: int, text: str) -> float:
        """A number of a data line; empty means zero, as in Abaqus."""
        try:
            # exponents of Fortran
            return float(text.upper().replace("D", "E")) if text else 0.0
        except ValueError:
            raise self.refused(
                f'"{text}" in *{self.keyword}',
                "a number",
                "write the numbers out: parameters and expressions are not read",
                line,
            ) from None


def unquoted(text: str) -> str:
    """A name without blanks around it and without the quotes that are no part of it."""
    text = text.strip()
    return text[1:-1].strip() if len(text) > 1 and text[0] == text[-1] == '"' else text


def fields(text: str) -> list[str]:
    """The fields of a line, with commas between them; those in quotes may have commas."""
    return [unquoted(part) for part in split(text)]


def split(text: str) -> list[str]:
    """The parts between commas that stand in no quotes."""
    if '"' not in text:
        return text.split(",")
    parts, inside = [""], False
    for character in text:
        if character == "," and not inside:
            parts.append("")
            continue
        inside ^= character == '"'
        parts[-1] += character
    return parts


def cards(path: Path) -> Iterator[Card]:
    """The cards of a deck, in its order; comments and empty lines are left out."""
    card: Card | None = None
    head: str | None = None  # a keyword line that goes on
    begin = 0
    with path.open(encoding="utf-8", errors="replace") as file:
        for number, line in enumerate(file, 1):
            text = line.strip()
            if not text or text.startswith("**"):
                continue
            if head is None and text.startswith("*"):
                if card:
                    yield card
                card, head, begin = None, "", number
            if head is not None:
                head += text
                if text.endswith(","):
                    continue
                card, head = _card(path, begin, head), None
            elif card is None:
                raise at_line(
                    path,
                    number,
                    text[:40],
                    "a keyword line with a star at the beginning of a deck",
                    "check that the file is an Abaqus or CalculiX deck",
                )
            else:
                card.data.append((number, fields(text)))
    if head:
        card = _card(path, begin, head)
    if card:
        yield card


def _card(path: Path, line: int, head: str) -> Card:
    first, *rest = split(head[1:])
    keyword, _, value = first.partition("=")
    parameters = {}
    for part in rest:
        name, _, given = part.partition("=")
        if name.strip():
            parameters["".join(name.split()).upper()] = unquoted(given)
    if value:
        parameters[""] = unquoted(value)
    return Card(path, line, " ".join(keyword.split()).upper(), parameters)
