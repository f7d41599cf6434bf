//! The kept cross-validations in `data/crosscheck` are those of the studies, the reference and the
//! tool as they are now.
//!
//! Source: the records themselves. Goal: input hash, hash of the reference package, hub displacement (mm), tangent stiffness and
//! horizontal stiffness (kN/m) of the tool under every load of the record, forces (kN) of the tool at all times of a load case, and the verdict.
//! Accuracy: hashes exactly, numbers to what the order of sums on another processor may change.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use railspring::engine::inputs::Inputs;
use railspring::engine::output::OutputFolder;
use railspring::python::{package_hash, package_hash_in_time};
use railspring::results::bodies::estimate::Resources;
use railspring::results::bodies::{geometry, meshes, zones};
use railspring::results::crosscheck::answers;
use railspring::results::crosscheck::in_time::input::InTimeInput;
use railspring::results::crosscheck::in_time::tool::{self, ToolRuns};
use railspring::results::crosscheck::input::CrosscheckInput;
use railspring::results::crosscheck::questions::tool_curves;
use railspring::results::crosscheck::record::{CrosscheckRecord, RunInTime, ToolCurve};
use railspring::results::study_run::StudyRun;
use railspring::study::Study;
use railspring_profiles::monitor::Silent;
use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::history::{Ending, History, HistoryRow};

/// SOLVER: end of the contact iterations; rounding of other processors is far below.
const SOLVER: f64 = 1e-6;
/// SOLVER: 1e-10 of the largest force in each of 2400 steps; impacts make twelve times as much of it, which is what they make of a load that is
/// 0.1 % larger.
const SOLVER_IN_TIME: f64 = 3e-6;
/// What makes the records again.
const REMEDY: &str =
    "run `cargo validate`, `cargo validate-calculix` and `cargo validate-in-time`, and commit the files";

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(name)
}

fn read(path: &Path) -> CrosscheckRecord {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}; {REMEDY}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}; {REMEDY}", path.display()))
}

/// The tool's load curves of a study.
fn now(study: &Study) -> Vec<ToolCurve> {
    let input = CrosscheckInput::of(study);
    let statics = input.statics();
    let geometry = geometry::geometry(statics).unwrap_or_else(|e| panic!("{e}"));
    let meshes =
        meshes::meshes(statics, &geometry, zones::mesh_options(statics, &geometry), (None, None), &Silent)
            .unwrap_or_else(|e| panic!("{e}"));
    tool_curves(&answers::answers(statics, &geometry, &meshes, &Silent).unwrap_or_else(|e| panic!("{e}")))
}

/// The tool's histories of a study's load case.
fn in_time_now(study: &Study) -> ToolRuns {
    let input = InTimeInput::of(study).unwrap_or_else(|e| panic!("{e}"));
    let statics = input.statics();
    let geometry = geometry::geometry(statics).unwrap_or_else(|e| panic!("{e}"));
    let meshes =
        meshes::meshes(statics, &geometry, zones::mesh_options(statics, &geometry), (None, None), &Silent)
            .unwrap_or_else(|e| panic!("{e}"));
    tool::runs(&input, &geometry, &meshes, &Silent).unwrap_or_else(|e| panic!("{e}"))
}

/// What is stale in a record, or does not hold; the tool's numbers by its `curves`, if they are there.
fn stale(record: &CrosscheckRecord, study: &Study, curves: Option<&[ToolCurve]>) -> Vec<String> {
    let keys = (CrosscheckInput::of(study).key(), package_hash());
    let mut found = stale_for(record, keys);
    found.extend(curves.and_then(|curves| moved(&record.curves, curves)));
    found
}

/// The same of a load case in time; the tool's numbers by its `runs`.
fn stale_in_time(record: &CrosscheckRecord, study: &Study, runs: Option<&ToolRuns>) -> Vec<String> {
    let input = InTimeInput::of(study).unwrap_or_else(|e| panic!("{e}"));
    let mut found = stale_for(record, (input.key(), package_hash_in_time()));
    let kept = record.in_time.as_ref().map(|forces| forces.runs.as_slice());
    let Some([tool, longer, _, _]) = kept else {
        found.push("the record has not two runs of each program".into());
        return found;
    };
    for (kept, now) in runs.iter().flat_map(|runs| [(tool, &runs.history), (longer, &runs.longer)]) {
        found.extend(moved_in_time(kept, now));
    }
    found
}

/// The force of the tool that is no longer the recorded one at all times.
fn moved_in_time(kept: &RunInTime, now: &History) -> Option<String> {
    let forces = |of: fn(&HistoryRow) -> f64| now.rows.iter().map(|row| of(row) / KILONEWTON).collect();
    let now: [(&str, &[f64], Vec<f64>); 2] = [
        ("P", &kept.p_kn, forces(|row| row.vertical_force)),
        ("Q", &kept.q_kn, forces(|row| row.lateral_force)),
    ];
    now.into_iter().find_map(|(name, was, is)| {
        let peak = was.iter().map(|f| f.abs()).fold(0.0, f64::max);
        let same = was.len() == is.len()
            && was.iter().zip(&is).all(|(was, is)| (was - is).abs() <= SOLVER_IN_TIME * peak);
        (!same).then(|| format!("{name} of the tool is not what it was, steps of {} µs", kept.step_us))
    })
}

/// What is stale or does not hold, but for the tool's numbers, of a record with a key and a hash of the reference package.
fn stale_for(record: &CrosscheckRecord, (key, package_hash): (String, String)) -> Vec<String> {
    let mut found = Vec::new();
    if record.input_hash != key {
        found.push(format!("the study or the program's version has changed; the key is now {key}"));
    }
    if record.reference.package_hash != package_hash {
        found.push("the reference package has changed".into());
    }
    let failing = record.checks.iter().filter(|c| !(c.holds && c.difference <= c.limit)).count();
    if failing > 0 || !record.holds || record.checks.is_empty() {
        found.push(format!("{failing} of {} checks do not hold", record.checks.len()));
    }
    found
}

/// The first number of the tool's curves that is no longer the recorded one.
fn moved(kept: &[ToolCurve], now: &[ToolCurve]) -> Option<String> {
    let kind = |curves: &[ToolCurve]| -> Vec<(String, f64, usize)> {
        curves.iter().map(|c| (c.element.clone(), c.friction, c.points.len())).collect()
    };
    if kept.is_empty() || kind(kept) != kind(now) {
        return Some(format!("the tool's curves were {:?} and are {:?}", kind(kept), kind(now)));
    }
    let horizontal = |curves: &[ToolCurve]| -> Vec<(f64, f64)> {
        curves.iter().flat_map(|c| c.horizontal.iter().copied()).collect()
    };
    let (was, is) = (horizontal(kept), horizontal(now));
    let near = |(a, b): (&(f64, f64), &(f64, f64))| a.0 == b.0 && (b.1 / a.1 - 1.0).abs() <= SOLVER;
    if was.len() != is.len() || !was.iter().zip(&is).all(near) {
        return Some(format!(
            "the horizontal stiffness of the tool by preload (kN) was {was:?} and is {is:?}"
        ));
    }
    kept.iter().zip(now).find_map(|(kept, now)| {
        kept.points.iter().zip(&now.points).find_map(|(a, b)| {
            let numbers = [
                ("load", a.load_kn, b.load_kn),
                ("hub displacement", a.hub_displacement_mm, b.hub_displacement_mm),
                ("tangent stiffness", a.tangent_kn_per_m, b.tangent_kn_per_m),
            ];
            numbers.into_iter().find(|(_, kept, now)| !((now / kept - 1.0).abs() <= SOLVER)).map(
                |(quantity, was, is)| {
                    format!(
                        "{quantity} of the tool at {} kN ({}, friction {}) was {was} and is {is}",
                        a.load_kn, kept.element, kept.friction
                    )
                },
            )
        })
    })
}

/// The studies whose numbers of today take a minute each.
const LONG: [&str; 2] = ["uic60-s1002-fine", "uic60-s1002-in-time"];

/// Goal: the example studies have kept records, one with elements of second order, one with CalculiX and one in time, and
/// every kept record is fresh and holds; the tool's numbers of some studies are left to `cargo long every_kept_record`.
#[test]
fn kept_records_are_fresh() {
    records_are_fresh(|name| !LONG.contains(&name));
}

/// Goal: the numbers of every record are those of the tool as it is now.
#[test]
#[ignore = "three minutes; `cargo long every_kept_record`"]
fn the_numbers_of_every_kept_record_are_fresh() {
    records_are_fresh(|_| true);
}

/// Checks all records, and the tool's numbers of the studies that `computed` wants.
fn records_are_fresh(computed: impl Fn(&str) -> bool) {
    let record = |name: &str| read(&folder("crosscheck").join(name));
    let second_order = record("uic60-s1002.json").questions.iter().any(|q| q.name == "second_order");
    assert!(second_order, "no second order; {REMEDY}");
    let calculix =
        record("uic60-s1002-fine.json").checks.iter().any(|c| c.reference_solver.starts_with("CalculiX"));
    assert!(calculix, "no CalculiX; {REMEDY}");
    assert!(record("uic60-s1002-in-time.json").in_time.is_some(), "no load case in time; {REMEDY}");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder("crosscheck")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "json"));
    files.sort();
    for path in files {
        let study = folder("studies").join(path.file_name().unwrap()).with_extension("toml");
        let study = Study::read(&study).unwrap_or_else(|e| panic!("{e}"));
        let (record, computed) = (read(&path), computed(&study.name));
        let found = if record.in_time.is_some() {
            stale_in_time(&record, &study, computed.then(|| in_time_now(&study)).as_ref())
        } else {
            stale(&record, &study, computed.then(|| now(&study)).as_deref())
        };
        assert!(found.is_empty(), "{}: {}; {REMEDY}", path.display(), found.join("; "));
    }
}

/// A study of some seconds; its coarse contact is beyond the limits of the cross-check.
const STUDY: &str = include_str!("studies/coarse.toml");

/// A folder with a study, its results and then its cross-check, kept too; what the report said before.
struct Made {
    study: PathBuf,
    out: PathBuf,
    kept: PathBuf,
    report_before: String,
}

impl Made {
    fn page(&self, name: &str) -> String {
        std::fs::read_to_string(self.out.join(name)).unwrap()
    }

    /// A store that begins empty, beside the Python of all tests.
    fn store(&self) -> PathBuf {
        self.out.with_file_name("store")
    }

    fn railspring(&self, arguments: &[&str], expected: i32) {
        let output = assert_cmd::Command::cargo_bin("railspring")
            .unwrap()
            .args(arguments)
            .args(["--quiet", "--cache"])
            .arg(self.store())
            .arg("-o")
            .args([&self.out, &self.study])
            .env("RAILSPRING_CACHE", env!("CARGO_TARGET_TMPDIR"))
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(expected), "{arguments:?}: {said}");
    }
}

fn made() -> &'static Made {
    static MADE: OnceLock<Made> = OnceLock::new();
    MADE.get_or_init(|| {
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("validation");
        let _ = std::fs::remove_dir_all(&root);
        std::fs::create_dir_all(&root).unwrap();
        let mut made = Made {
            study: root.join("coarse.toml"),
            out: root.join("out"),
            kept: root.join("kept/coarse.json"),
            report_before: String::new(),
        };
        std::fs::write(&made.study, STUDY).unwrap();
        made.railspring(&["run"], 0);
        made.report_before = made.page("report.html");
        // the coarse contact is beyond the limits
        made.railspring(&["crosscheck", "--keep", made.kept.to_str().unwrap()], 1);
        made
    })
}

/// Goal: the report says that there is no cross-check, has its chapter as soon as there is one, and
/// says when it is of another study; report and page point to each other, a page alone to nothing. One that was
/// edited is refused.
#[test]
fn report_and_page_belong_together() {
    let made = made();
    let link = "href=\"crosscheck.html\"";
    assert!(made.report_before.contains("no cross-validation of this study yet"));
    assert!(!made.report_before.contains(link));
    let (report, page) = (made.page("report.html"), made.page("crosscheck.html"));
    assert!(report.contains(link) && report.contains("hub displacement"));
    assert!(page.contains("href=\"report.html\""));
    assert_eq!(page.matches("<figure id=").count(), 5, "three curves and two bodies");
    assert_eq!(report.matches("<figure id=").count(), made.report_before.matches("<figure id=").count() + 5);

    let other = OutputFolder::create(&made.out.with_file_name("alone"), &Inputs::none()).unwrap();
    let study = Study::read(&made.study).unwrap_or_else(|e| panic!("{e}"));
    other.write("crosscheck.json", made.page("crosscheck.json").as_bytes()).unwrap();
    assert!(!StudyRun::new(&study, &other, Resources::of_the_machine(&Silent)).crosscheck_pages().unwrap());
    let alone = std::fs::read_to_string(other.file("crosscheck.html")).unwrap();
    assert!(!alone.contains("href=") && !other.file("report.html").exists());

    for name in ["crosscheck.json", "crosscheck/differences.json"] {
        let written = made.page(name);
        let edited = written.replacen("1.0", "1.5", 1).replacen("\"holds\": false", "\"holds\": true", 1);
        assert!(edited != written, "{name}");
        std::fs::write(made.out.join(name), edited).unwrap();
        made.railspring(&["report"], 2);
        std::fs::write(made.out.join(name), written).unwrap();
    }
    let stale = made.page("crosscheck.json").replace(&CrosscheckInput::of(&study).key(), &"0".repeat(64));
    std::fs::write(made.out.join("crosscheck.json"), stale).unwrap();
    made.railspring(&["report"], 0);
    let report = made.page("report.html");
    assert!(report.contains("of another study") && !report.contains(link));
}

/// Source: the record that was made first, whose date and seconds no second solution would have. Goal: the same question
/// is answered from the store, in another folder and without the reference solver; a changed study asks again.
#[test]
#[ignore = "a quarter of a minute: cargo long validation"]
fn an_answered_cross_check_is_taken_from_the_store() {
    let made = made();
    let first = std::fs::read(&made.kept).unwrap();
    let again = made.out.with_file_name("again");
    let ask = |study: &str, out: &Path| {
        let file = out.with_extension("toml");
        std::fs::write(&file, study).unwrap();
        let mut command = assert_cmd::Command::cargo_bin("railspring").unwrap();
        command.args(["crosscheck", "-o"]).args([out, &file]).arg("--cache").arg(made.store());
        let output = command.env("RAILSPRING_CACHE", env!("CARGO_TARGET_TMPDIR")).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "the coarse contact is beyond the limits");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let said = ask(STUDY, &again);
    assert!(said.contains("cross-check: taken from the store"), "{said}");
    assert!(std::fs::read(again.join("crosscheck.json")).unwrap() == first);
    assert!(again.join("crosscheck/differences.json").exists() && again.join("crosscheck.html").exists());
    assert!(!again.join("crosscheck/exchange.json").exists(), "nothing was asked");

    let other = made.out.with_file_name("other");
    let said = ask(&STUDY.replace("load_max_kn = 85", "load_max_kn = 11"), &other);
    assert!(said.contains("cross-check: made") && other.join("crosscheck/exchange.json").exists(), "{said}");
}

/// Goal: `--keep` writes the record; it is found fresh, its failing limits are reported, and so is each
/// change of study, reference, tool and verdict, alone.
#[test]
#[ignore = "a quarter of a minute: cargo long validation"]
fn every_kind_of_staleness_is_found() {
    let Made { study, kept, .. } = made();
    let study = Study::read(study).unwrap_or_else(|e| panic!("{e}"));
    let curves = now(&study);
    let mut record = read(kept);
    let underived: Vec<_> = record.checks.iter().filter(|check| record.limit(check).is_none()).collect();
    assert!(underived.is_empty(), "limits without derivation: {underived:?}");
    let found = stale(&record, &study, Some(&curves));
    assert!(found.len() == 1 && found[0].ends_with("checks do not hold"), "{found:?}");

    record.checks.retain(|check| check.holds);
    record.holds = true;
    assert_eq!(stale(&record, &study, Some(&curves)), [""; 0], "fresh");
    let changed = |change: fn(&mut CrosscheckRecord)| {
        let mut copy = record.clone();
        change(&mut copy);
        let found = stale(&copy, &study, Some(&curves));
        assert_eq!(found.len(), 1, "{found:?}");
        found.into_iter().next().unwrap()
    };
    assert!(changed(|r| r.input_hash.replace_range(..1, "x")).contains("study"));
    assert!(changed(|r| r.reference.package_hash.clear()).contains("reference package"));
    assert!(
        changed(|r| r.curves[0].points[1].hub_displacement_mm *= 1.0 + 3e-6).contains("hub displacement")
    );
    assert!(changed(|r| r.curves[0].points[2].tangent_kn_per_m *= 1.0 - 3e-6).contains("tangent stiffness"));
    assert!(changed(|r| r.curves[0].points[0].load_kn = f64::NAN).contains("load"));
    let horizontal = |r: &mut CrosscheckRecord| r.curves[1].horizontal[0].1 *= 1.0 + 3e-6;
    assert!(changed(horizontal).contains("horizontal stiffness"));
    assert!(changed(|r| r.curves.clear()).contains("curves"));
    assert!(changed(|r| r.holds = false).contains("do not hold"));
    assert!(changed(|r| r.checks[0].difference = 2.0 * r.checks[0].limit).contains("1 of"));
    assert!(changed(|r| r.checks.clear()).contains("0 of 0"));
}

/// Goal: each change of study, reference, tool and verdict of the record in time is found, alone; of a kept record with what its tool found then.
#[test]
fn every_kind_of_staleness_in_time_is_found() {
    let study = Study::read(&folder("studies").join("uic60-s1002-in-time.toml")).unwrap();
    let record = read(&folder("crosscheck").join("uic60-s1002-in-time.json"));
    let forces = record.in_time.as_ref().unwrap();
    let history = |run: &RunInTime| History {
        rows: (run.p_kn.iter().zip(&run.q_kn))
            .map(|(p, q)| HistoryRow {
                time: 0.0,
                vertical_force: p * KILONEWTON,
                lateral_force: q * KILONEWTON,
                wheel_y: 0.0,
                wheel_z: 0.0,
                load_y: 0.0,
                energy: None,
                contacts: Vec::new(),
            })
            .collect(),
        degrees_of_freedom: 0,
        ending: Ending::Completed,
    };
    let runs = ToolRuns { history: history(&forces.runs[0]), longer: history(&forces.runs[1]), seconds: 0.0 };
    assert_eq!(stale_in_time(&record, &study, Some(&runs)), [""; 0], "fresh");
    let changed = |change: fn(&mut CrosscheckRecord)| {
        let mut copy = record.clone();
        change(&mut copy);
        let found = stale_in_time(&copy, &study, Some(&runs));
        assert_eq!(found.len(), 1, "{found:?}");
        found.into_iter().next().unwrap()
    };
    fn forces_of(record: &mut CrosscheckRecord) -> &mut Vec<RunInTime> {
        &mut record.in_time.as_mut().unwrap().runs
    }
    assert!(changed(|r| r.input_hash.replace_range(..1, "x")).contains("study"));
    assert!(changed(|r| r.reference.package_hash.clear()).contains("reference package"));
    assert!(changed(|r| forces_of(r)[0].p_kn[170] += 2e-4).starts_with("P of the tool"));
    assert!(changed(|r| forces_of(r)[1].q_kn[170] += 4e-4).starts_with("Q of the tool"));
    assert!(changed(|r| forces_of(r)[0].q_kn.truncate(9)).starts_with("Q of the tool"));
    assert!(changed(|r| forces_of(r).truncate(3)).contains("two runs"));
    assert!(changed(|r| r.checks[0].difference = 2.0 * r.checks[0].limit).contains("1 of"));
    assert!(changed(|r| r.holds = false).contains("do not hold"));
}
