//! Elimination of the equations of a body by fronts: its compliance, and its factor where that is wanted as well.
//!
//! I.S. Duff, J.K. Reid, "The multifrontal solution of indefinite sparse symmetric linear equations", ACM Trans. Math. Softw. 9
//! (1983). A supernode of the factor is eliminated in a dense matrix of its own equations and those that it touches. What that leaves
//! between the latter waits for the front that eliminates the first of them. Where the factor is not wanted, there are at no time more values
//! than those of a front and of what waits, which is less than half of the factor.

use super::left::{Left, Stack, subtract_square, values_of};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_inverse::invert_lower_triangular;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Accum, Col, Mat, MatMut, Par, Side};
use railspring_profiles::error::{NumericsError, Result, StopReason};

/// Compliance of the last equations of a symmetric positive definite matrix, by its upper triangle in the order of elimination. The first `interior` ones are eliminated,
/// of the `loads` as well ([`eliminated`]).
///
/// # Errors
/// [`NumericsError`] if the matrix is not positive definite.
pub(super) fn compliance(
    upper: SparseColMat<usize, f64>,
    interior: usize,
    loads: MatMut<'_, f64>,
) -> Result<Mat<f64>> {
    let symbolic = symbolic_of(upper.symbolic())?;
    let lower = transposed(upper.as_ref())?;
    drop(upper);
    Ok(compliance_of(eliminated(&symbolic, lower, interior, loads, None)?))
}

/// The supernodes of the factor of a matrix, by the pattern of its upper triangle, in the order given.
pub(super) fn symbolic_of(upper: SymbolicSparseColMatRef<'_, usize>) -> Result<SymbolicCholesky<usize>> {
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        ..Default::default()
    };
    let symbolic = factorize_symbolic_cholesky(upper, Side::Upper, SymmetricOrdering::Identity, params);
    Ok(symbolic.map_err(|_| failed())?)
}

/// The columns of the lower triangle, each of which has the equations that it meets after itself.
pub(super) fn transposed(upper: SparseColMatRef<'_, usize, f64>) -> Result<SparseColMat<usize, f64>> {
    Ok(upper.transpose().to_col_major().map_err(|_| failed())?)
}

/// The factor of the retained equations, in a lower triangle, from the lower triangle of the matrix. The columns of the others go into `kept`, the values of the
/// factor, or are lost. The `loads`, right-hand sides of all equations, become `L⁻¹·b` in those that are eliminated and the condensed loads in the others.
///
/// # Errors
/// [`NumericsError`] if the matrix is not positive definite.
pub(super) fn eliminated(
    symbolic: &SymbolicCholesky<usize>,
    lower: SparseColMat<usize, f64>,
    interior: usize,
    mut loads: MatMut<'_, f64>,
    mut kept: Option<&mut [f64]>,
) -> Result<Mat<f64>> {
    let fronts = Fronts::new(symbolic, interior);
    let size = lower.ncols();
    let entries = |column: usize| lower.row_idx_of_col(column).zip(lower.val_of_col(column));
    let mut retained = Mat::zeros(size - interior, size - interior);
    for column in interior..size {
        entries(column).for_each(|(row, value)| retained[(row - interior, column - interior)] += value);
    }
    let mut place = vec![0; size];
    let mut stack = Stack::new(fronts.most_beside(1, kept.is_some()));
    for s in 0..fronts.count() {
        let Front { mut rows, eliminated } = fronts.front(s);
        rows.iter().enumerate().for_each(|(at, row)| place[*row] = at);
        let of_panel = rows.len() * eliminated;
        let own = if kept.is_some() { 0 } else { of_panel };
        let (before, values) = stack.front(s, own + values_of(rows.len() - eliminated));
        let (own_panel, left) = values.split_at_mut(own);
        let panel = match &mut kept {
            Some(values) => &mut values[fronts.nodes.col_ptr_for_val()[s]..][..of_panel],
            None => own_panel,
        };
        let mut panel = MatMut::from_column_major_slice_mut(panel, rows.len(), eliminated);
        for (at, column) in rows[..eliminated].iter().enumerate() {
            entries(*column).for_each(|(row, value)| panel[(place[row], at)] += value);
        }
        before.iter().for_each(|before| before.add_to(panel.as_mut(), left, &place));
        let (mut top, mut below) = panel.split_at_row_mut(eliminated);
        factored(top.as_mut())?;
        solve_lower_triangular_in_place(top.as_ref(), below.as_mut().transpose_mut(), threads());
        subtract_square(left, below.as_ref(), threads());
        for n in 0..loads.ncols() {
            let mut load = Col::from_fn(rows.len(), |at| loads[(rows[at], n)]);
            let (mut of_top, of_below) = load.as_mut().split_at_row_mut(eliminated);
            solve_lower_triangular_in_place(top.as_ref(), of_top.as_mut().as_mat_mut(), Par::Seq);
            matmul(of_below.as_mat_mut(), Accum::Add, below.as_ref(), of_top.as_mat(), -1.0, Par::Seq);
            rows.iter().zip(load.iter()).for_each(|(row, value)| loads[(*row, n)] = *value);
        }
        let rest = rows.split_off(eliminated);
        let next = fronts.next(&rest);
        if next.is_none() {
            Left { rows: &rest, values: left }.each_column(|column, rows, values| {
                let to = retained.col_as_slice_mut(column - interior);
                rows.iter().zip(values).for_each(|(row, value)| to[row - interior] += value);
            });
        }
        stack.made(s, rest, own, next);
    }
    factored(retained.as_mut())?;
    Ok(retained)
}

/// The threads of the pool, whose number changes no byte of the result.
fn threads() -> Par {
    Par::rayon(0)
}

/// That a matrix is not positive definite.
fn failed() -> NumericsError {
    NumericsError::new("factorisation", StopReason::Singular, f64::NAN, 0)
}

/// Replaces the lower triangle of a matrix by that of its factor.
fn factored(matrix: MatMut<'_, f64>) -> Result<()> {
    let scratch = cholesky_in_place_scratch::<f64>(matrix.nrows(), threads(), Default::default());
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    cholesky_in_place(matrix, LltRegularization::default(), threads(), stack, Default::default())
        .map_err(|_| failed())?;
    Ok(())
}

/// `(L·Lᵀ)⁻¹` of a factor L, the lower triangle of a matrix.
pub(super) fn compliance_of(lower: Mat<f64>) -> Mat<f64> {
    let n = lower.nrows();
    let mut inverse = Mat::<f64>::zeros(n, n);
    invert_lower_triangular(inverse.as_mut(), lower.as_ref(), threads());
    let mut compliance = lower;
    triangular::matmul(
        compliance.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        inverse.transpose(),
        BlockStructure::TriangularUpper,
        inverse.as_ref(),
        BlockStructure::TriangularLower,
        1.0,
        threads(),
    );
    drop(inverse);
    for column in 1..n {
        for row in 0..column {
            compliance[(row, column)] = compliance[(column, row)];
        }
    }
    compliance
}

/// The fronts of a factor, of which the equations from `interior` on are retained.
pub(super) struct Fronts<'s> {
    nodes: &'s SymbolicSupernodalCholesky<usize>,
    interior: usize,
}

/// A front: its equations, the first of which are eliminated.
struct Front {
    rows: Vec<usize>,
    eliminated: usize,
}

impl<'s> Fronts<'s> {
    pub fn new(symbolic: &'s SymbolicCholesky<usize>, interior: usize) -> Self {
        match symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(nodes) => Self { nodes, interior },
            SymbolicCholeskyRaw::Simplicial(_) => unreachable!("the supernodal form is forced"),
        }
    }

    /// How many eliminate an equation.
    fn count(&self) -> usize {
        self.nodes.supernode_begin().partition_point(|begin| *begin < self.interior)
    }

    fn front(&self, s: usize) -> Front {
        let (begin, end) = (self.nodes.supernode_begin()[s], self.nodes.supernode_end()[s]);
        let below = self.nodes.col_ptr_for_row_idx();
        let below = &self.nodes.row_idx()[below[s]..below[s + 1]];
        let rows = (begin..end).chain(below.iter().copied()).collect();
        Front { rows, eliminated: end.min(self.interior) - begin }
    }

    /// Which of them eliminates the first of some equations that one before has left; none where all are retained.
    fn next(&self, rows: &[usize]) -> Option<usize> {
        let first = rows.first().filter(|row| **row < self.interior)?;
        Some(self.nodes.supernode_end().partition_point(|end| end <= first))
    }

    /// The most values that there are at the same time: those of a front, what waits for others, and the retained ones. The columns that a front eliminates
    /// are among them unless they are `kept` in the factor. Each equation stands for so `many`.
    pub fn most_values(&self, many: usize, kept: bool) -> usize {
        (many * (self.nodes.nrows() - self.interior)).pow(2) + self.most_beside(many, kept)
    }

    /// Those of them beside the retained ones.
    fn most_beside(&self, many: usize, kept: bool) -> usize {
        let (mut waiting, mut of_front) = (0, vec![0; self.count()]);
        let mut most = 0;
        for s in 0..self.count() {
            let Front { rows, eliminated } = self.front(s);
            let panel = if kept { 0 } else { many * many * rows.len() * eliminated };
            let left = values_of(many * (rows.len() - eliminated));
            most = most.max(waiting + panel + left);
            waiting -= of_front[s];
            if let Some(next) = self.next(&rows[eliminated..]) {
                of_front[next] += left;
                waiting += left;
            }
        }
        most
    }
}

#[cfg(test)]
mod tests {
    use super::super::factor::Factor;
    use super::*;
    use faer::sparse::Triplet;
    use std::ops::Range;

    /// ROUNDOFF of a few thousand equations that are well conditioned.
    const ROUNDOFF: f64 = 1e-12;

    /// Upper triangle of a chain of `blocks` full blocks, each of which touches the next one in one equation; the last block is retained.
    fn chain(blocks: usize, each: usize) -> (SparseColMat<usize, f64>, usize) {
        let size = blocks * each;
        let mut triplets = Vec::new();
        for column in 0..size {
            let value = |row: usize| 0.3 / each as f64 * (1.7 * (row * column) as f64 + row as f64).sin();
            let begin = column / each * each;
            triplets.extend((begin..column).map(|row| Triplet::new(row, column, value(row))));
            if column == begin && begin > 0 {
                triplets.push(Triplet::new(begin - 1, column, -0.2));
            }
            triplets.push(Triplet::new(column, column, 1.5 + (column as f64).cos() / 4.0));
        }
        (SparseColMat::try_new_from_triplets(size, size, &triplets).unwrap(), size - each)
    }

    /// Source: dense algebra of the same matrix by nalgebra. Goal: the compliance, m/N, for a chain of blocks, the last of which is retained whole or in part, for
    /// a full matrix, and for a grid whose halves meet in its middle, in two orders. Two loads do their work, J, and move the retained equations, m. With the factor the compliance is the same
    /// to the byte. Accuracy over the largest: ROUNDOFF.
    #[test]
    fn fronts_have_the_compliance_of_the_dense_inverse() {
        let ((blocks, interior), full) = (chain(8, 30), chain(1, 60).0);
        let cases =
            [(blocks.clone(), interior), (blocks, interior + 10), (full, 30), dissected(13), interleaved(13)];
        for (matrix, interior) in cases {
            let size = matrix.ncols();
            let mut dense = nalgebra::DMatrix::<f64>::zeros(size, size);
            for Triplet { row, col, val } in matrix.triplet_iter() {
                (dense[(row, col)], dense[(col, row)]) = (*val, *val);
            }
            let inverse = dense.try_inverse().unwrap();
            let with_factor = Factor::new(matrix.as_ref(), interior).unwrap().retained_compliance();
            let mut loads = Mat::from_fn(size, 2, |i, n| (0.7 * (i * (n + 1)) as f64).cos());
            let given = nalgebra::DMatrix::from_fn(size, 2, |i, n| loads[(i, n)]);
            let found = compliance(matrix, interior, loads.as_mut()).unwrap();
            let (inside, condensed) = loads.as_ref().split_at_row(interior);
            let work = inside.transpose() * inside + condensed.transpose() * &found * condensed;
            let moved = &inverse * &given;
            let expected = given.transpose() * &moved;
            for (i, k) in [(0, 0), (0, 1), (1, 1)] {
                assert!((work[(i, k)] - expected[(i, k)]).abs() < ROUNDOFF * expected.amax());
            }
            let retained = &found * condensed;
            for (i, n) in (interior..size).flat_map(|i| [(i, 0), (i, 1)]) {
                assert!((retained[(i - interior, n)] - moved[(i, n)]).abs() < ROUNDOFF * moved.amax());
            }
            for (i, j) in (interior..size).flat_map(|i| (interior..size).map(move |j| (i, j))) {
                let off = found[(i - interior, j - interior)] - inverse[(i, j)];
                assert!(off.abs() < ROUNDOFF * inverse.amax(), "{i} {j}: {off:e}");
            }
            assert_eq!(found, with_factor);
        }
    }

    /// Goal: the most values at a time are those of the largest front where one block follows the other; of a grid whose halves meet in its middle
    /// they are fewer than those of its factor. Equations that stand for three have nine times as many where what is left has one block of columns; with more blocks,
    /// which leave out half of a square, they have between half of that and that.
    #[test]
    fn values_are_those_of_fronts() {
        let (matrix, interior) = chain(8, 30);
        let symbolic = symbolic_of(matrix.symbolic()).unwrap();
        // 30 equations that touch one, which the next front has from them
        let most = Fronts::new(&symbolic, interior).most_values(1, false);
        assert_eq!(most, 30 * 30 + 31 * 30 + 1 + 1);
        assert_eq!(Fronts::new(&symbolic, interior).most_values(1, true), 30 * 30 + 1 + 1);
        for (matrix, interior) in [(matrix, interior), dissected(13)] {
            let symbolic = symbolic_of(matrix.symbolic()).unwrap();
            let fronts = Fronts::new(&symbolic, interior);
            for kept in [false, true] {
                assert_eq!(fronts.most_values(3, kept), 9 * fronts.most_values(1, kept));
            }
        }
        let (matrix, interior) = dissected(40);
        let symbolic = symbolic_of(matrix.symbolic()).unwrap();
        let fronts = Fronts::new(&symbolic, interior);
        let (one, three) = (fronts.most_values(1, false), fronts.most_values(3, false));
        assert!(2 * one < symbolic.len_val(), "{one} of {}", symbolic.len_val());
        assert!(2 * three > 9 * one && three <= 9 * one, "{three}");
    }

    /// A square grid of springs, each half of it in nested dissection, whose last side is retained.
    fn dissected(side: usize) -> (SparseColMat<usize, f64>, usize) {
        let mut order = Vec::new();
        dissect([0..side, 0..side - 1], &mut order);
        grid(side, order)
    }

    /// The same, the rest of a front of one half between those of the other.
    fn interleaved(side: usize) -> (SparseColMat<usize, f64>, usize) {
        let mut halves = [0..side / 2, side / 2 + 1..side].map(|rows| {
            let mut order = Vec::new();
            dissect([rows, 0..side - 1], &mut order);
            order
        });
        let mut order = Vec::new();
        while halves.iter().any(|half| !half.is_empty()) {
            for half in &mut halves {
                order.extend(half.drain(..half.len().min(7)));
            }
        }
        order.extend((0..side - 1).map(|k| (side / 2, k)));
        grid(side, order)
    }

    /// That grid in this order of what is eliminated.
    fn grid(side: usize, mut order: Vec<(usize, usize)>) -> (SparseColMat<usize, f64>, usize) {
        let interior = order.len();
        order.extend((0..side).map(|i| (i, side - 1)));
        let at = |i: usize, k: usize| order.iter().position(|place| *place == (i, k)).unwrap();
        let mut triplets = Vec::new();
        for i in 0..side {
            for k in 0..side {
                let here = at(i, k);
                triplets.push(Triplet::new(here, here, 4.1 + 0.2 * (here as f64).sin()));
                let next = [(i + 1, k), (i, k + 1)];
                for (i, k) in next.into_iter().filter(|(i, k)| *i < side && *k < side) {
                    let there = at(i, k);
                    triplets.push(Triplet::new(here.min(there), here.max(there), -1.0));
                }
            }
        }
        let size = order.len();
        (SparseColMat::try_new_from_triplets(size, size, &triplets).unwrap(), interior)
    }

    /// The places of a rectangle, those of its middle line last.
    fn dissect([rows, columns]: [Range<usize>; 2], order: &mut Vec<(usize, usize)>) {
        if rows.is_empty() || columns.is_empty() {
            return;
        }
        if rows.len() >= columns.len() {
            let middle = rows.start + rows.len() / 2;
            dissect([rows.start..middle, columns.clone()], order);
            dissect([middle + 1..rows.end, columns.clone()], order);
            order.extend(columns.map(|k| (middle, k)));
        } else {
            let middle = columns.start + columns.len() / 2;
            dissect([rows.clone(), columns.start..middle], order);
            dissect([rows.clone(), middle + 1..columns.end], order);
            order.extend(rows.map(|i| (i, middle)));
        }
    }

    /// Goal: a matrix that is not positive definite is refused, whether an equation that is eliminated or one that is retained makes it so.
    #[test]
    fn nothing_may_be_indefinite() {
        for wrong in [10, 200] {
            let (matrix, interior) = chain(8, 30);
            let triplets: Vec<_> = (matrix.triplet_iter())
                .map(|Triplet { row, col, val }| {
                    Triplet::new(row, col, if row == wrong && col == wrong { -1.0 } else { *val })
                })
                .collect();
            let matrix = SparseColMat::try_new_from_triplets(240, 240, &triplets).unwrap();
            let mut none = Mat::zeros(240, 0);
            assert!(compliance(matrix, interior, none.as_mut()).is_err(), "{wrong}");
        }
    }
}
