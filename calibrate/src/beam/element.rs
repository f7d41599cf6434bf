//! The 12-degree-of-freedom Timoshenko element.
//!
//! Degrees of freedom of each node: displacements x, y, z, rotations about x, y, z.
//! The functions are the exact static solution of the unloaded element
//! (Przemieniecki, Theory of Matrix Structural Analysis, 1968, section 5.6;
//! Friedman and Kosmatka, Computers & Structures 47, 1993), so that nodal
//! displacements under nodal forces are exact for any number of elements.

use nalgebra::{Matrix3, SMatrix, SVector};

use super::section::BeamSection;
use railspring_profiles::quadrature::gauss_4_unit;

type Matrix12 = SMatrix<f64, 12, 12>;
type Vector12 = SVector<f64, 12>;

/// One element along x with the section turned about x.
#[derive(Debug, Clone, Copy)]
pub struct BeamElement<'a> {
    /// Its section.
    pub section: &'a BeamSection,
    /// Length, m.
    pub length: f64,
    /// Angle that turns the section's y to z, rad.
    pub angle: f64,
}

/// Interpolation of the deflection from (w1, w1', w2, w2') at `xi` in 0..1, with the
/// shear parameter Φ = 12·EI/(κGA·L²). For Φ = 0 these are the cubic Hermite functions N1 to N4 of eq. 9.
pub fn deflection_functions(xi: f64, length: f64, shear_parameter: f64) -> [f64; 4] {
    let (f, d) = (shear_parameter, 1.0 / (1.0 + shear_parameter));
    let (x, x2, x3) = (xi, xi * xi, xi * xi * xi);
    [
        (2.0 * x3 - 3.0 * x2 - f * x + 1.0 + f) * d,
        length * (x3 - (2.0 + 0.5 * f) * x2 + (1.0 + 0.5 * f) * x) * d,
        (-2.0 * x3 + 3.0 * x2 + f * x) * d,
        length * (x3 - (1.0 - 0.5 * f) * x2 - 0.5 * f * x) * d,
    ]
}

/// Interpolation of the section's rotation that belongs to [`deflection_functions`].
pub fn rotation_functions(xi: f64, length: f64, shear_parameter: f64) -> [f64; 4] {
    let (f, d) = (shear_parameter, 1.0 / (1.0 + shear_parameter));
    let x2 = xi * xi;
    [
        6.0 * (x2 - xi) / length * d,
        (3.0 * x2 - (4.0 + f) * xi + 1.0 + f) * d,
        6.0 * (xi - x2) / length * d,
        (3.0 * x2 - (2.0 - f) * xi) * d,
    ]
}

/// Places of (y, rotation z) and of (z, rotation y) among the 12 degrees of freedom; a
/// positive rotation about y tilts the axis to negative z, hence the sign.
const PLANE_Y: ([usize; 4], [f64; 4]) = ([1, 5, 7, 11], [1.0, 1.0, 1.0, 1.0]);
const PLANE_Z: ([usize; 4], [f64; 4]) = ([2, 4, 8, 10], [1.0, -1.0, 1.0, -1.0]);

impl BeamElement<'_> {
    /// Φ = 12·EI/(κGA·L²) against deflection along the section's y and z.
    pub fn shear_parameters(&self) -> [f64; 2] {
        let s = self.section;
        let parameter = |bending: f64, shear: f64| 12.0 * bending / (shear * self.length.powi(2));
        [parameter(s.bending_y, s.shear_y), parameter(s.bending_z, s.shear_z)]
    }

    /// Stiffness matrix in the world axes.
    pub fn stiffness(&self) -> Matrix12 {
        let (s, l) = (self.section, self.length);
        let mut k = Matrix12::zeros();
        for (first, value) in [(0, s.axial / l), (3, s.torsion / l)] {
            k[(first, first)] = value;
            k[(first + 6, first + 6)] = value;
            k[(first, first + 6)] = -value;
            k[(first + 6, first)] = -value;
        }
        let parameters = self.shear_parameters();
        for ((places, signs), bending, f) in
            [(PLANE_Y, s.bending_y, parameters[0]), (PLANE_Z, s.bending_z, parameters[1])]
        {
            let block = [
                [12.0, 6.0 * l, -12.0, 6.0 * l],
                [6.0 * l, (4.0 + f) * l * l, -6.0 * l, (2.0 - f) * l * l],
                [-12.0, -6.0 * l, 12.0, -6.0 * l],
                [6.0 * l, (2.0 - f) * l * l, -6.0 * l, (4.0 + f) * l * l],
            ];
            let factor = bending / (l.powi(3) * (1.0 + f));
            for (i, row) in block.iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    k[(places[i], places[j])] = factor * signs[i] * signs[j] * value;
                }
            }
        }
        self.to_world(&k)
    }

    /// Consistent mass matrix with rotary inertia, in the world axes.
    pub fn mass(&self) -> Matrix12 {
        let s = self.section;
        let mut m = Matrix12::zeros();
        for (xi, weight) in gauss_4_unit() {
            let [u, v, w, twist, tilt_y, tilt_z] = self.interpolation(xi);
            let sway = v - twist * s.centroid[1];
            let heave = w + twist * s.centroid[0];
            for (row, density) in [
                (u, s.mass),
                (sway, s.mass),
                (heave, s.mass),
                (twist, s.polar),
                (tilt_y, s.rotary_z),
                (tilt_z, s.rotary_y),
            ] {
                m += row * row.transpose() * (weight * self.length * density);
            }
        }
        self.to_world(&m)
    }

    /// Rows that interpolate displacements x, y, z and rotations about x, y, z at `xi`, in the section's axes.
    pub(super) fn interpolation(&self, xi: f64) -> [Vector12; 6] {
        let mut rows = [Vector12::zeros(); 6];
        for dof in [0, 3] {
            rows[dof][dof] = 1.0 - xi;
            rows[dof][dof + 6] = xi;
        }
        let parameters = self.shear_parameters();
        for ((places, signs), f, deflection, rotation, tilt) in
            [(PLANE_Y, parameters[0], 1, 5, 1.0), (PLANE_Z, parameters[1], 2, 4, -1.0)]
        {
            let n = deflection_functions(xi, self.length, f);
            let g = rotation_functions(xi, self.length, f);
            for i in 0..4 {
                rows[deflection][places[i]] = signs[i] * n[i];
                rows[rotation][places[i]] = tilt * signs[i] * g[i];
            }
        }
        rows
    }

    /// Rows that interpolate the world displacements y and z of the node line and its rotation
    /// about x at `xi`.
    pub fn section_motion(&self, xi: f64) -> [Vector12; 3] {
        let mut rows = self.interpolation(xi);
        // Columns to world degrees of freedom, then the displacement itself to world axes.
        let turn = self.turn();
        for row in &mut rows {
            for block in 0..4 {
                let local = row.fixed_rows::<3>(3 * block).into_owned();
                row.fixed_rows_mut::<3>(3 * block).copy_from(&(turn * local));
            }
        }
        let (sin, cos) = self.angle.sin_cos();
        [rows[1] * cos - rows[2] * sin, rows[1] * sin + rows[2] * cos, rows[3]]
    }

    /// Rotation from the section's axes to the world axes.
    fn turn(&self) -> Matrix3<f64> {
        let (sin, cos) = self.angle.sin_cos();
        Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos)
    }

    fn to_world(self, local: &Matrix12) -> Matrix12 {
        let turn = self.turn();
        let mut world = *local;
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (3 * i, 3 * j))) {
            let block = turn * local.fixed_view::<3, 3>(i, j) * turn.transpose();
            world.fixed_view_mut::<3, 3>(i, j).copy_from(&block);
        }
        world
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cancellation in the bending block, some ten operations on entries that differ by powers of the length.
    const ROUNDOFF: f64 = 1e-12;

    fn section() -> BeamSection {
        BeamSection {
            axial: 1.6e9,
            bending_y: 1.1e6,
            bending_z: 6.4e6,
            shear_y: 3.3e8,
            shear_z: 2.4e8,
            torsion: 1.8e5,
            mass: 60.0,
            rotary_y: 0.04,
            rotary_z: 0.24,
            polar: 0.28,
            centroid: [0.002, -0.034],
        }
    }

    /// Displacement of the two nodes under a rigid motion: translation and small rotation about the first node.
    fn rigid_motions(length: f64, angle: f64, centroid: [f64; 2]) -> Vec<Vector12> {
        let (sin, cos) = angle.sin_cos();
        // The axial degree of freedom belongs to the centroid.
        let offset = [centroid[0] * cos - centroid[1] * sin, centroid[0] * sin + centroid[1] * cos];
        let mut motions = vec![Vector12::zeros(); 6];
        for i in 0..6 {
            motions[i][i] = 1.0;
            motions[i][i + 6] = 1.0;
        }
        motions[4][8] = -length;
        motions[5][7] = length;
        for node in [0, 6] {
            motions[4][node] = offset[1];
            motions[5][node] = -offset[0];
        }
        motions
    }

    #[test]
    fn matrices_are_symmetric_and_know_rigid_motions() {
        let section = section();
        for (length, angle) in [(0.02775, 0.025), (0.5, -0.3)] {
            let element = BeamElement { section: &section, length, angle };
            let (k, m) = (element.stiffness(), element.mass());
            assert!((k - k.transpose()).norm() < ROUNDOFF * k.norm());
            assert!((m - m.transpose()).norm() < ROUNDOFF * m.norm());
            let motions = rigid_motions(length, angle, section.centroid);
            for motion in &motions {
                assert!((k * motion).norm() < ROUNDOFF * k.norm() * motion.norm());
            }
            // Mass of the translations, and the inertia about the node line.
            for motion in &motions[..3] {
                assert!((motion.dot(&(m * motion)) / (60.0 * length) - 1.0).abs() < ROUNDOFF);
            }
            let spin = motions[3].dot(&(m * motions[3])) / length;
            let arm = section.centroid[0].powi(2) + section.centroid[1].powi(2);
            assert!((spin / (section.polar + section.mass * arm) - 1.0).abs() < ROUNDOFF);
            // A twist takes the centroid, above the node line, to the field side.
            let sway = motions[1].dot(&(m * motions[3])) / length;
            let (sin, cos) = angle.sin_cos();
            let above = -(section.centroid[0] * sin + section.centroid[1] * cos);
            assert!((sway / (section.mass * above) - 1.0).abs() < ROUNDOFF);
            // Pitch about the first node: rotary inertia, axial at the centroid, and mL²/3.
            let level = BeamElement { section: &section, length, angle: 0.0 };
            let pitch = rigid_motions(length, 0.0, section.centroid)[4];
            let exact =
                section.rotary_z + section.mass * (length * length / 3.0 + section.centroid[1].powi(2));
            assert!((pitch.dot(&(level.mass() * pitch)) / (exact * length) - 1.0).abs() < ROUNDOFF);
        }
    }

    /// Goal: the functions are nodal, sum to one, and are Hermite's for Φ = 0.
    #[test]
    fn functions_are_nodal() {
        for f in [0.0, 0.7, 400.0] {
            let l = 0.3;
            let unit = |i: usize| std::array::from_fn(|j| f64::from(u8::from(i == j)));
            let near = |p: [f64; 4], q: [f64; 4]| p.iter().zip(&q).all(|(x, y)| (x - y).abs() < ROUNDOFF);
            assert!(near(deflection_functions(0.0, l, f), unit(0)));
            assert!(near(deflection_functions(1.0, l, f), unit(2)));
            assert!(near(rotation_functions(0.0, l, f), unit(1)));
            assert!(near(rotation_functions(1.0, l, f), unit(3)));
            let n = deflection_functions(0.3, l, f);
            assert!((n[0] + n[2] - 1.0).abs() < ROUNDOFF);
            // A rigid tilt about the first node deflects linearly.
            assert!((n[1] + n[2] * l + n[3] - 0.3 * l).abs() < ROUNDOFF);
        }
        let hermite = deflection_functions(0.25, 2.0, 0.0);
        assert!((hermite[1] - 2.0 * 0.25 * 0.75 * 0.75).abs() < ROUNDOFF);
    }
}
