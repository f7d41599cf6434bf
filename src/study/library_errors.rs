//! Errors of the libraries in the words of a study. A library names the field that it refuses; the schema of a key
//! says which field it sets (`x-field`), with `{section}` for the section of the key.

use std::sync::OnceLock;

use railspring_profiles::error::{Error, InputError};
use serde_json::Value;

use super::check::Checker;
use super::explain::NAME;
use super::schema::study_schema;
use super::source::Source;

/// A field of the libraries, and a key that sets it.
struct Setter {
    field: String,
    key: String,
}

/// All keys that set a field, in the order of the document.
fn setters() -> &'static [Setter] {
    static SETTERS: OnceLock<Vec<Setter>> = OnceLock::new();
    SETTERS.get_or_init(|| {
        let mut found = Vec::new();
        Checker { root: study_schema(), whole: "study" }.walk(&mut |key, schema| {
            let Some(field) = schema.get("x-field").and_then(Value::as_str) else { return };
            let section = key.rsplit('.').nth(1).unwrap_or_default();
            let field = field.replace("{section}", section);
            found.push(Setter { field, key: key.into() });
        });
        found
    })
}

/// The error with the keys of the study in the place of the libraries' fields, in the key and, where they are in
/// backticks, in expectation and remedy. Of several keys for a field it is the last that `gives` knows, else the
/// first. `scenario` is the load case that the error belongs to.
fn translated(error: InputError, gives: &dyn Fn(&str) -> bool, scenario: Option<&str>) -> InputError {
    let key = |name: &str| -> Option<String> {
        let named = |setter: &Setter| match (setter.key.contains(NAME), scenario) {
            (true, Some(scenario)) => Some(setter.key.replace(NAME, scenario)),
            // Without a load case the key stays open: the error is translated again where the load case is known.
            (true, None) => None,
            (false, _) => Some(setter.key.clone()),
        };
        let keys: Vec<String> =
            setters().iter().filter(|setter| setter.field == name).filter_map(named).collect();
        keys.iter().rfind(|key| gives(key)).or(keys.first()).cloned()
    };
    let in_text = |text: &str| -> String {
        let parts = text.split('`').enumerate();
        let parts = parts.map(|(index, part)| match key(part).filter(|_| index % 2 == 1) {
            Some(key) => key,
            None => part.to_string(),
        });
        parts.collect::<Vec<_>>().join("`")
    };
    InputError {
        key: key(&error.key).unwrap_or(error.key),
        expected: in_text(&error.expected),
        remedy: in_text(&error.remedy),
        value: error.value,
    }
}

/// The error with the keys of a study in the place of the libraries' fields; which of several keys for the same value
/// the study gives is not known.
pub fn with_keys(error: InputError) -> InputError {
    translated(error, &|_| false, None)
}

impl Source {
    /// The error with the keys of this study in the place of the libraries' fields.
    pub fn with_keys(&self, error: InputError) -> InputError {
        translated(error, &|key| self.gives(key), None)
    }

    /// The input error of the load case `scenario`, with the keys of that load case.
    pub fn with_keys_of(&self, scenario: &str, error: InputError) -> InputError {
        translated(error, &|key| self.gives(key), Some(scenario))
    }

    /// The error of a stage that ran the load case `scenario`, with the keys of that load case.
    pub fn in_scenario(&self, scenario: &str, error: Error) -> Error {
        match error {
            Error::Input(input) => self.with_keys_of(scenario, input).into(),
            other => other,
        }
    }
}

#[cfg(test)]
mod tests;
