//! Quality of hexahedra.

use nalgebra::{Matrix3, Point3, Vector3};

use super::hex_mesh::HexMesh;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::quadrature::GAUSS_2;

/// Corner neighbours along the three local axes, in right-handed order.
const NEIGHBOURS: [[usize; 3]; 8] =
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]];
/// Local coordinates of the corners of a hexahedron, in the order of VTK.
pub(crate) const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Quality of a mesh of hexahedra.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Smallest scaled Jacobian of all elements: the least of the eight corner
    /// determinants of unit edges; 1 for a brick, 0 for a flat element.
    pub min_scaled_jacobian: f64,
    /// Mean over the elements of their scaled Jacobian.
    pub mean_scaled_jacobian: f64,
    /// Element with the smallest scaled Jacobian.
    pub worst_element: usize,
    /// Smallest determinant of the Jacobian at the 2x2x2 Gauss points, m³.
    pub min_gauss_jacobian: f64,
    /// Largest ratio of the longest to the shortest edge of an element.
    pub max_aspect: f64,
    /// Volume of all elements, m³.
    pub volume: f64,
}

/// Measures a mesh.
///
/// # Errors
/// When an element is inverted or flat at a corner or a Gauss point.
pub fn quality(mesh: &HexMesh) -> Result<Quality> {
    let mut result = Quality {
        min_scaled_jacobian: f64::INFINITY,
        mean_scaled_jacobian: 0.0,
        worst_element: 0,
        min_gauss_jacobian: f64::INFINITY,
        max_aspect: 0.0,
        volume: 0.0,
    };
    for (e, hex) in mesh.hexes.iter().enumerate() {
        let corner = hex.map(|v| mesh.nodes[v]);
        let scaled = scaled_jacobian(&corner);
        let (smallest, volume) = gauss_jacobian(&corner);
        result.volume += volume;
        // Also false when a value is not a number.
        if !(scaled > 0.0 && smallest > 0.0) {
            let middle = corner.iter().map(|p| p.coords).sum::<Vector3<f64>>() * (1e3 / 8.0);
            return InputError::refuse(
                "hexahedron",
                format!(
                    "element {e} around ({:.2}, {:.2}, {:.2}) mm: scaled Jacobian {scaled:.3e}, \
                     smallest Jacobian at a Gauss point {smallest:.3e} m³",
                    middle.x, middle.y, middle.z
                ),
                "positive values",
                "change the element sizes, or repair the profile there",
            );
        }
        if scaled < result.min_scaled_jacobian {
            result.min_scaled_jacobian = scaled;
            result.worst_element = e;
        }
        result.mean_scaled_jacobian += scaled;
        result.min_gauss_jacobian = result.min_gauss_jacobian.min(smallest);
        result.max_aspect = result.max_aspect.max(aspect(&corner));
    }
    result.mean_scaled_jacobian /= mesh.hexes.len() as f64;
    Ok(result)
}

/// Least of the eight corner determinants of unit edges.
pub(super) fn scaled_jacobian(corner: &[Point3<f64>; 8]) -> f64 {
    (0..8)
        .map(|i| {
            let edge = |k: usize| (corner[NEIGHBOURS[i][k]] - corner[i]).normalize();
            edge(0).cross(&edge(1)).dot(&edge(2))
        })
        .fold(f64::INFINITY, |a, b| if b.is_nan() { b } else { a.min(b) })
}

/// Whether an element is neither inverted nor flat, at its corners and at its Gauss points.
pub(super) fn is_sound(corner: &[Point3<f64>; 8]) -> bool {
    scaled_jacobian(corner) > 0.0 && gauss_jacobian(corner).0 > 0.0
}

/// Smallest determinant of the Jacobian at the 2x2x2 Gauss points, and the volume, m³.
fn gauss_jacobian(corner: &[Point3<f64>; 8]) -> (f64, f64) {
    let determinants = CORNERS.map(|local| jacobian(corner, &(Vector3::from(local) * GAUSS_2)).determinant());
    (determinants.into_iter().fold(f64::INFINITY, f64::min), determinants.iter().sum())
}

/// Derivatives of the position with respect to the local coordinates (columns).
fn jacobian(corner: &[Point3<f64>; 8], at: &Vector3<f64>) -> Matrix3<f64> {
    let mut matrix = Matrix3::zeros();
    for (p, local) in corner.iter().zip(&CORNERS) {
        let f: [f64; 3] = std::array::from_fn(|d| 1.0 + local[d] * at[d]);
        let gradient =
            Vector3::new(local[0] * f[1] * f[2], f[0] * local[1] * f[2], f[0] * f[1] * local[2]) / 8.0;
        matrix += p.coords * gradient.transpose();
    }
    matrix
}

/// Ratio of the longest to the shortest edge.
fn aspect(corner: &[Point3<f64>; 8]) -> f64 {
    let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
    for i in 0..8 {
        for &j in &NEIGHBOURS[i] {
            let length = (corner[i] - corner[j]).norm();
            shortest = shortest.min(length);
            longest = longest.max(length);
        }
    }
    longest / shortest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of floating-point arithmetic on values of order one.
    const ROUNDOFF: f64 = 1e-13;

    fn brick(a: f64, b: f64, c: f64) -> [Point3<f64>; 8] {
        CORNERS.map(|l| Point3::new(a * (l[0] + 1.0) / 2.0, b * (l[1] + 1.0) / 2.0, c * (l[2] + 1.0) / 2.0))
    }

    #[test]
    fn a_brick_is_perfect_and_a_sheared_one_has_the_sine_of_its_angle() {
        assert!((scaled_jacobian(&brick(1.0, 2.0, 3.0)) - 1.0).abs() < ROUNDOFF);
        let sheared = brick(1.0, 1.0, 1.0).map(|p| Point3::new(p.x + p.z, p.y, p.z));
        assert!((scaled_jacobian(&sheared) - std::f64::consts::FRAC_1_SQRT_2).abs() < ROUNDOFF);
        assert!(
            (jacobian(&brick(1.0, 2.0, 3.0), &Vector3::new(0.3, -0.2, 0.9)).determinant() - 6.0 / 8.0).abs()
                < ROUNDOFF
        );
        assert!((aspect(&brick(1.0, 2.0, 3.0)) - 3.0).abs() < ROUNDOFF);
    }

    #[test]
    fn an_inverted_element_is_refused_with_its_place() {
        let mut mesh =
            super::super::mesh_block(&super::super::BlockOptions::uniform([1.0; 3], [1, 1, 1])).unwrap();
        mesh.hexes[0].swap(0, 1);
        let message = quality(&mesh).unwrap_err().to_string();
        assert!(message.contains("element 0 around"), "{message}");
    }
}
