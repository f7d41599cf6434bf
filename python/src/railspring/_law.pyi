"""Laws of wheel on rail, in N, m and N/m."""

from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
