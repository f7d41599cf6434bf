//! The compliance of the retained equations where nothing else of the factor is wanted: it is made in two parts, and the first goes before the second comes.
//!
//! The equations are in the order of a nested dissection, so that some place in it has few equations behind it that those before it
//! touch: the disc of a wheel touches its rim in a few hundred. What is eliminated before that place leaves a dense block there, by which
//! it is replaced in the matrix of the others.

use super::factor::Factor;
use faer::Mat;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::simplicial::{
    prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch,
};
use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use railspring_profiles::error::Result;

/// The larger part has at most this share of the values of the whole factor; otherwise the memory saved is no reason for parts.
const LARGEST_PART: f64 = 0.9;
/// The work that parts add, of that of the whole factor: the dense block is factored, and its factor multiplied again.
const EXTRA_WORK: f64 = 0.01;

/// Compliance of the last equations of a symmetric positive definite matrix, by its upper triangle in the order of elimination. The first `interior` ones are eliminated.
///
/// # Errors
/// [`NumericsError`](railspring_profiles::error::NumericsError) if the matrix is not positive definite.
pub(super) fn compliance(upper: SparseColMat<usize, f64>, interior: usize) -> Result<Mat<f64>> {
    let (rest, interior) = match Cut::of(upper.symbolic(), interior) {
        Some(cut) => (cut.rest(upper)?, interior - cut.first),
        None => (upper, interior),
    };
    let factor = Factor::new(rest.as_ref(), interior)?;
    drop(rest);
    Ok(factor.retained_compliance())
}

/// Where the equations are divided.
pub(super) struct Cut {
    /// Equations of the first part.
    first: usize,
    /// Those of the second part that the first one touches, ascending.
    touched: Vec<usize>,
    /// Values of the factor of the larger part, of those of the whole one.
    pub larger: f64,
}

impl Cut {
    /// The one with the smallest larger part, among those that add little work; none where that saves little.
    pub fn of(upper: SymbolicSparseColMatRef<'_, usize>, interior: usize) -> Option<Self> {
        let size = upper.ncols();
        // the first row of each column says from which cut on it is touched
        let first_row = |column: usize| upper.row_idx_of_col_raw(column).first().copied().unwrap_or(column);
        let (mut more, mut fewer) = (vec![0_usize; size + 1], vec![0_usize; size + 1]);
        for column in 0..size {
            more[first_row(column).min(column) + 1] += 1;
            fewer[column + 1] += 1;
        }
        let heights = heights(upper);
        let values: f64 = heights.iter().sum();
        let work: f64 = heights.iter().map(|height| 0.5 * height * height).sum();
        let (mut before, mut touched) = (0.0, 0);
        let mut best: Option<(f64, usize)> = None;
        for first in 1..=interior {
            before += heights[first - 1];
            touched = touched + more[first] - fewer[first];
            let block = touched as f64;
            let larger = (before + block * block).max(values - before);
            let cheap = block.powi(3) / 3.0 < EXTRA_WORK * work;
            if cheap && larger < best.map_or(LARGEST_PART * values, |(least, _)| least) {
                best = Some((larger, first));
            }
        }
        let (larger, first) = best?;
        let touched = (first..size).filter(|&column| first_row(column) < first).collect();
        Some(Self { first, touched, larger: larger / values })
    }

    /// The matrix of the second part, when the first one is eliminated.
    fn rest(&self, upper: SparseColMat<usize, f64>) -> Result<SparseColMat<usize, f64>> {
        let Self { first, touched, .. } = self;
        let block = {
            let part = self.first_part(upper.as_ref());
            let factor = Factor::new(part.as_ref(), *first)?;
            drop(part);
            factor.retained_stiffness()
        };
        let mut columns = Columns::with_room(upper.compute_nnz());
        let mut next = 0;
        for column in *first..upper.ncols() {
            let entries = upper.row_idx_of_col_raw(column).iter().zip(upper.val_of_col(column));
            let entries =
                entries.filter(|(row, _)| **row >= *first).map(|(row, value)| (row - first, *value));
            if touched.get(next) == Some(&column) {
                let of_block = touched[..=next].iter().zip(block.row(next).iter());
                columns.add_merged(entries, of_block.map(|(row, value)| (row - first, *value)));
                next += 1;
            } else {
                columns.add(entries);
            }
        }
        Ok(columns.matrix())
    }

    /// The matrix of the first part with the equations that it touches.
    fn first_part(&self, upper: SparseColMatRef<'_, usize, f64>) -> SparseColMat<usize, f64> {
        let Self { first, touched, .. } = self;
        let place = |row: usize| match row < *first {
            true => Some(row),
            false => touched.binary_search(&row).ok().map(|at| first + at),
        };
        let mut columns = Columns::with_room(upper.compute_nnz());
        for column in (0..*first).chain(touched.iter().copied()) {
            let entries = upper.row_idx_of_col_raw(column).iter().zip(upper.val_of_col(column));
            columns.add(entries.filter_map(|(row, value)| Some((place(*row)?, *value))));
        }
        columns.matrix()
    }
}

/// How many values each column of the factor has.
fn heights(upper: SymbolicSparseColMatRef<'_, usize>) -> Vec<f64> {
    let (size, entries) = (upper.ncols(), upper.compute_nnz());
    let (mut tree, mut counts) = (vec![0_isize; size], vec![0_usize; size]);
    let mut memory = MemBuffer::new(prefactorize_symbolic_cholesky_scratch::<usize>(size, entries));
    prefactorize_symbolic_cholesky(&mut tree, &mut counts, upper, MemStack::new(&mut memory));
    counts.into_iter().map(|count| count as f64).collect()
}

/// Columns of a square matrix, one after the other, rows ascending.
struct Columns {
    ends: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl Columns {
    /// Room for so many entries, so that they are not moved while they grow.
    fn with_room(entries: usize) -> Self {
        Self { ends: Vec::new(), rows: Vec::with_capacity(entries), values: Vec::with_capacity(entries) }
    }

    fn add(&mut self, entries: impl Iterator<Item = (usize, f64)>) {
        for (row, value) in entries {
            self.rows.push(row);
            self.values.push(value);
        }
        self.ends.push(self.rows.len());
    }

    /// A column of both, those `over` others in their place.
    fn add_merged(
        &mut self,
        entries: impl Iterator<Item = (usize, f64)>,
        over: impl Iterator<Item = (usize, f64)>,
    ) {
        let (mut entries, mut over) = (entries.peekable(), over.peekable());
        let merged = std::iter::from_fn(|| {
            let (row, other) = (entries.peek().map(|entry| entry.0), over.peek().map(|entry| entry.0));
            match (row, other) {
                (Some(row), Some(other)) if row < other => entries.next(),
                (row, Some(other)) => {
                    if row == Some(other) {
                        entries.next();
                    }
                    over.next()
                }
                (_, None) => entries.next(),
            }
        });
        self.add(merged);
    }

    fn matrix(self) -> SparseColMat<usize, f64> {
        let Self { ends, rows, values } = self;
        let size = ends.len();
        let starts = std::iter::once(0).chain(ends).collect();
        SparseColMat::new(SymbolicSparseColMat::new_checked(size, size, starts, None, rows), values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::sparse::Triplet;

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

    /// Source: the whole factor. Goal: the compliance in two parts, m/N, is the same, for a chain of blocks of which one equation is touched; for a full matrix
    /// there is no cut. The larger part is about half. Accuracy over the largest: ROUNDOFF.
    #[test]
    fn two_parts_have_the_compliance_of_the_whole() {
        let (matrix, interior) = chain(8, 30);
        let cut = Cut::of(matrix.symbolic(), interior).expect("a place behind which one equation is touched");
        assert_eq!((cut.first, cut.touched.as_slice()), (119, &[119][..]));
        let whole = Factor::new(matrix.as_ref(), interior).unwrap().retained_compliance();
        let parts = compliance(matrix, interior).unwrap();
        let largest = whole.norm_max();
        assert!((&parts - &whole).norm_max() < ROUNDOFF * largest);
        let (full, interior) = (chain(1, 60).0, 30);
        assert!(Cut::of(full.symbolic(), interior).is_none());
        assert_eq!(compliance(full, interior).unwrap().nrows(), 30);
    }

    /// Goal: a matrix that is not positive definite in either part is refused.
    #[test]
    fn neither_part_may_be_indefinite() {
        for wrong in [10, 200] {
            let (matrix, interior) = chain(8, 30);
            let triplets: Vec<_> = (matrix.triplet_iter())
                .map(|Triplet { row, col, val }| {
                    Triplet::new(row, col, if row == wrong && col == wrong { -1.0 } else { *val })
                })
                .collect();
            let matrix = SparseColMat::try_new_from_triplets(240, 240, &triplets).unwrap();
            assert!(compliance(matrix, interior).is_err(), "{wrong}");
        }
    }
}
