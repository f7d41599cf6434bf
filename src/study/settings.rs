//! Keys that are given beside the study file, by an option of the command line: `--set contact.friction=0.3`.

use std::borrow::Cow;

use railspring_profiles::error::InputError;
use serde_json::Value;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::check::{Checker, accepts_type};
use super::schema::study_schema;
use super::source::Lines;

/// A key with the value that it gets in the place of that of the study file.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// What messages call it, for instance `--set contact.friction=0.3`.
    option: String,
    /// The key as it is written.
    key: String,
    /// The key by its sections.
    path: Vec<String>,
    /// The value as it was given; empty: the key is taken out of the study.
    value: String,
}

impl Setting {
    /// The option that gives settings.
    pub const OPTION: &str = "--set";

    /// A setting as the option has it: a dotted key, `=`, and a value as in a study file. Where the key takes a text, it needs no quotes; an empty
    /// value takes the key out of the study.
    ///
    /// # Errors
    /// [`InputError`] with key `--set` for a text without a key or without `=`, and for one of several lines.
    pub fn parse(text: &str) -> Result<Self, InputError> {
        let refused = |expected: &str| {
            InputError::new(
                Self::OPTION,
                format!("{text:?}"),
                expected,
                "write for instance `--set contact.friction=0.3`; `railspring explain` lists the keys",
            )
        };
        let (key, value) =
            text.split_once('=').ok_or_else(|| refused("a key of the study and its value, KEY=VALUE"))?;
        if text.contains(char::is_control) {
            return Err(refused("a key and its value on one line"));
        }
        Self::new(format!("{} {text}", Self::OPTION), key.trim(), value.trim())
            .ok_or_else(|| refused("a dotted key before the `=`, such as `contact.friction`"))
    }

    /// A setting that messages call `option`: a key with a value as it stands in a study file, on one line; `None` if the key is none.
    pub fn new(option: String, key: &str, value: &str) -> Option<Self> {
        let probe = format!("{key} = 0");
        let (table, broken) = DeTable::parse_recoverable(&probe);
        let mut path = Vec::new();
        let mut inner = table.get_ref();
        loop {
            let (name, value) = inner.iter().next()?;
            path.push(name.get_ref().to_string());
            match value.get_ref() {
                DeValue::Table(deeper) => inner = deeper,
                _ => break,
            }
        }
        broken.is_empty().then(|| Self { option, key: key.into(), path, value: value.into() })
    }

    /// What messages call it.
    pub fn option(&self) -> &str {
        &self.option
    }

    /// The dotted key.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// The value as TOML for a key of the study's schema; `None` if the key is taken out of the study.
    pub fn toml(&self) -> Option<String> {
        self.value_in(study_schema())
    }

    fn value_in(&self, schema: &Value) -> Option<String> {
        if self.value.is_empty() {
            return None;
        }
        let quoted = || Value::String(self.value.clone()).to_string();
        let probe = format!("x = {}", self.value);
        let (table, broken) = DeTable::parse_recoverable(&probe);
        let value = table.get_ref().get("x").map(Spanned::get_ref);
        let Some(value) = value.filter(|_| broken.is_empty() && table.get_ref().len() == 1) else {
            return Some(quoted());
        };
        // `rail.profile=60E1` is a text, although TOML has it as a number
        let checker = Checker { root: schema, whole: "study" };
        let options = checker.at(&self.path).map(|at| checker.options(at)).unwrap_or_default();
        let takes = |value: &DeValue<'_>| options.iter().any(|option| accepts_type(option, value));
        let text = DeValue::String(Cow::Borrowed(""));
        Some(if !takes(value) && takes(&text) { quoted() } else { self.value.clone() })
    }
}

/// The settings as texts of TOML behind a study of `length` bytes, each at its place; `lines` learns where they begin.
pub(super) fn texts(length: usize, settings: &[Setting], schema: &Value, lines: &mut Lines) -> Vec<String> {
    let mut begin = length + 1;
    let mut texts = Vec::new();
    for setting in settings {
        let written =
            setting.value_in(schema).map_or_else(String::new, |value| format!("{} = {value}", setting.key));
        lines.with_option(begin, &setting.option);
        let text = format!("{:begin$}{written}", "");
        begin = text.len() + 1;
        texts.push(text);
    }
    texts
}

/// Puts a setting, whose text is `text`, into a document.
///
/// # Errors
/// [`InputError`] for a key that is to be taken out and is not there.
pub(super) fn put<'i>(
    document: &mut DeTable<'i>,
    setting: &Setting,
    text: &'i str,
) -> Result<(), InputError> {
    let mut given = DeTable::parse_recoverable(text).0.into_inner();
    let mut table = document;
    let (last, sections) = setting.path.split_last().expect("a key has a name");
    if setting.value.is_empty() {
        let missing = || {
            InputError::new(
                setting.key.as_str(),
                "(empty)",
                "a key that the study gives, to be taken out",
                "leave the option out, or give a value",
            )
        };
        for section in sections {
            table = match table.get_mut(section.as_str()).map(Spanned::get_mut) {
                Some(DeValue::Table(inner)) => inner,
                _ => return Err(missing()),
            };
        }
        return table.remove(last.as_str()).map(|_| ()).ok_or_else(missing);
    }
    for section in sections {
        let (key, value) =
            given.remove_entry(section.as_str()).expect("the text has the sections of its key");
        let span = value.span();
        let DeValue::Table(inner) = value.into_inner() else { unreachable!("sections are tables") };
        given = inner;
        if !table.get(section.as_str()).is_some_and(|found| found.get_ref().is_table()) {
            table.remove(section.as_str());
            table.insert(key, Spanned::new(span, DeValue::Table(DeTable::new())));
        }
        table = match table.get_mut(section.as_str()).map(Spanned::get_mut) {
            Some(DeValue::Table(inner)) => inner,
            _ => unreachable!("it was put there"),
        };
    }
    let (key, value) = given.remove_entry(last.as_str()).expect("the text has its key");
    table.remove(last.as_str());
    table.insert(key, value);
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::{Mistakes, Study};
    use super::*;

    const STUDY: &str = "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"S1002\"\n";

    fn with(settings: &[&str]) -> Result<Study, Mistakes> {
        let settings: Vec<Setting> = settings.iter().map(|text| Setting::parse(text).unwrap()).collect();
        Study::parse_with(Path::new("x.toml"), STUDY, &settings)
    }

    /// Goal: a study with settings is the study with these keys in its file, and counts them as given. Texts
    /// need no quotes, even where TOML reads them as numbers. The last one of a key counts. A key can be
    /// taken out, and a whole section be given.
    #[test]
    fn settings_are_keys() {
        let text = STUDY.replace("60E1", "54E1")
            + "[contact]\nfriction = 0.3\n[scenario.s]\nlateral_force = { mean_kn = 5 }\nvertical_force = {}\n";
        let settings = [
            "rail.profile=UIC60",
            "rail.profile = 54E1",
            "contact.friction=0.3",
            "scenario.s.lateral_force={ mean_kn = 5 }",
            "scenario.s.vertical_force={}",
        ];
        let (set, written) = (with(&settings).unwrap(), Study::parse(Path::new("x.toml"), &text).unwrap());
        assert_eq!((set.statics(), &set.resolved), (written.statics(), &written.resolved));
        let smooth = with(&["name=1.5", "rail.inclination=1:20", "calibration.shifts_mm=[]"]).unwrap();
        assert_eq!((smooth.name.as_str(), smooth.rail.inclination), ("1.5", 0.05));
        let out = with(&["wheel.profile=", "wheel.section_file=none.dxf"]).unwrap_err().to_string();
        assert!(out.contains("wheel.section_file=none.dxf: wheel.section_file = "), "{out}");
    }

    /// Goal: what is wrong with a setting is said of its option: an unknown key, a value out of range or of another type, a check of several keys,
    /// a key that is not there; what is wrong with the file keeps its line.
    #[test]
    fn mistakes_name_the_option() {
        for (setting, said) in [
            ("contact.frction=0.3", "contact.frction = 0.3: expected a key of [contact]"),
            ("contact.friction=3", "contact.friction = 3: expected a number from 0 to 2"),
            ("contact.friction=0,3", "contact.friction = \"0,3\": expected a number from 0 to 2"),
            ("contact.friction=[0.3", "contact.friction = \"[0.3\": expected a number"),
            ("rail.profile=60E3", "rail.profile = \"60E3\": expected one of "),
            ("rail=5", "rail = 5: expected a section"),
            ("rail.profile.x=5", "rail.profile = (a section): expected a text"),
            ("calibration.load_max_kn=0.5", "calibration.load_max_kn = 0.5: expected more than"),
            ("contact.friction=", "contact.friction = (empty): expected a key that the study gives"),
        ] {
            let message = with(&[setting]).unwrap_err().to_string();
            let start = format!("x.toml with --set {setting}: {said}");
            assert!(message.starts_with(&start), "{start}\n{message}");
        }
        let line = with(&["rail.profile=", "contact.friction=0.3"]).unwrap_err().to_string();
        assert!(line.starts_with("x.toml:2: rail.profile = (missing)"), "{line}");
        for text in ["contact.friction", "=3", "a b=3", "contact.friction=1\n[rail]", "x.=1"] {
            assert_eq!(Setting::parse(text).unwrap_err().key, "--set", "{text:?}");
        }
    }
}
