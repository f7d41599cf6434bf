//! Rail and wheel in the track: inclination, gauge, and the wheel lowered until it just touches.
//!
//! World frame: y from the track centre to the field side of the right rail, z down from the highest point of
//! the placed rail.

mod departure;
mod touch;

use nalgebra::{Point2, Rotation2, Vector2};

use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::profile::ProfileCurve;
use crate::root::bracketed_newton;
use crate::section::RailSection;
use crate::units::MILLIMETRE;

pub use departure::{Departure, departure, lateral_extent};
pub use touch::{Touch, touch};

/// Where rails and wheels are in the track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackGeometry {
    /// Distance of the gauge faces, m.
    pub gauge: f64,
    /// Depth below the top of the inclined rail at which the gauge is measured, m.
    pub gauge_height: f64,
    /// Distance of the flange backs of a wheelset, m.
    pub flange_back: f64,
    /// Slope by which the rail leans towards the track centre, for instance 1/40.
    pub inclination: f64,
    /// Lateral shift of the wheelset, m, positive towards the field side of the right rail.
    pub lateral_shift: f64,
}

impl TrackGeometry {
    /// Standard gauge: 1435 mm measured 14 mm below the top, flange backs 1360 mm, inclination 1:40, no shift.
    pub fn standard() -> Self {
        Self {
            gauge: 1.435,
            gauge_height: 0.014,
            flange_back: 1.360,
            inclination: 1.0 / 40.0,
            lateral_shift: 0.0,
        }
    }

    /// Lateral position of the right wheel's tape circle, m: the `wheel` (profile frame) begins at the flange back.
    ///
    /// ```
    /// use railspring_profiles::placement::TrackGeometry;
    /// use railspring_profiles::profile::wheels::wheel_profile;
    /// let track = TrackGeometry::standard();
    /// assert!((track.tape_y(&wheel_profile("S1002")?) - 0.750).abs() < 1e-15);
    /// // 2 27/32 inches instead of 70 mm from the flange back
    /// assert!((track.tape_y(&wheel_profile("APTA120")?) - 0.752231).abs() < 1e-6);
    /// # Ok::<(), railspring_profiles::error::Error>(())
    /// ```
    pub fn tape_y(&self, wheel: &ProfileCurve) -> f64 {
        0.5 * self.flange_back - wheel.point(0.0).x + self.lateral_shift
    }

    /// Checks every value against what a track can have.
    ///
    /// # Errors
    /// [`InputError`] naming the field of the first value out of range.
    pub fn check(&self) -> Result<()> {
        let in_millimetres = [
            (InputField::Gauge, self.gauge, 300.0, 3000.0),
            (InputField::GaugeHeight, self.gauge_height, 1.0, 30.0),
            (InputField::FlangeBack, self.flange_back, 250.0, 3000.0),
            (InputField::LateralShift, self.lateral_shift, -100.0, 100.0),
        ];
        for (field, value, least, greatest) in in_millimetres {
            if !(least..=greatest).contains(&(value / MILLIMETRE)) {
                return Err(InputError::new(
                    field,
                    format!("{} mm", value / MILLIMETRE),
                    format!("{least} to {greatest} mm"),
                    "check the value and its unit",
                )
                .into());
            }
        }
        if !(-0.2..=0.2).contains(&self.inclination) {
            return Err(InputError::new(
                InputField::Inclination,
                self.inclination,
                "a slope between -0.2 and 0.2",
                "give the slope, for instance 0.025 for 1:40",
            )
            .into());
        }
        Ok(())
    }
}

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
