//! The head of a rail near an end that is held.
//!
//! Nearer to a held end the head is stiffer against its rail than in the middle: web and head are held there, and no section warps. Beyond the statics of a rail whose
//! ends hinder it from warping ([`HeldRail`]), how much the head moves depends on its distance from the nearer end alone, whatever the rail's length, so that a short solid rail
//! says it for all.

use super::sections::{RunningSurface, SectionFlexibility};
use nalgebra::{Matrix3, Point2, Point3, Vector3};
use railspring_calibrate::beam::HeldRail;
use railspring_calibrate::contact::{HalfSpace, Side};
use railspring_calibrate::mesh::{HexMesh, MeshOptions, SurfaceGrid, mesh_even_rail, mesh_rail};
use railspring_calibrate::pair::{CondensedPair, Pair};
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::{SectionMotion, Superelement, carried};
use railspring_element::held_end::{EndPlace, HeldEnd, in_world};
use railspring_profiles::error::Result;

/// The longest solid rail that is asked, m: four heights of a rail on either side of its middle.
const LONGEST: f64 = 0.7;
/// Length of its elements along the track, m, and the largest edges of those of its section, m.
const LAYER: f64 = 10e-3;
const SURFACE: f64 = 6e-3;
const SECTION: f64 = 16e-3;
/// Elements from an end to the first place: nearer, a load on all of the running surface is not what a contact is. From the second on there are places every so many.
const FIRST: usize = 4;
const NEAR: usize = 12;
const EVERY: usize = 3;
/// The shear flexibility is taken off in steps of this length at either end, m, up to the largest.
const INSET_STEP: f64 = 1e-3;
const MOST_INSET: f64 = 0.06;

/// A solid rail between held ends under the forces of the head's section at places along it.
struct Stub<'a> {
    element: Superelement<'a>,
    /// The running surface in the first layer.
    surface: Rows,
    /// Nodes of a layer, and length of an element, m.
    layer: usize,
    pitch: f64,
}

/// The mesh of a solid rail of a `length`, m, with equally long elements.
fn even(pair: &Pair, length: f64) -> Result<HexMesh> {
    let options = MeshOptions {
        contact_element: SURFACE,
        rail_section_element: SECTION,
        window_half_length: LAYER,
        ..MeshOptions::default()
    };
    mesh_even_rail(&pair.rail, &pair.placed, length, (length / LAYER).ceil() as usize, &options)
}

impl<'a> Stub<'a> {
    fn new(pair: &Pair, mesh: &'a HexMesh, material: &Material, length: f64) -> Result<Self> {
        let supports = Supports { held: mesh.ends.clone(), ..Supports::default() };
        let system = System::new(mesh, *material, Formulation::IncompatibleModes, &supports)?;
        // both end faces are held
        let layer = mesh.ends.len() / 2;
        let nodes = mesh.contact.nodes.iter().map(|&node| (node % layer, mesh.nodes[node].yz()));
        let surface = nearest_motion(nodes, &pair.node_line());
        let pitch = length / (mesh.nodes.len() / layer - 1) as f64;
        Ok(Self { element: Superelement::new(system)?, surface, layer, pitch })
    }

    /// The running surface so many `layers` from the end.
    fn rows(&self, layers: usize) -> Rows {
        self.surface.iter().map(|(node, row)| (node + layers * self.layer, *row)).collect()
    }

    /// Displacements of all nodes (`3·node + axis`, m) under a torque of 1 N·m on the middle section.
    fn twisted(&self, pair: &Pair) -> Result<Vec<f64>> {
        let [_, _, torque] = pair.section_loads(self.element.system.mesh, 0.0)?.unit;
        Ok(self.element.solve(&torque))
    }

    /// Motion of the head's section under its own forces, so many `layers` from the end, with what these do to the nodes themselves.
    fn head(&self, layers: usize) -> Matrix3<f64> {
        let rows = self.rows(layers);
        let columns = [0, 1, 2].map(|k| {
            let mut forces = vec![0.0; 3 * self.element.system.mesh.nodes.len()];
            for (node, row) in &rows {
                (0..2).for_each(|axis| forces[3 * node + 1 + axis] = row[axis][k]);
            }
            motion(&rows, &self.element.solve(&forces))
        });
        let flexibility = Matrix3::from_columns(&columns);
        (flexibility + flexibility.transpose()) * 0.5
    }
}

/// The ends of the rail of a pair between whose ends of a `length` (m) the `bodies` have it, or of one of 0.7 m if that is shorter; `head` is the head in the middle of the bodies' rail against
/// its section.
///
/// # Errors
/// A rail too short for its mesh, and an inverted element.
pub fn held_end(
    pair: &Pair,
    bodies: &CondensedPair,
    head: &SectionFlexibility,
    length: f64,
) -> Result<HeldEnd> {
    let material = &bodies.rail_on_ends.surface;
    let (length, middle) = match length <= LONGEST {
        true => (length, head.flexibility + of_section(pair, &bodies.section, &bodies.rail_on_ends.grid)),
        false => (LONGEST, whole_in_middle(pair, material, LONGEST)?),
    };
    let mesh = even(pair, length)?;
    let stub = Stub::new(pair, &mesh, material, length)?;
    let last = ((0.5 * length / stub.pitch).round() as usize).max(FIRST);
    let beyond = (NEAR..last).step_by(EVERY);
    let layers = (FIRST..NEAR.min(last)).chain(beyond).chain([last]);
    let twisted = stub.twisted(pair)?;
    let places: Vec<(f64, Matrix3<f64>, Vector3<f64>)> = layers
        .map(|layers| {
            let twist = motion(&stub.rows(layers), &twisted);
            (layers as f64 * stub.pitch, stub.head(layers), twist)
        })
        .collect();
    let of_nodes = places.last().map_or_else(Matrix3::zeros, |(_, of_middle, _)| *of_middle);
    let against = |inset: f64| -> Vec<EndPlace> {
        let rail = HeldRail::new(&pair.properties, material, length, inset);
        let place = |&(distance, head, twist): &(f64, Matrix3<f64>, Vector3<f64>)| {
            let of_rail = in_world(pair.placed.angle, rail.flexibility(distance));
            let turned = Vector3::new(0.0, 0.0, rail.twist(0.5 * length, distance));
            EndPlace { distance, flexibility: head - of_nodes + middle - of_rail, twist: twist - turned }
        };
        places.iter().map(place).collect()
    };
    let stores = |places: &[EndPlace]| places.iter().all(|place| place.flexibility[(1, 1)] >= 0.0);
    let steps = (MOST_INSET / INSET_STEP) as usize;
    let mut insets = (0..=steps).map(|step| step as f64 * INSET_STEP);
    let inset = insets.find(|inset| stores(&against(*inset))).unwrap_or(MOST_INSET);
    Ok(HeldEnd { inset, places: against(inset) })
}

/// Flexibility of the middle of a solid rail of a `length` (m) under forces on its head, beyond what is a contact's.
fn whole_in_middle(pair: &Pair, material: &Material, length: f64) -> Result<Matrix3<f64>> {
    let options =
        MeshOptions { contact_element: SURFACE, rail_length_element: 2.0 * LAYER, ..MeshOptions::default() };
    let mesh = mesh_rail(&pair.rail, &pair.placed, length, &options)?;
    let supports = Supports { held: mesh.ends.clone(), ..Supports::default() };
    let element =
        Superelement::new(System::new(&mesh, *material, Formulation::IncompatibleModes, &supports)?)?;
    let loads = pair.section_loads(&mesh, 0.0)?;
    let section = SectionMotion::new(&mesh, &loads, |forces| element.solve(forces));
    let nodes: Vec<Point3<f64>> = mesh.contact.nodes.iter().map(|&node| mesh.nodes[node]).collect();
    let surface = RunningSurface {
        compliance: &section.relative(&element.compliance),
        grid: &mesh.contact,
        nodes: &nodes,
        half_space: HalfSpace::new(material, Side::Base),
    };
    Ok(surface.section(pair.node_line()).flexibility + of_section(pair, &section, &mesh.contact))
}

/// What of the motion of the head under its own forces is that of the section under it: the head under the forces of a beam on the section, the section under those of the head, and what is in both.
fn of_section(pair: &Pair, section: &SectionMotion, grid: &SurfaceGrid) -> Matrix3<f64> {
    let (columns, about) = (grid.along_track.len(), pair.node_line());
    let middle =
        (0..columns).min_by(|&a, &b| grid.along_track[a].abs().total_cmp(&grid.along_track[b].abs()));
    let nodes = (0..grid.along_profile.len()).map(|line| line * columns + middle.unwrap_or(0));
    let rows = nearest_motion(nodes.map(|node| (node, section.places()[node])), &about);
    let head = Matrix3::from_columns(&[0, 1, 2].map(|k| motion(&rows, section.moved(k))));
    head + head.transpose() - section.flexibility
}

/// What of the motion of a section (y, z, rotation about a point) the displacements y and z of each node are, in the motion nearest to all of them; their transpose are the forces of a section on the
/// nodes.
type Rows = Vec<(usize, [Vector3<f64>; 2])>;

fn nearest_motion(nodes: impl Iterator<Item = (usize, Point2<f64>)>, about: &Point2<f64>) -> Rows {
    let arms: Vec<_> = nodes.map(|(node, place)| (node, carried(&(place - about)))).collect();
    let normal: Matrix3<f64> = arms.iter().map(|(_, arm)| arm.tr_mul(arm)).sum();
    let inverse = normal.try_inverse().unwrap_or_else(Matrix3::zeros);
    arms.iter().map(|(node, arm)| (*node, [0, 1].map(|axis| inverse * arm.row(axis).transpose()))).collect()
}

/// The motion of the section nearest to displacements (`3·node + axis`).
fn motion(rows: &Rows, moved: &[f64]) -> Vector3<f64> {
    rows.iter().map(|(node, row)| row[0] * moved[3 * node + 1] + row[1] * moved[3 * node + 2]).sum()
}
