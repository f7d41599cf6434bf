"""The contact element in Python: one state and many, steps, and what is refused."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import railspring

from .conftest import COARSE


@pytest.fixture(scope="module")
def element(work: Path) -> railspring.Element:
    """The element of the coarse study."""
    keys = {"calibration.shifts_mm": [0, 4, 6.5, 7], "calibration.elements": True}
    return railspring.element(COARSE, work / "pair.rse", results=work / "element", keys=keys, cache=work / "cache")


def test_an_element_says_what_it_is_of(element: railspring.Element) -> None:
    """Goal: pair, kind and masses; the hub has less mass than the wheel by what moves in the modes."""
    assert element.kind == "condensed" and "60E1" in element.pair and element.friction > 0
    mass, damping, stiffness, rim = element.superelement()
    assert mass.shape == damping.shape == stiffness.shape and rim.shape == (3, len(mass))
    coupling = mass[:3, 3:]
    np.testing.assert_allclose(element.hub_mass, mass[:3, :3] - coupling @ coupling.T, rtol=1e-12)
    assert np.all(np.linalg.eigvalsh(mass) > 0)


def test_many_states_are_as_one_after_the_other(element: railspring.Element) -> None:
    """Goal: a thousand states at once have the forces of each alone from the same end of a step. Exact."""
    contact = element.contact()
    contact.start([0, 2e-5, 0], place=element.place)
    generator = np.random.default_rng(5)
    rim = generator.uniform([-5e-4, 0, -1e-3], [5e-4, 6e-5, 1e-3], (1000, 3))
    place = np.full(1000, element.place)
    forces, sections, tangents = contact.evaluate_many(rim, place=place)
    for n in range(0, 1000, 37):
        force, section, tangent = contact.evaluate(rim[n], place=element.place)
        np.testing.assert_array_equal(force, forces[n])
        np.testing.assert_array_equal(section, sections[n])
        np.testing.assert_array_equal(tangent, tangents[n])
    assert np.isfinite(forces).all() and (forces[:, 1] < -1e3).mean() > 0.5


def test_a_step_is_taken_or_given_up(element: railspring.Element) -> None:
    """Goal: forces depend on the end of the last step; a copy and a restored contact go on as the first. Exact."""
    one = element.contact(friction=0.3)
    one.start([0, 3e-5, 0])
    other = one.copy()
    one.evaluate([2e-5, 3e-5, 0])
    one.commit()
    moved, *_ = one.evaluate([4e-5, 3e-5, 0])
    other.restore(one)
    again, *_ = other.evaluate([4e-5, 3e-5, 0])
    np.testing.assert_array_equal(moved, again)
    assert len(one.contacts()) == 1 and one.contacts()[0][2] > 0


def test_a_unit_integrates_its_modes(element: railspring.Element) -> None:
    """Goal: on a hub that is held, a unit that begins bent stays so: the same forces after a millisecond, N. Accuracy: of two balances, 30 N each."""
    unit = element.unit()
    hub = [0, 4e-5, 0]
    first = unit.start(hub, [0, 0, 0], bent=True)
    for _ in range(20):
        last = unit.advance(5e-5, hub, [0, 0, 0])
        unit.commit()
    np.testing.assert_allclose(last[2][:2], first[2][:2], atol=60)
    assert first[2][1] < -1e3 and unit.tangent().shape == (6, 6)


def test_senseless_input_is_refused(element: railspring.Element, work: Path) -> None:
    """Goal: what is wrong is said, and nothing else happens."""
    contact = element.contact()
    with pytest.raises(ValueError, match="motion = NaN"):
        contact.evaluate([np.nan, 0, 0])
    with pytest.raises(ValueError, match="4 numbers"):
        contact.evaluate([0, 0, 0, 0])
    with pytest.raises(ValueError, match="2 rows: expected 3"):
        contact.evaluate_many(np.zeros((3, 3)), section=np.zeros((2, 3)))
    with pytest.raises(ValueError, match="friction"):
        element.contact(friction=-1)
    wrong = work / "wrong.rse"
    wrong.write_bytes(b"no element")
    with pytest.raises(ValueError, match="wrong.rse"):
        railspring.Element(wrong)
    with pytest.raises(TypeError):
        pickle.dumps(contact)
