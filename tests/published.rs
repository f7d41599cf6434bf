//! The published constants are in one data file; code and studies agree with it.
//!
//! Source: `data/published/ju-2016.json`, values as printed. Accuracy: exact
//! up to the conversion of units.

use std::path::Path;

use railspring::study::Study;
use railspring::verify::Limits;
use railspring_calibrate::law::{REFERENCE_FORCE, StiffnessLaw};
use serde_json::Value;

/// ROUNDOFF: one multiplication by a power of ten.
const ROUNDOFF: f64 = 1e-14;

fn published() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/published/ju-2016.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[track_caller]
fn same(found: f64, published: &Value, unit: f64) {
    let expected = published.as_f64().expect("a number in the file") * unit;
    assert!((found - expected).abs() <= ROUNDOFF * expected.abs(), "{found}, published {expected}");
}

fn study(name: &str) -> Study {
    Study::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data/studies").join(name)).unwrap()
}

#[test]
fn the_law_is_the_published_one() {
    let (file, law) = (&published()["stiffness_law"], StiffnessLaw::published());
    same(law.a, &file["a_kn_per_m"], 1e3);
    same(law.b, &file["b_kn_per_m"], 1e3);
    same(law.c, &file["c"], 1.0);
    same(REFERENCE_FORCE, &file["f0_kn"], 1e3);
}

#[test]
fn the_studies_are_the_published_examples() {
    let file = &published()["example"];
    let constant = study("uic60-s1002.toml");
    let sine = study("uic60-s1002-sine.toml");
    let torsion = &sine.scenarios["torsion"].scenario;
    for (study, name) in [(&constant, "constant"), (&sine, "sine"), (&sine, "torsion")] {
        let scenario = &study.scenarios[name].scenario;
        same(study.wheel.tape_diameter, &file["wheel_diameter_m"], 1.0);
        same(study.rail.length, &file["rail_length_m"], 1.0);
        same(study.simulation.rail_elements as f64, &file["rail_elements"], 1.0);
        same(study.contact.penalty, &file["penalty_kn_per_m"], 1e3);
        same(scenario.friction, &file["friction"], 1.0);
        same(scenario.lateral_suspension.stiffness, &file["horizontal_stiffness_kn_per_m"], 1e3);
        same(scenario.lateral_suspension.damping, &file["horizontal_damping_kn_s_per_m"], 1e3);
        same(scenario.vertical_suspension.stiffness, &file["vertical_stiffness_kn_per_m"], 1e3);
        same(scenario.vertical_suspension.damping, &file["vertical_damping_kn_s_per_m"], 1e3);
        same(scenario.suspended_mass, &file["suspended_mass_t"], 1e3);
        same(scenario.time_step, &file["time_step_s"], 1.0);
        same(scenario.steps as f64, &file["steps"], 1.0);
        let vertical_force = scenario.vertical_force.as_harmonic().unwrap();
        // The publication's vertical axis points up, the study's down.
        same(-vertical_force.constant, &file["vertical_force"]["mean_kn"], 1e3);
        same(vertical_force.amplitude, &file["vertical_force"]["amplitude_kn"], 1e3);
        same(vertical_force.frequency, &file["vertical_force"]["frequency_hz"], 1.0);
    }
    let lateral = constant.scenarios["constant"].scenario.lateral_force.harmonics[0];
    same(lateral.constant, &file["horizontal_force_4_1"]["constant_kn"], 1e3);
    let lateral = sine.scenarios["sine"].scenario.lateral_force.harmonics[0];
    same(lateral.amplitude, &file["horizontal_force_4_2"]["amplitude_kn"], 1e3);
    same(lateral.frequency, &file["horizontal_force_4_2"]["frequency_hz"], 1.0);
    let twist = torsion.rail_torsion.as_ref().unwrap().harmonics[0];
    same(twist.amplitude, &file["torsion_4_2"]["amplitude_kn_m"], 1e3);
    same(twist.frequency, &file["torsion_4_2"]["frequency_hz"], 1.0);
    same(torsion.speed, &file["speed_4_2_m_per_s"], 1.0);
    for (snapshots, name) in [
        (&constant.scenarios["constant"].snapshots, "contact_pictures_4_1_s"),
        (&sine.scenarios["sine"].snapshots, "contact_pictures_4_2_s"),
    ] {
        for (found, published) in snapshots.iter().zip(file[name].as_array().unwrap()) {
            same(*found, published, 1.0);
        }
    }
    same(Limits::default().ratio_window_s, &file["averaging_time_s"], 1.0);
}
