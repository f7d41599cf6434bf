//! Meshes of wheels in layers: the tool's own mesh of a tyre, and rings of elements from its inner side inwards.

use std::collections::HashMap;
use std::path::Path;

use nalgebra::{Point2, Point3};
use railspring_calibrate::mesh::{Cells, Field, HexMesh, MeshOptions, mesh_wheel, vtu};
use railspring_profiles::section::{WheelSection, wheel_section};

/// Diameter at the tape circle, m.
pub const DIAMETER: f64 = 0.858;
/// Inner radius of the tyre, m.
pub const INSIDE: f64 = 0.37;
/// Sides of the tyre (y), m.
pub const SIDES: [f64; 2] = [-0.07, 0.065];

/// Which group an element around a radius and a lateral place (m) is of; none: there is no element.
pub type Groups<'a> = &'a dyn Fn(f64, f64) -> Option<&'static str>;

/// A wheel: the tyre with the group of radius [`INSIDE`], and below it rings of elements between the `radii` (m, inwards).
pub struct Layered {
    mesh: HexMesh,
    names: Vec<&'static str>,
    bore: Vec<usize>,
    /// Lateral places of the rows of nodes on the inner side of the tyre, m.
    pub rows: Vec<f64>,
}

impl Layered {
    pub fn new(radii: &[f64], group: Groups<'_>) -> Self {
        let standard = wheel_section("S1002", DIAMETER).unwrap();
        let (first, last) = (standard.running.point(0.0), standard.running.point(standard.running.length()));
        let top = INSIDE - standard.radius;
        let body = vec![last, Point2::new(SIDES[1], top), Point2::new(SIDES[0], top), first];
        let tyre = WheelSection { body, bore_radius: INSIDE, ..standard };
        let options = MeshOptions {
            contact_element: 6e-3,
            contact_element_along: 6e-3,
            wheel_section_element: 15e-3,
            wheel_arc_element: 90e-3,
            ..MeshOptions::default()
        };
        let mut mesh = mesh_wheel(&tyre, &options).unwrap();
        let mut names = vec![group(INSIDE, 0.0).unwrap(); mesh.hexes.len()];
        // the nodes of the inner side by rows (y) and angles, both ascending
        let key = |v: f64| (v * 1e9).round() as i64;
        let place = |p: &Point3<f64>| [key(p.y), key(p.x.atan2(p.z))];
        let on = |axis: usize| {
            let mut all: Vec<i64> = mesh.bore.iter().map(|&v| place(&mesh.nodes[v])[axis]).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let (rows, angles) = (on(0), on(1));
        assert_eq!(rows.len() * angles.len(), mesh.bore.len(), "the inner side is a grid");
        let mut node: HashMap<[usize; 3], usize> = HashMap::new();
        for &v in &mesh.bore {
            let [y, angle] = place(&mesh.nodes[v]);
            node.insert([0, rows.binary_search(&y).unwrap(), angles.binary_search(&angle).unwrap()], v);
        }
        let value = |key: i64| key as f64 * 1e-9;
        for ring in 1..=radii.len() {
            let outer = if ring == 1 { INSIDE } else { radii[ring - 2] };
            for j in 1..rows.len() {
                let Some(name) = group(0.5 * (outer + radii[ring - 1]), 0.5 * value(rows[j - 1] + rows[j]))
                else {
                    continue;
                };
                for k in 0..angles.len() {
                    let mut at = |ring: usize, j: usize, k: usize| {
                        let k = k % angles.len();
                        *node.entry([ring, j, k]).or_insert_with(|| {
                            let (rho, angle) = (radii[ring - 1], value(angles[k]));
                            mesh.nodes.push(Point3::new(
                                rho * angle.sin(),
                                value(rows[j]),
                                rho * angle.cos(),
                            ));
                            mesh.nodes.len() - 1
                        })
                    };
                    let mut face =
                        |k| [at(ring, j - 1, k), at(ring, j, k), at(ring - 1, j, k), at(ring - 1, j - 1, k)];
                    let ([a, b, c, d], [e, f, g, h]) = (face(k), face(k + 1));
                    mesh.hexes.push([a, b, c, d, e, f, g, h]);
                    names.push(name);
                }
            }
        }
        let bore = node.iter().filter(|(at, _)| at[0] == radii.len()).map(|(_, v)| *v).collect();
        Self { mesh, names, bore, rows: rows.into_iter().map(value).collect() }
    }

    /// Writes it in m, with masks of nodes `running surface` and `bore` and a mask of cells for each group.
    pub fn write(&self, path: &Path) {
        let mask = |nodes: &[usize]| {
            let mut mask = vec![0.0; self.mesh.nodes.len()];
            nodes.iter().for_each(|&v| mask[v] = 1.0);
            mask
        };
        let (running, bore) = (mask(&self.mesh.contact.nodes), mask(&self.bore));
        let points = [Field::Scalar("running surface", &running), Field::Scalar("bore", &bore)];
        let mut groups: Vec<&str> = self.names.clone();
        groups.sort_unstable();
        groups.dedup();
        let of = |group: &str| self.names.iter().map(|name| f64::from(u8::from(*name == group))).collect();
        let masks: Vec<Vec<f64>> = groups.iter().map(|group| of(group)).collect();
        let cells: Vec<Field> =
            groups.iter().zip(&masks).map(|(group, mask)| Field::Scalar(group, mask)).collect();
        let text = vtu(&self.mesh.nodes, Cells::Hexes(&self.mesh.hexes), &points, &cells).unwrap();
        std::fs::write(path, text).unwrap();
    }
}

/// A wheel whose tyre lies on a ring of rubber of `elements` through its thickness, down to the radius `inner` (m), on a centre of steel.
pub fn resilient(inner: f64, elements: usize) -> Layered {
    let step = |i: usize| INSIDE + (inner - INSIDE) * i as f64 / elements as f64;
    let radii: Vec<f64> = (1..=elements).map(step).chain([0.31, 0.28, 0.25]).collect();
    Layered::new(&radii, &|radius, _| {
        Some(if radius >= INSIDE {
            "tyre"
        } else if radius > inner {
            "rubber"
        } else {
            "centre"
        })
    })
}

/// A wheel with a brake disc on either side of its web.
pub fn with_discs() -> Layered {
    let radii = [0.345, 0.32, 0.295, 0.27, 0.245, 0.22, 0.195, 0.17, 0.15, 0.13, 0.11, 0.09];
    Layered::new(&radii, &|radius, y| match (radius, y.abs()) {
        (0.32.., _) | (..0.15, _) | (_, ..0.018) => Some("wheel"),
        (0.195..0.295, ..0.045) => Some("discs"),
        _ => None,
    })
}
