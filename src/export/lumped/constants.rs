//! Constants as lines of Python, each with its unit and meaning.

use std::fmt::Write as _;

/// Digits of a constant: beyond them the difference to the program's own run is rounding.
const DIGITS: usize = 10;

/// ROUNDOFF: a number that is smaller beside the largest of its kind is what rounding leaves.
const ROUNDING: f64 = 1e-10;

/// Lines of a block of constants.
#[derive(Default)]
pub(super) struct Constants(String);

impl Constants {
    /// A comment of its own.
    pub fn about(&mut self, text: &str) {
        let _ = writeln!(self.0, "# {text}");
    }

    /// A number.
    pub fn number(&mut self, name: &str, value: f64, meaning: &str) {
        let _ = writeln!(self.0, "{name} = {}  # {meaning}", literal(value));
    }

    /// A whole number.
    pub fn count(&mut self, name: &str, value: usize, meaning: &str) {
        let _ = writeln!(self.0, "{name} = {value}  # {meaning}");
    }

    /// Several numbers; those that are nothing beside the largest are zero.
    pub fn numbers(&mut self, name: &str, values: impl IntoIterator<Item = f64>, meaning: &str) {
        let values: Vec<f64> = values.into_iter().collect();
        let least = ROUNDING * values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let values = values.iter().map(|&value| literal(if value.abs() < least { 0.0 } else { value }));
        let values: Vec<String> = values.collect();
        let _ = writeln!(self.0, "{name} = [{}]  # {meaning}", values.join(", "));
    }

    /// The lines.
    pub fn text(&self) -> &str {
        &self.0
    }
}

/// The shortest literal with [`DIGITS`] digits.
pub(super) fn literal(value: f64) -> String {
    let rounded: f64 = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
    // without the sign of a zero
    format!("{:?}", rounded + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: what is written reads back with ten digits, units and meaning in a comment behind it; zero has no sign.
    #[test]
    fn literals_are_short() {
        let mut constants = Constants::default();
        constants.about("Wheel");
        constants.number("MASS", 309.567_056_138_764_54, "kg");
        constants.numbers("HZ", [-0.0, 6.366_197_723_675_814e-6, 1e-17], "Hz");
        constants.count("ROWS", 550, "rows");
        let expected =
            "# Wheel\nMASS = 309.5670561  # kg\nHZ = [0.0, 6.366197724e-6, 0.0]  # Hz\nROWS = 550  # rows\n";
        assert_eq!(constants.text(), expected);
    }
}
