//! The uncertainty of the inputs of a study, as its files have it.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn railspring(root: &Path, threads: &str, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
    command.current_dir(root).args(arguments.split(' ')).env("RAYON_NUM_THREADS", threads);
    command.env("RAILSPRING_CACHE", root.join("store")).output().unwrap()
}

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat()
}

/// The uncertainty in `stiffness.json` of a coarse study with settings.
fn uncertainty(root: &Path, folder: &str, threads: &str, settings: &str) -> Value {
    let arguments = format!("calibrate study.toml -o {folder} -q {settings}");
    let output = railspring(root, threads, arguments.trim_end());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let text = std::fs::read_to_string(root.join(folder).join("stiffness.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["input_uncertainty"].clone()
}

fn numbers(of: &Value) -> Vec<f64> {
    of.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

/// Source: JCGM 100:2008, 5.1.2 and ASME V&V 20, for numbers that others state. Goal: the record has the inputs of the study alone; its sums are those of its parts; without samples the first order is left; the same study
/// gives the same bytes on one thread and on three; a wrong uncertainty is refused with its key. Unit: relative changes. Accuracy: ROUNDOFF of a sum.
#[test]
fn a_study_states_the_uncertainty_of_its_inputs() {
    const ROUNDOFF: f64 = 1e-12;
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let coarse = include_str!("studies/coarse.toml")
        .replace("error_band = false", "error_band = true")
        .replace("full-integration", "incompatible-modes");
    let inputs = "[uncertainty]\nsamples = 24\ntape_diameter_mm = 0\ngauge_mm = 0\nflange_back_mm = 0\n";
    std::fs::write(root.join("study.toml"), format!("{coarse}\n{inputs}")).unwrap();
    let found = uncertainty(root, "one", "1", "");
    let names: Vec<&str> =
        found["inputs"].as_array().unwrap().iter().map(|input| input["name"].as_str().unwrap()).collect();
    let expected = [
        "inclination of the rail",
        "friction",
        "Young's modulus of the rail",
        "Young's modulus of the wheel",
        "Poisson's ratio",
    ];
    assert_eq!(names, expected);
    assert_eq!(found["samples"], 24);
    let points = found["points"].as_array().unwrap();
    assert_eq!(points.len(), 4);
    for value in points.iter().flat_map(|p| ["displacement", "tangent"].map(|key| &p[key])) {
        let number = |key: &str| value[key].as_f64().unwrap();
        let squares: f64 = numbers(&value["changes"]).iter().map(|change| change * change).sum();
        assert!((number("linear") / squares.sqrt() - 1.0).abs() < ROUNDOFF, "{value}");
        let combined = number("numerical").hypot(number("input"));
        assert!((number("combined") / combined - 1.0).abs() < ROUNDOFF, "{value}");
        let [low, high] = numbers(&value["percentiles"])[..] else { panic!("{value}") };
        assert!(low < high && (0.5 * (high - low) / number("input") - 1.0).abs() < ROUNDOFF, "{value}");
    }
    // both moduli soften the contact as much as they stiffen the bodies: more load for the same displacement
    let at = |input: usize| numbers(&points[3]["displacement"]["changes"])[input];
    assert!(at(2) < 0.0 && at(3) < 0.0, "{points:?}");
    assert_eq!(found["law"]["covariance"][0][1], found["law"]["covariance"][1][0]);

    let store = root.join("store");
    std::fs::remove_dir_all(&store).unwrap();
    assert_eq!(uncertainty(root, "three", "3", ""), found);
    let first_order = uncertainty(root, "first-order", "3", "--set uncertainty.samples=0");
    assert_eq!(first_order["points"][0]["tangent"]["changes"], points[0]["tangent"]["changes"]);
    assert!(
        first_order["points"][0]["tangent"].get("percentiles").is_none() && first_order.get("law").is_none()
    );
    let none = uncertainty(root, "none", "3", "--set calibration.error_band=false");
    assert!(none.is_null());

    let output = railspring(root, "3", "calibrate study.toml -o wrong -q --set uncertainty.friction=-0.1");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        said(&output).contains("uncertainty.friction") && said(&output).contains("0.3"),
        "{}",
        said(&output)
    );
}
