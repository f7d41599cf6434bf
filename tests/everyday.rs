//! The commands of a first day: springs of a pair without a study, a study to go on from, keys on the command line, results for a program, help.
//!
//! Goal: what is said and what is left in folders, exactly; no tolerance.

use std::path::Path;
use std::process::Output;

use railspring_profiles::section::rail_section;
use railspring_testing::{Place, message, said};
use serde_json::Value;

const COARSE: &str = include_str!("studies/coarse.toml");
/// Keys that make a pair coarse, as `COARSE`.
const COARSELY: [&str; 12] = [
    "--set",
    "mesh.contact_element_mm=6",
    "--set",
    "mesh.contact_element_along_mm=6",
    "--set",
    "calibration.load_count=4",
    "--set",
    "calibration.load_min_kn=5",
    "--set",
    "calibration.shifts_mm=[]",
    "--set",
    "calibration.error_band=false",
];

/// An empty folder for this file's tests, which have one store.
fn empty() -> Place {
    Place::new(env!("CARGO_BIN_EXE_railspring"), concat!(env!("CARGO_TARGET_TMPDIR"), "/everyday"))
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {}", said(output)))
}

/// A measured head, 60E1 lower by 0.3 mm on its crown, as columns.
fn head() -> String {
    let rows = rail_section("60E1").unwrap().running.sample(0.5e-3).into_iter().map(|p| {
        let worn = 0.3 * (1.0 - (p.x / 0.03).powi(2)).max(0.0);
        format!("{:.6},{:.6}\n", 1e3 * p.x, 1e3 * p.y + worn)
    });
    ["y_mm,z_mm\n".to_owned()].into_iter().chain(rows).collect()
}

/// The springs of a measured head without a study. Its standard is found and printed, assumptions are
/// printed, and the results end the command. The study that is left in the folder is that of the fit, whose
/// results are taken from the store.
#[test]
fn a_pair_is_fitted_without_a_study() {
    let place = empty();
    place.write("head.csv", &head());
    let output = place.run(&[&["fit", "S1002", "head.csv"], &COARSELY[..]].concat());
    let (text, remarks) = (said(&output), message(&output));
    assert!(matches!(output.status.code(), Some(0 | 1)), "{remarks}");
    for part in [
        "law: k(f) = ",
        "  a  ",
        "  b  ",
        "  c  ",
        "horizontal stiffness: k_h = ",
        "error band: ",
        "verdict: ",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert_eq!(text.lines().last(), Some("out/S1002-on-head/report.html"));
    for part in [
        "taken as measured on ",
        " would fit as well",
        "`rail.standard` gives another",
        "assumed: ",
        "contact.friction = 0.5",
    ] {
        assert!(remarks.contains(part), "{part}: {remarks}");
    }
    let study = place.read("out/S1002-on-head/study.toml");
    assert!(
        study.contains("profile_file = \"../../head.csv\"") && study.contains("load_count = 4"),
        "{study}"
    );
    let again = place.run(&["calibrate", "out/S1002-on-head/study.toml", "--json"]);
    assert!(message(&again).contains("calibration: taken from the store"), "{}", message(&again));
    let stiffness: Value = serde_json::from_str(&place.read("out/S1002-on-head/stiffness.json")).unwrap();
    assert_eq!(json(&again)["springs"]["b_kn_per_m"], stiffness["law"]["b_kn_per_m"]);
}

/// What cannot be fitted is said of the argument or option, and nothing is left behind.
#[test]
fn a_pair_that_cannot_be_fitted_is_named() {
    let place = empty();
    place.write("head.csv", &head());
    place.write("bad.csv", "y_mm,z_mm\n1,2\n1,x\n");
    for (arguments, parts) in [
        (&["fit", "S1003", "60E1"][..], &["error: WHEEL = \"S1003\"", "did you mean \"S1002\"?"][..]),
        (&["fit", "60E1", "S1002"], &["error: WHEEL = \"60E1\""]),
        (&["fit", "head.csv", "60E1"], &["WHEEL head.csv: wheel.profile_file", "the shape of a rail"]),
        (&["fit", "S1002", "bad.csv"], &["bad.csv:3:3"]),
        (
            &["fit", "S1002", "60E1", "--set", "contact.friction=3"],
            &["error: --set contact.friction=3: contact.friction = 3"],
        ),
        (&["new", "x", "--rail", "61E1"], &["error: --rail = \"61E1\"", "did you mean"]),
        (&["new", "a b"], &["name = \"a b\"", "letters, digits"]),
    ] {
        let output = place.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", message(&output));
        for part in parts {
            assert!(message(&output).contains(part), "{part}: {}", message(&output));
        }
        assert_eq!(std::fs::read_dir(place.root()).unwrap().count(), 2, "{arguments:?} leaves nothing");
    }
    // a place in a file is no key
    let of_file = message(&place.run(&["fit", "S1002", "bad.csv"]));
    assert!(!of_file.contains("keys are given with"), "{of_file}");
}

/// A new study is read as it stands, names files from its own folder, and takes the place of no other file.
#[test]
fn a_new_study_runs_and_replaces_nothing() {
    let place = empty();
    place.write("head.csv", &head());
    let output = place.run(&["new", "studies/mine", "--rail", "head.csv", "--set", "contact.friction=0.3"]);
    assert_eq!(
        (output.status.code(), said(&output).trim()),
        (Some(0), "studies/mine.toml"),
        "{}",
        message(&output)
    );
    let text = place.read("studies/mine.toml");
    for part in
        ["profile_file = \"../head.csv\"", "friction = 0.3", "[scenario.constant]", "railspring explain"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    let dry = place.run(&["run", "studies/mine.toml", "--dry-run"]);
    assert!(said(&dry).contains("degrees of freedom"), "{}", message(&dry));
    let again = place.run(&["new", "studies/mine.toml"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(message(&again).contains("what is there stays as it is"), "{}", message(&again));
    assert_eq!(place.read("studies/mine.toml"), text);
    assert_eq!(std::fs::read_dir(place.path("studies")).unwrap().count(), 1);
}

/// One JSON object on standard output: springs, verdict with every line, exit code; of a study that is refused its mistakes. Colours are not for a pipe.
#[test]
fn results_are_json_on_request() {
    let place = empty();
    place.write("study.toml", COARSE);
    let output = place.run(&["run", "study.toml", "--json", "--quiet"]);
    let found = json(&output);
    let code = output.status.code().unwrap();
    assert_eq!((&found["command"], &found["exit_code"]), (&"run".into(), &code.into()), "{found}");
    let verdict = &found["verdict"];
    let lines = verdict["lines"].as_array().unwrap();
    let failing = lines.iter().filter(|line| line["holds"] == false).count();
    assert_eq!(
        (verdict["limits"].as_u64(), verdict["fail"].as_u64()),
        (Some(lines.len() as u64), Some(failing as u64))
    );
    assert_eq!(failing > 0, code == 1);
    let record: Value = serde_json::from_str(&place.read("out/coarse/stiffness.json")).unwrap();
    for key in ["a_kn_per_m", "b_kn_per_m", "c", "f0_kn", "range_kn"] {
        assert_eq!(found["springs"][key], record["law"][key], "{key}");
    }
    assert_eq!(found["springs"]["horizontal_kn_per_m"], record["horizontal_kn_per_m"]);
    let report = place.run(&["report", "study.toml"]);
    assert!(
        said(&report).contains(verdict["headline"].as_str().unwrap()) && !said(&report).contains('\u{1b}')
    );

    let refused = place.run(&["run", "study.toml", "--json", "--set", "contact.friction=3"]);
    assert_eq!(refused.status.code(), Some(2));
    let mistakes = json(&refused);
    let first = mistakes["errors"][0].as_str().unwrap();
    assert!(first.starts_with("study.toml with --set contact.friction=3: "), "{mistakes}");
    assert_eq!(mistakes["exit_code"], 2);
}

/// Keys are explained, shells get completions, and every command has a manual page.
#[test]
fn help_is_in_the_terminal() {
    let place = empty();
    let key = said(&place.run(&["explain", "contact.friction"]));
    assert!(key.contains("a number from 0 to 2") && key.contains("default  0.5"), "{key}");
    let wrong = place.run(&["explain", "contact.frction"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(message(&wrong).contains("did you mean `contact.friction`?"), "{}", message(&wrong));
    for shell in ["bash", "zsh", "fish"] {
        let text = said(&place.run(&["completions", shell]));
        assert!(text.contains("calibrate") && text.contains("dry-run"), "{shell}");
    }
    let version = said(&place.run(&["--version"]));
    let begin = concat!("railspring ", env!("CARGO_PKG_VERSION"), " (");
    let origin = version.trim_end().strip_prefix(begin).and_then(|rest| rest.strip_suffix(')'));
    let origin = origin.unwrap_or_else(|| panic!("{version}"));
    // in its repository it is the commit of that, and has changes only where something is changed
    let git = |arguments: &[&str]| {
        let output = std::process::Command::new("git")
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(arguments)
            .output();
        let output = output.ok().filter(|output| output.status.success())?;
        Some(String::from_utf8(output.stdout).unwrap().trim().to_string())
    };
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().unwrap();
    let root = git(&["rev-parse", "--show-toplevel"]).and_then(|root| Path::new(&root).canonicalize().ok());
    if root == Some(here) {
        let commit = git(&["rev-parse", "--short=12", "HEAD"]).unwrap();
        let [built, changed] = [format!("commit {commit}"), format!("commit {commit} and changes")];
        let clean = git(&["status", "--porcelain"]).is_some_and(|status| status.is_empty());
        assert!(origin == built || origin == changed && !clean, "{version} of {commit}");
    } else {
        let packed = origin.strip_prefix("commit ").is_some_and(|commit| commit.len() == 12);
        assert!(packed || origin == "built outside of its repository, commit not known", "{version}");
    }
    assert!(said(&place.run(&["man"])).contains(".TH railspring 1"));
    assert_eq!(place.run(&["man", "-o", "man"]).status.code(), Some(0));
    for command in ["railspring", "railspring-fit", "railspring-run", "railspring-profile-place"] {
        assert!(Path::new(&place.path("man")).join(format!("{command}.1")).exists(), "{command}");
    }
}
