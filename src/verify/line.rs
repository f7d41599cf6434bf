//! A line of the verdict: a value, its limit, and whether it holds.

use serde::{Deserialize, Serialize};

/// What a line of the verdict can prove.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The program agrees with itself.
    Consistency,
    /// The simple model agrees with an independent model of the same physics.
    Verification,
    /// The result agrees with one that another program printed.
    CrossCode,
}

/// One line of the verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Whether the value is within the limit; a line without a value does not hold.
    pub holds: bool,
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
        Line {
            quantity: self.quantity.into(),
            meaning: self.meaning.into(),
            kind: self.kind,
            unit: self.unit.into(),
            value: value.filter(|value| value.is_finite()).map(rounded),
            limit: self.limit,
            holds: value.is_some_and(|value| value.is_finite() && value <= self.limit),
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

    /// Value over limit, by which failing lines are ranked; infinite without a value and over a limit of zero.
    pub fn excess(&self) -> f64 {
        match self.value {
            Some(value) if self.limit > 0.0 => value / self.limit,
            Some(value) if value <= self.limit => 0.0,
            _ => f64::INFINITY,
        }
    }
}

/// A comparison that cannot be made, and why; it counts neither as holding nor as failing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NotApplicable {
    /// Name of the quantity.
    pub quantity: String,
    /// What would be compared, in words.
    pub meaning: String,
    /// Why it cannot be compared.
    pub reason: String,
}

/// Six significant digits: more would be noise of the arithmetic.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
