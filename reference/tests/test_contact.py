"""The contact of a cylinder-like wheel on a flat rail block: conditions and balances."""

from types import ModuleType
from typing import Any

import meshio
import numpy as np
import pytest
from test_body import STEEL, block

from railspring_reference import contact as contact_module
from railspring_reference import run
from railspring_reference import surface as surface_module
from railspring_reference.body import Body
from railspring_reference.contact import Carrier, Contact
from railspring_reference.exchange import Grid, Side
from railspring_reference.iteration import BeyondCandidates, NotConverged
from railspring_reference.surface import Graph, rail_gap

SOLVER = 1e-6
"""Relative end of the alternation of normal and tangential forces."""
RADIUS = 0.4
HEIGHT = 0.02
WIDTH = 0.02
LOAD = 4e4
"""Load under which eleven nodes touch, some slipping and some at rest with a friction of 0.1, N."""


def pair(friction: bool = False, carrier: Carrier = "rail") -> tuple[Contact, Body]:
    """A sector of a wheel with a crowned tread (radius 0.2 m across) on a flat block."""
    n = (10, 10, 4)

    def flat() -> tuple[meshio.Mesh, np.ndarray]:
        mesh = block(n, (WIDTH, WIDTH, HEIGHT))
        axes = [np.linspace(0.0, s, k + 1) for s, k in zip((WIDTH, WIDTH, HEIGHT), n, strict=True)]
        mesh.points[:] = np.array(np.meshgrid(*axes, indexing="ij")).reshape(3, -1).T
        mesh.points[:, :2] -= 0.5 * WIDTH
        return mesh, np.arange(len(mesh.points)).reshape([k + 1 for k in n])

    rail_mesh, number = flat()
    rail = Body(rail_mesh, [STEEL], number[:, :, -1].ravel())
    y = np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, 201)
    rail_side = Side(
        Grid(number[:, :, 0].T.copy(), rail_mesh.points[number[:, 0, 0], 0]),
        np.array([y, np.zeros_like(y)]).T, np.zeros(2), 0.0,
    )
    wheel_mesh, number = flat()
    # the block bent about the axle: its lower face is the tread, a little wider than fine on the rail
    x, across, depth = wheel_mesh.points.T
    angle = x * 0.97 / RADIUS
    rho = RADIUS - across**2 / 0.4 - (HEIGHT - depth)
    wheel_mesh.points[:] = np.array([rho * np.sin(angle), across, rho * np.cos(angle)]).T
    wheel = Body(wheel_mesh, [STEEL], number[:, :, 0].ravel())
    wheel_side = Side(
        Grid(number[:, :, -1].T.copy(), (wheel_mesh.points[number[:, 0, -1], 0] / RADIUS).copy()),
        np.array([y, -(y**2) / 0.4]).T, np.zeros(2), RADIUS,
    )
    wheel_side = Side(Grid(wheel_side.grid.nodes, angle[number[:, 0, -1]]), wheel_side.curve, np.zeros(2), RADIUS)
    return Contact(wheel, rail, (wheel_side, rail_side), friction, 0.1e-3, lambda *_: None, carrier), wheel


@pytest.fixture(scope="module", params=["rail", "wheel"])
def contact(request: pytest.FixtureRequest) -> Contact:
    return pair(True, request.param)[0]


def test_conditions_of_signorini(contact: Contact) -> None:
    """Goal: no tension, no overlap, no force across a gap; the forces carry the load."""
    state = contact.press(5e3, None)
    gap = contact.gap(state.lowering) + contact.compliance[: contact.count, : contact.count] @ state.normal
    assert (state.normal >= 0.0).all()
    scale = state.lowering
    assert gap.min() > -SOLVER * scale
    assert np.abs(gap[state.normal > 0.0]).max() < SOLVER * scale
    assert abs(state.normal @ contact.vertical[: contact.count] / 5e3 - 1.0) < SOLVER


def test_the_tangent_is_the_slope_of_the_curve(contact: Contact) -> None:
    """Source: central difference of two presses with the same nodes in contact."""
    load = 5e3
    state = contact.press(load, None)
    low, high = (contact.press(load * f, None) for f in (0.9999, 1.0001))
    slope = 2e-4 * load / (high.lowering - low.lowering)
    assert abs(contact.tangent(state) / slope - 1.0) < 1e-4


def test_the_horizontal_stiffness_has_the_least_energy(contact: Contact) -> None:
    """Source: forces that stick have the least complementary energy of all that carry a lateral force of one and no
    vertical one (their matrix of conditions solved as a whole), twice of which is the flexibility, m/N. Goal: the
    same, with the nodes that touch alone; a stronger contact is stiffer; without tangential multipliers none."""
    state, more = contact.press(5e3, None), contact.press(LOAD, None)
    on = np.flatnonzero(state.normal > 0.0)
    rows = np.concatenate([on, contact.count + on, 2 * contact.count + on])
    conditions = np.array([contact.lateral[rows], contact.vertical[rows]])
    system = np.block([[contact.compliance[np.ix_(rows, rows)], conditions.T], [conditions, np.zeros((2, 2))]])
    force = np.linalg.solve(system, np.concatenate([np.zeros(len(rows)), [1.0, 0.0]]))[: len(rows)]
    flexibility = force @ contact.compliance[np.ix_(rows, rows)] @ force
    stiffness = contact.horizontal_stiffness(state)
    assert abs(stiffness * flexibility - 1.0) < SOLVER
    assert contact.horizontal_stiffness(more) > 1.01 * stiffness
    with pytest.raises(ValueError, match="tangential multipliers"):
        pair(False)[0].horizontal_stiffness(state)


def test_friction_stays_on_its_cone_and_opposes_slip(contact: Contact) -> None:
    """Goal: |t| <= mu n; slipping points are pushed against their slip; less friction slips more."""
    frictional = contact.with_friction(0.1)
    state = frictional.press(LOAD, None)
    size = np.hypot(*state.tangential.T)
    on = state.normal > 0.0
    assert (size[on] <= 0.1 * state.normal[on] * (1 + SOLVER)).all()
    slipping = on & (size > 0.1 * state.normal * (1 - SOLVER)) & (size > 0.0)
    slip = np.hypot(*state.slip.T)
    resting = on & ~slipping
    assert resting.any() and (slip[slipping] > 1e-3 * state.lowering).any()
    assert slip[resting].max(initial=0.0) < 1e-4 * state.lowering
    for j in np.flatnonzero(slipping & (slip > 1e-3 * state.lowering)):
        assert state.tangential[j] @ state.slip[j] < 0.0


def test_both_carriers_find_the_same_contact() -> None:
    """Goal: hub displacement does not depend on which surface carries the multipliers, but for about ten elements
    in the patch: 3 %, an eighth of what one ring of them would change."""
    states = [pair(False, carrier)[0].press(5e3, None) for carrier in ("rail", "wheel")]
    assert states[0].lowering != states[1].lowering
    assert abs(states[0].lowering / states[1].lowering - 1.0) < 0.03


def test_the_gap_runs_along_the_normal() -> None:
    """Source: plane under 45 degrees; the distance along a 30 degree normal from one above it."""
    from railspring_reference.surface import Points

    curve = Graph(np.array([np.linspace(-1, 1, 21), np.linspace(-1, 1, 21)]).T, 0.0)
    normal = np.array([[0.0], [-0.5], [np.sqrt(0.75)]])
    points = Points(np.array([[0.0], [0.0], [-0.1]]), normal, np.ones(1), np.zeros((2, 1), int), np.zeros((2, 1)))
    gap, y = rail_gap(points, curve, np.zeros(2), 0.0)
    expected = 0.1 / (np.sqrt(0.75) + 0.5)
    assert abs(gap[0] - expected) < 1e-12
    assert abs(y[0] + 0.5 * expected) < 1e-12


STOPS = [
    (contact_module, "NNLS_ROUNDS", 0.02, "normal forces by non-negative least squares"),
    (contact_module, "PROJECTIONS", 1, "tangential forces under given normal forces"),
    (contact_module, "ALTERNATIONS", 1, "friction under 4e\\+04 N"),
    (surface_module, "PROJECTIONS", 1, "gap along the wheel's normal"),
]
"""Iterations with a limit that is too small for them."""


@pytest.mark.parametrize(("module", "limit", "value", "what"), STOPS)
def test_an_iteration_without_an_answer_is_an_error(
    contact: Contact, monkeypatch: pytest.MonkeyPatch, module: ModuleType, limit: str, value: float, what: str
) -> None:
    """Goal: each iteration that runs out of steps raises with its name, its steps and what was missing."""
    frictional = contact.with_friction(0.1)
    monkeypatch.setattr(module, limit, value)
    with pytest.raises(NotConverged, match=what) as caught:
        frictional.press(LOAD, None)
    assert caught.value.iterations == (round(value * contact.count) if limit == "NNLS_ROUNDS" else value)
    assert caught.value.points > 0
    assert f"no convergence in {caught.value.iterations} iterations" in str(caught.value)


def test_the_edge_of_the_candidates_alone_asks_for_more_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Goal: an iteration that stops is not hidden by a larger contact surface, and three sizes that are too small are an
    error, not a contact."""
    made: list[float] = []

    class Planted:
        def __init__(self, *arguments: object) -> None:
            made.append(float(str(arguments[4])))

        def press(self, *_: object) -> None:
            raise error

    class Asked:
        loads = np.array([1e3])

        def side(self, *_: object) -> None:
            return None

    monkeypatch.setattr(run, "Contact", Planted)
    bodies: Any = {"wheel": None, "rail": None}
    asked: Any = Asked()
    error: Exception = NotConverged("friction under 1e3 N", 200, 1.0, 0.1, "N", 9)
    with pytest.raises(NotConverged):
        run.condense(asked, bodies, "same_mesh")
    assert len(made) == 1
    made.clear()
    error = BeyondCandidates("edge")
    with pytest.raises(BeyondCandidates, match="same mesh: candidates up to a gap of 0.00018 m are not enough"):
        run.condense(asked, bodies, "same_mesh")
    assert made == pytest.approx([8e-5, 1.2e-4, 1.8e-4])


def test_the_command_ends_with_the_reason(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Goal: 3 and a line for the tool where an iteration stops, 3 for other numerics, 2 for input; never a traceback."""
    planted: list[tuple[Exception, int, str]] = [
        (NotConverged("friction under 1e+04 N", 200, 0.25, 0.1, "N", 9), 3, "friction under 1e+04 N: no convergence"),
        (BeyondCandidates("edge"), 3, "BeyondCandidates: edge"),
        (RuntimeError("Factor is exactly singular"), 3, "RuntimeError: Factor is exactly singular"),
        (KeyError("loads_n"), 2, "KeyError: 'loads_n'"),
    ]
    for error, code, text in planted:

        def stop(_: object, error: Exception = error) -> None:
            raise error

        monkeypatch.setattr(run, "run", stop)
        assert run.main(["folder"]) == code
        said = capsys.readouterr()
        assert said.err.startswith(f"error: {text}") and said.err.count("\n") == 1
        line = "STOPPED\tfriction under 1e+04 N\t200\t0.25\t9\n"
        assert said.out == (line if isinstance(error, NotConverged) else "")
