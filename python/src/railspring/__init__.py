"""Contact springs of railway wheels and rails: what railspring makes, as arrays and data frames.

Results are read with `Study.read`, `Calibration.read`, `Table.read` and `read_history`; `fit`, `calibrate`, `run` and `make_table` have the program make them. A `Law`
is evaluated by the library itself, and so is an `Element`, the contact of a pair for programs with an integration of their own. Lengths, forces and stiffness of laws are in m, N and N/m; columns and keys of files have their units in their names.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ._native import Contact, Element, Law, LawFit, TableLaw, Unit, check_as_written, fit_law

if TYPE_CHECKING:
    from .program import ProgramError, calibrate, element, fit, make_table, run
    from .results import Calibration, History, Study, Table, averaged_ratio, read_history

__all__ = [
    "Calibration",
    "Contact",
    "Element",
    "History",
    "Law",
    "LawFit",
    "ProgramError",
    "Study",
    "Table",
    "TableLaw",
    "Unit",
    "averaged_ratio",
    "calibrate",
    "check_as_written",
    "element",
    "fit",
    "fit_law",
    "make_table",
    "read_history",
    "run",
]


def __getattr__(name: str) -> Any:
    # pandas takes half a second, which the program does without
    if name in __all__:
        for module in ("program", "results"):
            found = getattr(import_module(f".{module}", __name__), name, None)
            if found is not None:
                globals()[name] = found
                return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
