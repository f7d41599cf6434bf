//! The normal stiffness law `k(f) = a + b·(f/f0)^c` (publication, eq. 11) and
//! its fit to measured tangent stiffness.
//!
//! `k` is the *tangent* stiffness dF/dδ; the displacement follows by
//! integration, `δ(f) = ∫ df/k(f)` from 0. A law is usable when a ≥ 0, b ≥ 0,
//! a + b > 0 and 0 ≤ c < 1; [`StiffnessLaw::new`] checks that.

mod inverse;
mod power;
mod points;
mod exponent;
mod series;
mod series_fit;
mod steps;
mod steps_fit;
mod table;
mod normal;
mod forms;

pub use forms::{FormFit, LawError, fit_forms};
pub use normal::{Form, NormalLaw};
pub use points::{LEAST_LOADS, Solid};
pub use power::{REFERENCE_FORCE, StiffnessLaw};
pub use series::SeriesLaw;
pub use series_fit::fit_series;
pub use steps::{StepConstants, StepLaw};
pub use steps_fit::{LEAST_LOADS_OF_STEPS, fit_steps};
pub use table::TableLaw;

use nalgebra::{DMatrix, DVector};

use self::exponent::{EXPONENT_RANGE, best_exponent};
use self::points::check_points;
use railspring_profiles::error::Result;

/// The search comes as close to a bound of the exponent.
const BOUND_TOLERANCE: f64 = 1e-6;

/// A law fitted to points of tangent stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawFit {
    /// The law.
    pub law: StiffnessLaw,
    /// Standard errors of a (N/m), b (N/m) and c, from the scatter of the points about the law; 0 for a parameter on
    /// its bound, given which those of the others hold.
    pub standard_error: [f64; 3],
    /// Which of a, b and c lie on a bound of the fit: a at 0, c at the largest exponent, or b and c at 0.
    pub at_bound: [bool; 3],
    /// Root mean square of the relative residuals.
    pub rms_relative_error: f64,
    /// Largest relative residual.
    pub max_relative_error: f64,
    /// Smallest and largest force of the points, N.
    pub range: (f64, f64),
}

/// Fits the law to tangent stiffness (N/m) at given forces (N) by relative
/// least squares: Brent's search over c, with a ≥ 0 and b ≥ 0 linear inside.
///
/// Stiffness that falls with the force, as of a sticking flange contact, gets the best constant, with b and c on
/// their bounds; the largest relative error is stated beside it.
///
/// ```
/// use railspring_calibrate::law::{fit_law, StiffnessLaw};
/// let forces: Vec<f64> = (1..=20).map(|i| 5e3 * i as f64).collect();
/// let hertz = StiffnessLaw::hertz(115e9, 0.4);
/// let stiffness: Vec<f64> = forces.iter().map(|&f| hertz.tangent(f)).collect();
/// let fit = fit_law(&forces, &stiffness).unwrap();
/// assert!((fit.law.c - 1.0 / 3.0).abs() < 1e-6);
/// ```
///
/// # Errors
/// [`railspring_profiles::error::InputError`] for lists of different length, fewer than four points, values
/// that are not positive and finite; [`railspring_profiles::error::NumericsError`] if the search fails.
pub fn fit_law(forces: &[f64], tangent_stiffness: &[f64]) -> Result<LawFit> {
    check_points(forces, tangent_stiffness)?;
    let points = Points { forces, stiffness: tangent_stiffness };
    let c = best_exponent(|c| points.sum_of_squares(c), forces.len())?;
    let mut law = points.best_law(c);
    let mut at_bound = [law.a == 0.0, false, c >= EXPONENT_RANGE.1 - BOUND_TOLERANCE];
    if law.b <= 0.0 || c <= EXPONENT_RANGE.0 {
        // no power helps: stiffness that falls with the force is best fitted by a constant
        law = points.constant();
        at_bound = [false, true, true];
    }
    let residuals = points.residuals(&law);
    let squares: f64 = residuals.iter().map(|r| r * r).sum();
    Ok(LawFit {
        law,
        standard_error: points.standard_errors(&law, at_bound, squares),
        at_bound,
        rms_relative_error: (squares / forces.len() as f64).sqrt(),
        max_relative_error: residuals.iter().fold(0.0, |m, r| m.max(r.abs())),
        range: forces.iter().fold((f64::INFINITY, 0.0), |(low, high), &f| (f.min(low), f.max(high))),
    })
}

/// Points to fit, and the sums of the fit at a given exponent.
struct Points<'a> {
    forces: &'a [f64],
    stiffness: &'a [f64],
}

impl Points<'_> {
    /// a and b that fit best at exponent `c`, with a ≥ 0.
    fn best_law(&self, c: f64) -> StiffnessLaw {
        // Columns 1/k and x^c/k, right side 1. The second is made orthogonal to
        // the first, because the two are nearly parallel for small c.
        let ones: Vec<f64> = self.stiffness.iter().map(|k| 1.0 / k).collect();
        let powers: Vec<f64> =
            self.forces.iter().zip(&ones).map(|(f, one)| (f / REFERENCE_FORCE).powf(c) * one).collect();
        let dot = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(x, y)| x * y).sum::<f64>();
        let projection = dot(&ones, &powers) / dot(&ones, &ones);
        let rest: Vec<f64> = powers.iter().zip(&ones).map(|(p, one)| p - projection * one).collect();
        let length = dot(&rest, &rest);
        let b = if length > 0.0 { rest.iter().sum::<f64>() / length } else { 0.0 };
        let a = ones.iter().sum::<f64>() / dot(&ones, &ones) - projection * b;
        if a >= 0.0 && length > 0.0 {
            StiffnessLaw { a, b, c }
        } else {
            StiffnessLaw { a: 0.0, b: powers.iter().sum::<f64>() / dot(&powers, &powers), c }
        }
    }

    /// The constant that fits best.
    fn constant(&self) -> StiffnessLaw {
        let sum = |power: i32| self.stiffness.iter().map(|k| k.powi(-power)).sum::<f64>();
        StiffnessLaw { a: sum(1) / sum(2), b: 0.0, c: 0.0 }
    }

    fn residuals(&self, law: &StiffnessLaw) -> Vec<f64> {
        self.forces.iter().zip(self.stiffness).map(|(&f, &k)| law.tangent(f) / k - 1.0).collect()
    }

    fn sum_of_squares(&self, c: f64) -> f64 {
        self.residuals(&self.best_law(c)).iter().map(|r| r * r).sum()
    }

    /// Roots of the diagonal of `s²·(JᵀJ)⁻¹` with the Jacobian of the relative residuals.
    fn standard_errors(&self, law: &StiffnessLaw, at_bound: [bool; 3], squares: f64) -> [f64; 3] {
        let free: Vec<usize> = (0..3).filter(|&i| !at_bound[i]).collect();
        // Columns relative to the parameters keep the matrix well scaled.
        let scale = [law.a, law.b, 1.0];
        let jacobian = DMatrix::from_fn(self.forces.len(), free.len(), |i, j| {
            let x = self.forces[i] / REFERENCE_FORCE;
            let power = law.b * x.powf(law.c);
            [law.a, power, power * x.ln()][free[j]] / self.stiffness[i]
        });
        let variance = squares / (self.forces.len() - free.len()) as f64;
        // (JᵀJ)⁻¹ = R⁻¹R⁻ᵀ: the squared norms of the rows of R⁻¹.
        let r = jacobian.qr().r();
        let mut errors = [0.0; 3];
        for j in 0..free.len() {
            let mut unit = DVector::zeros(free.len());
            unit[j] = 1.0;
            let row = r.tr_solve_upper_triangular(&unit).map_or(f64::INFINITY, |v| v.norm_squared());
            errors[free[j]] = scale[free[j]] * (variance * row).sqrt();
        }
        errors
    }
}

#[cfg(test)]
mod tests;
