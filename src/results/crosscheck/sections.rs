//! Where on a body the displacements of tool and reference differ: its
//! elements as a plane through the largest difference cuts them.

use nalgebra::{Point3, Vector3};
use railspring_calibrate::mesh::HexMesh;
use railspring_profiles::units::MILLIMETRE;

use crate::results::crosscheck::record::{SectionCell, SectionDifference};

/// Corners of the twelve edges of a hexahedron.
const EDGES: [(usize, usize); 12] =
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)];
/// The plane stands this far beside the node, m: swept meshes have a layer of nodes there, and the
/// elements are then cut on one side of it only.
const BESIDE: f64 = 1e-7;
/// Coordinates are kept to this, mm.
const GRID_MM: f64 = 1e-3;

/// Coordinates on and off the plane of a section.
struct Plane {
    /// Unit normal.
    normal: Vector3<f64>,
    /// Position along the normal, m.
    position: f64,
    /// Unit vector of the vertical axis of the picture; the horizontal one is y.
    down: Vector3<f64>,
    /// Whether only what lies on the positive side of the vertical axis belongs to the section.
    half: bool,
}

/// The section through the largest difference, across the rail or through the axle of the wheel, at
/// the origin of its frame.
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
    // only the wheel has a bore
    let turned = (!mesh.bore.is_empty()).then(|| at.x.atan2(at.z));
    let mut plane = match turned {
        Some(angle) => Plane {
            normal: Vector3::new(angle.cos(), 0.0, -angle.sin()),
            position: BESIDE,
            down: Vector3::new(angle.sin(), 0.0, angle.cos()),
            half: true,
        },
        None => Plane { normal: Vector3::x(), position: at.x + BESIDE, down: Vector3::z(), half: false },
    };
    let mut cells = plane.cells(mesh, own, theirs);
    if cells.is_empty() {
        // the node lies at the end of the body
        plane.position -= 2.0 * BESIDE;
        cells = plane.cells(mesh, own, theirs);
    }
    SectionDifference {
        body: body.into(),
        largest_displacement_mm: displacement / MILLIMETRE,
        largest_difference_mm: difference / MILLIMETRE,
        largest_at_mm: [at.x, at.y, at.z].map(rounded),
        largest_on_section_mm: [at.y, plane.down.dot(&at.coords)].map(rounded),
        turned_deg: turned.map(f64::to_degrees),
        cells,
    }
}

impl Plane {
    fn cells(&self, mesh: &HexMesh, own: &[Vector3<f64>], theirs: &[Vector3<f64>]) -> Vec<SectionCell> {
        let corners = |hex: &[usize; 8]| hex.map(|n| (mesh.nodes[n], own[n] - theirs[n]));
        mesh.hexes.iter().filter_map(|hex| self.cut(&corners(hex))).collect()
    }

    /// The polygon in which the plane cuts an element, with the largest difference of its corners.
    fn cut(&self, corners: &[(Point3<f64>, Vector3<f64>); 8]) -> Option<SectionCell> {
        let off = |p: &Point3<f64>| self.normal.dot(&p.coords) - self.position;
        let mut points: Vec<([f64; 2], f64)> = EDGES
            .iter()
            .filter_map(|&(a, b)| {
                let ((p, u), (q, v)) = (corners[a], corners[b]);
                let (low, high) = (off(&p), off(&q));
                (low * high < 0.0).then(|| {
                    let t = low / (low - high);
                    let at = p + t * (q - p);
                    ([at.y, self.down.dot(&at.coords)], (u + t * (v - u)).norm())
                })
            })
            .collect();
        if points.len() < 3 || (self.half && points.iter().any(|(p, _)| p[1] < 0.0)) {
            return None;
        }
        let count = points.len() as f64;
        let middle = [0, 1].map(|axis| points.iter().map(|(p, _)| p[axis]).sum::<f64>() / count);
        let angle = |p: &[f64; 2]| (p[1] - middle[1]).atan2(p[0] - middle[0]);
        points.sort_by(|(p, _), (q, _)| angle(p).total_cmp(&angle(q)));
        // what is no number stays none
        let larger = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) };
        Some(SectionCell {
            difference_mm: points.iter().map(|(_, d)| *d).fold(0.0, larger) / MILLIMETRE,
            corners_mm: points.into_iter().map(|(p, _)| p.map(rounded)).collect(),
        })
    }
}

/// Metres to millimetres on the grid.
fn rounded(metres: f64) -> f64 {
    (metres / MILLIMETRE / GRID_MM).round() * GRID_MM
}

#[cfg(test)]
mod tests {
    use railspring_calibrate::mesh::{MeshOptions, mesh_wheel};

    use super::*;

    /// Source: a unit cube whose difference is y along z. Goal: the section is the square, m to mm;
    /// the largest difference is that of its upper corners. Accuracy: the grid of a micrometre. Turned
    /// by a right angle about the axle, the cube is cut into the same square of y and radius.
    #[test]
    fn a_cube_is_cut_into_its_square() {
        let corners =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
                .map(|c| Point3::from(c.map(f64::from)))
                .map(|p| (p, Vector3::new(0.0, 0.0, p.y)));
        let across = Plane { normal: Vector3::x(), position: BESIDE, down: Vector3::z(), half: false };
        let square = [[0.0, 0.0], [1e3, 0.0], [1e3, 1e3], [0.0, 1e3]];
        let cell = across.cut(&corners).unwrap();
        assert_eq!(cell.corners_mm, square);
        assert!((cell.difference_mm - 1e3).abs() < GRID_MM, "{}", cell.difference_mm);
        assert_eq!(across.cut(&corners.map(|(p, u)| (p - Vector3::x(), u))), None);
        let ahead = Plane { normal: -Vector3::z(), position: -BESIDE, down: Vector3::x(), half: true };
        let front = corners.map(|(p, u)| (Point3::new(p.z, p.y, p.x), u));
        assert_eq!(ahead.cut(&front).unwrap().corners_mm, square);
        let behind = front.map(|(p, u)| (p - 1.5 * Vector3::x(), u));
        assert_eq!(ahead.cut(&behind), None, "beyond the axle");
    }

    /// Source: the mesh of a coarse wheel whose difference is largest at one node of the flange side,
    /// in front of the load. Goal: the section goes through that node and shows its difference.
    #[test]
    fn the_section_goes_through_the_largest_difference() {
        let section = railspring_profiles::section::wheel_section("S1002", 0.858);
        let mesh = mesh_wheel(
            &section.unwrap(),
            &MeshOptions { contact_element: 8e-3, contact_element_along: 8e-3, ..MeshOptions::default() },
        );
        let mesh = mesh.unwrap();
        let own = vec![Vector3::zeros(); mesh.nodes.len()];
        for node in [mesh.nodes.len() / 2, mesh.contact.nodes[3]] {
            let mut theirs = own.clone();
            theirs[node].z = 1e-6;
            let found = super::section("wheel", &mesh, &own, &theirs);
            assert!((found.largest_difference_mm / 1e-3 - 1.0).abs() < 1e-12);
            let shown = found.cells.iter().map(|c| c.difference_mm).fold(0.0, f64::max);
            assert!((shown / 1e-3 - 1.0).abs() < 1e-3, "{shown}");
            let [y, r] = found.largest_on_section_mm;
            let here = |p: &[f64; 2]| (p[0] - y).abs() < 2.0 * GRID_MM && (p[1] - r).abs() < 2.0 * GRID_MM;
            assert!(found.cells.iter().any(|c| c.difference_mm > 0.9e-3 && c.corners_mm.iter().any(here)));
            assert!(found.cells.iter().all(|c| c.corners_mm.iter().all(|p| p[1] > 0.0)), "half a plane");
        }
    }
}
