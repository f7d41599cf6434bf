//! The solid model with reduced bodies against itself at full order, on the coarse study.
//!
//! Source: the study at full order. Goal: P, Q (kN) over 60 ms of both published load cases, 4.1 and 4.2, and what the results say of
//! the modes. Accuracy: MODES, 0.3 % of the peaks, which is what the program wants of its estimate.

use std::path::Path;

use railspring::engine::inputs::Inputs;
use railspring::engine::output::OutputFolder;
use railspring::results::bodies::estimate::Resources;
use railspring::results::study_run::StudyRun;
use railspring::study::Study;
use railspring_profiles::monitor::Silent;
use serde_json::Value;

const MODES: f64 = 3e-3;

/// The coarse study with 60 ms of the published load cases, and keys at its end.
fn study(keys: &str) -> Study {
    let forces = "vertical_force = { mean_kn = 10, amplitude_kn = 61.25, frequency_hz = 10 }";
    let text = format!(
        "{}\n[scenario.constant]\nsteps = 120\nsnapshots_s = [0.01]\n{forces}\nlateral_force = {{ mean_kn = 20 }}\n\
         [scenario.sine]\nsteps = 120\nsnapshots_s = [0.01]\n{forces}\n\
         lateral_force = {{ amplitude_kn = 10.4125, frequency_hz = 10 }}\n{keys}",
        include_str!("studies/coarse.toml")
    );
    Study::parse(Path::new("reduced.toml"), &text).unwrap_or_else(|e| panic!("{e}"))
}

/// A run of all stages: by load case P and Q of the solid model, kN, and what `results.json` says of the run; the report.
struct Finished {
    forces: [Vec<[f64; 2]>; 2],
    runs: [Value; 2],
    report: String,
}

fn run(keys: &str) -> Finished {
    let study = study(keys);
    let place = tempfile::tempdir().unwrap();
    let folder = OutputFolder::create(place.path(), &Inputs::none()).unwrap();
    let pipeline = StudyRun::new(&study, &folder, Resources::of_the_machine(&Silent));
    pipeline.run().unwrap_or_else(|e| panic!("{e}"));
    let read = |name: &str| std::fs::read_to_string(place.path().join(name)).unwrap();
    let names = ["solid_history.csv", "solid_history-sine.csv"];
    let forces = names.map(|name| {
        let text = read(name);
        assert!(text.starts_with("time_s,p_kn,q_kn,"), "{text}");
        let rows = text.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect::<Vec<_>>());
        rows.map(|row| [1, 2].map(|column: usize| row[column].parse().unwrap())).collect()
    });
    let results: Value = serde_json::from_str(&read("results.json")).unwrap();
    let runs = names.map(|name| results["files"][name]["run"].clone());
    Finished { forces, runs, report: read("report.html") }
}

/// Largest difference of a force over its peak.
fn difference(a: &[[f64; 2]], b: &[[f64; 2]], force: usize) -> f64 {
    let peak = b.iter().map(|row| row[force].abs()).fold(0.0, f64::max);
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a[force] - b[force]).abs()).fold(0.0, f64::max) / peak
}

/// Goal: reduced bodies in time follow full order in both published load cases, through the whole program. `simulate/tests/transient_hybrid.rs` has the same on one load case in seconds.
#[test]
#[ignore = "a minute: cargo long full_order"]
fn reduced_bodies_follow_full_order() {
    let (full, reduced) = std::thread::scope(|scope| {
        let full = scope.spawn(|| run("[solid]\ntransient = \"full\"\ninner_steps = 1\n"));
        let reduced = run("[solid]\ninner_steps = 1\n");
        (full.join().unwrap(), reduced)
    });
    for case in 0..2 {
        let found = [0, 1].map(|force| difference(&reduced.forces[case], &full.forces[case], force));
        let record = &reduced.runs[case]["reduction"];
        println!("{found:?} {record}");
        assert!(found.iter().all(|off| *off < MODES), "{case}: {found:?}");
        let estimate = ["vertical_change", "lateral_change"].map(|key| record[key].as_f64().unwrap());
        assert!(estimate.iter().all(|change| (0.0..MODES).contains(change)), "{record}");
        assert_eq!((&record["rail_modes"], &record["wheel_modes"]), (&64.into(), &64.into()));
        assert_eq!(record["compared_until_s"].as_f64(), Some(0.06));
        assert!(full.runs[case]["reduction"].is_null());
        assert_eq!(full.runs[case]["degrees_of_freedom"], reduced.runs[case]["degrees_of_freedom"]);
    }
    assert!(reduced.report.contains("reduced to 64 modes of the rail and 64 of the wheel"));
    assert!(!full.report.contains("reduced to"));
}

/// Goal: a number that is given is taken, and where it is too small the result says so.
#[test]
fn too_few_modes_are_reported() {
    let few = run("[solid]\nmodes = 6\ninner_steps = 1\n");
    let record = &few.runs[0]["reduction"];
    assert_eq!(record["wheel_modes"], 6);
    assert!(record["vertical_change"].as_f64().unwrap() > MODES, "{record}");
    let notes = few.runs[0]["notes"].to_string();
    assert!(notes.contains("with 6 modes of each body P still changes by"), "{notes}");
    assert!(few.report.contains("with 6 modes of each body P still changes by"));
}
