//! The examples that are commands: a table and exports. The verdict of `examples/verdict.rs` is run with the documentation of the library.
//!
//! Goal: the files in `examples/` run as they are. No tolerance.

use std::path::{Path, PathBuf};

use railspring_testing::{Place, message, said};
use serde_json::Value;

const COARSE: &str = include_str!("studies/coarse.toml");

/// The store of the tests here.
const STORE: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/examples");

fn empty() -> Place {
    Place::new(env!("CARGO_BIN_EXE_railspring"), STORE)
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name)
}

/// The table of two wheels at two shifts has a row for each place, and all are complete.
#[test]
fn the_table_is_complete() {
    let place = empty();
    let output = place.run(&["table", &example("table.toml").to_string_lossy(), "-o", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", said(&output), message(&output));
    let mut rows = csv::Reader::from_path(place.path("out/table.csv")).unwrap();
    let columns = rows.headers().unwrap().clone();
    let of = |row: &csv::StringRecord, name: &str| {
        row[columns.iter().position(|column| column == name).unwrap()].to_string()
    };
    let found: Vec<[String; 3]> = rows
        .records()
        .map(|row| row.map(|row| ["wheel", "shift_mm", "status"].map(|name| of(&row, name))).unwrap())
        .collect();
    let wanted =
        ["S1002", "worn"].map(|wheel| ["0", "2"].map(|shift| [wheel, shift, "complete"].map(String::from)));
    assert_eq!(found, wanted.concat());
}

/// The script writes the springs of its study, and a file for each program, which has the law.
#[cfg(unix)]
#[test]
fn the_exports_are_written() {
    let place = empty();
    place.write("coarse.toml", COARSE);
    let program = Path::new(env!("CARGO_BIN_EXE_railspring")).parent().unwrap();
    let before = std::env::var_os("PATH").unwrap_or_default();
    let path: Vec<PathBuf> =
        [program.to_path_buf()].into_iter().chain(std::env::split_paths(&before)).collect();
    let output = std::process::Command::new("sh")
        .arg(example("export.sh"))
        .args(["coarse.toml", "out"])
        .current_dir(place.root())
        .env("PATH", std::env::join_paths(path).unwrap())
        .env("RAILSPRING_CACHE", STORE)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}{}", said(&output), message(&output));
    let springs: Value = serde_json::from_str(&place.read("out/stiffness.json")).unwrap();
    assert!(springs["law"]["b_kn_per_m"].as_f64().unwrap() > 0.0, "{}", springs["law"]);
    for folder in ["out/table", "out/opensees"] {
        let mut files = std::fs::read_dir(place.path(folder)).unwrap();
        let file = files.next().expect("a file of the export").unwrap();
        assert!(file.metadata().unwrap().len() > 500, "{}", file.path().display());
    }
}
