//! What the pages show of a study besides its results.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::results::crosscheck::input::CrosscheckInput;
use crate::study::{ResolvedKey, Source, Study, StudyScenario};
use crate::verify::Limits;

/// A study as the pages show it.
#[derive(Debug, Clone, Serialize)]
pub struct PageInput<'a> {
    /// Name of the study.
    #[serde(skip)]
    pub name: &'a str,
    /// What it is about.
    pub description: &'a str,
    /// Its keys with their values.
    pub keys: &'a [ResolvedKey],
    /// The file that it came from.
    #[serde(skip)]
    pub source: &'a Source,
    /// The limits of its verdict.
    #[serde(skip)]
    pub limits: &'a Limits,
    /// The load cases by name.
    #[serde(skip)]
    pub cases: &'a BTreeMap<String, StudyScenario>,
    /// Key of its cross-check.
    #[serde(skip)]
    pub crosscheck: String,
}

impl<'a> PageInput<'a> {
    /// That of a study.
    pub fn of(study: &'a Study) -> Self {
        Self {
            name: &study.name,
            description: &study.description,
            keys: &study.resolved,
            source: &study.source,
            limits: &study.limits,
            cases: &study.scenarios,
            crosscheck: CrosscheckInput::of(study).key(),
        }
    }
}
