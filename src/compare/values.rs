//! Two values of the same quantity, and whether they differ beyond their error bands.

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

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: values are rounded to their errors, those without an error have four digits, changes have two with their sign, and what is not known is a dash.
    #[test]
    fn texts_say_what_is_known() {
        let texts = |a: Option<Value>, b: Option<Value>| Compared::new("q", "mm", a, b).texts();
        let known = |value: f64, error: f64| Some(Value::with_error(value, error));
        assert_eq!(
            texts(known(1.2345, 0.012), known(1.3333, 0.1)),
            ["1.234 \u{b1} 0.012", "1.33 \u{b1} 0.10", "+8.0 %", "no"]
        );
        assert_eq!(texts(known(2.0, 0.1), known(1.0, 0.2))[2..], ["\u{2212}50 %", "yes"]);
        assert_eq!(texts(known(12.3456, 0.0), None), ["12.35", "none", "\u{2013}", "\u{2013}"]);
        // a change is none below six digits alone
        assert_eq!(texts(known(1.0, 0.0), known(1.000_01, 0.0))[2], "+0.0010 %");
        assert_eq!(texts(known(1.0, 0.0), known(1.000_004, 0.0))[2], "0 %");
    }

    /// Goal: a band is a share of its value's size; an error of 0 or that is no number is none; from 0 there is no change that is a number.
    #[test]
    fn errors_and_changes_are_numbers() {
        assert_eq!(Value::with_band(-2.0, Some(0.1)).error, Some(0.2));
        for error in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Value::with_error(3.0, error).error, None, "{error}");
        }
        let value = |value: f64| Some(Value::with_error(value, 0.1));
        assert_eq!(Compared::new("a", "1", value(0.0), value(1.0)).change, None);
        assert_eq!(Compared::new("a", "1", value(1.0), value(1.0)).without_answer().beyond, None);
    }
}
