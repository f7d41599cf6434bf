//! Mutated studies. What is accepted has every key of the file with the file's value, within the schema, and is finite.

use std::collections::BTreeMap;
use std::path::PathBuf;

use railspring::study::{Study, schema};
use serde_json::Value;

use super::mutate::{Dice, mistakes};
use super::{Fate, tried};

/// Everything that a study can say, but for files.
const EVERYTHING: &str = r#"
name = "everything"
description = "every section"
[rail]
profile = "60E1"
inclination = "1:40"
length_m = 0.555
[wheel]
profile = "S1002"
tape_diameter_m = 0.858
flange_height_mm = 28
flange_thickness_mm = 32.5
[track]
gauge_mm = 1435
flange_back_mm = 1360
lateral_shift_mm = 1.5
[material]
young_gpa = 210
poisson = 0.3
density_kg_per_m3 = 7850
damping_ratio = 0.02
[mesh]
contact_element_mm = 4
element = "incompatible-modes"
[contact]
friction = 0.5
[calibration]
load_min_kn = 5
load_max_kn = 85
load_count = 5
horizontal_preloads_kn = [40, 60]
[simulation]
rail_elements = 40
[scenario.push]
description = "a push"
steps = 60
time_step_s = 0.0005
gravity_m_per_s2 = 9.81
suspended_mass_t = 6.25
vertical_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
vertical_force = { mean_kn = 10, amplitude_kn = 61.25, frequency_hz = 10, phase_deg = 90 }
lateral_force = { mean_kn = 20 }
snapshots_s = [0, 0.003]
[scenario.ride]
steps = 60
solid = false
speed_m_per_s = 0.5
start_x_m = 0.2
vertical_force = { mean_kn = 10 }
lateral_force = {}
[limits]
vertical_rms = 0.2
"#;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data/studies")
}

fn seeds() -> Vec<String> {
    let read = |name: &str| std::fs::read_to_string(folder().join(name)).unwrap();
    vec![EVERYTHING.into(), read("uic60-s1002.toml"), read("worn.toml")]
}

pub fn try_mutations(count: u64) {
    let (seeds, schema) = (seeds(), schema());
    let path = folder().join("mutated.toml");
    tried("studies", count, |dice: &mut Dice| {
        let (text, changes) = mistakes(&seeds[dice.below(seeds.len())], dice);
        let fate = match Study::parse(&path, &text) {
            Err(error) => Fate::Refused(error.to_string()),
            Ok(study) => match misread(&study, &text, &schema) {
                Some(what) => Fate::Silent(what),
                None => Fate::Read,
            },
        };
        (changes, fate)
    });
}

/// What a study has otherwise than its file, if anything.
fn misread(study: &Study, text: &str, schema: &Value) -> Option<String> {
    let table: toml::Table = match text.parse() {
        Ok(table) => table,
        Err(cause) => return Some(format!("no TOML, {cause}")),
    };
    let resolved: BTreeMap<String, (&str, bool)> = study
        .resolved
        .iter()
        .map(|key| (format!("{}.{}", key.section, key.key), (key.value.as_str(), key.given)))
        .collect();
    let mut leaves = Vec::new();
    flatten("", &toml::Value::Table(table), &mut leaves);
    for (key, value) in &leaves {
        if let Some(fault) = out_of_schema(key, value, schema) {
            return Some(fault);
        }
        if key == "name" || key.ends_with("description") {
            continue;
        }
        match resolved.get(key) {
            Some((read, true)) if same(value, read) => {}
            other => return Some(format!("{key} = {value} was read as {other:?}")),
        }
    }
    let known = |key: &str| leaves.iter().any(|(leaf, _)| leaf == key);
    if let Some((key, _)) = resolved.iter().find(|(key, (_, given))| *given && !known(key)) {
        return Some(format!("{key} is said to be given"));
    }
    let shown = format!("{study:?}");
    [": NaN", ": inf", ": -inf"].iter().find(|n| shown.contains(**n)).map(|n| format!("a value{n}"))
}

/// All values of a file that are no tables, by dotted key.
fn flatten(path: &str, value: &toml::Value, leaves: &mut Vec<(String, toml::Value)>) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                flatten(&if path.is_empty() { key.clone() } else { format!("{path}.{key}") }, value, leaves);
            }
        }
        other => leaves.push((path.to_string(), other.clone())),
    }
}

fn number(value: &toml::Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|n| n as f64))
}

fn same(value: &toml::Value, read: &str) -> bool {
    match value {
        toml::Value::Array(items) if items.is_empty() => read.is_empty(),
        toml::Value::Array(items) => {
            let read: Vec<&str> = read.split(", ").collect();
            items.len() == read.len() && items.iter().zip(read).all(|(item, read)| same(item, read))
        }
        toml::Value::String(text) => text == read,
        toml::Value::Boolean(flag) => flag.to_string() == read,
        _ => number(value).is_some_and(|value| read.parse() == Ok(value)),
    }
}

/// A number beyond the bounds of the schema, or a key that the schema does not have.
fn out_of_schema(key: &str, value: &toml::Value, schema: &Value) -> Option<String> {
    let mut at = follow(schema, schema);
    for part in key.split('.') {
        let next = at.get("properties").and_then(|p| p.get(part)).or_else(|| at.get("additionalProperties"));
        match next {
            Some(next) => at = follow(schema, next),
            None => return Some(format!("{key} is not in the schema")),
        }
    }
    let items: Vec<&toml::Value> = value.as_array().map_or(vec![value], |items| items.iter().collect());
    let bounds = if value.is_array() { at.get("items").unwrap_or(at) } else { at };
    items.into_iter().filter_map(number).find_map(|number| {
        let bound = |name: &str| bounds.get(name).and_then(Value::as_f64);
        let inside = bound("minimum").is_none_or(|low| number >= low)
            && bound("maximum").is_none_or(|high| number <= high);
        (!inside).then(|| format!("{key} = {number} is out of the schema's range"))
    })
}

/// The definition that a reference, or the part of a choice that is no null, stands for.
fn follow<'s>(root: &'s Value, schema: &'s Value) -> &'s Value {
    if let Some(pointer) = schema.get("$ref").and_then(Value::as_str).and_then(|r| r.strip_prefix('#')) {
        return follow(root, root.pointer(pointer).unwrap_or(schema));
    }
    let options = schema.get("anyOf").and_then(Value::as_array);
    let not_null =
        options.and_then(|all| all.iter().find(|o| o.get("type").and_then(Value::as_str) != Some("null")));
    not_null.map_or(schema, |option| follow(root, option))
}
