//! The study: from a TOML file with units in its keys to checked values in SI
//! units, which is the only form the stages see.

pub mod document;

mod record;
mod check;
mod source;
mod schema;
mod settings;
mod explain;
mod collect;
mod content;
mod file_content;
mod key_value;
mod pair;
pub mod tables;
mod analysis;
mod library_errors;
mod measured;
mod force_curve;
mod mesh_file;
mod case_notes;
mod statics;
mod checked;
mod resolve;

use std::path::Path;

use railspring_profiles::error::InputError;
use schema::study_schema;
use serde::de::DeserializeOwned;
use source::Lines;
use toml::de::DeTable;

pub use analysis::{
    CalibrationSettings, ContactSettings, SimulationSettings, StudyScenario, UncertaintySettings,
};
pub(crate) use check::nearest;
pub use checked::Study;
pub use document::{
    ContactElementKey, ElementKey, EnforcementKey, FieldKey, IntendedUseKeys, LawAcceptedKey, LawKey,
    OutputKeys, ReferenceKey, ReviewKeys, SECTIONS, SlidingMatrixKey, SolidKeys, SolidLoadsKey, SpacingKey,
    StudyDocument, TransientKey, VerticalKey, ZeroKey,
};
pub use explain::{KeyText, SectionText, explain, sections};
pub use file_content::FileContent;
pub use force_curve::{ForceCurve, MeasuredForce};
pub use key_value::KeyValue;
pub use library_errors::with_keys;
pub use pair::{MeasuredSurface, MeshFile, Rail, RailBody, SectionFile, Track, Wheel};
pub use record::{PairRecord, ResolvedKey, ResolvedKeys};
pub use schema::schema;
pub(crate) use schema::schema_of;
pub use settings::Setting;
pub use source::{LocatedError, Mistakes, Place, Source};
pub use statics::{Statics, parts};

impl Study {
    /// Reads and checks a study file.
    ///
    /// # Errors
    /// [`Mistakes`] for a file that cannot be read, is not TOML, has unknown, missing or mistyped keys, or values
    /// out of range.
    pub fn read(path: &Path) -> Result<Self, Mistakes> {
        Self::read_with(path, &[])
    }

    /// Reads and checks a study file with `settings` in the place of its keys.
    ///
    /// # Errors
    /// As [`Study::read`]; of a key that a setting gives with the option in the place of the line.
    pub fn read_with(path: &Path, settings: &[Setting]) -> Result<Self, Mistakes> {
        Self::parse_with(path, &text_of(path, WHOLE)?, settings)
    }

    /// Checks the text of a study file; `path` is only named in messages.
    ///
    /// # Errors
    /// As [`Study::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, Mistakes> {
        Self::parse_with(path, text, &[])
    }

    /// Checks the text of a study file with `settings` in the place of its keys.
    ///
    /// # Errors
    /// As [`Study::read_with`].
    pub fn parse_with(path: &Path, text: &str, settings: &[Setting]) -> Result<Self, Mistakes> {
        let Parsed { document, source, findings, mistakes } =
            parsed(path, text, settings, WHOLE, study_schema())?;
        resolve::resolve(document, source, &findings, mistakes).map_err(Mistakes::sorted)
    }
}

/// What messages call a study.
const WHOLE: &str = "study";

/// The text of a TOML file; `whole` is what messages call its content.
///
/// # Errors
/// [`Mistakes`] for a file that cannot be read or is no text.
pub(crate) fn text_of(path: &Path, whole: &str) -> Result<String, Mistakes> {
    content::read(path, whole).map_err(|error| Mistakes::of_file(path, error))
}

/// A document that was checked against its schema.
pub(crate) struct Parsed<T> {
    /// Its keys, without those that are wrong.
    pub document: T,
    /// Where they stand.
    pub source: Source,
    findings: Vec<check::Finding>,
    /// What is wrong.
    pub mistakes: Vec<LocatedError>,
}

/// The document of a TOML text with `settings` in the place of its keys, checked against its `schema`; `path` is only named in messages, and
/// `whole` is what they call it.
///
/// # Errors
/// [`Mistakes`] for a text that is not TOML, for settings that are none, and for keys without which there is no document.
pub(crate) fn parsed<T: DeserializeOwned>(
    path: &Path,
    text: &str,
    settings: &[Setting],
    whole: &str,
    schema: &serde_json::Value,
) -> Result<Parsed<T>, Mistakes> {
    let mut lines = Lines::of(text);
    let set = settings::texts(text.len(), settings, schema, &mut lines);
    let at = |offset: Option<usize>, error: InputError| LocatedError {
        path: path.to_path_buf(),
        place: offset.map(|offset| lines.place(offset)),
        error,
    };
    let syntax = |cause: toml::de::Error| {
        let said = cause.message().replace('\n', ", ");
        let key = format!("{whole} file");
        let error = InputError::new(key, said, "a TOML file", "correct the syntax on this line");
        at(cause.span().map(|span| span.start), error)
    };
    let (mut parsed, broken) = DeTable::parse_recoverable(text);
    if !broken.is_empty() {
        if let Some(foreign) = content::foreign(path, text) {
            return Err(Mistakes::of_file(path, foreign));
        }
        return Err(Mistakes::sorted(broken.into_iter().map(syntax).collect()));
    }
    for (setting, text) in settings.iter().zip(&set) {
        settings::put(parsed.get_mut(), setting, text)
            .map_err(|error| Mistakes::of_option(path, setting.option(), error))?;
    }
    let findings = check::check(parsed.get_ref(), schema, whole);
    let source = Source::new(path, text, &lines, parsed.get_ref());
    let mistakes: Vec<LocatedError> =
        findings.iter().map(|finding| at(finding.offset, finding.error.clone())).collect();
    // Without the keys that are wrong, the others can still be checked against each other.
    let wrong = findings.iter().filter_map(|finding| finding.key).collect();
    let valid = toml::de::Deserializer::from(check::without(parsed, &wrong));
    match T::deserialize(valid) {
        Ok(document) => Ok(Parsed { document, source, findings, mistakes }),
        Err(_) if !mistakes.is_empty() => Err(Mistakes::sorted(mistakes)),
        Err(cause) => Err(Mistakes::sorted(vec![syntax(cause)])),
    }
}

#[cfg(test)]
mod tests;
