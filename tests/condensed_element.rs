//! The condensed element beside the solid model: statics and the first 60 ms of the published load case with a constant lateral
//! force, through the whole program.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use railspring::results::run::history_csv;
use railspring::verify::{Carrying, averaged_ratio};
use railspring_simulate::time::history::{Ending, History};
use serde_json::Value;

/// The pair and the load case of the publication's section 4.1 on a mesh of 3 mm: the flange strikes the rail, slides up and sticks, the wheel
/// leaves the rail and comes back on the tread.
const STUDY: &str = r#"
name = "strike"
[rail]
profile = "60E1"
[wheel]
profile = "S1002"
tape_diameter_m = 0.858
[material]
damping_ratio = 0.02
damping_frequency_hz = 1000
[mesh]
contact_element_mm = 3
contact_element_along_mm = 2.5
[calibration]
load_min_kn = 5
load_max_kn = 120
load_count = 6
error_band = false
horizontal_preloads_kn = [40]
[scenario.strike]
steps = 120
time_step_s = 0.0005
gravity_m_per_s2 = 0
suspended_mass_t = 6.25
vertical_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
lateral_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
vertical_force = { mean_kn = 10, amplitude_kn = 61.25, frequency_hz = 10, phase_deg = 0 }
lateral_force = { mean_kn = 20 }
rotations_held = true
"#;

/// MODEL: the hub's displacement is within 4 % of the solid's (below), and the force of an impact goes with the root of the stiffness; the
/// solid itself changes by 1 % with its steps. The published element is 15 % off.
const FORCES: f64 = 0.03;
/// MODEL: what forces that are 3 % off leave of an averaged ratio of up to 5 where P is a tenth of its peak.
const RATIO: f64 = 0.03;
/// Two output steps, s.
const SEPARATION: f64 = 1e-3;
/// MODEL: half of the 8 % by which a section that moves without distortion misses the head where the wheel stands on its edge.
const DISPLACEMENT: f64 = 0.04;
/// MODEL: a strip has one tangential stiffness for all loads, between 20 and 120 kN the solid's contact has one that is a tenth different, and the contact has a
/// quarter of the hub's lateral flexibility.
const LATERAL: f64 = 0.025;

fn json(root: &Path, name: &str) -> Value {
    serde_json::from_slice(&fs::read(root.join("out").join(name)).unwrap()).unwrap()
}

fn history(root: &Path, name: &str) -> History {
    let path = root.join("out").join(name);
    history_csv::read(&path, &fs::read_to_string(&path).unwrap(), 0, Ending::Completed).unwrap()
}

/// Averaged Q/P against the solid's, RMS, where P exceeds a tenth of its peak.
fn ratio(root: &Path) -> f64 {
    let (simple, solid) = (history(root, "history.csv"), history(root, "solid_history.csv"));
    let peak = solid.rows.iter().map(|row| row.vertical_force).fold(0.0, f64::max);
    // with an error of a tenth of the peak P carries no ratio below that
    let carrying = Carrying { errors: [0.1 * peak, 0.0], limit: f64::INFINITY };
    let ratios = |history: &History| averaged_ratio(history, 0.024, &carrying);
    let pairs = ratios(&simple).into_iter().zip(ratios(&solid));
    let off: Vec<f64> = pairs.filter_map(|(a, b)| Some(a? - b?)).collect();
    assert!(off.len() > 40, "{}", off.len());
    (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt()
}

/// Source: the solid model on the same bodies. Goal: P and Q (RMS over the solid's peak), averaged Q/P (RMS)
/// where P exceeds a tenth of its peak, begin and end of the separations (s) over 60 ms. Goal in statics:
/// displacement of the hub along the contact normal (over that under the largest load) and its lateral
/// flexibility at ten places and loads of 20 to 120 kN. Accuracy: MODEL.
#[test]
#[ignore = "a minute: cargo long condensed_element"]
fn the_condensed_element_follows_the_solid() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("study.toml"), STUDY).unwrap();
    let output = Command::cargo_bin("railspring")
        .unwrap()
        .current_dir(root.path())
        .env("RAILSPRING_CACHE", root.path().join("cache"))
        .args(["run", "study.toml", "-o", "out", "-q"])
        .output()
        .unwrap();
    // the verdict has its own limits
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&output.stderr));
    let verdict = json(root.path(), "verification.json");
    let lines = verdict["scenarios"][0]["lines"].as_array().unwrap();
    let value = |quantity: &str| {
        let line = lines.iter().find(|line| line["quantity"] == quantity);
        line.and_then(|line| line["value"].as_f64()).unwrap_or(f64::NAN)
    };
    for (quantity, most) in [
        ("vertical_rms", FORCES),
        ("lateral_rms", FORCES),
        ("separation_begin_s", SEPARATION),
        ("separation_end_s", SEPARATION),
        ("separations_unmatched", 0.0),
    ] {
        assert!(value(quantity) <= most, "{quantity}: {} of {most}", value(quantity));
    }
    let ratio = ratio(root.path());
    assert!(ratio < RATIO, "{ratio}");
    let laws = json(root.path(), "stiffness_by_angle.json");
    let displacement = laws["element"]["displacement"]["max_rel_error"].as_f64().unwrap();
    assert!(displacement < DISPLACEMENT, "{displacement}");
    let shifts = laws["shifts"].as_array().unwrap().iter();
    let loads: Vec<&Value> = shifts.filter_map(|shift| shift["loads"].as_array()).flatten().collect();
    assert!(loads.len() > 40, "{}", loads.len());
    for load in loads {
        let lateral = |of: &str| load[of][0].as_f64().unwrap_or(f64::NAN);
        let off = lateral("condensed_hub_um_per_kn") / lateral("hub_um_per_kn") - 1.0;
        assert!(off.abs() < LATERAL, "{load}: {off}");
    }
}
