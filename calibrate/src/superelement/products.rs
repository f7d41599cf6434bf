//! Products of a dense matrix with vectors.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

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
