//! A section swept to a body: straight along the track, or about the axle.

use nalgebra::Point3;

use super::hex_mesh::{HexMesh, SurfaceGrid};
use super::section_mesh::SectionMesh;

/// How the nodes are numbered: node `j` of the section in layer `l` is `l * section_nodes + j`.
#[derive(Clone, Copy)]
struct SweepLayout {
    /// Number of nodes of the section.
    section_nodes: usize,
    /// Number of layers of nodes along the sweep.
    layers: usize,
    /// Whether the last layer of nodes is joined to the first by elements (a wheel).
    closed: bool,
}

/// A section swept along x.
///
/// The section's nodes are `(y, z)`. `x` are the positions of the layers of
/// nodes, increasing; those within `window` of zero carry the contact grid.
/// `foot` are nodes of the section that lie on the foot.
#[must_use]
pub fn extrude(section: &SectionMesh, x: &[f64], window: f64, foot: &[usize]) -> HexMesh {
    let count = section.nodes.len();
    let layout = SweepLayout { section_nodes: count, layers: x.len(), closed: false };
    let nodes = x.iter().flat_map(|&x| section.nodes.iter().map(move |p| Point3::new(x, p.x, p.y))).collect();
    HexMesh {
        nodes,
        hexes: hexes(section, layout),
        groups: Vec::new(),
        contact: contact_grid(section, x, window),
        ends: (0..count).chain((x.len() - 1) * count..x.len() * count).collect(),
        foot: all_layers(foot, layout),
        bore: Vec::new(),
    }
}

/// A section swept once around the y axis.
///
/// A node `(y, z)` of the section at the angle θ sits at
/// `(ρ sin θ, y, ρ cos θ)` with `ρ = radius + z`. `theta` are the angles of the
/// layers of nodes, increasing and within one revolution; the last layer is
/// joined to the first. Those within `window` of zero carry the contact grid.
/// `bore` are nodes of the section that lie on the bore.
#[must_use]
pub fn revolve(section: &SectionMesh, radius: f64, theta: &[f64], window: f64, bore: &[usize]) -> HexMesh {
    let layout = SweepLayout { section_nodes: section.nodes.len(), layers: theta.len(), closed: true };
    let nodes = theta
        .iter()
        .flat_map(|theta| {
            let (sin, cos) = theta.sin_cos();
            section.nodes.iter().map(move |p| {
                let rho = radius + p.y;
                Point3::new(rho * sin, p.x, rho * cos)
            })
        })
        .collect();
    HexMesh {
        nodes,
        hexes: hexes(section, layout),
        groups: Vec::new(),
        contact: contact_grid(section, theta, window),
        ends: Vec::new(),
        foot: Vec::new(),
        bore: all_layers(bore, layout),
    }
}

/// Positions from 0 to `end`: steps of at most `element` up to `fine`, then
/// growing by the ratio `growth` up to about `largest`.
pub(super) fn graded(fine: f64, end: f64, element: f64, growth: f64, largest: f64) -> Vec<f64> {
    let steps = (fine / element - 1e-9).ceil().max(1.0) as usize;
    let element = fine / steps as f64;
    let mut positions: Vec<f64> = (0..=steps).map(|k| fine * k as f64 / steps as f64).collect();
    let mut lengths = Vec::new();
    let mut covered = 0.0;
    let mut step = element;
    while covered < end - fine {
        step = (step * growth).min(largest);
        lengths.push(step);
        covered += step;
    }
    // The last step overshoots: drop it if that leaves less to correct, then stretch all.
    if let [.., last] = lengths[..]
        && lengths.len() > 1
        && covered - (end - fine) > 0.5 * last
    {
        lengths.pop();
        covered -= last;
    }
    let mut reached = 0.0;
    for length in &lengths {
        reached += length;
        positions.push(fine + (end - fine) * reached / covered);
    }
    positions
}

/// Hexahedra between the layers of nodes.
fn hexes(mesh: &SectionMesh, layout: SweepLayout) -> Vec<[usize; 8]> {
    let gaps = if layout.closed { layout.layers } else { layout.layers - 1 };
    let mut hexes = Vec::with_capacity(gaps * mesh.quads.len());
    for l in 0..gaps {
        let (a, b) = (l * layout.section_nodes, (l + 1) % layout.layers * layout.section_nodes);
        for q in &mesh.quads {
            hexes.push([a + q[0], a + q[1], a + q[2], a + q[3], b + q[0], b + q[1], b + q[2], b + q[3]]);
        }
    }
    hexes
}

/// Surface nodes of the layers whose position lies within the window.
fn contact_grid(mesh: &SectionMesh, positions: &[f64], half: f64) -> SurfaceGrid {
    let inside: Vec<usize> = in_window(positions, half).collect();
    let count = mesh.nodes.len();
    SurfaceGrid {
        along_profile: mesh.contact_s.clone(),
        along_track: inside.iter().map(|&l| positions[l]).collect(),
        nodes: mesh.contact.iter().flat_map(|&j| inside.iter().map(move |&l| l * count + j)).collect(),
    }
}

/// Layers within `half` of the middle of the contact window.
pub(super) fn in_window(positions: &[f64], half: f64) -> impl Iterator<Item = usize> {
    (0..positions.len()).filter(move |&l| positions[l].abs() <= half * (1.0 + 1e-9))
}

/// Nodes of the section in every layer, in increasing order.
fn all_layers(of_section: &[usize], layout: SweepLayout) -> Vec<usize> {
    let mut sorted = of_section.to_vec();
    sorted.sort_unstable();
    (0..layout.layers).flat_map(|l| sorted.iter().map(move |j| l * layout.section_nodes + j)).collect()
}
