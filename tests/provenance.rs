//! Results are used by the inputs that they were made from, and by nothing else.
//!
//! Goal: whatever lies in the output folder, a command uses a result of these very inputs, makes it again, or
//! refuses. A refusal names what is missing or stale and the command to run. No verdict or report stands
//! beside results that it was not made from. Source: a clean run of the same study, equal to the byte.

use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::OnceLock;

use assert_cmd::Command;
use railspring::engine::inputs::Inputs;
use railspring::engine::output::OutputFolder;
use railspring_testing::copy;
use serde_json::Value;

/// The coarse study with a short load case.
fn study(vertical_kn: f64, more: &str) -> String {
    let load_case = format!(
        "[scenario.one]\nsteps = 6\nvertical_force = {{ mean_kn = {vertical_kn} }}\nlateral_force = {{ mean_kn = 5 }}\n"
    );
    format!("{}\n{load_case}{more}", include_str!("studies/coarse.toml"))
}

struct Place {
    root: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        Self { root: tempfile::tempdir().unwrap() }
    }

    /// A folder with the results of the study with 50 kN, made once.
    fn with_results() -> Self {
        static MADE: OnceLock<PathBuf> = OnceLock::new();
        let made = MADE.get_or_init(|| {
            let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("provenance");
            let _ = std::fs::remove_dir_all(&root);
            std::fs::create_dir_all(&root).unwrap();
            let output = railspring(&root, &study(50.0, ""), &["run"]);
            assert_eq!(output.status.code(), Some(1), "{}", message(&output));
            root
        });
        let place = Self::new();
        copy(&made.join("out"), &place.root.path().join("out"));
        place
    }

    fn run(&self, study: &str, arguments: &[&str]) -> Output {
        railspring(self.root.path(), study, arguments)
    }

    fn out(&self, name: &str) -> PathBuf {
        self.root.path().join("out").join(name)
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.out(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }
}

fn railspring(root: &Path, study: &str, arguments: &[&str]) -> Output {
    std::fs::write(root.join("study.toml"), study).unwrap();
    Command::cargo_bin("railspring")
        .unwrap()
        .current_dir(root)
        .env("RAILSPRING_CACHE", root.join("cache"))
        .args(arguments)
        .args(["study.toml", "-o", "out"])
        .output()
        .unwrap()
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn printed(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Goal: results of another load case are refused by `report` and by `verify`, and made again; then all is as in a
/// clean folder.
#[test]
fn results_of_another_load_case_are_not_used() {
    let place = Place::with_results();
    let other = study(90.0, "");
    let before = place.read("solid_history.csv");
    assert_eq!(place.run(&other, &["calibrate", "--quiet"]).status.code(), Some(0));
    let refused = place.run(&other, &["report", "--quiet"]);
    assert_eq!(refused.status.code(), Some(2));
    for part in ["out/history.csv (made from", "out/solid_history.csv (made from", "`railspring simulate`"] {
        assert!(message(&refused).contains(part), "{part:?} in {}", message(&refused));
    }
    let refused = place.run(&other, &["verify", "--quiet"]);
    assert_eq!(refused.status.code(), Some(2), "the simple history is stale, too");
    assert!(message(&refused).contains("make it again with `railspring simulate`"), "{}", message(&refused));

    assert_eq!(place.run(&other, &["simulate", "--quiet"]).status.code(), Some(0));
    assert!(
        !place.out("verification.json").exists() && !place.out("report.html").exists(),
        "of the other history"
    );
    assert!(place.run(&other, &["verify", "--quiet"]).status.code() <= Some(1));
    assert_eq!(place.run(&other, &["report", "--quiet"]).status.code(), Some(0));
    assert_ne!(place.read("solid_history.csv"), before);

    let clean = Place::new();
    assert!(clean.run(&other, &["run", "--quiet"]).status.code() <= Some(1));
    let names = [
        "stiffness.json",
        "load_curve.csv",
        "history.csv",
        "solid_history.csv",
        "verification.json",
        "results.json",
    ];
    for name in names {
        assert!(place.read(name) == clean.read(name), "{name} differs from that of a clean run");
    }
}

/// Goal: solid histories are taken where only the springs have changed, and not touched where nothing has.
#[test]
fn what_did_not_change_is_used() {
    let place = Place::with_results();
    let (before, verdict) = (place.read("solid_history.csv"), place.read("verification.json"));
    let same = study(50.0, "[verification]\nvertical_rms = 0.03\n");
    let output = place.run(&same, &["verify"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(!message(&output).contains("solid"), "the solid model ran again: {}", message(&output));
    assert_eq!(place.read("verification.json"), verdict);
    assert!(place.out("report.html").exists(), "nothing has changed");

    let springs = study(50.0, "[simulation]\nhorizontal_kn_per_m = 50000\n");
    assert_eq!(place.run(&springs, &["simulate"]).status.code(), Some(0));
    let output = place.run(&springs, &["verify"]);
    assert!(!message(&output).contains("solid"), "the solid model ran again: {}", message(&output));
    assert_eq!(place.read("solid_history.csv"), before);

    let times = |place: &Place| {
        place.read("report.html").split("<section id=\"measured\">").nth(1).unwrap().to_owned()
    };
    assert_eq!(place.run(&springs, &["report"]).status.code(), Some(0));
    assert!(times(&place).contains("solid model, one") && times(&place).contains("calibration"));
    // Another load case in the same folder: the times of this one are not its own.
    let renamed = springs.replace("scenario.one", "scenario.two").replace("mean_kn = 50", "mean_kn = 90");
    assert_eq!(place.run(&renamed, &["simulate"]).status.code(), Some(0));
    assert!(place.run(&renamed, &["verify"]).status.code() <= Some(1));
    assert_eq!(place.run(&renamed, &["report"]).status.code(), Some(0));
    assert!(times(&place).contains("model, two") && !times(&place).contains("model, one"));

    let strict = study(50.0, "[verification]\nvertical_rms = 0.001\n");
    let stale = place.run(&strict, &["report"]);
    assert!(message(&stale).contains("verification.json (made from"), "other limits: {}", message(&stale));
}

/// Goal: edited files are refused, with their line where a value is wrong.
#[test]
fn edited_files_are_refused() {
    let same = study(50.0, "");
    for (name, from, to, part) in [
        ("history.csv", "0.0005,", "NaN,", "out/history.csv:3 = \"NaN\" in column 1"),
        ("history.csv", "\n", "\n\n", "out/history.csv = another content than is listed"),
        ("history_disturbed.csv", "0.0005,", "NaN,", "out/history_disturbed.csv:3 = \"NaN\" in column 1"),
        ("history.csv", "0.0005,", "0.0006,", "out/history.csv:2 = \"0\" in column 15"),
        ("solid_history_disturbed.csv", "\n", "\n\n", "out/solid_history_disturbed.csv = another content"),
        ("solid_history.csv", "0.001,", "0.0005,", "out/solid_history.csv:4 = 0.0005 s after 0.0005 s"),
        (
            "stiffness.json",
            "\"study\": \"coarse\"",
            "\"study\": \"other\"",
            "out/stiffness.json = another content",
        ),
        (
            "verification.json",
            "\"holds\": false",
            "\"holds\": true",
            "out/verification.json = another content",
        ),
        ("load_curve.csv", "\n", "\n\n", "out/load_curve.csv = another content"),
    ] {
        let place = Place::with_results();
        let text = place.read(name);
        assert!(text.contains(from), "{name}: {from}");
        std::fs::write(place.out(name), text.replacen(from, to, 1)).unwrap();
        let refused = place.run(&same, &["report", "--quiet"]);
        assert_eq!(refused.status.code(), Some(2), "{name}");
        // The report lists all faults; each stands as file and value.
        let (file, value) = part.split_once(" = ").unwrap();
        assert!(message(&refused).contains(&format!("{file} ({value}")), "{part:?} in {}", message(&refused));
        if name == "history.csv" {
            let refused = place.run(&same, &["verify", "--quiet"]);
            assert!(
                refused.status.code() == Some(2) && message(&refused).contains(part),
                "{}",
                message(&refused)
            );
        }
    }
    let place = Place::with_results();
    std::fs::remove_file(place.out("results.json")).unwrap();
    let refused = place.run(&same, &["report", "--quiet"]);
    // without the list no file is known as the program's own
    assert!(
        message(&refused).contains("out/report.html = a file that this program"),
        "{}",
        message(&refused)
    );
    std::fs::remove_file(place.out("report.html")).unwrap();
    let refused = place.run(&same, &["report", "--quiet"]);
    assert!(
        message(&refused).contains("out/stiffness.json (not listed in results.json)"),
        "{}",
        message(&refused)
    );
}

/// Goal: a law from a file is used with its reference force, and named in terminal, results and report; a verdict on it
/// has no lines about the study's own springs.
#[test]
fn a_law_from_a_file_is_named_everywhere() {
    let place = Place::with_results();
    let own = study(50.0, "");
    let law = r#"{"a_kn_per_m": 30000, "b_kn_per_m": 294000, "c": 0.241104, "f0_kn": 1, "horizontal_kn_per_m": 80000, "reference": "beam", "range_kn": [1, 2]}"#;
    std::fs::write(place.root.path().join("mine.json"), law).unwrap();
    let output = place.run(&own, &["simulate", "--law", "mine.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", message(&output));
    let (pair, range) =
        ("mine.json does not say for which pair its law is", "leaves the law's fitted range, 1 to 2 kN");
    for note in [pair, range] {
        assert!(printed(&output).contains(note), "{note:?} in {}", printed(&output));
    }
    let with_1_kn = place.read("history.csv");
    let b = 294_000.0 * 10f64.powf(0.241104);
    let scaled = law.replace("\"f0_kn\": 1", "\"f0_kn\": 10").replace("294000", &b.to_string());
    std::fs::write(place.root.path().join("mine.json"), scaled).unwrap();
    place.run(&own, &["simulate", "--law", "mine.json"]);
    let (a, b) = (numbers(&with_1_kn), numbers(&place.read("history.csv")));
    // SOLVER: the constants agree to rounding, the iterations of the simple model end at 1e-9.
    const SOLVER: f64 = 1e-6;
    let largest = a.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    assert!(a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= SOLVER * largest));

    let output = place.run(&own, &["verify"]);
    assert!(output.status.code() <= Some(1), "{}", message(&output));
    assert!(printed(&output).contains(pair) && printed(&output).contains(range), "{}", printed(&output));
    let verdict = place.json("verification.json");
    assert_eq!(verdict["calibration"].as_array().unwrap().len(), 0);
    assert_eq!(verdict["scenarios"][0]["simple"]["springs"]["source"]["file"]["name"], "mine.json");
    assert_eq!(place.run(&own, &["report"]).status.code(), Some(0));
    let report = place.read("report.html");
    assert!(report.contains(pair) && report.contains("1 to 2 kN"));

    let foot = law.replace("beam", "foot");
    std::fs::write(place.root.path().join("mine.json"), foot).unwrap();
    let refused = place.run(&own, &["simulate", "--law", "mine.json"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(message(&refused).contains("mine.json: reference = \"foot\""), "{}", message(&refused));
}

/// Time and vertical force of each row.
fn numbers(history: &str) -> Vec<f64> {
    history
        .lines()
        .skip(1)
        .flat_map(|line| line.split(',').take(2).map(|cell| cell.parse().unwrap()))
        .collect()
}

/// Goal: a law that counts the rail's compliance twice stops `run` before it computes, and `calibrate` does not mind.
#[test]
fn a_law_against_the_foot_is_not_put_on_a_beam() {
    let foot = study(50.0, "").replace("load_count = 5", "load_count = 5\nreference = \"foot\"");
    let place = Place::new();
    let refused = place.run(&foot, &["run", "--quiet"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(message(&refused).contains("calibration.reference = \"foot\""), "{}", message(&refused));
    assert!(!place.out("").exists(), "nothing is left behind");
}

/// Goal: a load case in which nothing touches ends with exit code 1, and the last lines say the verdict and where the results are.
#[test]
fn nothing_touches_is_no_pass() {
    let place = Place::new();
    let up = study(-60.0, "");
    let output = place.run(&up, &["run", "--quiet"]);
    assert_eq!(output.status.code(), Some(1), "{}", message(&output));
    let again = place.run(&up, &["verify"]);
    let text = printed(&again);
    let verdict = text.lines().skip_while(|line| !line.starts_with("verdict: ")).collect::<Vec<_>>();
    assert!(verdict[0].contains(" fail") && !verdict[0].contains(" 0 fail"), "{text}");
    assert!(verdict[1].starts_with("  FAILS  one: ") && verdict[1].contains("(limit "), "{text}");
    assert!(verdict.last().is_some_and(|last| last.ends_with("out")), "{text}");
    assert!(text.contains("FAILS  one: Models in which the wheel never touches the rail"), "{text}");
}

/// Goal: a folder that another process writes to is refused, and its files stay.
#[test]
fn one_process_writes_at_a_time() {
    let place = Place::with_results();
    let folder = OutputFolder::open(&place.out(""), &Inputs::none()).unwrap();
    let claim = folder.claim().unwrap();
    let refused = place.run(&study(50.0, ""), &["report", "--quiet"]);
    assert_eq!(refused.status.code(), Some(2), "{}", message(&refused));
    assert!(message(&refused).contains("no other railspring is writing to"), "{}", message(&refused));
    drop(claim);
    assert_eq!(place.run(&study(50.0, ""), &["report", "--quiet"]).status.code(), Some(0));
}

/// Goal: a wheel that leaves the rail is a result: exit code 1, its history kept and read again, its time in terminal,
/// verdict and report, and no pass. Lateral force 500 kN into the track.
#[test]
fn a_wheel_that_leaves_the_rail_is_a_result() {
    let derails = study(50.0, "")
        .replace("steps = 6", "steps = 60\nsolid = false")
        .replace("lateral_force = { mean_kn = 5 }", "lateral_force = { mean_kn = -500 }");
    let place = Place::with_results();
    let output = place.run(&derails, &["simulate"]);
    assert_eq!(output.status.code(), Some(1), "{}", message(&output));
    assert!(printed(&output).contains("one: left the profile at 0.0"), "{}", printed(&output));
    let rows = place.read("history.csv").lines().count() - 1;
    assert!((2..61).contains(&rows), "{rows} rows");
    let output = place.run(&derails, &["verify"]);
    assert_eq!(output.status.code(), Some(1), "{}", message(&output));
    let line = "FAILS  one: Models whose run ends before the last step 1 (limit 0); simple model: left the profile at";
    assert!(printed(&output).contains(line), "{}", printed(&output));
    let run = &place.json("results.json")["files"]["history.csv"]["run"];
    assert_eq!(run["ending"], "gauge-side");
    let left = run["ended_at_s"].as_f64().unwrap();
    // within the time step after the last row
    let steps = left / 0.0005;
    assert!(steps > rows as f64 - 1.0 && steps < rows as f64 + 1e-6, "{left} s after {rows} rows");
    assert_eq!(place.run(&derails, &["report"]).status.code(), Some(0));
    assert!(place.read("report.html").contains("Simple model, published element: left the profile at"));
}
