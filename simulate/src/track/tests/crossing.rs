//! Forces and sprung masses that cross a bridge, and wheels that fall, against the literature.

use super::*;
use railspring_calibrate::analytic::beam::{Bending, Span};

/// What the benchmarks ask for, relative.
const DISCRETISATION: f64 = 1e-3;
const MASS: f64 = 5750.0;

fn vbi(duration: f64, way: Way, wheels: Wheels) -> TrackCase {
    let track = on_two_supports(slender(3.5e10 * 1.3901, 18358.0), 25.0, 40);
    TrackCase {
        probes: vec![probe(Carrier::Rail, 12.5)],
        ..case(Some(track), MASS, wheels, way, [20e3, duration])
    }
}

/// Source: program VBI-2D, cases A to A4: a mass on a spring of 1.595e6 N/m crosses a bridge of 25 m. A2 has
/// a ramp of 10 mm from a third to the half, A3 a damper of 4e5 N·s/m as well. A4 also gains 10 m/s². For A3
/// and A4 also an independent solution of the same equations by twenty modes with the method of Runge and
/// Kutta. Goal: deflection (m) of the middle at a quarter, half and three quarters of a second, and the
/// largest. Accuracy: DISCRETISATION of the largest deflection. MODEL: the printed values of A3 and A4 are
/// 0.15 and 0.16 % above that independent solution, of which 0.05 and 0.04 % go where the damper does not
/// feel the slope of the bridge.
#[test]
fn a_sprung_mass_crosses_as_in_vbi_2d() {
    let ramp = Irregularity::Corners(vec![(0.0, 0.0), (25.0 / 3.0, 0.0), (12.5, 0.01), (25.0, 0.01)]);
    let of = |ramp: Option<&Irregularity>, damping: f64| Wheels {
        damping,
        unevenness: vec![Unevenness { rail: ramp.into_iter().cloned().collect(), wheel: Vec::new() }],
        ..linear(1.595e6)
    };
    let steady = || Way::uniform(0.0, 25.0, 0.0, 1.0);
    // 25·t + 5·t² = 25
    let duration = (1125.0_f64.sqrt() - 25.0) / 10.0;
    let gaining = Way::uniform(0.0, 25.0, 10.0, duration);
    assert!((gaining.x(duration) - 25.0).abs() < 1e-9, "{}", gaining.x(duration));
    const MODEL: f64 = 2e-3;
    for (name, case, printed, solved) in [
        ("A", vbi(1.0, steady(), of(None, 0.0)), 4.18545e-4, None),
        ("A2", vbi(1.0, steady(), of(Some(&ramp), 0.0)), 4.6721e-4, None),
        ("A3", vbi(1.0, steady(), of(Some(&ramp), 4e5)), 4.6260e-4, Some(4.618985e-4)),
        ("A4", vbi(duration, gaining, of(Some(&ramp), 4e5)), 4.6912e-4, Some(4.683516e-4)),
    ] {
        let run = run(&case);
        assert_eq!(run.ending, TrackEnding::Completed, "{name}");
        let largest = lowest(&run, 0).probes[0].deflection;
        let within = if solved.is_some() { MODEL } else { DISCRETISATION };
        assert!((largest / printed - 1.0).abs() < within, "{name}: {largest:e} {printed:e}");
        if let Some(solved) = solved {
            assert!((largest / solved - 1.0).abs() < DISCRETISATION, "{name}: {largest:e} {solved:e}");
        }
        if name == "A" {
            for (row, expected) in [(5000, 2.5643e-4), (10_000, 3.6733e-4), (15_000, 2.4006e-4)] {
                let found = run.rows[row].probes[0].deflection;
                assert!((found - expected).abs() < DISCRETISATION * 4.18545e-4, "{row}: {found:e}");
            }
        }
    }
}

/// Source: an independent calculation with the parameters of Yang and Yau's example, 100 km/h. Goal: the largest deflection (m) of the middle, acceleration (m/s²) of the mass and force
/// (N) on the bridge. Accuracy: DISCRETISATION.
#[test]
fn a_sprung_mass_crosses_as_in_yang_and_yau() {
    let track = on_two_supports(slender(2.87e9 * 2.90, 2303.0), 25.0, 40);
    let way = Way::uniform(0.0, 100.0 / 3.6, 0.0, 0.9);
    let case = TrackCase {
        probes: vec![probe(Carrier::Rail, 12.5)],
        ..case(Some(track), MASS, linear(1.595e6), way, [20e3, 0.9])
    };
    let run = run(&case);
    let row = lowest(&run, 0);
    let forces: Vec<f64> = run.rows.iter().map(|row| row.wheels[0].force).collect();
    let [least, most] = [f64::min, f64::max].map(|of| forces.iter().copied().reduce(of).unwrap());
    for (found, expected) in [
        (row.probes[0].deflection, 2.4073e-3),
        (row.x, 10.31),
        (least, 55.590e3),
        (most, 57.258e3),
        (run.rows[5000].probes[0].deflection, 1.3985e-3),
    ] {
        assert!((found / expected - 1.0).abs() < DISCRETISATION, "{found:e} {expected:e}");
    }
}

/// Source: Frýba's series with the shear branch. Goal: deflection (m) of the middle of a rail of 4 m with shear and rotary inertia under a force of 100 kN at 60 m/s, at
/// ten times. Accuracy: DISCRETISATION of the largest.
#[test]
fn a_moving_force_matches_the_series() {
    let bending = Bending { length: 4.0, bending_stiffness: 6.38e6, shear_stiffness: 2.43e8 };
    let mut section = slender(bending.bending_stiffness, 60.2);
    (section.shear_z, section.rotary_z) = (bending.shear_stiffness, 0.2385);
    let span = Span { bending, mass_per_length: 60.2, rotary_inertia: 0.2385 };
    let way = Way::uniform(0.0, 60.0, 0.0, 1.0);
    let case = TrackCase {
        running: Running::Force,
        force: TimeFunction::constant(1e5),
        start: Start::Above { height: 0.0, velocity: 0.0 },
        probes: vec![probe(Carrier::Rail, 2.0)],
        ..case(Some(on_two_supports(section, 4.0, 40)), 0.0, linear(1.0), way, [4000.0, 4.0 / 60.0])
    };
    let run = run(&case);
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for row in run.rows.iter().step_by(400).skip(1) {
        let exact = span.moving_force_deflection(1e5, 60.0, 2.0, row.time, 200);
        worst = worst.max((row.probes[0].deflection - exact).abs());
        largest = largest.max(exact);
    }
    assert!(worst < DISCRETISATION * largest, "{worst:e} of {largest:e}");
}

/// Source: energy, `facts` of drops: a mass that falls on Hertz's contact (9.239e10 N/m^1.5) or on the published law, gravity during the contact left out. Goal: largest force (N) and approach (m), and the
/// time of contact (s). Accuracy: DISCRETISATION; of the time twice that, for it is counted in microseconds.
#[test]
fn a_wheel_falls_on_a_rail_that_does_not_move() {
    // k(f) = 1.5·C^(2/3)·f^(1/3), with forces in kN
    let hertz = StiffnessLaw { a: 0.0, b: 1.5 * 9.239e10_f64.powf(2.0 / 3.0) * 10.0, c: 1.0 / 3.0 };
    for (law, mass, height, force, approach, time) in [
        (hertz, 283.0, 0.010, 309.8e3, 0.2240e-3, Some(1.489e-3)),
        (hertz, 1000.0, 0.001, 165.96e3, 0.1478e-3, Some(3.105e-3)),
        (hertz, 1000.0, 0.010, 660.7e3, 0.3712e-3, Some(2.466e-3)),
        (StiffnessLaw::published(), 283.0, 0.010, 235.0e3, 0.2716e-3, None),
        (StiffnessLaw::published(), 1000.0, 0.001, 130.45e3, 0.1728e-3, None),
        (StiffnessLaw::published(), 1000.0, 0.010, 480.4e3, 0.4701e-3, None),
    ] {
        let wheels = Wheels { law: law.into(), ..linear(1.0) };
        let way = Way::uniform(0.0, 0.0, 0.0, 1.0);
        let velocity = f64::sqrt(2.0 * 9.81 * height);
        let case = TrackCase {
            gravity: 0.0,
            start: Start::Above { height: 0.0, velocity },
            ..case(None, mass, wheels, way, [5000.0, 5e-3])
        };
        let run = run(&case);
        let of = |value: fn(&WheelRow) -> f64| {
            run.rows.iter().map(|row| value(&row.wheels[0])).fold(0.0, f64::max)
        };
        let touching = run.rows.iter().filter(|row| row.wheels[0].force > 0.0).count() as f64 * 1e-6;
        for (found, expected) in [(of(|w| w.force), force), (of(|w| w.approach), approach)] {
            assert!(
                (found / expected - 1.0).abs() < DISCRETISATION,
                "{mass} {height}: {found:e} {expected:e}"
            );
        }
        if let Some(time) = time {
            assert!(
                (touching / time - 1.0).abs() < 2.0 * DISCRETISATION,
                "{mass} {height}: {touching:e} {time:e}"
            );
        }
    }
}
