//! The line on a wheel on which a rail can touch it.
//!
//! A rail is the same all along x, so the common normal has no component along x. On every circle of the wheel there
//! is one lower point with such a normal; with yaw it lies ahead of or behind the axle.

use nalgebra::{Point2, Rotation2, Vector2, Vector3};

use crate::error::{InputError, NumericsError, Result, StopReason};
use crate::profile::ProfileCurve;

/// Those points of a placed wheel, seen along the track, for a wheelset whose middle is one rolling radius above z = 0.
pub(super) struct Trace<'a> {
    wheel: &'a ProfileCurve,
    radius: f64,
    tape_y: f64,
    /// Direction of the axle.
    axle: Vector3<f64>,
    /// Lateral position and height.
    pub curve: ProfileCurve,
    shift: f64,
}

impl<'a> Trace<'a> {
    pub fn new(
        wheel: &'a ProfileCurve,
        radius: f64,
        tape_y: f64,
        shift: f64,
        yaw: f64,
        roll: f64,
    ) -> Result<Self> {
        for (key, angle) in [("wheelset.yaw", yaw), ("wheelset.roll", roll)] {
            if angle.is_nan() || angle.abs() > 0.5 {
                return InputError::refuse(
                    key,
                    format!("{angle} rad"),
                    "-0.5 to 0.5 rad",
                    "check the angle and its unit",
                );
            }
        }
        let axle = Vector3::new(-yaw.sin() * roll.cos(), yaw.cos() * roll.cos(), roll.sin());
        let origin = Vector2::new(shift, -radius);
        if axle.x == 0.0 {
            let to = Rotation2::new(roll) * Vector2::new(tape_y, radius) + origin;
            let curve = wheel.transformed(roll, to);
            return Ok(Self { wheel, radius, tape_y, axle, curve, shift });
        }
        let mut trace = Self { wheel, radius, tape_y, axle, curve: wheel.clone(), shift };
        // Where the profile is so steep that no such point exists, on the flange back, the line ends.
        let knots = wheel.knots();
        let found: Vec<Option<Point2<f64>>> =
            knots.iter().map(|&s| trace.place(s).map(|p| Point2::new(p.y, p.z) + origin)).collect();
        let middle = wheel.s_at_y(0.0).unwrap_or(0.5 * wheel.length());
        let middle = knots.partition_point(|&s| s < middle).min(knots.len() - 1);
        let first = (0..=middle).rev().take_while(|&i| found[i].is_some()).last().unwrap_or(middle);
        let last = (middle..knots.len()).take_while(|&i| found[i].is_some()).last().unwrap_or(middle);
        let points: Vec<Point2<f64>> = found[first..=last].iter().flatten().copied().collect();
        let breaks: Vec<usize> = wheel
            .breakpoints()
            .iter()
            .map(|&s| knots.partition_point(|&knot| knot < s))
            .filter(|&i| i > first && i < last)
            .map(|i| i - first)
            .collect();
        trace.curve = ProfileCurve::from_points(&points, &breaks)?;
        Ok(trace)
    }

    /// Point of the circle at the arc length `s` of the profile, from the middle of the wheelset.
    fn place(&self, s: f64) -> Option<Vector3<f64>> {
        let (profile, derivative) = self.wheel.evaluate(s);
        let across = (1.0 - self.axle.x * self.axle.x).sqrt();
        // The normal r - R' a has no x component: r_x = R' a_x.
        let sin = derivative.y / derivative.x * self.axle.x / across;
        if sin.is_nan() || sin.abs() >= 1.0 {
            return None;
        }
        let forward = (Vector3::x() - self.axle.x * self.axle) / across;
        let down = Vector3::new(0.0, -self.axle.z, self.axle.y) / across;
        let radial = sin * forward + (1.0 - sin * sin).sqrt() * down;
        Some((self.tape_y + profile.x) * self.axle + (self.radius + profile.y) * radial)
    }

    /// Arc length on the wheel of the arc length `s` on the curve, where the curve runs to the field side.
    ///
    /// # Errors
    /// [`NumericsError`] where the curve turns back.
    pub fn wheel_s(&self, s: f64) -> Result<f64> {
        if self.axle.x == 0.0 {
            return Ok(s);
        }
        const MAX_STEPS: usize = 60;
        // SOLVER: the lateral place, m.
        const SETTLED: f64 = 1e-12;
        let y = self.curve.point(s).x;
        // Yaw moves the places by little: the profile's own slope serves.
        let mut found = self.wheel.s_at_y(y - self.shift - self.tape_y).unwrap_or(0.5 * self.wheel.length());
        let mut off = f64::NAN;
        for _ in 0..MAX_STEPS {
            let Some(place) = self.place(found) else { break };
            off = place.y + self.shift - y;
            if off.abs() < SETTLED {
                return Ok(found);
            }
            found = (found - off / self.wheel.evaluate(found).1.x).clamp(0.0, self.wheel.length());
        }
        Err(NumericsError::new("yawed wheel", StopReason::IterationLimit, off, 1).after(MAX_STEPS).into())
    }

    /// How far ahead of the wheelset's middle the point at the wheel's arc length `s` lies.
    pub fn ahead(&self, s: f64) -> f64 {
        if self.axle.x == 0.0 { 0.0 } else { self.place(s).map_or(f64::NAN, |p| p.x) }
    }
}
