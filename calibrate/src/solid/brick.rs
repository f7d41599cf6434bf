//! The eight-node brick: stiffness by full integration or with incompatible
//! modes, consistent mass, strain.
//!
//! Incompatible modes: E.L. Wilson, R.L. Taylor, W.P. Doherty, J. Ghaboussi,
//! "Incompatible displacement models" (1973), with the constant-gradient
//! mapping of R.L. Taylor, P.J. Beresford, E.L. Wilson, "A non-conforming
//! element for stress analysis", Int. J. Numer. Meth. Eng. 10 (1976), so that
//! distorted elements pass the patch test.

use super::material::Material;
use crate::mesh::{CORNERS, HexMesh};
use nalgebra::{Matrix3, Point3, SMatrix, SVector, Vector3};
use railspring_profiles::quadrature::GAUSS_2;

/// Which strain field the element uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Formulation {
    /// Three quadratic modes per direction inside the element: exact in bending of a straight brick.
    #[default]
    IncompatibleModes,
    /// Plain trilinear displacements with 2×2×2 Gauss points; too stiff in bending.
    FullIntegration,
}

/// Stiffness of a brick, N/m; degree of freedom `3·node + direction`.
pub type Stiffness = SMatrix<f64, 24, 24>;

/// Corner coordinates of a hexahedron.
pub(super) fn corners(mesh: &HexMesh, hex: &[usize; 8]) -> [Point3<f64>; 8] {
    hex.map(|n| mesh.nodes[n])
}

/// The 2×2×2 Gauss points, one towards each corner.
fn gauss_points() -> impl Iterator<Item = Vector3<f64>> {
    CORNERS.iter().map(|c| Vector3::from(*c) * GAUSS_2)
}

/// Shape functions at a reference point.
pub(super) fn shape(at: &Vector3<f64>) -> SVector<f64, 8> {
    SVector::from_fn(|n, _| (0..3).map(|d| 0.5 * (1.0 + CORNERS[n][d] * at[d])).product())
}

/// Derivatives of the shape functions by the reference coordinates, 3×8.
pub(super) fn shape_gradient(at: &Vector3<f64>) -> SMatrix<f64, 3, 8> {
    SMatrix::from_fn(|d, n| {
        (0..3)
            .map(|e| if e == d { 0.5 * CORNERS[n][e] } else { 0.5 * (1.0 + CORNERS[n][e] * at[e]) })
            .product()
    })
}

/// Jacobian dx/dξ with rows by reference direction.
pub(super) fn jacobian(nodes: &[Point3<f64>; 8], gradient: &SMatrix<f64, 3, 8>) -> Matrix3<f64> {
    Matrix3::from_fn(|d, e| (0..8).map(|n| gradient[(d, n)] * nodes[n][e]).sum())
}

/// Strain-displacement matrix of functions with the physical gradients `g` (3×N), 6×3N.
fn strain_displacement<const N: usize, const M: usize>(g: &SMatrix<f64, 3, N>) -> SMatrix<f64, 6, M> {
    const { assert!(M == 3 * N) };
    let mut b = SMatrix::<f64, 6, M>::zeros();
    for n in 0..N {
        let (x, y, z) = (g[(0, n)], g[(1, n)], g[(2, n)]);
        let c = 3 * n;
        b[(0, c)] = x;
        b[(1, c + 1)] = y;
        b[(2, c + 2)] = z;
        b[(3, c)] = y;
        b[(3, c + 1)] = x;
        b[(4, c + 1)] = z;
        b[(4, c + 2)] = y;
        b[(5, c)] = z;
        b[(5, c + 2)] = x;
    }
    b
}

/// Stiffness of the brick with the given nodes (m, VTK order), or `None` if it is inverted or flat.
pub fn stiffness(
    nodes: &[Point3<f64>; 8],
    material: &Material,
    formulation: Formulation,
) -> Option<Stiffness> {
    let d = material.elasticity();
    let centre = jacobian(nodes, &shape_gradient(&Vector3::zeros()));
    let centre_inverse = centre.try_inverse()?;
    let mut k = Stiffness::zeros();
    let mut coupling = SMatrix::<f64, 9, 24>::zeros();
    let mut modes = SMatrix::<f64, 9, 9>::zeros();
    for at in gauss_points() {
        let gradient = shape_gradient(&at);
        let j = jacobian(nodes, &gradient);
        let det = j.determinant();
        if !(det > 0.0) {
            return None;
        }
        let b = strain_displacement::<8, 24>(&(j.try_inverse()? * gradient));
        let db = d * b * det;
        k += b.transpose() * db;
        if formulation == Formulation::IncompatibleModes {
            // d(1-ξ²)/dξ = -2ξ, mapped by the Jacobian at the centre
            let reference = Matrix3::from_diagonal(&(at * -2.0));
            let g = centre_inverse * reference * (centre.determinant() / det);
            let bi = strain_displacement::<3, 9>(&g);
            coupling += bi.transpose() * db;
            modes += bi.transpose() * d * bi * det;
        }
    }
    if formulation == Formulation::IncompatibleModes {
        let factor = modes.cholesky()?;
        k -= coupling.transpose() * factor.solve(&coupling);
    }
    // exactly symmetric, so that either triangle may be assembled
    Some((k + k.transpose()) * 0.5)
}

/// Consistent mass of the brick between nodes, kg, the same for each direction.
pub fn mass(nodes: &[Point3<f64>; 8], density: f64) -> SMatrix<f64, 8, 8> {
    let mut m = SMatrix::zeros();
    for at in gauss_points() {
        let n = shape(&at);
        let det = jacobian(nodes, &shape_gradient(&at)).determinant();
        m += n * n.transpose() * (density * det);
    }
    m
}

/// Strain at the centre (xx, yy, zz, xy, yz, zx; engineering shears) and volume, m³.
/// The incompatible modes vanish at the centre.
pub fn centre_strain(nodes: &[Point3<f64>; 8], displacement: &SVector<f64, 24>) -> (SVector<f64, 6>, f64) {
    let gradient = shape_gradient(&Vector3::zeros());
    let j = jacobian(nodes, &gradient);
    let inverse = j.try_inverse().unwrap_or_else(Matrix3::zeros);
    (strain_displacement::<8, 24>(&(inverse * gradient)) * displacement, 8.0 * j.determinant())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Accumulated rounding of 24×24 sums relative to the largest entry.
    const ROUNDOFF: f64 = 1e-12;

    fn distorted() -> [Point3<f64>; 8] {
        let mut nodes = CORNERS.map(|c| Point3::new(c[0] * 0.011, c[1] * 0.017, c[2] * 0.013));
        for (n, p) in nodes.iter_mut().enumerate() {
            let s = n as f64;
            p.coords += Vector3::new((s * 1.7).sin(), (s * 2.3).cos(), (s * 0.9).sin()) * 0.0015;
        }
        nodes
    }

    /// Source: elasticity. Goal: the six rigid-body motions store no energy, all other
    /// motions do. Accuracy: rounding of the largest eigenvalue.
    #[test]
    fn six_rigid_body_modes() {
        for formulation in [Formulation::IncompatibleModes, Formulation::FullIntegration] {
            let k = stiffness(&distorted(), &Material::STEEL, formulation).unwrap();
            let mut values = k.symmetric_eigenvalues().as_slice().to_vec();
            values.sort_by(f64::total_cmp);
            let largest = values[23];
            assert!(values[..6].iter().all(|v| v.abs() < ROUNDOFF * largest), "{values:?}");
            assert!(values[6] > 1e-4 * largest, "a mode too many: {values:?}");
        }
    }

    /// Source: linear displacement fields are in the element's space (patch test).
    /// Goal: nodal forces of a linear field equal those of its constant stress, also when distorted.
    #[test]
    fn constant_strain_is_exact_when_distorted() {
        let nodes = distorted();
        let slope = Matrix3::new(1e-3, 2e-4, -3e-4, 4e-4, -5e-4, 6e-4, 1e-4, -2e-4, 3e-4);
        let u = SVector::<f64, 24>::from_fn(|i, _| (slope * nodes[i / 3].coords)[i % 3]);
        for formulation in [Formulation::IncompatibleModes, Formulation::FullIntegration] {
            let f = stiffness(&nodes, &Material::STEEL, formulation).unwrap() * u;
            let full = stiffness(&nodes, &Material::STEEL, Formulation::FullIntegration).unwrap() * u;
            assert!((f - full).norm() < ROUNDOFF * full.norm() * 10.0, "{formulation:?}");
            let work: f64 = f.dot(&u);
            let (strain, _) = centre_strain(&nodes, &u);
            let volume: f64 =
                gauss_points().map(|at| jacobian(&nodes, &shape_gradient(&at)).determinant()).sum();
            let expected = (strain.transpose() * Material::STEEL.elasticity() * strain)[0] * volume;
            assert!((work - expected).abs() < ROUNDOFF * expected * 10.0, "{work} {expected}");
        }
    }

    /// Source: Euler-Bernoulli bending of a brick 10 long and 1 thick.
    /// Goal: incompatible modes bend without locking; full integration locks (so the test can fail).
    #[test]
    fn incompatible_modes_do_not_lock_in_bending() {
        let (l, h) = (0.1, 0.01);
        let nodes = CORNERS.map(|c| Point3::new(c[0] * l / 2.0, c[1] * h / 2.0, c[2] * h / 2.0));
        let material = Material { poisson: 0.0, ..Material::STEEL };
        // pure bending: u = κ x z, w = -κ x²/2
        let curvature = 1e-3;
        let u = SVector::<f64, 24>::from_fn(|i, _| {
            let p = nodes[i / 3];
            [curvature * p.x * p.z, 0.0, -curvature * p.x * p.x / 2.0][i % 3]
        });
        let exact = material.young * h.powi(4) / 12.0 * curvature * curvature * l;
        let energy = |f| (u.transpose() * stiffness(&nodes, &material, f).unwrap() * u)[0];
        assert!((energy(Formulation::IncompatibleModes) / exact - 1.0).abs() < 1e-9);
        assert!(energy(Formulation::FullIntegration) / exact > 10.0);
    }

    /// Goal: the mass of a distorted brick is density times volume in every direction.
    #[test]
    fn mass_is_density_times_volume() {
        let nodes = distorted();
        let volume: f64 = gauss_points().map(|at| jacobian(&nodes, &shape_gradient(&at)).determinant()).sum();
        assert!((mass(&nodes, 7850.0).sum() / (7850.0 * volume) - 1.0).abs() < ROUNDOFF);
    }

    #[test]
    fn an_inverted_brick_is_refused() {
        let mut nodes = distorted();
        nodes.swap(0, 6);
        assert!(stiffness(&nodes, &Material::STEEL, Formulation::IncompatibleModes).is_none());
    }
}
