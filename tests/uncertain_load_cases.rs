//! Uncertain inputs through the load cases of a study, as its files have it.

use crate::coarser::coarser;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;

/// The coarse study with laws by contact angle, bands, a load case on both models, and some samples.
fn study(more: &str) -> String {
    let coarse = coarser()
        .replace("shifts_mm = []", "shifts_mm = [0]")
        .replace("error_band = false", "error_band = true");
    let inputs = "tape_diameter_mm = 0\nfriction = 0\npoisson = 0\nyoung_percent = 0\n";
    format!(
        "{coarse}\n[scenario.one]\nsteps = 12\nvertical_force = {{ mean_kn = 60 }}\nlateral_force = {{ mean_kn = 20 }}\n[uncertainty]\n{inputs}{more}"
    )
}

/// A command on a study in `root`, with the store and the output folder there.
fn railspring(root: &Path, threads: &str, command: &str, study: &str) -> Output {
    std::fs::write(root.join("study.toml"), study).unwrap();
    let mut all = Command::cargo_bin("railspring").unwrap();
    all.current_dir(root).env("RAILSPRING_CACHE", root.join("cache"));
    all.args([command, "study.toml", "-o", "out", "--threads", threads]).output().unwrap()
}

/// What it says, of a command that ends.
fn said(output: &Output) -> String {
    let text =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat();
    // 1: the coarse study does not keep all limits
    assert!(matches!(output.status.code(), Some(0 | 1)), "{text}");
    text
}

fn read(root: &Path, file: &str) -> String {
    std::fs::read_to_string(root.join("out").join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

fn judged(root: &Path) -> Value {
    serde_json::from_str::<Value>(&read(root, "verification.json")).unwrap()["scenarios"][0].clone()
}

/// Goal: a study writes the bands over time, a row for each time step with ascending quantiles, kN, that hold
/// the run itself at nearly all of them. The verdict has their widths beside the difference of the models
/// over the same peak. Terminal and report print them. The report made again from the files is the same, and
/// an edited file is refused. Without samples, and without bands, there is no file, and verdict and report
/// give the reason.
#[test]
fn a_study_states_what_uncertain_inputs_change_in_time() {
    const FILE: &str = "history_uncertain.csv";
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let whole = study("samples = 8\n");
    let text = said(&railspring(root, "2", "run", &whole));
    let line = "uncertain inputs, 8 quasi-random samples with the condensed element: P: models differ by ";
    assert!(text.contains(&format!("note   one: {line}")), "{text}");
    let rows = read(root, FILE);
    let mut lines = rows.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let heading = lines.next().unwrap();
    let cell = |row: &[&str], name: &str| -> f64 {
        let at = heading.iter().position(|of| *of == name).unwrap_or_else(|| panic!("{name}"));
        row[at].parse().unwrap_or(f64::NAN)
    };
    let history = read(root, "history.csv");
    let own: Vec<f64> =
        history.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
    let rows: Vec<Vec<&str>> = lines.collect();
    assert_eq!(rows.len(), 1 + 12);
    let mut within = 0;
    for (row, own) in rows.iter().zip(&own) {
        let quantiles = ["025", "160", "500", "840", "975"].map(|of| cell(row, &format!("p_q{of}_kn")));
        assert!(quantiles.is_sorted() && cell(row, "samples") == 8.0, "{row:?}");
        within += usize::from((quantiles[0]..=quantiles[4]).contains(own));
    }
    assert!(within >= 10, "{within} of {}", rows.len());

    let verdict = judged(root);
    let bands = &verdict["input_uncertainty"];
    let rms =
        verdict["lines"].as_array().unwrap().iter().find(|line| line["quantity"] == "vertical_rms").unwrap();
    assert_eq!(bands["vertical"]["models"], rms["value"]);
    let halves: Vec<f64> =
        rows.iter().map(|row| 0.5 * (cell(row, "p_q975_kn") - cell(row, "p_q025_kn"))).collect();
    let half = (halves.iter().map(|half| half * half).sum::<f64>() / halves.len() as f64).sqrt();
    let [beside, peak] = [&bands["vertical"]["inputs"], &verdict["compared"]["solid_peak_p_kn"]]
        .map(|of| of.as_f64().unwrap());
    // six digits of the peak are written
    assert!((beside * peak / half - 1.0).abs() < 1e-5, "{beside} {peak} {half}");
    let names: Vec<&str> =
        bands["of"]["inputs"].as_array().unwrap().iter().map(|of| of["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["track gauge", "distance of the flange backs", "inclination of the rail"]);
    let report = read(root, "report.html");
    assert!(
        report.contains("95 % by the inputs") && report.contains("Uncertain inputs, 8 quasi-random samples")
    );

    said(&railspring(root, "2", "report", &whole));
    assert_eq!(
        read(root, "report.html").split("<section id=\"measured\">").next(),
        report.split("<section id=\"measured\">").next()
    );
    let edited = read(root, FILE).replacen("8,", "7,", 1);
    std::fs::write(root.join("out").join(FILE), edited).unwrap();
    let refused = railspring(root, "2", "report", &whole);
    let text = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        refused.status.code() == Some(2) && text.contains("history_uncertain.csv (another content"),
        "{text}"
    );
    said(&railspring(root, "2", "simulate", &whole));

    for (more, reason) in [
        (study("samples = 0\n"), "uncertainty.samples is 0"),
        (
            study("gauge_mm = 0\nflange_back_mm = 0\ninclination_deg = 0\n"),
            "all standard uncertainties are 0",
        ),
        (whole.replace("error_band = true", "error_band = false"), "calibration.error_band is false"),
    ] {
        let text = said(&railspring(root, "2", "run", &more));
        assert!(!root.join("out").join(FILE).exists(), "{reason}");
        assert!(!text.contains("uncertain inputs,"), "{text}");
        assert_eq!(judged(root)["input_uncertainty_missing"], reason);
        let words = format!("What uncertain inputs change in this load case is not known: {reason}.");
        assert!(read(root, "report.html").contains(&words), "{reason}");
    }
}

/// Goal: with the published element, whose law and horizontal stiffness depart to first order, the file has the same bytes on one thread and on three.
#[test]
fn samples_have_the_same_bytes_on_any_threads() {
    let published = |threads: &str| {
        let root = tempfile::tempdir().unwrap();
        let study = study("samples = 6\n[simulation]\nelement = \"published\"\n");
        said(&railspring(root.path(), threads, "run", &study));
        let left_out = &judged(root.path())["input_uncertainty"]["of"]["left_out"][0];
        assert!(
            left_out.as_str().unwrap().starts_with("law and horizontal stiffness depart to first order"),
            "{left_out}"
        );
        read(root.path(), "history_uncertain.csv")
    };
    assert!(published("1") == published("3"));
}
