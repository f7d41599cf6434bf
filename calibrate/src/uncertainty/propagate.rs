//! Departures of inputs through a model, to first order and by quasi-random samples.

use super::distribution::Distribution;
use super::samples::{departures, first_order_indices, is_enough, percentile};
use railspring_profiles::error::{Result, unless_interrupted};
use railspring_profiles::monitor::Monitor;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Degree of the polynomials in each input, by which first-order indices are found from the samples.
const DEGREE: usize = 2;

/// An input of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Input {
    /// How it departs.
    pub distribution: Distribution,
    /// Whether samples depart in it through the model; its change to first order is added to theirs otherwise.
    pub sampled: bool,
}

/// The uncertainty of a model's answers. All changes are those of their logarithms, which are relative changes where they are small.
#[derive(Debug, Clone, PartialEq)]
pub struct Propagated {
    /// Change of each answer over one standard uncertainty of each input, `[input][answer]`: half the difference between one up and one down.
    pub linear: Vec<Vec<f64>>,
    /// Departures of the samples with an answer in standard uncertainties, `[sample][input]`.
    pub departures: Vec<Vec<f64>>,
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
    if samples == 0 {
        return Ok(Propagated { linear, departures: Vec::new(), changes: Vec::new(), failed: 0 });
    }
    let nominal = logarithms(&vec![0.0; inputs.len()], false)?;
    let distributions: Vec<Distribution> = inputs.iter().map(|input| input.distribution).collect();
    let found: Vec<Option<(Vec<f64>, Vec<f64>)>> = departures(&distributions, samples)
        .into_par_iter()
        .map(|departures| {
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
            Ok(Some((departures, changes)))
        })
        .collect::<Result<_>>()?;
    monitor.progress(stage, total, total)?;
    let (departures, changes): (Vec<_>, Vec<_>) = found.into_iter().flatten().unzip();
    let failed = samples - changes.len();
    Ok(Propagated { linear, departures, changes, failed })
}

impl Propagated {
    /// Whether so many samples have an answer that they make a band.
    pub fn is_enough(&self) -> bool {
        is_enough(self.changes.len(), self.changes.len() + self.failed)
    }

    /// The band of an answer.
    pub fn band(&self, answer: usize) -> Band {
        let of_input: Vec<f64> = self.linear.iter().map(|of| of[answer]).collect();
        let variance: f64 = of_input.iter().map(|change| change * change).sum();
        let linear = variance.sqrt();
        let to_first_order = || of_input.iter().map(|c| c * c / variance.max(f64::MIN_POSITIVE)).collect();
        if !self.is_enough() || self.changes.first().is_none_or(|of| answer >= of.len()) {
            return Band { linear, sampled: None, percentiles: None, shares: to_first_order() };
        }
        let changes: Vec<f64> = self.changes.iter().map(|of| of[answer]).collect();
        let count = changes.len() as f64;
        let mean = changes.iter().sum::<f64>() / count;
        let sampled = (changes.iter().map(|change| (change - mean).powi(2)).sum::<f64>()
            / (count - 1.0).max(1.0))
        .sqrt();
        let mut ascending = changes.clone();
        ascending.sort_unstable_by(f64::total_cmp);
        let percentiles = Some([0.025, 0.975].map(|at| percentile(&ascending, at).exp_m1()));
        let inputs = (self.linear.len(), DEGREE);
        let shares = first_order_indices(&self.departures, &changes, inputs).unwrap_or_else(to_first_order);
        Band { linear, sampled: Some(sampled), percentiles, shares }
    }
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
            let band = found.band(0);
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
        let band = propagate(&inputs, 500, curved, ("", &Silent)).unwrap().band(0);
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
        assert!(!found.is_enough() && found.band(0).percentiles.is_none());
        let found = propagate(&inputs, 400, ends(2.2), ("", &Silent)).unwrap();
        assert!(found.failed > 0 && found.is_enough(), "{}", found.failed);
        assert!(propagate(&inputs, 10, ends(0.5), ("", &Silent)).is_err());
    }
}
