//! The interface of a reduced body where its contact is: how it moves with the body's coordinates, and what that adds to its flexibility in a step.

use super::loads::{Load, add_product};
use super::path::{PathPlace, RailPath};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use nalgebra::{DMatrix, DVector};
use std::sync::OnceLock;

/// A body where its contact is: at its only place, or at one along a rail.
#[derive(Debug)]
pub(super) struct AtPlace {
    /// Place along the rail from its middle, m.
    pub(super) x: f64,
    /// Motions of the interface under unit coordinates, the hub's first, then the modes; and those in which the flexibility differs from place to place.
    pub(super) shapes: Mat<f64>,
    /// How many of these are coordinates of the body.
    pub(super) coordinates: usize,
    /// What the flexibility of the interface in a step is beyond the compliance in the middle is this times the transpose of the shapes.
    pub(super) half: Mat<f64>,
    /// What the compliance differs by from that in the middle, between the motions after the coordinates, m/N.
    pub(super) difference: DMatrix<f64>,
    /// Displacements of the contact nodes under a unit torque on the middle of a rail; empty where there is none.
    pub(super) twist: Vec<f64>,
    /// Of the interface in a step, m/N, if it was wanted for every step.
    pub(super) flexibility: OnceLock<Mat<f64>>,
}

impl AtPlace {
    /// The interface that moves with coordinates by `shapes`; `between` is what the inverse of the step has beyond the statics of the modes.
    pub(super) fn only(shapes: Mat<f64>, between: &DMatrix<f64>) -> Self {
        let none = PathPlace { shapes, twist: Vec::new(), difference: DMatrix::zeros(0, 0) };
        Self::along(0.0, none, None, between, 1.0)
    }

    /// The same of a rail at `x` (m) along its `path`, with the stiffening of a step.
    pub(super) fn along(
        x: f64,
        at: PathPlace,
        path: Option<&RailPath>,
        between: &DMatrix<f64>,
        stiffening: f64,
    ) -> Self {
        let PathPlace { shapes: of_modes, twist, difference } = at;
        let (rows, coordinates, motions) = (of_modes.nrows(), of_modes.ncols(), difference.nrows());
        let mut shapes = Mat::zeros(rows, coordinates + motions);
        shapes.subcols_mut(0, coordinates).copy_from(&of_modes);
        if let Some(path) = path {
            shapes.subcols_mut(coordinates, motions).copy_from(&path.window);
        }
        let mut half = Mat::zeros(rows, coordinates + motions);
        let inner = |matrix: &DMatrix<f64>, factor: f64| {
            Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| factor * matrix[(i, j)])
        };
        let (of_body, of_window) = shapes.split_at_col(coordinates);
        let (half_body, half_window) = half.split_at_col_mut(coordinates);
        matmul(half_body, Accum::Replace, of_body, inner(between, 1.0).as_ref(), 1.0, Par::Seq);
        let difference_in_step = inner(&difference, 1.0 / stiffening);
        matmul(half_window, Accum::Replace, of_window, difference_in_step.as_ref(), 1.0, Par::Seq);
        Self { x, shapes, coordinates, half, difference, twist, flexibility: OnceLock::new() }
    }

    /// Motions of the interface with the coordinates of the body.
    pub(super) fn of_body(&self) -> MatRef<'_, f64> {
        self.shapes.subcols(0, self.coordinates)
    }

    /// Those in which the flexibility differs from place to place.
    pub(super) fn of_window(&self) -> MatRef<'_, f64> {
        self.shapes.subcols(self.coordinates, self.shapes.ncols() - self.coordinates)
    }

    /// Forces on coordinates and motions of the window of forces at the interface.
    pub(super) fn on_all(&self, loads: &[Load]) -> DVector<f64> {
        let mut sum = DVector::zeros(self.shapes.ncols());
        for Load { rows, forces } in loads {
            let shapes = self.shapes.subrows(rows.start, rows.len());
            add_product(shapes.transpose(), forces, 1.0, sum.as_mut_slice());
        }
        sum
    }
}
