//! The axle of a wheel whose rotations a load case frees.

use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::Material;

/// Stiffness of the axle against the rotation of a wheel about the track or about the vertical, N·m/rad: a beam of the diameter of the hub's bore between the two wheels, of which one turns it at its end while the
/// other one stands, 3EI/L. A wheel without it would roll over under the first lateral force.
pub(crate) fn axle_stiffness(pair: &Pair, material: &Material) -> f64 {
    let diameter = 2.0 * pair.wheel.bore_radius;
    let inertia = std::f64::consts::PI * diameter.powi(4) / 64.0;
    3.0 * material.young * inertia / (2.0 * pair.tape_y)
}
