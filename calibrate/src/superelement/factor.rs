//! Sparse Cholesky factor with its interior and retained parts kept apart.

use super::elimination::{compliance_of, eliminated, symbolic_of, transposed};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, SymbolicCholeskyRaw};
use faer::{Accum, Conj, Mat, MatMut, MatRef, Par};
use railspring_profiles::error::Result;

/// `A = L·Lᵀ` of a matrix whose first `interior` equations are eliminated and whose
/// last ones are retained.
pub struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    interior: usize,
    size: usize,
}

impl Factor {
    /// Factors a symmetric positive definite matrix given by its upper triangle, in the order given.
    ///
    /// # Errors
    /// [`NumericsError`](railspring_profiles::error::NumericsError) if the matrix is not positive definite.
    pub fn new(upper: SparseColMatRef<'_, usize, f64>, interior: usize) -> Result<Self> {
        Self::with_loads(upper, interior, Mat::zeros(upper.ncols(), 0).as_mut())
    }

    /// The same, which eliminates the interior from `loads`, right-hand sides by column, as [`Self::forward_interior`] does.
    pub(super) fn with_loads(
        upper: SparseColMatRef<'_, usize, f64>,
        interior: usize,
        loads: MatMut<'_, f64>,
    ) -> Result<Self> {
        let symbolic = symbolic_of(upper.symbolic())?;
        let mut values = vec![0.0; symbolic.len_val()];
        let retained = eliminated(&symbolic, transposed(upper)?, interior, loads, Some(&mut values))?;
        let mut factor = Self { symbolic, values, interior, size: upper.ncols() };
        factor.put_retained(&retained);
        Ok(factor)
    }

    /// The columns of the retained equations, from `L_rr`.
    fn put_retained(&mut self, lower: &Mat<f64>) {
        let Self { values, interior, .. } = self;
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("the supernodal form is forced")
        };
        for s in 0..symbolic.n_supernodes() {
            let node = symbolic.supernode(s);
            let rows: Vec<usize> =
                (node.start()..symbolic.supernode_end()[s]).chain(node.pattern().iter().copied()).collect();
            let first = symbolic.col_ptr_for_val()[s];
            for (j, column) in (node.start()..symbolic.supernode_end()[s]).enumerate() {
                let Some(at) = column.checked_sub(*interior) else { continue };
                let to = &mut values[first + j * rows.len()..first + (j + 1) * rows.len()];
                let from = lower.col_as_slice(at);
                to.iter_mut().zip(&rows).skip(j).for_each(|(value, row)| *value = from[row - *interior]);
            }
        }
    }

    /// Number of values stored in the factor.
    pub fn stored_values(&self) -> usize {
        self.values.len()
    }

    fn supernodes(&self) -> SupernodalLltRef<'_, usize, f64> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) => SupernodalLltRef::new(symbolic, &self.values),
            SymbolicCholeskyRaw::Simplicial(_) => unreachable!("the supernodal form is forced"),
        }
    }

    /// Supernodes with interior columns: first column, interior columns, values by column, rows below.
    fn interior_blocks(&self) -> impl DoubleEndedIterator<Item = Block<'_>> {
        let factor = self.supernodes();
        (0..factor.symbolic().n_supernodes()).filter_map(move |s| {
            let node = factor.supernode(s);
            let values = node.val();
            let columns = values.ncols().min(self.interior.saturating_sub(node.start()));
            (columns > 0).then(|| Block {
                start: node.start(),
                columns,
                square: values.ncols(),
                values,
                pattern: node.pattern(),
            })
        })
    }

    /// Solves for several right-hand sides at once, in place; a column takes a fraction of the time that it takes alone.
    pub fn solve(&self, columns: MatMut<'_, f64>) {
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(columns.ncols(), Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            columns,
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }

    /// `Lᵀ·x` of several vectors: the products of its columns are those of the vectors with the matrix between them.
    pub fn root_times(&self, columns: MatRef<'_, f64>) -> Mat<f64> {
        let factor = self.supernodes();
        let count = columns.ncols();
        let mut product = Mat::zeros(self.size, count);
        for s in 0..factor.symbolic().n_supernodes() {
            let node = factor.supernode(s);
            let (start, width) = (node.start(), node.val().ncols());
            let (top, below) = node.val().split_at_row(width);
            let mut rows = product.as_mut().subrows_mut(start, width);
            triangular::matmul(
                rows.as_mut(),
                BlockStructure::Rectangular,
                Accum::Replace,
                top.transpose(),
                BlockStructure::TriangularUpper,
                columns.subrows(start, width),
                BlockStructure::Rectangular,
                1.0,
                Par::Seq,
            );
            let mut gathered = Mat::zeros(below.nrows(), count);
            for n in 0..count {
                let column = columns.col(n).try_as_col_major().expect("column major").as_slice();
                let values = gathered.col_as_slice_mut(n).iter_mut().zip(node.pattern());
                values.for_each(|(value, row)| *value = column[*row]);
            }
            matmul(rows, Accum::Add, below.transpose(), gathered.as_ref(), 1.0, Par::Seq);
        }
        product
    }

    /// Eliminates the interior from a right-hand side: afterwards `x[..interior]` holds `L⁻¹·b`
    /// and `x[interior..]` the condensed right-hand side.
    pub fn forward_interior(&self, x: &mut [f64]) {
        assert_eq!(x.len(), self.size);
        let mut below = Vec::new();
        for block in self.interior_blocks() {
            below.clear();
            below.resize(block.values.nrows() - block.columns, 0.0);
            for j in 0..block.columns {
                let column = block.values.col(j).try_as_col_major().expect("column major").as_slice();
                let value = x[block.start + j] / column[j];
                x[block.start + j] = value;
                let (top, rest) = column.split_at(block.columns);
                for (xi, l) in
                    x[block.start + j + 1..block.start + block.columns].iter_mut().zip(&top[j + 1..])
                {
                    *xi -= l * value;
                }
                below.iter_mut().zip(rest).for_each(|(b, l)| *b += l * value);
            }
            for (row, b) in block.rows_below().zip(&below) {
                x[row] -= b;
            }
        }
    }

    /// Back-substitution: with `x[..interior]` from [`Self::forward_interior`] (or zero) and the
    /// retained solution in `x[interior..]`, fills in the interior solution.
    pub fn backward_interior(&self, x: &mut [f64]) {
        assert_eq!(x.len(), self.size);
        let mut below = Vec::new();
        for block in self.interior_blocks().rev() {
            below.clear();
            below.extend(block.rows_below().map(|row| x[row]));
            for j in (0..block.columns).rev() {
                let column = block.values.col(j).try_as_col_major().expect("column major").as_slice();
                let (top, rest) = column.split_at(block.columns);
                let known = dot(&top[j + 1..], &x[block.start + j + 1..block.start + block.columns])
                    + dot(rest, &below);
                x[block.start + j] = (x[block.start + j] - known) / column[j];
            }
        }
    }

    /// `L_rr`: the factor of the retained equations.
    fn retained(&self) -> Mat<f64> {
        let n = self.size - self.interior;
        let mut lower = Mat::<f64>::zeros(n, n);
        let factor = self.supernodes();
        for s in 0..factor.symbolic().n_supernodes() {
            let node = factor.supernode(s);
            let values = node.val();
            for j in self.interior.saturating_sub(node.start()).min(values.ncols())..values.ncols() {
                let column = node.start() + j - self.interior;
                for i in j..values.ncols() {
                    lower[(node.start() + i - self.interior, column)] = values[(i, j)];
                }
                for (i, &row) in node.pattern().iter().enumerate() {
                    lower[(row - self.interior, column)] = values[(values.ncols() + i, j)];
                }
            }
        }
        lower
    }

    /// Compliance of the retained equations, `(L_rr·L_rrᵀ)⁻¹`.
    pub fn retained_compliance(&self) -> Mat<f64> {
        compliance_of(self.retained())
    }
}

/// The interior columns of one supernode.
struct Block<'a> {
    start: usize,
    columns: usize,
    square: usize,
    values: faer::MatRef<'a, f64>,
    pattern: &'a [usize],
}

impl Block<'_> {
    /// Rows below the interior columns' own triangle.
    fn rows_below(&self) -> impl Iterator<Item = usize> {
        (self.start + self.columns..self.start + self.square).chain(self.pattern.iter().copied())
    }
}

/// Dot product in eight independent sums, in a fixed order, so that it vectorises and repeats.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a8.zip(b8) {
        for i in 0..8 {
            sums[i] += x[i] * y[i];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::sparse::{SparseColMat, Triplet};

    /// Relative rounding of a well-conditioned 60-equation solve.
    const ROUNDOFF: f64 = 1e-12;

    /// Source: dense algebra of the same matrix by nalgebra.
    /// Goal: condensation, retained compliance, back-substitution, the solution for two right-hand sides at once and the products by the
    /// factor are those of the full matrix and its inverse.
    #[test]
    fn condensation_agrees_with_the_dense_inverse() {
        let (n, interior) = (60, 41);
        let mut dense = nalgebra::DMatrix::<f64>::zeros(n, n);
        let mut triplets = Vec::new();
        for i in 0..n {
            for j in [i, i + 1, i + 7, i + 13] {
                if j < n {
                    let v = if i == j { 6.0 + (i as f64).sin() } else { (i as f64 * 0.7 + j as f64).cos() };
                    dense[(i, j)] = v;
                    dense[(j, i)] = v;
                    triplets.push(Triplet::new(i, j, v));
                }
            }
        }
        let matrix = SparseColMat::try_new_from_triplets(n, n, &triplets).unwrap();
        let factor = Factor::new(matrix.as_ref(), interior).unwrap();
        let inverse = dense.clone().try_inverse().unwrap();
        let compliance = factor.retained_compliance();
        for i in 0..n - interior {
            for j in 0..n - interior {
                assert!((compliance[(i, j)] - inverse[(interior + i, interior + j)]).abs() < ROUNDOFF);
            }
        }
        let two = Mat::from_fn(n, 2, |i, j| (i as f64 * 0.9 + j as f64).cos());
        let root = factor.root_times(two.as_ref());
        let through = root.transpose() * &root;
        let nodal = nalgebra::DMatrix::from_fn(n, 2, |i, j| two[(i, j)]);
        let between = nodal.transpose() * &dense * &nodal;
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            assert!((through[(i, j)] - between[(i, j)]).abs() < ROUNDOFF * n as f64 * between[(0, 0)]);
        }
        let mut both = Mat::from_fn(n, 2, |i, j| (i as f64 * 1.3 + j as f64).sin());
        let b: Vec<f64> = both.col_as_slice(0).to_vec();
        let second = nalgebra::DVector::from_column_slice(both.col_as_slice(1));
        factor.solve(both.as_mut());
        let mut x = b.clone();
        factor.forward_interior(&mut x);
        let retained = crate::superelement::times(&compliance, &x[interior..]);
        x[interior..].copy_from_slice(&retained);
        factor.backward_interior(&mut x);
        let expected = &inverse * nalgebra::DVector::from_vec(b);
        assert!((nalgebra::DVector::from_vec(x) - &expected).norm() < ROUNDOFF * n as f64);
        for (column, expected) in [expected, inverse * second].into_iter().enumerate() {
            let found = nalgebra::DVector::from_column_slice(both.col_as_slice(column));
            assert!((found - expected).norm() < ROUNDOFF * n as f64);
        }
    }

    #[test]
    fn an_unheld_body_is_an_error() {
        let matrix = SparseColMat::try_new_from_triplets(
            2,
            2,
            &[Triplet::new(0, 0, 1.0), Triplet::new(0, 1, -1.0), Triplet::new(1, 1, -2.0)],
        )
        .unwrap();
        assert!(Factor::new(matrix.as_ref(), 1).is_err());
    }
}
