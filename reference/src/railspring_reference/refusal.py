"""What is said about a mesh file that cannot be used."""

from pathlib import Path


class Refused(Exception):
    """The file cannot be used: key of the study, value, what was expected and how to correct it."""

    def __init__(self, key: str, value: str, expected: str, remedy: str) -> None:
        super().__init__(f"{key} = {value}: expected {expected}; {remedy}")
        self.message = {"key": key, "value": value, "expected": expected, "remedy": remedy}


def elsewhere(path: Path, what: str) -> Refused:
    """Refuses a file with parts in others."""
    return Refused(
        "mesh_file",
        f'"{path.name}" ({what})',
        "a file that has the whole mesh",
        "write the mesh into one file, for instance by inserting what it includes, or as Gmsh (.msh) or VTU",
    )


def at_line(path: Path, line: int, found: str, expected: str, remedy: str) -> Refused:
    """Refuses what stands in a line of the file."""
    return Refused("mesh_file", f'"{path.name}" (line {line}: {found})', expected, remedy)
