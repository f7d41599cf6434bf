//! The rail in the track: inclined, raised to z = 0 and moved to its gauge.

use nalgebra::{Point2, Rotation2, Vector2};

use super::track::TrackGeometry;
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::profile::ProfileCurve;
use crate::root::bracketed_newton;
use crate::section::RailSection;
use crate::units::MILLIMETRE;

/// A rail in the track: world point = R(angle) · profile point + origin.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedRail {
    /// Running surface in the world frame; the arc length is that of the section's running curve.
    pub curve: ProfileCurve,
    /// Rotation, rad, from y towards z; negative for a rail that leans towards the track centre.
    pub angle: f64,
    /// World position of the origin of the profile frame, m.
    pub origin: Point2<f64>,
}

impl PlacedRail {
    /// World point of a point of the profile frame.
    pub fn to_world(&self, p: &Point2<f64>) -> Point2<f64> {
        Rotation2::new(self.angle) * p + self.origin.coords
    }

    /// Point of the profile frame at a world point.
    pub fn to_profile(&self, p: &Point2<f64>) -> Point2<f64> {
        Rotation2::new(-self.angle) * (p - self.origin.coords)
    }
}

/// Inclines the right rail towards the track centre, raises it until its highest point lies at z = 0, and moves
/// it sideways until its gauge face lies at half the gauge in the depth where the gauge is measured.
///
/// # Errors
/// [`InputError`] for a track geometry out of range, or a running surface that does not reach down to the depth
/// of the gauge.
///
/// ```
/// use railspring_profiles::placement::{TrackGeometry, place_rail};
/// use railspring_profiles::section::rail_section;
/// let rail = place_rail(&rail_section("60E1")?, &TrackGeometry::standard())?;
/// let gauge_face = rail.curve.s_at_y(0.7175).unwrap();
/// assert!((rail.curve.point(gauge_face).y - 0.014).abs() < 1e-12);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn place_rail(section: &RailSection, track: &TrackGeometry) -> Result<PlacedRail> {
    track.check()?;
    let angle = -track.inclination.atan();
    let inclined = section.running.transformed(angle, Vector2::zeros());
    let (top_interval, top_s) = highest_point(&inclined);
    let top = inclined.point(top_s).y;

    // From the top back along the gauge side: the first interval that reaches as deep as the gauge is measured.
    let knots = inclined.knots();
    let depth = |s: f64| inclined.point(s).y - top - track.gauge_height;
    let reaching = (0..=top_interval).rev().find(|&i| depth(knots[i]) >= 0.0).ok_or_else(|| {
        InputError::new(
            InputField::GaugeHeight,
            format!("{} mm", track.gauge_height / MILLIMETRE),
            "a depth that the gauge side of the rail profile reaches",
            "measure the gauge less deep, or give a profile that goes on further down the gauge side",
        )
    })?;
    let rising = |s: f64| (-depth(s), -inclined.evaluate(s).1.y);
    let gauge_s = bracketed_newton(rising, knots[reaching], knots[reaching + 1]);
    let origin = Point2::new(0.5 * track.gauge - inclined.point(gauge_s).x, -top);
    Ok(PlacedRail { curve: section.running.transformed(angle, origin.coords), angle, origin })
}

/// Interval and arc length of the point with the smallest z; the first of several.
fn highest_point(curve: &ProfileCurve) -> (usize, f64) {
    let knots = curve.knots();
    let height = |s: f64| curve.point(s).y;
    let mut knot = 0;
    for i in 1..knots.len() {
        if height(knots[i]) < height(knots[knot]) {
            knot = i;
        }
    }
    // Between the knots the curve may rise a little higher, in one of the two intervals beside the highest knot.
    let last_interval = knots.len() - 2;
    let mut best = (knot.min(last_interval), knots[knot]);
    for interval in knot.saturating_sub(1)..=knot.min(last_interval) {
        let slope = |s: f64| curve.evaluate(s).1.y;
        let start = knots[interval];
        // Just before the end: the end itself may be a kink and has the slope of the next interval.
        let end = knots[interval + 1] - 1e-9 * (knots[interval + 1] - start);
        if slope(start) < 0.0 && slope(end) > 0.0 {
            let s = bracketed_newton(|s| (slope(s), curve.curvature(s)), start, end);
            if height(s) < height(best.1) {
                best = (interval, s);
            }
        }
    }
    best
}
