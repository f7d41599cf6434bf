//! A body reduced to its contact nodes: factor once, then only dense algebra.
//!
//! The equations of the contact nodes and of the master node come last, so the
//! trailing block `L_rr` of the Cholesky factor is the factor of the Schur
//! complement, and `(L_rr·L_rrᵀ)⁻¹` is the exact compliance there. A body that is its own mirror
//! image across the track is condensed by halves ([`Parts`]).

mod dense;
mod factor;
mod size;
mod section_motion;
mod modes;
mod condensed;
mod condensed_file;
mod parts;

#[cfg(test)]
pub use condensed::Interior;
pub use condensed::{CondensedBody, body_key};
pub use dense::product_speed;
pub use factor::Factor;
pub use modes::Modes;
pub use parts::{Parts, Step, Wanted};
pub use section_motion::SectionMotion;
pub use section_motion::carried;
pub use size::FactorSize;

use crate::solid::System;
use faer::linalg::matmul::matmul;
use faer::sparse::SparseColMat;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use pulp::{Arch, Simd, WithSimd};
use railspring_profiles::error::Result;
use std::ops::Range;

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
        Self::in_steps(system, &mut |_| ())
    }

    /// The same, which says what it `begins`.
    fn in_steps(system: System<'a>, begins: &mut dyn FnMut(Step)) -> Result<Self> {
        begins(Step::Assembly);
        let matrix = system.matrix(1.0, 0.0, &[])?;
        Self::of(system, matrix, begins)
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
        Self::of(system, matrix, &mut |_| ())
    }

    fn of(
        system: System<'a>,
        matrix: SparseColMat<usize, f64>,
        begins: &mut dyn FnMut(Step),
    ) -> Result<Self> {
        begins(Step::Factorisation);
        let factor = Factor::new(matrix.as_ref(), system.numbering.interior)?;
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

/// Dense matrix times vector.
pub fn times(matrix: &Mat<f64>, vector: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; matrix.nrows()];
    add_times(matrix.as_ref(), vector, &mut product);
    product
}

/// Adds dense matrix times vector to a `sum`, without the columns of zeros. Most forces on nodes are zero, and those that are not come in
/// runs.
pub fn add_times(matrix: MatRef<'_, f64>, vector: &[f64], sum: &mut [f64]) {
    let rows = sum.len();
    let mut start = 0;
    for run in vector.chunk_by(|a, b| (*a == 0.0) == (*b == 0.0)) {
        if run[0] != 0.0 {
            let sum = MatMut::from_column_major_slice_mut(sum, rows, 1);
            let run_of = MatRef::from_column_major_slice(run, run.len(), 1);
            // on one thread, so that their number changes nothing
            matmul(sum, Accum::Add, matrix.subcols(start, run.len()), run_of, 1.0, Par::Seq);
        }
        start += run.len();
    }
}

/// Adds the `rows` of columns of a matrix with their weights to a sum, several columns at a time.
pub fn add_columns(matrix: &Mat<f64>, rows: Range<usize>, weights: &[(usize, f64)], sum: &mut [f64]) {
    Arch::new().dispatch(AddColumns { matrix, rows, weights, sum });
}

/// With the widest vectors of the processor; as every value is a sum by itself, their width changes nothing.
struct AddColumns<'a> {
    matrix: &'a Mat<f64>,
    rows: Range<usize>,
    weights: &'a [(usize, f64)],
    sum: &'a mut [f64],
}

impl WithSimd for AddColumns<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { matrix, rows, weights, sum } = self;
        let count = rows.len();
        let sum = &mut sum[..count];
        let (fours, rest) = weights.as_chunks::<4>();
        for [(a, wa), (b, wb), (c, wc), (d, wd)] in fours {
            let (a, b) = (
                &matrix.col_as_slice(*a)[rows.clone()][..count],
                &matrix.col_as_slice(*b)[rows.clone()][..count],
            );
            let (c, d) = (
                &matrix.col_as_slice(*c)[rows.clone()][..count],
                &matrix.col_as_slice(*d)[rows.clone()][..count],
            );
            for r in 0..count {
                sum[r] += (wa * a[r] + wb * b[r]) + (wc * c[r] + wd * d[r]);
            }
        }
        for (column, weight) in rest {
            let column = &matrix.col_as_slice(*column)[rows.clone()][..count];
            for r in 0..count {
                sum[r] += weight * column[r];
            }
        }
    }
}
