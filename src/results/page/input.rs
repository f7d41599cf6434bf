//! What the pages show of a study besides its results.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::results::crosscheck::in_time::input::InTimeInput;
use crate::results::crosscheck::input::CrosscheckInput;
use crate::study::{IntendedUseKeys, ResolvedKey, ReviewKeys, Source, Study, StudyScenario};
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
    pub keys: Vec<ResolvedKey>,
    /// What its springs are for, which the keys have.
    #[serde(skip)]
    pub intended_use: &'a IntendedUseKeys,
    /// Who made and who reviewed it, likewise.
    #[serde(skip)]
    pub review: &'a ReviewKeys,
    /// The file that it came from.
    #[serde(skip)]
    pub source: &'a Source,
    /// The limits of its verdict.
    #[serde(skip)]
    pub limits: &'a Limits,
    /// The load cases by name.
    #[serde(skip)]
    pub cases: &'a BTreeMap<String, StudyScenario>,
    /// Keys of its cross-checks: the static one, and that of its load case, if it has one that can be asked.
    #[serde(skip)]
    pub crosschecks: Vec<String>,
}

impl<'a> PageInput<'a> {
    /// That of a study.
    pub fn of(study: &'a Study) -> Self {
        let in_time = InTimeInput::of(study).ok().map(|input| input.key());
        Self {
            name: &study.name,
            description: &study.description,
            keys: study.resolved.to_vec(),
            intended_use: &study.intended_use,
            review: &study.review,
            source: &study.source,
            limits: &study.limits,
            cases: &study.scenarios,
            crosschecks: [Some(CrosscheckInput::of(study).key()), in_time].into_iter().flatten().collect(),
        }
    }
}
