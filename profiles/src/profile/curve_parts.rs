//! A profile curve as numbers, for files.

use super::spline::Cubic;
use crate::error::InputError;

/// Polynomials end where the next ones begin but for this, m.
const MEET: f64 = 1e-7;

/// The numbers that a [`ProfileCurve`](super::ProfileCurve) consists of. Between two knots the curve is `a + b·u + c·u² + d·u³`, with `u` the arc length from the first of them.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveParts {
    /// Arc lengths, m, ascending from 0.
    pub knots: Vec<f64>,
    /// Of each interval a (y, z), b, c and d; m, 1, 1/m, 1/m².
    pub cubics: Vec<[f64; 8]>,
    /// Numbers of the inner knots at which separate splines join.
    pub breaks: Vec<usize>,
}

impl CurveParts {
    /// Whether these can be the parts of a curve, but for their arc length.
    pub(super) fn check(&self) -> Result<(), InputError> {
        let Self { knots, cubics, breaks } = self;
        if cubics.is_empty() || knots.len() != cubics.len() + 1 || knots[0] != 0.0 {
            return Err(Self::refusal("knots that are not those of the polynomials"));
        }
        if !knots.iter().chain(cubics.iter().flatten()).all(|value| value.is_finite()) {
            return Err(Self::refusal("values that are not finite"));
        }
        if !knots.is_sorted_by(|a, b| a < b) {
            return Err(Self::refusal("knots that do not ascend"));
        }
        if !breaks.iter().all(|&at| at > 0 && at < cubics.len()) || !breaks.is_sorted_by(|a, b| a < b) {
            return Err(Self::refusal("breakpoints that are not between the polynomials"));
        }
        let end = |i: usize| Cubic::of_row(&cubics[i]).point(knots[i + 1] - knots[i]);
        let next = |i: usize| Cubic::of_row(&cubics[i + 1]).a;
        if (0..cubics.len() - 1).any(|i| (end(i) - next(i)).norm() > MEET) {
            return Err(Self::refusal("polynomials that do not meet"));
        }
        Ok(())
    }

    pub(super) fn refusal(found: &str) -> InputError {
        let expected = "knots, cubic polynomials and breakpoints as a profile curve has them";
        InputError::new("profile curve", found, expected, "write the curve again")
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve::ProfileCurve;
    use super::*;
    use nalgebra::Point2;

    /// Goal: a curve with a kink is the same to the last bit after its parts; parts with one number changed are refused. Exact.
    #[test]
    fn a_curve_is_the_same_after_its_parts() {
        let point = |i: i32| {
            let y = 1e-3 * f64::from(i);
            Point2::new(y, if i < 20 { 3.0 * y * y } else { 3.0 * y * y - 0.3 * (y - 0.02) })
        };
        let points: Vec<Point2<f64>> = (0..=40).map(point).collect();
        let curve = ProfileCurve::from_points(&points, &[20]).unwrap();
        let parts = curve.parts();
        assert_eq!(ProfileCurve::from_parts(&parts).unwrap(), curve);
        let wrong = |change: &dyn Fn(&mut CurveParts)| {
            let mut parts = parts.clone();
            change(&mut parts);
            ProfileCurve::from_parts(&parts).unwrap_err().to_string()
        };
        for (change, said) in [
            (
                (&|p: &mut CurveParts| p.knots.truncate(3)) as &dyn Fn(&mut CurveParts),
                "not those of the poly",
            ),
            (&|p| p.knots[3] = f64::NAN, "not finite"),
            (&|p| p.knots.swap(3, 4), "do not ascend"),
            (&|p| p.breaks[0] = 0, "breakpoints"),
            (&|p| p.cubics[3][1] += 1e-6, "do not meet"),
            (&|p| p.knots.iter_mut().for_each(|s| *s *= 2.0), "do not meet"),
            (
                &|p| {
                    // the same curve by another parameter
                    p.knots.iter_mut().for_each(|s| *s *= 2.0);
                    for q in &mut p.cubics {
                        (2..8).for_each(|i| q[i] *= 0.5_f64.powi(i as i32 / 2));
                    }
                },
                "not the arc length",
            ),
        ] {
            let message = wrong(change);
            assert!(message.contains(said), "{said}: {message}");
        }
    }
}
