//! The sections `intended_use`, `validation` and `review`: what an assessor asks for beside the numbers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the springs are for, and how accurate they have to be for it (ASME V&V 10): to be said before the results are seen. A requirement that is not
/// met fails the verdict.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct IntendedUseKeys {
    /// What the springs are for, in a sentence; shown in the report before the results.
    pub purpose: String,
    /// Largest uncertainty of the law's displacement, per cent: inputs and numerics together, in 95 of 100 cases, at the loads of the uncertainty. Beside a
    /// measured curve the model's error with its uncertainty has to keep it as well.
    #[schemars(range(min = 0.01, max = 1000.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement_percent: Option<f64>,
    /// The same of the law's tangent stiffness.
    #[schemars(range(min = 0.01, max = 1000.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tangent_percent: Option<f64>,
    /// The same of the horizontal stiffness.
    #[schemars(range(min = 0.01, max = 1000.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub horizontal_percent: Option<f64>,
}

/// A measurement that the springs are compared with (ASME V&V 20).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ValidationKeys {
    /// File of a measured curve of force and displacement, relative to the study: a line of names, then a line for each load, ascending. Columns have their
    /// units in their names, `force_kn` and `displacement_mm`, and may have `standard_uncertainty_mm`. The displacement is that of
    /// `calibration.reference`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<String>,
    /// Where the displacement of the curve is counted from.
    pub zero: ZeroKey,
    /// Standard uncertainty of each measured displacement, mm, where the file has no column of it.
    #[schemars(range(min = 0.0, max = 10.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_uncertainty_mm: Option<f64>,
}

/// Where a measured displacement is counted from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ZeroKey {
    /// Where wheel and rail just touch.
    #[default]
    Touching,
    /// The first line of the file: its displacement is taken off all, and that of the law under its force from the law.
    FirstLine,
}

/// Who made and who reviewed the study.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ReviewKeys {
    /// Who made it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// Who reviewed it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reviewer: Option<String>,
    /// Of whom, or of what, the reviewer is independent: of the author, of the project, of the organisation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub independent_of: Option<String>,
}
