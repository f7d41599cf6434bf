//! A body of 8-node hexahedra, and the grid of its contact surface.

use super::faces::single_layer;
use nalgebra::Point3;
use std::collections::BTreeMap;

/// Tensor grid of the surface nodes in which contact can take place.
///
/// Node `(i, k)`, at `along_profile[i]` and `along_track[k]`, is
/// `nodes[i * along_track.len() + k]`.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceGrid {
    /// Arc length on the running curve, increasing, m.
    pub along_profile: Vec<f64>,
    /// Position along the track, increasing: x in m for a rail or a block,
    /// the angle θ from straight down in rad for a wheel.
    pub along_track: Vec<f64>,
    /// Node of the mesh at every grid point.
    pub nodes: Vec<usize>,
}

impl SurfaceGrid {
    /// Node at grid point `(i, k)`: `i` along the profile, `k` along the track.
    #[must_use]
    pub fn node(&self, i: usize, k: usize) -> usize {
        self.nodes[i * self.along_track.len() + k]
    }

    /// Longest distance of neighbouring nodes along the profile, m.
    #[must_use]
    pub fn longest_across(&self) -> f64 {
        self.along_profile.windows(2).map(|s| s[1] - s[0]).fold(0.0, f64::max)
    }
}

/// A body of 8-node hexahedra.
#[derive(Debug, Clone, PartialEq)]
pub struct HexMesh {
    /// Coordinates of the nodes, m.
    pub nodes: Vec<Point3<f64>>,
    /// Nodes of every hexahedron in the order of VTK: the face 0-1-2-3 seen
    /// from inside runs counter-clockwise, 4-7 lie above it; the Jacobian is positive.
    pub hexes: Vec<[usize; 8]>,
    /// Group of every hexahedron, by its number among the materials of the body; empty where all are of one.
    pub groups: Vec<usize>,
    /// Nodes where contact can take place.
    pub contact: SurfaceGrid,
    /// Nodes of both end faces of a rail, or of the sides of a block; empty for a wheel.
    pub ends: Vec<usize>,
    /// Nodes on the bottom of a rail's foot or of a block; empty for a wheel.
    pub foot: Vec<usize>,
    /// Nodes on the bore of a wheel; empty for the other bodies.
    pub bore: Vec<usize>,
}

impl HexMesh {
    /// Group of a hexahedron.
    #[must_use]
    pub fn group(&self, element: usize) -> usize {
        self.groups.get(element).copied().unwrap_or(0)
    }

    /// The mesh whose groups share no node, and the node of this mesh that each of them is: what jumps from group to group,
    /// stresses for instance, has a value for each of them there.
    #[must_use]
    pub fn with_groups_apart(&self) -> (Self, Vec<usize>) {
        if self.groups.is_empty() {
            return (self.clone(), (0..self.nodes.len()).collect());
        }
        let mut known: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let mut owner = vec![None; self.nodes.len()];
        let mut of: Vec<usize> = (0..self.nodes.len()).collect();
        let mut hexes = self.hexes.clone();
        for (e, hex) in hexes.iter_mut().enumerate() {
            let group = self.group(e);
            for v in hex {
                let node = *v;
                if *owner[node].get_or_insert(group) != group {
                    *v = *known.entry((group, node)).or_insert_with(|| {
                        of.push(node);
                        of.len() - 1
                    });
                }
            }
        }
        let nodes = of.iter().map(|&node| self.nodes[node]).collect();
        (Self { nodes, hexes, ..self.clone() }, of)
    }

    /// A hexahedron of a group that is the only one between two other groups, or between one and the nodes at the bore or the foot: it meets
    /// them at opposite faces.
    pub(crate) fn single_layer(&self, group: usize) -> Option<usize> {
        let mut rigid = vec![false; self.nodes.len()];
        self.bore.iter().chain(&self.foot).for_each(|&v| rigid[v] = true);
        single_layer(&self.hexes, |e| self.group(e), &rigid, group)
    }

    /// Hexahedra with a corner on the contact surface.
    pub(crate) fn at_contact(&self) -> impl Iterator<Item = usize> + '_ {
        let mut marked = vec![false; self.nodes.len()];
        self.contact.nodes.iter().for_each(|&v| marked[v] = true);
        (0..self.hexes.len()).filter(move |&e| self.hexes[e].iter().any(|&v| marked[v]))
    }
}
