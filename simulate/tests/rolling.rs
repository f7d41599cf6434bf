//! The transient solids with a wheel that stands anywhere on its rail, and one that moves along it, against solids whose contact zone is at the place.

use std::f64::consts::PI;

use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::mesh::{MeshOptions, mesh_rail_between, mesh_wheel};
use railspring_calibrate::pair::{Orders, Pair, PairBody, PairSolids};
use railspring_calibrate::solid::{Formulation, Material, Materials};
use railspring_calibrate::superelement::CondensedBody;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use railspring_simulate::solid::{ModeCount, RailPath, TransientModel};
use railspring_simulate::time::function::TimeFunction;
use railspring_simulate::time::history::{History, HistoryRow};
use railspring_simulate::time::scenario::Scenario;

const LENGTH: f64 = 0.4;
const MODES: usize = 32;
const ELEMENT: Formulation = Formulation::IncompatibleModes;
const CONTACT: (Enforcement, ContactField) = (Enforcement::Exact, ContactField::Hybrid);

fn options() -> MeshOptions {
    MeshOptions { contact_element: 6e-3, contact_element_along: 4e-3, ..MeshOptions::default() }
}

fn pair() -> Pair {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap()
}

/// A body with the contact zone of the rail at a distance (m) from its first end.
fn condensed(pair: &Pair, material: Material, x: f64, body: PairBody) -> CondensedBody {
    let rail = mesh_rail_between(&pair.rail, &pair.placed, [x, LENGTH - x], &options()).unwrap();
    let wheel = mesh_wheel(&pair.wheel, &options()).unwrap();
    let orders = &Orders::default();
    let materials = Materials::from(material);
    let materials = [&materials; 2];
    let solids = PairSolids { pair, rail: &rail, wheel: &wheel, materials, element: ELEMENT, orders };
    solids.condense_in_time(body, String::new(), MODES).unwrap()
}

/// A wheel that is pressed down and to the field side: it bounces.
fn pressed(steps: usize, friction: f64) -> Scenario {
    Scenario {
        vertical_force: TimeFunction::constant(60e3),
        lateral_force: TimeFunction::constant(10e3),
        ..Scenario::new(steps, 2.5e-4, friction)
    }
}

/// RMS of the difference of P and of Q over the largest value of the second history.
fn off(found: &History, exact: &History) -> [f64; 2] {
    assert_eq!(found.rows.len(), exact.rows.len());
    [|row: &HistoryRow| row.vertical_force, |row: &HistoryRow| row.lateral_force].map(|force| {
        let peak = exact.rows.iter().map(|row| force(row).abs()).fold(0.0, f64::max);
        let squares: f64 =
            found.rows.iter().zip(&exact.rows).map(|(a, b)| (force(a) - force(b)).powi(2)).sum();
        (squares / exact.rows.len() as f64).sqrt() / peak
    })
}

/// Source: solids whose contact zone is 80 mm from an end of a rail of 0.4 m. Goal: P and Q (N, RMS over
/// their peaks) of a wheel that is pressed on there, from the solids of the middle with the path of their
/// rail. With friction the wheel stands there. Without friction it rolls over the place at 0.1 m/s, 0.6 mm in
/// the time: with friction the rail's bending also holds a wheel that stands, but none that rolls. In the
/// middle of the rail the motion is another one. Accuracy: MODEL, 1 %, the meshes of both rails.
#[test]
fn a_wheel_along_the_rail_is_one_on_the_solids_there() {
    const MODEL: f64 = 0.01;
    const PLACE: f64 = 0.08;
    let steel = Material { damping: 0.02 / (PI * 1000.0), ..Material::STEEL };
    let pair = pair();
    let wheel = condensed(&pair, steel, 0.5 * LENGTH, PairBody::Wheel);
    let [middle, there] = [0.5 * LENGTH, PLACE].map(|x| condensed(&pair, steel, x, PairBody::RailOnEnds));
    let path = RailPath::new(&pair, &middle, &options(), &steel, ELEMENT, (LENGTH, MODES)).unwrap();
    let model = |rail, material: Material| {
        let modes = ModeCount::Given(MODES);
        TransientModel::reduced(&pair, [rail, &wheel], modes, material.damping, CONTACT).unwrap()
    };
    let moving = |material| model(&middle, material).along(&path);
    let run = |model: &TransientModel, scenario: &Scenario| model.run(scenario, &Silent).unwrap().history;

    let steps = 24;
    for (friction, speed) in [(0.5, 0.0), (0.0, 0.1)] {
        let scenario = pressed(steps, friction);
        let exact = run(&model(&there, steel), &scenario);
        let way = speed * 2.5e-4 * steps as f64;
        let over = Scenario { start_x: Some(PLACE - 0.5 * way), speed, ..scenario.clone() };
        let found = off(&run(&moving(steel), &over), &exact);
        println!("friction {friction}, {speed} m/s: {found:.5?}");
        assert!(found.iter().all(|off| *off < MODEL), "{friction} {speed}: {found:?}");
        if speed == 0.0 {
            let in_middle = off(&run(&model(&middle, steel), &scenario), &exact);
            println!("in the middle {in_middle:.4?}");
            assert!(in_middle.iter().all(|off| *off > 5.0 * MODEL), "{in_middle:?}");
        }
    }
}
