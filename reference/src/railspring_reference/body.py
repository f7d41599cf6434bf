"""A linear elastic body of hexahedra on scikit-fem."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

import meshio
import numpy as np
import scipy.sparse as sp
import skfem
from numpy.typing import NDArray
from skfem.io.meshio import from_meshio
from skfem.models.elasticity import lame_parameters

from .factor import factored
from .inner_modes import relief
from .ordering import nested_dissection

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

VTK_CORNERS: Floats = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=np.float64
)
"""Reference corners of a hexahedron in the order of VTK."""
COLUMNS_AT_ONCE = 24
"""Right-hand sides solved together; bounds the memory."""
Element = Literal["full integration", "incompatible modes", "second order"]
"""Trilinear with 2x2x2 Gauss points; the same with inner modes that make it bend (:mod:`.inner_modes`); serendipity with
20 nodes and 3x3x3 points."""


@dataclass(frozen=True)
class Material:
    """Isotropic elasticity."""

    young_pa: float
    poisson: float


def read_mesh(path: Path) -> meshio.Mesh:
    """Reads a mesh that must consist of hexahedra with eight nodes."""
    mesh = meshio.read(path)
    kinds = {block.type for block in mesh.cells}
    if kinds != {"hexahedron"}:
        raise ValueError(f"{path}: cells {sorted(kinds)}: expected hexahedra with eight nodes only")
    return mesh


class Body:
    """A body of straight-edged hexahedra, factored with some nodes held.

    ``groups``: the number of every hexahedron's material among ``materials``; left out or empty, all have the first.
    """

    def __init__(
        self,
        mesh: meshio.Mesh,
        materials: Sequence[Material],
        held: Ints,
        kind: Element = "full integration",
        groups: Ints | None = None,
    ) -> None:
        self.points: Floats = np.asarray(mesh.points, dtype=np.float64)
        self.hexes: Ints = np.asarray(mesh.cells_dict["hexahedron"], dtype=np.int64)
        self.mesh = from_meshio(mesh)
        # scikit-fem numbers the corners of a hexahedron in another order: nodes must still be the file's
        if not np.array_equal(self.mesh.p.T, self.points):
            raise ValueError("scikit-fem renumbered the nodes of the mesh")
        self.materials = materials
        self.groups = groups if groups is not None and len(groups) else np.zeros(len(self.hexes), dtype=np.int64)
        if len(self.groups) != len(self.hexes) or not set(self.groups.tolist()) <= set(range(len(materials))):
            raise ValueError(f"groups of {len(self.groups)} hexahedra of {len(self.hexes)}, {len(materials)} materials")
        self.kind = kind
        self.order = 2 if kind == "second order" else 1
        self.element = skfem.ElementHex1() if self.order == 1 else skfem.ElementHexS2()
        self.basis = skfem.Basis(self.mesh, self.element, quadrature=gauss_cube(1 + self.order))
        self.held = held

    @cached_property
    def smallest_jacobian(self) -> float:
        """Smallest Jacobian determinant at a Gauss point over the mean one of its element's absolute values."""
        # from the file's own order of corners: scikit-fem's is mirrored and its sign says nothing
        signs = 2.0 * VTK_CORNERS - 1.0
        points = 2.0 * gauss_cube(2)[0].T - 1.0
        factors = 1.0 + signs[None] * points[:, None]
        slopes = np.stack([signs[:, d] * np.delete(factors, d, axis=2).prod(axis=2) / 8.0 for d in range(3)])
        det = np.linalg.det(np.einsum("dqn,eni->eqdi", slopes, self.points[self.hexes]))
        return float((det / np.abs(det).mean(axis=1, keepdims=True)).min())

    @property
    def degrees_of_freedom(self) -> int:
        """Number of all degrees of freedom, held ones included; ``3 * function + direction``."""
        return 3 * int(self.basis.N)

    @cached_property
    def nodal_dofs(self) -> Ints:
        """Degrees of freedom of every mesh node, one row a direction."""
        return 3 * self.basis.nodal_dofs + np.arange(3)[:, None]

    @cached_property
    def stiffness(self) -> sp.csc_matrix:
        """Stiffness matrix, N/m, nothing held."""
        total = sp.csc_matrix((self.degrees_of_freedom,) * 2)
        for number, material in enumerate(self.materials):
            elements = np.flatnonzero(self.groups == number)
            if len(elements):
                total = total + self._stiffness_of(material, elements)
        return total

    def _stiffness_of(self, material: Material, elements: Ints) -> sp.csc_matrix:
        """The part of some elements of one material."""
        basis = self.basis
        if len(elements) < len(self.hexes):
            basis = skfem.Basis(self.mesh, self.element, quadrature=self.basis.quadrature, elements=elements)
        # products of slopes of scalar functions: twenty times faster than the form of vector functions
        slopes: dict[tuple[int, int], sp.csr_matrix] = {}
        for a in range(3):
            for b in range(a + 1):
                form = skfem.BilinearForm(lambda u, v, _, a=a, b=b: u.grad[b] * v.grad[a])
                slopes[a, b] = form.assemble(basis).tocsr()
                slopes[b, a] = slopes[a, b].T
        first, second = lame_parameters(material.young_pa, material.poisson)
        shear = second * (slopes[0, 0] + slopes[1, 1] + slopes[2, 2])
        total = sp.csc_matrix((self.degrees_of_freedom,) * 2)
        for a in range(3):
            for b in range(3):
                block = first * slopes[a, b] + second * slopes[b, a]
                if a == b:
                    block = block + shear
                place = sp.csr_matrix(([1.0], ([a], [b])), shape=(3, 3))
                total = total + sp.kron(block, place, format="csc")
        if self.kind == "incompatible modes":
            total = total - relief(basis, first, second, self.degrees_of_freedom)
        return total

    @cached_property
    def free(self) -> Ints:
        """Free degrees of freedom in elimination order."""
        is_held = np.zeros(self.basis.N, dtype=bool)
        is_held[self.basis.nodal_dofs[0, self.held]] = True
        if self.order == 2:
            is_held[self.basis.edge_dofs[0]] = is_held[self.basis.nodal_dofs[0, self.mesh.edges]].all(axis=0)
        functions = np.flatnonzero(~is_held)
        pattern = self.stiffness[3 * functions][:, 3 * functions].tocsr()
        order = nested_dissection(self.basis.doflocs[:, functions].T, pattern)
        return (3 * functions[order][:, None] + np.arange(3)).ravel()

    @cached_property
    def _factor(self) -> Callable[[Floats], Floats]:
        return factored(self.stiffness[self.free][:, self.free].tocsc())

    def release(self) -> None:
        """Forgets the matrix and its factor, which come again when they are needed."""
        for name in ("stiffness", "_factor"):
            self.__dict__.pop(name, None)

    def solve(
        self,
        forces: sp.csc_matrix | Floats,
        progress: Callable[[int, int], None] | None = None,
        refined: bool = True,
    ) -> Floats:
        """Displacements (rows: degrees of freedom) under each column of forces; ``refined``: one step of refinement,
        from 1e-10 to 1e-13 of the largest."""
        columns = sp.csc_matrix(forces)
        matrix = self.stiffness[self.free][:, self.free].tocsr()
        solution = np.zeros(columns.shape)
        for first in range(0, columns.shape[1], COLUMNS_AT_ONCE):
            chunk = slice(first, min(first + COLUMNS_AT_ONCE, columns.shape[1]))
            rhs = columns[:, chunk].toarray()[self.free]
            u = self._factor(rhs)
            if refined:
                u += self._factor(rhs - matrix @ u)
            solution[self.free, chunk] = u
            if progress:
                progress(chunk.stop, columns.shape[1])
        return solution

    def at_nodes(self, solution: Floats) -> Floats:
        """Values at the mesh's nodes, one row each, from a vector of degrees of freedom."""
        return solution[self.nodal_dofs].T

    def from_nodes(self, values: Floats) -> Floats:
        """Vector of degrees of freedom from one row of values a mesh node."""
        vector = np.zeros(self.degrees_of_freedom)
        vector[self.nodal_dofs] = values.T
        return vector


def gauss_cube(count: int) -> tuple[Floats, Floats]:
    """Gauss rule with ``count`` points a direction on the unit cube."""
    x, w = np.polynomial.legendre.leggauss(count)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    grid = np.meshgrid(x, x, x, indexing="ij")
    weights = np.einsum("i,j,k->ijk", w, w, w)
    return np.array([g.ravel() for g in grid]), weights.ravel()
