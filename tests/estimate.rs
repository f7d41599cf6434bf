//! The estimate of what a study takes, compared with what it takes; and the refusal of what the machine cannot hold.

use railspring_testing::{Place, message, said};
use serde_json::Value;

const COARSE: &str = include_str!("studies/coarse.toml");

/// A folder with a study, its cache in it.
fn with(study: &str) -> Place {
    let place = Place::new(env!("CARGO_BIN_EXE_railspring"), "cache");
    place.write("study.toml", study);
    place
}

/// The exit code of a command, and what it writes on standard output and on standard error.
fn run(place: &Place, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = place.run(arguments);
    (output.status.code(), said(&output), message(&output))
}

/// The memory (GiB) on the line of a stage.
fn expected_gib(text: &str, stage: &str) -> f64 {
    let line = text.lines().find(|line| line.trim().starts_with(stage)).unwrap_or_else(|| panic!("{text}"));
    let words: Vec<&str> = line.split_whitespace().collect();
    let unit = words.iter().position(|word| *word == "GiB").unwrap();
    words[unit - 1].parse().unwrap()
}

/// Source: the peak of the resident memory of the same stage, which `measured.json` holds. Goal: what `--dry-run` says of
/// the calibration, GiB. Accuracy: MODEL, 15 %, and the rounding of the text. Nothing else is done or written.
#[cfg(target_os = "linux")]
#[test]
fn the_expected_memory_is_that_of_the_run() {
    const MODEL: f64 = 0.15;
    const ROUNDED: f64 = 0.05;
    // fine enough for some hundred megabytes beside the program itself
    let study = COARSE
        .replace("contact_element_mm = 6", "contact_element_mm = 3")
        .replace("contact_element_along_mm = 6", "contact_element_along_mm = 2.5");
    assert_ne!(study, COARSE);
    let place = with(&study);
    let (code, said, _) = run(&place, &["calibrate", "study.toml", "--dry-run", "-o", "out"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("degrees of freedom") && !place.path("out").exists(), "{said}");
    let expected = expected_gib(&said, "calibration");
    let (code, _, shown) = run(&place, &["calibrate", "study.toml", "-o", "out"]);
    assert_eq!(code, Some(0), "{shown}");
    assert!(shown.contains(said.lines().next().unwrap()), "the run says it, too: {shown}");
    let record: Value =
        serde_json::from_slice(&std::fs::read(place.path("out/measured.json")).unwrap()).unwrap();
    let stages = record["stages"].as_array().unwrap();
    let stage = stages.iter().find(|stage| stage["stage"] == "calibration").unwrap();
    let measured = stage["peak_memory_mib"].as_f64().unwrap() / 1024.0;
    assert!((expected - measured).abs() < MODEL * measured + ROUNDED, "{expected} GiB, measured {measured}");
}

/// Goal: a limit below the need and elements that need twenty times the limit are refused by every command
/// that makes a mesh. The refusal has exit code 2, the line of the key and sizes that would do. It comes
/// within seconds and without results. `--dry-run` of cheap commands prints what they would do.
#[test]
#[ignore = "a minute: cargo long estimate"]
fn what_the_machine_cannot_hold_is_refused() {
    let place = with(COARSE);
    let (code, _, said) = run(&place, &["run", "study.toml", "--memory-limit", "0.1", "-o", "out"]);
    assert_eq!(code, Some(2), "{said}");
    for part in ["study.toml:", "mesh.contact_element_mm = 6 (", "GiB", "--memory-limit"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let finest = COARSE
        .replace("contact_element_mm = 6", "contact_element_mm = 0.5")
        .replace("contact_element_along_mm = 6", "contact_element_along_mm = 0.5");
    let place = with(&finest);
    let (code, _, said) = run(&place, &["run", "study.toml", "--quiet", "-o", "out", "--memory-limit", "1"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("mesh.contact_element_mm = 0.5 (") && said.contains("take mesh.contact_element_mm = ")
    );
    assert!(!place.path("out").exists(), "nothing is left behind");
    for limit in ["0", "-1", "nan", "x"] {
        let (code, _, _) = run(&place, &["run", "study.toml", "--memory-limit", limit]);
        assert_eq!(code, Some(2), "{limit}");
    }
    let place = with(COARSE);
    for command in [&["mesh"][..], &["deck", "--format", "calculix"], &["crosscheck"]] {
        let limits = ["study.toml", "--quiet", "-o", "apart", "--memory-limit", "0.005"];
        let (code, _, said) = run(&place, &[command, &limits].concat());
        assert_eq!(code, Some(2), "{command:?}: {said}");
        assert!(said.contains("mesh.contact_element_mm = 6 ("), "{command:?}: {said}");
    }
    let (code, said, _) = run(&place, &["crosscheck", "study.toml", "--second-order", "--dry-run"]);
    assert_eq!(code, Some(0), "{said}");
    let [own, reference] = ["calibration", "reference"].map(|stage| expected_gib(&said, stage));
    assert!(reference > 3.0 * own, "{said}");
    for (command, part) in
        [("report", "results in out/coarse"), ("simulate", ""), ("mesh", "degrees of freedom")]
    {
        let (code, said, shown) = run(&place, &[command, "study.toml", "--dry-run"]);
        assert_eq!(code, Some(0), "{command}: {shown}");
        assert!(said.contains(part) && !place.path("out").exists(), "{command}: {said}");
    }
}
