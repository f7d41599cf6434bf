//! A whole study on a coarse mesh and a few time steps: every file of the
//! result, the same bytes on one and on two threads, and the later stages
//! again from the files alone.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use assert_cmd::Command;
use railspring::results::files::RESULT_FILES;
use serde_json::Value;

const STUDY: &str = r#"
name = "coarse"
[rail]
profile = "60E1"
[wheel]
profile = "S1002"
[mesh]
contact_element_mm = 4
window_half_length_mm = 14
[calibration]
load_min_kn = 10
load_max_kn = 80
load_count = 5
horizontal_preloads_kn = [40, 60]
shifts_mm = [0, 7]
[scenario.push]
steps = 6
vertical_force = { mean_kn = 10, amplitude_kn = 61.25, frequency_hz = 10 }
lateral_force = { mean_kn = 20 }
snapshots_s = [0, 0.003]
[scenario.ride]
steps = 6
solid = false
speed_m_per_s = 0.5
start_x_m = 0.2
vertical_force = { mean_kn = 10, amplitude_kn = 61.25, frequency_hz = 10 }
lateral_force = {}
"#;

/// Names of the files that one study writes, in order.
const FILES: [&str; 39] = [
    "contact.pvd",
    "contact.vtu",
    "contact_patches.json",
    "fields/contact-01.vtu",
    "fields/contact-02.vtu",
    "fields/contact-03.vtu",
    "fields/contact-04.vtu",
    "fields/rail-01.vtu",
    "fields/rail-03.vtu",
    "fields/wheel-01.vtu",
    "fields/wheel-03.vtu",
    "history-ride.csv",
    "history.csv",
    "history_disturbed-ride.csv",
    "history_disturbed.csv",
    "history_lumped-ride.csv",
    "history_lumped.csv",
    "history_lumped_disturbed-ride.csv",
    "history_lumped_disturbed.csv",
    "history_published-ride.csv",
    "history_published.csv",
    "history_published_disturbed-ride.csv",
    "history_published_disturbed.csv",
    "history_uncertain-ride.csv",
    "history_uncertain.csv",
    "inputs.json",
    "load_curve.csv",
    "rail.pvd",
    "rail.vtu",
    "report.html",
    "results.json",
    "solid_history.csv",
    "solid_history_disturbed.csv",
    "stiffness.json",
    "stiffness_by_angle.csv",
    "stiffness_by_angle.json",
    "verification.json",
    "wheel.pvd",
    "wheel.vtu",
];

struct Finished {
    root: PathBuf,
    code: Option<i32>,
}

fn railspring(root: &Path, arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("railspring")
        .unwrap()
        .current_dir(root)
        .env("RAILSPRING_CACHE", root.join("cache"))
        .args(arguments)
        .output()
        .unwrap()
}

fn run_with(threads: &str) -> Finished {
    // Kept in the build folder: a value that lives as long as the program is never dropped.
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("whole-study-{threads}"));
    let _ = std::fs::remove_dir_all(&root);
    std::fs::create_dir_all(&root).unwrap();
    std::fs::write(root.join("study.toml"), STUDY).unwrap();
    let output = railspring(&root, &["run", "study.toml", "--threads", threads]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{text}");
    Finished { root, code: output.status.code() }
}

/// The study on two threads, run once for all tests.
fn finished() -> &'static Finished {
    static RUN: OnceLock<Finished> = OnceLock::new();
    RUN.get_or_init(|| run_with("2"))
}

/// Files of the result with their content; of the report, which measures, the part that does not.
fn results(root: &Path) -> BTreeMap<String, String> {
    let folder = root.join("out/coarse");
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.clone()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(&folder).unwrap().to_string_lossy().into_owned();
            let text = std::fs::read_to_string(&path).unwrap();
            let text = match name.as_str() {
                "measured.json" => continue,
                "report.html" => text.split("<section id=\"measured\">").next().unwrap().to_string(),
                _ => text,
            };
            found.insert(name, text);
        }
    }
    found
}

#[test]
fn every_file_is_there_and_nothing_else() {
    let run = finished();
    let results = results(&run.root);
    let (figures, files): (Vec<&String>, Vec<&String>) =
        results.keys().partition(|name| name.starts_with("figures"));
    assert_eq!(files, FILES);
    for name in results.keys() {
        let described = RESULT_FILES.iter().filter(|file| file.matches(name)).count();
        assert_eq!(described, 1, "{name} stands once in the reference of the files");
    }
    // Thirteen of the springs, seven of each scenario.
    assert_eq!(figures.len(), 27, "{figures:?}");
    assert!(
        results["report.html"].contains("Scenario push") && !results["report.html"].contains("figure failed")
    );
    assert_eq!(results["load_curve.csv"].lines().count(), 1 + 5);
    for file in ["history.csv", "solid_history.csv", "history-ride.csv", "history_published-ride.csv"] {
        assert_eq!(results[file].lines().count(), 1 + 7, "{file}");
    }
}

#[test]
fn the_springs_are_recorded_with_what_made_them() {
    let run = finished();
    let stiffness: Value = serde_json::from_str(&results(&run.root)["stiffness.json"]).unwrap();
    let law = &stiffness["law"];
    for key in ["a_kn_per_m", "b_kn_per_m", "c", "f0_kn", "rms_rel_error", "max_rel_error"] {
        assert!(law[key].is_f64(), "{key} in {law}");
    }
    assert_eq!(law["range_kn"], serde_json::json!([10.0, 80.0]));
    assert_eq!(stiffness["reference"], "beam");
    assert!(stiffness["horizontal_kn_per_m"].as_f64().unwrap() > 0.0);
    assert_eq!(stiffness["input_hash"].as_str().unwrap().len(), 64);
    let references: Vec<&Value> =
        stiffness["references"].as_array().unwrap().iter().map(|law| &law["reference"]).collect();
    assert_eq!(references, ["beam", "local", "half-spaces"]);
}

#[test]
fn the_exit_code_is_that_of_the_verdict() {
    let run = finished();
    let verification: Value = serde_json::from_str(&results(&run.root)["verification.json"]).unwrap();
    assert_eq!(verification["holds"], run.code == Some(0));
    let scenarios = verification["scenarios"].as_array().unwrap();
    assert_eq!(scenarios.len(), 2);
    for scenario in scenarios {
        let both = scenario["scenario"] == "push";
        assert_eq!(scenario["compared"].is_object(), both, "only one has a solid run");
        assert_eq!(scenario["solid"]["degrees_of_freedom"].as_u64().unwrap_or(0) > 10_000, both);
        assert_eq!(scenario["simple"]["ending"], "completed");
    }
}

#[test]
fn one_and_two_threads_write_the_same_bytes() {
    let (two, one) = (results(&finished().root), results(&run_with("1").root));
    assert_eq!(two.keys().collect::<Vec<_>>(), one.keys().collect::<Vec<_>>());
    for (name, content) in &two {
        assert!(*content == one[name], "{name} differs");
    }
}

#[test]
fn later_stages_come_to_the_same_from_the_files() {
    let source = finished();
    let root = tempfile::tempdir().unwrap();
    std::fs::write(root.path().join("study.toml"), STUDY).unwrap();
    let from = source.root.join("out/coarse");
    let to = root.path().join("out/coarse");
    std::fs::create_dir_all(to.join("fields")).unwrap();
    for name in FILES.iter().filter(|name| **name != "report.html").chain(&["measured.json"]) {
        std::fs::copy(from.join(name), to.join(name)).unwrap();
    }
    for command in ["simulate", "verify", "report"] {
        let output = railspring(root.path(), &[command, "study.toml", "--quiet"]);
        let expected = if command == "verify" { source.code } else { Some(0) };
        assert_eq!(output.status.code(), expected, "{command}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let (again, before) = (results(root.path()), results(&source.root));
    for (name, content) in &before {
        assert!(again.get(name) == Some(content), "{name} differs");
    }

    // The folder now belongs to another study.
    std::fs::write(root.path().join("study.toml"), STUDY.replace("load_count = 5", "load_count = 6"))
        .unwrap();
    for command in ["verify", "report"] {
        let output = railspring(root.path(), &[command, "study.toml", "-o", "out/coarse"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains("the study or the program has changed"));
    }
}

/// Goal: a study without load cases has its report whatever its law is measured against, as no simple model takes that law; with a
/// load case it is refused before anything is computed.
#[test]
fn a_law_against_the_foot_has_its_report_where_nothing_runs_on_it() {
    let root = tempfile::tempdir().unwrap();
    let coarse = include_str!("studies/coarse.toml");
    let foot = coarse.replace("[calibration]\n", "[calibration]\nreference = \"foot\"\n");
    assert_ne!(coarse, foot);
    let run = |text: &str| {
        std::fs::write(root.path().join("study.toml"), text).unwrap();
        railspring(root.path(), &["run", "study.toml", "-o", "foot"])
    };
    let loaded = format!(
        "{foot}\n[scenario.one]\nsteps = 2\nvertical_force = {{ mean_kn = 50 }}\nlateral_force = {{ mean_kn = 5 }}\n"
    );
    let refused = run(&loaded);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("calibration.reference"), "{refused:?}");
    assert!(!root.path().join("foot").join("stiffness.json").exists());
    let reported = run(&foot);
    assert!(matches!(reported.status.code(), Some(0 | 1)), "{reported:?}");
    let page = std::fs::read_to_string(root.path().join("foot").join("report.html")).unwrap();
    assert!(page.contains("hub against rail foot") && page.contains("Foot-referenced tangent stiffness"));
}
