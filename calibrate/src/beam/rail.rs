//! A straight beam of equal elements: supports, statics and modes.

use nalgebra::{
    Cholesky, DMatrix, DVector, Dyn, Matrix2, Matrix3, Rotation3, SMatrix, SVector, SymmetricEigen, Vector2,
    Vector3,
};

use crate::error::{InputError, NumericsError, Result, StopReason};
use crate::field::InputField;
use crate::section_analysis::SectionProperties;

use super::element::BeamElement;
use super::section::{BeamCorrection, BeamSection, Torsion};
use crate::solid::Material;

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
    fn holds(self, dof: usize) -> bool {
        match self {
            Self::Fixed => true,
            Self::Pinned => dof < 4,
            Self::Free => false,
        }
    }
}

/// A straight beam along x from 0 to its length, with equal elements.
#[derive(Debug, Clone)]
pub struct RailBeam {
    section: BeamSection,
    length: f64,
    angle: f64,
    ends: [End; 2],
    hermite: bool,
    /// Unknown of each of the 6 degrees of freedom of each node; `None` where held.
    unknowns: Vec<[Option<usize>; 6]>,
    stiffness: DMatrix<f64>,
    mass: DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
}

/// Undamped modes of a [`RailBeam`], normalised to unit modal mass.
///
/// In these coordinates the effective matrix of Newmark's scheme is diagonal
/// for every time step: nothing is factored again when the step changes.
#[derive(Debug, Clone)]
pub struct RailModes {
    /// Squares of the circular frequencies, rad²/s², rising.
    pub squares: Vec<f64>,
    /// Modes as columns, one row an unknown of the beam.
    pub shapes: DMatrix<f64>,
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
            return Err(InputError::new(
                InputField::RailLength,
                length,
                "a positive length in metres",
                "set it",
            )
            .into());
        }
        if !(1..=400).contains(&elements) {
            return Err(InputError::new(
                InputField::BeamElements,
                elements,
                "1 to 400 elements",
                "the publication has 20",
            )
            .into());
        }
        let mut unknowns = vec![[None; 6]; elements + 1];
        let mut count = 0;
        for (node, dofs) in unknowns.iter_mut().enumerate() {
            for (dof, unknown) in dofs.iter_mut().enumerate() {
                let held = (node == 0 && ends[0].holds(dof)) || (node == elements && ends[1].holds(dof));
                if !held {
                    *unknown = Some(count);
                    count += 1;
                }
            }
        }
        let element = BeamElement { section: &section, length: length / elements as f64, angle };
        let stiffness = assemble(&unknowns, count, &element.stiffness());
        let mass = assemble(&unknowns, count, &element.mass());
        let factor = Cholesky::new(stiffness.clone()).ok_or_else(|| singular(count))?;
        Ok(Self { section, length, angle, ends, hermite: false, unknowns, stiffness, mass, factor })
    }

    /// Interpolates inside the elements with the cubic Hermite functions of eq. 9 instead of the
    /// element's own functions. The two agree at the nodes; in between, in short elements, where
    /// shear dominates, their flexibilities differ by about one per cent.
    #[must_use]
    pub fn with_hermite_functions(mut self) -> Self {
        self.hermite = true;
        self
    }

    /// Length, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.unknowns.len() - 1
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.stiffness.nrows()
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
        let corrected = Self::new(section, self.length, self.elements(), self.angle, self.ends)?;
        Ok(Self { hermite: self.hermite, ..corrected })
    }

    /// The section.
    pub fn section(&self) -> &BeamSection {
        &self.section
    }

    /// Mass of the beam between its ends, kg.
    pub fn total_mass(&self) -> f64 {
        self.section.mass * self.length
    }

    /// Rows that give displacements y and z of the node line and rotation about x at `x` (m from the
    /// first end, clamped to the beam), as pairs of unknown and factor.
    pub fn section_motion(&self, x: f64) -> [Vec<(usize, f64)>; 3] {
        let step = self.length / self.elements() as f64;
        let index = ((x / step).max(0.0) as usize).min(self.elements() - 1);
        let xi = (x / step - index as f64).clamp(0.0, 1.0);
        let element = BeamElement { section: &self.section, length: step, angle: self.angle };
        element.section_motion(xi, self.hermite).map(|row| {
            (0..12)
                .filter(|&i| row[i] != 0.0)
                .filter_map(|i| self.unknowns[index + i / 6][i % 6].map(|unknown| (unknown, row[i])))
                .collect()
        })
    }

    /// Static flexibility at `x`: displacements y, z (m) of the node line and rotation about x (rad)
    /// under unit forces y, z (N) and a unit moment about x (N·m) there.
    pub fn section_flexibility(&self, x: f64) -> Matrix3<f64> {
        let rows = self.section_motion(x);
        let columns = rows.clone().map(|row| self.factor.solve(&dense(&row, self.unknowns())));
        Matrix3::from_fn(|i, j| rows[i].iter().map(|&(unknown, factor)| factor * columns[j][unknown]).sum())
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

    /// Vibration modes.
    ///
    /// # Errors
    /// [`NumericsError`] when the mass matrix is not positive definite.
    pub fn modes(&self) -> Result<RailModes> {
        let size = self.unknowns();
        let factor = Cholesky::new(self.mass.clone()).ok_or_else(|| singular(size))?.unpack();
        let half = factor.solve_lower_triangular(&self.stiffness).ok_or_else(|| singular(size))?;
        let mut reduced = factor.solve_lower_triangular(&half.transpose()).ok_or_else(|| singular(size))?;
        reduced = (&reduced + reduced.transpose()) * 0.5;
        let eigen = SymmetricEigen::new(reduced);
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
        let sorted = DMatrix::from_fn(size, size, |i, j| eigen.eigenvectors[(i, order[j])]);
        let shapes = factor.transpose().solve_upper_triangular(&sorted).ok_or_else(|| singular(size))?;
        Ok(RailModes { squares: order.iter().map(|&i| eigen.eigenvalues[i].max(0.0)).collect(), shapes })
    }
}

impl RailModes {
    /// A row of [`RailBeam::section_motion`] in modal coordinates.
    pub fn project(&self, row: &[(usize, f64)]) -> DVector<f64> {
        let mut projected = DVector::zeros(self.squares.len());
        for &(unknown, factor) in row {
            projected.axpy(factor, &self.shapes.row(unknown).transpose(), 1.0);
        }
        projected
    }
}

fn assemble(unknowns: &[[Option<usize>; 6]], count: usize, element: &SMatrix<f64, 12, 12>) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(count, count);
    for pair in unknowns.windows(2) {
        let places: SVector<Option<usize>, 12> = SVector::from_fn(|i, _| pair[i / 6][i % 6]);
        for i in 0..12 {
            for j in 0..12 {
                if let (Some(row), Some(column)) = (places[i], places[j]) {
                    matrix[(row, column)] += element[(i, j)];
                }
            }
        }
    }
    matrix
}

fn dense(row: &[(usize, f64)], size: usize) -> DVector<f64> {
    let mut vector = DVector::zeros(size);
    for &(unknown, factor) in row {
        vector[unknown] += factor;
    }
    vector
}

fn singular(unknowns: usize) -> NumericsError {
    NumericsError {
        stage: "rail beam".into(),
        step: None,
        iteration: 0,
        residual: f64::NAN,
        active: unknowns,
        reason: StopReason::Singular,
    }
}

#[cfg(test)]
pub(super) mod tests;
