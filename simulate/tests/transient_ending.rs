//! The transient solid model without a suspended mass, and wheels that leave the rail. Coarse meshes: the oracles are
//! rigid-body motions.

use nalgebra::Vector2;
use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::contact::Surface;
use railspring_calibrate::mesh::{MeshOptions, mesh_rail, mesh_wheel};
use railspring_calibrate::solid::{Formulation, Material, Materials};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::Departure;
use railspring_profiles::placement::{TrackGeometry, place_rail, touch};
use railspring_profiles::section::{rail_section, wheel_section};
use railspring_simulate::solid::{SolidBodies, TransientModel};
use railspring_simulate::time::function::TimeFunction;
use railspring_simulate::time::history::{Ending, History, HistoryRow, SurfaceEnd};
use railspring_simulate::time::scenario::{Kelvin, Scenario};
use railspring_simulate::time::steps::InnerSteps;

/// A wheel at rest, just touching, without a suspended mass, under constant forces (N; to the field side, and down).
fn scenario(lateral: f64, vertical: f64, steps: usize, time_step: f64) -> Scenario {
    Scenario {
        vertical_force: TimeFunction::constant(vertical),
        lateral_suspension: Kelvin { stiffness: 1.2e6, damping: 4e4 },
        lateral_force: TimeFunction::constant(lateral),
        ..Scenario::new(steps, time_step, 0.0)
    }
}

/// Histories of 60E1 and S1002 on elements of 6 mm, and the mass of the meshed wheel, kg.
fn run(scenarios: &[Scenario]) -> (Vec<History>, f64) {
    run_in_zone(scenarios, MeshOptions::default().wheel_zone.field_y)
}

/// The same with a contact zone of the wheel that reaches so far to the field side, m.
fn run_in_zone(scenarios: &[Scenario], field_y: f64) -> (Vec<History>, f64) {
    let track = TrackGeometry::standard();
    let rail = rail_section("60E1").unwrap();
    let wheel = wheel_section("S1002", 0.858).unwrap();
    let placed = place_rail(&rail, &track).unwrap();
    let touching = touch(&placed, &wheel.running, track.tape_y(&wheel.running)).unwrap();
    let mut options =
        MeshOptions { contact_element: 6e-3, contact_element_along: 6e-3, ..MeshOptions::default() };
    options.wheel_zone.field_y = field_y;
    let rail_mesh = mesh_rail(&rail, &placed, 0.555, &options).unwrap();
    let wheel_mesh = mesh_wheel(&wheel, &options).unwrap();
    let tape = Vector2::new(track.tape_y(&wheel.running), touching.tape_z);
    let steel = Materials::from(Material::STEEL);
    let model = TransientModel {
        bodies: SolidBodies::Full {
            rail: &rail_mesh,
            wheel: &wheel_mesh,
            materials: [&steel; 2],
            formulation: Formulation::FullIntegration,
        },
        materials: [Material::STEEL; 2],
        placed_rail: &placed,
        rail_axis: None,
        rail_surface: Surface::extruded(&placed.curve, &rail_mesh.contact),
        wheel_surface: Surface::revolved(&wheel.running, &wheel_mesh.contact, wheel.radius, tape),
        enforcement: Enforcement::Exact,
        field: ContactField::Elements,
        path: None,
        axle: 0.0,
    };
    let runs: Vec<_> = scenarios.iter().map(|scenario| model.run(scenario, &Silent).unwrap()).collect();
    let mass = runs[0].wheel_mass;
    (runs.into_iter().map(|run| run.history).collect(), mass)
}

/// Source: Newton's second law for a rigid wheel. Goal: without a suspended mass a vertical force reaches the wheel from the first
/// moment: lifted by 50 kN it rises by F·t²/2m (m); pressed by 50 kN, with or without spring and damper, it loads the rail alike.
/// MODEL: the hub leads the centre of mass by the wheel's own deflection, 50 kN over 1 GN/m, 0.05 mm of 14 mm; twice for its swing.
/// SOLVER: the same forces by two sums.
#[test]
fn a_force_without_suspended_mass_reaches_the_wheel() {
    const MODEL: f64 = 0.01;
    const SOLVER: f64 = 1e-9;
    let lifted = scenario(0.0, -50e3, 40, 3e-4);
    let pressed = scenario(0.0, 50e3, 8, 1e-4);
    let chained =
        Scenario { vertical_suspension: Kelvin { stiffness: 1.2e6, damping: 4e4 }, ..pressed.clone() };
    let (runs, mass) = run(&[lifted, pressed, chained]);
    let last = runs[0].rows.last().unwrap();
    let rise = 50e3 * last.time.powi(2) / (2.0 * mass);
    assert!((-last.wheel_z / rise - 1.0).abs() < MODEL, "{} of {rise}", last.wheel_z);
    assert!(runs[0].rows.iter().all(|row| row.vertical_force == 0.0 && row.wheel_z.is_finite()));
    let peak = runs[1].rows.iter().map(|row| row.vertical_force).fold(0.0, f64::max);
    assert!((5e3..150e3).contains(&peak), "{peak}");
    for (bare, chained) in runs[1].rows.iter().zip(&runs[2].rows) {
        assert!((bare.vertical_force - chained.vertical_force).abs() <= SOLVER * peak, "{} s", bare.time);
        assert!((bare.wheel_z - chained.wheel_z).abs() <= SOLVER * 1e-3, "{} s", bare.time);
    }
}

/// Goal: steps within those of the history are steps: the rows of a run with two of them are every second row of the run with time steps
/// of half the length, and a wheel that leaves the rail does so at the same time. Accuracy: to the bit.
#[test]
#[ignore = "a quarter of a minute: cargo long transient_ending"]
fn inner_steps_are_steps() {
    for scenario in [scenario(2e3, 50e3, 12, 2e-4), scenario(-500e3, -10e3, 50, 1e-3)] {
        let inner = Scenario { inner_steps: InnerSteps::Equal(2), ..scenario.clone() };
        let short =
            Scenario { steps: 2 * scenario.steps, time_step: 0.5 * scenario.time_step, ..scenario.clone() };
        let (runs, _) = run(&[inner, short]);
        let [inner, short] = &runs[..] else { unreachable!("two runs") };
        assert_eq!(inner.ending, short.ending);
        assert_eq!(inner.rows.len(), (short.rows.len() - 1) / 2 + 1);
        assert!(inner.rows.len() > 10);
        for (a, b) in inner.rows.iter().zip(short.rows.iter().step_by(2)) {
            assert!((a.time - b.time).abs() < 1e-12);
            assert_eq!(HistoryRow { time: b.time, load_y: b.load_y, ..a.clone() }, *b, "{} s", a.time);
        }
    }
}

/// Source: free fall to the side, y = Q·t²/(2m). Goal: the wheel is pulled into the track by 500 kN. It
/// leaves the rail when the end of its tread, 60 mm from the tape circle at 750 mm, has passed the gauge face
/// at 717.5 mm or the rail below it. That is after 92.5 mm at most, 85 mm at least.
#[test]
fn a_wheel_pulled_into_the_track_leaves_the_solid_rail() {
    const MODEL: f64 = 0.02;
    let step = 5e-4;
    let (runs, mass) = run(&[scenario(-500e3, -10e3, 100, step)]);
    let Ending::Departed { time, departure } = runs[0].ending else { panic!("{}", runs[0].ending) };
    assert_eq!(departure, Departure::GaugeSide);
    let fall = |y: f64| (2.0 * y * mass / 500e3).sqrt();
    assert!(((1.0 - MODEL) * fall(85e-3)..(1.0 + MODEL) * fall(92.5e-3) + step).contains(&time), "{time}");
    assert!((runs[0].rows.last().unwrap().time - (time - step)).abs() < 1e-12);
}

/// Source: the same run with fewer steps. Goal: a wheel is pressed down by 50 kN and pulled into the track by
/// 200 kN. Its contact goes to the field side of its tread, to the end of the meshed contact zone there. The
/// history ends before that, with time (s) and place (m) on the rail, instead of an error. It has the states
/// of the shorter run to the bit. Accuracy: DISCRETISATION, the place within an element of the last contact,
/// and that within two of the end of the zone.
#[test]
fn a_contact_at_the_end_of_the_zone_ends_the_history() {
    const DISCRETISATION: f64 = 6e-3;
    const ZONE: f64 = 24e-3;
    let step = 5e-4;
    let pulled = scenario(-200e3, 50e3, 40, step);
    let (runs, _) = run_in_zone(std::slice::from_ref(&pulled), ZONE);
    let Ending::EndOfSurface { time, end, rail } = runs[0].ending else { panic!("{}", runs[0].ending) };
    assert_eq!(end, SurfaceEnd::ContactZone);
    let rows = &runs[0].rows;
    let last = rows.last().unwrap();
    assert!((5..40).contains(&rows.len()), "{}", rows.len());
    assert!((last.time - (time - step)).abs() < 1e-12, "{time}");
    let contact = last.contacts.last().unwrap();
    assert!((contact.rail - rail).norm() < DISCRETISATION, "{rail} {contact:?}");
    assert!((ZONE - 2.0 * DISCRETISATION..ZONE).contains(&contact.wheel.x), "{contact:?}");

    let shorter = Scenario { steps: rows.len() - 1, ..pulled };
    let (shorter, _) = run_in_zone(&[shorter], ZONE);
    assert_eq!(shorter[0].ending, Ending::Completed);
    assert_eq!(shorter[0].rows, *rows);
}
