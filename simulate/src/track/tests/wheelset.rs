//! Two wheels on two rails.

use super::*;

/// Agreement of two ways to the same equations: the contacts of a wheelset are found in rounds, to 1e-13 of an approach.
const SOLVER: f64 = 1e-7;

fn wheelset() -> Wheelset {
    Wheelset {
        mass: 1200.0,
        inertia: 800.0,
        above: 10_000.0,
        above_inertia: 6000.0,
        suspension: kelvin(1.2e6, 4e4),
        half_track: 0.75,
        half_base: 1.0,
    }
}

fn on_two_rails(roll: TimeFunction, heights: [f64; 2]) -> TrackCase {
    let dip = |depth: f64| Unevenness {
        rail: vec![Irregularity::Dip { at: 4.0, depth, half_length: 0.5 }],
        wheel: Vec::new(),
    };
    let wheels = Wheels { unevenness: heights.map(dip).into(), ..linear(1e9) };
    TrackCase {
        running: Running::Wheelset(wheelset()),
        roll,
        ..case(Some(on_sleepers(40, 0.3)), 0.0, wheels, Way::uniform(3.0, 20.0, 0.0, 1.0), [400.0, 0.2])
    }
}

/// Goal: with the same dip under both wheels each has the force (N) of a single wheel with half of all masses and the suspension of a side. Accuracy: SOLVER.
#[test]
fn both_sides_alike_are_a_wheel_each() {
    let both = on_two_rails(TimeFunction::default(), [1e-3; 2]);
    let half = SprungWheel { mass: 600.0, above: 5000.0, suspension: kelvin(1.2e6, 4e4) };
    let mut one = TrackCase { running: Running::Wheel(half), ..both.clone() };
    one.wheels.unevenness.truncate(1);
    let (both, one) = (run(&both), run(&one));
    let spread = one.rows.iter().map(|row| row.wheels[0].force).fold(0.0, f64::max);
    assert!(spread > 1.1 * 5600.0 * 9.81, "{spread}");
    for (both, one) in both.rows.iter().zip(&one.rows) {
        for wheel in &both.wheels {
            assert!((wheel.force - one.wheels[0].force).abs() < SOLVER * spread, "{both:?} {one:?}");
        }
    }
}

/// Source: statics. Goal: a moment about the track moves M/(2·half_track) from one wheel to the other at rest (N); the mirrored case, with the opposite moment and the dips
/// exchanged, has the wheels exchanged to the last bit. Accuracy: SOLVER.
#[test]
fn a_moment_unloads_a_wheel_and_the_mirrored_case_the_other() {
    let weight = 0.5 * 11_200.0 * 9.81;
    let right = run(&on_two_rails(TimeFunction::constant(12e3), [2e-3, 0.5e-3]));
    let left = run(&on_two_rails(TimeFunction::constant(-12e3), [0.5e-3, 2e-3]));
    let first: Vec<f64> = right.rows[0].wheels.iter().map(|wheel| wheel.force).collect();
    for (found, expected) in first.iter().zip([weight + 8e3, weight - 8e3]) {
        assert!((found / expected - 1.0).abs() < SOLVER, "{found} {expected}");
    }
    for (right, left) in right.rows.iter().zip(&left.rows) {
        for side in [0, 1] {
            assert_eq!(right.wheels[side], left.wheels[1 - side]);
        }
    }
}

/// Goal: a wheelset that falls with one wheel over a step comes to rest with both wheels on the rail and its
/// weight on both (N). It does so within the damping of ten periods of the mass above. The sum of forces is
/// that of gravity on the mean. Accuracy: REST, the share of the force that still moves.
#[test]
fn a_wheelset_that_falls_comes_to_rest() {
    const REST: f64 = 0.02;
    let falls = TrackCase {
        start: Start::Above { height: 1e-3, velocity: 0.0 },
        way: Way::uniform(6.0, 0.0, 0.0, 1.0),
        steps: 40_000,
        time_step: 1e-4,
        ..on_two_rails(TimeFunction::default(), [0.0; 2])
    };
    let run = run(&falls);
    assert_eq!(run.rows[0].wheels[0].force, 0.0);
    let last = run.rows.last().unwrap();
    for wheel in &last.wheels {
        assert!((wheel.force / (0.5 * 11_200.0 * 9.81) - 1.0).abs() < REST, "{last:?}");
    }
}
