"""Laws, evaluated by the library.

Source: the law's definition k(F) = a + b (F/f0)^c, the displacement that the library's documentation states for the published law, numerical integrals. Units N,
m, N/m. Accuracy: ROUNDOFF, some products and powers; QUADRATURE, the trapezoidal rule of the test itself on a fine grid.
"""

import pickle

import numpy as np
import pytest

from railspring import Law, TableLaw, fit_law

ROUNDOFF = 1e-12
QUADRATURE = 1e-6


def test_a_law_is_its_definition() -> None:
    law = Law(2e8, 1e8, 0.49)
    forces = np.geomspace(10.0, 150e3, 200_001)
    tangent = law.tangent(forces)
    assert np.allclose(tangent, 2e8 + 1e8 * (forces / 1e3) ** 0.49, rtol=ROUNDOFF)
    integral = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(forces) * (1 / tangent[1:] + 1 / tangent[:-1]))))
    displacement = law.displacement(forces)
    assert np.allclose(displacement - displacement[0], integral, rtol=QUADRATURE, atol=1e-15)
    some = slice(None, None, 1000)
    assert np.allclose(law.force(displacement[some]), forces[some], rtol=1e-11)
    energy = law.energy(displacement)
    work = np.sum(0.5 * np.diff(displacement) * (forces[1:] + forces[:-1]))
    assert energy[-1] - energy[0] == pytest.approx(work, rel=QUADRATURE)
    assert Law.published().displacement(100e3) == pytest.approx(0.1408e-3, abs=0.0001e-3)


def test_shapes_stay() -> None:
    law = Law.published()
    assert isinstance(law.tangent(85e3), float) and isinstance(law.force(np.float64(1e-4)), float)
    assert law.displacement([1, 2, 3]).shape == (3,) and law.displacement(np.ones((2, 3))).shape == (2, 3)
    assert law.tangent(np.array([])).shape == (0,)
    assert np.array_equal(law.displacement([1e3, 2e3]), [law.displacement(1e3), law.displacement(2e3)])


def test_what_is_no_number_and_no_contact() -> None:
    law = Law.published()
    assert np.isnan(law.tangent(float("nan"))) and np.isnan(law.force([np.nan, 1e-4])[0])
    assert law.force(-1e-3) == 0.0 and law.displacement(-5.0) == 0.0 and law.tangent(-5.0) == law.a


def test_constants_of_files() -> None:
    law = Law.from_constants(3e4, 2.94e5, 0.241104, 10.0)
    assert law.tangent(50e3) == pytest.approx(1e3 * (3e4 + 2.94e5 * 5.0**0.241104), rel=ROUNDOFF)
    assert pickle.loads(pickle.dumps(law)) == law and eval(repr(law), {"Law": Law}) == law
    for constants in [(-1.0, 1e5, 0.2, 1.0), (1e4, 1e5, 1.0, 1.0), (1e4, 1e5, 0.2, 0.0), (1e4, float("nan"), 0.2, 1.0)]:
        with pytest.raises(ValueError, match="expected|≥"):
            Law.from_constants(*constants)


def test_fits_and_tables() -> None:
    law = Law(1e8, 2e8, 0.3)
    forces = np.linspace(5e3, 150e3, 20)
    fit = fit_law(forces, law.tangent(forces))
    assert fit.law.c == pytest.approx(0.3, abs=1e-6) and fit.max_relative_error < 1e-6
    assert fit.range == (5e3, 150e3) and list(fit.at_bound) == [False, False, False]
    knots = TableLaw(list(forces), list(law.tangent(forces)))
    assert knots.tangent(forces[3]) == pytest.approx(law.tangent(forces[3]), rel=ROUNDOFF)
    assert np.allclose(knots.force(knots.displacement(forces)), forces, rtol=1e-11)
    with pytest.raises(ValueError, match="four|4"):
        TableLaw([1.0, 2.0], [1.0, 2.0])
