//! Meshes that were made elsewhere: checked, and brought into the form of the tool's own.
//!
//! The smooth profiles of the study carry the gap, and the mesh carries the stiffness. A mesh has to stand where the
//! tool's own would stand (rail in the world frame, wheel in its body frame), and its contact nodes have to lie on the
//! smooth running surface in a swept grid.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector3};

use super::bodies::{check_rail_window, check_wheel_window};
use super::faces::{Faces, coincident};
use super::given_surface::Smooth;
use super::hex_mesh::HexMesh;
use super::options::MeshOptions;
use super::quality::{is_sound, scaled_jacobian};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::units::MILLIMETRE;

/// Nodes nearer to each other than this are one node that was not merged, m.
const COINCIDENT: f64 = 1e-6;
/// How far an end of the rail may lie from half its length, and its nodes from one plane, m.
const END: f64 = 0.1e-3;
/// Largest extent of a body, m: a rail has at most 20 m, a wheel is smaller. Above, the unit is wrong.
const LARGEST: f64 = 25.0;
/// Smallest of the largest extents of a body, m.
const SMALLEST: f64 = 0.1;
/// Widest angle about the axle without a node: six elements around are the coarsest wheel.
const WIDEST_ANGLE: f64 = PI / 3.0 + 1e-6;
/// Held nodes have to lie this far from a line through two of them, or the body could turn about it, m.
const OFF_LINE: f64 = 1e-3;

/// A mesh that was made elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenMesh {
    /// Coordinates of the nodes, m. Those of a rail are in the world frame, as it lies in the track, with its
    /// middle at x = 0. Those of a wheel are in its body frame: origin in the middle of the hub at the tape
    /// circle, y along the axle, z down.
    pub nodes: Vec<Point3<f64>>,
    /// Nodes of every hexahedron in the order of VTK.
    pub hexes: Vec<[usize; 8]>,
    /// Nodes of the running surface; those outside the contact window are left out.
    pub contact: Vec<usize>,
    /// Nodes that are held: at the foot of a rail, at the bore of a wheel.
    pub held: Vec<usize>,
    /// Group of every hexahedron, by its number among the names; empty where all are of one material.
    pub groups: Vec<usize>,
    /// Names of the groups.
    pub group_names: Vec<String>,
}

/// A rail of `length` (m) from a mesh that was made elsewhere, with its contact grid on the placed running `curve`.
///
/// The ends are the nodes of the first and the last plane across x.
///
/// # Errors
/// [`InputError`] with a field of the rail for a mesh that is not sound, not in its place or not as long as the rail,
/// and for a contact surface that is no swept grid on the curve.
pub fn given_rail(
    given: GivenMesh,
    curve: &ProfileCurve,
    length: f64,
    options: &MeshOptions,
) -> Result<HexMesh> {
    check_rail_window(length, options)?;
    let faces = check_solid(&given, ("rail", InputField::RailMesh, InputField::RailMeshUnit))?;
    let half = 0.5 * length;
    let bound = |pick: fn(f64, f64) -> f64, start: f64| given.nodes.iter().map(|p| p.x).fold(start, pick);
    let (first, last) = (bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY));
    if !((first + half).abs() <= END && (last - half).abs() <= END) {
        return InputError::refuse(
            InputField::RailMesh,
            format!("a rail from x = {:.3} to {:.3} mm", first / MILLIMETRE, last / MILLIMETRE),
            format!(
                "a rail from x = {:.3} to {:.3} mm, by `rail_length`",
                -half / MILLIMETRE,
                half / MILLIMETRE
            ),
            "x runs along the track with its zero in the middle: move the mesh, or set `rail_length` to its length",
        );
    }
    let smooth = Smooth { field: InputField::RailContactSurface, curve, radius: None };
    let contact = smooth.grid(&given.nodes, &faces.outer, &given.contact, options.window_half_length)?;
    let ends = [first, last].map(|x| -> Vec<usize> {
        (0..given.nodes.len()).filter(|&v| (given.nodes[v].x - x).abs() <= END).collect()
    });
    for end in &ends {
        check_held(
            &given.nodes,
            end,
            InputField::RailMesh,
            "nodes at an end of the rail, on a plane across x",
        )?;
    }
    let ends = sorted(ends.concat());
    check_apart(&contact.nodes, &ends, InputField::RailContactSurface, "the ends of the rail")?;
    check_apart(&contact.nodes, &given.held, InputField::RailHeldNodes, "the contact surface")?;
    check_held(&given.nodes, &given.held, InputField::RailHeldNodes, "nodes that hold the foot")?;
    let foot = sorted(given.held);
    let GivenMesh { nodes, hexes, groups, group_names, .. } = given;
    let mesh = HexMesh { nodes, hexes, groups, contact, ends, foot, bore: Vec::new() };
    check_contact_material(&mesh, &group_names, InputField::RailMaterials)?;
    Ok(mesh)
}

/// A wheel from a mesh that was made elsewhere, with its contact grid on the `running` curve revolved with the given
/// `radius` (m) at its z = 0.
///
/// # Errors
/// [`InputError`] with a field of the wheel for a mesh that is not sound, not in its place or no full wheel, and for
/// a contact surface that is no swept grid on the curve.
pub fn given_wheel(
    given: GivenMesh,
    running: &ProfileCurve,
    radius: f64,
    options: &MeshOptions,
) -> Result<HexMesh> {
    check_wheel_window(radius, options)?;
    let faces = check_solid(&given, ("wheel", InputField::WheelMesh, InputField::WheelMeshUnit))?;
    let mut angles: Vec<f64> = given.nodes.iter().map(|p| p.x.atan2(p.z)).collect();
    angles.sort_by(f64::total_cmp);
    let around = angles.first().map_or(TAU, |first| first + TAU - angles[angles.len() - 1]);
    let widest = angles.windows(2).map(|pair| pair[1] - pair[0]).fold(around, f64::max);
    if !(widest <= WIDEST_ANGLE) {
        return InputError::refuse(
            InputField::WheelMesh,
            format!("no nodes over {:.1}\u{b0} about the axle", widest.to_degrees()),
            "a full wheel about the y axis",
            "mesh the whole revolution, with the axle on y and the origin in the middle of the hub",
        );
    }
    let smooth = Smooth { field: InputField::WheelContactSurface, curve: running, radius: Some(radius) };
    let contact = smooth.grid(&given.nodes, &faces.outer, &given.contact, options.window_half_length)?;
    check_apart(&contact.nodes, &given.held, InputField::WheelHeldNodes, "the contact surface")?;
    check_held(&given.nodes, &given.held, InputField::WheelHeldNodes, "nodes that follow the hub")?;
    let bore = sorted(given.held);
    let GivenMesh { nodes, hexes, groups, group_names, .. } = given;
    let mesh = HexMesh { nodes, hexes, groups, contact, ends: Vec::new(), foot: Vec::new(), bore };
    check_contact_material(&mesh, &group_names, InputField::WheelMaterials)?;
    Ok(mesh)
}

fn sorted(mut nodes: Vec<usize>) -> Vec<usize> {
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

fn place(p: &Point3<f64>) -> String {
    format!("({:.3}, {:.3}, {:.3}) mm", p.x / MILLIMETRE, p.y / MILLIMETRE, p.z / MILLIMETRE)
}

/// Checks that the hexahedra are one sound body of a plausible size; returns its faces.
fn check_solid(given: &GivenMesh, fields: (&str, InputField, InputField)) -> Result<Faces> {
    let GivenMesh { nodes, hexes, contact, held, groups, group_names } = given;
    let (section, file, unit) = fields;
    let refuse = |value: String, expected: &str, remedy: &str| -> Result<Faces> {
        InputError::refuse(file, value, expected, remedy)
    };
    let beyond = hexes.iter().flatten().chain(contact).chain(held).find(|&&v| v >= nodes.len());
    if let Some(&v) = beyond {
        return refuse(
            format!("node {v} of {}", nodes.len()),
            "nodes that the mesh has",
            "write the mesh again",
        );
    }
    let most = group_names.len();
    if !groups.is_empty() && (groups.len() != hexes.len() || groups.iter().any(|&group| group >= most)) {
        return refuse(
            format!("{} groups of {} hexahedra, {most} names", groups.len(), hexes.len()),
            "a group with a name for every hexahedron",
            "write the mesh again",
        );
    }
    let mut used = vec![false; nodes.len()];
    hexes.iter().flatten().for_each(|&v| used[v] = true);
    if let Some(v) = used.iter().position(|used| !used) {
        let value = format!("a node at {} that belongs to no hexahedron", place(&nodes[v]));
        return refuse(value, "nodes of hexahedra only", "leave the node out");
    }
    let extent = (0..3)
        .map(|d| {
            let bound = |pick: fn(f64, f64) -> f64, start: f64| nodes.iter().map(|p| p[d]).fold(start, pick);
            bound(f64::max, f64::NEG_INFINITY) - bound(f64::min, f64::INFINITY)
        })
        .fold(0.0, f64::max);
    if !(SMALLEST..=LARGEST).contains(&extent) {
        let other = if extent > LARGEST { "mm" } else { "m" };
        return InputError::refuse(
            unit,
            format!("a {section} of {extent:.6} m"),
            format!("a {section} between {SMALLEST} and {LARGEST} m large"),
            format!("if the file is in {other}, set `{unit}` = \"{other}\""),
        );
    }
    if let Some((a, b)) = coincident(nodes, COINCIDENT) {
        return refuse(
            format!("nodes {a} and {b}, counted from zero, both at {}", place(&nodes[a])),
            "every place with one node",
            "merge coincident nodes: where the elements have each their own, the body has a crack",
        );
    }
    check_elements(given, file)?;
    let faces = Faces::new(hexes);
    if let Some(face) = faces.overfull {
        let value = format!("a face at {} that belongs to more than two hexahedra", place(&nodes[face[0]]));
        return refuse(value, "faces of one or two hexahedra", "remove the elements that stand there twice");
    }
    if faces.pieces > 1 {
        let (e, size) = faces.smallest;
        return refuse(
            format!(
                "{} pieces; the smallest, of {size} hexahedra, has one at {}",
                faces.pieces,
                place(&nodes[hexes[e][0]])
            ),
            "one body whose elements are joined by common faces",
            "merge the nodes of parts that belong together, and leave other bodies out of the file",
        );
    }
    Ok(faces)
}

/// Checks that no element is inverted or flat.
fn check_elements(given: &GivenMesh, file: InputField) -> Result<()> {
    let corner = |hex: &[usize; 8]| hex.map(|v| given.nodes[v]);
    let bad: Vec<usize> = (0..given.hexes.len()).filter(|&e| !is_sound(&corner(&given.hexes[e]))).collect();
    let Some(&first) = bad.first() else {
        return Ok(());
    };
    let nodes = corner(&given.hexes[first]);
    let middle = Point3::from(nodes.iter().map(|p| p.coords).sum::<Vector3<f64>>() / 8.0);
    let remedy = if bad.len() == given.hexes.len() {
        "the mesh is mirrored: its axes have to be right-handed (x along the track, y to the field side, z down), and \
         the nodes of the elements in the order of VTK, Gmsh and Abaqus"
    } else {
        "correct these elements: corners that fold over, or nodes in another order than that of VTK, Gmsh and Abaqus"
    };
    InputError::refuse(
        file,
        format!(
            "{} of {} hexahedra inverted or flat, the first around {} with a scaled Jacobian of {:.3e}",
            bad.len(),
            given.hexes.len(),
            place(&middle),
            scaled_jacobian(&nodes)
        ),
        "positive Jacobians",
        remedy,
    )
}

/// Checks that one group reaches the contact surface: the contact sees a half-space there, of one material.
fn check_contact_material(mesh: &HexMesh, names: &[String], field: InputField) -> Result<()> {
    let mut at_contact = mesh.at_contact();
    let Some(first) = at_contact.next() else { return Ok(()) };
    let Some(other) = at_contact.find(|&e| mesh.group(e) != mesh.group(first)) else { return Ok(()) };
    let nodes = mesh.hexes[other].map(|v| mesh.nodes[v]);
    let middle = Point3::from(nodes.iter().map(|p| p.coords).sum::<Vector3<f64>>() / 8.0);
    let [one, two] = [first, other].map(|e| names.get(mesh.group(e)).map_or("", String::as_str));
    InputError::refuse(
        field,
        format!("{one:?} and {two:?} at the contact surface, the latter around {}", place(&middle)),
        "one group under the whole contact surface within the window, for the contact is that of a half-space of one material",
        "put the elements with a node on the contact surface into one group, or name a shorter surface",
    )
}

/// Checks that two groups of nodes have none in common; `other` is what the second one is.
fn check_apart(contact: &[usize], nodes: &[usize], field: InputField, other: &str) -> Result<()> {
    let contact: BTreeSet<usize> = contact.iter().copied().collect();
    let common = nodes.iter().filter(|v| contact.contains(v)).count();
    if common == 0 {
        return Ok(());
    }
    InputError::refuse(
        field,
        format!("{common} nodes that belong to {other} too"),
        "contact nodes that are free to move",
        "name different nodes; a contact node cannot be held",
    )
}

/// Checks that nodes can hold a body: at least three that do not lie on a line.
fn check_held(nodes: &[Point3<f64>], held: &[usize], field: InputField, what: &str) -> Result<()> {
    let spread = held.first().map_or(0.0, |&a| {
        let arm = |v: usize| nodes[v] - nodes[a];
        let far = held
            .iter()
            .map(|&v| arm(v))
            .fold(Vector3::zeros(), |best: Vector3<f64>, v| if v.norm() > best.norm() { v } else { best });
        let line = far.try_normalize(0.0).unwrap_or_default();
        held.iter().map(|&v| arm(v).cross(&line).norm()).fold(0.0, f64::max)
    });
    if spread >= OFF_LINE {
        return Ok(());
    }
    InputError::refuse(
        field,
        format!("{} nodes on a line", held.len()),
        format!("{what}, at least three that are not on a line"),
        "name the nodes of a surface",
    )
}

#[cfg(test)]
mod tests;
