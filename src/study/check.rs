//! Checks a parsed TOML document against the JSON schema of the study and
//! says what is wrong in terms of the file: key, line, value, what was
//! expected and how to correct it.

use std::collections::BTreeSet;

use railspring_profiles::error::InputError;
use serde_json::Value;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Keys that studies had before, and what is there instead.
const REMOVED: [(&str, &str); 1] = [(
    "verification.ratio_floor",
    "Q/P is compared where the uncertainty of P and Q moves it by `verification.ratio_max` at most",
)];

/// One thing that is wrong in a study file.
#[derive(Debug, Clone)]
pub struct Finding {
    /// Byte at which it stands; `None` for something that is absent from the whole file.
    pub offset: Option<usize>,
    /// Byte at which the innermost key around it begins; `None` for what is absent from the whole file.
    pub key: Option<usize>,
    /// Whether the key is one that its section does not have.
    pub unknown: bool,
    /// What is wrong.
    pub error: InputError,
}

/// All findings of a document, in the order of the file; a missing section comes first. `whole` is what messages call it.
pub fn check(document: &DeTable<'_>, schema: &Value, whole: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    Checker { root: schema, whole }.table(document, schema, "", None, &mut findings);
    findings.sort_by_key(|finding| finding.offset);
    findings
}

/// The document without the keys that begin at the bytes `wrong`.
pub fn without<'i>(document: Spanned<DeTable<'i>>, wrong: &BTreeSet<usize>) -> Spanned<DeTable<'i>> {
    fn strip_invalid<'i>(table: DeTable<'i>, wrong: &BTreeSet<usize>) -> DeTable<'i> {
        let kept = table.into_iter().filter(|(key, _)| !wrong.contains(&key.span().start));
        kept.map(|(key, value)| {
            let span = value.span();
            let value = match value.into_inner() {
                DeValue::Table(inner) => DeValue::Table(strip_invalid(inner, wrong)),
                other => other,
            };
            (key, Spanned::new(span, value))
        })
        .collect()
    }
    if wrong.is_empty() {
        return document;
    }
    let span = document.span();
    Spanned::new(span, strip_invalid(document.into_inner(), wrong))
}

/// A schema, and what messages call the document that it describes.
pub(super) struct Checker<'a> {
    pub root: &'a Value,
    pub whole: &'a str,
}

impl<'a> Checker<'a> {
    /// The schema of a key by its sections.
    pub fn at(&self, path: &[String]) -> Option<&'a Value> {
        path.iter().try_fold(self.root, |schema, name| {
            let schema = self.resolve(schema);
            let named = schema.get("properties").and_then(|properties| properties.get(name));
            named.or_else(|| schema.get("additionalProperties").filter(|other| other.is_object()))
        })
    }

    /// The alternatives of a schema; itself if it has none.
    pub fn options(&self, schema: &'a Value) -> Vec<&'a Value> {
        let resolved = self.resolve(schema);
        let options = resolved.get("anyOf").or_else(|| resolved.get("oneOf")).and_then(Value::as_array);
        match options {
            Some(options) => options.iter().flat_map(|option| self.options(option)).collect(),
            None => vec![resolved],
        }
    }

    /// Follows a `$ref` into the definitions, also that of a section that may be left out.
    pub fn resolve(&self, schema: &'a Value) -> &'a Value {
        if let Some(pointer) = schema.get("$ref").and_then(Value::as_str).and_then(|r| r.strip_prefix('#')) {
            return self.root.pointer(pointer).unwrap_or(schema);
        }
        let of = schema.get("anyOf").and_then(Value::as_array).into_iter().flatten();
        let given: Vec<&Value> =
            of.filter(|one| one.get("type").and_then(Value::as_str) != Some("null")).collect();
        match given[..] {
            [one] => self.resolve(one),
            _ => schema,
        }
    }

    fn table(
        &self,
        table: &DeTable<'_>,
        schema: &'a Value,
        path: &str,
        offset: Option<usize>,
        findings: &mut Vec<Finding>,
    ) {
        let schema = self.resolve(schema);
        let properties = schema.get("properties").and_then(Value::as_object);
        let additional = schema.get("additionalProperties").filter(|a| **a != Value::Bool(false));
        for (key, value) in table.iter() {
            let name = key.get_ref().as_ref();
            let full = join(path, name);
            match properties.and_then(|p| p.get(name)).or(additional) {
                Some(expected) => {
                    let before = findings.len();
                    self.value(value.get_ref(), expected, &full, key.span().start, findings);
                    let here = Some(key.span().start);
                    findings[before..].iter_mut().for_each(|finding| finding.key = finding.key.or(here));
                }
                None => {
                    let known: Vec<&str> =
                        properties.map(|p| p.keys().map(String::as_str).collect()).unwrap_or_default();
                    findings.push(Finding {
                        offset: Some(key.span().start),
                        key: Some(key.span().start),
                        unknown: true,
                        error: self.unknown_key(path, name, value.get_ref(), &known),
                    });
                }
            }
        }
        for name in schema.get("required").and_then(Value::as_array).into_iter().flatten() {
            let name = name.as_str().unwrap_or_default();
            if !table.contains_key(name) {
                let meaning =
                    properties.and_then(|p| p.get(name)).map(|p| self.describe(p)).unwrap_or_default();
                let expected = properties
                    .and_then(|p| p.get(name))
                    .map(|p| self.expectation(p))
                    .unwrap_or_else(|| "a value".into());
                findings.push(Finding {
                    offset,
                    key: None,
                    unknown: false,
                    error: InputError::new(
                        join(path, name),
                        "(missing)",
                        expected,
                        format!("add this key{}: {meaning}", in_section(path)),
                    ),
                });
            }
        }
    }

    fn value(
        &self,
        value: &DeValue<'_>,
        schema: &'a Value,
        path: &str,
        offset: usize,
        findings: &mut Vec<Finding>,
    ) {
        let resolved = self.resolve(schema);
        // any value that a key can have
        if resolved.as_object().is_none_or(|schema| !DECIDE.iter().any(|word| schema.contains_key(*word))) {
            return unholdable(value, path, offset, findings);
        }
        if let Some(options) =
            resolved.get("anyOf").or_else(|| resolved.get("oneOf")).and_then(Value::as_array)
        {
            // The alternatives differ in type; a value of the right type is checked in full
            // against that alternative, so that its range is named.
            let of_type: Vec<&Value> =
                options.iter().map(|o| self.resolve(o)).filter(|o| accepts_type(o, value)).collect();
            let accepted = of_type.iter().any(|option| {
                let mut inner = Vec::new();
                self.value(value, option, path, offset, &mut inner);
                inner.is_empty()
            });
            if accepted {
                return;
            }
            match of_type.as_slice() {
                // the one choice of an enum is named as the choices of others are
                [only] if only.get("const").is_none() => self.value(value, only, path, offset, findings),
                _ => findings.push(self.mismatch(value, schema, path, offset)),
            }
            return;
        }
        if !accepts_type(resolved, value) || !accepts_value(resolved, value) {
            findings.push(self.mismatch(value, schema, path, offset));
            return;
        }
        match value {
            DeValue::Table(table) => self.table(table, resolved, path, Some(offset), findings),
            DeValue::Array(items) => {
                if let Some(item) = resolved.get("items") {
                    for (index, entry) in items.iter().enumerate() {
                        let path = format!("{path}[{index}]");
                        self.value(entry.get_ref(), item, &path, entry.span().start, findings);
                    }
                }
            }
            _ => {}
        }
    }

    fn mismatch(&self, value: &DeValue<'_>, schema: &'a Value, path: &str, offset: usize) -> Finding {
        let meaning = self.describe(schema);
        let remedy =
            if meaning.is_empty() { "correct the value".into() } else { format!("this key is: {meaning}") };
        Finding {
            offset: Some(offset),
            key: None,
            unknown: false,
            error: InputError::new(path, render(value), self.expectation(schema), remedy),
        }
    }

    fn unknown_key(&self, path: &str, name: &str, value: &DeValue<'_>, known: &[&str]) -> InputError {
        let place = if path.is_empty() { format!("the {}", self.whole) } else { format!("[{path}]") };
        let expected = format!("a key of {place} ({})", known.join(", "));
        let removed = REMOVED.iter().find(|(key, _)| *key == join(path, name));
        let remedy = match nearest(name, known.iter().copied()) {
            _ if let Some((_, instead)) = removed => format!("the key is gone: {instead}; remove it"),
            Some(near) => format!("the key is unknown; did you mean `{}`?", join(path, near)),
            None => match self.elsewhere(name) {
                Some(full) => format!("the key is unknown here; it belongs to `{full}`"),
                None => "the key is unknown; remove it".into(),
            },
        };
        InputError::new(join(path, name), render(value), expected, remedy)
    }

    /// The same key in another section.
    fn elsewhere(&self, name: &str) -> Option<String> {
        let sections = self.root.get("properties")?.as_object()?;
        sections.iter().find_map(|(section, schema)| {
            let keys = self.resolve(schema).get("properties")?.as_object()?;
            keys.contains_key(name).then(|| join(section, name))
        })
    }

    /// What a schema means, without a full stop.
    pub fn describe(&self, schema: &'a Value) -> String {
        let own = schema.get("description").and_then(Value::as_str);
        let text = own.or_else(|| self.resolve(schema).get("description").and_then(Value::as_str));
        text.unwrap_or_default().replace('\n', " ").trim_end_matches('.').to_string()
    }

    /// What a schema accepts, in words.
    pub fn expectation(&self, schema: &'a Value) -> String {
        let resolved = self.resolve(schema);
        if let Some(options) =
            resolved.get("anyOf").or_else(|| resolved.get("oneOf")).and_then(Value::as_array)
        {
            let constants: Vec<String> =
                options.iter().filter_map(|o| o.get("const")).map(Value::to_string).collect();
            if constants.len() == options.len() {
                return one_of(&constants);
            }
            let parts: Vec<String> = options
                .iter()
                .filter(|o| o.get("type").and_then(Value::as_str) != Some("null"))
                .map(|o| self.expectation(o))
                .collect();
            return parts.join(" or ");
        }
        if let Some(values) = resolved.get("enum").and_then(Value::as_array) {
            return one_of(&values.iter().map(Value::to_string).collect::<Vec<_>>());
        }
        if let Some(only) = resolved.get("const") {
            return only.to_string();
        }
        let range = match (bound(resolved, "minimum"), bound(resolved, "maximum")) {
            (Some(low), Some(high)) => format!(" from {low} to {high}"),
            (Some(low), None) => format!(" of at least {low}"),
            (None, Some(high)) => format!(" of at most {high}"),
            (None, None) => String::new(),
        };
        match kind(resolved) {
            "number" => format!("a number{range}"),
            "integer" => format!("a whole number{range}"),
            "string" => "a text in quotes".into(),
            "boolean" => "true or false".into(),
            "array" => {
                let items = resolved.get("items").map(|i| self.expectation(i)).unwrap_or_default();
                let count = match (bound(resolved, "minItems"), bound(resolved, "maxItems")) {
                    (Some(low), Some(high)) => format!(" of {low} to {high} entries"),
                    (Some(low), None) => format!(" of at least {low} entries"),
                    _ => String::new(),
                };
                format!("a list{count}, each {items}")
            }
            "object" => "a section".into(),
            _ => "another value".into(),
        }
    }
}

/// The choices of a key, in words.
fn one_of(choices: &[String]) -> String {
    match choices {
        [only] => only.clone(),
        several => format!("one of {}", several.join(", ")),
    }
}

/// Words of a schema that say which values there are.
const DECIDE: [&str; 7] = ["type", "anyOf", "oneOf", "enum", "const", "properties", "additionalProperties"];

/// What no key can have, wherever it stands in a value: `nan`, `inf`, a date, a number that does not fit.
fn unholdable(value: &DeValue<'_>, path: &str, offset: usize, findings: &mut Vec<Finding>) {
    match value {
        DeValue::Table(table) => {
            for (key, inner) in table.iter() {
                unholdable(inner.get_ref(), &join(path, key.get_ref()), key.span().start, findings);
            }
        }
        DeValue::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                unholdable(item.get_ref(), &format!("{path}[{index}]"), item.span().start, findings);
            }
        }
        DeValue::Float(_) | DeValue::Integer(_) if accepts_value(&Value::Bool(true), value) => {}
        DeValue::String(_) | DeValue::Boolean(_) => {}
        DeValue::Float(_) | DeValue::Integer(_) | DeValue::Datetime(_) => findings.push(Finding {
            offset: Some(offset),
            key: None,
            unknown: false,
            error: InputError::new(
                path,
                render(value),
                "a finite number, a text in quotes, true or false, or a list of these",
                "correct the value",
            ),
        }),
    }
}

/// The type a schema asks for, `null` aside.
fn kind(schema: &Value) -> &str {
    match schema.get("type") {
        Some(Value::String(name)) => name,
        Some(Value::Array(names)) => {
            names.iter().filter_map(Value::as_str).find(|name| *name != "null").unwrap_or_default()
        }
        _ => "",
    }
}

/// Whether a value is of the type that a schema asks for.
pub(super) fn accepts_type(schema: &Value, value: &DeValue<'_>) -> bool {
    matches!(
        (kind(schema), value),
        ("number", DeValue::Float(_) | DeValue::Integer(_))
            | ("integer", DeValue::Integer(_))
            | ("string", DeValue::String(_))
            | ("boolean", DeValue::Boolean(_))
            | ("array", DeValue::Array(_))
            | ("object", DeValue::Table(_))
            | ("", _)
    )
}

fn accepts_value(schema: &Value, value: &DeValue<'_>) -> bool {
    let within = |number: f64, low: &str, high: &str| {
        number.is_finite()
            && bound(schema, low).is_none_or(|low| number >= low)
            && bound(schema, high).is_none_or(|high| number <= high)
    };
    match value {
        DeValue::Float(float) => {
            within(float.as_str().replace('_', "").parse().unwrap_or(f64::NAN), "minimum", "maximum")
        }
        DeValue::Integer(integer) => {
            let number = i64::from_str_radix(&integer.as_str().replace('_', ""), integer.radix());
            within(number.map_or(f64::NAN, |n| n as f64), "minimum", "maximum")
        }
        DeValue::String(text) => {
            let named = |value: &Value| value.as_str() == Some(text.as_ref());
            within(text.chars().count() as f64, "minLength", "maxLength")
                && schema.get("const").is_none_or(named)
                && schema.get("enum").and_then(Value::as_array).is_none_or(|list| list.iter().any(named))
        }
        DeValue::Array(items) => within(items.len() as f64, "minItems", "maxItems"),
        _ => true,
    }
}

fn bound(schema: &Value, name: &str) -> Option<f64> {
    schema.get(name).and_then(Value::as_f64)
}

/// A text in quotes, of a bounded length.
fn quoted(text: &str) -> String {
    const LONGEST: usize = 120;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{:?}… ({} characters)", &text[..end], text.chars().count()),
        None => format!("{text:?}"),
    }
}

/// The known name nearest to a wrong one, if any is near.
pub(crate) fn nearest<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    // Below this similarity a suggestion would only mislead.
    const NEAR: f64 = 0.75;
    // The search takes the product of the lengths.
    const LONGEST: usize = 100;
    let lower: String = name.chars().take(LONGEST).flat_map(char::to_lowercase).collect();
    known
        .map(|candidate| (strsim::jaro_winkler(&lower, &candidate.to_lowercase()), candidate))
        .filter(|(similarity, _)| *similarity >= NEAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// A dotted key.
pub(super) fn join(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_string() } else { format!("{path}.{name}") }
}

fn in_section(path: &str) -> String {
    if path.is_empty() { String::new() } else { format!(" to [{path}]") }
}

/// A value as it is shown in a message.
fn render(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => quoted(text),
        DeValue::Integer(integer) => integer.to_string(),
        DeValue::Float(float) => float.to_string(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(date) => date.to_string(),
        DeValue::Array(items) => {
            let shown: Vec<String> = items.iter().take(6).map(|item| render(item.get_ref())).collect();
            let more = if items.len() > 6 { ", …" } else { "" };
            format!("[{}{more}]", shown.join(", "))
        }
        DeValue::Table(_) => "(a section)".into(),
    }
}
