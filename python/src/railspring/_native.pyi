"""Laws of wheel on rail, and their contact element, in N, m, s, rad and N/m."""

from os import PathLike
from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

def run_program(arguments: list[str], file: str, command: str | None) -> int:
    """Runs the program `railspring` with arguments, the first of them its name; its exit code. `file` is this module, `command` what starts the program."""

def check_as_written(path: str | PathLike[str]) -> None:
    """Refuses, with a ValueError, a `stiffness.json`, a `table.json`, or a `table.csv` beside one, that is not as the program wrote it."""

class Law:
    """The law ``k(F) = dF/dx = a + b * (F/f0)**c`` with f0 = 1 kN: a and b in N/m.

    Its methods take a number, or anything that numpy makes an array of, and return the same shape. A force or a displacement below zero is no
    contact: no force, and the tangent at no force.
    """

    def __new__(cls, a: float, b: float, c: float) -> Law: ...
    @staticmethod
    def from_constants(a_kn_per_m: float, b_kn_per_m: float, c: float, f0_kn: float) -> Law:
        """The law of constants as the files have them: kN/m, and the reference force in kN."""
    @staticmethod
    def published() -> Law:
        """The law of the publication, for the UIC 60 rail and the SKS-700 wheel."""
    @property
    def a(self) -> float:
        """Constant part, N/m."""
    @property
    def b(self) -> float:
        """Factor of the power, N/m."""
    @property
    def c(self) -> float:
        """Exponent."""
    @overload
    def tangent(self, force: float) -> float: ...
    @overload
    def tangent(self, force: ArrayLike) -> NDArray[np.float64]:
        """Tangent stiffness (N/m) at a force (N)."""
    @overload
    def displacement(self, force: float) -> float: ...
    @overload
    def displacement(self, force: ArrayLike) -> NDArray[np.float64]:
        """Displacement (m) under a force (N), from no load on."""
    @overload
    def force(self, displacement: float) -> float: ...
    @overload
    def force(self, displacement: ArrayLike) -> NDArray[np.float64]:
        """Force (N) at a displacement (m)."""
    @overload
    def energy(self, displacement: float) -> float: ...
    @overload
    def energy(self, displacement: ArrayLike) -> NDArray[np.float64]:
        """Energy (J) that is stored at a displacement (m)."""

class TableLaw:
    """The law through points of tangent stiffness (N/m) at ascending forces (N), four at least."""

    def __new__(cls, forces: list[float], tangents: list[float]) -> TableLaw: ...
    @overload
    def tangent(self, force: float) -> float: ...
    @overload
    def tangent(self, force: ArrayLike) -> NDArray[np.float64]:
        """Tangent stiffness (N/m) at a force (N)."""
    @overload
    def displacement(self, force: float) -> float: ...
    @overload
    def displacement(self, force: ArrayLike) -> NDArray[np.float64]:
        """Displacement (m) under a force (N), from no load on."""
    @overload
    def force(self, displacement: float) -> float: ...
    @overload
    def force(self, displacement: ArrayLike) -> NDArray[np.float64]:
        """Force (N) at a displacement (m)."""

class LawFit:
    """A law with what it is worth as a fit."""

    @property
    def law(self) -> Law:
        """The law."""
    @property
    def standard_error(self) -> list[float]:
        """Standard errors of a (N/m), b (N/m) and c; 0 for one on its bound."""
    @property
    def at_bound(self) -> list[bool]:
        """Which of a, b and c lie on a bound of the fit."""
    @property
    def rms_relative_error(self) -> float:
        """Root mean square of the relative residuals of the tangent."""
    @property
    def max_relative_error(self) -> float:
        """Largest relative residual of the tangent."""
    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest force of the points, N."""

def fit_law(forces: NDArray[np.float64], tangents: NDArray[np.float64]) -> LawFit:
    """The law that fits tangent stiffness (N/m) at forces (N) best, relative; four points at least."""

class Element:
    """The contact element of a wheel on a rail, from a file of `railspring element`. It does not change.

    Motions of a section are (y, z, rotation about x) in m and rad, from where the wheel just touches; y points to the field side of the right rail, z down. Forces are
    (y, z, torque about x) in N and N·m at the same points. P and Q are minus the second and the first of the force on the rim.
    """

    def __new__(cls, path: str | PathLike[str]) -> Element: ...
    @property
    def pair(self) -> str:
        """Wheel, rail and their placement."""
    @property
    def kind(self) -> str:
        """``condensed`` or ``lumped``."""
    @property
    def friction(self) -> float:
        """Coefficient of friction of the study."""
    @property
    def largest_force(self) -> float:
        """Largest normal force that the element was fitted to, N."""
    @property
    def hub_mass(self) -> NDArray[np.float64]:
        """Mass of a host's hub whose wheel has its modes in a `Unit`, about its centre, 3 x 3; kg, kg·m, kg·m²."""
    @property
    def place(self) -> float | None:
        """Place of the wheel for which `rail` is, m."""
    def superelement(self) -> list[NDArray[np.float64]]:
        """Mass, damping and stiffness of the wheel over the hub's three motions and the modes, and the rim's motion under them (3 rows)."""
    def rail(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], float] | None:
        """The study's rail by modes of 1 kg: squared angular frequencies (1/s²), motions of the section, its flexibility beyond them (3 x 3), damping over stiffness (s)."""
    def contact(self, friction: float | None = None) -> Contact:
        """A contact on which friction has taken up nothing."""
    def unit(self, friction: float | None = None, gravity: float = 0.0) -> Unit:
        """An element with the modes of its wheel inside; gravity acts on these, m/s²."""

class Contact:
    """The contact as statics: motions of rim and rail section in; forces on both and their tangent (6 x 6, rim before section) out.

    What is evaluated depends on it and on the end of the last step alone. Without a place the rail is not the study's.
    """

    def start(
        self, rim: ArrayLike, section: ArrayLike | None = None, place: float | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Begins with bodies there on which friction has taken up nothing."""
    def evaluate(
        self, rim: ArrayLike, section: ArrayLike | None = None, place: float | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Forces on rim and section, and their tangent, at the end of a step to these motions."""
    def evaluate_many(
        self, rim: ArrayLike, section: ArrayLike | None = None, place: ArrayLike | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """The same of n states, each a step from the same end: n x 3, n x 3 and n x 6 x 6; not-a-numbers where no balance is found."""
    def commit(self) -> None:
        """Takes what was evaluated last as the end of a step."""
    def copy(self) -> Contact:
        """A contact with the same state."""
    def restore(self, other: Contact) -> None:
        """Takes over the state at the end of the last step of a contact of the same element, with its friction and the rest of its section."""
    def set_section_rest(self, rest: ArrayLike) -> None:
        """Gives the host's rail section a flexibility that its motions do not have, 3 x 3; m/N, rad/N, rad/(N·m)."""
    def contacts(self) -> list[tuple[tuple[float, float], tuple[float, float], float, float, float, bool]]:
        """Of each contact: place on the rail and on the wheel (profile frames, m), normal and tangential force (N), width (m), whether it slides."""

class Unit:
    """An element with the modes of its wheel inside: motions of hub and rail section at the end of a step in; forces on hub, section and rim out."""

    def start(
        self,
        hub: ArrayLike,
        hub_velocity: ArrayLike,
        section: ArrayLike | None = None,
        section_velocity: ArrayLike | None = None,
        place: float | None = None,
        bent: bool = False,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Begins with modes that do not swing: as the hub has them, or bent by weight and contact."""
    def advance(
        self,
        length: float,
        hub: ArrayLike,
        hub_velocity: ArrayLike,
        section: ArrayLike | None = None,
        section_velocity: ArrayLike | None = None,
        place: float | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Forces at the end of a step of a length, s, from the end of the last one."""
    def tangent(self) -> NDArray[np.float64]:
        """Derivatives of the forces on hub and section by displacements of both at the end of that step, 6 x 6."""
    def commit(self) -> None:
        """Takes what `advance` found last as the end of a step."""
    def copy(self) -> Unit:
        """A unit with the same state."""
    def restore(self, other: Unit) -> None:
        """Takes over the state at the end of the last step of a unit of the same element, with its friction and the rest of its section."""
    def set_section_rest(self, rest: ArrayLike) -> None:
        """As that of `Contact`."""
    def contacts(self) -> list[tuple[tuple[float, float], tuple[float, float], float, float, float, bool]]:
        """As those of `Contact`."""
