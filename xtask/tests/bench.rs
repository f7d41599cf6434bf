//! `cargo xtask bench`: its files, what it predicts, and what it refuses.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use railspring::engine::inputs::Inputs;
use railspring::engine::output::OutputFolder;
use railspring::results::bodies::estimate::Resources;
use railspring::results::study_run::StudyRun;
use railspring::study::Study;
use railspring_profiles::monitor::Silent;
use serde_json::Value;

const COARSE: &str = include_str!("../../tests/studies/coarse.toml");

/// Sweeps the solid model in a folder with the coarse study.
fn bench(root: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    std::fs::write(root.join("study.toml"), COARSE).unwrap();
    bench_of("solid", root, arguments)
}

/// Runs a command in a folder.
fn bench_of(what: &str, root: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_xtask"))
        .current_dir(root)
        .args(["bench", what])
        .args(arguments)
        .output()
        .unwrap();
    (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

fn record(folder: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("scaling.json")).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

/// Source: the counts of the meshes and factors, and the peak of the resident memory. Goal: a sweep of two sizes has both near the wanted
/// degrees of freedom, all stages of each body, exponents, a table with a row for every stage, and a figure with axes. Bodies that
/// grow have more values, and more of them than they have equations. Accuracy: DISCRETISATION, rings and layers are whole numbers, and held
/// nodes, two of some thirty sections of the rail and the bore, are no equations: 10 %; MODEL, the predicted memory of the first size: 0.35, of a program of
/// seventy mebibytes. The second size takes more of what the allocator has kept of the first or less, so that its prediction only bounds it from above.
#[test]
fn a_sweep_writes_its_sizes_their_exponents_and_a_figure() {
    const DISCRETISATION: f64 = 0.1;
    const MODEL: f64 = 0.35;
    let root = tempfile::tempdir().unwrap();
    let arguments =
        ["--study", "study.toml", "--from", "24000", "--to", "30000", "--sizes", "2", "-o", "out"];
    let (code, said, heard) = bench(root.path(), &arguments);
    assert_eq!(code, Some(0), "{heard}");
    assert!(
        said.contains("factorisation, both bodies: exponent") && heard.contains("sizes: 1 of 2"),
        "{said}{heard}"
    );
    let out = root.path().join("out");
    let found = record(&out);
    let sizes = found["sizes"].as_array().unwrap();
    assert_eq!((sizes.len(), found["skipped"].as_array().unwrap().len()), (2, 0));
    let mut rows = 0;
    for (n, (size, wanted)) in sizes.iter().zip([24e3, 30e3]).enumerate() {
        let all = number(&size["degrees_of_freedom"]);
        assert!((all / wanted - 1.0).abs() < DISCRETISATION, "{all} of {wanted}");
        let bodies = size["bodies"].as_array().unwrap();
        let sum: f64 = bodies.iter().map(|body| number(&body["degrees_of_freedom"])).sum();
        assert_eq!((bodies.len(), sum), (2, all));
        let names = |stages: &Value| {
            let stages = stages.as_array().unwrap();
            stages.iter().for_each(|stage| assert!(number(&stage["seconds"]) > 0.0, "{stage}"));
            stages.iter().map(|stage| stage["stage"].as_str().unwrap().to_string()).collect::<Vec<_>>()
        };
        for body in bodies {
            let stages = names(&body["stages"]);
            assert_eq!(stages, ["ordering", "assembly", "factorisation", "condensation", "modes"]);
            assert!(number(&body["factor_values"]) > number(&body["degrees_of_freedom"]));
            assert!(number(&body["multiplications"]) > number(&body["factor_values"]));
            // a product that does nothing else is faster, and no factorisation is a hundred times slower
            let share = number(&body["share_of_product"]);
            assert!((0.01..1.2).contains(&share), "{share}");
            rows += stages.len();
        }
        assert_eq!(names(&size["stages"]), ["mesh", "one load", "one step"], "{size}");
        rows += 3;
        if cfg!(target_os = "linux") {
            let memory = &size["memory"];
            let ratio = number(&memory["predicted_mib"]) / number(&memory["found_mib"]);
            assert!(ratio > 1.0 - MODEL && (n > 0 || ratio < 1.0 + MODEL), "{memory}");
        }
    }
    let values = |size: &Value| number(&size["bodies"][1]["factor_values"]);
    assert!(values(&sizes[1]) > values(&sizes[0]));
    let exponents = found["exponents"].as_array().unwrap();
    let of = |quantity: &str, of: &str| {
        let found = exponents.iter().find(|e| e["quantity"] == quantity && e["of"] == of);
        number(&found.unwrap_or_else(|| panic!("{quantity}: {exponents:?}"))["exponent"])
    };
    let dof = |size: &Value| number(&size["bodies"][1]["degrees_of_freedom"]);
    let slope = (values(&sizes[1]) / values(&sizes[0])).ln() / (dof(&sizes[1]) / dof(&sizes[0])).ln();
    // ROUNDOFF: some logarithms
    assert!((of("values in the factor", "wheel") - slope).abs() < 1e-9);
    assert!(of("multiplications of the factorisations", "both bodies") > 1.0);
    let table = std::fs::read_to_string(out.join("scaling.csv")).unwrap();
    let heading = "degrees_of_freedom,body,body_degrees_of_freedom,stage,seconds,peak_memory_mib";
    assert_eq!((table.lines().next(), table.lines().count()), (Some(heading), rows + 1));
    let figure = std::fs::read_to_string(out.join("scaling.svg")).unwrap();
    for text in
        ["time (s)", "memory (MiB)", "degrees of freedom of rail and wheel", "factorisation, exponent"]
    {
        assert!(figure.contains(text), "{text}");
    }
}

/// Goal: sizes that are expected to need more than there is are left out, which is said, and the results say which; nothing fails.
#[test]
fn sizes_beyond_the_memory_are_left_out() {
    let root = tempfile::tempdir().unwrap();
    let arguments = ["--study", "study.toml", "--to", "1e9", "--sizes", "2", "--memory-limit", "0.05"];
    let (code, said, heard) = bench(root.path(), &arguments);
    assert_eq!(code, Some(0), "{heard}");
    assert!(
        heard.contains("50000 degrees of freedom are left out: about") && heard.contains("0.1 GiB"),
        "{heard}"
    );
    let out = root.path().join("out/bench-solid");
    assert!(said.trim_end().ends_with("out/bench-solid"), "{said}");
    let found = record(&out);
    assert_eq!(found["sizes"].as_array().unwrap().len(), 0);
    let skipped = found["skipped"].as_array().unwrap();
    let needed: Vec<f64> = skipped.iter().map(|size| number(&size["needed_gib"])).collect();
    assert!(needed.len() == 2 && 0.05 < needed[0] && needed[0] < needed[1], "{needed:?}");
    assert!(std::fs::read_to_string(out.join("scaling.svg")).unwrap().contains("left out"));
}

/// Goal: one message with the argument, what is expected and what to do; exit code 2, and nothing written.
#[test]
fn wrong_sizes_are_refused() {
    let cases: [(&[&str], &[&str]); 5] = [
        (&["--to", "20000", "--from", "30000"], &["--to = 20000", "more than 30000"]),
        (&["--from", "100"], &["--from = 100", "contact zone", "leave it out"]),
        (&["--to", "many"], &["--to", "a number of degrees of freedom"]),
        (&["--sizes", "1"], &["--sizes"]),
        (&["--memory-limit", "0"], &["--memory-limit", "a positive number"]),
    ];
    for (arguments, parts) in cases {
        let root = tempfile::tempdir().unwrap();
        let study = ["--study", "study.toml", "-o", "deep/out", "--quiet"];
        let (code, said, heard) = bench(root.path(), &[&study[..], arguments].concat());
        assert_eq!(code, Some(2), "{arguments:?}: {heard}");
        for part in parts {
            assert!(heard.contains(part), "{arguments:?}: {part:?} in {heard}");
        }
        assert!(said.is_empty() && !root.path().join("deep").exists(), "{arguments:?}");
    }
    let root = tempfile::tempdir().unwrap();
    let (code, _, heard) = bench(root.path(), &["--study", "absent.toml"]);
    assert!(code == Some(2) && heard.contains("absent.toml"), "{heard}");
    let left: Vec<PathBuf> =
        std::fs::read_dir(root.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(left.len(), 1, "{left:?}");
}

/// Source: the counts of the cases. Goal: with rails of a hundred elements at most every case has a time (µs) of its steps that lies
/// between those of its shortest and its longest run; table, record and figure have all of them. No limit on a time.
#[test]
fn steps_of_the_moving_solver_are_timed() {
    let root = tempfile::tempdir().unwrap();
    let arguments = ["--to", "100", "--repeats", "3", "-o", "out"];
    let (code, said, heard) = bench_of("moving", root.path(), &arguments);
    assert_eq!(code, Some(0), "{heard}");
    let out = root.path().join("out");
    let text = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let found: Value = serde_json::from_str(&text("moving.json")).unwrap();
    let times = found["times"].as_array().unwrap();
    let names: Vec<_> = times
        .iter()
        .map(|time| (time["case"].as_str().unwrap(), time["elements"].as_u64().unwrap()))
        .collect();
    let bridge = "bridge of 25 m";
    let load_cases = [("load case 4.1", 20), ("4.1 as in a study", 20)];
    let rails = [(bridge, 20), (bridge, 40), (bridge, 80), ("rail", 20), ("rail", 100)];
    assert_eq!(names, [&load_cases[..], &rails].concat());
    for time in times {
        let of = |key: &str| number(&time[key]);
        assert_eq!(time["element"], "published");
        assert!(0.0 < of("microseconds") && of("microseconds") <= of("median_microseconds"), "{time}");
        assert!(of("median_microseconds") <= of("longest_microseconds"), "{time}");
        // a step that changes anything has an iteration
        assert!(of("iterations") >= 1.0 && of("steps") >= 550.0, "{time}");
    }
    assert!(said.contains("all in turns") && said.trim_end().ends_with("out"), "{said}");
    assert_eq!(text("moving.csv").lines().count(), 1 + times.len());
    assert_eq!(found["peers"].as_array().unwrap().len(), 0);
    let figure = text("moving.svg");
    for words in ["beam elements", "time of a step (\u{b5}s)", "rail, published element", "in turns"] {
        assert!(figure.contains(words), "{words}");
    }
    let (code, _, heard) = bench_of("moving", root.path(), &["--to", "10", "-o", "deep/out"]);
    assert!(code == Some(2) && heard.contains("20..=10000"), "{heard}");
    assert!(!root.path().join("deep").exists());
}

/// Source: OpenSees (WheelRail), FMPy and Exudyn from the package index, and hosts in Rust and C. Goal: each runs its case in turns with this program's own. Record, table and what is printed have its time
/// (µs a step) under that of the same case, with the ratio. No limit on a time.
#[test]
#[ignore = "some minutes, and packages of 300 MB: cargo long other_programs_are_timed"]
fn other_programs_are_timed_in_the_same_run() {
    let root = tempfile::tempdir().unwrap();
    let (code, said, heard) =
        bench_of("moving", root.path(), &["--to", "20", "--repeats", "1", "-o", "out", "--peers"]);
    assert_eq!(code, Some(0), "{heard}");
    let text = |name: &str| std::fs::read_to_string(root.path().join("out").join(name)).unwrap();
    let found: Value = serde_json::from_str(&text("moving.json")).unwrap();
    let (times, peers) = (found["times"].as_array().unwrap(), found["peers"].as_array().unwrap());
    let names: Vec<_> = peers.iter().map(|peer| peer["program"].as_str().unwrap()).collect();
    assert_eq!(names.len(), 7, "{names:?}");
    assert_eq!(text("moving.csv").lines().count(), 1 + times.len() + peers.len());
    for peer in peers {
        let own: Vec<&Value> = times.iter().filter(|time| time["case"] == peer["case"]).collect();
        assert_eq!(own.len(), if peer["case"] == "4.1 in equal steps" { 1 } else { 2 }, "{peer}");
        let line = said.lines().find(|line| line.contains(peer["program"].as_str().unwrap())).unwrap();
        let ratio = number(&peer["microseconds"]) / number(&own[0]["microseconds"]);
        assert!(line.ends_with(&format!("  {ratio:.1}")) && ratio > 0.0, "{line}");
    }
}

/// Goal: with laws by contact angle of the default pair, every case is timed with both contact elements in turn; a file without an element is refused with its name.
#[test]
fn both_contact_elements_are_timed() {
    let root = tempfile::tempdir().unwrap();
    let coarse = COARSE.replace("shifts_mm = []", "shifts_mm = [0, 6]");
    let load_case = "[scenario.one]\nsteps = 3\nvertical_force = { mean_kn = 50 }\nlateral_force = {}\n";
    let calibrate = |text: &str, out: &str| {
        let study = Study::parse(Path::new("study.toml"), text).unwrap();
        let folder = OutputFolder::create(&root.path().join(out), &Inputs::none()).unwrap();
        let pipeline = StudyRun::new(&study, &folder, Resources::of_the_machine(&Silent));
        pipeline.calibrate().unwrap_or_else(|e| panic!("{e}"));
        format!("{out}/stiffness_by_angle.json")
    };
    let laws = calibrate(&format!("{coarse}\n{load_case}"), "laws");
    let arguments = ["--to", "20", "--repeats", "1", "-o", "out", "--element", &laws];
    let (code, _, heard) = bench_of("moving", root.path(), &arguments);
    assert_eq!(code, Some(0), "{heard}");
    let text = std::fs::read_to_string(root.path().join("out/moving.json")).unwrap();
    let found: Value = serde_json::from_str(&text).unwrap();
    let times = found["times"].as_array().unwrap();
    let names: Vec<_> = times
        .iter()
        .map(|time| (time["case"].as_str().unwrap(), time["element"].as_str().unwrap()))
        .collect();
    let cases = ["load case 4.1", "4.1 as in a study", "4.1 in equal steps", "bridge of 25 m", "rail"];
    let both = cases.iter().flat_map(|case| [(*case, "published"), (*case, "condensed")]);
    // hosts of the element have no other one
    let both = both.filter(|one| *one != (cases[2], "published"));
    assert_eq!(names, both.collect::<Vec<_>>());
    for time in times {
        let inner = number(&time["inner_steps"]);
        match (time["case"] == cases[1], time["element"] == "published") {
            (true, true) => assert_eq!(inner, 16.0, "{time}"),
            (true, false) => assert!(inner > 1.0 && inner < 16.0, "{time}"),
            (false, _) => assert_eq!(inner, 1.0, "{time}"),
        }
        assert!(number(&time["microseconds"]) > 0.0 && number(&time["iterations"]) > 0.0, "{time}");
    }
    let without = calibrate(&coarse, "bare");
    let (code, _, heard) =
        bench_of("moving", root.path(), &["--to", "20", "-o", "none", "--element", &without]);
    assert!(code == Some(2) && heard.contains("bare/stiffness_by_angle.json = no `element`"), "{heard}");
}
