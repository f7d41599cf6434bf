//! Which wheels and rails of a table are measured, and how another table names them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use serde_json::{Map, Value};

use super::cases::{Case, Table};
use super::files::beside;
use super::fleet::{About, Shape};
use super::made::Made;
use super::rows::Rows;
use super::surfaces::MeasuredRecord;

/// What the page of a fleet needs to know of a table; the table is the file `path`, a table of typical wheels will be in `folder`.
pub fn about<'a>(table: &'a Table, path: &Path, folder: &Path, earlier: Option<&'a Rows>) -> About<'a> {
    let names = |is_measured: fn(&Case) -> bool, name: fn(&Case) -> &String| -> BTreeSet<String> {
        table.cases.iter().filter(|case| is_measured(case)).map(|case| name(case).clone()).collect()
    };
    let mut keys: BTreeMap<String, Map<String, Value>> = BTreeMap::new();
    for case in table.cases.iter().filter(|case| case.study.wheel.measured.is_some()) {
        keys.entry(case.wheel.clone()).or_insert_with(|| {
            let own = case.keys().get("wheel").and_then(Value::as_object).cloned().unwrap_or_default();
            moved(&own, path, folder)
        });
    }
    let document = serde_json::to_value(&table.document).unwrap_or_default();
    let mut rest = moved(document.as_object().unwrap_or(&Map::new()), path, folder);
    // other wheels take their place, and cases would name them
    rest.retain(|key, value| {
        !["name", "description", "wheel", "case", "pairs_file"].contains(&&**key) && !value.is_null()
    });
    // without a folder, the default is another one
    rest.insert("bodies".into(), table.document.bodies().name().into());
    About {
        name: &table.document.name,
        description: &table.document.description,
        wheels: names(|case| case.study.wheel.measured.is_some(), |case| &case.wheel),
        rails: names(|case| case.study.rail.measured.is_some(), |case| &case.rail),
        keys,
        table: rest,
        earlier,
    }
}

/// The deviations of the measured wheels of places from their standards; of the rails, where no wheel was measured.
pub fn shapes(made: &Made<'_>) -> Vec<Option<Shape>> {
    let measured = || made.places().map(|at| at.measured());
    let of_wheels = measured().flatten().any(|of| of.wheel.is_some());
    let shape = |of: &MeasuredRecord| {
        let wheel = of.wheel.as_ref().map(|wheel| &wheel.deviation);
        let of = if of_wheels { wheel } else { of.rail.as_ref().map(|rail| &rail.deviation) }?;
        let off_um = of.missing_um.iter().copied().collect::<Option<Vec<f64>>>()?;
        Some(Shape { y_mm: of.y_mm.clone(), off_um })
    };
    measured().map(|of| of.and_then(shape)).collect()
}

/// Keys whose files are named relative to another folder than that of the table.
fn moved(keys: &Map<String, Value>, table: &Path, folder: &Path) -> Map<String, Value> {
    let is_file = |key: &str| key == "folder" || key == "base" || key.ends_with("_file");
    let of = |(key, value): (&String, &Value)| (key.clone(), renamed(value, is_file(key), table, folder));
    keys.iter().map(of).collect()
}

/// A value with the files in it named anew: its texts if they are files, and the keys in it.
fn renamed(value: &Value, is_file: bool, table: &Path, folder: &Path) -> Value {
    match value {
        Value::String(file) if is_file => relative(&beside(table, file), folder).into(),
        Value::Array(values) => values.iter().map(|value| renamed(value, is_file, table, folder)).collect(),
        Value::Object(keys) => Value::Object(moved(keys, table, folder)),
        other => other.clone(),
    }
}

/// A file as it is named in a folder; both as the working directory names them.
fn relative(file: &Path, folder: &Path) -> String {
    let [file, folder] = [file, folder].map(whole);
    let shared = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    let named: PathBuf = up.chain(file.components().skip(shared)).collect();
    named.to_string_lossy().replace('\\', "/")
}

/// The path from the root, without links where it exists.
fn whole(path: &Path) -> PathBuf {
    path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::fleet::{Shape, page};

    /// Goal: files, folders and the base are named from the new folder, in sections and lists too; other texts stay.
    #[test]
    fn files_are_named_from_another_folder() {
        let root = tempfile::tempdir().unwrap();
        for folder in ["data/m", "out/fleet"] {
            std::fs::create_dir_all(root.path().join(folder)).unwrap();
        }
        let keys = serde_json::json!({
            "base": "b.toml", "profile": "S1002", "rail": [{ "profile_file": "m/r.prr", "standard": "60E1" }],
            "study": { "wheel": { "section_file": ["m/s.toml"] } }, "shifts_mm": [1]
        });
        let moved = moved(
            keys.as_object().unwrap(),
            &root.path().join("data/t.toml"),
            &root.path().join("out/fleet"),
        );
        let expected = serde_json::json!({
            "base": "../../data/b.toml", "profile": "S1002",
            "rail": [{ "profile_file": "../../data/m/r.prr", "standard": "60E1" }],
            "study": { "wheel": { "section_file": ["../../data/m/s.toml"] } }, "shifts_mm": [1]
        });
        assert_eq!(Value::Object(moved), expected);
    }

    /// Goal: of a table with a folder of 21 measured wheels the typical ones are a table that can be read in another folder, with the same
    /// rails, loads and base; a standard wheel is no measured one.
    #[test]
    fn typical_wheels_are_a_table_that_can_be_read() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        for folder in ["data/measured", "out/fleet"] {
            std::fs::create_dir_all(path(folder)).unwrap();
        }
        for wheel in 0..21 {
            let file = path(&format!("data/measured/w{wheel:02}.whl"));
            std::fs::write(file, include_str!("../../data/profiles/worn-s1002.whl")).unwrap();
        }
        let base = "name = \"base\"\n[wheel]\nprofile = \"S1002\"\n[rail]\nprofile = \"60E1\"\n[contact]\nfriction = 0.25\n";
        std::fs::write(path("data/base.toml"), base).unwrap();
        let text = "name = \"fleet\"\nbase = \"base.toml\"\nstiffness_at_kn = [20, 60]\n\
            [[wheel]]\nname = \"May\"\nfolder = \"measured\"\nstandard = \"S1002\"\n\
            [[wheel]]\nprofile = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\ninclination = \"1:20\"\n";
        let table = Table::parse(&path("data/table.toml"), text).unwrap();
        let about = about(&table, &path("data/table.toml"), &path("out/fleet"), None);
        assert_eq!((about.wheels.len(), about.rails.len()), (21, 0));
        let rows = table.cases.iter().map(|case| vec![case.wheel.as_str().into()]).collect();
        let rows = Rows { columns: vec!["wheel".into()], rows, metadata: 0..0 };
        let shape = |at: usize| {
            let off = if at.is_multiple_of(2) { 100.0 } else { 900.0 };
            Some(Shape { y_mm: vec![0.0, 1.0], off_um: vec![off + at as f64, off] })
        };
        let shapes: Vec<Option<Shape>> = (0..rows.rows.len()).map(shape).collect();
        let typical = page(&rows, &shapes, &about).unwrap().typical.unwrap();
        std::fs::write(path("out/fleet/table_typical.toml"), &typical).unwrap();
        let read = Table::read(&path("out/fleet/table_typical.toml")).unwrap_or_else(|_| panic!("{typical}"));
        assert_eq!((read.cases.len(), &*read.cases[0].rail), (2, "60E1"), "{typical}");
        assert_eq!(read.document.stiffness_at_kn, [20.0, 60.0]);
        let study = &read.cases[0].study;
        assert_eq!((study.contact.friction, study.rail.inclination), (0.25, 0.05));
        assert_eq!(read.cases[0].parts[0], table.cases[0].parts[0], "the same wheel");
    }
}
