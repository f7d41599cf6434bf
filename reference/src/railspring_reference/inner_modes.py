"""Modes inside a trilinear hexahedron that make it bend as a plate does.

Each displacement gets three more functions, 1 - xi^2 in each reference coordinate xi from -1 to 1, that are zero on no
common face with a neighbour and so eliminated element by element (E.L. Wilson et al., "Incompatible displacement
models", 1973). Their slopes are mapped by the Jacobian at the centre and weighted with its determinant, so that constant
strains stay exact on distorted elements (R.L. Taylor, P.J. Beresford, E.L. Wilson, Int. J. Numer. Meth. Eng. 10, 1976).
"""

import numpy as np
import scipy.sparse as sp
import skfem
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ELEMENTS_AT_ONCE = 20000
"""Elements whose modes are eliminated together; bounds the memory."""


def relief(basis: skfem.CellBasis, first: float, second: float, degrees_of_freedom: int) -> sp.csc_matrix:
    """What the modes take off the stiffness of the trilinear elements of a basis with 2x2x2 points, N/m.

    ``first``, ``second``: Lame's constants, Pa. Degrees of freedom are ``3 * function + direction``.
    """
    total = sp.csc_matrix((degrees_of_freedom,) * 2)
    elements = np.arange(basis.mesh.nelements) if basis.tind is None else np.asarray(basis.tind)
    for begin in range(0, len(elements), ELEMENTS_AT_ONCE):
        chunk = slice(begin, begin + ELEMENTS_AT_ONCE)
        blocks = _blocks(basis, elements, chunk, first, second)
        functions = basis.element_dofs[:, chunk].T
        dofs = (3 * functions[:, :, None] + np.arange(3)).reshape(len(blocks), -1)
        shape = (degrees_of_freedom,) * 2
        rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
        total = total + sp.csc_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
    return total


def _blocks(basis: skfem.CellBasis, elements: NDArray[np.int64], chunk: slice, first: float, second: float) -> Floats:
    """The 24x24 block of every element of a chunk."""
    at = basis.X  # reference points in the unit cube, whose coordinate is (xi + 1) / 2
    of = elements[chunk]
    mapping = basis.mapping
    centre = np.full((3, 1), 0.5)
    inverse = mapping.invDF(centre, of)[..., 0]
    larger = mapping.detDF(centre, of)[:, 0]
    weight = basis.dx[chunk]
    # slopes of 1 - xi^2 = 1 - (2 r - 1)^2 by r, then by the place
    by_reference = -4.0 * (2.0 * at - 1.0)
    smaller = np.abs(mapping.detDF(at, of))
    inner = np.einsum("jde,jq,eq->ejdq", inverse, by_reference, np.abs(larger)[:, None] / smaller)
    outer = np.array([value[0].grad[:, chunk] for value in basis.basis]).transpose(2, 0, 1, 3)

    def products(left: Floats, right: Floats) -> Floats:
        """Energy products of two sets of functions, rows and columns ``3 * function + direction``."""
        slopes = np.einsum("eiaq,ejbq,eq->eijab", left, right, weight, optimize=True)
        trace = np.einsum("eijcc->eij", slopes)
        block = first * slopes + second * slopes.swapaxes(3, 4) + second * trace[..., None, None] * np.eye(3)
        count, rows, columns = block.shape[:3]
        return block.transpose(0, 1, 3, 2, 4).reshape(count, 3 * rows, 3 * columns)

    coupling = products(inner, outer)
    return coupling.swapaxes(1, 2) @ np.linalg.solve(products(inner, inner), coupling)
