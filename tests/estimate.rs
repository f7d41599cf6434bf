//! The estimate of what a study takes, compared with what it takes; and the refusal of what the machine cannot hold.

use std::path::PathBuf;
use std::process::Output;

use serde_json::Value;

const COARSE: &str = include_str!("studies/coarse.toml");

/// A folder with a study.
struct Place(tempfile::TempDir);

impl Place {
    fn new(study: &str) -> Self {
        let root = tempfile::tempdir().unwrap();
        std::fs::write(root.path().join("study.toml"), study).unwrap();
        Self(root)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> (Option<i32>, String, String) {
        let Output { status, stdout, stderr } = assert_cmd::Command::cargo_bin("railspring")
            .unwrap()
            .current_dir(self.0.path())
            .env("RAILSPRING_CACHE", self.path("cache"))
            .args(arguments)
            .output()
            .unwrap();
        (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
    }
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
    let place = Place::new(&study);
    let (code, said, _) = place.run(&["calibrate", "study.toml", "--dry-run", "-o", "out"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("degrees of freedom") && !place.path("out").exists(), "{said}");
    let expected = expected_gib(&said, "calibration");
    let (code, _, shown) = place.run(&["calibrate", "study.toml", "-o", "out"]);
    assert_eq!(code, Some(0), "{shown}");
    assert!(shown.contains(said.lines().next().unwrap()), "the run says it, too: {shown}");
    let record: Value =
        serde_json::from_slice(&std::fs::read(place.path("out/measured.json")).unwrap()).unwrap();
    let stages = record["stages"].as_array().unwrap();
    let stage = stages.iter().find(|stage| stage["stage"] == "calibration").unwrap();
    let measured = stage["peak_memory_mib"].as_f64().unwrap() / 1024.0;
    assert!((expected - measured).abs() < MODEL * measured + ROUNDED, "{expected} GiB, measured {measured}");
}

/// Goal: a limit below the need and elements that no machine holds are refused with exit code 2, the line of the key,
/// and sizes that would do, within seconds and without results, by every command that makes a mesh; `--dry-run` of commands that cost little
/// says what they would do.
#[test]
fn what_the_machine_cannot_hold_is_refused() {
    let place = Place::new(COARSE);
    let (code, _, said) = place.run(&["run", "study.toml", "--memory-limit", "0.1", "-o", "out"]);
    assert_eq!(code, Some(2), "{said}");
    for part in ["study.toml:", "mesh.contact_element_mm = 6 (", "GiB", "--memory-limit"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let finest = COARSE
        .replace("contact_element_mm = 6", "contact_element_mm = 0.2")
        .replace("contact_element_along_mm = 6", "contact_element_along_mm = 0.2");
    let place = Place::new(&finest);
    let (code, _, said) = place.run(&["run", "study.toml", "--quiet", "-o", "out", "--memory-limit", "64"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("mesh.contact_element_mm = 0.2 (") && said.contains("take mesh.contact_element_mm = ")
    );
    assert!(!place.path("out").exists(), "nothing is left behind");
    for limit in ["0", "-1", "nan", "x"] {
        let (code, _, _) = place.run(&["run", "study.toml", "--memory-limit", limit]);
        assert_eq!(code, Some(2), "{limit}");
    }
    let place = Place::new(COARSE);
    for command in [&["mesh"][..], &["deck", "--format", "calculix"], &["crosscheck"]] {
        let limits = ["study.toml", "--quiet", "-o", "apart", "--memory-limit", "0.005"];
        let (code, _, said) = place.run(&[command, &limits].concat());
        assert_eq!(code, Some(2), "{command:?}: {said}");
        assert!(said.contains("mesh.contact_element_mm = 6 ("), "{command:?}: {said}");
    }
    let (code, said, _) = place.run(&["crosscheck", "study.toml", "--second-order", "--dry-run"]);
    assert_eq!(code, Some(0), "{said}");
    let [own, reference] = ["calibration", "reference"].map(|stage| expected_gib(&said, stage));
    assert!(reference > 3.0 * own, "{said}");
    for (command, part) in
        [("report", "results in out/coarse"), ("simulate", ""), ("mesh", "degrees of freedom")]
    {
        let (code, said, shown) = place.run(&[command, "study.toml", "--dry-run"]);
        assert_eq!(code, Some(0), "{command}: {shown}");
        assert!(said.contains(part) && !place.path("out").exists(), "{command}: {said}");
    }
}
