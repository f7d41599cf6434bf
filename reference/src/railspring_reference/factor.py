"""Factoring a symmetric positive definite matrix: MKL Pardiso where it is installed, else SuperLU.

SuperLU comes with SciPy and serves for elements of first order. Some hundred
thousand equations of second order take it hours; Pardiso takes minutes.
"""

from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl
from numpy.typing import NDArray

try:
    import pypardiso
except ImportError:
    pypardiso = None

Floats = NDArray[np.float64]
POSITIVE_DEFINITE = 2
"""Pardiso's matrix type: real, symmetric, positive definite."""


def solver() -> str:
    """Name and version of the solver in use."""
    if pypardiso is None:
        return f"SuperLU of scipy {version('scipy')}"
    try:
        return f"MKL Pardiso {version('mkl')}"
    except PackageNotFoundError:
        return "MKL Pardiso"


def factored(matrix: sp.csc_matrix) -> Callable[[Floats], Floats]:
    """Factors ``matrix`` and returns what solves for columns of right-hand sides.

    SuperLU takes the rows in the order in which they stand, Pardiso in one of its own.
    """
    if pypardiso is None:
        # symmetric: no pivoting away from the given order
        return spl.splu(
            matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        ).solve
    return Pardiso(matrix)


class Pardiso:
    """A matrix factored by Pardiso; frees its memory, which Python knows nothing of, when nobody refers to it."""

    def __init__(self, matrix: sp.csc_matrix) -> None:
        self._upper = sp.triu(matrix, format="csr")
        self._solver = pypardiso.PyPardisoSolver(mtype=POSITIVE_DEFINITE)
        self._solver.factorize(self._upper)

    def __call__(self, columns: Floats) -> Floats:
        return self._solver.solve(self._upper, np.asfortranarray(columns))

    def __del__(self) -> None:
        self._solver.free_memory(everything=True)
