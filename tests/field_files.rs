//! The fields of a calibration, as another program reads them: collections over the loads, and the z axis down or up.
//!
//! Needs Python 3.11 or newer with `venv`, as `tests/reference.rs` does.

use std::path::{Path, PathBuf};
use std::process::Command;

use railspring::python::{Purpose, Python};
use railspring_profiles::monitor::Silent;
use serde_json::Value;

fn tmp() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
}

/// Calibrates a study with more lines in it; the output folder.
fn calibrated(root: &Path, name: &str, field: &str, more: &str) -> PathBuf {
    let contact = format!("[contact]\nfield = \"{field}\"");
    let study = format!("{}\n{more}", include_str!("studies/coarse.toml").replace("[contact]", &contact));
    std::fs::write(root.join(format!("{name}.toml")), study).unwrap();
    let output = assert_cmd::Command::cargo_bin("railspring")
        .unwrap()
        .current_dir(root)
        .args(["calibrate", &format!("{name}.toml"), "-o", name, "--quiet", "--cache", "store"])
        .env("RAILSPRING_CACHE", tmp())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    root.join(name)
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = ["", "fields"]
        .iter()
        .filter_map(|sub| std::fs::read_dir(folder.join(sub)).ok())
        .flatten()
        .map(|entry| entry.unwrap().path().strip_prefix(folder).unwrap().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".vtu"))
        .collect();
    names.sort();
    names
}

/// Goal: ParaView's collections name a file for every load, kN, of the contact, and for three of the solids.
/// meshio reads all of them. With the z axis up they are the same turned by half a turn about the track:
/// points m, displacements m, stresses Pa, tractions Pa, slips m. The cells stay right-handed. The springs
/// are the same to the byte. A study with fewer loads leaves no file of the one before. Accuracy: exact, a
/// turn changes signs alone.
#[test]
#[ignore = "a minute: cargo long field_files"]
fn collections_are_read_and_turned() {
    if !railspring_testing::python() {
        return;
    }
    let python =
        Python::prepare(None, &tmp(), Purpose::FirstOrder, &Silent).unwrap_or_else(|e| panic!("{e}"));
    let place = tempfile::tempdir().unwrap();
    let root = place.path();
    for field in ["elements", "hybrid"] {
        let down = calibrated(root, &format!("{field}-down"), field, "");
        let up = calibrated(root, &format!("{field}-up"), field, "[output]\nvertical = \"up\"\n");
        check(&python, field, [&down, &up]);
    }

    let down = root.join("elements-down");
    assert_eq!(files(&down).len(), 5 + 3 + 3, "{:?}", files(&down));
    calibrated(root, "elements-down", "elements", "[output]\nsolid_loads = \"largest\"\n");
    assert_eq!(files(&down).len(), 5 + 1 + 1, "{:?}", files(&down));
    assert!(files(&down).contains(&"fields/contact-04.vtu".into()) && down.join("contact.vtu").exists());
}

/// What meshio makes of the collections in two folders, with z down and up.
fn check(python: &Python, field: &str, [down, up]: [&Path; 2]) {
    let output = Command::new(python.interpreter())
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fields/compare.py"))
        .args([down, up])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let curve = std::fs::read_to_string(down.join("load_curve.csv")).unwrap();
    let loads: Vec<f64> =
        curve.lines().skip(1).map(|row| row.split(',').nth(1).unwrap().parse().unwrap()).collect();
    assert_eq!(loads.len(), 5);
    for (stem, expected) in [
        ("contact", loads.clone()),
        ("rail", vec![loads[0], loads[2], loads[4]]),
        ("wheel", vec![loads[0], loads[2], loads[4]]),
    ] {
        let collection = &found[stem];
        let listed: Vec<f64> =
            collection["loads"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        assert_eq!(listed, expected, "{stem}");
        let least = if stem == "contact" && field == "elements" { 3 } else { 30 };
        assert!(
            collection["points"].as_array().unwrap().iter().all(|n| n.as_u64() >= Some(least)),
            "{field}: {collection}"
        );
        let differences = collection["differences"].as_object().unwrap();
        assert!(differences.len() >= 5, "{differences:?}");
        assert!(differences.values().all(|d| d.as_f64() == Some(0.0)), "{stem}: {differences:?}");
        for volume in
            collection["volumes"].as_array().unwrap().iter().flat_map(|pair| pair.as_array().unwrap())
        {
            assert!(
                if stem == "contact" { volume.is_null() } else { volume.as_f64() > Some(0.0) },
                "{stem}: {volume}"
            );
        }
        let field = if stem == "contact" { "pressure (Pa)" } else { "displacement (m)" };
        let largest: Vec<f64> =
            collection["largest"][field].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        assert!(largest[0] > 0.0 && largest.windows(2).all(|w| w[0] < w[1]), "{stem} grows: {largest:?}");
    }
    let springs = |folder: &Path| -> Value {
        let mut record: Value =
            serde_json::from_slice(&std::fs::read(folder.join("stiffness.json")).unwrap()).unwrap();
        record["input_hash"].take();
        // of which that is a part
        record["content_blake3"].take();
        record
    };
    assert_eq!(springs(down), springs(up));
    assert_eq!(
        std::fs::read(down.join("load_curve.csv")).unwrap(),
        std::fs::read(up.join("load_curve.csv")).unwrap()
    );
}
