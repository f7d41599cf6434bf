//! The power law of the normal stiffness: tangent, displacement, force and energy.

use super::inverse::force_at;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::quadrature::GAUSS_12;

/// Force to which the power in the law refers, N.
pub const REFERENCE_FORCE: f64 = 1e3;

/// Largest exponent of a law; at 1 one without a constant part has no finite displacement.
pub(super) const LARGEST_EXPONENT: f64 = 0.95;

/// Length of a quadrature panel in `ln f`.
const PANEL: f64 = 2.0;

/// Tangent stiffness against force, `k(f) = a + b·(f/f0)^c` with `f0` = [`REFERENCE_FORCE`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffnessLaw {
    /// Constant part, N/m.
    pub a: f64,
    /// Factor of the power part, N/m.
    pub b: f64,
    /// Exponent.
    pub c: f64,
}

impl StiffnessLaw {
    /// A law from its three constants, a and b in N/m.
    ///
    /// # Errors
    /// [`InputError`] with key `law` unless a ≥ 0, b ≥ 0, a + b > 0 and 0 ≤ c < 1, all finite.
    pub fn new(a: f64, b: f64, c: f64) -> Result<Self> {
        let finite = a.is_finite() && b.is_finite() && c.is_finite();
        if finite && a >= 0.0 && b >= 0.0 && a + b > 0.0 && (0.0..1.0).contains(&c) {
            return Ok(Self { a, b, c });
        }
        InputError::refuse(
            "law",
            format!("a = {a} N/m, b = {b} N/m, c = {c}"),
            "a ≥ 0, b ≥ 0, a + b > 0 and 0 ≤ c < 1",
            "fit the law to stiffness that is positive and does not fall with the force",
        )
    }

    /// The constants of the publication for the UIC 60 rail and the SKS-700 wheel (section 2.2).
    pub const fn published() -> Self {
        Self { a: 3e7, b: 2.94e8, c: 0.241104 }
    }

    /// Hertz contact of a sphere of `radius` (m) on a plane, contact modulus `contact_modulus_e_star`
    /// (N/m²): `k = (6 E*² R)^(1/3) f^(1/3)` (publication, eq. 10, with its material constant made explicit).
    pub fn hertz(contact_modulus_e_star: f64, radius: f64) -> Self {
        let b = (6.0 * contact_modulus_e_star.powi(2) * radius * REFERENCE_FORCE).cbrt();
        Self { a: 0.0, b, c: 1.0 / 3.0 }
    }

    /// Tangent stiffness, N/m, at `force` (N); a force below zero counts as zero.
    pub fn tangent(&self, force: f64) -> f64 {
        self.a + self.b * (force.max(0.0) / REFERENCE_FORCE).powf(self.c)
    }

    /// Displacement, m, under `force` (N), `∫ df/k` from 0; 0 for a force below zero.
    ///
    /// Relative error below 1e-14: closed form for a = 0, otherwise Gauss
    /// quadrature of an integrand that is analytic in a strip.
    ///
    /// ```
    /// use railspring_calibrate::law::StiffnessLaw;
    /// let law = StiffnessLaw::published();
    /// assert!((law.displacement(100e3) - 0.1408e-3).abs() < 0.0001e-3);
    /// ```
    pub fn displacement(&self, force: f64) -> f64 {
        self.moment(force, 0)
    }

    /// Force, N, at `displacement` (m): the inverse of [`Self::displacement`] to
    /// 1e-13 relative; 0 for a displacement of zero or below.
    pub fn force(&self, displacement: f64) -> f64 {
        // Two lower bounds; the displacement is concave in the force, so that
        // Newton from below approaches from below and never leaves f > 0.
        let constant_part = self.a * displacement;
        let power_part = if self.b > 0.0 {
            let x = self.b * (1.0 - self.c) * displacement / REFERENCE_FORCE;
            REFERENCE_FORCE * x.max(0.0).powf(1.0 / (1.0 - self.c))
        } else {
            0.0
        };
        self.force_from(displacement, constant_part.max(power_part))
    }

    /// As [`Self::force`], starting the iteration from a `guess` (N) of the force.
    pub fn force_from(&self, displacement: f64, guess: f64) -> f64 {
        let guess = if guess > 0.0 { guess } else { f64::MIN_POSITIVE.max(self.a * displacement) };
        force_at(displacement, guess, |force| (self.displacement(force), self.tangent(force)))
    }

    /// Energy stored at `displacement` (m), J: `∫ f dδ = ∫ f df/k`.
    pub fn energy(&self, displacement: f64) -> f64 {
        self.moment(self.force(displacement), 1)
    }

    /// `∫ f^power df/k(f)` from 0 to `force`, for the powers 0 and 1.
    ///
    /// With f = F·exp(-y) the integral becomes F^(p+1) ∫ exp(-(p+1)y)/k dy over
    /// y > 0, whose nearest pole lies π/c > π off the real axis: 12 Gauss points on
    /// panels of length 2 leave a relative error below 1e-17 a panel.
    fn moment(&self, force: f64, power: i32) -> f64 {
        if force.is_nan() {
            return f64::NAN;
        }
        if force <= 0.0 {
            return 0.0;
        }
        let rate = f64::from(power + 1);
        let scale = force.powi(power + 1);
        let stiffness = self.b * (force / REFERENCE_FORCE).powf(self.c);
        if self.a == 0.0 {
            return scale / (stiffness * (rate - self.c));
        }
        let (panel_weight, panel_power) = ((-PANEL * rate).exp(), (-PANEL * self.c).exp());
        let points: [(f64, f64); 12] = std::array::from_fn(|i| {
            let (x, w) = GAUSS_12[i];
            let y = 0.5 * PANEL * (1.0 + x);
            (0.5 * PANEL * w * (-rate * y).exp(), stiffness * (-self.c * y).exp())
        });
        // What follows a panel is less than a geometric series of its value.
        let ratio = (-PANEL * (rate - self.c)).exp();
        let (mut weight, mut decay, mut sum) = (1.0, 1.0, 0.0);
        for _ in 0..10_000 {
            let panel: f64 = weight * points.iter().map(|(w, k)| w / (self.a + decay * k)).sum::<f64>();
            sum += panel;
            if panel * ratio <= 1e-17 * sum * (1.0 - ratio) {
                break;
            }
            weight *= panel_weight;
            decay *= panel_power;
        }
        scale * sum
    }
}
