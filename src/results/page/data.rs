//! Everything the report shows.

use crate::engine::measured::Measured;
use crate::results::bodies::outline_figure::{BodyOutline, ProfilePair};
use crate::results::bodies::surface_figure::OnStandard;
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::crosscheck;
use crate::results::patches::record::PatchesRecord;
use crate::results::run::figures::ScenarioRun;
use crate::results::springs::record::{LoadCurveRow, StiffnessRecord};
use crate::results::verdict::record::VerificationRecord;
use crate::self_test::Check;
use crate::study::{IntendedUseKeys, ResolvedKey, ReviewKeys};

/// Everything the report shows.
#[derive(Debug, Clone)]
pub struct ReportData<'a> {
    /// Name of the study.
    pub name: &'a str,
    /// What the study is about.
    pub description: &'a str,
    /// File of the study, without its folders, and the BLAKE3 hash of its text; none of both for a study without a file.
    pub file: Option<(String, String)>,
    /// The study's keys.
    pub inputs: &'a [ResolvedKey],
    /// What the springs are for.
    pub intended_use: &'a IntendedUseKeys,
    /// Who made and who reviewed the study.
    pub review: &'a ReviewKeys,
    /// The program's own test on this machine.
    pub checks: &'a [Check],
    /// The springs.
    pub stiffness: &'a StiffnessRecord,
    /// The load curve with the reference in use.
    pub load_curve: &'a [LoadCurveRow],
    /// The contact patches under some loads.
    pub patches: &'a PatchesRecord,
    /// The laws by contact angle, if there are any.
    pub by_angle: Option<&'a StiffnessByAngleRecord>,
    /// The two profiles.
    pub profiles: &'a ProfilePair,
    /// The measured profiles on their standards.
    pub surfaces: &'a [OnStandard],
    /// The outlines of both bodies, rail first.
    pub bodies: &'a [BodyOutline; 2],
    /// The load cases.
    pub scenarios: Vec<ScenarioRun<'a>>,
    /// Time over which Q and P are averaged, s.
    pub ratio_window: f64,
    /// The verdict.
    pub verdict: &'a VerificationRecord,
    /// The programs that made the files which the report is from.
    pub programs: &'a [String],
    /// Time, memory, host.
    pub measured: &'a Measured,
    /// What independent programs say.
    pub crosscheck: crosscheck::page::Crosscheck<'a>,
}
