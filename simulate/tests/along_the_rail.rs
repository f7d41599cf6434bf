//! The condensed element in time where the wheel stands or rolls near a held end, against the transient solids there.

use std::f64::consts::PI;

use railspring_calibrate::beam::RailBeam;
use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::mesh::{HexMesh, MeshOptions, mesh_rail_between, mesh_wheel};
use railspring_calibrate::pair::{
    AngleSettings, CondensedPair, ContactConditions, Orders, Pair, PairBody, PairSolids, PressDirection,
    SeriesBeam, law_by_shift,
};
use railspring_calibrate::solid::{Formulation, Material, Materials};
use railspring_calibrate::superelement::CondensedBody;
use railspring_element::pair_element::PairElement;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use railspring_simulate::element::condensed::parts::{ElementBodies, PlaceApproaches};
use railspring_simulate::element::condensed::{CondensedModel, fitted_element};
use railspring_simulate::solid::{ModeCount, TransientModel};
use railspring_simulate::time::function::{HarmonicForce, TimeFunction};
use railspring_simulate::time::history::{History, HistoryRow};
use railspring_simulate::time::scenario::{Kelvin, Scenario};
use railspring_simulate::time::steps::{InnerSteps, StepControl};

const LENGTH: f64 = 0.555;
const MODES: usize = 64;
const CONTACT: ContactConditions =
    ContactConditions { friction: 0.5, enforcement: Enforcement::Exact, field: ContactField::Hybrid };

fn steel() -> Material {
    Material { damping: 0.02 / (PI * 1000.0), ..Material::STEEL }
}

fn options() -> MeshOptions {
    MeshOptions { contact_half_length: 24e-3, ..MeshOptions::default() }
}

/// Load case 4.2 over its first 60 ms.
fn sine() -> Scenario {
    let suspension = Kelvin { stiffness: 1.2e6, damping: 4e4 };
    let force = |constant: f64, amplitude: f64| {
        TimeFunction::from(HarmonicForce { constant, amplitude, frequency: 10.0, phase: 0.0 })
    };
    Scenario {
        suspended_mass: 6250.0,
        vertical_suspension: suspension,
        lateral_suspension: suspension,
        vertical_force: force(10e3, 61.25e3),
        lateral_force: force(0.0, 10.4125e3),
        ..Scenario::new(120, 5e-4, CONTACT.friction)
    }
}

fn condensed(pair: &Pair, wheel: &HexMesh, x: f64, body: PairBody) -> CondensedBody {
    let rail = mesh_rail_between(&pair.rail, &pair.placed, [x, LENGTH - x], &options()).unwrap();
    let (steel, element) = (Materials::from(steel()), Formulation::IncompatibleModes);
    let (materials, orders) = ([&steel; 2], Orders::default());
    let solids = PairSolids { pair, rail: &rail, wheel, materials, element, orders: &orders };
    solids.condense_in_time(body, solids.key(body), MODES).unwrap()
}

/// The element of the pair, from laws with the contact in the middle of the rail, and its beam.
fn element(pair: &Pair, rail: CondensedBody, wheel: CondensedBody) -> (PairElement, RailBeam) {
    let bodies = CondensedPair::new(vec![(PairBody::RailOnEnds, rail), (PairBody::Wheel, wheel)]).unwrap();
    let loads = [10e3, 20e3, 40e3, 60e3, 80e3, 120e3];
    let settings = AngleSettings {
        contact: CONTACT,
        direction: PressDirection::Normal,
        loads: &loads,
        fixed_loads: &loads[1..],
        stresses: false,
    };
    let shifts =
        [-4e-3, -2e-3, 0.0, 2e-3, 4e-3, 6e-3, 6.5e-3, 6.58e-3, 7e-3].map(|shift| pair.tape_y + shift);
    let laws = law_by_shift(pair, &bodies, &settings, &shifts, &Silent).unwrap();
    let places: Vec<PlaceApproaches> = laws.iter().filter_map(PlaceApproaches::of).collect();
    let beam = pair.beam(&steel(), LENGTH, 20).unwrap();
    let parts = ElementBodies::new(pair, &bodies, LENGTH).unwrap();
    let element = fitted_element(&parts, (&beam, [&steel(); 2]), places, CONTACT.friction).unwrap();
    let correction = SeriesBeam::new(pair, &bodies, &beam).unwrap().correction;
    (element, beam.corrected(&correction).unwrap())
}

/// P and Q against the solid's, RMS over the solid's peak.
fn off(found: &History, solid: &History) -> [f64; 2] {
    let of = |value: fn(&HistoryRow) -> f64| {
        let peak = solid.rows.iter().map(|row| value(row).abs()).fold(0.0, f64::max);
        let rows = found.rows.iter().zip(&solid.rows);
        let square: f64 = rows.map(|(a, b)| (value(a) - value(b)).powi(2)).sum();
        (square / solid.rows.len() as f64).sqrt() / peak
    };
    assert_eq!(found.rows.len(), solid.rows.len());
    [of(|row| row.vertical_force), of(|row| row.lateral_force)]
}

/// Source: the transient solids with the contact zone 60 mm from a held end. Goal: P and Q of load case 4.2
/// over 60 ms (RMS over the solids' peaks) of the condensed element that stands there, and of one that rolls
/// past that place. It rolls at 0.5 m/s, as in the publication's case with motion, and moves by 30 mm in 60
/// ms. Accuracy: MODEL, twice the 2.8 % of P and 1.2 % of Q by which it is off in the middle of the rail, on
/// the same bodies: near an end the beam has less of the motion, and what moves at once more. A wheel in the
/// middle of the rail is 20 and 5 % off the solids there.
#[test]
#[ignore = "a quarter of a minute: cargo long along_the_rail"]
fn a_wheel_near_a_held_end_follows_the_solids_there() {
    const MODEL: [f64; 2] = [0.056, 0.024];
    const PLACE: f64 = 0.06;
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let mesh = mesh_wheel(&pair.wheel, &options()).unwrap();
    let wheel = condensed(&pair, &mesh, 0.5 * LENGTH, PairBody::Wheel);
    let near = condensed(&pair, &mesh, PLACE, PairBody::RailOnEnds);
    let contact = (CONTACT.enforcement, CONTACT.field);
    let solid =
        TransientModel::reduced(&pair, [&near, &wheel], ModeCount::Given(MODES), steel().damping, contact)
            .unwrap();
    let adaptive = Scenario { inner_steps: InnerSteps::Adaptive(StepControl::DEFAULT), ..sine() };
    let solid = solid.run(&adaptive, &Silent).unwrap().history;
    let middle = condensed(&pair, &mesh, 0.5 * LENGTH, PairBody::RailOnEnds);
    let (element, beam) = element(&pair, middle, wheel);
    let model = CondensedModel::of_pair(&pair, beam, [&steel(); 2], element);
    let run = |speed: f64, from: f64| {
        let inner_steps = InnerSteps::Equal(16);
        let scenario = Scenario { start_x: Some(from), speed, inner_steps, ..sine() };
        off(&model.run(&scenario, &Silent).unwrap().history, &solid)
    };
    let [standing, rolling, elsewhere] = [run(0.0, PLACE), run(0.5, PLACE - 0.015), run(0.0, 0.5 * LENGTH)];
    println!("standing {standing:.4?}, rolling {rolling:.4?}, in the middle of the rail {elsewhere:.4?}");
    for found in [standing, rolling] {
        assert!(found[0] < MODEL[0] && found[1] < MODEL[1], "{found:?}");
    }
    assert!(elsewhere[0] > 2.0 * MODEL[0] && elsewhere[1] > MODEL[1], "{elsewhere:?}");
}
