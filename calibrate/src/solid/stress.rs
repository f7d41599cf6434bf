//! Nodal stresses for pictures: volume-weighted means of the element centres.

use super::{Material, assembly::corners, brick};
use crate::mesh::HexMesh;
use nalgebra::SVector;

/// Stress at every node (xx, yy, zz, xy, yz, zx), Pa, from nodal displacements (`3·node + direction`, m).
pub fn nodal_stress(mesh: &HexMesh, material: &Material, displacement: &[f64]) -> Vec<[f64; 6]> {
    let d = material.elasticity();
    let mut sums = vec![SVector::<f64, 6>::zeros(); mesh.nodes.len()];
    let mut volumes = vec![0.0; mesh.nodes.len()];
    for hex in &mesh.hexes {
        let u = SVector::<f64, 24>::from_fn(|i, _| displacement[3 * hex[i / 3] + i % 3]);
        let (strain, volume) = brick::centre_strain(&corners(mesh, hex), &u);
        for &n in hex {
            sums[n] += d * strain * volume;
            volumes[n] += volume;
        }
    }
    sums.iter().zip(&volumes).map(|(s, v)| (s / *v).into()).collect()
}
