//! The bodies: a rail and a wheel.

use nalgebra::Point2;

use super::hex_mesh::HexMesh;
use super::options::{ContactZone, MeshOptions};
use super::section_mesh::{SectionMesh, SectionOutline, SurfacePoint, mesh_section};
use super::sweep::{extrude, graded, in_window, revolve};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::placement::PlacedRail;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::section::{RailSection, WheelSection};

/// Vertex spacing (m) with which the running curve outside the contact zone is
/// followed: on a radius of 12 mm the chord is off by 0.7 µm.
const CURVE_STEP: f64 = 2.5e-4;
/// A node this near (m) to the foot's plane or the bore lies on it.
const ON_SURFACE: f64 = 1e-6;

/// Numbers of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshSize {
    /// Nodes.
    pub nodes: usize,
    /// Hexahedra.
    pub hexes: usize,
    /// Nodes at which contact can take place.
    pub contact: usize,
}

impl MeshSize {
    /// Size of a mesh that is there.
    pub fn of(mesh: &HexMesh) -> Self {
        Self { nodes: mesh.nodes.len(), hexes: mesh.hexes.len(), contact: mesh.contact.nodes.len() }
    }
}

/// Size of the mesh that [`mesh_rail`] makes, from its section and its layers alone.
///
/// # Errors
/// As [`mesh_rail`].
pub fn rail_size(section: &RailSection, length: f64, options: &MeshOptions) -> Result<MeshSize> {
    let plane = rail_section_mesh(section, length, options)?;
    let x = rail_layers([0.5 * length; 2], options);
    Ok(MeshSize {
        nodes: plane.nodes.len() * x.len(),
        hexes: plane.quads.len() * (x.len() - 1),
        contact: plane.contact.len() * in_window(&x, grid_half_length(&x, 1.0, options)).count(),
    })
}

/// Size of the mesh that [`mesh_wheel`] makes, from its section and its layers alone.
///
/// # Errors
/// As [`mesh_wheel`].
pub fn wheel_size(section: &WheelSection, options: &MeshOptions) -> Result<MeshSize> {
    let plane = wheel_section_mesh(section, options)?;
    let theta = wheel_layers(section.radius, options);
    Ok(MeshSize {
        nodes: plane.nodes.len() * theta.len(),
        hexes: plane.quads.len() * theta.len(),
        contact: plane.contact.len()
            * in_window(&theta, grid_half_length(&theta, section.radius, options)).count(),
    })
}

/// Least nodes of the mesh that [`mesh_rail`] makes, all contact nodes among them, without meshing its section: those of the structured layers below the
/// contact zone alone.
///
/// # Errors
/// When an option is out of range, or the contact zone does not lie on the running curve.
pub fn least_rail_size(section: &RailSection, length: f64, options: &MeshOptions) -> Result<MeshSize> {
    options.check()?;
    check_rail_window(length, options)?;
    let x = rail_layers([0.5 * length; 2], options);
    let window = in_window(&x, grid_half_length(&x, 1.0, options)).count();
    Ok(least(&rail_outline(section, options)?, options, [x.len(), x.len() - 1], window))
}

/// The same of the mesh that [`mesh_wheel`] makes.
///
/// # Errors
/// As [`least_rail_size`].
pub fn least_wheel_size(section: &WheelSection, options: &MeshOptions) -> Result<MeshSize> {
    options.check()?;
    check_wheel_window(section.radius, options)?;
    let theta = wheel_layers(section.radius, options);
    let window = in_window(&theta, grid_half_length(&theta, section.radius, options)).count();
    Ok(least(&wheel_outline(section, options)?, options, [theta.len(); 2], window))
}

/// The structured layers below a contact zone, swept over sections `along` (of nodes, of hexahedra), of which those in the `window` have contact nodes.
fn least(outline: &SectionOutline, options: &MeshOptions, along: [usize; 2], window: usize) -> MeshSize {
    let (across, (layers, _)) = (outline.fine.len(), options.layering());
    MeshSize {
        nodes: across * (layers + 1) * along[0],
        hexes: (across - 1) * layers * along[1],
        contact: across * window,
    }
}

/// Meshes a rail in the world frame, from `-length / 2` to `length / 2` along x.
///
/// # Errors
/// When an option is out of range, or the section cannot be meshed.
pub fn mesh_rail(
    section: &RailSection,
    placed: &PlacedRail,
    length: f64,
    options: &MeshOptions,
) -> Result<HexMesh> {
    mesh_rail_between(section, placed, [0.5 * length; 2], options)
}

/// Meshes a rail in the world frame whose first and second end are at the distances `ends` (m) from the contact at x = 0.
///
/// # Errors
/// As [`mesh_rail`].
pub fn mesh_rail_between(
    section: &RailSection,
    placed: &PlacedRail,
    ends: [f64; 2],
    options: &MeshOptions,
) -> Result<HexMesh> {
    let mut mesh = rail_section_mesh(section, 2.0 * ends[0].min(ends[1]), options)?;
    let foot = on_line(&mesh.boundary, &mesh.nodes, section.height);
    mesh.nodes.iter_mut().for_each(|p| *p = placed.to_world(p));
    let x = rail_layers(ends, options);
    Ok(extrude(&mesh, &x, grid_half_length(&x, 1.0, options), &foot))
}

/// The same with an even number of equally long elements along the track, at least `layers`; the contact grid is the line x = 0.
///
/// # Errors
/// As [`mesh_rail`].
pub fn mesh_even_rail(
    section: &RailSection,
    placed: &PlacedRail,
    length: f64,
    layers: usize,
    options: &MeshOptions,
) -> Result<HexMesh> {
    even_rail(section, placed, length, layers, options, |element| 0.5 * element)
}

/// The same with all lines of the running surface but those of both ends in the contact grid.
///
/// # Errors
/// As [`mesh_rail`].
pub fn mesh_rail_path(
    section: &RailSection,
    placed: &PlacedRail,
    length: f64,
    layers: usize,
    options: &MeshOptions,
) -> Result<HexMesh> {
    even_rail(section, placed, length, layers, options, |element| 0.5 * (length - element))
}

/// A rail of equal elements with the contact grid that reaches as far to either side as `half_length` says of their length, m.
fn even_rail(
    section: &RailSection,
    placed: &PlacedRail,
    length: f64,
    layers: usize,
    options: &MeshOptions,
    half_length: impl Fn(f64) -> f64,
) -> Result<HexMesh> {
    let mut mesh = rail_section_mesh(section, length, options)?;
    let foot = on_line(&mesh.boundary, &mesh.nodes, section.height);
    mesh.nodes.iter_mut().for_each(|p| *p = placed.to_world(p));
    let half = layers.div_ceil(2).max(1) as isize;
    let x: Vec<f64> = (-half..=half).map(|i| 0.5 * length * i as f64 / half as f64).collect();
    Ok(extrude(&mesh, &x, half_length(0.5 * length / half as f64), &foot))
}

/// Half the length of the contact grid of a rail of a `length`, m, with the contact in its middle ([`mesh_rail`]).
pub fn rail_grid_half_length(length: f64, options: &MeshOptions) -> f64 {
    grid_half_length(&rail_layers([0.5 * length; 2], options), 1.0, options)
}

fn rail_section_mesh(section: &RailSection, length: f64, options: &MeshOptions) -> Result<SectionMesh> {
    options.check()?;
    check_rail_window(length, options)?;
    mesh_section(&rail_outline(section, options)?, &options.rail_sizes())
}

/// Positions of the layers of nodes along x.
fn rail_layers(ends: [f64; 2], options: &MeshOptions) -> Vec<f64> {
    let [before, after] = ends.map(|end| half_positions(options, end, options.rail_length_element));
    before.iter().skip(1).rev().map(|v| -v).chain(after).collect()
}

/// Meshes a wheel, the full revolution, in its body frame: origin at the hub
/// centre, a section point (y, z) at the angle θ from straight down sits at
/// `(ρ sin θ, y, ρ cos θ)` with `ρ = radius + z`.
///
/// # Errors
/// When an option is out of range, or the section cannot be meshed.
pub fn mesh_wheel(section: &WheelSection, options: &MeshOptions) -> Result<HexMesh> {
    let mesh = wheel_section_mesh(section, options)?;
    let bore = on_line(&mesh.boundary, &mesh.nodes, section.bore_radius - section.radius);
    let theta = wheel_layers(section.radius, options);
    let half_length = grid_half_length(&theta, section.radius, options);
    Ok(revolve(&mesh, section.radius, &theta, half_length, &bore))
}

fn wheel_section_mesh(section: &WheelSection, options: &MeshOptions) -> Result<SectionMesh> {
    options.check()?;
    check_wheel_window(section.radius, options)?;
    mesh_section(&wheel_outline(section, options)?, &options.wheel_sizes())
}

/// Angles of the layers of nodes. Half around, as arc length at the tape circle; the far end is one layer of nodes.
fn wheel_layers(radius: f64, options: &MeshOptions) -> Vec<f64> {
    let half = half_positions(options, std::f64::consts::PI * radius, options.wheel_arc_element);
    let other = half[1..half.len() - 1].iter().rev().map(|v| -v);
    other.chain(half.iter().copied()).map(|arc| arc / radius).collect()
}

/// Refuses a contact window longer than the rail.
pub(super) fn check_rail_window(length: f64, options: &MeshOptions) -> Result<()> {
    if length.is_finite() && length > 2.0 * options.window_half_length {
        return Ok(());
    }
    InputError::refuse(
        InputField::RailLength,
        format!("{length} m"),
        format!("more than the contact window of {:.1} mm", 2e3 * options.window_half_length),
        "take a longer rail or a shorter `window_half_length`",
    )
}

/// Refuses a contact window that reaches too far around the wheel.
pub(super) fn check_wheel_window(radius: f64, options: &MeshOptions) -> Result<()> {
    if options.window_half_length <= 0.5 * radius {
        return Ok(());
    }
    InputError::refuse(
        InputField::WindowHalfLength,
        format!("{:.1} mm", options.window_half_length * 1e3),
        format!("at most half the wheel's radius of {:.1} mm", radius * 1e3),
        "shorten the contact window",
    )
}

/// Boundary nodes at the coordinate `z`.
fn on_line(boundary: &[usize], nodes: &[Point2<f64>], z: f64) -> Vec<usize> {
    boundary.iter().copied().filter(|&j| (nodes[j].y - z).abs() < ON_SURFACE).collect()
}

/// Positions along one half of a sweep, from the middle of the window to `end`.
fn half_positions(options: &MeshOptions, end: f64, largest: f64) -> Vec<f64> {
    graded(options.window_half_length, end, options.contact_element_along, options.growth, largest)
}

/// Half the length of the contact grid among the `layers` of nodes, in their unit, of which `radius` makes arc lengths: up to the first
/// layer at the wanted distance, the last one that is no end.
fn grid_half_length(layers: &[f64], radius: f64, options: &MeshOptions) -> f64 {
    let wanted = options.contact_half_length.max(options.window_half_length) / radius;
    let ahead = &layers[layers.partition_point(|l| *l < 0.0)..layers.len() - 1];
    let reached = ahead.iter().find(|l| **l >= wanted * (1.0 - 1e-9));
    reached.or(ahead.last()).copied().unwrap_or(wanted)
}

/// Outline of a rail's section with its contact nodes, in the profile frame.
///
/// # Errors
/// When the contact zone does not lie on the running curve.
pub fn rail_outline(section: &RailSection, options: &MeshOptions) -> Result<SectionOutline> {
    outline(
        &section.running,
        &section.body,
        &options.rail_zone,
        options.contact_element,
        1.0,
        [InputField::RailZoneFaceDepth, InputField::RailZoneFieldY],
    )
}

/// Outline of a wheel's section with its contact nodes, in the profile frame.
///
/// # Errors
/// When the contact zone does not lie on the running curve.
pub fn wheel_outline(section: &WheelSection, options: &MeshOptions) -> Result<SectionOutline> {
    outline(
        &section.running,
        &section.body,
        &options.wheel_zone,
        options.contact_element,
        -1.0,
        [InputField::WheelZoneFaceDepth, InputField::WheelZoneFieldY],
    )
}

/// `below` is 1 when the material lies below the running curve (a rail), -1 when above.
fn outline(
    running: &ProfileCurve,
    body: &[Point2<f64>],
    zone: &ContactZone,
    element: f64,
    below: f64,
    [face_depth, field_y]: [InputField; 2],
) -> Result<SectionOutline> {
    let no_end = |field: InputField, value: f64| {
        InputError::new(
            field,
            format!("{:.2} mm", value * 1e3),
            "a position on the running curve",
            "move the end of the contact zone onto the profile",
        )
    };
    let top = running.s_at_y(0.0).ok_or_else(|| no_end(face_depth, zone.face_depth))?;
    let first = face_end(running, top, zone.face_depth).ok_or_else(|| no_end(face_depth, zone.face_depth))?;
    let last = running
        .s_at_y(zone.field_y)
        .filter(|last| last - first > 2.0 * element)
        .ok_or_else(|| no_end(field_y, zone.field_y))?;

    let elements = 2 * ((last - first) / (2.0 * element) - 1e-9).ceil() as usize;
    let fine = (0..=elements)
        .map(|i| {
            let s = first + (last - first) * i as f64 / elements as f64;
            SurfacePoint { point: running.point(s), inward: -below * running.upward_normal(s), s }
        })
        .collect();
    let follow = |from: f64, to: f64| {
        let steps = ((to - from) / CURVE_STEP).ceil().max(1.0) as usize;
        (0..=steps).map(move |i| running.point(from + (to - from) * i as f64 / steps as f64))
    };
    let mut rest: Vec<Point2<f64>> = follow(last, running.length()).collect();
    rest.extend(body);
    rest.extend(follow(0.0, first));
    Ok(SectionOutline { fine, rest })
}

/// Arc length towards the gauge or flange face at which the curve is first `depth` below the origin.
fn face_end(running: &ProfileCurve, top: f64, depth: f64) -> Option<f64> {
    let steps = (top / CURVE_STEP).ceil() as usize;
    let at = |k: usize| top * (1.0 - k as f64 / steps as f64);
    let k = (1..=steps).find(|&k| running.point(at(k)).y >= depth)?;
    let (mut deep, mut shallow) = (at(k), at(k - 1));
    while shallow - deep > 1e-12 {
        let middle = 0.5 * (deep + shallow);
        if running.point(middle).y >= depth { deep = middle } else { shallow = middle }
    }
    Some(deep)
}

#[cfg(test)]
mod tests;
