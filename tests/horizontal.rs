//! A horizontal stiffness without an answer: the normal laws, which are finished, are kept and written.
//!
//! Source: the same study with preloads that its contact window holds; its law, equal to the number. The preload of 600 kN
//! needs a contact window of 15 mm; the longest Hertz patch that the study is checked for fits one of 12 mm.

use assert_cmd::Command;
use serde_json::Value;

const PRELOAD: &str = "horizontal_preloads_kn = [20, 600]";

/// `calibrate` on the coarse study with these keys under `[mesh]` and `[calibration]`: exit code, what it said, and
/// `stiffness.json`.
fn calibrate(mesh: &str, calibration: &str) -> (i32, String, Value) {
    let root = tempfile::tempdir().unwrap();
    let study = include_str!("studies/coarse.toml")
        .replace("[mesh]", &format!("[mesh]\n{mesh}"))
        .replace("[calibration]", &format!("[calibration]\n{calibration}"));
    std::fs::write(root.path().join("study.toml"), study).unwrap();
    let output = Command::cargo_bin("railspring")
        .unwrap()
        .current_dir(root.path())
        .env("RAILSPRING_CACHE", root.path().join("cache"))
        .args(["calibrate", "study.toml", "-o", "out"])
        .output()
        .unwrap();
    let record = std::fs::read_to_string(root.path().join("out/stiffness.json")).unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code().unwrap(), said, serde_json::from_str(&record).unwrap())
}

/// Goal: a preload at which the contact leaves the window that the study gives ends without an answer (exit code 3); the law is written, and with
/// it why the horizontal stiffness is missing.
#[test]
fn the_finished_law_is_kept() {
    let window = "window_half_length_mm = 12";
    let (code, said, kept) = calibrate(window, PRELOAD);
    assert_eq!(code, 3, "{said}");
    let reason = kept["horizontal_missing"].as_str().expect("a reason");
    assert!(reason.contains("600.000 kN") && reason.contains("end of the contact window"), "{reason}");
    assert!(said.contains(reason), "{said}");
    assert!(kept["horizontal_kn_per_m"].is_null() && kept["horizontal"].is_null());

    let (code, said, whole) = calibrate(window, "horizontal_preloads_kn = [20, 60]");
    assert_eq!(code, 0, "{said}");
    assert!(whole["horizontal_kn_per_m"].is_f64() && whole.get("horizontal_missing").is_none());
    for key in ["law", "references", "compliance_split"] {
        assert_eq!(kept[key], whole[key], "{key}");
    }
}

/// Goal: where the study leaves the window to the program, the same preload has its answer on the same meshes: the contact goes on beyond the
/// window.
#[test]
fn the_contact_of_a_preload_goes_on_beyond_the_window() {
    let (code, said, record) = calibrate("", PRELOAD);
    assert_eq!(code, 0, "{said}");
    assert!(!said.contains("meshed again"), "{said}");
    assert_eq!(record["horizontal"]["points"].as_array().unwrap().len(), 2);
}
