//! One place of the rail against the wheel.

use nalgebra::{Point2, Rotation2, Vector2};

/// Least cosine of the angle between both profiles where they can touch.
pub(super) const LEAST_COSINE: f64 = 0.3;

/// The rail's profile in the wheel's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turned {
    pub(super) turn: Rotation2<f64>,
    pub(super) by: Vector2<f64>,
    /// The wheel in the world.
    pub wheel: Rotation2<f64>,
}

/// One place of the rail against the wheel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facing {
    /// Arc length on the wheel, m.
    pub wheel_s: f64,
    /// How far the bodies overlap along the rail's normal, m.
    pub penetration: f64,
    /// Change of the penetration along the rail, but for the curvature times the overlap.
    pub slope: f64,
    /// Weight of a relief and of the loads that make it.
    pub weight: f64,
    /// Cosine of the angle between the profiles.
    pub cosine: f64,
    /// Outward normal of the wheel, in the wheel's frame, and the change of its tangent along it, 1/m.
    pub outward: Vector2<f64>,
    /// See `outward`.
    pub bend: Vector2<f64>,
    /// Tangent of the rail, in the wheel's frame.
    pub along: Vector2<f64>,
    /// The rail's point in the wheel's frame.
    pub point: Point2<f64>,
}

impl Turned {
    pub(super) fn at(&self, point: &Point2<f64>) -> Point2<f64> {
        Point2::from(self.turn * point.coords + self.by)
    }
}

impl Facing {
    /// From the place of the rail in the wheel's frame with its normal and the tangent across it, and the `foot` on the wheel: its arc length, point, tangent and the
    /// change of that.
    pub(super) fn new(
        point: Point2<f64>,
        normal: Vector2<f64>,
        along: Vector2<f64>,
        (wheel_s, foot, tangent, bend): (f64, Point2<f64>, Vector2<f64>, Vector2<f64>),
    ) -> Option<Self> {
        let cosine = along.dot(&tangent);
        if cosine < LEAST_COSINE {
            return None;
        }
        // the wheel's outward normal, towards the rail
        let outward = Vector2::new(-tangent.y, tangent.x);
        Some(Self {
            wheel_s,
            penetration: (point - foot).dot(&normal),
            slope: -normal.dot(&tangent) / cosine,
            weight: 0.0,
            cosine,
            outward,
            bend,
            along,
            point,
        })
    }
}
