//! The clearance between a rail and what lies above it, and its local minima.

use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::profile::ProfileCurve;
use crate::root::bracketed_newton;
use crate::units::MILLIMETRE;

/// Lateral step at which the clearance is sampled for its minima, m. Two minima between the same two samples count as one.
const STEP: f64 = 0.05 * MILLIMETRE;
/// SOLVER: an end counts as touched within this, m.
const AT_END: f64 = 1e-9;

/// A local minimum of the clearance.
#[derive(Clone, Copy)]
pub(super) struct Minimum {
    /// Clearance above the least one, m.
    pub gap: f64,
    pub rail_s: f64,
    /// Arc length on the upper curve.
    pub wheel_s: f64,
}

/// The part of a curve around a place that can be seen from above (rail) or below (wheel): there y increases.
struct Graph<'a> {
    curve: &'a ProfileCurve,
    knots: &'a [f64],
    y: Vec<f64>,
}

impl<'a> Graph<'a> {
    fn around(curve: &'a ProfileCurve, s: f64) -> Self {
        let knots = curve.knots();
        let y = |i: usize| curve.point(knots[i]).x;
        let middle = knots.partition_point(|&knot| knot < s).min(knots.len() - 1);
        let first = (1..=middle).rev().find(|&i| y(i - 1) >= y(i)).unwrap_or(0);
        let last = (middle..knots.len() - 1).find(|&i| y(i + 1) <= y(i)).unwrap_or(knots.len() - 1);
        Self { curve, knots: &knots[first..=last], y: (first..=last).map(y).collect() }
    }

    fn range(&self) -> (f64, f64) {
        (self.y[0], self.y[self.y.len() - 1])
    }

    fn s_at(&self, y: f64) -> f64 {
        let i = self.y.partition_point(|&knot| knot <= y).clamp(1, self.y.len() - 1);
        let condition = |s: f64| {
            let (p, t) = self.curve.evaluate(s);
            (p.x - y, t.x)
        };
        if y <= self.y[i - 1] {
            self.knots[i - 1]
        } else if y >= self.y[i] {
            self.knots[i]
        } else {
            bracketed_newton(condition, self.knots[i - 1], self.knots[i])
        }
    }

    /// dz/dy and d²z/dy².
    fn slopes(&self, s: f64) -> (f64, f64) {
        let t = self.curve.tangent(s);
        (t.y / t.x, self.curve.curvature(s) / t.x.powi(3))
    }
}

/// Height by which `wheel` must be lowered (down positive) until it touches `rail`, and the minima of the clearance
/// within `gap` of the least one, by their gap. `near` is a lateral position in the middle of the tread.
pub(super) fn minima(
    rail: &ProfileCurve,
    wheel: &ProfileCurve,
    near: f64,
    gap: f64,
) -> Result<(f64, Vec<Minimum>)> {
    let missed = |what: &str| {
        InputError::new(
            InputField::LateralShift,
            format!("tape circle at y = {:.3} mm", near / MILLIMETRE),
            "a position at which the running surfaces of wheel and rail touch",
            format!("{what}; reduce `lateral_shift`, or check `gauge` and `flange_back`"),
        )
    };
    let [rail, wheel] = [rail, wheel].map(|curve| {
        // The rail's top or the tape circle; a curve without the latter is taken from its middle.
        Graph::around(curve, curve.s_at_y(near).unwrap_or(0.5 * curve.length()))
    });
    let ((r0, r1), (w0, w1)) = (rail.range(), wheel.range());
    let (low, high) = (r0.max(w0), r1.min(w1));
    if low.is_nan() || low >= high {
        return Err(missed("the wheel misses the rail").into());
    }
    let parts = ((high - low) / STEP).ceil().max(2.0) as usize;
    let at = |i: usize| low + (high - low) * i as f64 / parts as f64;
    let clearance = |y: f64| {
        let (rail_s, wheel_s) = (rail.s_at(y), wheel.s_at(y));
        Minimum { gap: rail.curve.point(rail_s).y - wheel.curve.point(wheel_s).y, rail_s, wheel_s }
    };
    // Slope of the clearance, and its derivative.
    let slope = |y: f64| {
        let ((r, dr), (w, dw)) = (rail.slopes(rail.s_at(y)), wheel.slopes(wheel.s_at(y)));
        (r - w, dr - dw)
    };
    let samples: Vec<Minimum> = (0..=parts).map(|i| clearance(at(i))).collect();
    let least = samples.iter().map(|sample| sample.gap).fold(f64::INFINITY, f64::min);
    // Between two samples on a flange face of 75° the clearance can still fall by this much.
    const SLACK: f64 = 4.0 * STEP;
    let slope_at = |sample: &Minimum| rail.slopes(sample.rail_s).0 - wheel.slopes(sample.wheel_s).0;
    let mut found = Vec::new();
    for i in 0..parts {
        let (from, to) = (&samples[i], &samples[i + 1]);
        if from.gap.min(to.gap) <= least + gap + SLACK && slope_at(from) < 0.0 && slope_at(to) >= 0.0 {
            found.push(clearance(bracketed_newton(slope, at(i), at(i + 1))));
        }
    }
    // An end is the lowest place of a wheel that hangs on it.
    found.extend([samples[0], samples[parts]]);
    found.sort_by(|a, b| a.gap.total_cmp(&b.gap).then(a.rail_s.total_cmp(&b.rail_s)));
    let height = found[0].gap;
    let at_end = |curve: &ProfileCurve, s: f64| s < AT_END || s > curve.length() - AT_END;
    let hangs = |m: &Minimum| at_end(rail.curve, m.rail_s) || at_end(wheel.curve, m.wheel_s);
    if hangs(&found[0]) {
        return Err(missed("the wheel misses the rail and hangs on the end of a profile").into());
    }
    for minimum in &mut found {
        minimum.gap -= height;
    }
    found.retain(|m| m.gap <= gap && !hangs(m));
    Ok((height, found))
}
