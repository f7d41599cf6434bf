//! A structured block: flat contact surface for patch tests and half-space comparisons.

use nalgebra::Point3;

use super::hex_mesh::{HexMesh, SurfaceGrid};
use railspring_profiles::error::{InputError, Result};

/// Planes of nodes of a block in the world frame.
///
/// z points down; the contact surface is the plane of the smallest z.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockOptions {
    /// Planes across x (along the track), increasing, m.
    pub x: Vec<f64>,
    /// Planes across y (lateral), increasing, m.
    pub y: Vec<f64>,
    /// Planes across z (down), increasing, m.
    pub z: Vec<f64>,
}

impl BlockOptions {
    /// Equal elements: x and y centred on zero, z from zero down.
    #[must_use]
    pub fn uniform(lengths: [f64; 3], divisions: [usize; 3]) -> Self {
        let planes = |length: f64, n: usize, from: f64| -> Vec<f64> {
            (0..=n).map(|i| from + length * i as f64 / n as f64).collect()
        };
        Self {
            x: planes(lengths[0], divisions[0], -lengths[0] / 2.0),
            y: planes(lengths[1], divisions[1], -lengths[1] / 2.0),
            z: planes(lengths[2], divisions[2], 0.0),
        }
    }

    /// Elements of `element` within `window` of the origin in x and y and `depth`
    /// in z, then growing by the ratio `growth`, up to half lengths `half_length`
    /// and the depth `height`.
    #[must_use]
    pub fn graded(half_length: f64, height: f64, window: f64, depth: f64, element: f64, growth: f64) -> Self {
        let side = super::sweep::graded(window, half_length, element, growth, f64::INFINITY);
        let mut x: Vec<f64> = side.iter().rev().map(|v| -v).collect();
        x.extend(side.iter().skip(usize::from(side[0] == 0.0)));
        Self { y: x.clone(), x, z: super::sweep::graded(depth, height, element, growth, f64::INFINITY) }
    }
}

/// Meshes a block.
///
/// `contact` covers its upper face (smallest z) with the arc length measured
/// in y from the first plane, `foot` is the lower face, `ends` are the four sides.
///
/// # Errors
/// When the planes of a direction are fewer than two or do not increase.
pub fn mesh_block(options: &BlockOptions) -> Result<HexMesh> {
    for (name, planes) in [("x", &options.x), ("y", &options.y), ("z", &options.z)] {
        if planes.len() < 2 || !planes.windows(2).all(|p| p[1] > p[0] && p[1].is_finite()) {
            return InputError::refuse(
                format!("block.{name}"),
                format!("{planes:?}"),
                "two or more increasing coordinates",
                "sort them and drop repeated ones",
            );
        }
    }
    let (nx, ny, nz) = (options.x.len(), options.y.len(), options.z.len());
    let at = |i: usize, j: usize, k: usize| i * ny * nz + j * nz + k;
    let mut nodes = Vec::with_capacity(nx * ny * nz);
    let (mut ends, mut foot) = (Vec::new(), Vec::new());
    for (i, &x) in options.x.iter().enumerate() {
        for (j, &y) in options.y.iter().enumerate() {
            for (k, &z) in options.z.iter().enumerate() {
                nodes.push(Point3::new(x, y, z));
                if i == 0 || i == nx - 1 || j == 0 || j == ny - 1 {
                    ends.push(at(i, j, k));
                }
                if k == nz - 1 {
                    foot.push(at(i, j, k));
                }
            }
        }
    }
    let mut hexes = Vec::with_capacity((nx - 1) * (ny - 1) * (nz - 1));
    for i in 0..nx - 1 {
        for j in 0..ny - 1 {
            for k in 0..nz - 1 {
                let face = |i: usize| [at(i, j, k), at(i, j + 1, k), at(i, j + 1, k + 1), at(i, j, k + 1)];
                let (a, b) = (face(i), face(i + 1));
                hexes.push([a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]]);
            }
        }
    }
    let contact = SurfaceGrid {
        along_profile: options.y.iter().map(|y| y - options.y[0]).collect(),
        along_track: options.x.clone(),
        nodes: (0..ny).flat_map(|j| (0..nx).map(move |i| at(i, j, 0))).collect(),
    };
    Ok(HexMesh { nodes, hexes, groups: Vec::new(), contact, ends, foot, bore: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::super::quality;
    use super::*;

    /// Rounding of floating-point sums over the elements.
    const ROUNDOFF: f64 = 1e-12;

    #[test]
    fn a_block_has_its_volume_its_sides_and_its_grid() {
        let mesh = mesh_block(&BlockOptions::uniform([0.2, 0.1, 0.05], [4, 3, 2])).unwrap();
        let q = quality(&mesh).unwrap();
        assert!((q.volume / (0.2 * 0.1 * 0.05) - 1.0).abs() < ROUNDOFF);
        assert!((q.min_scaled_jacobian - 1.0).abs() < ROUNDOFF);
        assert_eq!((mesh.nodes.len(), mesh.hexes.len()), (5 * 4 * 3, 4 * 3 * 2));
        assert_eq!((mesh.foot.len(), mesh.ends.len()), (5 * 4, (5 * 4 - 3 * 2) * 3));
        for (i, s) in mesh.contact.along_profile.iter().enumerate() {
            for (k, x) in mesh.contact.along_track.iter().enumerate() {
                let p = mesh.nodes[mesh.contact.node(i, k)];
                assert!((p - Point3::new(*x, s - 0.05, 0.0)).norm() < ROUNDOFF);
            }
        }
    }

    #[test]
    fn a_graded_block_is_fine_in_its_window_and_ends_where_asked() {
        let block = BlockOptions::graded(0.05, 0.04, 0.01, 0.008, 2e-3, 1.4);
        let n = block.x.len();
        assert!((block.x[0] + 0.05).abs() < ROUNDOFF && (block.x[n - 1] - 0.05).abs() < ROUNDOFF);
        assert!((block.z[0]).abs() < ROUNDOFF && (block.z[block.z.len() - 1] - 0.04).abs() < ROUNDOFF);
        for p in block.x.windows(2).filter(|p| p[0] > -0.0101 && p[1] < 0.0101) {
            assert!(p[1] - p[0] <= 2e-3 + ROUNDOFF);
        }
        assert!(quality(&mesh_block(&block).unwrap()).unwrap().min_scaled_jacobian > 1.0 - ROUNDOFF);
    }

    #[test]
    fn planes_out_of_order_are_refused() {
        let mut block = BlockOptions::uniform([1.0; 3], [2, 2, 2]);
        block.y[1] = 7.0;
        assert!(mesh_block(&block).unwrap_err().to_string().starts_with("block.y"));
    }
}
