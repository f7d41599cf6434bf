"""The load case in time: integration, conditions of contact, surfaces in motion, and a wheel that comes to rest."""

from types import ModuleType

import numpy as np
import pytest
import scipy.sparse as sp
from test_body import STEEL, block
from test_contact import pair as static_pair

from railspring_reference import coulomb, curve, in_time, moving_surfaces
from railspring_reference.body import Body
from railspring_reference.coulomb import contact_forces
from railspring_reference.curve import Curve
from railspring_reference.dynamics import Motion, Moving, Scheme, Suspended
from railspring_reference.exchange import Grid, Side
from railspring_reference.in_time import Case, Harmonic, Row, run
from railspring_reference.iteration import BeyondCandidates, NotConverged
from railspring_reference.moving_surfaces import Facing, Surface

DENSITY = np.array([7850.0])
RADIUS = 0.4
CROWN = 0.2
WIDTH, HEIGHT = 0.02, 0.02
NOTHING = Harmonic(0.0, 0.0, 0.0, 0.0)


def arc(radius: float, half_angle: float) -> np.ndarray:
    """Points (y, z) of an arc that is convex upwards, 0.1 mm apart."""
    angle = np.linspace(-half_angle, half_angle, 1 + int(np.ceil(2e4 * radius * half_angle)))
    return np.array([radius * np.sin(angle), radius * (1.0 - np.cos(angle))]).T


def test_nearest_places_on_an_arc() -> None:
    """Source: a circle. Goal: arc length (m) nearest to points on both sides, whichever way they lie; beyond the end it is the end.
    Accuracy: CHORD, the arc length of the spline is that of its chords, h^2/24R^2 = 1e-7 of it; SPLINE, h^4/R^3."""
    radius, half = 0.013, 1.2
    profile = Curve(arc(radius, half))
    angle = np.linspace(-1.1, 1.1, 23)
    for off in (-3e-3, -1e-6, 0.0, 2e-4):
        points = np.array([(radius + off) * np.sin(angle), radius - (radius + off) * np.cos(angle)]).T
        found = profile.nearest(points)
        assert np.abs(found / profile.length - 0.5 - 0.5 * angle / half).max() < 1e-6
        tangent = profile.tangent(found)
        assert np.abs(tangent - np.array([np.cos(angle), np.sin(angle)]).T).max() < 1e-5
    beyond = np.array([[0.02, 0.009], [-0.02, 0.009]])
    assert np.array_equal(profile.nearest(beyond), [profile.length, 0.0])


def test_a_point_sticks_slides_and_opens() -> None:
    """Source: Coulomb's law of one point. Goal: forces (N) of a point that is pressed in by 1 um and moved by 0.1, 1 and -1 um across,
    and of one that is off by 1 um. Accuracy: the end of the sweeps."""
    compliance = np.diag([2e-9, 3e-9, 3e-9])
    for slip, across in ((0.1e-6, -0.1e-6 / 3e-9), (1e-6, -0.5 * 500.0), (-1e-6, 0.5 * 500.0)):
        forces = contact_forces(compliance, np.array([-1e-6, slip, 0.0]), 0.5, np.zeros(3))
        assert np.abs(forces - [500.0, across, 0.0]).max() < 1e-6
    assert not contact_forces(compliance, np.array([1e-6, 1e-6, 0.0]), 0.5, np.full(3, 7.0)).any()


def test_conditions_of_coulomb_hold_on_coupled_points() -> None:
    """Goal: on twelve points whose directions are coupled: no tension, no overlap, forces within the cone, slip against the force on it and
    none inside. Accuracy: the end of the sweeps over what a sweep brings nearer, 1e-7 of the largest."""
    end = 1e-7
    numbers = np.random.default_rng(3)
    n = 12
    root = numbers.normal(size=(3 * n, 3 * n))
    compliance = 1e-9 * (root @ root.T / (3 * n) + 2.0 * np.eye(3 * n))
    free = 1e-6 * numbers.normal(size=3 * n) * np.repeat([1.0, 0.2, 0.2], n)
    forces = contact_forces(compliance, free, 0.3, np.zeros(3 * n))
    normal, across, along = forces.reshape(3, n)
    gap, *slip = (compliance @ forces + free).reshape(3, n)
    on = normal > 0.0
    assert on.any() and not on.all()
    assert gap.min() > -end * 1e-6 and np.abs(gap[on]).max() < end * 1e-6
    size, moved = np.hypot(across, along), np.hypot(*slip)
    assert (size <= 0.3 * normal * (1.0 + 1e-12)).all()
    slides = on & (size > 0.3 * normal * (1.0 - end))
    assert slides.any() and (on & ~slides).any()
    assert moved[on & ~slides].max() < end * 1e-6
    against = (across * slip[0] + along * slip[1])[slides]
    assert np.abs(against / (size * moved)[slides] + 1.0).max() < end


def test_the_scheme_is_of_second_order() -> None:
    """Source: a damped oscillator that is released. Goal: displacement after two periods; the error falls to a quarter with half
    the step. Accuracy of the quarter: terms of third order, a twentieth."""
    omega, ratio, end = 40.0, 0.05, 0.3
    damped = omega * np.sqrt(1.0 - ratio**2)
    exact = np.exp(-ratio * omega * end) * (np.cos(damped * end) + ratio * omega / damped * np.sin(damped * end))
    mass, damping, stiffness = (sp.csr_matrix([[v]]) for v in (1.0, 2.0 * ratio * omega, omega**2))

    def error(steps: int) -> float:
        scheme = Scheme(end / steps)
        matrix = scheme.matrix(mass, damping, stiffness).toarray()
        motion = Motion(np.ones(1), np.zeros(1), np.full(1, -(omega**2)))
        for _ in range(steps):
            inertia, speed, moved = scheme.carried(motion)
            forces = mass @ inertia + damping @ speed + stiffness @ moved
            motion = scheme.later(motion, np.linalg.solve(matrix, forces))
        return float(motion.displacement[0] - exact)

    errors = [error(steps) for steps in (200, 400)]
    assert abs(errors[0] / errors[1] / 4.0 - 1.0) < 0.05
    assert abs(errors[1]) < 2e-3


def test_two_masses_on_a_spring() -> None:
    """Source: two masses on a spring under a constant force on one of them. Goal: hub and suspended mass, m; mass of the block, kg; its
    weight, N. Accuracy: STEPS, (omega h)^2 of the relative motion; MODEL, the block is elastic, (omega / omega of the block)^2 = 1e-5."""
    size = (0.4, 0.3, 0.2)
    mesh = block(size=size)
    body = Body(mesh, [STEEL], np.flatnonzero(mesh.points[:, 2] > size[2] - 1e-9))
    mass, upper, stiffness, force = DENSITY[0] * np.prod(size), 50.0, 4e6, 1e3
    omega = np.sqrt(stiffness * (1.0 / mass + 1.0 / upper))
    step, steps = 2e-5, 500
    assert omega * step < 0.01
    moving = Moving(body, DENSITY, 0.0, np.array([0, 1]), step, Suspended(upper, stiffness, 0.0))
    assert abs(moving.mass / mass - 1.0) < 1e-9
    weight = moving.weight(9.81)
    assert abs(weight.sum() / (9.81 * (mass + upper)) - 1.0) < 1e-9
    _, z, top = moving.hub
    loads = np.zeros(moving.unknowns)
    loads[top] = force
    motion = Motion(*(np.zeros(moving.unknowns) for _ in range(2)), moving.accelerated(loads))
    for _ in range(steps):
        motion = moving.scheme.later(motion, moving.free(motion, (loads, loads)))
    t = step * steps
    relative = force / (upper * omega**2) * (1.0 - np.cos(omega * t))
    both = 0.5 * force * t**2 / (mass + upper)
    expected = [both - upper / (mass + upper) * relative, both + mass / (mass + upper) * relative]
    found = motion.displacement[[z, top]]
    assert np.abs(found - expected).max() < 1e-3 * np.abs(expected).max()
    nodal = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 2.0])
    under = moving.on_surface @ moving.under(np.zeros(moving.unknowns), nodal)
    assert np.allclose(under, moving.flexibility @ nodal, rtol=1e-9, atol=0.0)


def pair() -> tuple[tuple[Body, Body], tuple[Side, Side]]:
    """A sector of a wheel with a crowned tread on a flat block, with profiles that are fine enough for an arc length."""
    (contact, wheel), n = static_pair(False), (10, 10, 4)
    rail_mesh = block(n, (WIDTH, WIDTH, HEIGHT))
    axes = [np.linspace(0.0, s, k + 1) for s, k in zip((WIDTH, WIDTH, HEIGHT), n, strict=True)]
    rail_mesh.points[:] = np.array(np.meshgrid(*axes, indexing="ij")).reshape(3, -1).T
    rail_mesh.points[:, :2] -= 0.5 * WIDTH
    number = np.arange(len(rail_mesh.points)).reshape([k + 1 for k in n])
    rail = Body(rail_mesh, [STEEL], number[:, :, -1].ravel())
    y = np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, 201)
    track = rail_mesh.points[number[:, 0, 0], 0]
    rail_side = Side(Grid(number[:, :, 0].T.copy(), track), np.array([y, 0.0 * y]).T, np.zeros(2), 0.0)
    wheel_side = Side(Grid(number[:, :, -1].T.copy(), 0.97 * track / RADIUS), np.array([y, -(y**2) / (2.0 * CROWN)]).T, np.zeros(2), RADIUS)
    assert contact.radius == RADIUS
    return (wheel, rail), (wheel_side, rail_side)


def test_gaps_of_a_crowned_wheel() -> None:
    """Source: means of x^2/2R + y^2/2Rc over the hats of a node, h^2/6 more than at the node. Goal: gaps (m) of all nodes within 40 um,
    the same when both bodies move together; less by what the wheel comes down; normals that turn with the rail. Accuracy:
    terms of fourth order, (x/R)^2 of the gap; ROUNDOFF of the rule, hats end within its cells, 1 %."""
    bodies, sides = pair()
    wheel, rail = (Surface(body, side) for body, side in zip(bodies, sides, strict=True))
    assert np.abs(rail.rest - bodies[1].points[rail.nodes]).max() < 1e-9
    facing = Facing(wheel, rail)
    still = [np.zeros((len(surface.nodes), 3)) for surface in (wheel, rail)]
    none = np.zeros(0, dtype=int)
    pairs = facing.pairs(still[0], still[1], 40e-6, none)
    x, y, _ = rail.rest[pairs.nodes].T
    h = WIDTH / 10
    exact = (x**2 + h**2 / 6) / (2 * RADIUS) + (y**2 + h**2 / 6) / (2 * CROWN)
    assert len(pairs.nodes) > 9 and not pairs.at_edge.any()
    assert np.abs(pairs.gap / exact - 1.0).max() < 0.01
    by = np.array([0.0, 2e-4, -3e-4])
    together = facing.pairs(still[0] + by, still[1] + by, 40e-6, none)
    assert np.array_equal(together.nodes, pairs.nodes) and np.abs(together.gap - pairs.gap).max() < 1e-12
    uniform = np.tile(by, len(wheel.nodes))
    n = len(pairs.nodes)
    assert np.abs((pairs.motion[0] @ uniform).reshape(3, n) - [[3e-4], [2e-4], [0.0]]).max() < 1e-15
    down = facing.pairs(still[0] + [0.0, 0.0, 5e-6], still[1], 40e-6, pairs.nodes)
    assert np.array_equal(down.nodes[np.isin(down.nodes, pairs.nodes)], pairs.nodes)
    lower = down.gap[np.isin(down.nodes, pairs.nodes)]
    assert np.abs(pairs.gap - lower - 5e-6).max() < 1e-11
    turn = 3e-3
    turned = still[1].copy()
    turned[:, 1], turned[:, 2] = -turn * rail.rest[:, 2], turn * rail.rest[:, 1]
    tilted = facing.pairs(still[0], turned, 40e-6, none)
    across = tilted.motion[0] @ np.tile([0.0, 1.0, 0.0], len(wheel.nodes))
    assert np.abs(across.reshape(3, -1)[0] - turn).max() < 1e-4 * turn


def moved(step: float, case: Case, inner: int = 1) -> list[Row]:
    """The pair in time, its wheel under a light mass on a damped spring."""
    bodies, sides = pair()
    surfaces = [Surface(body, side) for body, side in zip(bodies, sides, strict=True)]
    suspended = Suspended(1.0, 1e7, 6e3)
    wheel, rail = (
        Moving(body, DENSITY, 1e-5, surface.nodes, step / inner, hub)
        for body, surface, hub in zip(bodies, surfaces, (suspended, None), strict=True)
    )
    return run((wheel, rail), Facing(surfaces[0], surfaces[1]), case, inner, lambda _: None)


def test_a_pressed_wheel_comes_to_the_static_state() -> None:
    """Source: the static contact of the same meshes (`Contact.press`). Goal: after the motion is damped out P is the load and the weight,
    Q the lateral force, the hub lies where the statics have it without friction, m. Friction on a flat rail stays within its cone.
    Accuracy: 1e-4 of the motion is left; RULE, other integrals over a cell, 0.5 % as in the comparison with the tool; FRICTION, the
    tangential forces of alike bodies do not change the approach, but those blocks are finite and unlike at their ends, 0.5 %."""
    load, lateral, gravity = 5e3, 500.0, 10.0
    constant = [Harmonic(mean, 0.0, 0.0, 0.0) for mean in (load, lateral)]
    rows = moved(2e-5, Case(300, 2e-5, 0.5, gravity, *constant))
    contact, wheel = static_pair(False)
    volume = wheel.basis.dx.sum()
    whole = load + gravity * (1.0 + DENSITY[0] * volume)
    last = rows[-1]
    assert abs(last.vertical / whole - 1.0) < 1e-4
    assert abs(last.lateral / lateral - 1.0) < 1e-3
    assert abs(last.hub[1] / contact.press(whole, None).lowering - 1.0) < 0.01
    assert all(abs(row.lateral) <= 0.5 * row.vertical * (1.0 + 1e-3) + 1e-6 for row in rows)
    assert max(row.vertical for row in rows) > whole


def test_a_contact_at_the_end_of_the_surfaces_is_refused() -> None:
    """Goal: a wheel that slides without friction off the block ends the run in words, with the time."""
    with pytest.raises(BeyondCandidates, match="end of the meshed surfaces at"):
        moved(5e-5, Case(200, 5e-5, 0.0, 0.0, Harmonic(2e4, 0.0, 0.0, 0.0), Harmonic(2e3, 0.0, 0.0, 0.0)))


STOPS = [
    (curve, "ROUNDS", 1, "nearest place on a profile"),
    (moving_surfaces, "FOOT_ROUNDS", 1, "places on the rail"),
    (coulomb, "SWEEPS", 1, "contact forces"),
    (in_time, "LOOKS", 1, "places of the contact at"),
]
"""Iterations with a limit that is too small for them."""


@pytest.mark.parametrize(("module", "limit", "value", "what"), STOPS)
def test_an_iteration_that_stops_is_an_error(
    monkeypatch: pytest.MonkeyPatch, module: ModuleType, limit: str, value: float, what: str
) -> None:
    """Goal: every iteration with a limit says so where it does not reach its end, and gives no answer."""
    monkeypatch.setattr(module, limit, value)
    with pytest.raises(NotConverged, match=what):
        moved(2e-5, Case(20, 2e-5, 0.3, 0.0, Harmonic(5e3, 0.0, 0.0, 0.0), NOTHING))
