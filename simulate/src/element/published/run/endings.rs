//! Runs that end before their last step, and load cases without a suspended mass.

use super::tests::{bridge, flat, profile, published, published_scenario, quiet, relative, rigid};
use super::*;
use crate::element::published::RailSupport;
use crate::time::function::{HarmonicForce, TimeFunction};
use crate::time::history::{Ending, SurfaceEnd};
use crate::time::scenario::Kelvin;
use crate::time::steps::InnerSteps;
use railspring_calibrate::law::StiffnessLaw;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::Departure;
use railspring_profiles::profile::ProfileCurve;

/// How far the wheel of `history` got to the side at its last state, m.
fn last_y(run: &MovingRun) -> f64 {
    run.history.rows.last().unwrap().wheel_y
}

/// Source: free fall to the side, y = Q·t²/(2m), under a force far above the friction of 0.5 times the vertical force.
/// Goal: a wheel pulled into the track with 500 kN falls off the head; the run ends there (s) with the history up to
/// there. The tread's end of the profile, 60 mm from the tape circle, passes the gauge face, 32.5 mm inside of it: 92.5 mm at
/// most, 67 mm at least when the end of the tread is the last to touch. Friction is below 5 % of the force.
#[test]
fn a_wheel_pulled_into_the_track_falls_off() {
    const MODEL: f64 = 0.05;
    let run = published().run(&published_scenario(TimeFunction::constant(-500e3)), &Silent).unwrap();
    let Ending::Departed { time, departure } = run.history.ending else { panic!("{}", run.history.ending) };
    assert_eq!(departure, Departure::GaugeSide);
    let fall = |y: f64| (2.0 * y * 283.0 / 500e3).sqrt();
    let step = 5e-4;
    assert!(((1.0 - MODEL) * fall(67e-3)..(1.0 + MODEL) * fall(92.5e-3) + step).contains(&time), "{time}");
    assert!((-92.5e-3..-60e-3).contains(&last_y(&run)), "{}", last_y(&run));
    let rows = &run.history.rows;
    assert!((rows.last().unwrap().time - (time - step)).abs() < 1e-12);
    assert_eq!((rows.len(), run.rail.len()), ((time / step).round() as usize, rows.len()));
    assert!(run.history.ending.to_string().starts_with("left the profile at 0.01"), "{}", run.history.ending);
}

/// Source: free fall, `y = Q·t²/2m` and `z = F·t²/2m`. Goal: a wheel that is pulled up off the rail flies to the end of the run, however far; pushed aside as well, until its flange is
/// past the rail's head, 0.11 m from where it started. Nothing touches on the way, with long steps and short ones: not the tangents beyond the ends of the profile, where the
/// wheel is further away from the rail than its flange is round (13 mm). Accuracy: average acceleration is exact under a constant force; SOLVER: the balance of forces in a step, 1e-8.
#[test]
fn a_wheel_that_is_pulled_up_flies() {
    const SOLVER: f64 = 1e-8;
    const MASS: f64 = 283.0;
    for (up, aside, inner) in [
        (260e3, 0.0, 16),
        (260e3, 0.0, 1),
        (5e3, 0.0, 16),
        (5e3, -20e3, 4),
        (60e3, 20e3, 16),
        (60e3, 20e3, 1),
    ] {
        let scenario = Scenario {
            steps: 400,
            suspended_mass: 0.0,
            vertical_force: TimeFunction::constant(-up),
            inner_steps: InnerSteps::Equal(inner),
            ..published_scenario(TimeFunction::constant(aside))
        };
        let run = published().run(&scenario, &Silent).unwrap();
        let rows = &run.history.rows;
        for row in &rows[1..] {
            let half = 0.5 * row.time * row.time / MASS;
            assert!(row.contacts.is_empty() && row.vertical_force == 0.0, "{up} {aside} {inner}: {row:?}");
            let off = (row.wheel_y - aside * half).abs().max((row.wheel_z + up * half).abs());
            assert!(off < SOLVER * up * half, "{up} {aside} {inner}: {off:e} at {} s", row.time);
        }
        match run.history.ending {
            Ending::Completed => assert!(aside == 0.0 && rows.len() == 401, "{up} {aside} {inner}"),
            Ending::Departed { time, .. } => {
                let way = 0.5 * aside.abs() * time * time / MASS;
                assert!((0.092..0.118).contains(&way), "{up} {aside} {inner}: {way}");
            }
            ref ending => panic!("{up} {aside} {inner}: {ending}"),
        }
    }
}

/// Goal: a wheel that is pushed aside while it is pulled up meets the gauge corner with its flange on the way, and goes over it to the field side, slowly or so hard that the friction
/// limits of the flange settle slowly.
#[test]
fn a_wheel_that_is_pulled_up_beside_the_rail_goes_over_it() {
    for (up, aside, suspended_mass, inner) in
        [(5e3, 20e3, 0.0, 16), (20e3, 40e3, 0.0, 16), (20e3, 40e3, 0.0, 4), (60e3, 40e3, 6250.0, 16)]
    {
        let scenario = Scenario {
            steps: 400,
            suspended_mass,
            vertical_force: TimeFunction::constant(-up),
            inner_steps: InnerSteps::Equal(inner),
            ..published_scenario(TimeFunction::constant(aside))
        };
        let run = published().run(&scenario, &Silent).unwrap();
        let Ending::Departed { time, departure } = run.history.ending else {
            panic!("{}", run.history.ending)
        };
        assert_eq!(departure, Departure::FieldSide);
        let fall = (2.0 * 0.1 * 283.0 / aside).sqrt();
        assert!(time > fall && last_y(&run) > 0.09, "{time} {fall} {}", last_y(&run));
        let touched = run.history.rows.iter().any(|row| row.lateral_force > 20e3);
        assert!(touched, "the flange does not meet the rail");
    }
}

/// Source: Nadal. Goal: 200 kN sideways against 10 kN down, with friction 0.5 on a flange of 70°, is beyond any limit of climbing
/// (Q/P = 20 against 0.95): the wheel rises by its flange of 28 mm and goes over the rail to the field side.
#[test]
fn a_wheel_beyond_nadal_climbs_out() {
    let run = published().run(&published_scenario(TimeFunction::constant(200e3)), &Silent).unwrap();
    let Ending::Departed { time, departure } = run.history.ending else { panic!("{}", run.history.ending) };
    assert_eq!(departure, Departure::FieldSide);
    assert!((0.02..0.2).contains(&time), "{time}");
    let highest = run.history.rows.iter().map(|r| -r.wheel_z).fold(0.0, f64::max);
    assert!(highest > 27e-3, "{highest}");
    assert!(run.history.rows.iter().all(|r| r.wheel_y < 0.12), "no state is off the rail");
    // Below the limit the same flange holds it.
    let held = published().run(&published_scenario(TimeFunction::constant(20e3)), &Silent).unwrap();
    assert_eq!(held.history.ending, Ending::Completed);
}

/// Goal: 500 kN towards the field side for 200 steps end within the bound on the evaluations, with a
/// departure to the field side or with an error that names the bound. The law is the published one or one
/// that starts from zero stiffness.
#[test]
fn work_is_bounded() {
    for a in [StiffnessLaw::published().a, 0.0] {
        let mut scenario = published_scenario(TimeFunction::constant(500e3));
        scenario.steps = 200;
        let mut model = published();
        model.springs.normal = StiffnessLaw { a, ..StiffnessLaw::published() }.into();
        let result = model.run(&scenario, &Silent);

        match result {
            Ok(run) => {
                let departure = Departure::FieldSide;
                assert!(
                    matches!(run.history.ending, Ending::Departed { departure: d, .. } if d == departure)
                );
                assert!(run.statistics.evaluations < 50_000 + 200 * run.history.rows.len());
            }
            Err(error) => assert!(error.to_string().contains("bound on the iterations"), "{error}"),
        }
    }
}

/// Goal: a wheel that slides along a profile of 80 mm leaves it at its end, 40 mm from where it started, on either side.
#[test]
fn a_wheel_slides_off_the_profile() {
    for (speed, departure) in [(20.0, Departure::FieldSide), (-20.0, Departure::GaugeSide)] {
        let mut model = flat(StiffnessLaw::published(), 283.0);
        model.initial.velocity = [speed, 0.01];
        let mut scenario = quiet(100, 1e-4);
        (scenario.gravity, scenario.friction) = (9.81, 0.0);
        let run = model.run(&scenario, &Silent).unwrap();
        // After 20 steps of 2 mm the last point of the profile carries the load.
        assert_eq!(run.history.ending, Ending::Departed { time: 0.002, departure });
        assert!((last_y(&run).abs() - 0.038).abs() < 1e-6, "{}", last_y(&run));
    }
}

/// Source: two parabolas that touch, the wheel's hollow of the larger radius: moved aside by d, the contact
/// goes to d/(1 - Rw/Rr), to the other side. Goal: a wheel that is hollow by 1/375 mm on a rail crowned by
/// 1/300 mm slides 10 mm to the field side. Its contact goes four times as far to the gauge side, to the end
/// of the rail's profile at -40 mm. The run keeps the 4 steps before that and says where the profile is too
/// short, instead of an error or a wheel off the rail. Mirrored it ends at the other end. Accuracy: a step of
/// 2 mm (0.1 ms).
#[test]
fn a_profile_that_is_too_short_ends_the_history() {
    const CROWN: f64 = 0.3;
    const HOLLOW: f64 = 0.375;
    for side in [1.0, -1.0] {
        let hollow: Vec<_> =
            (-60..=60).map(|i| 1e-3 * f64::from(i)).map(|y| Point2::new(y, y * y / (2.0 * HOLLOW))).collect();
        let hollow = ProfileCurve::from_points(&hollow, &[]).unwrap();
        let mut model =
            rigid(profile(|y| y * y / (2.0 * CROWN), &[]), hollow, 0.0, StiffnessLaw::published(), 283.0);
        model.initial.velocity = [side * 20.0, 0.01];
        let mut scenario = quiet(100, 1e-4);
        (scenario.gravity, scenario.friction) = (9.81, 0.0);
        let run = model.run(&scenario, &Silent).unwrap();
        let Ending::EndOfSurface { time, end, rail } = run.history.ending else {
            panic!("{}", run.history.ending)
        };
        assert_eq!(end, SurfaceEnd::RailProfile);
        assert!((time - 5e-4).abs() < 1.01e-4, "{time}");
        assert!(
            (rail.x + side * 0.04).abs() < 1e-9 && (rail.y - 0.04_f64.powi(2) / (2.0 * CROWN)).abs() < 1e-6
        );
        let rows = &run.history.rows;
        assert_eq!((rows.len(), run.rail.len()), ((time / 1e-4).round() as usize, rows.len()));
        assert!((rows.last().unwrap().time - (time - 1e-4)).abs() < 1e-12);
        assert!(side * last_y(&run) > 5e-3, "the wheel has moved to the other side: {}", last_y(&run));
    }
}

/// Goal: a wheel at 0.5 m/s that starts 55 mm from the rail's end leaves it after 0.11 s: 220 steps of 0.5 ms are on the rail.
#[test]
fn a_wheel_runs_off_the_end() {
    let mut scenario = published_scenario(HarmonicForce::NONE);
    (scenario.start_x, scenario.speed) = (Some(0.5), 0.5);
    let run = published().run(&scenario, &Silent).unwrap();
    let Ending::Departed { time, departure } = run.history.ending else { panic!("{}", run.history.ending) };
    assert_eq!(departure, Departure::RailEnd);
    assert!((time - 0.1105).abs() < 1e-12, "{time}");
    assert_eq!(run.history.rows.len(), 221);
}

/// Source: statics. Goal: without a suspended mass the vertical force (N) reaches the rail, unchanged, whatever spring and damper
/// transmit it, the first step included.
/// SOLVER: the balance of forces. DISCRETISATION: the wheel's spline lies within a nanometre of its arc, 2e-6 of the spring's 0.5 mm.
#[test]
fn a_force_without_suspended_mass_reaches_the_rail() {
    const SOLVER: f64 = 1e-7;
    const DISCRETISATION: f64 = 1e-5;
    for (stiffness, damping) in [(0.0, 0.0), (1.2e6, 4e4), (0.0, 4e4), (1.2e6, 0.0)] {
        // At rest on a linear spring under 50 kN.
        let mut model = flat(StiffnessLaw { a: 1e8, b: 0.0, c: 0.0 }, 283.0);
        model.initial.displacement[1] = 50e3 / 1e8 + 50e3 / model.penalty;
        let mut scenario = quiet(50, 1e-4);
        scenario.vertical_force = TimeFunction::constant(50e3);
        scenario.vertical_suspension = Kelvin { stiffness, damping };
        let run = model.run(&scenario, &Silent).unwrap();
        for row in &run.history.rows[1..] {
            let force = row.vertical_force;
            assert!(relative(force, 50e3) < DISCRETISATION, "{stiffness} {damping}: {force}");
        }
    }
    // From a force that sets in at once every chain gives the same motion.
    let sudden = |stiffness, damping| {
        let mut scenario = quiet(50, 1e-4);
        scenario.vertical_force = TimeFunction::constant(50e3);
        scenario.vertical_suspension = Kelvin { stiffness, damping };
        flat(StiffnessLaw::published(), 283.0).run(&scenario, &Silent).unwrap().history
    };
    let bare = sudden(0.0, 0.0);
    assert!(bare.rows.iter().any(|row| row.vertical_force > 80e3));
    for (a, b) in bare.rows.iter().zip(&sudden(1.2e6, 4e4).rows) {
        assert!((a.wheel_z - b.wheel_z).abs() < SOLVER * 1e-3, "{} s", a.time);
    }
}

/// Goal: a mass that no spring and no damper carries, and values that are not finite, are refused with their key.
#[test]
fn load_cases_without_sense_are_named() {
    let model = flat(StiffnessLaw::published(), 283.0);
    let mut loose = quiet(1, 1e-4);
    loose.suspended_mass = 1000.0;
    let message = model.run(&loose, &Silent).unwrap_err().to_string();
    assert!(message.contains("vertical_suspension.stiffness"), "{message}");
    let endless = Scenario { lateral_force: TimeFunction::constant(f64::INFINITY), ..quiet(1, 1e-4) };
    assert!(model.run(&endless, &Silent).unwrap_err().to_string().contains("lateral_force"));
    let mut lost = model.clone();
    lost.initial.velocity[0] = f64::NAN;
    assert!(lost.run(&quiet(1, 1e-4), &Silent).unwrap_err().to_string().contains("initial motion"));
    // A finite force beyond what the numbers hold.
    let huge = Scenario { lateral_force: TimeFunction::constant(1e308), ..quiet(3, 1.0) };
    assert!(model.run(&huge, &Silent).unwrap_err().to_string().contains("not finite"));
}

/// Source: publication, figure 3: spring and damper between wheel and force. Goal: they change the travel of the loading point and
/// nothing else; from rest the travel differs from the wheel's by the closed lengthening.
#[test]
fn lateral_suspension_moves_the_loading_point_only() {
    const ROUNDOFF: f64 = 1e-15;
    let mut scenario = published_scenario(TimeFunction::constant(20e3));
    scenario.steps = 40;
    let soft = published().run(&scenario, &Silent).unwrap().history;
    scenario.lateral_suspension = Kelvin { stiffness: 0.0, damping: 0.0 };
    let rigid = published().run(&scenario, &Silent).unwrap().history;
    for (a, b) in soft.rows.iter().zip(&rigid.rows) {
        assert_eq!((a.wheel_y, a.lateral_force), (b.wheel_y, b.lateral_force));
        assert_eq!(b.load_y, b.wheel_y);
        let lengthening = 20e3 / 1.2e6 * (1.0 - (-30.0 * a.time).exp());
        assert!((a.load_y - a.wheel_y - lengthening).abs() < ROUNDOFF, "{} s", a.time);
    }
    assert!(soft.rows[40].load_y - soft.rows[40].wheel_y > 7e-3);
}

/// Source: statics of the contact: one node carries F/penalty where the spring has δ(F). Goal: the penalty's error on a bridge of 25 m that
/// swings under a force at its first natural frequency is that of the springs, whatever the bridge does; at most two nodes share
/// the load.
/// DISCRETISATION: half of it less a tenth, since no step need fall on the peak of the force.
#[test]
fn penalty_error_does_not_depend_on_the_beam() {
    const DISCRETISATION: f64 = 1e-3;
    let (young, inertia, density, length): (f64, f64, f64, f64) = (3.5e10, 1.3901, 18358.0, 25.0);
    let beam = bridge(young, inertia, density, length, 10);
    let frequency = std::f64::consts::PI / 2.0 * (young * inertia / density).sqrt() / (length * length);
    let mut model = flat(StiffnessLaw::published(), 1000.0);
    model.support = RailSupport::Beam { beam, node_line: nalgebra::Point2::origin(), damping: 0.0 };
    let mut scenario = quiet(1000, 1e-3);
    scenario.vertical_force = HarmonicForce { constant: 60e3, amplitude: 40e3, frequency, phase: 0.0 }.into();
    let run = model.run(&scenario, &Silent).unwrap();
    let highest = run.rail.iter().map(|section| -section.displacement[1]).fold(0.0, f64::max);
    assert!(highest > 1e-4, "the bridge does not swing up: {highest}");
    let most = run.history.rows.iter().map(|row| row.vertical_force).fold(0.0, f64::max);
    let error = most / model.penalty / model.springs.normal.displacement(most);
    let found = run.statistics.penalty_error;
    assert!((0.45 * error..(1.0 + DISCRETISATION) * error).contains(&found), "{found} of {error}");
}

/// Source: equations (3) and (4) of the publication, which have the same forces. Goal: the published cases 4.1 and 4.2 run to their end with
/// the symmetric matrix, and their forces (N) are those of the consistent one.
/// SOLVER: a balance of 1e-8 of the forces at work in each step, kept or amplified a hundred times over the steps.
#[test]
fn the_symmetric_matrix_runs_the_published_cases() {
    const SOLVER: f64 = 1e-6;
    let lateral = [
        HarmonicForce::constant(20e3),
        HarmonicForce { amplitude: 10.4125e3, frequency: 10.0, ..HarmonicForce::NONE },
    ];
    for lateral in lateral {
        let scenario = published_scenario(lateral);
        let consistent = published().run(&scenario, &Silent).unwrap();
        let mut model = published();
        model.sliding = SlidingMatrix::Symmetric;
        let symmetric = model.run(&scenario, &Silent).unwrap();
        assert_eq!(symmetric.history.ending, Ending::Completed);
        let largest = consistent.history.rows.iter().map(|row| row.vertical_force).fold(0.0, f64::max);
        for (a, b) in consistent.history.rows.iter().zip(&symmetric.history.rows) {
            assert!((a.vertical_force - b.vertical_force).abs() < SOLVER * largest, "{} s", a.time);
            assert!((a.lateral_force - b.lateral_force).abs() < SOLVER * largest, "{} s", a.time);
        }
        // It does end steps; the others are done with equation (3).
        let by_symmetric = 550 - symmetric.statistics.consistent_steps;
        assert!((50..550).contains(&by_symmetric), "{:?}", symmetric.statistics);
        assert!(symmetric.statistics.iterations > consistent.statistics.iterations, "another matrix");
        assert_eq!(consistent.statistics.consistent_steps, 0);
        // With the publication's penalty it ends nearly all.
        model.penalty = 1e9;
        let soft = model.run(&scenario, &Silent).unwrap().statistics;
        assert!(soft.consistent_steps < 40 && soft.penalty_error > 0.1, "{soft:?}");
    }
}
