//! Fields of the libraries and keys of the study, walked both ways.

use std::path::Path;

use railspring_profiles::error::InputError;
use railspring_profiles::field::InputField;
use serde_json::Value;

use super::setters;
use crate::study::{SECTIONS, Study, schema};

/// Follows a reference, the optional alternative included.
fn followed<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    let of = |s: &'a Value| s.get("$ref").and_then(Value::as_str).and_then(|r| root.pointer(&r[1..]));
    let option = schema.get("anyOf").and_then(Value::as_array).and_then(|any| any.iter().find_map(of));
    of(schema).or(option).unwrap_or(schema)
}

/// Goal: every field of the libraries is set by a key or by the program, and no key sets a field that is none.
#[test]
fn fields_are_set_by_keys_or_by_the_program() {
    use InputField::{
        Dissipation, LayerGrowth, ProfileKind, ProfilePart, ProfileUnit, RailZoneFaceDepth, RailZoneFieldY,
        SectionGrowth, WheelZoneFaceDepth, WheelZoneFieldY,
    };
    let by_the_program = [
        ProfilePart,
        ProfileUnit,
        ProfileKind,
        LayerGrowth,
        SectionGrowth,
        RailZoneFaceDepth,
        RailZoneFieldY,
        WheelZoneFaceDepth,
        WheelZoneFieldY,
        Dissipation,
    ];
    let by_keys = |field: &InputField| setters().iter().any(|setter| setter.field == field.name());
    let not_by_keys: Vec<InputField> =
        InputField::ALL.iter().copied().filter(|field| !by_keys(field)).collect();
    assert_eq!(not_by_keys, by_the_program);
    let mut names: Vec<&str> = InputField::ALL.iter().map(|field| field.name()).collect();
    let unknown: Vec<&str> =
        setters().iter().map(|setter| setter.field.as_str()).filter(|field| !names.contains(field)).collect();
    assert_eq!(unknown, [""; 0]);
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), InputField::ALL.len(), "two fields with one name");
    let sections = names.iter().filter(|name| SECTIONS.contains(name) || **name == "name");
    assert_eq!(sections.count(), 0, "a field that a study could name");
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
    let of = |field, scenario| {
        let error = InputError::new(field, "v", "e", "r");
        match scenario {
            Some(scenario) => study.source.with_keys_of(scenario, error).key,
            None => study.source.with_keys(error).key,
        }
    };
    assert_eq!(of(InputField::TimeStep, Some("s")), "scenario.s.time_step_s");
    assert_eq!(of(InputField::Friction, Some("s")), "contact.friction", "the load case gives none");
    assert_eq!(of(InputField::TimeStep, None), "time_step", "left for the place that knows the load case");
    assert_eq!(of(InputField::RailName, None), "rail.profile");
}
