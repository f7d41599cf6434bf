//! Ground that moves.

use std::f64::consts::TAU;

use super::*;
use crate::time::function::HarmonicForce;

/// Source: the equation of a mass on a spring on a ground with the acceleration A·sin(ωt), from rest: u = −A/(ω0² − ω²)·(sin ωt − ω/ω0·sin ω0·t) against the ground. Goal: the force (N) over
/// three periods of the slower motion for frequencies from a fifth to three times that of the mass. DISCRETISATION: the scheme's period error (ω·Δt)²/12 over all the phase, 2000 steps a period of the
/// faster motion: 1e-6·TAU·periods. Accuracy: DISCRETISATION of the largest change of the force.
#[test]
fn a_mass_on_a_spring_follows_a_sine_of_the_ground() {
    const DISCRETISATION: f64 = 1e-3;
    let (mass, stiffness, amplitude) = (5750.0, 1.595e6_f64, 0.5);
    let own = (stiffness / mass).sqrt();
    for ratio in [0.2, 0.5, 0.9, 1.1, 1.7, 3.0] {
        let omega = ratio * own;
        let duration = 3.0 * TAU / own.min(omega);
        let steps = (duration * own.max(omega) / TAU * 2000.0).ceil();
        let sine = HarmonicForce { amplitude, frequency: omega / TAU, ..HarmonicForce::NONE };
        let case = TrackCase {
            ground: TimeFunction { harmonics: vec![sine], table: Vec::new() },
            ..case(None, mass, linear(stiffness), Way::uniform(0.0, 0.0, 0.0, 1.0), [steps, duration])
        };
        let run = run(&case);
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for row in &run.rows {
            let t = row.time;
            let u = -amplitude / (own * own - omega * omega)
                * ((omega * t).sin() - omega / own * (own * t).sin());
            worst = worst.max((row.wheels[0].force - mass * 9.81 - stiffness * u).abs());
            largest = largest.max((stiffness * u).abs());
        }
        assert!(largest > 1e3 && largest < mass * 9.81, "{ratio}: {largest}");
        assert!(worst < DISCRETISATION * largest, "{ratio}: {worst} of {largest}");
    }
}

/// Source: statics. A rail on two supports whose ground is accelerated slowly bends as under its own weight times a/g: 5·m·a·L⁴/(384·EI) up, and its supports move with the ground. Goal: the
/// deflection (m) of the middle after a ramp of many periods, and the acceleration (m/s²) of a support. QUASI-STATIC: a ramp of 20 of the lowest periods leaves an oscillation of 1/(20·π).
#[test]
fn a_rail_bends_under_an_accelerated_ground() {
    const QUASI_STATIC: f64 = 0.02;
    let (length, bending, mass) = (4.0, 6.38e6_f64, 60.2);
    let period = TAU / ((TAU / 2.0 / length).powi(2) * (bending / mass).sqrt());
    let ramp = 20.0 * period;
    let case = TrackCase {
        running: Running::Force,
        start: Start::Above { height: 0.0, velocity: 0.0 },
        ground: TimeFunction { harmonics: Vec::new(), table: vec![(0.0, 0.0), (ramp, 2.0)] },
        probes: vec![probe(Carrier::Rail, 0.5 * length), probe(Carrier::Rail, 0.0)],
        ..case(
            Some(on_two_supports(slender(bending, mass), length, 20)),
            0.0,
            linear(1.0),
            Way::uniform(1.0, 0.0, 0.0, 1.0),
            [4000.0, ramp],
        )
    };
    let run = run(&case);
    let last = run.rows.last().unwrap();
    let expected = -5.0 * mass * 2.0 * length.powi(4) / (384.0 * bending);
    assert!((last.probes[0].deflection / expected - 1.0).abs() < QUASI_STATIC, "{last:?} {expected:e}");
    assert_eq!(last.probes[1].acceleration, 2.0);
}

/// Goal: a wheel whose ground falls faster than it does leaves the rail, has no force while there is a gap (m), and comes back harder.
#[test]
fn a_wheel_that_is_left_behind_flies() {
    let pulse = vec![(0.0, 0.0), (0.01, 30.0), (0.05, 30.0), (0.06, -30.0), (0.1, -30.0), (0.11, 0.0)];
    let case = TrackCase {
        ground: TimeFunction { harmonics: Vec::new(), table: pulse },
        ..case(
            Some(on_sleepers(20, 0.3)),
            900.0,
            linear(1e9),
            Way::uniform(3.0, 0.0, 0.0, 1.0),
            [3000.0, 0.3],
        )
    };
    let run = run(&case);
    let flying: Vec<_> = run.rows.iter().filter(|row| row.wheels[0].approach < 0.0).collect();
    assert!(flying.len() > 100 && flying.iter().all(|row| row.wheels[0].force == 0.0));
    let most = run.rows.iter().map(|row| row.wheels[0].force).fold(0.0, f64::max);
    assert!(most > 3.0 * 900.0 * 9.81, "{most}");
}
