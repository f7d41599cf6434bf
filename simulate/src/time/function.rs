//! A value over time: a mean, sines and a table together. Forces of load cases and accelerations of the ground are such functions.

use std::f64::consts::TAU;

use serde::{Serialize, Serializer};

/// Time steps that a period of a force must have at least.
///
/// Average acceleration replaces the frequency ω of a motion by 2/Δt·tan(ωΔt/2), so that a force moves a free
/// mass by the share (x/tan x)² of the right amplitude, x = ωΔt/2 = π/n with n steps per period. Twenty steps leave 0.984,
/// and the sampled force misses its peak by no more than 1 − cos x = 0.012; with ten it would be 0.934 and 0.049,
/// and with one step per period the force vanishes.
pub const LEAST_STEPS_PER_PERIOD: f64 = 20.0;

/// A force `constant + amplitude·sin(2π·frequency·t + phase)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HarmonicForce {
    /// Mean value, N (or N·m).
    pub constant: f64,
    /// Amplitude, N (or N·m).
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Phase, rad.
    pub phase: f64,
}

impl HarmonicForce {
    /// No force.
    pub const NONE: Self = Self { constant: 0.0, amplitude: 0.0, frequency: 0.0, phase: 0.0 };

    /// A constant force, N.
    pub fn constant(force: f64) -> Self {
        Self { constant: force, ..Self::NONE }
    }

    /// Value at time `t` in seconds.
    ///
    /// ```
    /// use railspring_simulate::time::function::HarmonicForce;
    /// let force = HarmonicForce { constant: 10.0, amplitude: 5.0, frequency: 10.0, phase: 0.0 };
    /// assert!((force.at(0.025) - 15.0).abs() < 1e-12);
    /// ```
    pub fn at(&self, t: f64) -> f64 {
        self.constant + self.amplitude * (TAU * self.frequency * t + self.phase).sin()
    }

    /// Whether it is other than zero at any time.
    fn acts(&self) -> bool {
        let swings = self.frequency != 0.0 || self.phase.sin() != 0.0;
        self.constant != 0.0 || (self.amplitude != 0.0 && swings)
    }
}

/// A sum of harmonics and of a table, which is linear between its rows.
///
/// ```
/// use railspring_simulate::time::function::{HarmonicForce, TimeFunction};
/// let sine = HarmonicForce { amplitude: 5.0, frequency: 10.0, ..HarmonicForce::constant(10.0) };
/// let force = TimeFunction { harmonics: vec![sine], table: vec![(0.0, 0.0), (0.1, 4.0)] };
/// assert!((force.at(0.025) - 16.0).abs() < 1e-12);
/// assert!((TimeFunction::from(sine).at(0.025) - 15.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TimeFunction {
    /// Means and sines.
    pub harmonics: Vec<HarmonicForce>,
    /// Times, s, ascending, with values; empty for none. Beyond its ends the table keeps its last value.
    pub table: Vec<(f64, f64)>,
}

/// A single harmonic as such: the keys of results that are kept do not change by the other forms.
impl Serialize for TimeFunction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match (&self.harmonics[..], &self.table[..]) {
            ([one], []) => one.serialize(serializer),
            parts => parts.serialize(serializer),
        }
    }
}

impl From<HarmonicForce> for TimeFunction {
    fn from(harmonic: HarmonicForce) -> Self {
        Self { harmonics: vec![harmonic], table: Vec::new() }
    }
}

impl TimeFunction {
    /// A constant value.
    pub fn constant(value: f64) -> Self {
        HarmonicForce::constant(value).into()
    }

    /// The function with so many times the values.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        for harmonic in &mut self.harmonics {
            harmonic.constant *= factor;
            harmonic.amplitude *= factor;
        }
        self.table.iter_mut().for_each(|(_, value)| *value *= factor);
        self
    }

    /// The value at `time`, s.
    pub fn at(&self, time: f64) -> f64 {
        self.harmonics.iter().map(|harmonic| harmonic.at(time)).sum::<f64>() + interpolated(&self.table, time)
    }

    /// The function as one mean and one sine; none of more sines and of a table.
    pub fn as_harmonic(&self) -> Option<HarmonicForce> {
        match self.harmonics[..] {
            _ if !self.table.is_empty() => None,
            [] => Some(HarmonicForce::NONE),
            [one] => Some(one),
            _ => None,
        }
    }

    /// Whether it is other than zero at any time.
    pub fn acts(&self) -> bool {
        self.harmonics.iter().any(HarmonicForce::acts) || self.table.iter().any(|(_, value)| *value != 0.0)
    }

    /// Bounds that it keeps within: all sines at their ends at the same time, with the ends of the table.
    pub fn bounds(&self) -> [f64; 2] {
        let values = self.table.iter().map(|(_, value)| *value);
        let ends = values.fold(None, |ends: Option<[f64; 2]>, value| {
            let [low, high] = ends.unwrap_or([value; 2]);
            Some([low.min(value), high.max(value)])
        });
        self.harmonics.iter().fold(ends.unwrap_or_default(), |[low, high], of| {
            [low + (of.constant - of.amplitude.abs()), high + (of.constant + of.amplitude.abs())]
        })
    }

    /// The largest size that it can have.
    pub fn largest(&self) -> f64 {
        let [low, high] = self.bounds();
        high.max(-low)
    }

    /// The highest frequency (Hz) with an amplitude that steps of `step` s do not resolve, if there is one.
    pub fn unresolved(&self, step: f64) -> Option<f64> {
        // A product of three factors may round up.
        let fast = |h: &&HarmonicForce| LEAST_STEPS_PER_PERIOD * h.frequency * step > 1.0 + 1e-12;
        let of = self.harmonics.iter().filter(|h| h.amplitude != 0.0).filter(fast).map(|h| h.frequency);
        of.max_by(f64::total_cmp)
    }

    /// A value of it that is no finite number, and a time of the table that does not come after the one before.
    pub fn mistake(&self) -> Option<String> {
        let of_harmonics =
            self.harmonics.iter().flat_map(|h| [h.constant, h.amplitude, h.frequency, h.phase]);
        let of_table = self.table.iter().flat_map(|(time, value)| [*time, *value]);
        let broken = of_harmonics.chain(of_table).find(|value| !value.is_finite());
        let falls = || self.table.windows(2).find(|pair| pair[1].0 <= pair[0].0);
        broken
            .map(|value| value.to_string())
            .or_else(|| falls().map(|pair| format!("{} s after {} s", pair[1].0, pair[0].0)))
    }
}

/// Linear between the rows of a table, constant beyond; 0 of none.
pub(crate) fn interpolated(table: &[(f64, f64)], at: f64) -> f64 {
    let after = table.partition_point(|(x, _)| *x <= at);
    match (after.checked_sub(1).map(|i| table[i]), table.get(after)) {
        (None, None) => 0.0,
        (None, Some(&(_, value))) | (Some((_, value)), None) => value,
        (Some((from, low)), Some(&(to, high))) => low + (high - low) * (at - from) / (to - from),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: sums of a mean, sines and a table that keeps its ends, and so many times them; their bounds; sines that steps do not resolve are named by their
    /// frequency (Hz); what is zero at all times, and values and times that are none. ROUNDOFF.
    #[test]
    fn a_time_function_is_the_sum_of_its_parts() {
        const ROUNDOFF: f64 = 1e-12;
        let sine =
            |amplitude: f64, frequency: f64| HarmonicForce { amplitude, frequency, ..HarmonicForce::NONE };
        let function = TimeFunction {
            harmonics: vec![HarmonicForce::constant(5.0), sine(2.0, 1.0), sine(0.0, 1e6)],
            table: vec![(1.0, 10.0), (2.0, 30.0)],
        };
        let twice = function.clone().scaled(-2.0);
        for (time, expected) in [(0.25, 17.0), (1.25, 22.0), (1.5, 25.0), (3.25, 37.0)] {
            assert!((function.at(time) - expected).abs() < ROUNDOFF * 40.0, "{time}: {}", function.at(time));
            assert!((twice.at(time) + 2.0 * expected).abs() < ROUNDOFF * 80.0, "{time}: {}", twice.at(time));
        }
        assert_eq!((function.unresolved(0.05), function.unresolved(0.06)), (None, Some(1.0)));
        assert_eq!(
            (function.bounds(), twice.bounds(), twice.largest()),
            ([13.0, 37.0], [-74.0, -26.0], 74.0)
        );
        assert_eq!(function.mistake(), None);
        let idle = TimeFunction { harmonics: vec![sine(3.0, 0.0)], table: vec![(0.0, 0.0), (1.0, 0.0)] };
        assert!(function.acts() && !idle.acts() && !TimeFunction::default().acts());
        assert_eq!(TimeFunction::default().bounds(), [0.0; 2]);
        let falls = TimeFunction { table: vec![(0.0, 1.0), (2.0, 1.0), (2.0, 3.0)], ..idle.clone() };
        assert_eq!(falls.mistake().unwrap(), "2 s after 2 s");
        assert_eq!(TimeFunction { table: vec![(0.0, f64::NAN)], ..idle }.mistake().unwrap(), "NaN");
    }
}
