//! A straight beam of equal elements: supports, statics, and what a step in time needs of it.

use nalgebra::{Matrix2, Matrix3, Rotation3, SMatrix, SVector, Vector2, Vector3};

use crate::section_analysis::SectionProperties;
use railspring_profiles::error::{InputError, NumericsError, Result, StopReason};
use railspring_profiles::field::InputField;

use super::element::BeamElement;
use super::factor::{Block, ChainFactor, ElementBlocks, NODE, Node, inverse};
use super::motion::ElementProducts;
use super::section::{BeamCorrection, BeamSection, Torsion};
use crate::solid::Material;

/// Most elements of a beam; with so many a step takes a millisecond.
const MOST_ELEMENTS: usize = 10_000;

/// How an end of the beam is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// All displacements and rotations are held.
    Fixed,
    /// Displacements and twist are held; bending rotations are free.
    Pinned,
    /// Nothing is held.
    Free,
}

impl End {
    /// Whether it holds one of the six degrees of freedom of its node, displacements first.
    fn holds(self, dof: usize) -> bool {
        match self {
            Self::Fixed => true,
            Self::Pinned => dof < 4,
            Self::Free => false,
        }
    }

    /// Which of the degrees of freedom of [`Node`] it holds.
    fn held(self) -> [bool; NODE] {
        std::array::from_fn(|i| self.holds(i + 1))
    }
}

/// A straight beam along x from 0 to its length, with equal elements.
///
/// A node has displacements y and z and rotations x, y and z, in the axes of the section. Nothing loads a rail along its axis, where it
/// is uncoupled from the rest, so that nothing is solved for there.
#[derive(Debug, Clone)]
pub struct RailBeam {
    section: BeamSection,
    length: f64,
    elements: usize,
    angle: f64,
    ends: [End; 2],
    products: ElementProducts,
}

/// The section at a place: its element, and rows that give a displacement from the two nodes of the element.
#[derive(Debug, Clone, Copy, Default)]
pub struct SectionRows {
    /// Number of the element.
    pub element: usize,
    /// Displacements y and z of the node line and rotation about x, world axes, from both nodes.
    pub rows: [[Node; 2]; 3],
}

impl RailBeam {
    /// The rail of the publication: `elements` elements over `length` metres, both ends fixed, the
    /// section turned by `angle` (rad, y to z) for its inclination.
    ///
    /// # Errors
    /// As [`Self::new`] and [`BeamSection::rail`].
    pub fn rail(
        properties: &SectionProperties,
        material: &Material,
        length: f64,
        elements: usize,
        angle: f64,
        torsion: Torsion,
    ) -> Result<Self> {
        let section = BeamSection::rail(properties, material, length, torsion)?;
        Self::new(section, length, elements, angle, [End::Fixed, End::Fixed])
    }

    /// A beam of `elements` equal elements over `length` metres, its section turned by `angle` (rad, y to z).
    ///
    /// # Errors
    /// [`InputError`] with field `rail_length` or `beam_elements`; [`NumericsError`] when the beam is not held.
    pub fn new(
        section: BeamSection,
        length: f64,
        elements: usize,
        angle: f64,
        ends: [End; 2],
    ) -> Result<Self> {
        if !(length.is_finite() && length > 0.0) {
            return InputError::refuse(
                InputField::RailLength,
                length,
                "a positive length in metres",
                "set it",
            );
        }
        if !(1..=MOST_ELEMENTS).contains(&elements) {
            return InputError::refuse(
                InputField::BeamElements,
                elements,
                format!("1 to {MOST_ELEMENTS} elements"),
                "the publication has 20",
            );
        }
        let element = BeamElement { section: &section, length: length / elements as f64, angle: 0.0 };
        let products = ElementProducts::new(&element, &node_blocks(&element.mass()));
        let beam = Self { section, length, elements, angle, ends, products };
        let stands = ends.contains(&End::Fixed) || ends == [End::Pinned; 2];
        // both halves of the beam as an element each
        if !stands || beam.at_node(0.5 * length).is_none() {
            return Err(beam.singular().into());
        }
        Ok(beam)
    }

    /// Length, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.elements
    }

    /// Number of unknowns: six a node, those along the axis included.
    pub fn unknowns(&self) -> usize {
        let held = |end: End| (0..6).filter(|&dof| end.holds(dof)).count();
        6 * (self.elements + 1) - held(self.ends[0]) - held(self.ends[1])
    }

    /// Angle of the section, rad, y to z.
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// The same beam with the stiffness of its section corrected.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn corrected(&self, correction: &BeamCorrection) -> Result<Self> {
        let section = self.section.corrected(correction);
        Self::new(section, self.length, self.elements, self.angle, self.ends)
    }

    /// The section.
    pub fn section(&self) -> &BeamSection {
        &self.section
    }

    /// The element of the section at `x` (m from the first end, clamped to the beam), and where in it the section is, 0 to 1.
    fn place(&self, x: f64) -> (usize, f64) {
        let along = x / self.pitch();
        let element = (along.max(0.0) as usize).min(self.elements - 1);
        (element, (along - element as f64).clamp(0.0, 1.0))
    }

    fn element(&self, length: f64) -> BeamElement<'_> {
        BeamElement { section: &self.section, length, angle: 0.0 }
    }

    /// Length of an element, m.
    fn pitch(&self) -> f64 {
        self.length / self.elements as f64
    }

    /// The section at `x` (m from the first end, clamped to the beam).
    pub fn section_rows(&self, x: f64) -> SectionRows {
        let (element, xi) = self.place(x);
        let along = self.element(self.pitch()).section_motion(xi);
        let [y, z, rx] = along.map(|row| [0, 6].map(|node| std::array::from_fn(|i| row[node + 1 + i])));
        let (sin, cos) = self.angle.sin_cos();
        let turned = |of_y: f64, of_z: f64| {
            [0, 1].map(|node| std::array::from_fn(|i| of_y * y[node][i] + of_z * z[node][i]))
        };
        SectionRows { element, rows: [turned(cos, -sin), turned(sin, cos), rx] }
    }

    /// Static flexibility at `x`: displacements y, z (m) of the node line and rotation about x (rad)
    /// under unit forces y, z (N) and a unit moment about x (N·m) there.
    ///
    /// Nodal displacements under nodal forces do not depend on the number of elements, so that the parts of the beam on both sides of a
    /// node are an element each; a chain of thousands of short ones would lose all digits.
    pub fn section_flexibility(&self, x: f64) -> Matrix3<f64> {
        let SectionRows { element, rows } = self.section_rows(x);
        let here = self.pitch() * element as f64;
        let there =
            if element + 1 == self.elements { self.length } else { self.pitch() * (element + 1) as f64 };
        // the matrix is positive definite, as the beam is held
        let unknown = Block::repeat(f64::NAN);
        let first = self.at_node(here).unwrap_or(unknown);
        let second = self.at_node(there).unwrap_or(unknown);
        let across = self.carried_on(here, there) * first;
        let of = |row: [Node; 2]| row.map(SVector::from);
        let product = |[a, b]: [SVector<f64, NODE>; 2], [c, d]: [SVector<f64, NODE>; 2]| {
            a.dot(&(first * c)) + b.dot(&(across * c)) + d.dot(&(across * a)) + b.dot(&(second * d))
        };
        Matrix3::from_fn(|i, j| product(of(rows[i]), of(rows[j])))
    }

    /// Static flexibility at `x` (m from the first end, clamped to the beam) of a beam that has a node there, in the axes of the section: displacements along y and z (m/N) and
    /// rotation about x (rad/(N·m)) under unit loads.
    pub fn at_place(&self, x: f64) -> [f64; 3] {
        let block = self.at_node(x.clamp(0.0, self.length));
        // the matrix is positive definite, as the beam is held
        [0, 1, 2].map(|i| block.map_or(f64::NAN, |block| block[(i, i)]))
    }

    /// How its ends are held.
    pub fn ends(&self) -> [End; 2] {
        self.ends
    }

    /// Static flexibility of a node at `x`; none if the section's stiffness is not positive.
    fn at_node(&self, x: f64) -> Option<Block> {
        let mut stiffness = Block::zeros();
        let mut held = [false; NODE];
        for (side, end) in self.ends.into_iter().enumerate() {
            let length = [x, self.length - x][side];
            if length == 0.0 {
                held = end.held();
            } else if end != End::Free {
                let [first, across, second] = node_blocks(&self.element(length).stiffness());
                let [own, across, beyond] =
                    [[second, across.transpose(), first], [first, across, second]][side];
                stiffness += own - across * inverse(beyond, &end.held())? * across.transpose();
            }
        }
        inverse(stiffness, &held)
    }

    /// Displacements of a node at `there` from those of a node at `here`, with no load from `here` to the last end.
    fn carried_on(&self, here: f64, there: f64) -> Block {
        let rest = self.element(self.length - here);
        let [_, across, second] = node_blocks(&rest.stiffness());
        let at_end = inverse(second, &self.ends[1].held()).unwrap_or_else(|| Block::repeat(f64::NAN));
        let rows = rest.interpolation((there - here) / rest.length);
        let of = |node: usize| Block::from_fn(|i, j| rows[i + 1][6 * node + j + 1]);
        of(0) - of(1) * at_end * across.transpose()
    }

    /// As [`Self::section_flexibility`], with y and z along the axes of the section.
    pub fn in_section_axes(&self, x: f64) -> Matrix3<f64> {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -self.angle);
        turn * self.section_flexibility(x) * turn.inverse()
    }

    /// Static flexibility (y, z; m/N, world axes) at midspan of a point that is rigidly attached to the
    /// node line at `offset` (y, z; m, world axes). This is what a calibration subtracts so that
    /// beam and law together are the solid.
    pub fn static_flexibility(&self, offset: Vector2<f64>) -> Matrix2<f64> {
        self.static_flexibility_at(0.5 * self.length, offset)
    }

    /// As [`Self::static_flexibility`], at `x` metres from the first end.
    pub fn static_flexibility_at(&self, x: f64, offset: Vector2<f64>) -> Matrix2<f64> {
        // Rotation about x moves the point by (−z, y) of the offset.
        let arm = SMatrix::<f64, 2, 3>::new(1.0, 0.0, -offset.y, 0.0, 1.0, offset.x);
        arm * self.section_flexibility(x) * arm.transpose()
    }

    /// The matrix `mass`·M + `stiffness`·K, factored.
    ///
    /// # Errors
    /// [`NumericsError`] when it is not positive definite.
    pub fn factor(&self, mass: f64, stiffness: f64) -> Result<ChainFactor> {
        let element = self.element(self.pitch());
        let [m, k] = [element.mass(), element.stiffness()].map(|matrix| node_blocks(&matrix));
        let combined: ElementBlocks = std::array::from_fn(|i| m[i] * mass + k[i] * stiffness);
        let held = self.ends.map(End::held);
        Ok(ChainFactor::new(combined, self.elements, held).ok_or_else(|| self.singular())?)
    }

    /// Adds the forces with which the beam resists the displacements `at` of its nodes, N and N·m.
    pub fn add_elastic_forces(&self, at: impl Fn(usize) -> Node, forces: &mut [Node]) {
        self.products.add_elastic_forces(at, forces);
    }

    /// Energy of the deformation in the displacements `at` of the nodes, J.
    pub fn elastic_energy(&self, at: impl Fn(usize) -> Node) -> f64 {
        self.products.elastic_energy(at, self.elements + 1)
    }

    /// Energy of the motion with the `velocities` of the nodes, J.
    pub fn kinetic_energy(&self, velocities: &[Node]) -> f64 {
        self.products.kinetic_energy(velocities)
    }

    /// One of its elements, in the axes of the section.
    pub(super) fn of_length(&self) -> BeamElement<'_> {
        self.element(self.pitch())
    }

    /// The unknowns that are not held, among [`NODE`] of each node.
    pub(super) fn free(&self) -> Vec<usize> {
        let of_end = [(0, self.ends[0]), (self.elements, self.ends[1])];
        let held =
            |dof: &usize| of_end.iter().any(|(node, end)| dof / NODE == *node && end.held()[dof % NODE]);
        (0..NODE * (self.elements + 1)).filter(|dof| !held(dof)).collect()
    }

    pub(super) fn singular(&self) -> NumericsError {
        NumericsError::new("rail beam", StopReason::Singular, f64::NAN, self.unknowns())
    }
}

/// The parts of an element's matrix that belong to bending and torsion.
fn node_blocks(matrix: &SMatrix<f64, 12, 12>) -> ElementBlocks {
    [(0, 0), (0, 6), (6, 6)].map(|(row, column)| Block::from_fn(|i, j| matrix[(row + 1 + i, column + 1 + j)]))
}

#[cfg(test)]
pub(super) mod tests;
