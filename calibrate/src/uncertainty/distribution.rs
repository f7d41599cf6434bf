//! How an input may depart from its value.

use railspring_profiles::root::bracketed_newton;
use std::f64::consts::{PI, SQRT_2};

/// Farthest quantile of a normal distribution, in standard deviations: `f64` has no probability beyond it.
const FARTHEST: f64 = 8.0;

/// A distribution about the value of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Distribution {
    /// Normal: of a measured value.
    #[default]
    Normal,
    /// Rectangular: of a value of which only the limits are known. Its half width is √3 of its standard uncertainty.
    Rectangular,
}

impl Distribution {
    /// Departure at a probability between 0 and 1, in standard uncertainties.
    ///
    /// ```
    /// use railspring_calibrate::uncertainty::Distribution;
    /// assert!((Distribution::Normal.quantile(0.975) - 1.959964).abs() < 1e-6);
    /// assert!((Distribution::Rectangular.quantile(0.75) - 0.75_f64.sqrt()).abs() < 1e-15);
    /// ```
    pub fn quantile(self, probability: f64) -> f64 {
        match self {
            Self::Normal => normal_quantile(probability),
            Self::Rectangular => 3.0_f64.sqrt() * (2.0 * probability - 1.0),
        }
    }
}

/// Quantile of the standard normal distribution.
pub fn normal_quantile(probability: f64) -> f64 {
    let excess = |x: f64| {
        let below = 0.5 * libm::erfc(-x / SQRT_2);
        (below - probability, (-0.5 * x * x).exp() / (2.0 * PI).sqrt())
    };
    bracketed_newton(excess, -FARTHEST, FARTHEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: quantiles of the normal distribution (M. Abramowitz, I. Stegun, table 26.5), and its symmetry. Goal: the same. Accuracy: the ten digits of
    /// the table.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        const DIGITS: f64 = 1e-9;
        for (probability, expected) in
            [(0.5, 0.0), (0.9, 1.281_551_565_5), (0.995, 2.575_829_303_5), (0.999_5, 3.290_526_731_5)]
        {
            for (probability, expected) in [(probability, expected), (1.0 - probability, -expected)] {
                let found = normal_quantile(probability);
                assert!((found - expected).abs() < DIGITS, "{probability}: {found}");
            }
        }
    }
}
