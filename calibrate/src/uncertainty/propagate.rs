//! Departures of inputs through a model, to first order and by quasi-random samples.

use super::distribution::Distribution;
use super::samples::{departures, departures_of, first_order_indices, is_enough, percentile};
use railspring_profiles::error::{Result, unless_interrupted};
use railspring_profiles::monitor::Monitor;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Degree of the polynomials in each input, by which first-order indices are found from the samples.
const DEGREE: usize = 2;
/// Points of the sequence for percentiles to first order, which cost nothing.
const POINTS: usize = 2048;
/// Ends of a band of 95 %.
const ENDS: [f64; 2] = [0.025, 0.975];

/// An input of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Input {
    /// How it departs.
    pub distribution: Distribution,
    /// Whether samples depart in it through the model; its change to first order is added to theirs otherwise.
    pub sampled: bool,
}

/// An input that is known by what it changes of an answer alone, independent of the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// How it departs.
    pub distribution: Distribution,
    /// Change of the answer's logarithm at one standard uncertainty down and at one up; in proportion between and beyond.
    pub changes: [f64; 2],
}

impl Effect {
    /// Change of the answer's logarithm at a departure, in standard uncertainties.
    fn at(&self, departure: f64) -> f64 {
        let [down, up] = self.changes;
        if departure < 0.0 { -departure * down } else { departure * up }
    }

    /// Change over one standard uncertainty: half the difference between one up and one down.
    pub fn linear(&self) -> f64 {
        let [down, up] = self.changes;
        0.5 * (up - down)
    }
}

/// The uncertainty of a model's answers. All changes are those of their logarithms, which are relative changes where they are small.
#[derive(Debug, Clone, PartialEq)]
pub struct Propagated {
    /// How the inputs depart.
    pub distributions: Vec<Distribution>,
    /// Change of each answer over one standard uncertainty of each input, `[input][answer]`: half the difference between one up and one down.
    pub linear: Vec<Vec<f64>>,
    /// Numbers of the samples with an answer in the sequence.
    pub numbers: Vec<usize>,
    /// Changes of their answers, `[sample][answer]`.
    pub changes: Vec<Vec<f64>>,
    /// Samples without an answer.
    pub failed: usize,
}

/// The band of an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Standard uncertainty to first order, of the logarithm.
    pub linear: f64,
    /// Standard deviation of the samples, of the logarithm; none without enough samples that have the answer.
    pub sampled: Option<f64>,
    /// Change at the 2.5 and at the 97.5 percentile of the samples, relative; likewise.
    pub percentiles: Option<[f64; 2]>,
    /// Half width of the band of 95 %, relative: half the way between the percentiles; without those, between the same ones to first order.
    pub half_width: f64,
    /// First-order index of each input: its share of the variance. From the samples where there are enough of them.
    pub shares: Vec<f64>,
}

/// Departures of `inputs` through a model, whose answers `evaluate` gives for departures in standard uncertainties. Answers are positive. Its
/// flag is set where one input alone departs; it may then append answers to those that samples have.
/// `samples` points of a scrambled Sobol sequence are taken. A sample without an answer is counted; the result does not depend on the threads.
///
/// # Errors
/// An interruption, and an input without an answer one standard uncertainty up or down.
pub fn propagate(
    inputs: &[Input],
    samples: usize,
    evaluate: impl Fn(&[f64], bool) -> Result<Vec<f64>> + Sync,
    (stage, monitor): (&str, &dyn Monitor),
) -> Result<Propagated> {
    let total = 2 * inputs.len() + samples + 1;
    let done = AtomicUsize::new(0);
    let logarithms = |departures: &[f64], alone: bool| -> Result<Vec<f64>> {
        monitor.progress(stage, done.fetch_add(1, Ordering::Relaxed), total)?;
        Ok(evaluate(departures, alone)?.into_iter().map(f64::ln).collect())
    };
    let alone = |input: usize, departure: f64| {
        let mut departures = vec![0.0; inputs.len()];
        departures[input] = departure;
        logarithms(&departures, true)
    };
    let linear: Vec<Vec<f64>> = (0..inputs.len())
        .into_par_iter()
        .map(|input| {
            let (down, up) = (alone(input, -1.0)?, alone(input, 1.0)?);
            Ok(up.iter().zip(&down).map(|(up, down)| 0.5 * (up - down)).collect())
        })
        .collect::<Result<_>>()?;
    let distributions: Vec<Distribution> = inputs.iter().map(|input| input.distribution).collect();
    let (numbers, changes) = (Vec::new(), Vec::new());
    let mut propagated = Propagated { distributions, linear, numbers, changes, failed: 0 };
    if samples == 0 {
        return Ok(propagated);
    }
    let nominal = logarithms(&vec![0.0; inputs.len()], false)?;
    let linear = &propagated.linear;
    let found: Vec<Option<(usize, Vec<f64>)>> = departures(&propagated.distributions, samples)
        .into_par_iter()
        .enumerate()
        .map(|(number, departures)| {
            let through: Vec<f64> = departures
                .iter()
                .zip(inputs)
                .map(|(departure, input)| if input.sampled { *departure } else { 0.0 })
                .collect();
            let Ok(answers) = unless_interrupted(logarithms(&through, false))? else { return Ok(None) };
            let added = |answer: usize| -> f64 {
                (0..inputs.len())
                    .filter(|&i| !inputs[i].sampled)
                    .map(|i| linear[i][answer] * departures[i])
                    .sum()
            };
            let changes =
                (0..answers.len()).map(|answer| answers[answer] - nominal[answer] + added(answer)).collect();
            Ok(Some((number, changes)))
        })
        .collect::<Result<_>>()?;
    monitor.progress(stage, total, total)?;
    (propagated.numbers, propagated.changes) = found.into_iter().flatten().unzip();
    propagated.failed = samples - propagated.numbers.len();
    Ok(propagated)
}

impl Propagated {
    /// Whether so many samples have an answer that they make a band.
    pub fn is_enough(&self) -> bool {
        is_enough(self.changes.len(), self.changes.len() + self.failed)
    }

    /// The band of an answer by the inputs and by those `beside` them, whose shares come last.
    pub fn band(&self, answer: usize, beside: &[Effect]) -> Band {
        let of_input: Vec<f64> =
            self.linear.iter().map(|of| of[answer]).chain(beside.iter().map(Effect::linear)).collect();
        let variance: f64 = of_input.iter().map(|change| change * change).sum();
        let linear = variance.sqrt();
        let to_first_order = || of_input.iter().map(|c| c * c / variance.max(f64::MIN_POSITIVE)).collect();
        let all: Vec<Distribution> =
            self.distributions.iter().copied().chain(beside.iter().map(|of| of.distribution)).collect();
        let inputs = self.linear.len();
        let effects = |departures: &[f64]| -> f64 {
            beside.iter().zip(&departures[inputs..]).map(|(of, departure)| of.at(*departure)).sum()
        };
        if !self.is_enough() || self.changes.first().is_none_or(|of| answer >= of.len()) {
            let change = |departures: &Vec<f64>| {
                let of_inputs: f64 = of_input[..inputs].iter().zip(departures).map(|(c, d)| c * d).sum();
                of_inputs + effects(departures)
            };
            let changes = departures(&all, POINTS).iter().map(change).collect();
            let half_width = half_width(ends(changes));
            return Band { linear, sampled: None, percentiles: None, half_width, shares: to_first_order() };
        }
        let departures = departures_of(&all, &self.numbers);
        let changes: Vec<f64> =
            self.changes.iter().zip(&departures).map(|(of, at)| of[answer] + effects(at)).collect();
        let count = changes.len() as f64;
        let mean = changes.iter().sum::<f64>() / count;
        let sampled = (changes.iter().map(|change| (change - mean).powi(2)).sum::<f64>()
            / (count - 1.0).max(1.0))
        .sqrt();
        let shares =
            first_order_indices(&departures, &changes, (all.len(), DEGREE)).unwrap_or_else(to_first_order);
        let percentiles = ends(changes);
        let half_width = half_width(percentiles);
        Band { linear, sampled: Some(sampled), percentiles: Some(percentiles), half_width, shares }
    }
}

/// Relative changes at the ends of the band of 95 % of changes of a logarithm.
fn ends(mut changes: Vec<f64>) -> [f64; 2] {
    changes.sort_unstable_by(f64::total_cmp);
    ENDS.map(|at| percentile(&changes, at).exp_m1())
}

fn half_width([low, high]: [f64; 2]) -> f64 {
    0.5 * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uncertainty::normal_quantile;
    use railspring_profiles::error::InputError;
    use railspring_profiles::monitor::Silent;

    fn inputs(distribution: Distribution, sampled: &[bool]) -> Vec<Input> {
        sampled.iter().map(|&sampled| Input { distribution, sampled }).collect()
    }

    /// Source: Hertz, δ = (9 F² / (16 R E*²))^(1/3), with lognormal F, R and E*: the logarithm of δ is normal, and its first-order indices are
    /// (exponent · standard deviation)² over their sum; the percentiles are those of the lognormal distribution. Goal: from 500 samples the indices to 1 %, the
    /// band to what 500 points of the sequence leave of a quantile; the linear result is exact. With an input that is added to first order, the same.
    #[test]
    fn a_hertz_contact_has_its_sobol_indices() {
        const INDEX: f64 = 0.01;
        const QUANTILE: f64 = 0.05;
        const ROUNDOFF: f64 = 1e-12;
        let powers = [2.0 / 3.0, -1.0 / 3.0, -2.0 / 3.0];
        let deviations = [0.05, 0.2, 0.03];
        let hertz = |z: &[f64], _: bool| {
            let value = |i: usize| (deviations[i] * z[i]).exp();
            Ok(vec![(9.0 / 16.0 * value(0).powi(2) / value(1) / value(2).powi(2)).cbrt()])
        };
        let parts: Vec<f64> = powers.iter().zip(&deviations).map(|(p, s)| (p * s).powi(2)).collect();
        let variance: f64 = parts.iter().sum();
        for sampled in [[true, true, true], [true, false, true]] {
            let inputs = inputs(Distribution::Normal, &sampled);
            let found = propagate(&inputs, 500, hertz, ("", &Silent)).unwrap();
            let band = found.band(0, &[]);
            for (share, part) in band.shares.iter().zip(&parts) {
                assert!((share - part / variance).abs() < INDEX, "{:?}", band.shares);
            }
            assert!((band.linear / variance.sqrt() - 1.0).abs() < ROUNDOFF);
            let [low, high] = band.percentiles.unwrap();
            let expected = normal_quantile(0.975) * variance.sqrt();
            assert!((low.ln_1p() / -expected - 1.0).abs() < QUANTILE, "{low}");
            assert!((high.ln_1p() / expected - 1.0).abs() < QUANTILE, "{high}");
            // the same bytes whatever the threads
            let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            let again = one.install(|| propagate(&inputs, 500, hertz, ("", &Silent)).unwrap());
            assert!(again == found);
        }
    }

    /// Source: y = 1 + x²/10 of a rectangular x: no change to first order, and the variance of x² alone, 4/45 · (3)². Goal: samples see what the first order does
    /// not. Accuracy: 1 % of 500 points.
    #[test]
    fn samples_see_a_curved_answer() {
        const STATISTICS: f64 = 0.01;
        let inputs = inputs(Distribution::Rectangular, &[true]);
        let curved = |z: &[f64], _: bool| Ok(vec![(0.1 * z[0] * z[0]).exp()]);
        let band = propagate(&inputs, 500, curved, ("", &Silent)).unwrap().band(0, &[]);
        assert!(band.linear < 1e-15, "{}", band.linear);
        let expected = 0.1 * 3.0 * (4.0_f64 / 45.0).sqrt();
        assert!((band.sampled.unwrap() / expected - 1.0).abs() < STATISTICS, "{band:?}");
        assert!((band.shares[0] - 1.0).abs() < STATISTICS, "{band:?}");
    }

    /// Goal: samples without an answer are counted, and more than 5 % of them leave no band; an input without an answer at its standard uncertainty is
    /// an error.
    #[test]
    fn samples_without_an_answer_are_counted() {
        let inputs = inputs(Distribution::Normal, &[true]);
        let ends = |limit: f64| {
            move |z: &[f64], _: bool| {
                if z[0] > limit {
                    InputError::refuse("input", z[0], "less", "none").map(|()| vec![1.0])
                } else {
                    Ok(vec![1.0])
                }
            }
        };
        let found = propagate(&inputs, 400, ends(1.3), ("", &Silent)).unwrap();
        // 9.7 % of a normal distribution lie beyond 1.3
        assert!((37..=41).contains(&found.failed), "{}", found.failed);
        assert!(!found.is_enough() && found.band(0, &[]).percentiles.is_none());
        let found = propagate(&inputs, 400, ends(2.2), ("", &Silent)).unwrap();
        assert!(found.failed > 0 && found.is_enough(), "{}", found.failed);
        assert!(propagate(&inputs, 10, ends(0.5), ("", &Silent)).is_err());
    }
    /// Source: a rectangular input of a half width h (of the logarithm) beside a normal one of a hundredth of it: 2.5 and 97.5 % lie at 0.95 h, whatever twice
    /// the standard uncertainty says (1.155 h, beyond its limits). One that goes further up than down has its ends there. Goal: the same from samples
    /// and to first order. Accuracy: what the points leave of a quantile.
    #[test]
    fn a_rectangular_input_has_its_own_band() {
        const QUANTILE: f64 = 0.02;
        let half = 0.5_f64;
        let unit = half / 3.0_f64.sqrt();
        let model = |z: &[f64], _: bool| Ok(vec![(0.01 * unit * z[0]).exp()]);
        let inputs = inputs(Distribution::Normal, &[true]);
        for samples in [0, 500] {
            let found = propagate(&inputs, samples, model, ("", &Silent)).unwrap();
            for [down, up] in [[-1.0, 1.0], [-0.2, 1.0]] {
                let effect =
                    Effect { distribution: Distribution::Rectangular, changes: [down * unit, up * unit] };
                let band = found.band(0, &[effect]);
                let ends = [0.95 * half * down, 0.95 * half * up].map(f64::exp_m1);
                let expected = 0.5 * (ends[1] - ends[0]);
                assert!((band.half_width / expected - 1.0).abs() < QUANTILE, "{samples}: {band:?}");
                assert!(band.shares[1] > 0.99, "{band:?}");
            }
        }
    }
}
