//! Search for the exponent of a law, the one constant that does not enter linearly.

use argmin::core::{CostFunction, Executor};
use argmin::solver::brent::BrentOpt;
use railspring_profiles::error::{Error, NumericsError, Result, StopReason};

use super::power::LARGEST_EXPONENT;

/// Search interval for the exponent. Hertz has 1/3 and conformal contact less;
/// at c = 1 a law without a constant part has no finite displacement.
pub(super) const EXPONENT_RANGE: (f64, f64) = (0.0, LARGEST_EXPONENT);

/// A sum of squares over the exponent.
struct Squares<F>(F);

impl<F: Fn(f64) -> f64> CostFunction for Squares<F> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, c: &f64) -> std::result::Result<f64, argmin::core::Error> {
        Ok(self.0(*c))
    }
}

/// The exponent with the smallest sum of `squares` over `points` points: a scan that brackets it, then Brent.
///
/// # Errors
/// [`NumericsError`] if the search fails.
pub(super) fn best_exponent(squares: impl Fn(f64) -> f64, points: usize) -> Result<f64> {
    const SCAN: usize = 38;
    let (low, high) = EXPONENT_RANGE;
    let at = |i: usize| low + (high - low) * i as f64 / SCAN as f64;
    let best = (0..=SCAN).min_by(|&i, &j| squares(at(i)).total_cmp(&squares(at(j)))).unwrap_or(0);
    // The smallest reachable tolerance: near an exact law the sum of squares
    // has no rounding floor, and Brent may go beyond the usual root of epsilon.
    let solver =
        BrentOpt::new(at(best.saturating_sub(1)), at((best + 1).min(SCAN))).set_tolerance(1e-12, 1e-13);
    let failure = |iteration, residual| {
        Error::from(NumericsError::new("law fit", StopReason::NotFinite, residual, points).after(iteration))
    };
    let search = Executor::new(Squares(squares), solver)
        .configure(|state| state.max_iters(200))
        .run()
        .map_err(|_| failure(0, f64::NAN))?;
    let state = search.state();
    match state.best_param {
        Some(c) if state.best_cost.is_finite() => Ok(c),
        _ => Err(failure(state.iter as usize, state.best_cost)),
    }
}
