//! The contact elements that a study has not chosen: each runs beside the chosen one as if it were that, and what becomes of it is no error of the study.

use crate::coarser::coarser;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use railspring::rounding::with_minus_signs;
use serde_json::Value;

/// A lateral force (kN) that throws the wheel over the rail; the iterations of the published element end there, those of the condensed one go on until
/// the wheel has left.
const HARD_KN: f64 = 8000.0;

/// The coarse study with laws by contact angle, an element, and a load case of a lateral force, kN.
fn study(element: &str, steps: usize, lateral_kn: f64) -> String {
    let coarse = coarser().replace("shifts_mm = []", "shifts_mm = [0]");
    let load_case = format!(
        "[scenario.one]\nsteps = {steps}\nsolid = false\nvertical_force = {{ mean_kn = 10 }}\nlateral_force = {{ mean_kn = {lateral_kn} }}\n"
    );
    format!("{coarse}\n[simulation]\nelement = \"{element}\"\n{load_case}")
}

/// A command on a study in `root`, with the store and the output folder there.
fn railspring(root: &Path, command: &str, study: &str) -> Output {
    std::fs::write(root.join("study.toml"), study).unwrap();
    let mut all = Command::cargo_bin("railspring").unwrap();
    all.current_dir(root).env("RAILSPRING_CACHE", root.join("cache"));
    all.args([command, "study.toml", "-o", "out", "--quiet"]).output().unwrap()
}

fn done(root: &Path, command: &str, study: &str) {
    let output = railspring(root, command, study);
    let said = String::from_utf8_lossy(&output.stderr);
    // 1: the coarse study does not keep all limits
    assert!(matches!(output.status.code(), Some(0 | 1)), "{command}: {said}");
}

fn read(root: &Path, file: &str) -> String {
    std::fs::read_to_string(root.join("out").join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

fn json(root: &Path, file: &str) -> Value {
    serde_json::from_str(&read(root, file)).unwrap()
}

/// The verdict on an element of the only load case.
fn judged(root: &Path, element: &str) -> Value {
    let verdict = json(root, "verification.json");
    let all = verdict["scenarios"][0]["elements"].as_array().unwrap();
    all.iter().find(|of| of["element"] == element).unwrap_or_else(|| panic!("{element}: {verdict}")).clone()
}

/// A history whose last lateral displacement of the wheel, from which no other cell follows, is another number.
fn with_another_displacement(history: &str) -> String {
    let column = history.lines().next().unwrap().split(',').position(|name| name == "wheel_y_mm").unwrap();
    let (rows, last) = history.trim_end().rsplit_once('\n').unwrap();
    let mut cells: Vec<&str> = last.split(',').collect();
    assert_ne!(cells[column], "0.125");
    cells[column] = "0.125";
    format!("{rows}\n{}\n", cells.join(","))
}

/// Goal: the histories of each element, that of the disturbed run too, are the same bytes whether the study
/// has chosen it or not. Files of an earlier choice are removed, with verdict and report. The report refuses
/// an edited history of another element with its name, and the run makes it again.
#[test]
fn the_other_element_runs_as_if_it_were_chosen() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let condensed = study("condensed", 20, 20.0);
    done(root, "run", &condensed);
    let names = ["history.csv", "history_disturbed.csv"];
    let others = |element: &str| {
        [format!("history_{element}.csv"), format!("history_{element}_disturbed.csv")]
            .map(|name| read(root, &name))
    };
    let chosen = names.map(|name| read(root, name));
    let other = others("published");
    assert!(chosen[0] != other[0] && chosen[0].lines().count() == other[0].lines().count());
    let lumped = others("lumped");
    assert!(chosen[0] != lumped[0] && chosen[0].lines().count() == lumped[0].lines().count());
    let verdict = json(root, "verification.json");
    for element in ["published", "lumped"] {
        assert_eq!(judged(root, element)["run"]["ending"], "completed");
        let name = format!("history_{element}_disturbed.csv");
        assert!(verdict["inputs"][&name].is_string(), "{name}: {verdict}");
    }

    std::fs::write(root.join("out/history_published.csv"), with_another_displacement(&other[0])).unwrap();
    let refused = railspring(root, "report", &condensed);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        refused.status.code() == Some(2) && said.contains("history_published.csv (another content"),
        "{said}"
    );
    done(root, "simulate", &condensed);
    assert_eq!(others("published"), other);

    done(root, "simulate", &study("lumped", 20, 20.0));
    assert_eq!(names.map(|name| read(root, name)), lumped);
    assert_eq!([others("condensed"), others("published")], [chosen.clone(), other.clone()]);
    assert!(!root.join("out/history_lumped.csv").exists());
    let published = study("published", 20, 20.0);
    done(root, "simulate", &published);
    assert_eq!(names.map(|name| read(root, name)), other);
    assert_eq!([others("condensed"), others("lumped")], [chosen, lumped]);
    for gone in
        ["history_published.csv", "history_published_disturbed.csv", "verification.json", "report.html"]
    {
        assert!(!root.join("out").join(gone).exists(), "{gone}");
    }
}

/// Goal: an element that does not come to its end is no error of the study: the verdict and the report say why, there is no history of it, and the report
/// made again from the files says the same. Where it is the study's own element, the command fails.
#[test]
#[ignore = "a minute: cargo long both_elements"]
fn an_element_that_fails_is_said() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    // a history of the other element is there from a load case that it runs
    done(root, "run", &study("condensed", 60, 20.0));
    assert!(root.join("out/history_published.csv").exists());
    let hard = study("condensed", 60, HARD_KN);
    done(root, "run", &hard);
    let reason = judged(root, "published")["missing"].clone();
    let reason = reason.as_str().unwrap();
    assert!(reason.starts_with("moving solver, step "), "{reason}");
    assert!(!root.join("out/history_published.csv").exists());
    let page = read(root, "report.html");
    let sentence = with_minus_signs(&format!("The published element has no run: {reason}."));
    assert!(page.contains(&sentence), "{page}");
    std::fs::remove_file(root.join("out/report.html")).unwrap();
    // as it was taken from the store, so it is from the files
    for command in ["simulate", "verify", "report"] {
        done(root, command, &hard);
    }
    let part = |page: String| page.split("<section id=\"measured\">").next().unwrap().to_string();
    assert_eq!(part(read(root, "report.html")), part(page));
    let failed = railspring(root, "simulate", &study("published", 60, HARD_KN));
    assert_eq!(failed.status.code(), Some(3), "{}", String::from_utf8_lossy(&failed.stderr));
}

/// Source: the law against the rail's section and the horizontal stiffness of the calibration, and statics. Goal: the published element's hub at the fixed loads has the
/// horizontal stiffness, the law's tangent at a vertical force that is the load but for friction along a normal of 1.4°, and no coupling, µm/kN. Accuracy: PENALTY of a contact node, and
/// FRICTION.
#[test]
fn the_published_hub_has_the_calibrated_springs() {
    /// PENALTY: 1e9 kN/m beside a spring of 1e6 kN/m.
    const PENALTY: f64 = 1e-3;
    /// FRICTION: a vertical force that is off by 0.5·sin 1.4° of the load, of which the tangent has less than a third.
    const FRICTION: f64 = 4e-3;
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    done(root, "calibrate", &study("condensed", 20, 20.0));
    let (stiffness, laws) = (json(root, "stiffness.json"), json(root, "stiffness_by_angle.json"));
    let number = |value: &Value| value.as_f64().unwrap();
    let of_law = |key: &str| number(&stiffness["law"][key]);
    let loads = laws["shifts"][0]["loads"].as_array().unwrap();
    assert!(!loads.is_empty() && stiffness["reference"] == "beam");
    for load in loads {
        let hub = &load["published_hub_um_per_kn"];
        let lateral = number(&hub[0]) * number(&stiffness["horizontal_kn_per_m"]) * 1e-6;
        assert!((lateral - 1.0).abs() < PENALTY, "{load}");
        assert_eq!(number(&hub[1]), 0.0);
        let force = number(&load["force_kn"]) / of_law("f0_kn");
        let tangent = of_law("a_kn_per_m") + of_law("b_kn_per_m") * force.powf(of_law("c"));
        assert!((number(&hub[2]) * tangent * 1e-6 - 1.0).abs() < PENALTY + FRICTION, "{load}");
    }
}
