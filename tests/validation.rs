//! The kept cross-validations in `data/crosscheck` are those of the studies, the reference and the
//! tool as they are now.
//!
//! Source: the records themselves. Goal: input hash, hash of the reference package, hub displacement
//! (mm) and tangent stiffness (kN/m) of the tool under every judged load, and the verdict. Accuracy:
//! hashes exactly, numbers to what the order of sums on another processor may change.

use std::path::{Path, PathBuf};

use railspring::crosscheck::python::package_hash;
use railspring::crosscheck::questions::tool_curves;
use railspring::records::crosscheck::{CrosscheckRecord, ToolCurve};
use railspring::stages;
use railspring::study::Study;
use railspring_calibrate::monitor::Silent;

/// SOLVER: end of the contact iterations; rounding of other processors is far below.
const SOLVER: f64 = 1e-6;
/// What makes the records again.
const REMEDY: &str = "run `cargo validate` and commit the file";

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(name)
}

fn read(path: &Path) -> CrosscheckRecord {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}; {REMEDY}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}; {REMEDY}", path.display()))
}

/// The tool's load curves of a study.
fn now(study: &Study) -> Vec<ToolCurve> {
    let geometry = stages::geometry(study).unwrap_or_else(|e| panic!("{e}"));
    let meshes = stages::meshes(study, &geometry).unwrap_or_else(|e| panic!("{e}"));
    tool_curves(&stages::answers(study, &geometry, &meshes, &Silent).unwrap_or_else(|e| panic!("{e}")))
}

/// What is stale in a record, or does not hold.
fn stale(record: &CrosscheckRecord, study: &Study, curves: &[ToolCurve]) -> Vec<String> {
    let mut found = Vec::new();
    if record.input_hash != study.input_hash {
        found.push("the study or the program's version has changed".into());
    }
    if record.reference.package_hash != package_hash() {
        found.push("the reference package has changed".into());
    }
    found.extend(moved(&record.curves, curves));
    let failing = record.checks.iter().filter(|c| !(c.holds && c.difference <= c.limit)).count();
    if !record.holds || failing > 0 || record.checks.is_empty() {
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

/// Goal: the example study has a kept record, with elements of second order and CalculiX, and every
/// kept record is fresh and holds.
#[test]
fn kept_records_are_fresh() {
    let record = read(&folder("crosscheck").join("uic60-s1002.json"));
    assert!(record.questions.iter().any(|q| q.name == "second_order"), "no second order; {REMEDY}");
    assert!(record.checks.iter().any(|c| c.judge.starts_with("CalculiX")), "no CalculiX; {REMEDY}");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder("crosscheck")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "json"));
    files.sort();
    for path in files {
        let study = folder("studies").join(path.file_name().unwrap()).with_extension("toml");
        let study = Study::read(&study).unwrap_or_else(|e| panic!("{e}"));
        let found = stale(&read(&path), &study, &now(&study));
        assert!(found.is_empty(), "{}: {}; {REMEDY}", path.display(), found.join("; "));
    }
}

/// A study of some seconds; its coarse contact is beyond the limits.
const STUDY: &str = r#"
name = "coarse"
[rail]
profile = "60E1"
length_m = 0.555
[wheel]
profile = "S1002"
tape_diameter_m = 0.858
[mesh]
contact_element_mm = 6
contact_element_along_mm = 6
element = "full-integration"
[contact]
friction = 0
[calibration]
load_min_kn = 5
load_max_kn = 40
load_count = 4
"#;

/// Goal: `--keep` writes the record; it is found fresh, its failing limits are told, and so is each
/// change of study, reference, tool and verdict, alone.
#[test]
fn every_kind_of_staleness_is_found() {
    let root = tempfile::tempdir().unwrap();
    let file = root.path().join("coarse.toml");
    std::fs::write(&file, STUDY).unwrap();
    let kept = root.path().join("kept/coarse.json");
    let out = root.path().join("out");
    let railspring = |arguments: &[&str], expected: i32| {
        let output = assert_cmd::Command::cargo_bin("railspring")
            .unwrap()
            .args(arguments)
            .args(["--quiet", "-o"])
            .args([&out, &file])
            .env("RAILSPRING_CACHE", env!("CARGO_TARGET_TMPDIR"))
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(expected), "{arguments:?}: {said}");
    };
    let page = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    // the coarse contact is beyond the limits
    railspring(&["crosscheck", "--keep", kept.to_str().unwrap()], 1);
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), page("crosscheck.json"));
    assert_eq!(page("crosscheck.html").matches("<figure>").count(), 5, "three curves and two bodies");
    assert!(!out.join("report.html").exists(), "the folder has no other results");
    assert!(!page("crosscheck.html").contains("href=\"report.html\""));
    let study = Study::read(&file).unwrap_or_else(|e| panic!("{e}"));
    let curves = now(&study);
    let mut record = read(&kept);
    let underived: Vec<_> = record.checks.iter().filter(|check| record.limit(check).is_none()).collect();
    assert!(underived.is_empty(), "limits without derivation: {underived:?}");
    let found = stale(&record, &study, &curves);
    assert!(found.len() == 1 && found[0].ends_with("checks do not hold"), "{found:?}");

    record.checks.retain(|check| check.holds);
    record.holds = true;
    assert_eq!(stale(&record, &study, &curves), [""; 0], "fresh");
    let changed = |change: fn(&mut CrosscheckRecord)| {
        let mut copy = record.clone();
        change(&mut copy);
        let found = stale(&copy, &study, &curves);
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
    assert!(changed(|r| r.curves.clear()).contains("curves"));
    assert!(changed(|r| r.holds = false).contains("do not hold"));
    assert!(changed(|r| r.checks[0].difference = 2.0 * r.checks[0].limit).contains("1 of"));
    assert!(changed(|r| r.checks.clear()).contains("0 of 0"));
}
