//! A value over time: a mean, harmonics and a table together.

use crate::time::scenario::{HarmonicForce, LEAST_STEPS_PER_PERIOD};

/// A sum of harmonics and of a table, which is linear between its rows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TimeFunction {
    /// Means and sines.
    pub harmonics: Vec<HarmonicForce>,
    /// Times, s, ascending, with values; empty for none. Beyond its ends the table keeps its last value.
    pub table: Vec<(f64, f64)>,
}

impl TimeFunction {
    /// A constant value.
    pub fn constant(value: f64) -> Self {
        Self { harmonics: vec![HarmonicForce::constant(value)], table: Vec::new() }
    }

    /// The function with the opposite values.
    #[must_use]
    pub fn negated(mut self) -> Self {
        for harmonic in &mut self.harmonics {
            (harmonic.constant, harmonic.amplitude) = (-harmonic.constant, -harmonic.amplitude);
        }
        self.table.iter_mut().for_each(|(_, value)| *value = -*value);
        self
    }

    /// The value at `time`, s.
    pub fn at(&self, time: f64) -> f64 {
        self.harmonics.iter().map(|harmonic| harmonic.at(time)).sum::<f64>() + interpolated(&self.table, time)
    }

    /// The highest frequency (Hz) with an amplitude that steps of `step` s do not resolve, if there is one.
    pub fn unresolved(&self, step: f64) -> Option<f64> {
        let fast = |h: &&HarmonicForce| LEAST_STEPS_PER_PERIOD * h.frequency * step > 1.0 + 1e-12;
        let of = self.harmonics.iter().filter(|h| h.amplitude != 0.0).filter(fast).map(|h| h.frequency);
        of.max_by(f64::total_cmp)
    }
}

/// Linear between the rows of a table, constant beyond; 0 of none.
pub(super) fn interpolated(table: &[(f64, f64)], at: f64) -> f64 {
    let after = table.partition_point(|(x, _)| *x <= at);
    match (after.checked_sub(1).map(|i| table[i]), table.get(after)) {
        (None, None) => 0.0,
        (None, Some(&(_, value))) | (Some((_, value)), None) => value,
        (Some((from, low)), Some(&(to, high))) => low + (high - low) * (at - from) / (to - from),
    }
}
