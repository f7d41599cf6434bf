//! Reading of track studies.

use std::path::Path;

use railspring_simulate::track::{Carrier, Direction, Onto, Running, Start};

use super::{LoadCase, TrackStudy};

const STUDY: &str = r#"kind = "track"
name = "t"
[rail]
length_m = 6.0
elements = 12
section = { young_gpa = 210.0, inertia_m4 = 3e-5, mass_kg_per_m = 60.0, shear_area_m2 = 3e-3, poisson = 0.25 }
ends = ["fixed", "free"]
stiffness_damping_s = 1e-4
foundation = { stiffness_kn_per_m2 = 2.0, damping_kn_s_per_m2 = 3.0 }
sleepers = { first_m = 1.0, spacing_m = 1.0, last_m = 3.0, pad_stiffness_kn_per_m = 10.0, mass_kg = 5.0, ballast_stiffness_kn_per_m = 20.0 }
support = [{ x_m = 6.0, kind = "roller" }, { x_m = 0.3, kind = "spring", stiffness_kn_per_m = 7.0, rotation_kn_m_per_rad = 9.0 }]
[wheel]
kind = "force"
[excitation]
vertical_force = { mean_kn = 8.0 }
[run]
steps = 10
time_step_s = 1e-3
start_x_m = 2.0
speed_m_per_s = 4.0
start = "above"
"#;

fn read(text: &str) -> Result<TrackStudy, String> {
    TrackStudy::parse(Path::new("t.toml"), text, &[]).map_err(|mistakes| mistakes.to_string())
}

/// Goal: all keys of a rail arrive in SI units (N, m, kg, s), supports at their nodes and places, and the force at its place.
#[test]
fn keys_arrive_in_si_units() {
    let LoadCase::InPlane(case) = read(STUDY).unwrap().case else { panic!("across") };
    let track = case.track.as_ref().unwrap();
    assert_eq!((track.length, track.elements), (6.0, 12));
    let section = track.rail.section;
    // ROUNDOFF: products of three factors
    let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-12;
    assert!(near(section.bending_z, 6.3e6) && near(section.shear_z, 210e9 / 2.5 * 3e-3), "{section:?}");
    assert_eq!((section.mass, track.rail.damping), (60.0, 1e-4));
    let bed = track.bed.unwrap();
    assert_eq!((bed.stiffness, bed.damping), (2e3, 3e3));
    let held: Vec<_> = track.held.iter().map(|held| (held.of, held.node, held.direction)).collect();
    let rail = |node, direction| (Carrier::Rail, node, direction);
    assert_eq!(
        held,
        [rail(0, Direction::Vertical), rail(0, Direction::Rotation), rail(12, Direction::Vertical)]
    );
    let layers: Vec<_> =
        track.layers.iter().map(|l| (l.x, l.direction, l.upper.stiffness, l.below.map(|b| b.0))).collect();
    let sleeper = |x| (x, Direction::Vertical, 10e3, Some(5.0));
    assert_eq!(
        layers,
        [
            (0.3, Direction::Vertical, 7e3, None),
            (0.3, Direction::Rotation, 9e3, None),
            sleeper(1.0),
            sleeper(2.0),
            sleeper(3.0)
        ]
    );
    assert!(track.layers.iter().all(|layers| layers.onto == Onto::Ground));
    assert_eq!((case.running, case.force.at(0.5), case.way.x(0.5)), (Running::Force, 8e3, 4.0));
    assert_eq!(case.start, Start::Above { height: 0.0, velocity: 0.0 });
}

/// Goal: sleepers within the range of a bridge stand on it, the others on the ground; the ends of the bridge are nodes.
#[test]
fn sleepers_stand_on_the_bridge_that_is_there() {
    let bridge = "[bridge]\nfrom_m = 1.5\nto_m = 3.0\nsection = { young_gpa = 30.0, inertia_m4 = 0.1, mass_kg_per_m = 1e3 }\n";
    let text =
        STUDY.replace("foundation = { stiffness_kn_per_m2 = 2.0, damping_kn_s_per_m2 = 3.0 }\n", "") + bridge;
    let LoadCase::InPlane(case) = read(&text).unwrap().case else { panic!("across") };
    let track = case.track.unwrap();
    assert_eq!(track.bridge.unwrap().nodes, [3, 6]);
    let onto: Vec<_> = track.layers.iter().map(|layers| layers.onto).collect();
    assert_eq!(onto, [Onto::Ground, Onto::Ground, Onto::Ground, Onto::Bridge, Onto::Bridge]);
    let off = read(&text.replace("to_m = 3.0", "to_m = 3.2")).unwrap_err();
    assert!(off.contains("bridge.to_m") && off.contains("rail.elements = 60"), "{off}");
    let both = read(&(STUDY.to_owned() + bridge)).unwrap_err();
    assert!(both.contains("rail.foundation"), "{both}");
}

/// Goal: all mistakes are said together, each on its line, and keys that belong to another choice are refused.
#[test]
fn all_mistakes_are_said_together() {
    let text = STUDY
        .replace("start = \"above\"", "height_mm = 1.0")
        .replace("kind = \"force\"", "kind = \"force\"\nmass_t = 1.0")
        .replace("x_m = 6.0, kind", "x_m = 6.5, kind")
        + "[contact]\nlaw = \"linear\"\nc = 0.5\n";
    let said = read(&text).unwrap_err();
    for key in ["run.height_mm", "wheel.mass_t", "rail.support[0].x_m", "contact.stiffness_kn_per_m"] {
        assert!(said.contains(&format!("{key} = ")), "{key}: {said}");
    }
    assert_eq!(said.lines().count(), 4, "{said}");
    assert!(said.lines().all(|line| line.starts_with("t.toml:")), "{said}");
}
