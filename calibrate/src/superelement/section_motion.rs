//! The motion of a rail's cross-section as that of a beam, and the rail's compliance against it.
//!
//! The section of a beam has two displacements and a twist. In the solid these are the means over the section that
//! are conjugate in energy to the beam's forces: displacements weighted by the shear stresses of a unit force
//! through the shear centre and of a unit torque. The same stresses, as loads on that section, are the beam's
//! forces. A contact force less its beam forces is in equilibrium with itself within the section; what it does fades
//! along the rail (Saint-Venant) and does not depend on where and how the rail is held. That is the rail's compliance
//! against its section. The rest is the part of a rail beam, and what that beam misses.

use crate::mesh::HexMesh;
use crate::section_analysis::StressSample;
use crate::solid::Cut;
use faer::Mat;
use nalgebra::{Matrix2, Matrix2x3, Matrix3, Matrix3x2, Point2, Rotation2, Vector2};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::placement::PlacedRail;

/// A rail's cross-section in the plane of the contact: displacements y and z (m) of its shear centre and rotation
/// about x (rad), with the forces y and z (N) and the torque about x (N·m) that do work on them; world axes.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionMotion {
    /// World position (y, z) of the shear centre, m.
    pub shear_centre: Point2<f64>,
    /// Motion under unit beam forces on the section, the rail held as the superelement is.
    pub flexibility: Matrix3<f64>,
    /// Positions (y, z) of the contact nodes, m.
    pub(super) nodes: Vec<Point2<f64>>,
    /// Displacements of the contact nodes (`3·node + axis`) under unit beam forces on the section; by reciprocity the
    /// motions of the section under unit forces on the nodes.
    pub(super) moved: [Vec<f64>; 3],
}

/// The beam's unit forces across the track and down and its unit torque, as loads on a section of a rail's solid.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionLoads {
    /// World position (y, z) of the shear centre, m.
    pub shear_centre: Point2<f64>,
    /// Forces on all nodes (`3·node + axis`, N) of each.
    pub unit: [Vec<f64>; 3],
}

impl SectionLoads {
    /// Loads on the section x = `x` (m) of a rail's `mesh`. `stresses` are those of the section in its profile frame, `shear_centre` its
    /// shear centre in the world.
    ///
    /// # Errors
    /// [`InputError`] if the plane misses the mesh.
    pub fn new(
        mesh: &HexMesh,
        stresses: &[StressSample],
        placed: &PlacedRail,
        shear_centre: Point2<f64>,
        x: f64,
    ) -> Result<Self> {
        let cut = Cut::new(mesh, x);
        let turn = Rotation2::new(placed.angle);
        let mut loads = vec![vec![0.0; 3 * mesh.nodes.len()]; 3];
        // work of the loads on the rigid motions, which is that of unit forces but for the section's mesh
        let mut work = Matrix3::zeros();
        for sample in stresses {
            let point = placed.to_world(&sample.point);
            let weights = cut.weights(point.x, point.y).ok_or_else(|| {
                InputError::new(
                    InputField::RailMesh,
                    format!("no element at x = {x} m"),
                    "a rail on both sides of the contact",
                    "put the contact at x = 0, in the middle of the rail",
                )
            })?;
            for (k, stress) in sample.stress.iter().enumerate() {
                let force = turn * stress * sample.area;
                let column = carried(&(point - shear_centre)).transpose() * force;
                work.set_column(k, &(work.column(k) + column));
                for (node, weight) in weights {
                    loads[k][3 * node + 1] += weight * force.x;
                    loads[k][3 * node + 2] += weight * force.y;
                }
            }
        }
        let to_unit = work.try_inverse().ok_or_else(|| {
            InputError::new(
                InputField::RailProfile,
                "shear stresses without a resultant",
                "a section that carries shear and torsion",
                "check the profile for crossing outlines",
            )
        })?;
        let unit = [0, 1, 2].map(|k| {
            (0..loads[0].len()).map(|i| (0..3).map(|l| loads[l][i] * to_unit[(l, k)]).sum()).collect()
        });
        Ok(Self { shear_centre, unit })
    }
}

impl SectionMotion {
    /// The motion under `loads` on a section; `solve` has the displacements of the nodes of the `mesh` under forces on them.
    pub fn new(mesh: &HexMesh, loads: &SectionLoads, solve: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        let SectionLoads { shear_centre, unit } = loads;
        let moved = unit.each_ref().map(|load| solve(load));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(p, q)| p * q).sum::<f64>();
        Self::of(mesh, *shear_centre, Matrix3::from_fn(|i, k| dot(&unit[i], &moved[k])), &moved)
    }

    /// The motion by the `work` of each load on the displacements under each, and by these displacements of the contact nodes (`3·node + axis` of all
    /// nodes of the `mesh`).
    pub(super) fn of(
        mesh: &HexMesh,
        shear_centre: Point2<f64>,
        work: Matrix3<f64>,
        moved: &[Vec<f64>; 3],
    ) -> Self {
        let nodes =
            mesh.contact.nodes.iter().map(|&n| Point2::new(mesh.nodes[n].y, mesh.nodes[n].z)).collect();
        let at_contact = |u: &Vec<f64>| -> Vec<f64> {
            mesh.contact.nodes.iter().flat_map(|&n| [u[3 * n], u[3 * n + 1], u[3 * n + 2]]).collect()
        };
        let flexibility = 0.5 * (work + work.transpose());
        Self { shear_centre, flexibility, nodes, moved: moved.each_ref().map(at_contact) }
    }

    /// The same of a rail that is moved across the track by `way` (y, z), m.
    pub(crate) fn moved_by(&self, way: Vector2<f64>) -> Self {
        let nodes = self.nodes.iter().map(|node| node + way).collect();
        Self { shear_centre: self.shear_centre + way, nodes, ..self.clone() }
    }

    /// Positions (y, z) of the contact nodes, m.
    pub fn places(&self) -> &[Point2<f64>] {
        &self.nodes
    }

    /// Displacements of the contact nodes (`3·node + axis`) under the unit force or torque number `k` of a beam on the section, m.
    pub fn moved(&self, k: usize) -> &[f64] {
        &self.moved[k]
    }

    /// Displacements of the contact nodes (`3·node + axis`) under unit motions of the section, m.
    pub fn arms(&self) -> [Vec<f64>; 3] {
        [0, 1, 2].map(|motion| {
            let of_node = |node| [0.0, self.arm(node)[(0, motion)], self.arm(node)[(1, motion)]];
            (0..self.nodes.len()).flat_map(of_node).collect()
        })
    }

    fn arm(&self, node: usize) -> Matrix2x3<f64> {
        carried(&(self.nodes[node] - self.shear_centre))
    }

    /// The rail against its own section: `(I - T·Wᵀ)·C·(I - W·Tᵀ)` of the `compliance` C of its contact nodes
    /// (`3·node + axis`, m/N), with the beam forces `Tᵀ·f` of contact forces f taken back by the section (W).
    pub fn relative(&self, compliance: &Mat<f64>) -> Mat<f64> {
        let rows = 3 * self.nodes.len();
        // T by row, and S·Tᵀ - Wᵀ·C by column
        let arms =
            Mat::from_fn(rows, 3, |r, m| if r % 3 == 0 { 0.0 } else { self.arm(r / 3)[(r % 3 - 1, m)] });
        let rest = Mat::from_fn(rows, 3, |r, m| {
            (0..3).map(|l| self.flexibility[(m, l)] * arms[(r, l)]).sum::<f64>() - self.moved[m][r]
        });
        let mut relative = compliance.clone();
        for c in 0..rows {
            for r in 0..rows {
                relative[(r, c)] += (0..3)
                    .map(|m| arms[(r, m)] * rest[(c, m)] - self.moved[m][r] * arms[(c, m)])
                    .sum::<f64>();
            }
        }
        relative
    }

    /// What the section carries under a contact force that `weights` (with the sum 1) share out to the contact nodes:
    /// the flexibility (y, z; m/N) where it acts, other than that against the section.
    pub fn carried(&self, weights: &[f64]) -> Matrix2<f64> {
        let point = self.nodes.iter().zip(weights).map(|(p, w)| p.coords * *w).sum::<Vector2<f64>>();
        let arm = carried(&(point - self.shear_centre.coords));
        let section = Matrix3x2::from_fn(|m, axis| {
            weights.iter().enumerate().map(|(n, w)| w * self.moved[m][3 * n + 1 + axis]).sum()
        });
        let moved = arm * section;
        moved + moved.transpose() - arm * self.flexibility * arm.transpose()
    }
}

/// Displacement (y, z) of a point at `arm` from the shear centre under unit motions of the section: a rotation about x
/// moves it by (-z, y).
pub fn carried(arm: &Vector2<f64>) -> Matrix2x3<f64> {
    Matrix2x3::new(1.0, 0.0, -arm.y, 0.0, 1.0, arm.x)
}
