//! The wheel as hub, modes and the static rest, as seen at the section of its rim that touches.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// A wheel on its hub: its mass, its modes with the hub held, and what its rim has of either. Coordinates are displacements y and z
/// (m) and the rotation about x (rad).
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticWheel {
    /// Mass between the motions of the hub, as those of a rigid body about the hub's centre; kg, kg·m, kg·m².
    pub mass: Matrix3<f64>,
    /// From the rim's reference point to the hub's centre (y, z), m.
    pub hub: [f64; 2],
    /// Modes with the hub held that move the rim, by ascending frequency.
    pub modes: Vec<RimMode>,
    /// Flexibility of the rim's section, the hub held, beyond the modes: displacements (m) and rotation (rad) under forces (N) and a torque
    /// (N·m).
    pub rest: Matrix3<f64>,
}

/// A mode of mass 1 kg of the wheel with its hub held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimMode {
    /// Square of its angular frequency, 1/s².
    pub square: f64,
    /// Motion of the rim's section in the mode.
    pub rim: Vector3<f64>,
    /// Mass between the mode and the motions of the hub.
    pub coupling: Vector3<f64>,
}

impl ElasticWheel {
    /// Flexibility of the rim's section, the hub held.
    pub fn rim_flexibility(&self) -> Matrix3<f64> {
        self.modes.iter().fold(self.rest, |sum, mode| sum + mode.flexibility())
    }

    /// What of its mass does not move in the modes, between the motions of the hub.
    pub fn mass_beside_modes(&self) -> Matrix3<f64> {
        self.modes.iter().fold(self.mass, |mass, mode| mass - mode.coupling * mode.coupling.transpose())
    }

    /// Motion of the rim's section under unit motions of the hub.
    pub fn carried_by_hub(&self) -> Matrix3<f64> {
        let mut carried = Matrix3::identity();
        // the rim's reference point as seen from the hub
        carried[(0, 2)] = self.hub[1];
        carried[(1, 2)] = -self.hub[0];
        carried
    }
}

impl RimMode {
    /// Flexibility of the rim's section in the mode.
    pub fn flexibility(&self) -> Matrix3<f64> {
        self.rim * self.rim.transpose() / self.square
    }
}

/// The nearest flexibility of a section (y, z, rotation about x) that stores no negative energy: what is negative is the misfit of the section.
pub fn positive(matrix: Matrix3<f64>) -> Matrix3<f64> {
    // rotations as displacements at a lever of the profile's size
    const LEVER: f64 = 0.03;
    let scale = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, LEVER));
    let back = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1.0 / LEVER));
    let parts = SymmetricEigen::new(scale * matrix * scale);
    let values = parts.eigenvalues.map(|value| value.max(0.0));
    back * parts.eigenvectors * Matrix3::from_diagonal(&values) * parts.eigenvectors.transpose() * back
}
