//! A wheelset on its rails: its position in the track, and the points at which its wheels touch.

use nalgebra::Point3;

use super::{clearance, trace};
use crate::error::{NumericsError, Result, StopReason};
use crate::placement::PlacedRail;
use crate::profile::ProfileCurve;

/// A wheel and the rail under it, as on the right side of the track.
#[derive(Debug, Clone, PartialEq)]
pub struct WheelOnRail {
    /// The rail in the track.
    pub rail: PlacedRail,
    /// Running surface of the wheel in its profile frame.
    pub wheel: ProfileCurve,
    /// Rolling radius at the tape circle, m.
    pub radius: f64,
}

/// Two wheels on their axle, above their rails.
#[derive(Debug, Clone, PartialEq)]
pub struct Wheelset {
    /// Left side, in its mirror image.
    pub left: WheelOnRail,
    /// Right side.
    pub right: WheelOnRail,
    /// Distance of the tape circles from the middle of the wheelset, m.
    pub tape_y: f64,
}

/// How the wheelset's roll is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Roll {
    /// Given, rad: either wheel is lowered by itself until it touches.
    Fixed(f64),
    /// Such that both wheels touch.
    Coupled,
}

/// Position of a wheelset in the track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelsetPosition {
    /// Lateral shift, m, positive to the right.
    pub lateral_shift: f64,
    /// Yaw, rad, positive when the right wheel lags.
    pub yaw: f64,
    /// Roll.
    pub roll: Roll,
}

/// A place where wheel and rail touch or nearly do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// How much further the wheel would have to be lowered to touch here too, m.
    pub gap: f64,
    /// Place on the rail in the world frame: x ahead of the wheelset's middle, m.
    pub point: Point3<f64>,
    /// Arc length on the rail, m.
    pub rail_s: f64,
    /// Arc length on the wheel, m.
    pub wheel_s: f64,
    /// Inclination of the common tangent against the horizontal, rad, positive where it falls towards the track
    /// centre.
    pub contact_angle: f64,
    /// Distance from the axle, m.
    pub rolling_radius: f64,
    /// Curvature of the rail's profile, 1/m, positive on its crown.
    pub rail_curvature: f64,
    /// Curvature of the wheel's profile, 1/m, positive where the wheel bulges.
    pub wheel_curvature: f64,
}

/// One wheel that has been lowered onto its rail.
#[derive(Debug, Clone, PartialEq)]
pub struct SideContact {
    /// How far the middle of the wheelset lies below the height at which a wheel without roll would have its tape
    /// circle's lowest point at z = 0, m.
    pub height: f64,
    /// The touching point, and after it all others within the gap asked for, by their gap.
    pub points: Vec<ContactPoint>,
}

/// Both wheels on their rails.
#[derive(Debug, Clone, PartialEq)]
pub struct WheelsetContact {
    /// The roll, rad.
    pub roll: f64,
    /// Left side, in its mirror image.
    pub left: SideContact,
    /// Right side.
    pub right: SideContact,
}

impl WheelOnRail {
    /// Lowers this wheel at the given shift, yaw and roll onto its rail and finds every local minimum of the clearance
    /// that is at most `gap` (m) above the touching one.
    ///
    /// # Errors
    /// [`crate::error::InputError`] with the field `lateral_shift` if the wheel misses the rail or would hang on
    /// an end of a profile.
    pub fn lower(&self, tape_y: f64, shift: f64, yaw: f64, roll: f64, gap: f64) -> Result<SideContact> {
        let trace = trace::Trace::new(&self.wheel, self.radius, tape_y, shift, yaw, roll)?;
        let (height, minima) = clearance::minima(&self.rail.curve, &trace.curve, shift + tape_y, gap)?;
        let points = minima
            .iter()
            .map(|minimum| {
                let (point, tangent) =
                    (self.rail.curve.point(minimum.rail_s), self.rail.curve.tangent(minimum.rail_s));
                let wheel_s = trace.wheel_s(minimum.wheel_s)?;
                Ok(ContactPoint {
                    gap: minimum.gap,
                    point: Point3::new(trace.ahead(wheel_s), point.x, point.y),
                    rail_s: minimum.rail_s,
                    wheel_s,
                    contact_angle: (-tangent.y).atan2(tangent.x),
                    rolling_radius: self.radius + self.wheel.point(wheel_s).y,
                    rail_curvature: self.rail.curve.curvature(minimum.rail_s),
                    // The wheel's material lies above its curve.
                    wheel_curvature: -self.wheel.curvature(wheel_s),
                })
            })
            .collect::<Result<_>>()?;
        Ok(SideContact { height, points })
    }
}

impl Wheelset {
    /// A wheelset with two equal wheels on two equal rails.
    pub fn symmetric(side: WheelOnRail, tape_y: f64) -> Self {
        Self { left: side.clone(), right: side, tape_y }
    }

    /// Contact points of both wheels, those within `gap` (m) of touching included.
    ///
    /// # Errors
    /// As [`WheelOnRail::lower`]; [`NumericsError`] when no roll lets both wheels touch.
    pub fn contacts(&self, position: &WheelsetPosition, gap: f64) -> Result<WheelsetContact> {
        let WheelsetPosition { lateral_shift, yaw, roll } = *position;
        // The mirror turns shift, yaw and roll around.
        let at = |roll: f64, gap: f64| -> Result<WheelsetContact> {
            Ok(WheelsetContact {
                roll,
                left: self.left.lower(self.tape_y, -lateral_shift, -yaw, -roll, gap)?,
                right: self.right.lower(self.tape_y, lateral_shift, yaw, roll, gap)?,
            })
        };
        let mut roll = match roll {
            Roll::Fixed(roll) => return at(roll, gap),
            Roll::Coupled => 0.0,
        };
        const MAX_STEPS: usize = 50;
        // SOLVER: difference of the two wheels' heights, m: a nanometre, far below what profiles are known to.
        const LEVEL: f64 = 1e-9;
        // Fall of the difference with the roll: on the treads nearly the distance of the tape circles, on a flange
        // the roll's lateral motion adds to it. Secant steps find it.
        let mut fall = 2.0 * self.tape_y;
        let mut last: Option<(f64, f64)> = None;
        let mut difference = f64::NAN;
        for _ in 0..MAX_STEPS {
            let both = at(roll, 0.0)?;
            difference = both.right.height - both.left.height;
            if difference.abs() < LEVEL {
                return at(roll, gap);
            }
            if let Some((before, difference_before)) = last {
                let secant = (difference_before - difference) / (roll - before);
                if secant > 0.1 * self.tape_y && secant < 20.0 * self.tape_y {
                    fall = secant;
                }
            }
            last = Some((roll, difference));
            roll += difference / fall;
        }
        Err(NumericsError::new("wheelset roll", StopReason::IterationLimit, difference, 0)
            .after(MAX_STEPS)
            .into())
    }
}
