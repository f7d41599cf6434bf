//! What a key of a study means, from the schema.

use railspring_profiles::error::InputError;
use serde_json::Value;

use super::check::{Checker, join, nearest};
use super::schema::study_schema;

/// Stands for the name of a load case in a key.
pub(super) const NAME: &str = "NAME";

/// The meaning of a key, its values and its default, of a section its keys, and without a key the sections; as lines of text. The last name of a
/// key is enough where there is only one such key.
///
/// # Errors
/// [`InputError`] for a key that no study has, with the nearest one.
pub fn explain(key: Option<&str>) -> Result<Vec<String>, InputError> {
    let checker = Checker { root: study_schema(), whole: "study" };
    let key = key.unwrap_or_default();
    let all = all_keys(&checker);
    let path: Vec<String> = key.split('.').filter(|part| !part.is_empty()).map(str::to_owned).collect();
    if let Some(schema) = checker.at(&path) {
        return Ok(lines(&checker, &path.join("."), schema));
    }
    let same: Vec<&String> = all.iter().filter(|known| last_name(known) == key).collect();
    if !same.is_empty() {
        let of = |known: &&String| {
            let path: Vec<String> = known.split('.').map(str::to_owned).collect();
            checker.at(&path).map(|schema| lines(&checker, known, schema)).unwrap_or_default()
        };
        return Ok(same.iter().flat_map(of).collect());
    }
    let near = match nearest(key, all.iter().map(String::as_str)) {
        Some(near) if key.contains('.') => Some(near.to_owned()),
        _ => nearest(last_name(key), all.iter().map(|known| last_name(known)))
            .and_then(|near| all.iter().find(|known| last_name(known) == near))
            .cloned(),
    };
    let remedy = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
    Err(InputError::new(
        "key",
        format!("{key:?}"),
        "a key of a study, such as `contact.friction`, or one of its sections",
        format!("{remedy}`railspring explain` lists the sections"),
    ))
}

/// A section of the study for the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionText {
    /// Its name; empty for the keys above all sections.
    pub name: String,
    /// What it is about.
    pub meaning: String,
    /// Its keys in their order.
    pub keys: Vec<KeyText>,
}

/// A key of the study for the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyText {
    /// Its name, with the section before it.
    pub key: String,
    /// What it means.
    pub meaning: String,
    /// What its value may be.
    pub value: String,
    /// What single values mean, where that is said.
    pub options: Vec<(String, String)>,
    /// What holds where it is left out.
    pub default: String,
}

/// All sections with their keys.
pub fn sections() -> Vec<SectionText> {
    let checker = Checker { root: study_schema(), whole: "study" };
    let mut found: Vec<SectionText> = Vec::new();
    for key in all_keys(&checker) {
        let path: Vec<String> = key.split('.').map(str::to_owned).collect();
        let (section, _) = key.rsplit_once('.').unwrap_or(("", &key));
        if !found.iter().any(|known| known.name == section) {
            let path: Vec<String> = section.split('.').filter(|p| !p.is_empty()).map(str::to_owned).collect();
            let meaning = checker.at(&path).map(|schema| checker.describe(schema)).unwrap_or_default();
            found.push(SectionText { name: section.into(), meaning, keys: Vec::new() });
        }
        let (Some(section), Some(schema)) =
            (found.iter_mut().find(|known| known.name == section), checker.at(&path))
        else {
            continue;
        };
        section.keys.push(KeyText {
            meaning: checker.describe(schema),
            value: checker.expectation(schema),
            options: options(&checker, schema),
            default: default(&checker, &key, schema),
            key,
        });
    }
    found
}

fn options(checker: &Checker<'_>, schema: &Value) -> Vec<(String, String)> {
    let said = |option: &Value| Some((option.get("const")?.to_string(), checker.describe(option)));
    checker.options(schema).into_iter().filter_map(said).filter(|(_, said)| !said.is_empty()).collect()
}

fn default(checker: &Checker<'_>, key: &str, schema: &Value) -> String {
    match schema.get("default").filter(|default| !default.is_null()) {
        Some(default) => toml_of(default),
        None if checker.is_required(key) => "none: it has to be given".into(),
        None => "none: it may be left out".into(),
    }
}

fn last_name(key: &str) -> &str {
    key.rsplit('.').next().unwrap_or(key)
}

/// All keys of a study that take a value, dotted.
fn all_keys(checker: &Checker<'_>) -> Vec<String> {
    let mut keys = Vec::new();
    checker.walk(&mut |key, schema| {
        if checker.keys(schema).is_empty() {
            keys.push(key.into());
        }
    });
    keys
}

/// What a schema says about its key.
fn lines(checker: &Checker<'_>, key: &str, schema: &Value) -> Vec<String> {
    let meaning = checker.describe(schema);
    let keys = checker.keys(schema);
    if !keys.is_empty() {
        let head = if key.is_empty() { meaning } else { format!("[{key}]: {meaning}") };
        let names: Vec<String> = keys.iter().map(|(name, _)| join(key, name)).collect();
        let width = names.iter().map(String::len).max().unwrap_or_default();
        let rows = names.iter().zip(&keys).map(|(name, (_, schema))| {
            format!("  {name:width$}  {}", first_sentence(&checker.describe(schema)))
        });
        return [head].into_iter().chain(rows).collect();
    }
    let mut lines = vec![format!("{key}: {meaning}")];
    lines.push(format!("  value    {}", checker.expectation(schema)));
    let options = options(checker, schema).into_iter();
    lines.extend(options.map(|(value, said)| format!("           {value}  {said}")));
    lines.push(format!("  default  {}", default(checker, key, schema)));
    lines
}

fn first_sentence(text: &str) -> &str {
    text.split(". ").next().unwrap_or(text)
}

/// A default as it would stand in a study.
fn toml_of(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("[{}]", items.iter().map(toml_of).collect::<Vec<_>>().join(", ")),
        Value::Object(map) => {
            let entries: Vec<String> = map.iter().map(|(k, v)| format!("{k} = {}", toml_of(v))).collect();
            format!("{{ {} }}", entries.join(", "))
        }
        other => other.to_string(),
    }
}

impl<'a> Checker<'a> {
    /// The keys inside of a schema with their schemas; those of load cases stand under `NAME`.
    fn keys(&self, schema: &'a Value) -> Vec<(&'a str, &'a Value)> {
        let schema = self.resolve(schema);
        let named = schema.get("properties").and_then(Value::as_object).into_iter().flatten();
        let other = schema.get("additionalProperties").filter(|other| other.is_object()).map(|s| (NAME, s));
        named.map(|(name, schema)| (name.as_str(), schema)).chain(other).collect()
    }

    /// Visits all keys and sections, dotted, with their schemas, in the order of the document.
    pub(super) fn walk(&self, visit: &mut dyn FnMut(&str, &'a Value)) {
        fn below<'a>(
            checker: &Checker<'a>,
            path: &str,
            schema: &'a Value,
            visit: &mut dyn FnMut(&str, &'a Value),
        ) {
            for (name, schema) in checker.keys(schema) {
                let key = join(path, name);
                visit(&key, schema);
                below(checker, &key, schema, visit);
            }
        }
        below(self, "", self.root, visit);
    }

    /// Whether the section of a dotted key cannot be without it.
    fn is_required(&self, key: &str) -> bool {
        let (section, name) = key.rsplit_once('.').unwrap_or(("", key));
        let path: Vec<String> = section.split('.').filter(|p| !p.is_empty()).map(str::to_owned).collect();
        let required = self.at(&path).map(|schema| self.resolve(schema)).and_then(|s| s.get("required"));
        required.and_then(Value::as_array).is_some_and(|names| names.iter().any(|known| known == name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(key: &str) -> String {
        explain(Some(key)).unwrap().join("\n")
    }

    /// Source: the structures of `study::document`. Goal: a key has its meaning, values, range and default, a choice what its values mean, a
    /// section its keys, a load case any name; the last name is enough.
    #[test]
    fn keys_are_explained() {
        let friction = said("contact.friction");
        for part in ["Coulomb friction", "a number from 0 to 2", "default  0.5"] {
            assert!(friction.contains(part), "{part}: {friction}");
        }
        // a load case may have one, too
        assert!(
            said("friction").starts_with(&friction) && said("friction").contains("scenario.NAME.friction")
        );
        let field = said("contact.field");
        assert!(
            field.contains("\"hybrid\"  On a fine grid") && field.contains("default  \"hybrid\""),
            "{field}"
        );
        let wheel = said("wheel");
        let diameter = wheel.lines().find(|line| line.trim_start().starts_with("wheel.tape_diameter_m "));
        assert!(diameter.is_some_and(|line| line.contains("  Diameter at the tape circle")), "{wheel}");
        assert!(said("scenario.constant.steps").contains("a whole number"));
        assert!(said("scenario.NAME.lateral_force").contains("scenario.NAME.lateral_force.mean_kn"));
        assert!(said("name").contains("it has to be given"), "{}", said("name"));
        assert!(said("horizontal_preloads_kn").contains("default  [20.0, 50.0"));
        let sections = explain(None).unwrap().join("\n");
        assert!(
            super::super::document::SECTIONS.iter().all(|section| sections.contains(section)),
            "{sections}"
        );
    }

    /// Goal: a key that no study has gets the nearest one, with its section or without.
    #[test]
    fn the_nearest_key_is_offered() {
        for (key, near) in [
            ("contact.frction", "`contact.friction`"),
            ("frction", "`contact.friction`"),
            ("track.gauge_m", "`track.gauge_mm`"),
        ] {
            let error = explain(Some(key)).unwrap_err();
            assert!(error.remedy.contains(near), "{key}: {}", error.remedy);
        }
    }
}
