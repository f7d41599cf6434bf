//! A curve followed from one of its places to an end.

use nalgebra::Point2;

use super::curve::ProfileCurve;
use crate::units::MILLIMETRE;

/// Longest step, m.
const STEP: f64 = 0.25 * MILLIMETRE;
/// Half of the chord whose direction is that of the surface, m: scatter of 20 µm turns it by less than a degree.
const HALF_CHORD: f64 = 1.0 * MILLIMETRE;

/// A place of a surface that is followed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Followed {
    /// Arc length, m.
    pub s: f64,
    /// The point there.
    pub point: Point2<f64>,
    /// Direction in which the surface goes on, without its scatter: degrees from the horizontal, positive downwards.
    pub descent: f64,
}

impl ProfileCurve {
    /// Places no more than 0.25 mm apart from `start` on to an end of the curve; `sign` is the sense in which s changes, and y too where the surface is
    /// level.
    pub(crate) fn followed(&self, start: f64, sign: f64) -> Vec<Followed> {
        let way = if sign > 0.0 { self.length() - start } else { start };
        let count = (way / STEP).ceil().max(1.0) as usize;
        let at = |s: f64| self.point(s.clamp(0.0, self.length()));
        (0..=count)
            .map(|i| {
                let s = start + sign * way * i as f64 / count as f64;
                let chord = at(s + sign * HALF_CHORD) - at(s - sign * HALF_CHORD);
                Followed { s, point: at(s), descent: chord.y.atan2(sign * chord.x).to_degrees() }
            })
            .collect()
    }
}
