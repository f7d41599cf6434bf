//! The bodies: a rail and a wheel.

use nalgebra::Point2;

use super::section_mesh::{SectionOutline, SurfacePoint, mesh_section};
use super::sweep::{extrude, graded, revolve};
use super::{FineZone, HexMesh, MeshOptions};
use crate::error::{InputError, Result};
use crate::placement::PlacedRail;
use crate::profile::ProfileCurve;
use crate::section::{RailSection, WheelSection};

/// Vertex spacing (m) with which the running curve outside the fine zone is
/// followed: on a radius of 12 mm the chord is off by 0.7 µm.
const CURVE_STEP: f64 = 2.5e-4;
/// A node this near (m) to the foot's plane or the bore lies on it.
const ON_SURFACE: f64 = 1e-6;

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
    options.check()?;
    if !(length.is_finite() && length > 2.0 * options.window_half_length) {
        return Err(InputError::new(
            "rail.length",
            format!("{:.1} mm", length * 1e3),
            format!("more than the contact window of {:.1} mm", 2e3 * options.window_half_length),
            "take a longer rail or a shorter window",
        )
        .into());
    }
    let mut mesh =
        mesh_section(&rail_outline(section, options)?, &options.sizes(options.rail_section_element))?;
    let foot = on_line(&mesh.boundary, &mesh.nodes, section.height);
    mesh.nodes.iter_mut().for_each(|p| *p = placed.to_world(p));
    let half = half_positions(options, 0.5 * length, options.rail_length_element);
    let x: Vec<f64> = half.iter().skip(1).rev().map(|v| -v).chain(half.iter().copied()).collect();
    Ok(extrude(&mesh, &x, options.window_half_length, &foot))
}

/// Meshes a wheel, the full revolution, in its body frame: origin at the hub
/// centre, a section point (y, z) at the angle θ from straight down sits at
/// `(ρ sin θ, y, ρ cos θ)` with `ρ = radius + z`.
///
/// # Errors
/// When an option is out of range, or the section cannot be meshed.
pub fn mesh_wheel(section: &WheelSection, options: &MeshOptions) -> Result<HexMesh> {
    options.check()?;
    let mesh =
        mesh_section(&wheel_outline(section, options)?, &options.sizes(options.wheel_section_element))?;
    let bore = on_line(&mesh.boundary, &mesh.nodes, section.bore_radius - section.radius);
    // Half around, as arc length at the tape circle; the far end is one layer of nodes.
    let half = half_positions(options, std::f64::consts::PI * section.radius, options.wheel_arc_element);
    let other = half[1..half.len() - 1].iter().rev().map(|v| -v);
    let theta: Vec<f64> = other.chain(half.iter().copied()).map(|arc| arc / section.radius).collect();
    Ok(revolve(&mesh, section.radius, &theta, options.window_half_length / section.radius, &bore))
}

/// Boundary nodes at the coordinate `z`.
fn on_line(boundary: &[usize], nodes: &[Point2<f64>], z: f64) -> Vec<usize> {
    boundary.iter().copied().filter(|&j| (nodes[j].y - z).abs() < ON_SURFACE).collect()
}

/// Positions along one half of a sweep, from the middle of the window to `end`.
fn half_positions(options: &MeshOptions, end: f64, largest: f64) -> Vec<f64> {
    graded(options.window_half_length, end, options.contact_element, options.growth, largest)
}

/// Outline of a rail's section with its contact nodes, in the profile frame.
///
/// # Errors
/// When the fine zone does not lie on the running curve.
pub fn rail_outline(section: &RailSection, options: &MeshOptions) -> Result<SectionOutline> {
    outline(&section.running, &section.body, &options.rail_zone, options.contact_element, 1.0, "mesh.rail_zone")
}

/// Outline of a wheel's section with its contact nodes, in the profile frame.
///
/// # Errors
/// When the fine zone does not lie on the running curve.
pub fn wheel_outline(section: &WheelSection, options: &MeshOptions) -> Result<SectionOutline> {
    outline(&section.running, &section.body, &options.wheel_zone, options.contact_element, -1.0, "mesh.wheel_zone")
}

/// `below` is 1 when the material lies below the running curve (a rail), -1 when above.
fn outline(
    running: &ProfileCurve,
    body: &[Point2<f64>],
    zone: &FineZone,
    element: f64,
    below: f64,
    key: &str,
) -> Result<SectionOutline> {
    let no_end = |what: &str, value: f64| {
        InputError::new(
            format!("{key}.{what}"),
            format!("{:.2} mm", value * 1e3),
            "a position on the running curve",
            "move the end of the fine zone onto the profile",
        )
    };
    let top = running.s_at_y(0.0).ok_or_else(|| no_end("face_depth", zone.face_depth))?;
    let first = face_end(running, top, zone.face_depth).ok_or_else(|| no_end("face_depth", zone.face_depth))?;
    let last = running
        .s_at_y(zone.field_y)
        .filter(|last| last - first > 2.0 * element)
        .ok_or_else(|| no_end("field_y", zone.field_y))?;

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
