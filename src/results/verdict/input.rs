//! What a verdict is made from besides the results that it judges.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::engine::store::{Address, Kind};
use crate::results::springs::uncertain_inputs::UncertainInputs;
use crate::study::{ForceCurve, IntendedUseKeys, LawKey, Study, StudyScenario, Wheel};
use crate::verify::Limits;

/// Limits, and whose they are.
#[derive(Debug, Clone, Serialize)]
pub struct VerdictInput<'a> {
    /// Name of the study.
    pub name: &'a str,
    /// The limits.
    pub limits: &'a Limits,
    /// The accepted sizes of Q/P over 2 m of track, of the load cases that have one.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub ratio_limits: BTreeMap<&'a str, f64>,
    /// What the springs are for.
    pub intended_use: &'a IntendedUseKeys,
    /// The measured curve that the law is compared with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<&'a ForceCurve>,
    /// The wheel, which the published law is not of.
    #[serde(skip)]
    pub wheel: &'a Wheel,
    /// The load cases by name.
    #[serde(skip)]
    pub cases: &'a BTreeMap<String, StudyScenario>,
    /// Name of the load case whose histories have the plain file names.
    #[serde(skip)]
    pub main_case: Option<&'a str>,
    /// Which normal law the study's springs run with.
    pub law: LawKey,
    /// Whether there are laws by contact angle.
    #[serde(skip)]
    pub wants_by_angle: bool,
    /// Whether uncertain inputs go through the load cases.
    #[serde(skip)]
    pub wants_samples: bool,
}

impl<'a> VerdictInput<'a> {
    /// That of a study.
    pub fn of(study: &'a Study) -> Self {
        Self {
            name: &study.name,
            limits: &study.limits,
            ratio_limits: study
                .scenarios
                .iter()
                .filter_map(|(name, case)| Some((name.as_str(), case.ratio_limit?)))
                .collect(),
            intended_use: &study.intended_use,
            measured: study.measured.as_ref(),
            wheel: &study.wheel,
            cases: &study.scenarios,
            main_case: study.main_scenario.as_deref(),
            law: study.simulation.law,
            wants_by_angle: study.wants_by_angle(),
            wants_samples: UncertainInputs::without_samples(study.statics()).is_none(),
        }
    }

    /// Address of the verdict on files with these keys and contents, which stand for wheel and load cases.
    pub fn address(&self, files: &BTreeMap<String, [String; 2]>) -> Address {
        Address::of(Kind::Verdict, &(self, files))
    }
}
