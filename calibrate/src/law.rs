//! The normal stiffness law `k(f) = a + b·(f/f0)^c` (publication, eq. 11) and
//! its fit to measured tangent stiffness.
//!
//! `k` is the *tangent* stiffness dF/dδ; the displacement follows by
//! integration, `δ(f) = ∫ df/k(f)` from 0. A law is usable when a ≥ 0, b ≥ 0,
//! a + b > 0 and 0 ≤ c < 1; [`StiffnessLaw::new`] checks that.

mod table;
mod normal;

pub use normal::NormalLaw;
pub use table::TableLaw;

use argmin::core::{CostFunction, Executor};
use argmin::solver::brent::BrentOpt;
use nalgebra::{DMatrix, DVector};

use railspring_profiles::error::{Error, InputError, NumericsError, Result, StopReason};
use railspring_profiles::quadrature::GAUSS_12;

/// Force to which the power in the law refers, N.
pub const REFERENCE_FORCE: f64 = 1e3;

/// Fewer loads are no law: it has three constants, and their errors need one load more.
pub(crate) const LEAST_LOADS: usize = 4;

/// Search interval for the exponent. Hertz has 1/3 and conformal contact less;
/// at c = 1 a law without a constant part has no finite displacement.
const EXPONENT_RANGE: (f64, f64) = (0.0, LARGEST_EXPONENT);
const LARGEST_EXPONENT: f64 = 0.95;

/// The search comes as close to a bound of the exponent.
const BOUND_TOLERANCE: f64 = 1e-6;

/// Relative accuracy of the inverse [`StiffnessLaw::force`].
const INVERSE_TOLERANCE: f64 = 1e-13;

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
        Err(InputError::new(
            "law",
            format!("a = {a} N/m, b = {b} N/m, c = {c}"),
            "a ≥ 0, b ≥ 0, a + b > 0 and 0 ≤ c < 1",
            "fit the law to stiffness that is positive and does not fall with the force",
        )
        .into())
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
        if displacement.is_nan() {
            return f64::NAN;
        }
        if displacement <= 0.0 {
            return 0.0;
        }
        let mut force = if guess > 0.0 { guess } else { f64::MIN_POSITIVE.max(self.a * displacement) };
        for _ in 0..100 {
            let step = self.tangent(force) * (displacement - self.displacement(force));
            // From above a tangent may undershoot to below zero: halve instead.
            let next = (force + step).max(0.5 * force);
            let change = (next - force).abs();
            force = next;
            if change <= INVERSE_TOLERANCE * force {
                break;
            }
        }
        force
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

/// Length of a quadrature panel in `ln f`.
const PANEL: f64 = 2.0;

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
/// their bounds; the largest relative error says what that is worth.
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
/// [`InputError`] for lists of different length, fewer than four points, values
/// that are not positive and finite; [`NumericsError`] if the search fails.
pub fn fit_law(forces: &[f64], tangent_stiffness: &[f64]) -> Result<LawFit> {
    check_points(forces, tangent_stiffness)?;
    let points = Points { forces, stiffness: tangent_stiffness };
    let c = best_exponent(&points)?;
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

/// The exponent with the smallest sum of squares: a scan that brackets it, then Brent.
fn best_exponent(points: &Points) -> Result<f64> {
    const SCAN: usize = 38;
    let (low, high) = EXPONENT_RANGE;
    let at = |i: usize| low + (high - low) * i as f64 / SCAN as f64;
    let best = (0..=SCAN)
        .min_by(|&i, &j| points.sum_of_squares(at(i)).total_cmp(&points.sum_of_squares(at(j))))
        .unwrap_or(0);
    // The smallest reachable tolerance: near an exact law the sum of squares
    // has no rounding floor, and Brent may go beyond the usual root of epsilon.
    let solver =
        BrentOpt::new(at(best.saturating_sub(1)), at((best + 1).min(SCAN))).set_tolerance(1e-12, 1e-13);
    let failure = |iteration, residual| {
        Error::from(NumericsError {
            stage: "law fit".into(),
            step: None,
            iteration,
            residual,
            active: points.forces.len(),
            reason: StopReason::NotFinite,
        })
    };
    let search = Executor::new(points.clone(), solver)
        .configure(|state| state.max_iters(200))
        .run()
        .map_err(|_| failure(0, f64::NAN))?;
    let state = search.state();
    match state.best_param {
        Some(c) if state.best_cost.is_finite() => Ok(c),
        _ => Err(failure(state.iter as usize, state.best_cost)),
    }
}

fn check_points(forces: &[f64], stiffness: &[f64]) -> Result<()> {
    if forces.len() != stiffness.len() {
        return Err(InputError::new(
            "law.points",
            format!("{} forces, {} stiffnesses", forces.len(), stiffness.len()),
            "one stiffness a force",
            "give lists of equal length",
        )
        .into());
    }
    if forces.len() < LEAST_LOADS {
        return Err(InputError::new(
            "law.points",
            forces.len(),
            "at least 4 points for the three constants and their errors",
            "calibrate at more loads",
        )
        .into());
    }
    for (name, values) in [("force", forces), ("stiffness", stiffness)] {
        if let Some((i, v)) = values.iter().enumerate().find(|(_, v)| !(v.is_finite() && **v > 0.0)) {
            return Err(InputError::new(
                format!("law.points[{i}].{name}"),
                v,
                "a positive, finite value",
                "leave out the point or repair the load step it came from",
            )
            .into());
        }
    }
    Ok(())
}

/// Points to fit, and the sums of the fit at a given exponent.
#[derive(Clone)]
struct Points<'a> {
    forces: &'a [f64],
    stiffness: &'a [f64],
}

impl CostFunction for Points<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, c: &f64) -> std::result::Result<f64, argmin::core::Error> {
        Ok(self.sum_of_squares(*c))
    }
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
