//! Where on a body the displacements of tool and reference differ: its
//! elements as a plane under the load cuts them.

use nalgebra::{Point3, Vector3};
use railspring_calibrate::mesh::HexMesh;
use railspring_calibrate::units::MILLIMETRE;

use crate::records::crosscheck::{SectionCell, SectionDifference};

/// Corners of the twelve edges of a hexahedron.
const EDGES: [(usize, usize); 12] =
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)];
/// The plane stands this far beside x = 0, where swept meshes have a layer of nodes, m: it then cuts
/// the elements on one side only.
const BESIDE: f64 = 1e-7;
/// Coordinates are kept to this, mm.
const GRID_MM: f64 = 1e-3;

/// The section of `mesh` across the track under the load. Of a wheel only what lies below its axle.
pub fn section(
    body: &str,
    mesh: &HexMesh,
    own: &[Vector3<f64>],
    theirs: &[Vector3<f64>],
) -> SectionDifference {
    let largest = |field: &mut dyn Iterator<Item = f64>| {
        field.enumerate().fold((0, 0.0), |found, (n, v)| if v > found.1 { (n, v) } else { found })
    };
    let (node, difference) = largest(&mut own.iter().zip(theirs).map(|(a, b)| (a - b).norm()));
    let (_, displacement) = largest(&mut own.iter().map(Vector3::norm));
    let at = mesh.nodes[node];
    // z points down: the running surface lies below the bore
    let axle =
        mesh.bore.iter().map(|&n| mesh.nodes[n].z).reduce(|a, b| a + b).map(|z| z / mesh.bore.len() as f64);
    let cells = mesh
        .hexes
        .iter()
        .filter(|hex| axle.is_none_or(|z| hex.iter().map(|&n| mesh.nodes[n].z).sum::<f64>() > 8.0 * z))
        .filter_map(|hex| cut(&hex.map(|n| (mesh.nodes[n], own[n] - theirs[n]))))
        .collect();
    SectionDifference {
        body: body.into(),
        largest_displacement_mm: displacement / MILLIMETRE,
        largest_difference_mm: difference / MILLIMETRE,
        largest_at_mm: [at.x, at.y, at.z].map(rounded),
        cells,
    }
}

/// The polygon in which the plane cuts an element, with the mean difference of its corners.
fn cut(corners: &[(Point3<f64>, Vector3<f64>); 8]) -> Option<SectionCell> {
    let mut points: Vec<([f64; 2], f64)> = EDGES
        .iter()
        .filter_map(|&(a, b)| {
            let ((p, u), (q, v)) = (corners[a], corners[b]);
            let (low, high) = (p.x - BESIDE, q.x - BESIDE);
            (low * high < 0.0).then(|| {
                let t = low / (low - high);
                let at = p + t * (q - p);
                ([at.y, at.z], (u + t * (v - u)).norm())
            })
        })
        .collect();
    if points.len() < 3 {
        return None;
    }
    let count = points.len() as f64;
    let middle = [0, 1].map(|axis| points.iter().map(|(p, _)| p[axis]).sum::<f64>() / count);
    let angle = |p: &[f64; 2]| (p[1] - middle[1]).atan2(p[0] - middle[0]);
    points.sort_by(|(p, _), (q, _)| angle(p).total_cmp(&angle(q)));
    Some(SectionCell {
        difference_mm: points.iter().map(|(_, d)| d).sum::<f64>() / count / MILLIMETRE,
        corners_mm: points.into_iter().map(|(p, _)| p.map(rounded)).collect(),
    })
}

/// Metres to millimetres on the grid.
fn rounded(metres: f64) -> f64 {
    (metres / MILLIMETRE / GRID_MM).round() * GRID_MM
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: a unit cube whose difference is y along z. Goal: the section is the square, m to mm;
    /// the mean of its corners is half a metre. Accuracy: the grid of a micrometre.
    #[test]
    fn a_cube_is_cut_into_its_square() {
        let corners =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
                .map(|c| Point3::from(c.map(f64::from)))
                .map(|p| (p, Vector3::new(0.0, 0.0, p.y)));
        let cell = cut(&corners).unwrap();
        assert_eq!(cell.corners_mm, [[0.0, 0.0], [1e3, 0.0], [1e3, 1e3], [0.0, 1e3]]);
        assert!((cell.difference_mm - 500.0).abs() < GRID_MM, "{}", cell.difference_mm);
        let beside = corners.map(|(p, u)| (p - Vector3::x(), u));
        assert_eq!(cut(&beside), None);
    }
}
