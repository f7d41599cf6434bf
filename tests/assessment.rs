//! Intended use, measured curve and review of a study, as its files and its report have them.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

const CURVE: &str = include_str!("studies/force-displacement.csv");

fn railspring(root: &Path, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
    command.current_dir(root).args(arguments.split(' ')).env("RAILSPRING_CACHE", root.join("store"));
    command.output().unwrap()
}

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat()
}

fn json(root: &Path, file: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(root.join(file)).unwrap()).unwrap()
}

/// Source: ASME V&V 20 for the parts of the record, and the study's own load curve. Goal: a study with an
/// intended use and a measured curve has its requirements as lines of the verdict. The curve's errors are in
/// `verification.json` and on the page. The model's displacement lies between those of the loads beside the
/// measured force. A requirement that is not kept fails the command. Units: mm, kN. Accuracy: ROUNDOFF of a
/// root of squares.
#[test]
fn a_study_is_held_against_its_use_and_a_measurement() {
    const ROUNDOFF: f64 = 1e-12;
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let coarse = include_str!("studies/coarse.toml")
        .replace("error_band = false", "error_band = true")
        .replace("full-integration", "incompatible-modes");
    let assessed = "[intended_use]\npurpose = \"Curves of 300 m\"\ntangent_percent = 900\n[uncertainty]\nsamples = 8\n[validation]\nmeasured = \"curve.csv\"\n\
        standard_uncertainty_mm = 0.004\n[review]\nauthor = \"A. Maker\"\nreviewer = \"B. Reader\"\nindependent_of = \"the maker's office\"\n";
    std::fs::write(root.join("study.toml"), format!("{coarse}\n{assessed}")).unwrap();
    std::fs::write(root.join("curve.csv"), CURVE).unwrap();
    let output = railspring(root, "run study.toml -o out -q");
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", said(&output));
    let verdict = json(root, "out/verification.json");
    let [line] = verdict["requirements"].as_array().unwrap().as_slice() else { panic!("{verdict}") };
    assert_eq!(
        (&line["quantity"], &line["kind"], &line["holds"]),
        (&"tangent_percent".into(), &"acceptance".into(), &true.into())
    );
    let found = &verdict["validation"];
    let points = found["points"].as_array().unwrap();
    assert_eq!(points.len(), 5);
    let curve = csv::Reader::from_path(root.join("out/load_curve.csv")).unwrap().into_records();
    let curve: Vec<[f64; 2]> =
        curve.map(|row| row.unwrap()).map(|row| [1, 2].map(|i| row[i].parse().unwrap())).collect();
    for point in points {
        let number = |key: &str| point[key].as_f64().unwrap();
        let below = curve.iter().rfind(|[force, _]| *force <= number("force_kn")).unwrap();
        let above = curve.iter().find(|[force, _]| *force >= number("force_kn")).unwrap();
        assert!((below[1]..=above[1]).contains(&number("model_mm")), "{point}");
        assert!(
            (number("model_mm") - number("measured_mm") - number("error_mm")).abs() < ROUNDOFF,
            "{point}"
        );
        let parts = ["numerical_mm", "input_mm", "measurement_mm"].map(number);
        assert!(parts.iter().all(|part| *part > 0.0) && parts[2] == 0.004, "{point}");
        let all = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        assert!((number("validation_mm") / all - 1.0).abs() < ROUNDOFF, "{point}");
    }
    let page = std::fs::read_to_string(root.join("out/report.html")).unwrap();
    let annex = page.split("<h2 id=\"annex\">").nth(1).unwrap();
    for text in [
        "Curves of 300 m",
        "curve.csv: displacement against",
        "B. Reader",
        "the maker's office",
        "observed order of bricks",
    ] {
        assert!(annex.replace("&#x27;", "'").contains(text), "{text}");
    }
    assert!(
        page.find("Curves of 300 m").unwrap() < page.find("<h2 id=\"use\">").unwrap(),
        "use stands before results"
    );

    let strict = railspring(root, "run study.toml -o strict -q --set intended_use.tangent_percent=0.01");
    assert_eq!(strict.status.code(), Some(1), "{}", said(&strict));
    let failing = json(root, "strict/verification.json");
    assert_eq!(failing["requirements"][0]["holds"], false);
    let page = std::fs::read_to_string(root.join("strict/report.html")).unwrap();
    assert!(page.contains("the study asks for it") && page.contains("NOT kept"));
}

/// Goal: a curve that cannot be compared is refused before anything is computed, with its line and that of the study; keys beside no curve are refused; a new study asks
/// what the springs are for.
#[test]
fn curves_that_cannot_be_compared_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let coarse = include_str!("studies/coarse.toml");
    let refused = |curve: &str, keys: &str, said_of: &str| {
        std::fs::write(root.join("study.toml"), format!("{coarse}\n[validation]\n{keys}\n")).unwrap();
        std::fs::write(root.join("curve.csv"), curve).unwrap();
        let output = railspring(root, "run study.toml -o out -q");
        let message = said(&output);
        assert!(output.status.code() == Some(2) && message.contains(said_of), "{message}");
        assert!(!root.join("out").exists());
        message
    };
    let named = "measured = \"curve.csv\"";
    let message = refused(&CURVE.replace("40;", "4;"), named, "curve.csv:5: force 4 kN after 20 kN");
    assert!(message.contains("study.toml:") && message.contains("validation.measured"), "{message}");
    refused(&CURVE.replace("80;", "8000;"), named, "curve.csv:7: 8000 kN: expected a force within the loads");
    refused(
        &CURVE.replace("force_kn", "force"),
        named,
        "curve.csv:2: \"force\": expected a line of names with units",
    );
    refused(CURVE, "measured = \"none.csv\"", "a readable file");
    refused(CURVE, "zero = \"first-line\"", "validation.measured beside it");

    let new = railspring(root, "new mine");
    assert!(said(&new).contains("intended_use.purpose"), "{}", said(&new));
    let silent = railspring(root, "new other --set intended_use.purpose=curves");
    assert!(!said(&silent).contains("intended_use.purpose"), "{}", said(&silent));
}
