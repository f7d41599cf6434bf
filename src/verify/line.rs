//! A line of the verdict: a value, its limit, and whether it holds.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a line of the verdict can prove.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The program agrees with itself.
    Consistency,
    /// The simple model agrees with an independent model of the same physics.
    Verification,
    /// The result agrees with one that another program printed.
    CrossCode,
    /// The result keeps a limit that the user has set.
    Acceptance,
}

/// What a line holds by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HeldBy {
    /// The value is within the limit.
    Limit,
    /// The value is above the limit, and no more than the numerical uncertainty of the solid model.
    #[serde(alias = "solid-worth")]
    SolidUncertainty,
}

/// One line of the verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Line {
    /// Name of the quantity, the same as the key of its limit if it has one.
    pub quantity: String,
    /// What is compared, in words.
    pub meaning: String,
    /// What the line can prove.
    pub kind: Kind,
    /// Unit of value and limit; `1` for ratios.
    pub unit: String,
    /// The value; `None` where it is unknown or not a number, and such a line fails.
    pub value: Option<f64>,
    /// The limit.
    pub limit: f64,
    /// The same difference between two runs of the solid model: with other steps, and with an input that is 0.1 % larger; where it is known.
    #[serde(default, alias = "solid_worth", skip_serializing_if = "Option::is_none")]
    pub solid_uncertainty: Option<f64>,
    /// The same of the simple model, which the line does not depend on.
    #[serde(default, alias = "simple_worth", skip_serializing_if = "Option::is_none")]
    pub simple_uncertainty: Option<f64>,
    /// Begin and end of the time over which the value was taken, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over_s: Option<[f64; 2]>,
    /// Whether the value is within the limit, or no more than the numerical uncertainty of the solid; a line without a value does not hold.
    pub holds: bool,
    /// Which of the two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_by: Option<HeldBy>,
    /// What else has to be known about the value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// What a line of the verdict checks, before there is a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// Name of the quantity, the same as the key of its limit if it has one.
    pub quantity: &'static str,
    /// What is compared, in words.
    pub meaning: &'static str,
    /// What the line can prove.
    pub kind: Kind,
    /// Unit of value and limit; `1` for ratios.
    pub unit: &'static str,
    /// The limit.
    pub limit: f64,
}

impl Criterion {
    /// The line, which holds if it has a value, and the value is within the limit.
    pub fn line(&self, value: Option<f64>) -> Line {
        self.line_beside(value, [None; 2])
    }

    /// The line beside the uncertainty of simple and solid model; it also holds if the value is no more than that of the solid.
    pub fn line_beside(&self, value: Option<f64>, uncertainty: [Option<f64>; 2]) -> Line {
        let value = value.filter(|value| value.is_finite());
        let [simple, solid] =
            uncertainty.map(|uncertainty| uncertainty.filter(|uncertainty| uncertainty.is_finite()));
        let held_by = match value {
            Some(value) if value <= self.limit => Some(HeldBy::Limit),
            Some(value) if solid.is_some_and(|uncertainty| value <= uncertainty) => {
                Some(HeldBy::SolidUncertainty)
            }
            _ => None,
        };
        Line {
            quantity: self.quantity.into(),
            meaning: self.meaning.into(),
            kind: self.kind,
            unit: self.unit.into(),
            value: value.map(rounded),
            limit: self.limit,
            solid_uncertainty: solid.map(rounded),
            simple_uncertainty: simple.map(rounded),
            over_s: None,
            holds: held_by.is_some(),
            held_by,
            note: None,
        }
    }

    /// That the comparison cannot be made, and why.
    pub fn not_applicable(&self, reason: &str) -> NotApplicable {
        NotApplicable { quantity: self.quantity.into(), meaning: self.meaning.into(), reason: reason.into() }
    }
}

impl Line {
    /// The same line with a note.
    pub fn noted(self, note: impl Into<String>) -> Self {
        Self { note: Some(note.into()), ..self }
    }

    /// The time over which the value was taken, in words.
    pub fn over(&self) -> Option<String> {
        self.over_s.map(|[begin, end]| {
            format!("{} to {}", milliseconds(begin).trim_end_matches(" ms"), milliseconds(end))
        })
    }

    /// The same line with the time over which its value was taken, s.
    pub fn taken_over(self, times: [f64; 2]) -> Self {
        Self { over_s: Some(times.map(rounded)), ..self }
    }

    /// The limit, or the uncertainty of the solid if that is more.
    pub fn allowed(&self) -> f64 {
        self.solid_uncertainty.map_or(self.limit, |uncertainty| uncertainty.max(self.limit))
    }

    /// Value over what is allowed, by which failing lines are ranked; infinite without a value and over zero.
    pub fn excess(&self) -> f64 {
        let allowed = self.allowed();
        match self.value {
            Some(value) if allowed > 0.0 => value / allowed,
            Some(value) if value <= allowed => 0.0,
            _ => f64::INFINITY,
        }
    }
}

/// A comparison that cannot be made, and why; it counts neither as holding nor as failing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NotApplicable {
    /// Name of the quantity.
    pub quantity: String,
    /// What would be compared, in words.
    pub meaning: String,
    /// Why it cannot be compared.
    pub reason: String,
}

/// A check of the verdict: a line, or why the comparison cannot be made.
pub(super) type Check = Result<Line, NotApplicable>;

/// A time (s) in milliseconds, to the microsecond, as text.
pub(super) fn milliseconds(time: f64) -> String {
    format!("{} ms", (time * 1e6).round() / 1e3)
}

/// Six significant digits: more would be noise of the arithmetic.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
