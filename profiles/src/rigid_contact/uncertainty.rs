//! What the uncertainty of measured profiles makes of a parameter of their contact.

use std::f64::consts::{PI, TAU};

use nalgebra::{Rotation2, Vector2};
use rayon::prelude::*;

use super::parameters::gauge_face;
use super::wheelset::{WheelOnRail, Wheelset};
use crate::error::{Error, InputError, Result};
use crate::placement::PlacedRail;
use crate::profile::ProfileCurve;
use crate::units::MILLIMETRE;

/// Distance of the points of a disturbed profile, m.
const STEP: f64 = 0.25 * MILLIMETRE;

/// Standard uncertainties of measured profiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileUncertainty {
    /// Of the form, across the profile, m.
    pub form: f64,
    /// Correlation length of the errors of the form, m: those of two places Δs apart have the correlation exp(−(Δs/ℓ)²/2).
    pub correlation: f64,
    /// Of the roll of a profile, rad.
    pub roll: f64,
}

/// What the samples of a quantity are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Their mean.
    pub mean: f64,
    /// Their standard deviation: the standard uncertainty.
    pub standard: f64,
}

impl ProfileUncertainty {
    /// Checks every value against what it can be.
    ///
    /// # Errors
    /// [`InputError`] naming the first value that is out of range.
    pub fn check(&self) -> Result<()> {
        let named = [
            ("profile uncertainty", self.form / MILLIMETRE, 0.0, 1.0, "mm"),
            ("correlation length", self.correlation / MILLIMETRE, 2.0, 1000.0, "mm"),
            ("roll uncertainty", self.roll.to_degrees(), 0.0, 2.0, "degrees"),
        ];
        for (name, value, least, greatest, unit) in named {
            if !(least..=greatest).contains(&value) {
                let expected = format!("{least} to {greatest} {unit}");
                return InputError::refuse(
                    name,
                    format!("{value} {unit}"),
                    expected,
                    "check the value and its unit",
                );
            }
        }
        Ok(())
    }

    /// The spread of the values that `of` has on `samples` disturbed wheelsets, each value by itself: the propagation of
    /// distributions (JCGM 101:2008). The same samples are taken every time.
    ///
    /// A value has no spread where it is missing on one of the wheelsets, or these are fewer than two. Where a disturbed wheelset cannot be
    /// placed, all its values are missing.
    ///
    /// # Errors
    /// As [`ProfileUncertainty::check`], and errors of `of` that are none of input.
    pub fn propagate(
        &self,
        wheelset: &Wheelset,
        samples: usize,
        of: impl Fn(&Wheelset) -> Result<Vec<Option<f64>>> + Sync,
    ) -> Result<Vec<Option<Spread>>> {
        self.check()?;
        let found: Vec<Option<Vec<Option<f64>>>> = (0..samples as u64)
            .into_par_iter()
            .map(|sample| match of(&self.disturbed(wheelset, sample)) {
                Ok(values) => Ok(Some(values)),
                Err(Error::Input(_)) => Ok(None),
                Err(other) => Err(other),
            })
            .collect::<Result<_>>()?;
        let count = found.iter().flatten().map(Vec::len).max().unwrap_or(0);
        Ok((0..count)
            .map(|i| {
                let values: Option<Vec<f64>> =
                    found.iter().map(|values| values.as_ref().and_then(|values| values[i])).collect();
                spread(&values?)
            })
            .collect())
    }

    /// The wheelset with errors of one `sample` on its profiles. Two equal sides are one pair that was measured once: both have the same errors.
    pub fn disturbed(&self, wheelset: &Wheelset, sample: u64) -> Wheelset {
        let mut numbers = Numbers(sample << 32);
        let right = self.disturbed_side(&wheelset.right, &mut numbers);
        let left = if wheelset.left == wheelset.right {
            right.clone()
        } else {
            self.disturbed_side(&wheelset.left, &mut numbers)
        };
        Wheelset { left, right, tape_y: wheelset.tape_y }
    }

    fn disturbed_side(&self, side: &WheelOnRail, numbers: &mut Numbers) -> WheelOnRail {
        let rail = self.misshapen(&side.rail.curve, numbers);
        let rail = rolled_rail(&side.rail, &rail, self.roll * numbers.normal());
        let wheel = self.misshapen(&side.wheel, numbers);
        let wheel = rolled_wheel(&side.wheel, &wheel, self.roll * numbers.normal());
        WheelOnRail { rail, wheel, radius: side.radius }
    }

    /// The curve with a smooth random error of its form.
    fn misshapen(&self, curve: &ProfileCurve, numbers: &mut Numbers) -> ProfileCurve {
        let error = FormError::new(self, curve.length(), numbers);
        curve.offset(STEP, |s| error.at(s))
    }
}

/// A rail whose roll was measured wrong by `angle`. The gauge is measured by itself: the gauge face stays where it is.
fn rolled_rail(placed: &PlacedRail, misshapen: &ProfileCurve, angle: f64) -> PlacedRail {
    let about = placed.origin.coords - Rotation2::new(angle) * placed.origin.coords;
    let curve = misshapen.transformed(angle, about);
    let back = match (gauge_face(&placed.curve), gauge_face(&curve)) {
        (Some(before), Some(after)) => Vector2::new(before - after, 0.0),
        _ => Vector2::zeros(),
    };
    PlacedRail {
        curve: curve.transformed(0.0, back),
        angle: placed.angle + angle,
        origin: placed.origin + back,
    }
}

/// A wheel whose roll was measured wrong by `angle`. Its profile refers to the flange back and the tape circle, whose radius is measured by
/// itself: both stay where they are.
fn rolled_wheel(wheel: &ProfileCurve, misshapen: &ProfileCurve, angle: f64) -> ProfileCurve {
    let curve = misshapen.transformed(angle, Vector2::zeros());
    let across = wheel.point(0.0).x - curve.point(0.0).x;
    let at_tape = |curve: &ProfileCurve, y: f64| curve.s_at_y(y).map(|s| curve.point(s).y);
    let down = match (at_tape(wheel, 0.0), at_tape(&curve, -across)) {
        (Some(before), Some(after)) => before - after,
        _ => 0.0,
    };
    curve.transformed(0.0, Vector2::new(across, down))
}

/// Mean and standard deviation of two values or more.
fn spread(values: &[f64]) -> Option<Spread> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (values.len() > 1).then(|| Spread { mean, standard: (squares / (count - 1.0)).sqrt() })
}

/// A smooth random error along a profile: normal numbers half a correlation length apart, averaged with the weights
/// exp(−(Δs/ℓ)²), whose sum has the correlation exp(−(Δs/ℓ)²/2).
struct FormError {
    /// Numbers with the weights' norm and the uncertainty in them, m.
    numbers: Vec<f64>,
    correlation: f64,
}

impl FormError {
    /// Numbers in a correlation length.
    const PER_LENGTH: f64 = 2.0;
    /// Weights further away than this, in correlation lengths, are below 1e-15.
    const REACH: f64 = 6.0;

    fn new(uncertainty: &ProfileUncertainty, length: f64, numbers: &mut Numbers) -> Self {
        let correlation = uncertainty.correlation;
        let count = (Self::PER_LENGTH * (length / correlation + 2.0 * Self::REACH)).ceil() as usize + 1;
        // Σ exp(−2 (Δs/ℓ)²) over numbers so close is the integral, to 3e-9.
        let norm = (Self::PER_LENGTH * (0.5 * PI).sqrt()).sqrt();
        let numbers = (0..count).map(|_| uncertainty.form / norm * numbers.normal()).collect();
        Self { numbers, correlation }
    }

    /// The error at the arc length `s`, m, and its derivative.
    fn at(&self, s: f64) -> [f64; 2] {
        // Place in correlation lengths from the first number.
        let place = s / self.correlation + Self::REACH;
        let first = (Self::PER_LENGTH * (place - Self::REACH)).max(0.0) as usize;
        let last = ((Self::PER_LENGTH * (place + Self::REACH)) as usize).min(self.numbers.len() - 1);
        let mut sum = [0.0; 2];
        for (i, number) in self.numbers.iter().enumerate().take(last + 1).skip(first) {
            let away = place - i as f64 / Self::PER_LENGTH;
            let weighted = number * (-away * away).exp();
            sum[0] += weighted;
            sum[1] -= 2.0 * away / self.correlation * weighted;
        }
        sum
    }
}

/// Random numbers of a seed, the same everywhere: G.L. Steele, D. Lea, C.H. Flood, "Fast splittable pseudorandom number
/// generators", OOPSLA 2014.
struct Numbers(u64);

impl Numbers {
    /// The next number, above 0 and at most 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ (z >> 31)) >> 11) + 1) as f64 / (1u64 << 53) as f64
    }

    /// A normal number of unit variance (G.E.P. Box, M.E. Muller, 1958).
    fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * self.uniform().ln()).sqrt(), TAU * self.uniform());
        radius * angle.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the definition of the correlation. Goal: standard deviation 1, correlation exp(−1/2) at one correlation length and
    /// exp(−2) at two, the derivative. Accuracy (MODEL): four standard deviations of 4000 samples.
    #[test]
    fn form_errors_have_their_deviation_and_correlation() {
        const SAMPLES: usize = 4000;
        const MODEL: f64 = 4.0 * 1.42 / 63.2;
        let uncertainty = ProfileUncertainty { form: 1.0, correlation: 0.01, roll: 0.0 };
        let mut products = [0.0; 3];
        for sample in 0..SAMPLES {
            let error = FormError::new(&uncertainty, 0.15, &mut Numbers((sample as u64) << 32));
            let at = |s: f64| error.at(s)[0];
            for (sum, apart) in products.iter_mut().zip([0.0, 0.01, 0.02]) {
                *sum += at(0.06) * at(0.06 + apart) / SAMPLES as f64;
            }
            let slope = (at(0.07 + 1e-6) - at(0.07 - 1e-6)) / 2e-6;
            assert!((slope - error.at(0.07)[1]).abs() < 1e-5 * slope.abs().max(100.0), "{slope}");
        }
        for (found, expected) in products.iter().zip([1.0, (-0.5f64).exp(), (-2.0f64).exp()]) {
            assert!((found - expected).abs() < MODEL, "{products:?}");
        }
    }

    /// Goal: mean and deviation of values, of a known set; none of a single value.
    #[test]
    fn spread_of_a_known_set() {
        let found = spread(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!(found.mean, 2.5);
        assert!((found.standard - (5.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(spread(&[1.0]), None);
    }

    #[test]
    fn values_out_of_range_are_refused() {
        let good = ProfileUncertainty { form: 15e-6, correlation: 0.01, roll: 1e-3 };
        good.check().unwrap();
        for (bad, name) in [
            (ProfileUncertainty { form: -1e-6, ..good }, "profile uncertainty"),
            (ProfileUncertainty { form: f64::NAN, ..good }, "profile uncertainty"),
            (ProfileUncertainty { correlation: 1e-4, ..good }, "correlation length"),
            (ProfileUncertainty { roll: 0.1, ..good }, "roll uncertainty"),
        ] {
            assert!(bad.check().unwrap_err().to_string().contains(name));
        }
    }
}
