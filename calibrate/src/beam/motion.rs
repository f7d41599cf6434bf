//! Forces and energies of a moving beam, element by element.
//!
//! All elements are the same, so that no matrix of the beam is stored. Stiffness works on what deforms an element, which is free
//! of its motion as a rigid body.

use super::element::BeamElement;
use super::factor::{Block, ElementBlocks, NODE, Node, product};

/// An element for products with the displacements of its nodes.
#[derive(Debug, Clone)]
pub(super) struct ElementProducts {
    /// 2/length, 1/m.
    slope: f64,
    /// Stiffness of each of [`Self::deformations`], N·m.
    stiffness: [f64; NODE],
    /// Consistent mass for the motions of the two nodes that are their own mirror image about the middle of the element, and for those that
    /// are the opposite of theirs: the element is symmetric, and the two do not mix.
    mass: [Block; 2],
}

/// What a reflection about the middle of the element does to displacements and rotations of a node.
const MIRRORED: Node = [1.0, 1.0, 1.0, -1.0, -1.0];

impl ElementProducts {
    /// `mass` is the element's mass matrix.
    pub fn new(element: &BeamElement, mass: &ElementBlocks) -> Self {
        let (section, length) = (element.section, element.length);
        let [shear_y, shear_z] = element.shear_parameters();
        let [first, across, _] = mass;
        let mirrored = Block::from_fn(|i, j| across[(i, j)] * MIRRORED[j]);
        Self {
            slope: 2.0 / length,
            stiffness: [
                section.bending_y / length,
                3.0 * section.bending_y / (length * (1.0 + shear_y)),
                section.bending_z / length,
                3.0 * section.bending_z / (length * (1.0 + shear_z)),
                section.torsion / length,
            ],
            mass: [first + mirrored, first - mirrored],
        }
    }

    /// Bending with constant and with linear moment in the planes of y and z, and twist, rad.
    #[inline]
    fn deformations(&self, first: &Node, second: &Node) -> Node {
        let [y1, z1, rx1, ry1, rz1] = first;
        let [y2, z2, rx2, ry2, rz2] = second;
        [
            rz2 - rz1,
            rz1 + rz2 - self.slope * (y2 - y1),
            ry2 - ry1,
            // a positive rotation about y tilts the axis to negative z
            ry1 + ry2 + self.slope * (z2 - z1),
            rx2 - rx1,
        ]
    }

    /// Adds the elastic forces of the beam on its nodes in the displacements `at`, which point back to the state without deformation.
    #[inline]
    pub fn add_elastic_forces(&self, at: impl Fn(usize) -> Node, forces: &mut [Node]) {
        let mut first = at(0);
        for node in 1..forces.len() {
            let second = at(node);
            let deformations = self.deformations(&first, &second);
            let moments: Node = std::array::from_fn(|i| self.stiffness[i] * deformations[i]);
            let [bend_y, shear_y, bend_z, shear_z, twist] = moments;
            let (across_y, across_z) = (self.slope * shear_y, self.slope * shear_z);
            let on_first = [-across_y, across_z, twist, bend_z - shear_z, bend_y - shear_y];
            let on_second = [across_y, -across_z, -twist, -bend_z - shear_z, -bend_y - shear_y];
            for i in 0..NODE {
                forces[node - 1][i] += on_first[i];
                forces[node][i] += on_second[i];
            }
            first = second;
        }
    }

    /// Energy of the displacements `at` of `nodes` nodes, J.
    #[inline]
    pub fn elastic_energy(&self, at: impl Fn(usize) -> Node, nodes: usize) -> f64 {
        let mut first = at(0);
        let mut twice = 0.0;
        for node in 1..nodes {
            let second = at(node);
            let deformations = self.deformations(&first, &second);
            twice += (0..NODE).map(|i| self.stiffness[i] * deformations[i] * deformations[i]).sum::<f64>();
            first = second;
        }
        0.5 * twice
    }

    /// Energy of the `velocities` of the nodes, J.
    pub fn kinetic_energy(&self, velocities: &[Node]) -> f64 {
        let mut four_times = 0.0;
        for pair in velocities.windows(2) {
            let [first, second] = [pair[0], std::array::from_fn(|i| MIRRORED[i] * pair[1][i])];
            let same: Node = std::array::from_fn(|i| first[i] + second[i]);
            let opposite: Node = std::array::from_fn(|i| first[i] - second[i]);
            for (mass, motion) in self.mass.iter().zip([same, opposite]) {
                four_times += product(mass, &motion).iter().zip(&motion).map(|(p, v)| p * v).sum::<f64>();
            }
        }
        0.25 * four_times
    }
}
