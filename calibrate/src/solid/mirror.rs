//! Bodies that are their own mirror image in the plane x = 0, across the track through the contact.
//!
//! A force on such a body is the sum of a symmetric and of an antisymmetric force, half of it with and half of it against its mirror image.
//! Each moves the body in its own way, which the half x ≥ 0 shows by itself: in a symmetric motion no node of the plane moves along x, in an
//! antisymmetric one none moves across it (K.-J. Bathe, Finite Element Procedures, 1996, section 4.2.2 on boundary conditions of symmetry).
//! Two bodies of half the size take half the multiplications of the whole one, and each of their factors two fifths of the memory.

use super::numbering::{Numbering, Supports};
use crate::mesh::{HexMesh, SurfaceGrid};
use nalgebra::Point3;
use std::collections::{HashMap, HashSet};

/// Nodes are mirror images of each other to this distance, m: far more than rounding, far less than an element.
const SAME_PLACE: f64 = 1e-9;

/// How a motion and its mirror image are related.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// They are the same.
    Symmetric,
    /// Each is the other with the opposite sign.
    Antisymmetric,
}

impl Symmetry {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Symmetric, Self::Antisymmetric];

    /// Whether nodes of the plane rest in a direction (0 to 2: x, y, z).
    fn rests(self, direction: usize) -> bool {
        (direction == 0) == (self == Self::Symmetric)
    }

    /// What the mirror image of a component in a direction is multiplied with.
    pub(crate) fn sign(self, direction: usize) -> f64 {
        if self.rests(direction) { -1.0 } else { 1.0 }
    }
}

/// The half x ≥ 0 of a body that is its own mirror image.
#[derive(Debug, Clone, PartialEq)]
pub struct MirrorHalf {
    /// Its mesh, with its nodes, elements and contact nodes in the order that they have in the whole.
    pub mesh: HexMesh,
    /// How it is held, but for the plane.
    pub supports: Supports,
    /// The nodes of the whole that its nodes are, and their mirror images.
    nodes: Vec<[usize; 2]>,
    /// The same of its contact nodes, by their places in the contact grid of the whole.
    contact: Vec<[usize; 2]>,
}

impl MirrorHalf {
    /// The half of a body; `None` if the body is not its own mirror image with its supports, if an element reaches across the plane, and if a
    /// master node moves.
    pub fn of(mesh: &HexMesh, supports: &Supports) -> Option<Self> {
        let Supports { held, followers, master, master_free } = supports;
        if master_free.contains(&true) || (!followers.is_empty() && master.x.abs() > SAME_PLACE) {
            return None;
        }
        let images = images(&mesh.nodes)?;
        let image = |node: usize| images[node];
        let mirrored = |of: &[usize]| {
            let set: HashSet<usize> = of.iter().copied().collect();
            of.iter().all(|&node| set.contains(&image(node)))
        };
        let SurfaceGrid { along_profile, along_track, nodes: contact } = &mesh.contact;
        let columns = along_track.len();
        let image_at = |at: usize| at - at % columns + (columns - 1 - at % columns);
        let grid = contact.iter().enumerate().all(|(at, &node)| image(node) == contact[image_at(at)]);
        if !(grid && mirrored(held) && mirrored(followers)) {
            return None;
        }
        let inside: Vec<bool> = mesh.nodes.iter().map(|p| p.x > -SAME_PLACE).collect();
        let outside: Vec<bool> = mesh.nodes.iter().map(|p| p.x < SAME_PLACE).collect();
        let on = |side: &[bool], hex: &[usize; 8]| hex.iter().all(|&node| side[node]);
        let corners = |mut hex: [usize; 8]| {
            hex.sort_unstable();
            hex
        };
        let those = |side: &[bool]| -> Vec<usize> {
            (0..mesh.hexes.len()).filter(|&e| on(side, &mesh.hexes[e])).collect()
        };
        let others: HashMap<[usize; 8], usize> =
            those(&outside).into_iter().map(|e| (corners(mesh.hexes[e]), mesh.group(e))).collect();
        let ours = those(&inside);
        let whole = ours.len() + others.len() == mesh.hexes.len()
            && ours.len() == others.len()
            && ours.iter().all(|&e| others.get(&corners(mesh.hexes[e].map(image))) == Some(&mesh.group(e)));
        if !whole {
            return None;
        }
        let kept: Vec<usize> = (0..mesh.nodes.len()).filter(|&node| inside[node]).collect();
        let mut place = vec![None; mesh.nodes.len()];
        kept.iter().enumerate().for_each(|(n, &node)| place[node] = Some(n));
        let of = |nodes: &[usize]| nodes.iter().filter_map(|&node| place[node]).collect::<Vec<_>>();
        let at: Vec<usize> = (0..contact.len()).filter(|&at| place[contact[at]].is_some()).collect();
        let half = HexMesh {
            nodes: kept.iter().map(|&node| mesh.nodes[node]).collect(),
            hexes: ours
                .iter()
                .map(|&e| mesh.hexes[e].map(|node| place[node].expect("a node of this half")))
                .collect(),
            groups: if mesh.groups.is_empty() {
                Vec::new()
            } else {
                ours.iter().map(|&e| mesh.group(e)).collect()
            },
            contact: SurfaceGrid {
                along_profile: along_profile.clone(),
                along_track: along_track[columns / 2..].to_vec(),
                nodes: of(contact),
            },
            ends: of(&mesh.ends),
            foot: of(&mesh.foot),
            bore: of(&mesh.bore),
        };
        if half.contact.nodes.len() != half.contact.along_profile.len() * half.contact.along_track.len() {
            return None;
        }
        Some(Self {
            mesh: half,
            supports: Supports {
                held: of(held),
                followers: of(followers),
                master: *master,
                master_free: *master_free,
            },
            nodes: kept.iter().map(|&node| [node, image(node)]).collect(),
            contact: at.iter().map(|&at| [at, image_at(at)]).collect(),
        })
    }

    /// The `numbering` of the half with the nodes of the plane at rest as the motion has them.
    #[must_use]
    pub fn numbered(&self, numbering: &Numbering, symmetry: Symmetry) -> Numbering {
        let plane = self.nodes.iter().enumerate().filter(|(_, [node, image])| node == image);
        let directions = (0..3).filter(|direction| symmetry.rests(*direction));
        let at_rest: Vec<_> = plane.flat_map(|(n, _)| directions.clone().map(move |d| (n, d))).collect();
        numbering.clone().with_at_rest(&at_rest)
    }

    /// Places of the half's contact nodes in the contact grid of the whole, and those of their mirror images.
    pub(crate) fn contact(&self) -> &[[usize; 2]] {
        &self.contact
    }

    /// What the half carries of forces on the nodes of the whole (`3·node + direction`, N).
    pub(crate) fn forces(&self, symmetry: Symmetry, whole: &[f64]) -> Vec<f64> {
        self.nodes
            .iter()
            .flat_map(|&[node, image]| {
                // the other half carries as much, and of a node of the plane each half
                let share = if node == image { 0.25 } else { 0.5 };
                (0..3).map(move |d| share * (whole[3 * node + d] + symmetry.sign(d) * whole[3 * image + d]))
            })
            .collect()
    }

    /// The part of displacements of the whole's contact nodes that is such a motion, of the half's contact nodes; m.
    pub(crate) fn contact_part(&self, symmetry: Symmetry, whole: &[f64]) -> Vec<f64> {
        self.contact
            .iter()
            .flat_map(|&[at, image]| {
                (0..3).map(move |d| 0.5 * (whole[3 * at + d] + symmetry.sign(d) * whole[3 * image + d]))
            })
            .collect()
    }

    /// Adds displacements of the half's nodes in such a motion to those of the whole; m.
    pub(crate) fn add(&self, symmetry: Symmetry, half: &[f64], whole: &mut [f64]) {
        for (moved, &[node, image]) in half.chunks_exact(3).zip(&self.nodes) {
            for (d, value) in moved.iter().enumerate() {
                whole[3 * node + d] += value;
                if node != image {
                    whole[3 * image + d] += symmetry.sign(d) * value;
                }
            }
        }
    }
}

/// The mirror image of every node; `None` if one has none.
fn images(nodes: &[Point3<f64>]) -> Option<Vec<usize>> {
    /// Edge of the cells in which nodes are looked for, in distances at which they are the same.
    const CELL: f64 = 16.0;
    let cell = |p: &Point3<f64>, by: f64| p.coords.map(|c| (c / (CELL * SAME_PLACE) + by).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::with_capacity(nodes.len());
    for (n, p) in nodes.iter().enumerate() {
        cells.entry(cell(p, 0.0).into()).or_default().push(n);
    }
    let find = |p: &Point3<f64>| -> Option<usize> {
        let (low, high) = (cell(p, -1.0 / CELL), cell(p, 1.0 / CELL));
        (0..8_usize)
            .filter_map(|corner| {
                let at = std::array::from_fn(|d| if corner >> d & 1 == 1 { high[d] } else { low[d] });
                cells.get::<[i64; 3]>(&at)?.iter().copied().find(|&n| (nodes[n] - p).amax() <= SAME_PLACE)
            })
            .next()
    };
    let images: Option<Vec<usize>> = nodes.iter().map(|p| find(&Point3::new(-p.x, p.y, p.z))).collect();
    // each the other's, and those of the plane their own
    images.filter(|images| {
        images
            .iter()
            .enumerate()
            .all(|(n, &image)| images[image] == n && ((n == image) == (nodes[n].x.abs() <= SAME_PLACE)))
    })
}
