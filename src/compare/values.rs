//! Two values of the same quantity, and whether they differ beyond what they are worth.

use serde::Serialize;

use crate::rounding::{rounded_to, significant};

/// A value with what it is known to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Value {
    pub value: f64,
    /// Half the width of its band, in its unit; none where it has none.
    pub error: Option<f64>,
}

impl Value {
    /// A value with a relative band.
    pub fn with_band(value: f64, band: Option<f64>) -> Self {
        Self { value, error: band.map(|band| (band * value).abs()) }
    }

    /// A value with the standard error of a fit, which is 0 where there is none.
    pub fn with_error(value: f64, error: f64) -> Self {
        Self { value, error: Some(error).filter(|error| *error > 0.0 && error.is_finite()) }
    }
}

/// A quantity of both results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compared {
    /// The quantity in words.
    pub quantity: String,
    /// Its unit; `1` for ratios.
    pub unit: String,
    /// Its value in A.
    pub a: Option<f64>,
    /// Half the width of A's error band, or A's standard error, in the unit.
    pub a_error: Option<f64>,
    /// Its value in B.
    pub b: Option<f64>,
    /// See `a_error`.
    pub b_error: Option<f64>,
    /// B over A less 1; none where one is missing or A is 0.
    pub change: Option<f64>,
    /// Whether the two bands do not touch; none where one is missing, and for constants of a law, which trade against each other.
    pub beyond: Option<bool>,
}

impl Compared {
    /// Two values with error bands.
    pub(super) fn new(quantity: impl Into<String>, unit: &str, a: Option<Value>, b: Option<Value>) -> Self {
        let beyond = a.zip(b).and_then(|(a, b)| Some((a.value - b.value).abs() > a.error? + b.error?));
        let change = a.zip(b).map(|(a, b)| b.value / a.value - 1.0).filter(|change| change.is_finite());
        Self {
            quantity: quantity.into(),
            unit: unit.into(),
            a: a.map(|a| a.value),
            a_error: a.and_then(|a| a.error),
            b: b.map(|b| b.value),
            b_error: b.and_then(|b| b.error),
            change,
            beyond,
        }
    }

    /// The same where the errors of both do not say whether they differ.
    pub(super) fn without_answer(self) -> Self {
        Self { beyond: None, ..self }
    }

    /// Value of A, value of B, change, and whether it is beyond the bands, for a reader.
    pub fn texts(&self) -> [String; 4] {
        let value = |value: Option<f64>, error: Option<f64>| match (value, error) {
            (None, _) => "none".to_string(),
            (Some(value), None) => significant(value, 4),
            (Some(value), Some(error)) => match rounded_to(value, error) {
                (value, Some(error)) => format!("{value} \u{b1} {error}"),
                (value, None) => value,
            },
        };
        let change = match self.change {
            None => "\u{2013}".into(),
            Some(change) if change.abs() < 5e-6 => "0 %".into(),
            Some(change) => {
                let text = significant(1e2 * change.abs(), 2);
                format!("{}{text} %", if change < 0.0 { "\u{2212}" } else { "+" })
            }
        };
        let beyond = match self.beyond {
            None => "\u{2013}",
            Some(true) => "yes",
            Some(false) => "no",
        };
        [value(self.a, self.a_error), value(self.b, self.b_error), change, beyond.into()]
    }
}
