//! A factored body: its compliance, and its displacements under forces.

use super::factor::Factor;
use super::products::times;
use super::step::Step;
use crate::solid::System;
use faer::sparse::SparseColMat;
use faer::{Mat, MatMut};
use railspring_profiles::error::Result;

/// A factored body with its compliance at the retained equations.
pub struct Superelement<'a> {
    /// The body.
    pub system: System<'a>,
    /// Its factor.
    pub factor: Factor,
    /// Compliance of the retained equations, m/N: contact nodes (`3·node + direction` in the
    /// order of the contact grid), then the master's free motions.
    pub compliance: Mat<f64>,
}

impl<'a> Superelement<'a> {
    /// Assembles, factors and condenses the stiffness.
    ///
    /// # Errors
    /// An inverted element, or a matrix that is not positive definite because the body is not held.
    pub fn new(system: System<'a>) -> Result<Self> {
        let mut none = Mat::zeros(system.numbering.equations, 0);
        Self::in_steps(system, none.as_mut(), &mut |_| ())
    }

    /// The same, which says what it `begins`, and eliminates the inside from `loads`, right-hand sides of all equations by column.
    pub(super) fn in_steps(
        system: System<'a>,
        loads: MatMut<'_, f64>,
        begins: &mut dyn FnMut(Step),
    ) -> Result<Self> {
        begins(Step::Assembly);
        let matrix = system.matrix(1.0, 0.0, &[])?;
        Self::of(system, matrix, loads, begins)
    }

    /// As [`Self::new`] for `stiffness_factor·stiffness + mass_factor·mass` with extra `diagonal` terms.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn effective(
        system: System<'a>,
        stiffness_factor: f64,
        mass_factor: f64,
        diagonal: &[(usize, f64)],
    ) -> Result<Self> {
        let matrix = system.matrix(stiffness_factor, mass_factor, diagonal)?;
        let mut none = Mat::zeros(system.numbering.equations, 0);
        Self::of(system, matrix, none.as_mut(), &mut |_| ())
    }

    fn of(
        system: System<'a>,
        matrix: SparseColMat<usize, f64>,
        loads: MatMut<'_, f64>,
        begins: &mut dyn FnMut(Step),
    ) -> Result<Self> {
        begins(Step::Factorisation);
        let factor = Factor::with_loads(matrix.as_ref(), system.numbering.interior, loads)?;
        drop(matrix);
        begins(Step::Condensation);
        let compliance = factor.retained_compliance();
        Ok(Self { system, factor, compliance })
    }

    /// Displacements of all nodes (`3·node + direction`, m) under forces on any of them (same layout, N).
    pub fn solve(&self, nodal_forces: &[f64]) -> Vec<f64> {
        let System { mesh, numbering, .. } = &self.system;
        let mut x = numbering.gather(mesh, nodal_forces);
        self.factor.forward_interior(&mut x);
        let retained = times(&self.compliance, &x[numbering.interior..]);
        x[numbering.interior..].copy_from_slice(&retained);
        self.factor.backward_interior(&mut x);
        numbering.expand(mesh, &x)
    }
}
