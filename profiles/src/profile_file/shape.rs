//! What the shape of a profile tells: wheel or rail, which side is up, where the flange is.

use super::check::median;
use super::measured::MeasuredPoint;
use crate::profile::ProfileKind;

/// Part of the width at either end whose largest departure from the middle counts.
const END: f64 = 0.15;
/// Part of the width about the middle.
const MIDDLE: f64 = 0.3;
/// Part of a wheel's width at either end that is left out: its faces, which go the other way than the flange.
const FACE: f64 = 0.01;
/// A departure above this part of the width is a flange or the side of a head.
const STEEP: f64 = 0.1;
/// A departure below this part of the width is the end of a tread.
const FLAT: f64 = 0.08;
/// Width that divides rails from wheels, m: heads are up to 76 mm wide, wheels from 120 mm.
const RAIL_OR_WHEEL: f64 = 0.095;

/// Departures of the two ends of a profile from its middle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// Width, m.
    width: f64,
    /// Signed departure in z at the end of small y, m.
    low: f64,
    /// The same at the end of large y.
    high: f64,
}

impl Shape {
    /// Shape of some points (m), in any order; `None` for points without width.
    pub fn of(points: &[MeasuredPoint]) -> Option<Self> {
        let range = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
            (low.min(p.point.x), high.max(p.point.x))
        });
        let width = range.1 - range.0;
        if width.is_nan() || width <= 0.0 {
            return None;
        }
        let part = |p: &MeasuredPoint| (p.point.x - range.0) / width;
        let mut middle: Vec<f64> =
            points.iter().filter(|p| (part(p) - 0.5).abs() < 0.5 * MIDDLE).map(|p| p.point.y).collect();
        if middle.is_empty() {
            let nearest =
                points.iter().min_by(|a, b| (part(a) - 0.5).abs().total_cmp(&(part(b) - 0.5).abs()))?;
            middle.push(nearest.point.y);
        }
        let level = median(middle);
        let departure = |at_end: &dyn Fn(f64) -> bool| {
            points
                .iter()
                .filter(|p| at_end(part(p)))
                .map(|p| p.point.y - level)
                .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
        };
        let outermost = if width > RAIL_OR_WHEEL { FACE } else { -1.0 };
        let low = departure(&|t| t <= END && t >= outermost);
        let high = departure(&|t| t >= 1.0 - END && t <= 1.0 - outermost);
        Some(Self { width, low, high })
    }

    /// Wheel or rail, where the shape says so clearly.
    pub fn kind(&self) -> Option<ProfileKind> {
        let [less, more] = self.departures();
        if self.width < RAIL_OR_WHEEL && less > STEEP && self.low * self.high > 0.0 {
            Some(ProfileKind::Rail)
        } else if self.width > RAIL_OR_WHEEL && more > STEEP && less < FLAT {
            Some(ProfileKind::Wheel)
        } else {
            None
        }
    }

    /// Whether z counts upwards, if the shape tells.
    pub fn upside_down(&self, kind: ProfileKind) -> Option<bool> {
        let sum = match kind {
            ProfileKind::Rail => self.low + self.high,
            ProfileKind::Wheel => self.flange(),
        };
        (sum.abs() > 0.5 * STEEP * self.width).then_some(sum < 0.0)
    }

    /// Whether the flange of a wheel is at the end of large y, if the shape tells.
    pub fn flange_at_large_y(&self) -> Option<bool> {
        let [less, more] = self.departures();
        (more > STEEP && more > 1.5 * less).then_some(self.high.abs() > self.low.abs())
    }

    fn flange(&self) -> f64 {
        if self.high.abs() > self.low.abs() { self.high } else { self.low }
    }

    /// Departures as parts of the width, the smaller first.
    fn departures(&self) -> [f64; 2] {
        let (a, b) = (self.low.abs() / self.width, self.high.abs() / self.width);
        [a.min(b), a.max(b)]
    }
}
