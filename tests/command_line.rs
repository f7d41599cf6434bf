//! The program from outside: what it says about wrong input, where, with
//! which exit code, and that it leaves nothing behind.

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;

const GOOD: &str = "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"S1002\"\n";

/// A folder with a study, removed at the end.
struct Place {
    root: tempfile::TempDir,
}

impl Place {
    fn with_study(text: &str) -> Self {
        let root = tempfile::tempdir().unwrap();
        std::fs::write(root.path().join("study.toml"), text).unwrap();
        Self { root }
    }

    fn out(&self) -> PathBuf {
        self.root.path().join("deep/out")
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::cargo_bin("railspring")
            .unwrap()
            .current_dir(self.root.path())
            .args(arguments)
            .output()
            .unwrap()
    }
}

fn message(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Runs `command` on a study and expects one line of error that has all `parts`, and no output folder.
fn refused(command: &str, study: &str, parts: &[&str]) {
    let place = Place::with_study(study);
    let out = place.out();
    let output = place.run(&[command, "study.toml", "--quiet", "-o", out.to_str().unwrap()]);
    let text = message(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert_eq!(text.trim_end().lines().count(), 1, "one message: {text}");
    for part in parts {
        assert!(text.contains(part), "{part:?} in {text}");
    }
    assert!(output.stdout.is_empty());
    assert!(!place.root.path().join("deep").exists(), "nothing is left behind");
}

#[test]
fn a_missing_key() {
    let study = GOOD.replace("profile = \"60E1\"\n", "");
    refused("run", &study, &["study.toml:2: rail.profile = (missing)", "add this key to [rail]"]);
}

#[test]
fn a_wrong_unit() {
    let study = format!("{GOOD}[track]\ngauge_m = 1.435\n");
    refused("run", &study, &["study.toml:7: track.gauge_m = 1.435", "did you mean `track.gauge_mm`?"]);
    let value = format!("{GOOD}[track]\ngauge_mm = 1.435\n");
    refused("run", &value, &["study.toml:7: track.gauge_mm = 1.435", "expected a number from 500 to 2000"]);
}

#[test]
fn unknown_profiles() {
    refused("run", &GOOD.replace("60E1", "61E1"), &["study.toml:3: rail.profile = ", "61E1"]);
    refused("run", &GOOD.replace("S1002", "S1003"), &["study.toml:5: wheel.profile = ", "S1003"]);
    let exchanged = GOOD.replace("60E1", "?").replace("S1002", "60E1").replace('?', "S1002");
    refused("run", &exchanged, &["study.toml:3: rail.profile = ", "S1002"]);
}

#[test]
fn a_wheel_that_misses_the_rail() {
    let study = format!("{GOOD}[track]\nlateral_shift_mm = -100\n");
    for command in ["run", "calibrate", "mesh"] {
        refused(command, &study, &["study.toml:7: track.lateral_shift_mm = "]);
    }
}

#[test]
fn a_load_that_cannot_be_carried() {
    let long = format!("{GOOD}[calibration]\nload_max_kn = 400\n[mesh]\nwindow_half_length_mm = 6\n");
    refused("run", &long, &["study.toml:7: calibration.load_max_kn = 400.0 kN", "lower the load"]);
    // Found by the contact solver, after some loads: the patch grows over the gauge corner.
    let wide = format!("{GOOD}[calibration]\nload_max_kn = 1000\n");
    refused("calibrate", &wide, &["study.toml:7: calibration.load_max_kn = "]);
}

#[test]
fn a_study_that_is_not_there() {
    let place = Place::with_study(GOOD);
    let output = place.run(&["run", "other.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).starts_with("error: other.toml: study file = "), "{}", message(&output));
    assert!(!place.root.path().join("out").exists());
}

#[test]
fn a_folder_that_cannot_be_written() {
    // A path below a regular file cannot be written by anybody, the superuser included.
    let place = Place::with_study(GOOD);
    let output = place.run(&["run", "study.toml", "-o", "study.toml/out"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).starts_with("error: output folder = study.toml/out"), "{}", message(&output));
    assert_eq!(std::fs::read_to_string(place.root.path().join("study.toml")).unwrap(), GOOD);
}

#[test]
fn unknown_commands_and_missing_arguments() {
    let place = Place::with_study(GOOD);
    for arguments in [&["fit", "study.toml"][..], &["run"], &[], &["run", "study.toml", "--threads", "0"]] {
        let output = place.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            message(&output).contains("Usage") || message(&output).contains("--help"),
            "{}",
            message(&output)
        );
    }
    assert_eq!(std::fs::read_dir(place.root.path()).unwrap().count(), 1, "only the study");
}

#[test]
fn later_stages_need_the_earlier_ones() {
    let place = Place::with_study(GOOD);
    std::fs::create_dir(place.root.path().join("empty")).unwrap();
    for command in ["simulate", "verify", "report"] {
        let absent = place.run(&[command, "study.toml", "-o", "nowhere"]);
        assert_eq!(absent.status.code(), Some(2));
        assert!(message(&absent).contains("an earlier stage"), "{}", message(&absent));
        let empty = place.run(&[command, "study.toml", "-o", "empty"]);
        assert_eq!(empty.status.code(), Some(2));
        assert!(message(&empty).contains("empty/stiffness.json"), "{}", message(&empty));
        assert!(message(&empty).contains("run `railspring calibrate`"), "{}", message(&empty));
    }
    let output = place.run(&["simulate", "study.toml", "--law", "study.toml", "-o", "new"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).contains("error: study.toml = "), "{}", message(&output));
    assert!(!place.root.path().join("new").exists());
}

#[test]
fn the_schema_is_json_and_accepts_the_shipped_keys() {
    let place = Place::with_study(GOOD);
    let output = place.run(&["schema"]);
    assert_eq!(output.status.code(), Some(0));
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for section in ["rail", "wheel", "track", "mesh", "contact", "calibration", "simulation", "verification"]
    {
        assert!(schema["properties"][section].is_object(), "{section}");
    }
}

#[test]
fn help_and_version_need_no_study() {
    let place = Place::with_study(GOOD);
    let help = place.run(&["--help"]);
    assert_eq!(help.status.code(), Some(0));
    let text = String::from_utf8(help.stdout).unwrap();
    for word in ["run", "calibrate", "simulate", "verify", "mesh", "report", "schema", "Exit codes"] {
        assert!(text.contains(word), "{word}");
    }
    assert_eq!(place.run(&["--version"]).status.code(), Some(0));
}

#[test]
fn the_shipped_studies_are_readable() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/studies");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            // A folder that cannot be written stops the program right after the study was accepted.
            let below_a_file = path.join("out");
            let place = Place::with_study(GOOD);
            let output = place.run(&["run", path.to_str().unwrap(), "-o", below_a_file.to_str().unwrap()]);
            assert!(message(&output).starts_with("error: output folder = "), "{}", message(&output));
        }
    }
}

/// Checking and converting a profile: findings on standard output, exit code 1 where something is left.
#[test]
fn profiles_are_checked_and_converted() {
    let worn = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/profiles/worn-s1002.whl");
    let worn = worn.to_str().unwrap();
    let place = Place::with_study(GOOD);
    let checked = place.run(&["profile", "check", worn, "--smooth-mm", "3"]);
    let text = String::from_utf8(checked.stdout).unwrap();
    assert_eq!(checked.status.code(), Some(0), "{text}");
    assert!(text.contains("MiniProf, wheel, 589 points") && text.contains("smoothed"), "{text}");

    let converted = place.run(&["profile", "convert", worn, "wheel.prw", "--raw"]);
    assert_eq!(converted.status.code(), Some(0), "{}", message(&converted));
    let again = place.run(&["profile", "check", "wheel.prw"]);
    assert!(String::from_utf8(again.stdout).unwrap().contains("Simpack, wheel, 589 points"));

    let ending = place.run(&["profile", "convert", worn, "wheel.prr"]);
    assert_eq!(ending.status.code(), Some(2));
    assert!(message(&ending).contains("wheel.prr = the ending of a rail"), "{}", message(&ending));

    std::fs::write(place.root.path().join("bad.csv"), "y_mm,z_mm\n1,2\n1,x\n").unwrap();
    let bad = place.run(&["profile", "check", "bad.csv"]);
    assert_eq!(bad.status.code(), Some(2));
    assert!(message(&bad).starts_with("error: bad.csv:3:3 = \"x\""), "{}", message(&bad));
}
