//! A contact as the sum of its strips, and all contacts together.

use nalgebra::{Matrix3, Point2, Vector2, Vector3};

/// A contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Contact {
    /// Arc lengths on the rail between which the bodies overlap where the strips were found, m.
    pub extent: [f64; 2],
    /// Normal forces on the wheel (y, z; N) and their moment about the wheel's reference point where that is now, N·m.
    pub force: Vector3<f64>,
    /// Potential of them, J.
    pub energy: f64,
    /// Their stiffness against motions of the wheel, as `force`.
    pub stiffness: Matrix3<f64>,
    /// Normal force, N, and its stiffness against a motion along itself, N/m.
    pub normal_force: f64,
    /// See `normal_force`.
    pub normal_stiffness: f64,
    /// Friction forces on the wheel, as `force`.
    pub friction: Vector3<f64>,
    /// Minus their derivative by the motion of the wheel.
    pub friction_stiffness: Matrix3<f64>,
    /// Stiffness of all strips along their tangents, N/m, and of those that slide.
    pub tangential_stiffness: f64,
    /// See `tangential_stiffness`.
    pub sliding_stiffness: f64,
    /// Elastic energy of friction, J.
    pub stored: f64,
    /// Whether a strip sticks, and the share of the normal force on strips that slide.
    pub sticks: bool,
    /// See `sticks`.
    pub sliding_share: f64,
    /// Where the normal force acts: world (y, z), m.
    pub point: Point2<f64>,
    /// Arc length of that on the rail, m, and on the wheel.
    pub rail_s: f64,
    /// See `rail_s`.
    pub wheel_s: f64,
}

impl Contact {
    /// Direction of the normal force on the wheel, world (y, z).
    pub(super) fn normal(&self) -> Vector2<f64> {
        if self.normal_force > 0.0 { self.force.xy() / self.normal_force } else { Vector2::zeros() }
    }

    /// Friction force on the wheel a quarter of a turn from the normal one, N.
    pub fn tangential_force(&self) -> f64 {
        let normal = self.normal();
        self.friction.xy().dot(&Vector2::new(-normal.y, normal.x))
    }
}

/// All contacts together, with the relief that their forces make.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Relieved {
    /// Forces on the wheel, friction included.
    pub force: Vector3<f64>,
    /// Minus their derivative by the motion of the wheel.
    pub stiffness: Matrix3<f64>,
    /// What that relief differs by from the one with which the forces were summed, m.
    pub off: f64,
    /// Potential of the relief, J.
    pub energy: f64,
    /// So far the wheel can move against the rail, m, before there may be another contact, or one may part.
    pub gap: f64,
}
