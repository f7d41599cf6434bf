//! Where a point lies in a mesh, and with which weights its nodes move it.

use super::brick::{corners, jacobian, shape, shape_gradient};
use crate::mesh::HexMesh;
use nalgebra::{Point3, Vector3};

/// The hexahedra that a plane x = constant cuts or touches.
pub struct Cut<'a> {
    mesh: &'a HexMesh,
    x: f64,
    hexes: Vec<(usize, [Point3<f64>; 2])>,
}

impl<'a> Cut<'a> {
    /// Collects the hexahedra at `x` (m).
    pub fn new(mesh: &'a HexMesh, x: f64) -> Self {
        let hexes = mesh.hexes.iter().enumerate().filter_map(|(e, hex)| {
            let nodes = corners(mesh, hex);
            let low = nodes.iter().fold(nodes[0], |low, p| low.inf(p));
            let high = nodes.iter().fold(nodes[0], |high, p| high.sup(p));
            let slack = 1e-9 * (high - low).norm();
            (low.x - slack <= x && x <= high.x + slack).then_some((e, [low, high]))
        });
        Self { mesh, x, hexes: hexes.collect() }
    }

    /// Nodes and weights whose weighted displacement is that of the point (x, `y`, `z`), m. Beside the mesh, as
    /// between a curved outline and its facets, the nearest hexahedron is continued. `None` if the plane misses the mesh.
    pub fn weights(&self, y: f64, z: f64) -> Option<[(usize, f64); 8]> {
        self.find(y, z).map(|(e, at)| {
            let n = shape(&at);
            std::array::from_fn(|i| (self.mesh.hexes[e][i], n[i]))
        })
    }

    /// The hexahedron of [`Self::weights`].
    pub fn element(&self, y: f64, z: f64) -> Option<usize> {
        self.find(y, z).map(|(e, _)| e)
    }

    fn find(&self, y: f64, z: f64) -> Option<(usize, Vector3<f64>)> {
        let point = Point3::new(self.x, y, z);
        let mut by_distance: Vec<(f64, usize)> = self
            .hexes
            .iter()
            .map(|(e, [low, high])| {
                let outside = (low - point).sup(&(point - high)).sup(&Vector3::zeros());
                (outside.norm(), *e)
            })
            .collect();
        by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<(f64, usize, Vector3<f64>)> = None;
        for (distance, e) in by_distance {
            // boxes that are farther away than the best body is outside cannot hold the point
            if distance > 0.0 && best.is_some() {
                break;
            }
            let Some(at) = local(&corners(self.mesh, &self.mesh.hexes[e]), &point) else { continue };
            let outside = at.amax();
            if best.is_none_or(|b| outside < b.0) {
                best = Some((outside, e, at));
            }
            if outside <= 1.0 + 1e-9 {
                break;
            }
        }
        best.map(|(_, e, at)| (e, at))
    }
}

/// Reference coordinates of `point` in a brick, by Newton's method; `None` where it does not settle.
fn local(nodes: &[Point3<f64>; 8], point: &Point3<f64>) -> Option<Vector3<f64>> {
    let mut at = Vector3::zeros();
    for _ in 0..30 {
        let n = shape(&at);
        let here: Vector3<f64> = (0..8).map(|i| nodes[i].coords * n[i]).sum();
        let step = jacobian(nodes, &shape_gradient(&at)).transpose().try_inverse()? * (point.coords - here);
        at += step;
        if step.amax() < 1e-12 {
            return Some(at);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BlockOptions, mesh_block};

    /// ROUNDOFF of shape functions of coordinates below a metre.
    const ROUNDOFF: f64 = 1e-12;

    /// Source: bricks reproduce linear fields. Goal: the weights of a point on a node plane, inside elements, at a
    /// corner and slightly outside give its own coordinates back, m. Accuracy: rounding.
    #[test]
    fn weights_reproduce_the_point() {
        let mut mesh = mesh_block(&BlockOptions::uniform([0.04, 0.03, 0.05], [4, 3, 5])).unwrap();
        for p in &mut mesh.nodes {
            // a skewed block
            *p += Vector3::new(0.0, 0.2 * p.z, 0.1 * p.y * p.y);
        }
        let middle = mesh.nodes.iter().fold(Vector3::zeros(), |s, p| s + p.coords) / mesh.nodes.len() as f64;
        for x in [mesh.nodes[0].x, middle.x, middle.x + 1.3e-3] {
            let cut = Cut::new(&mesh, x);
            for (y, z) in [(0.0, 0.0), (3e-3, -4e-3), (0.0301, 0.001)] {
                let (y, z) = (middle.y + 0.4 * y, middle.z + 0.4 * z);
                let weights = cut.weights(y, z).unwrap();
                let found: Vector3<f64> = weights.iter().map(|&(n, w)| mesh.nodes[n].coords * w).sum();
                assert!((found - Vector3::new(x, y, z)).norm() < ROUNDOFF, "{found} {x} {y} {z}");
            }
        }
        assert!(Cut::new(&mesh, 1.0).weights(0.0, 0.0).is_none());
    }
}
