//! The matrices of the published contact element, equations (1) to (15).
//!
//! Axes: the published 1-2-3 axes are lateral to the field side (world y), up
//! (world −z), and backwards along the track (world −x), so that they are
//! right-handed; [`to_plane`] maps between them. The pair of a contact is
//! (wheel point, rail node); local components are along the tangent of the
//! wheel's spline and along its normal *into* the wheel. A relative
//! displacement is that of the rail node against the wheel, so that a positive
//! normal one is penetration.

use nalgebra::{Matrix2, Matrix4, SMatrix, Vector2, Vector3};

use crate::time::history::ContactMode;

/// Components 1 and 2 of a world vector (y, z), and the reverse: the map is its own inverse.
pub fn to_plane(world: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(world.x, -world.y)
}

/// Unit vectors of the directions 1, 2 and 3 in the world axes (x, y, z).
pub fn directions() -> [Vector3<f64>; 3] {
    [Vector3::y(), -Vector3::z(), -Vector3::x()]
}

/// Contact stiffness in local axes (tangent, normal), N/m: equations (1) for sticking, (2) for
/// separation and (3) for sliding. `friction` carries the sign of the friction force; the sliding matrix is not symmetric.
pub fn contact_stiffness(mode: ContactMode, penalty: f64, friction: f64) -> Matrix2<f64> {
    match mode {
        ContactMode::Stick => Matrix2::new(penalty, 0.0, 0.0, penalty),
        ContactMode::Separated => Matrix2::zeros(),
        ContactMode::Slip => Matrix2::new(0.0, friction * penalty, 0.0, penalty),
    }
}

/// Equation (4): the symmetric alternative to the sliding matrix of equation (3).
pub fn symmetric_sliding_stiffness(penalty: f64, friction: f64) -> Matrix2<f64> {
    Matrix2::new(friction * friction, friction, friction, 1.0) * penalty
}

/// Equation (6): rotation from the 1-2 axes to the local axes along the unit `tangent`.
pub fn rotation(tangent: Vector2<f64>) -> Matrix2<f64> {
    Matrix2::new(tangent.x, tangent.y, -tangent.y, tangent.x)
}

/// Equation (5): local stiffness in the 1-2 axes, `TᵀK_C T`.
pub fn plane_stiffness(local: &Matrix2<f64>, rotation: &Matrix2<f64>) -> Matrix2<f64> {
    rotation.transpose() * local * rotation
}

/// Equation (7): stiffness of the pair (wheel point, rail node).
pub fn two_node_stiffness(plane: &Matrix2<f64>) -> Matrix4<f64> {
    let mut k = Matrix4::zeros();
    k.fixed_view_mut::<2, 2>(0, 0).copy_from(plane);
    k.fixed_view_mut::<2, 2>(2, 2).copy_from(plane);
    k.fixed_view_mut::<2, 2>(0, 2).copy_from(&-plane);
    k.fixed_view_mut::<2, 2>(2, 0).copy_from(&-plane);
    k
}

/// Equation (8), the matrix T4×6: displacements of wheel point and rail node from the motion of
/// their masters, ordered B1, B2, C1, C2, rotation C, rotation B. `arm_b` and `arm_c` lead from the masters to the contact.
pub fn master_slave(arm_b: Vector2<f64>, arm_c: Vector2<f64>) -> SMatrix<f64, 4, 6> {
    let mut t = SMatrix::zeros();
    for i in 0..4 {
        t[(i, i)] = 1.0;
    }
    t[(0, 5)] = -arm_b.y;
    t[(1, 5)] = arm_b.x;
    t[(2, 4)] = -arm_c.y;
    t[(3, 4)] = arm_c.x;
    t
}

/// Equation (8): stiffness of the masters B and C, `T4×6ᵀ K4 T4×6`.
pub fn master_stiffness(pair: &Matrix4<f64>, transformation: &SMatrix<f64, 4, 6>) -> SMatrix<f64, 6, 6> {
    transformation.transpose() * pair * transformation
}

/// Equation (9), the matrix T6×18: motion of the masters B and C from the translations and rotations of B, I
/// and J. `functions` are N1 to N4 at C for directions 1 and 2, the same cubic Hermite functions in the
/// publication. `ratio` is S_n, the length J-C over the length I-J.
pub fn global_transformation(
    axes: &[Vector3<f64>; 3],
    functions: &[[f64; 4]; 2],
    ratio: f64,
) -> SMatrix<f64, 6, 18> {
    let mut t = SMatrix::zeros();
    let mut put = |row: usize, node: usize, rotation: bool, vector: Vector3<f64>| {
        let column = 6 * node + if rotation { 3 } else { 0 };
        for i in 0..3 {
            t[(row, column + i)] += vector[i];
        }
    };
    let [u1, u2, u3] = *axes;
    put(0, 0, false, u1);
    put(1, 0, false, u2);
    put(5, 0, true, u3);
    for (node, n, share) in [(1, 0, ratio), (2, 2, 1.0 - ratio)] {
        put(2, node, false, functions[0][n] * u1);
        put(3, node, false, functions[1][n] * u2);
        put(2, node, true, -functions[0][n + 1] * u2);
        put(3, node, true, functions[1][n + 1] * u1);
        put(4, node, true, share * u3);
    }
    t
}

/// Equation (12): tangential displacement of the rail node against the wheel since the last step, m, from the
/// places of its foot on the wheel's spline. The publication measures on the chord of the active segment; this is the arc
/// length, which has the same value to second order and does not jump from segment to segment.
pub fn tangential_increment(place: f64, last_place: f64) -> f64 {
    place - last_place
}

/// Equation (13): normal displacement, m, of the rail node against its foot on the spline; positive is penetration.
pub fn normal_displacement(foot_to_node: Vector2<f64>, tangent: Vector2<f64>) -> f64 {
    foot_to_node.dot(&Vector2::new(-tangent.y, tangent.x))
}

/// Equation (14): tangential force (N) if the contact sticks: the penalty force of the increment, and
/// the last step's force `last_force` carried from its tangent `last_tangent` to the present one.
pub fn sticking_force(
    penalty: f64,
    increment: f64,
    tangent: Vector2<f64>,
    last_tangent: Vector2<f64>,
    last_force: f64,
) -> f64 {
    penalty * increment + last_tangent.dot(&tangent) * last_force
}

/// Mode and tangential force (N) of a contact node: separation by the sign of the normal displacement,
/// then sticking is assumed and kept if its force stays below the friction limit; otherwise equation (15), μ·Fn.
pub fn mode_check(
    normal_displacement: f64,
    normal_force: f64,
    sticking_force: f64,
    friction: f64,
) -> (ContactMode, f64) {
    if normal_displacement <= 0.0 {
        return (ContactMode::Separated, 0.0);
    }
    let limit = friction * normal_force;
    if sticking_force.abs() < limit {
        (ContactMode::Stick, sticking_force)
    } else {
        (ContactMode::Slip, limit.copysign(sticking_force))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;
    use railspring_calibrate::beam::{BeamElement, BeamSection, deflection_functions};

    /// A few products of numbers of order one times the penalty.
    const ROUNDOFF: f64 = 1e-12;

    #[test]
    fn local_matrices_are_the_published_ones() {
        let (k, mu) = (1e9, 0.4);
        assert_eq!(contact_stiffness(ContactMode::Stick, k, mu), Matrix2::new(k, 0.0, 0.0, k));
        assert_eq!(contact_stiffness(ContactMode::Separated, k, mu), Matrix2::zeros());
        assert_eq!(contact_stiffness(ContactMode::Slip, k, -mu), Matrix2::new(0.0, -mu * k, 0.0, k));
        let symmetric = symmetric_sliding_stiffness(k, mu);
        assert_eq!(symmetric, symmetric.transpose());
        // Singular along the friction cone: sliding costs nothing.
        assert!(symmetric.determinant().abs() < ROUNDOFF * k * k);
        // A normal displacement gives the same forces in (3) and (4).
        assert!(
            (symmetric.column(1) - contact_stiffness(ContactMode::Slip, k, mu).column(1)).norm()
                < ROUNDOFF * k
        );
    }

    #[test]
    fn master_matrix_is_symmetric_and_knows_rigid_motions() {
        let tangent = Vector2::new(0.8, -0.6);
        let local = contact_stiffness(ContactMode::Stick, 2e9, 0.5);
        let pair = two_node_stiffness(&plane_stiffness(&local, &rotation(tangent)));
        // Both masters at different places, the contact at one point.
        let (b, c, contact) = (Vector2::new(0.1, 0.43), Vector2::new(-0.02, -0.13), Vector2::new(0.03, 0.01));
        let k = master_stiffness(&pair, &master_slave(contact - b, contact - c));
        assert!((k - k.transpose()).norm() < ROUNDOFF * k.norm());
        // Rotation about the origin moves each master by (−y, x).
        let motions = [
            SVector::<f64, 6>::from([1.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
            SVector::from([0.0, 1.0, 0.0, 1.0, 0.0, 0.0]),
            SVector::from([-b.y, b.x, -c.y, c.x, 1.0, 1.0]),
        ];
        for motion in motions {
            assert!((k * motion).norm() < ROUNDOFF * k.norm() * motion.norm());
        }
        // Work is kept: a unit opening along the normal stores k/2.
        let opening = SVector::<f64, 6>::from([0.0, 0.0, 0.6, 0.8, 0.0, 0.0]);
        assert!((opening.dot(&(k * opening)) / 2e9 - 1.0).abs() < ROUNDOFF);
    }

    /// Goal: equation (9) with this program's beam: the rows of C are those of the beam element, and a rigid motion of I,
    /// J and B together loads nothing.
    #[test]
    fn global_transformation_agrees_with_the_beam() {
        let section = BeamSection {
            axial: 1.0,
            bending_y: 1.0,
            bending_z: 1.0,
            shear_y: f64::INFINITY,
            shear_z: f64::INFINITY,
            torsion: 1.0,
            mass: 1.0,
            rotary_y: 1.0,
            rotary_z: 1.0,
            polar: 1.0,
            centroid: [0.0, 0.0],
        };
        let (length, xi) = (0.3, 0.3);
        let element = BeamElement { section: &section, length, angle: 0.0 };
        let n = deflection_functions(xi, length, 0.0);
        let t = global_transformation(&directions(), &[n, n], 1.0 - xi);
        let [y, z, rx] = element.section_motion(xi);
        for i in 0..12 {
            assert!((t[(2, 6 + i)] - y[i]).abs() < ROUNDOFF);
            assert!((t[(3, 6 + i)] + z[i]).abs() < ROUNDOFF);
            assert!((t[(4, 6 + i)] + rx[i]).abs() < ROUNDOFF);
        }
        // Rigid rotation about world axis through I: B, C, and J move along, relative motion of B and C stays rigid.
        let (b, c) = (Vector3::new(xi * length, 0.02, -0.56), Vector3::new(xi * length, 0.0, 0.0));
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let mut motion = SVector::<f64, 18>::zeros();
            for (node, place) in [(0, b), (1, Vector3::zeros()), (2, Vector3::new(length, 0.0, 0.0))] {
                motion.fixed_rows_mut::<3>(6 * node).copy_from(&axis.cross(&place));
                motion.fixed_rows_mut::<3>(6 * node + 3).copy_from(&axis);
            }
            let masters = t * motion;
            let plane = |v: Vector3<f64>| to_plane(Vector2::new(v.y, v.z));
            assert!((masters.fixed_rows::<2>(0) - plane(axis.cross(&b))).norm() < ROUNDOFF);
            assert!((masters.fixed_rows::<2>(2) - plane(axis.cross(&c))).norm() < ROUNDOFF);
            assert!((masters[4] + axis.x).abs() < ROUNDOFF && (masters[5] + axis.x).abs() < ROUNDOFF);
        }
    }

    #[test]
    fn directions_are_right_handed() {
        let [u1, u2, u3] = directions();
        assert_eq!(u1.cross(&u2), u3);
    }

    #[test]
    fn modes_follow_the_friction_limit() {
        assert_eq!(mode_check(-1e-9, 0.0, 5.0, 0.5), (ContactMode::Separated, 0.0));
        assert_eq!(mode_check(1e-9, 10.0, 4.9, 0.5), (ContactMode::Stick, 4.9));
        assert_eq!(mode_check(1e-9, 10.0, -5.1, 0.5), (ContactMode::Slip, -5.0));
        assert_eq!(mode_check(1e-9, 10.0, 0.0, 0.0).0, ContactMode::Slip);
        // The last force is carried along the tangent: a turn of 60° halves it.
        let turned = Vector2::new(0.5, 0.75f64.sqrt());
        assert!((sticking_force(1e9, 1e-9, turned, Vector2::x(), 4.0) - 3.0).abs() < ROUNDOFF);
        assert!((normal_displacement(Vector2::new(0.0, 1e-3), Vector2::x()) - 1e-3).abs() < ROUNDOFF);
    }
}
