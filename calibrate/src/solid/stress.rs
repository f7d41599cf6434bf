//! Nodal stresses for pictures: volume-weighted means of the element centres.

use super::brick::{self, corners};
use super::material::Material;
use super::materials::Materials;
use crate::mesh::HexMesh;
use nalgebra::{Matrix3, SVector};

/// Stress at every node (xx, yy, zz, xy, yz, zx), Pa, from nodal displacements (`3·node + direction`, m). Where materials meet, stresses jump, and
/// a mean of both is the stress of neither: [`HexMesh::with_groups_apart`].
pub fn nodal_stress(mesh: &HexMesh, materials: &Materials, displacement: &[f64]) -> Vec<[f64; 6]> {
    let elasticity: Vec<_> = materials.of_groups().iter().map(Material::elasticity).collect();
    let mut sums = vec![SVector::<f64, 6>::zeros(); mesh.nodes.len()];
    let mut volumes = vec![0.0; mesh.nodes.len()];
    for (e, hex) in mesh.hexes.iter().enumerate() {
        let d = elasticity[mesh.group(e)];
        let u = SVector::<f64, 24>::from_fn(|i, _| displacement[3 * hex[i / 3] + i % 3]);
        let (strain, volume) = brick::centre_strain(&corners(mesh, hex), &u);
        for &n in hex {
            sums[n] += d * strain * volume;
            volumes[n] += volume;
        }
    }
    sums.iter().zip(&volumes).map(|(s, v)| (s / *v).into()).collect()
}

/// Von Mises stress of a stress (xx, yy, zz, xy, yz, zx), Pa.
pub fn von_mises([xx, yy, zz, xy, yz, zx]: [f64; 6]) -> f64 {
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

/// Largest shear stress of a stress (xx, yy, zz, xy, yz, zx), Pa: half the difference of the outer principal stresses.
pub fn largest_shear([xx, yy, zz, xy, yz, zx]: [f64; 6]) -> f64 {
    let principal = Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz).symmetric_eigenvalues();
    0.5 * (principal.max() - principal.min())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the closed values of uniaxial tension, pure shear and pressure on all sides. Goal: von Mises and largest shear
    /// stress, Pa, in any axes. Accuracy: ROUNDOFF.
    #[test]
    fn simple_stresses_have_their_equivalents() {
        const ROUNDOFF: f64 = 1e-14;
        let s = 200e6;
        let cases = [
            ([s, 0.0, 0.0, 0.0, 0.0, 0.0], s, 0.5 * s),
            // uniaxial along (0, 1, 1)
            ([0.0, 0.5 * s, 0.5 * s, 0.0, 0.5 * s, 0.0], s, 0.5 * s),
            ([0.0, 0.0, 0.0, 0.0, 0.0, s], 3f64.sqrt() * s, s),
            ([-s, -s, -s, 0.0, 0.0, 0.0], 0.0, 0.0),
        ];
        for (stress, mises, shear) in cases {
            assert!((von_mises(stress) - mises).abs() < ROUNDOFF * s, "{stress:?}");
            assert!((largest_shear(stress) - shear).abs() < 10.0 * ROUNDOFF * s, "{stress:?}");
        }
    }
}
