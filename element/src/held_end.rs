//! The head of a rail near an end that is held.

use nalgebra::{Matrix3, Rotation3, Vector3};

/// How the head of a rail moves near a held end.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldEnd {
    /// Length at an end that has no shear flexibility, m, as of `HeldRail` of the beams.
    pub inset: f64,
    /// The head against such a rail, by ascending distance from the nearer end; beyond the last as there.
    pub places: Vec<EndPlace>,
}

/// The head at a distance from an end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndPlace {
    /// The distance, m.
    pub distance: f64,
    /// Its flexibility against the rail, about the node line, in world axes: displacements y and z (m) and rotation about x (rad) under forces (N) and a torque (N·m).
    pub flexibility: Matrix3<f64>,
    /// Its motion under a torque of 1 N·m on the section in the middle of the rail, beyond the rotation of such a rail.
    pub twist: Vector3<f64>,
}

/// Flexibilities along the axes of a section that is turned by an `angle`, in world axes.
pub fn in_world(angle: f64, [y, z, turned]: [f64; 3]) -> Matrix3<f64> {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    turn * Matrix3::from_diagonal(&Vector3::new(y, z, turned)) * turn.inverse()
}
