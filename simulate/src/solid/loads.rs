//! Forces on the interface of a body, and products with them.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use std::ops::Range;

/// Forces on neighbouring rows of the interface, N.
pub(super) struct Load {
    pub rows: Range<usize>,
    pub forces: Vec<f64>,
}

/// The nodes with forces lie in lines along the track, so that the rows come in runs: their part of a product is that of a matrix. Forces
/// are (row, N), ascending.
pub(super) fn in_runs(forces: impl IntoIterator<Item = (usize, f64)>) -> Vec<Load> {
    let mut runs: Vec<Load> = Vec::new();
    for (row, force) in forces {
        match runs.last_mut() {
            Some(run) if row >= run.rows.end && row <= run.rows.end + GAP => {
                run.forces.resize(row - run.rows.start, 0.0);
                run.forces.push(force);
                run.rows.end = row + 1;
            }
            _ => runs.push(Load { rows: row..row + 1, forces: vec![force] }),
        }
    }
    runs
}

/// Rows without forces that a run may have between others: those of a node.
const GAP: usize = 3;

/// Adds `factor` times matrix times vector to a `sum`; on one thread, so that their number changes nothing.
pub(super) fn add_product(matrix: MatRef<'_, f64>, vector: &[f64], factor: f64, sum: &mut [f64]) {
    let (rows, columns) = (matrix.nrows(), matrix.ncols());
    let vector = MatRef::from_column_major_slice(vector, columns, 1);
    let sum = MatMut::from_column_major_slice_mut(sum, rows, 1);
    matmul(sum, Accum::Add, matrix, vector, factor, Par::Seq);
}
