//! The first touch of a wheel that is lowered vertically onto a rail.

use std::cell::Cell;

use nalgebra::Point2;
use parry2d_f64::math::Vector;
use parry2d_f64::shape::Polyline;

use super::placed_rail::PlacedRail;
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::profile::ProfileCurve;
use crate::root::bracketed_newton;
use crate::units::MILLIMETRE;

/// Where a lowered wheel first touches the rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// World z of the lowest point of the tape circle, m: the wheel's profile origin.
    pub tape_z: f64,
    /// Arc length of the touching point on the rail, m.
    pub rail_s: f64,
    /// Arc length of the touching point on the wheel, m.
    pub wheel_s: f64,
    /// The touching point in the world frame.
    pub point: Point2<f64>,
    /// Inclination of the common tangent against the horizontal, rad, positive where it falls towards the track
    /// centre: small on the tread, about 1.22 (70°) on the flange.
    pub contact_angle: f64,
}

/// Lowers the wheel profile `wheel` (profile frame), its tape circle at the world position `tape_y` (m), onto
/// the rail until it just touches.
///
/// # Errors
/// Those of [`TouchSearch::at`].
pub fn touch(rail: &PlacedRail, wheel: &ProfileCurve, tape_y: f64) -> Result<Touch> {
    TouchSearch::new(rail, wheel).at(tape_y)
}

/// The first touches of a wheel on a rail, for many lateral positions.
///
/// The vertical gap is smallest at the touch. The bounding-volume hierarchies of the two polylines through the
/// curves' knots yield the pairs of intervals whose chords come closest over the whole overlap; on these the gap
/// of the smooth curves is minimised to round-off.
pub struct TouchSearch<'a> {
    rail: Chords<'a>,
    wheel: Chords<'a>,
}

/// A curve with the chords between its knots.
struct Chords<'a> {
    curve: &'a ProfileCurve,
    line: Polyline,
    /// How far the curve can lie from each of them, vertically, m.
    slack: Vec<f64>,
}

impl<'a> Chords<'a> {
    fn of(curve: &'a ProfileCurve) -> Self {
        Self { curve, line: chords(curve), slack: sagittas(curve) }
    }

    fn greatest_slack(&self) -> f64 {
        self.slack.iter().copied().fold(0.0, f64::max)
    }
}

impl<'a> TouchSearch<'a> {
    /// Of a wheel profile (profile frame) on a rail.
    pub fn new(rail: &'a PlacedRail, wheel: &'a ProfileCurve) -> Self {
        Self { rail: Chords::of(&rail.curve), wheel: Chords::of(wheel) }
    }

    /// The first touch with the tape circle at the world position `tape_y`, m.
    ///
    /// # Errors
    /// [`InputError`] with the field `lateral_shift` if the wheel misses the rail, or would hang on an end of
    /// one of the two curves.
    pub fn at(&self, tape_y: f64) -> Result<Touch> {
        let (rail, wheel) = (self.rail.curve, self.wheel.curve);
        let mut best: Option<(f64, f64, f64)> = None;
        for pair in self.candidates(tape_y) {
            let found = least_gap(rail, wheel, tape_y, pair);
            if best.is_none_or(|b| found.0 < b.0) {
                best = Some(found);
            }
        }
        let missed = |what: &str| {
            InputError::new(
                InputField::LateralShift,
                format!("tape circle at y = {:.3} mm", tape_y / MILLIMETRE),
                "a position at which the running surfaces of wheel and rail touch",
                format!("{what}; reduce `lateral_shift`, or check `gauge` and `flange_back`"),
            )
        };
        let (tape_z, rail_s, wheel_s) = best.ok_or_else(|| missed("the wheel misses the rail"))?;
        // SOLVER: an end counts as touched within a nanometre.
        const AT_END: f64 = 1e-9;
        let at_end = |curve: &ProfileCurve, s: f64| s < AT_END || s > curve.length() - AT_END;
        if at_end(rail, rail_s) || at_end(wheel, wheel_s) {
            return Err(missed("the wheel misses the rail and hangs on the end of a profile").into());
        }
        let tangent = rail.tangent(rail_s);
        Ok(Touch {
            tape_z,
            rail_s,
            wheel_s,
            point: rail.point(rail_s),
            contact_angle: (-tangent.y).atan2(tangent.x),
        })
    }

    /// Pairs of intervals that may hold the smallest gap, in the order of the two curves.
    fn candidates(&self, tape_y: f64) -> Vec<(usize, usize)> {
        let Self { rail, wheel } = self;
        let greatest_slack = rail.greatest_slack() + wheel.greatest_slack();
        // Upper bound of the smallest gap of the smooth curves, from the pairs seen so far.
        let bound = Cell::new(f64::INFINITY);
        // Two boxes are worth opening if they overlap laterally and may come closer than the bound.
        let promising = rail.line.bvh().leaf_pairs(wheel.line.bvh(), |a, b| {
            let (a, b) = (a.aabb(), b.aabb());
            let overlap = a.mins.x <= b.maxs.x + tape_y && b.mins.x + tape_y <= a.maxs.x;
            overlap && a.mins.y - b.maxs.y - greatest_slack <= bound.get()
        });
        let mut found = Vec::new();
        for (r, w) in promising {
            let (rail_chord, wheel_chord) = (rail.line.segment(r), wheel.line.segment(w));
            let (r, w) = (r as usize, w as usize);
            let slack = rail.slack[r] + wheel.slack[w];
            if let Some(gap) = chord_gap([rail_chord.a, rail_chord.b], [wheel_chord.a, wheel_chord.b], tape_y)
            {
                bound.set(bound.get().min(gap + slack));
                found.push((r, w, gap - slack));
            }
        }
        found.retain(|pair| pair.2 <= bound.get());
        found.sort_unstable_by_key(|pair| (pair.0, pair.1));
        found.into_iter().map(|(r, w, _)| (r, w)).collect()
    }
}

fn chords(curve: &ProfileCurve) -> Polyline {
    let vertices = curve.knots().iter().map(|&s| curve.point(s)).map(|p| Vector::new(p.x, p.y)).collect();
    Polyline::new(vertices, None)
}

/// How far, vertically, each interval of the curve can lie from its chord: the sagitta at the middle, doubled to
/// be safe, times the chord's steepness; on a nearly vertical chord its height.
fn sagittas(curve: &ProfileCurve) -> Vec<f64> {
    curve
        .knots()
        .windows(2)
        .map(|s| {
            let (a, b) = (curve.point(s[0]), curve.point(s[1]));
            let chord = b - a;
            let sagitta = 2.0 * (curve.point(0.5 * (s[0] + s[1])) - nalgebra::center(&a, &b)).norm();
            (sagitta * chord.norm() / chord.x.abs()).min(chord.y.abs() + sagitta)
        })
        .collect()
}

/// Smallest vertical gap of two chords where they overlap laterally; the wheel's are shifted by `shift`.
fn chord_gap(rail: [Vector; 2], wheel: [Vector; 2], shift: f64) -> Option<f64> {
    let wheel = wheel.map(|p| Vector::new(p.x + shift, p.y));
    let range = |c: &[Vector; 2]| (c[0].x.min(c[1].x), c[0].x.max(c[1].x));
    let ((r0, r1), (w0, w1)) = (range(&rail), range(&wheel));
    let (lo, hi) = (r0.max(w0), r1.min(w1));
    if lo > hi {
        return None;
    }
    // On a vertical chord both ends count.
    let heights = |c: &[Vector; 2], y: f64| {
        let width = c[1].x - c[0].x;
        if width == 0.0 { [c[0].y, c[1].y] } else { [c[0].y + (c[1].y - c[0].y) * (y - c[0].x) / width; 2] }
    };
    let gap_at = |y: f64| {
        let [ra, rb] = heights(&rail, y);
        let [wa, wb] = heights(&wheel, y);
        ra.min(rb) - wa.max(wb)
    };
    Some(gap_at(lo).min(gap_at(hi)))
}

/// Smallest vertical gap of the smooth curves on a pair of intervals, with the arc lengths where it is.
fn least_gap(
    rail: &ProfileCurve,
    wheel: &ProfileCurve,
    tape_y: f64,
    (rail_interval, wheel_interval): (usize, usize),
) -> (f64, f64, f64) {
    let ends = |curve: &ProfileCurve, interval: usize| [curve.knots()[interval], curve.knots()[interval + 1]];
    let (rail_ends, wheel_ends) = (ends(rail, rail_interval), ends(wheel, wheel_interval));
    let range = |curve: &ProfileCurve, ends: [f64; 2], shift: f64| {
        let y = ends.map(|s| curve.point(s).x + shift);
        (y[0].min(y[1]), y[0].max(y[1]))
    };
    let (r, w) = (range(rail, rail_ends, 0.0), range(wheel, wheel_ends, tape_y));
    let (lo, hi) = (r.0.max(w.0), r.1.min(w.1));
    let at = |y: f64| (s_on_interval(rail, rail_ends, y), s_on_interval(wheel, wheel_ends, y - tape_y));
    let gap_at = |y: f64| {
        let (rail_s, wheel_s) = at(y);
        (rail.point(rail_s).y - wheel.point(wheel_s).y, rail_s, wheel_s)
    };
    let smaller = |a: (f64, f64, f64), b: (f64, f64, f64)| if b.0 < a.0 { b } else { a };
    let best = smaller(gap_at(lo), gap_at(hi));
    // The gap's slope by y has the sign of the sine of the angle from the wheel's to the rail's tangent, and
    // that sine changes by the difference of the curvatures over the lateral progress.
    let condition = |y: f64| {
        let (rail_s, wheel_s) = at(y);
        let (t_rail, t_wheel) = (rail.tangent(rail_s), wheel.tangent(wheel_s));
        let slope = rail.curvature(rail_s) / t_rail.x - wheel.curvature(wheel_s) / t_wheel.x;
        let sense = (t_rail.x * t_wheel.x).signum();
        (sense * t_wheel.perp(&t_rail), sense * slope)
    };
    // Just inside: at the ends themselves the next interval may begin, with another tangent.
    let margin = 1e-9 * (hi - lo);
    let (lo, hi) = (lo + margin, hi - margin);
    if condition(lo).0 < 0.0 && condition(hi).0 > 0.0 {
        smaller(best, gap_at(bracketed_newton(condition, lo, hi)))
    } else {
        best
    }
}

/// Arc length between the knots `ends` at which the curve has the lateral position `y`.
fn s_on_interval(curve: &ProfileCurve, ends: [f64; 2], y: f64) -> f64 {
    let [before, after] = ends.map(|s| curve.point(s).x - y);
    let sign = if after >= before { 1.0 } else { -1.0 };
    if sign * before >= 0.0 {
        return ends[0];
    }
    if sign * after <= 0.0 {
        return ends[1];
    }
    let condition = |s: f64| {
        let (p, t) = curve.evaluate(s);
        (sign * (p.x - y), sign * t.x)
    };
    bracketed_newton(condition, ends[0], ends[1])
}
