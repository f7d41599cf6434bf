//! A power law and a linear spring in series: the contact, and bodies that give way in proportion to the force.
//!
//! `1/k(f) = 1/(b·(f/f0)^c) + 1/s`, with c near Hertz's 1/3 and `s` the bodies. Displacement and energy are closed.

use super::inverse::force_at;
use super::power::REFERENCE_FORCE;
use railspring_profiles::error::{InputError, Result};

/// Tangent stiffness `1/k(f) = 1/(b·(f/f0)^c) + 1/s` with `f0` = [`REFERENCE_FORCE`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesLaw {
    b: f64,
    c: f64,
    compliance: f64,
}

impl SeriesLaw {
    /// A law from its constants: `b` and the spring in series, `s`, in N/m; without a spring, the power alone.
    ///
    /// ```
    /// use railspring_calibrate::law::SeriesLaw;
    /// let law = SeriesLaw::new(4e8, 1.0 / 3.0, Some(2e9)).unwrap();
    /// assert!((1.0 / law.tangent(8e3) - (1.0 / 8e8 + 1.0 / 2e9)).abs() < 1e-24);
    /// ```
    ///
    /// # Errors
    /// [`InputError`] with key `law` unless b > 0, 0 ≤ c < 1 and s > 0, all finite.
    pub fn new(b: f64, c: f64, s: Option<f64>) -> Result<Self> {
        let spring = s.is_none_or(|s| s > 0.0 && s.is_finite());
        if b > 0.0 && b.is_finite() && (0.0..1.0).contains(&c) && spring {
            return Ok(Self { b, c, compliance: s.map_or(0.0, |s| 1.0 / s) });
        }
        InputError::refuse(
            "law",
            format!("b = {b} N/m, c = {c}, s = {s:?} N/m"),
            "b > 0, 0 ≤ c < 1 and s > 0",
            "fit the law to stiffness that is positive and does not fall with the force",
        )
    }

    /// Factor of the power, N/m.
    pub fn b(&self) -> f64 {
        self.b
    }

    /// Exponent of the power.
    pub fn c(&self) -> f64 {
        self.c
    }

    /// The linear spring in series, N/m; none where it does not give way.
    pub fn s(&self) -> Option<f64> {
        (self.compliance > 0.0).then(|| 1.0 / self.compliance)
    }

    /// Tangent stiffness of the power alone, N/m.
    fn power(&self, force: f64) -> f64 {
        if force.is_nan() {
            // whose power of exponent 0 would be 1
            return f64::NAN;
        }
        self.b * (force.max(0.0) / REFERENCE_FORCE).powf(self.c)
    }

    /// Tangent stiffness, N/m, at `force` (N); a force below zero counts as zero.
    pub fn tangent(&self, force: f64) -> f64 {
        let power = self.power(force);
        power / (1.0 + self.compliance * power)
    }

    /// Displacement, m, under `force` (N), `∫ df/k` from 0; 0 for a force below zero.
    pub fn displacement(&self, force: f64) -> f64 {
        if force <= 0.0 {
            return 0.0;
        }
        force * (1.0 / (self.power(force) * (1.0 - self.c)) + self.compliance)
    }

    /// Energy stored under `force` (N), `∫ f df/k`, J; 0 for a force below zero.
    pub fn energy(&self, force: f64) -> f64 {
        if force <= 0.0 {
            return 0.0;
        }
        force * force * (1.0 / (self.power(force) * (2.0 - self.c)) + 0.5 * self.compliance)
    }

    /// Force, N, at `displacement` (m), with a `guess` (N) of it: the inverse of [`Self::displacement`] to 1e-13 relative; 0 for a
    /// displacement of zero or below.
    pub fn force_from(&self, displacement: f64, guess: f64) -> f64 {
        let start = if guess > 0.0 { guess } else { self.tangent(REFERENCE_FORCE) * displacement };
        force_at(displacement, start, |force| (self.displacement(force), self.tangent(force)))
    }
}
