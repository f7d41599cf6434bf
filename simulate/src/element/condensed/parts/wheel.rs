//! The wheel of an element from its condensed body.

use super::sections::{RunningSurface, SectionFlexibility};
use nalgebra::{DMatrix, DVector, Matrix3, Point2, SymmetricEigen, Vector3};
use railspring_calibrate::superelement::{Modes, carried};
use railspring_element::wheel::{ElasticWheel, RimMode, positive};
use railspring_profiles::error::{InputError, Result};
use std::f64::consts::TAU;

/// The wheel has all of its modes up to this frequency, Hz. A mode above it counts as statics, or as a mode
/// where its inertia matters at [`SWINGS`].
const HIGHEST: f64 = 600.0;
/// Highest frequency at which a wheel swings on its contact spring, Hz.
const SWINGS: f64 = 300.0;
/// Largest error at [`SWINGS`] of a mode that counts as statics, over the flexibility of rim and contact.
const MOST_WRONG: f64 = 0.02;

/// A mode that has less than this share of the flexibility of the rim in each direction does not move it: half of the modes of a wheel of revolution stand still where it touches.
const LEAST_MOVED: f64 = 1e-4;

/// Stiffness of a usual contact, N/m.
const CONTACT: f64 = 1e9;

/// Motions of the hub that a wheel in the plane of the section has: y, z, rotation about x.
const MOTIONS: [usize; 3] = [1, 2, 3];

/// A wheel from its surface and modes: those that move the rim up to 600 Hz, and as many more as the rim needs at 300 Hz, as modes, the others as statics. `rim` is
/// the flexibility of its section about the point `about` (y, z of the body's frame; m).
///
/// # Errors
/// [`InputError`] for modes without stiffness.
pub fn elastic_wheel(
    surface: &RunningSurface,
    modes: &Modes,
    rim: &SectionFlexibility,
    about: Point2<f64>,
) -> Result<ElasticWheel> {
    let count = modes.count();
    let rows = rigid_rows(surface, modes, about);
    let natural = SymmetricEigen::new(modes.stiffness(count));
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| natural.eigenvalues[a].total_cmp(&natural.eigenvalues[b]));
    let mut all = Vec::new();
    for &n in &order {
        let (square, shape) = (natural.eigenvalues[n], natural.eigenvectors.column(n));
        if square <= 0.0 {
            let (value, expected) = (format!("{square} 1/s²"), "modes of a body that is held");
            return InputError::refuse("modes", value, expected, "condense the wheel again");
        }
        let along = |row: &DVector<f64>| row.dot(&shape);
        let rim = Vector3::from_fn(|i, _| along(&rows[i]));
        let coupling = Vector3::from_fn(|i, _| {
            (0..count).map(|mode| modes.coupling(MOTIONS[i], mode) * shape[mode]).sum()
        });
        all.push(RimMode { square, rim, coupling });
    }
    all.retain(|mode| moves(mode, &rim.flexibility));
    all.truncate(needed(&all, &rim.flexibility));
    let rest = all.iter().fold(rim.flexibility, |rest, mode| rest - mode.flexibility());
    let master = modes.rigid_motion(&nalgebra::Point3::origin(), 3);
    // a rotation about x moves the origin by (-z, y) of its arm
    let centre = Point2::new(-master.z, master.y);
    let hub = [centre.x - about.x, centre.y - about.y];
    let mass = Matrix3::from_fn(|i, j| modes.rigid_mass(MOTIONS[i], MOTIONS[j]));
    Ok(ElasticWheel { mass, hub, modes: all, rest: positive(rest) })
}

/// Whether a mode moves a `rim` of a flexibility.
fn moves(mode: &RimMode, rim: &Matrix3<f64>) -> bool {
    let own = mode.flexibility();
    (0..3).any(|i| own[(i, i)] > LEAST_MOVED * rim[(i, i)])
}

/// How many of the modes by ascending frequency a rim of a flexibility moves in, in series with a contact that does not turn.
///
/// A mode has `1/(1 - (f/fₙ)²)` of its static flexibility at a frequency `f` below its own, so that it is `(f/fₙ)²/(1 - (f/fₙ)²)` of that off where it follows the forces at once.
fn needed(modes: &[RimMode], rim: &Matrix3<f64>) -> usize {
    let square = |frequency: f64| (TAU * frequency).powi(2);
    let wrong = |mode: &RimMode| {
        let ratio = square(SWINGS) / mode.square;
        mode.rim.component_mul(&mode.rim) * (ratio / (mode.square * (1.0 - ratio)))
    };
    let first = modes.partition_point(|mode| mode.square <= square(HIGHEST));
    let suffices = |count: &usize| {
        let left: Vector3<f64> = modes[*count..].iter().map(wrong).sum();
        let contact = [1.0 / CONTACT, 1.0 / CONTACT, 0.0];
        (0..3).all(|i| left[i] <= MOST_WRONG * (rim[(i, i)] + contact[i]))
    };
    (first..modes.len()).find(suffices).unwrap_or(modes.len())
}

/// Rows of the section's motion (y, z, rotation) of the modes: the rigid motion nearest to the displacements of the profile.
fn rigid_rows(surface: &RunningSurface, modes: &Modes, about: Point2<f64>) -> [DVector<f64>; 3] {
    let places = surface.profile();
    let nodes = surface.profile_nodes();
    let arms: Vec<_> = places.iter().map(|p| carried(&(p - about))).collect();
    let normal: Matrix3<f64> = arms.iter().map(|arm| arm.transpose() * arm).sum();
    let inverse = normal.try_inverse().unwrap_or_else(Matrix3::zeros);
    let motions = DMatrix::from_columns(
        &(0..modes.count())
            .map(|mode| {
                let shape = modes.contact(mode);
                let right: Vector3<f64> = arms
                    .iter()
                    .zip(&nodes)
                    .map(|(arm, n)| {
                        arm.transpose() * nalgebra::Vector2::new(shape[3 * n + 1], shape[3 * n + 2])
                    })
                    .sum();
                DVector::from_column_slice((inverse * right).as_slice())
            })
            .collect::<Vec<_>>(),
    );
    [0, 1, 2].map(|i| motions.row(i).transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: a mode below its resonance. Goal: modes up to 600 Hz are needed, and none beyond the last one
    /// that is. A mode of 900 Hz would be wrong by 16 % at 300 Hz. It is needed where it has so much of the
    /// rim's flexibility that this is more than 2 % of the flexibility of rim and contact, in any direction.
    #[test]
    fn modes_are_needed_as_far_as_the_rim_is_right() {
        let flexibility = Matrix3::from_diagonal(&Vector3::new(1e-8, 1e-10, 2e-7));
        let mode = |frequency: f64, direction: usize, share: f64| {
            let square = (TAU * frequency).powi(2);
            let mut rim = Vector3::zeros();
            let contact = if direction < 2 { 1e-9 } else { 0.0 };
            rim[direction] = (share * (flexibility[(direction, direction)] + contact) * square).sqrt();
            RimMode { square, rim, coupling: Vector3::zeros() }
        };
        let low = [mode(190.0, 0, 0.5), mode(590.0, 1, 0.0)];
        for direction in 0..3 {
            for (share, expected) in [(0.15, 2), (0.17, 3)] {
                let modes = [low[0], low[1], mode(900.0, direction, share), mode(1500.0, direction, 0.01)];
                assert_eq!(needed(&modes, &flexibility), expected, "{direction} {share}");
            }
        }
        assert_eq!(needed(&low, &flexibility), 2);
    }

    /// Source: half of the modes of a wheel of revolution have a node where it touches. Goal: a mode moves the rim from a ten-thousandth of the flexibility in any direction on.
    #[test]
    fn a_mode_with_a_node_at_the_contact_does_not_move_the_rim() {
        let flexibility = Matrix3::from_diagonal(&Vector3::new(1e-8, 1e-10, 2e-7));
        let square = (TAU * 190.0_f64).powi(2);
        let mode = |direction: usize, share: f64| {
            let mut rim = Vector3::zeros();
            rim[direction] = (share * flexibility[(direction, direction)] * square).sqrt();
            RimMode { square, rim, coupling: Vector3::zeros() }
        };
        for direction in 0..3 {
            assert!(moves(&mode(direction, 1.1e-4), &flexibility), "{direction}");
            assert!(!moves(&mode(direction, 0.9e-4), &flexibility), "{direction}");
        }
    }
}
