//! Runs that end before their last step.

use nalgebra::Point2;

use crate::time::function::{HarmonicForce, TimeFunction};
use crate::time::history::{Ending, SurfaceEnd};
use crate::time::scenario::Scenario;
use crate::time::steps::InnerSteps;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::Departure;
use railspring_profiles::profile::ProfileCurve;

use super::{elastic, model, published, rigid_wheel, uniform};
use crate::element::published::InitialMotion;
use crate::element::published::run_tests::{arc, profile, quiet};

/// Source: free fall to the side, y = Q·t²/(2m), as for the published element. Goal: a wheel pulled into the track with 500 kN falls off the head; the run
/// ends there (s) with the history up to there: between 67 mm, where the end of the tread is the last to touch, and 92.5 mm. Friction is below 5 %
/// of the force.
#[test]
fn a_wheel_pulled_into_the_track_falls_off() {
    const MODEL: f64 = 0.05;
    let scenario = Scenario { lateral_force: TimeFunction::constant(-500e3), ..published() };
    let run = elastic().run(&scenario, &Silent).unwrap();
    let Ending::Departed { time, departure } = run.history.ending else { panic!("{}", run.history.ending) };
    assert_eq!(departure, Departure::GaugeSide);
    let fall = |y: f64| (2.0 * y * 283.0 / 500e3).sqrt();
    let step = 5e-4;
    assert!(((1.0 - MODEL) * fall(67e-3)..(1.0 + MODEL) * fall(92.5e-3) + step).contains(&time), "{time}");
    let rows = &run.history.rows;
    assert!(rows.last().unwrap().wheel_y < -60e-3);
    assert!((0.0..=step).contains(&(time - rows.last().unwrap().time)), "{time}");
    assert_eq!(run.rail.len(), rows.len());
}

/// Source: free fall, as for the published element. Goal: a wheel that is pulled up flies to the end of the
/// run. It is pulled suddenly or slowly, with a suspended mass or without, from a rail that it just touches
/// or from one that carries it. Pushed aside as well, it goes over the rail to the field side, 0.11 m away.
/// Once it has left nothing touches. The mean of its acceleration is that of the forces (m/s²). Accuracy:
/// MODEL: the hub swings on its rim by a tenth of a millimetre, of 30 mm at least.
#[test]
fn a_wheel_that_is_pulled_up_flies() {
    const MODEL: f64 = 2e-2;
    const MASS: f64 = 283.0;
    let sudden = HarmonicForce::constant;
    let slow = HarmonicForce { amplitude: -40e3, frequency: 2.0, ..sudden(10e3) };
    let cases = [
        (sudden(-260e3), 0.0, 0.0, 16),
        (sudden(-260e3), 0.0, 0.0, 1),
        (sudden(-5e3), 0.0, 0.0, 16),
        (sudden(-50e3), 0.0, 6250.0, 16),
        (slow, 0.0, 0.0, 16),
        (slow, 0.0, 6250.0, 4),
        (sudden(-60e3), 20e3, 0.0, 16),
        (sudden(-5e3), 20e3, 0.0, 16),
        (sudden(-260e3), 40e3, 1000.0, 16),
    ];
    for (n, (vertical_force, aside, suspended_mass, inner)) in cases.into_iter().enumerate() {
        for carried in [0.0, 10e3] {
            let mut model = elastic();
            if carried > 0.0 {
                model.initial = InitialMotion { carried, ..model.initial };
            }
            let scenario = Scenario {
                steps: 500,
                vertical_force: vertical_force.into(),
                suspended_mass,
                lateral_force: TimeFunction::constant(aside),
                inner_steps: InnerSteps::Equal(inner),
                ..published()
            };
            let history = model.run(&scenario, &Silent).unwrap().history;
            let rows = &history.rows;
            let last = rows.last().unwrap();
            if aside == 0.0 {
                assert_eq!(history.ending, Ending::Completed, "case {n}");
                assert!(last.wheel_z < -30e-3, "case {n}: {}", last.wheel_z);
            } else {
                let Ending::Departed { departure, .. } = history.ending else { panic!("{}", history.ending) };
                assert_eq!(departure, Departure::FieldSide, "case {n}");
                assert!(last.wheel_y > 0.09, "case {n}: {}", last.wheel_y);
            }
            // once higher than its flange it touches no more
            let left = rows.iter().position(|row| row.wheel_z < -30e-3).unwrap();
            assert!(rows[left..].iter().all(|row| row.contacts.is_empty()), "case {n}");
            assert!(rows[left..].iter().all(|row| row.vertical_force == 0.0), "case {n}");
            if suspended_mass == 0.0 && vertical_force.amplitude == 0.0 && carried == 0.0 && aside == 0.0 {
                let fallen = 0.5 * vertical_force.constant / MASS * last.time * last.time;
                assert!((last.wheel_z / fallen - 1.0).abs() < MODEL, "case {n}: {} {fallen}", last.wheel_z);
            }
        }
    }
}

/// Source: balance of a wheel that is pushed up a flank of the angle δ, Q/P = (tan δ + µ)/(1 - µ·tan δ): 6.6 with 70° and a friction of 0.2; from µ = cot δ = 0.36 on
/// no force pushes it up. Goal: with 0.2, 200 kN sideways against 10 kN down lift the wheel by its flange of 28 mm and it goes over the rail to the field
/// side, and 20 kN do not; with 0.5, 200 kN do not either.
#[test]
fn a_wheel_is_pushed_over_the_rail() {
    let run = |force: f64, friction: f64| {
        let lateral_force = TimeFunction::constant(force);
        let scenario = Scenario { lateral_force, friction, steps: 400, ..published() };
        elastic().run(&scenario, &Silent).unwrap().history
    };
    let history = run(200e3, 0.2);
    let Ending::Departed { time, departure } = history.ending else { panic!("{}", history.ending) };
    assert_eq!(departure, Departure::FieldSide);
    assert!((0.02..0.2).contains(&time), "{time}");
    let highest = history.rows.iter().map(|r| -r.wheel_z).fold(0.0, f64::max);
    assert!(highest > 27e-3, "{highest}");
    for (force, friction) in [(20e3, 0.2), (200e3, 0.5)] {
        let history = run(force, friction);
        assert_eq!(history.ending, Ending::Completed, "{force} {friction}");
        assert!(history.rows.iter().all(|r| -r.wheel_z < 20e-3), "{force} {friction}");
    }
}

/// Goal: a wheel that slides along a profile of 80 mm leaves it at its end, some 40 mm from where it started (m), on either side.
/// Accuracy: a step of 2 mm, and the breadth of a contact of 1 µm under the arc of 0.3 m, 1 mm.
#[test]
fn a_wheel_slides_off_the_profile() {
    for (speed, departure) in [(20.0, Departure::FieldSide), (-20.0, Departure::GaugeSide)] {
        let mut model =
            model(profile(|_| 0.0, &[]), profile(arc(0.3), &[]), rigid_wheel(283.0), uniform(4e10, 0.8));
        model.initial.velocity = [speed, 0.01];
        let scenario = Scenario { gravity: 9.81, friction: 0.0, ..quiet(100, 1e-4) };
        let run = model.run(&scenario, &Silent).unwrap();
        let Ending::Departed { time, departure: found } = run.history.ending else {
            panic!("{}", run.history.ending)
        };
        assert_eq!(found, departure);
        assert!((20.0 * time - 0.039).abs() < 3e-3, "{time}");
    }
}

/// Source: two parabolas that touch, the wheel's hollow of the larger radius: moved aside by d, the contact
/// goes to d/(1 - Rw/Rr), to the other side. Goal: a wheel hollow by 1/375 mm on a rail crowned by 1/300 mm
/// slides 10 mm to one side while its contact goes to the other end of the rail's profile. The run keeps the
/// steps before that and says where the profile is too short. Accuracy: a step of 2 mm (0.1 ms), and the
/// breadth of the patch.
#[test]
fn a_profile_that_is_too_short_ends_the_history() {
    for side in [1.0, -1.0] {
        let hollow: Vec<_> =
            (-60..=60).map(|i| 1e-3 * f64::from(i)).map(|y| Point2::new(y, y * y / 0.75)).collect();
        let hollow = ProfileCurve::from_points(&hollow, &[]).unwrap();
        let crown = profile(|y| y * y / 0.6, &[]);
        let mut model = model(crown, hollow, rigid_wheel(283.0), uniform(4e10, 0.8));
        model.initial.velocity = [side * 20.0, 0.01];
        let scenario = Scenario { gravity: 9.81, friction: 0.0, ..quiet(100, 1e-4) };
        let run = model.run(&scenario, &Silent).unwrap();
        let Ending::EndOfSurface { time, end, rail } = run.history.ending else {
            panic!("{}", run.history.ending)
        };
        assert_eq!(end, SurfaceEnd::RailProfile);
        assert!((1e-4..6.1e-4).contains(&time), "{time}");
        assert!((rail.x + side * 0.04).abs() < 1e-9, "{rail}");
        assert_eq!(run.history.rows.len(), (time / 1e-4).round() as usize);
    }
}

/// Goal: a wheel at 0.5 m/s that starts 55 mm from the rail's end leaves it after 0.11 s: 220 steps of 0.5 ms are on the rail.
#[test]
fn a_wheel_runs_off_the_end() {
    let scenario = Scenario {
        start_x: Some(0.5),
        speed: 0.5,
        steps: 300,
        lateral_force: TimeFunction::default(),
        ..published()
    };
    let run = elastic().run(&scenario, &Silent).unwrap();
    let Ending::Departed { time, departure } = run.history.ending else { panic!("{}", run.history.ending) };
    assert_eq!(departure, Departure::RailEnd);
    assert!((time - 0.11).abs() < 5.1e-5, "{time}");
    assert_eq!(run.history.rows.len(), 221);
}

/// Goal: values that are not finite are refused with their key, and forces beyond what the numbers hold end as an error that says so.
#[test]
fn load_cases_without_sense_are_named() {
    let endless = Scenario { lateral_force: TimeFunction::constant(f64::INFINITY), ..published() };
    assert!(elastic().run(&endless, &Silent).unwrap_err().to_string().contains("lateral_force"));
    let mut lost = elastic();
    lost.initial.velocity[0] = f64::NAN;
    assert!(lost.run(&published(), &Silent).unwrap_err().to_string().contains("initial motion"));
    let huge = Scenario { lateral_force: TimeFunction::constant(1e308), time_step: 1e-3, ..published() };
    assert!(elastic().run(&huge, &Silent).unwrap_err().to_string().contains("not finite"));
}
