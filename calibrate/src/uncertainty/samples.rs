//! Quasi-random samples of inputs, and what the answers to them say.

use super::distribution::Distribution;
use nalgebra::{DMatrix, DVector};

/// Least share of samples with an answer. A band of fewer would leave out those that have none.
const LEAST_ANSWERED: f64 = 0.95;

/// Departures of samples in standard uncertainties, `[sample][input]`: the first points of a scrambled Sobol sequence, the same in every run. Fewer
/// samples are the first of more.
///
/// ```
/// use railspring_calibrate::uncertainty::{Distribution, departures};
/// let [few, more] = [4, 8].map(|samples| departures(&[Distribution::Normal; 2], samples));
/// assert_eq!(few[..], more[..4]);
/// ```
pub fn departures(inputs: &[Distribution], samples: usize) -> Vec<Vec<f64>> {
    departures_of(inputs, &(0..samples).collect::<Vec<usize>>())
}

/// The same of samples with some numbers in the sequence. More inputs after these change nothing of their departures.
pub(super) fn departures_of(inputs: &[Distribution], numbers: &[usize]) -> Vec<Vec<f64>> {
    let of =
        |sample: usize| inputs.iter().enumerate().map(move |(i, of)| of.quantile(probability(sample, i)));
    numbers.iter().map(|sample| of(*sample).collect()).collect()
}

/// Coordinate of a point of the sequence, in the middle of what `f32` tells apart: never 0 nor 1.
fn probability(sample: usize, input: usize) -> f64 {
    const HALF_A_DIGIT: f64 = 1.0 / (1 << 25) as f64;
    f64::from(sobol_burley::sample(sample as u32, input as u32, 0)) + HALF_A_DIGIT
}

/// Whether so many of all samples have an answer that they make a band.
pub fn is_enough(answered: usize, all: usize) -> bool {
    all > 0 && answered as f64 >= LEAST_ANSWERED * all as f64
}

/// Value below which a share of all ascending values lies, between the two nearest; no number of no values.
pub fn percentile(values: &[f64], share: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return f64::NAN };
    let place = (share * values.len() as f64 - 0.5).clamp(0.0, last as f64);
    let (below, part) = (place as usize, place.fract());
    let above = (below + 1).min(last);
    values[below] + part * (values[above] - values[below])
}

/// First-order indices of the inputs from samples of an answer: the variance of its mean over all other inputs, by a polynomial of a `degree` in each input
/// that is fitted to all samples (as polynomial chaos without interactions, B. Sudret, *Reliab. Eng. Syst. Saf.* 93 (2008)). None where there are too few samples
/// for it. The departures are those of the same samples, of so many `inputs` each.
pub fn first_order_indices(
    departures: &[Vec<f64>],
    values: &[f64],
    (inputs, degree): (usize, usize),
) -> Option<Vec<f64>> {
    const SAMPLES_A_COEFFICIENT: usize = 4;
    let columns = 1 + degree * inputs;
    if values.len() < SAMPLES_A_COEFFICIENT * columns {
        return None;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let matrix = DMatrix::from_fn(values.len(), columns, |sample, column| match column.checked_sub(1) {
        None => 1.0,
        Some(term) => departures[sample][term / degree].powi((term % degree + 1) as i32),
    });
    let changes = DVector::from_iterator(values.len(), values.iter().map(|value| value - mean));
    let coefficients = matrix.clone().svd(true, true).solve(&changes, 1e-12).ok()?;
    let variance = changes.norm_squared();
    let of_input = |input: usize| -> f64 {
        let terms = 1 + degree * input..1 + degree * (input + 1);
        let part: Vec<f64> = (0..values.len())
            .map(|sample| terms.clone().map(|term| matrix[(sample, term)] * coefficients[term]).sum())
            .collect();
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        part.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / variance.max(f64::MIN_POSITIVE)
    };
    Some((0..inputs).map(of_input).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: y = 3·x₁ + 4·x₂ of two normal inputs: indices 9/25 and 16/25. Goal: a straight line finds them, and too few samples have none. Accuracy: what 128
    /// points of the sequence leave of a variance.
    #[test]
    fn straight_answers_have_their_indices() {
        const STATISTICS: f64 = 0.02;
        let departures = departures(&[Distribution::Normal; 2], 128);
        let values: Vec<f64> = departures.iter().map(|at| 7.0 + 3.0 * at[0] + 4.0 * at[1]).collect();
        for degree in [1, 2] {
            let found = first_order_indices(&departures, &values, (2, degree)).unwrap();
            assert!(
                (found[0] - 0.36).abs() < STATISTICS && (found[1] - 0.64).abs() < STATISTICS,
                "{found:?}"
            );
        }
        assert!(first_order_indices(&departures[..11], &values[..11], (2, 1)).is_none());
        assert!(first_order_indices(&departures[..12], &values[..12], (2, 1)).is_some());
    }

    /// Goal: percentiles lie between the two nearest values, each at the middle of its share, and never beyond the ends; no values have none.
    #[test]
    fn percentiles_lie_between_values() {
        let values = [1.0, 2.0, 4.0, 8.0];
        assert_eq!([0.0, 0.125, 0.25, 0.5, 1.0].map(|at| percentile(&values, at)), [1.0, 1.0, 1.5, 3.0, 8.0]);
        assert!(percentile(&[], 0.5).is_nan());
    }
}
