//! A load and a load case beyond what the meshes of a study have room for: what was done before is kept, written and reported.
//!
//! Source: the same study without them: its law, equal to the number, and its history, equal to the byte. The study gives the contact
//! window, ±12 mm, so that no longer one can be had; the patches of
//! 600 kN and of the peak of the load case are longer.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

/// The coarse study with these loads, kN, and a wheel pressed down by 200 kN for so many time steps of 0.25 ms: it bounces.
fn study(loads: &str, steps: usize) -> String {
    include_str!("studies/coarse.toml")
        .replace("[mesh]", "[mesh]\nwindow_half_length_mm = 12")
        .replace("load_min_kn = 5\nload_max_kn = 85\nload_count = 5", &format!("loads_kn = {loads}"))
        .replace("shifts_mm = []", "shifts_mm = []\nhorizontal_preloads_kn = [20, 60]")
        + &format!(
            "[scenario.pressed]\nsteps = {steps}\ntime_step_s = 0.00025\ngravity_m_per_s2 = 0\nsuspended_mass_t = 0\n\
             vertical_force = {{ mean_kn = 200 }}\nlateral_force = {{ mean_kn = 0 }}\nrotations_held = true\n"
        )
}

/// A command on a study in the folder: exit code, and what it said.
fn railspring(folder: &Path, command: &str, text: &str, output: &str) -> (i32, String) {
    std::fs::write(folder.join("study.toml"), text).unwrap();
    let output = Command::cargo_bin("railspring")
        .unwrap()
        .current_dir(folder)
        .env("RAILSPRING_CACHE", folder.join("cache"))
        .args([command, "study.toml", "-o", output])
        .output()
        .unwrap();
    let said = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    (output.status.code().unwrap(), said.concat())
}

fn text(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn json(folder: &Path, file: &str) -> Value {
    serde_json::from_str(&text(folder, file)).unwrap()
}

/// Goal: a calibration and a run that need a longer contact window than the study gives end with what they
/// have, not with an error. The calibration does so at its largest load, kN, the run at a contact after some
/// milliseconds. The verdict fails in the two lines that count them. The law goes up to the load before and
/// the history to the step before. Files, report and terminal say where and why. Stored files are read back.
/// Both are what the study gives without the load and the steps.
#[test]
fn what_was_done_before_the_end_is_kept() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    let beyond = study("[5, 25, 45, 65, 85, 600]", 12);
    let (code, said) = railspring(folder, "run", &beyond, "beyond");
    assert_eq!(code, 1, "{said}");
    assert!(!said.contains("meshed again"), "{said}");
    let stiffness = json(folder, "beyond/stiffness.json");
    let end = &stiffness["law_end"];
    assert_eq!((end["loads_left_out"].as_u64(), end["largest_wanted_kn"].as_f64()), (Some(1), Some(600.0)));
    let reason = end["reason"].as_str().unwrap();
    assert!(reason.contains("at 600.000 kN") && reason.contains("end of the contact window"), "{reason}");
    assert_eq!(stiffness["law"]["range_kn"], serde_json::json!([5.0, 85.0]));

    let record = &json(folder, "beyond/results.json")["files"]["solid_history.csv"]["run"];
    assert_eq!(record["ending"], "contact-window-end", "{record}");
    let ended = record["ended_at_s"].as_f64().unwrap();
    let [y, z] = [0, 1].map(|axis| record["ended_at_rail_mm"][axis].as_f64().unwrap());
    // the crown of the rail, below whose top nothing of the patch lies deeper than a millimetre
    assert!(y.abs() < 20.0 && (0.0..1.0).contains(&z), "{y} {z}");
    let rows = text(folder, "beyond/solid_history.csv");
    let steps = rows.lines().count() - 2;
    assert!((2..12).contains(&steps), "{rows}");
    assert!(
        2.5e-4 * steps as f64 <= ended && ended <= 2.5e-4 * (steps + 1) as f64 + 1e-12,
        "{ended} {steps}"
    );
    let compared = record["reduction"]["compared_until_s"].as_f64().unwrap();
    assert!(0.0 < compared && compared <= ended, "{record}");
    assert!(record["reduction"]["vertical_change"].as_f64().unwrap() < 3e-3, "{record}");

    let rounded = (ended * 1e6).round() / 1e6;
    let ending = format!("the contact reached the end of the contact window along the track at {rounded} s");
    let left_out = "the laws end at 85 kN instead of 600 kN, without 1 of the loads";
    let verdict = json(folder, "beyond/verification.json");
    let line = |lines: &Value, quantity: &str| -> Value {
        let lines = lines.as_array().unwrap();
        lines.iter().find(|line| line["quantity"] == quantity).unwrap_or_else(|| panic!("{quantity}")).clone()
    };
    for (line, note) in [
        (line(&verdict["calibration"], "loads_left_out"), left_out),
        (line(&verdict["scenarios"][0]["lines"], "runs_to_end"), &ending),
    ] {
        assert_eq!((line["value"].as_f64(), line["holds"].as_bool()), (Some(1.0), Some(false)), "{line}");
        assert!(line["note"].as_str().unwrap().contains(note), "{line}");
        assert!(said.contains(note), "{said}");
    }
    let (code, said) = railspring(folder, "report", &beyond, "beyond");
    assert_eq!(code, 0, "{said}");
    let page = text(folder, "beyond/report.html");
    for note in [left_out, &ending] {
        assert!(page.contains(note), "{note}");
    }

    let (_, said) = railspring(folder, "run", &study("[5, 25, 45, 65, 85]", steps), "within");
    let whole = json(folder, "within/stiffness.json");
    assert!(whole.get("law_end").is_none(), "{said}");
    for key in ["law", "references", "compliance_split", "horizontal"] {
        assert_eq!(stiffness[key], whole[key], "{key}");
    }
    let record = &json(folder, "within/results.json")["files"]["solid_history.csv"]["run"];
    assert_eq!(record["ending"], "completed", "{said}");
    assert!(record.get("ended_at_s").is_none() && record.get("ended_at_rail_mm").is_none());
    assert_eq!(text(folder, "within/solid_history.csv"), rows);
}
