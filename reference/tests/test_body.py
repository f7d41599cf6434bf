"""The elastic bodies against closed solutions."""

from pathlib import Path

import meshio
import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spl
import skfem
from skfem.models.elasticity import lame_parameters, linear_elasticity

from railspring_reference import factor
from railspring_reference.body import Body, Element, Material, gauss_cube, read_mesh
from railspring_reference.ordering import nested_dissection

ROUNDOFF = 1e-11
"""Relative rounding of a well-conditioned solve of some hundred equations."""
STEEL = Material(210e9, 0.3)
KINDS: list[Element] = ["full integration", "incompatible modes", "second order"]


def block(n: tuple[int, int, int] = (4, 3, 2), size: tuple[float, float, float] = (0.4, 0.3, 0.2)) -> meshio.Mesh:
    """A block of hexahedra in the order of VTK, its inner nodes moved."""
    axes = [np.linspace(0.0, s, k + 1) for s, k in zip(size, n, strict=True)]
    grid = np.array(np.meshgrid(*axes, indexing="ij"))
    points = grid.reshape(3, -1).T.copy()
    inner = np.all((points > 1e-9) & (points < np.array(size) - 1e-9), axis=1)
    points[inner] += 0.01 * np.sin(np.arange(3 * inner.sum())).reshape(-1, 3)
    number = np.arange(len(points)).reshape(grid.shape[1:])
    low = [number[a : n[0] + a, b : n[1] + b, : n[2]] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    high = [number[a : n[0] + a, b : n[1] + b, 1:] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return meshio.Mesh(points, [("hexahedron", np.array([c.ravel() for c in low + high]).T)])


def test_the_rule_integrates_its_degree_exactly() -> None:
    """Source: integral of x^2 y^3 over the unit cube is 1/12."""
    (x, y, _), w = gauss_cube(2)
    assert abs(w @ (x**2 * y**3) - 1.0 / 12.0) < 1e-15


@pytest.mark.parametrize("kind", KINDS)
def test_a_distorted_block_keeps_its_volume(kind: Element) -> None:
    """Goal: no corner is mixed up between meshio's and scikit-fem's order: volume is the box's."""
    body = Body(block(), [STEEL], np.array([0]), kind)
    assert abs(body.basis.dx.sum() - 0.4 * 0.3 * 0.2) < ROUNDOFF
    assert body.smallest_jacobian > 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_patch(kind: Element) -> None:
    """Source: constant strain is an exact solution. Forces of a linear field give back that field."""
    mesh = block()
    body = Body(mesh, [STEEL], np.flatnonzero(mesh.points[:, 0] < 1e-9), kind)
    slope = np.array([[1e-3, 0.0, 0.0], [2e-4, -3e-4, 1e-4], [-1e-4, 2e-4, 5e-4]])
    slope[:, 1:] = 0.0  # vanishes on the held face
    exact = (slope @ body.basis.doflocs).T.ravel()
    solution = body.solve((body.stiffness @ exact)[:, None])[:, 0]
    assert np.abs(solution - exact).max() < ROUNDOFF * np.abs(exact).max()
    # the same check notices a wrong modulus
    other = Body(mesh, [Material(1.01 * STEEL.young_pa, STEEL.poisson)], body.held, kind)
    assert np.abs(other.solve((body.stiffness @ exact)[:, None])[:, 0] - exact).max() > 1e-3 * np.abs(exact).max()


@pytest.mark.parametrize("kind", ["full integration", "second order"])
def test_the_stiffness_is_that_of_the_vector_form(kind: Element) -> None:
    """Source: scikit-fem's own linear elasticity with vector functions. Accuracy: rounding."""
    body = Body(block((2, 2, 1)), [STEEL], np.array([0]), kind)
    vector = skfem.Basis(body.mesh, skfem.ElementVector(body.element), quadrature=body.basis.quadrature)
    form = linear_elasticity(*lame_parameters(STEEL.young_pa, STEEL.poisson)).assemble(vector)
    place = np.zeros(vector.N, dtype=int)
    place[vector.nodal_dofs] = body.nodal_dofs
    if kind == "second order":
        place[vector.edge_dofs] = 3 * body.basis.edge_dofs + np.arange(3)[:, None]
    difference = body.stiffness[place][:, place] - form
    assert abs(difference).max() < ROUNDOFF * abs(form).max()


@pytest.mark.parametrize("kind", KINDS)
def test_a_plate_of_one_element_bends(kind: Element) -> None:
    """Source: pure bending about y of a beam without Poisson's effect: strain -z/R along x, energy per length
    E*b*h^3/(24 R^2). Goal: modes inside a rectangular element, and second order, have it to rounding with one element
    over the thickness; full integration has the shear of a parallelogram too, (l/h)^2/2 as much again."""
    length, width, height, radius = 0.4, 0.1, 0.02, 10.0
    mesh = block((4, 1, 1), (length, width, height))
    material = Material(210e9, 0.0)
    body = Body(mesh, [material], np.array([0]), kind)
    x, _, z = body.basis.doflocs
    z = z - 0.5 * height
    bent = np.array([-x * z / radius, np.zeros_like(x), 0.5 * x**2 / radius]).T.ravel()
    energy = 0.5 * bent @ (body.stiffness @ bent)
    exact = material.young_pa * width * height**3 * length / (24.0 * radius**2)
    shear = 0.5 * (0.1 / height) ** 2 if kind == "full integration" else 0.0
    assert abs(energy / exact - 1.0 - shear) < 1e2 * ROUNDOFF, energy / exact


@pytest.mark.parametrize("kind", KINDS)
def test_layers_are_in_series(kind: Element) -> None:
    """Source: a bar of three layers without Poisson's effect is a series of springs, F·(h1/E1 + h2/E2)/A. Goal: its
    change of length under a force at its end, m; the groups the other way round give another. Accuracy: rounding of a
    stiffness that jumps by 1e4."""
    axes = [np.linspace(0.0, 0.3, 4), np.array([0.0, 0.1]), np.array([0.0, 0.1])]
    grid = np.array(np.meshgrid(*axes, indexing="ij"))
    number = np.arange(16).reshape(4, 2, 2)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    hexes = np.array([[number[k + a, b, c] for a, b, c in corners] for k in range(3)])
    mesh = meshio.Mesh(grid.reshape(3, -1).T, [("hexahedron", hexes)])
    stiff, soft = Material(210e9, 0.0), Material(21e6, 0.0)
    held = np.flatnonzero(mesh.points[:, 0] < 1e-9)
    end = np.flatnonzero(mesh.points[:, 0] > 0.3 - 1e-9)

    def longer(groups: list[int]) -> float:
        body = Body(mesh, [stiff, soft], held, kind, np.array(groups))
        pull = skfem.LinearForm(lambda v, _: v / 0.01)
        face = skfem.FacetBasis(body.mesh, body.element, facets=body.mesh.facets_satisfying(lambda x: x[0] > 0.3 - 1e-9))
        forces = np.zeros(body.degrees_of_freedom)
        forces[0::3] = pull.assemble(face)
        return float(body.at_nodes(body.solve(forces[:, None])[:, 0])[end, 0].mean())

    exact = (0.2 / stiff.young_pa + 0.1 / soft.young_pa) / 0.01
    assert abs(longer([0, 1, 0]) - exact) < 1e4 * ROUNDOFF * exact
    assert abs(longer([1, 0, 1]) - exact) > 0.5 * exact
    with pytest.raises(ValueError, match="groups of 2 hexahedra"):
        Body(mesh, [stiff, soft], held, kind, np.array([0, 1]))


def test_both_solvers_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    """Source: MKL Pardiso against SuperLU, where it is installed. Accuracy: rounding."""
    pytest.importorskip("pypardiso")
    mesh = block((6, 6, 6), (0.1, 0.1, 0.1))
    held = np.flatnonzero(mesh.points[:, 0] < 1e-9)
    forces = np.zeros((3 * len(mesh.points), 2))
    forces[-1, 0], forces[-2, 1] = 1.0, 1.0
    pardiso = Body(mesh, [STEEL], held).solve(forces)
    monkeypatch.setattr(factor, "pypardiso", None)
    assert np.abs(Body(mesh, [STEEL], held).solve(forces) - pardiso).max() < ROUNDOFF * np.abs(pardiso).max()


def test_an_inverted_hexahedron_shows() -> None:
    """Goal: swapping two corners of one element makes the smallest determinant negative."""
    mesh = block()
    cells = mesh.cells_dict["hexahedron"].copy()
    cells[5, [0, 6]] = cells[5, [6, 0]]
    assert Body(meshio.Mesh(mesh.points, [("hexahedron", cells)]), [STEEL], np.array([0])).smallest_jacobian < 0.0


def test_other_cells_are_refused(tmp_path: Path) -> None:
    """Goal: tetrahedra are refused with the name of the file."""
    meshio.Mesh(np.eye(4, 3), [("tetra", np.array([[0, 1, 2, 3]]))]).write(tmp_path / "t.vtu")
    with pytest.raises(ValueError, match="t.vtu.*expected hexahedra"):
        read_mesh(tmp_path / "t.vtu")


def test_the_order_is_a_permutation_with_little_fill() -> None:
    """Goal: every node once, and far less fill than in an order by chance."""
    mesh = block((8, 8, 8), (0.1, 0.1, 0.1))
    body = Body(mesh, [STEEL], np.array([0]))
    dofs = body.nodal_dofs[0]
    pattern = body.stiffness[dofs][:, dofs].tocsr()
    order = nested_dissection(mesh.points, pattern)
    assert sorted(order) == list(range(len(mesh.points)))
    matrix = (pattern + sp.eye(len(order)) * abs(pattern).sum()).tocsc()
    options = {"permc_spec": "NATURAL", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    fill = [spl.splu(matrix[o][:, o], **options).nnz for o in (order, np.random.default_rng(1).permutation(len(order)))]
    assert fill[0] < 0.6 * fill[1]
