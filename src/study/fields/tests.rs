//! The table from the library's fields to the keys of the study, walked both ways.

use std::path::Path;

use railspring_profiles::error::InputError;
use railspring_profiles::field::InputField;
use serde_json::Value;

use super::{TABLE, translate};
use crate::study::{SECTIONS, Study, schema};

/// Follows a reference, the optional alternative included.
fn followed<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    let of = |s: &'a Value| s.get("$ref").and_then(Value::as_str).and_then(|r| root.pointer(&r[1..]));
    let option = schema.get("anyOf").and_then(Value::as_array).and_then(|any| any.iter().find_map(of));
    of(schema).or(option).unwrap_or(schema)
}

fn in_schema(root: &Value, key: &str) -> bool {
    let mut at = root;
    for part in key.split('.') {
        at = followed(root, at);
        let next = if part == "*" { at.get("additionalProperties") } else { at["properties"].get(part) };
        match next {
            Some(next) => at = next,
            None => return false,
        }
    }
    true
}

#[test]
fn every_field_is_in_the_table_once() {
    let listed: Vec<InputField> = TABLE.iter().map(|(field, _)| *field).collect();
    assert_eq!(listed, InputField::ALL);
    let mut names: Vec<&str> = InputField::ALL.iter().map(|field| field.name()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), InputField::ALL.len(), "two fields with one name");
    let sections = names.iter().filter(|name| SECTIONS.contains(name) || **name == "name");
    assert_eq!(sections.count(), 0, "a field that a study could name");
}

#[test]
fn every_key_of_the_table_is_in_the_schema() {
    let schema = schema();
    let unknown: Vec<&str> =
        TABLE.iter().flat_map(|(_, keys)| *keys).copied().filter(|key| !in_schema(&schema, key)).collect();
    assert_eq!(unknown, [""; 0]);
    assert!(!in_schema(&schema, "track.shift_mm") && !in_schema(&schema, "scenario.*.speed"));
}

/// Sources that are a library: they name fields, never keys of a study.
#[test]
fn the_library_quotes_no_key_of_a_study() {
    fn sources(folder: &Path, found: &mut Vec<(String, String)>) {
        for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_dir() {
                sources(&entry, found);
            } else if entry.extension().is_some_and(|ending| ending == "rs") {
                found.push((entry.display().to_string(), std::fs::read_to_string(&entry).unwrap()));
            }
        }
    }
    let schema = schema();
    let mut keys = Vec::new();
    for section in SECTIONS {
        let mut at = followed(&schema, &schema["properties"][section]);
        if let Some(named) = at.get("additionalProperties").filter(|named| named.is_object()) {
            at = followed(&schema, named);
        }
        keys.extend(at["properties"].as_object().unwrap().keys().map(|leaf| format!("{section}.{leaf}")));
    }
    assert!(keys.len() > 60, "{}", keys.len());
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["calibrate/src", "simulate/src"] {
        sources(&root.join(folder), &mut files);
    }
    let mut quoted = Vec::new();
    for (file, text) in &files {
        for (number, line) in text.lines().enumerate() {
            // A key that ends in a unit is no expression; any other stands in quotes or backticks.
            let key = keys.iter().find(|key| {
                let unit =
                    ["_mm", "_m", "_kn", "_t", "_s", "_gpa", "_m3"].iter().any(|unit| key.ends_with(unit));
                let opened = line.contains(&format!("\"{key}")) || line.contains(&format!("`{key}"));
                opened || unit && line.contains(*key)
            });
            let built = SECTIONS.iter().any(|section| line.contains(&format!("\"{section}.{{")));
            if key.is_some() || built {
                quoted.push(format!("{file}:{}: {}", number + 1, line.trim()));
            }
        }
    }
    assert!(quoted.is_empty(), "{}", quoted.join("\n"));
}

#[test]
fn errors_of_the_library_name_the_keys_that_the_study_gives() {
    let parse = |more: &str| {
        let text = format!("name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"S1002\"\n{more}");
        Study::parse(Path::new("x.toml"), &text).unwrap()
    };
    let refused =
        || InputError::new(InputField::Loads, "900 kN", "less", "widen `window_half_length`, not `x`");
    let range = parse("").source.with_keys(refused());
    assert_eq!(
        range.to_string(),
        "calibration.load_max_kn = 900 kN: expected less; widen `mesh.window_half_length_mm`, not `x`"
    );
    assert_eq!(
        parse("[calibration]\nloads_kn = [1, 2, 3, 4]\n").source.with_keys(refused()).key,
        "calibration.loads_kn"
    );

    let study = parse("[scenario.s]\nlateral_force = {}\nvertical_force = {}\ntime_step_s = 1e-3\n");
    let of = |field, scenario| translate(InputError::new(field, "v", "e", "r"), &study.source, scenario).key;
    assert_eq!(of(InputField::TimeStep, Some("s")), "scenario.s.time_step_s");
    assert_eq!(of(InputField::Friction, Some("s")), "contact.friction", "the load case gives none");
    assert_eq!(of(InputField::TimeStep, None), "time_step", "left for the place that knows the load case");
    assert_eq!(of(InputField::RailName, None), "rail.profile");
}
