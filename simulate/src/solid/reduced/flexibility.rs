//! The flexibility of a reduced body in a step.

use super::super::at_place::AtPlace;
use super::super::body::Flexible;
use super::super::loads::{Load, add_product, in_runs};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use railspring_calibrate::contact::{NodalCompliance, Terms};
use std::ops::Range;
use std::sync::Arc;

/// The flexibility of a reduced body in a step.
pub(super) struct StepFlexibility<'a> {
    /// Between the contact nodes in the middle, m/N.
    pub(super) compliance: &'a Mat<f64>,
    pub(super) contact: usize,
    /// A step is stiffer than the statics by this.
    pub(super) stiffening: f64,
    pub(super) at: Arc<AtPlace>,
}

impl NodalCompliance for StepFlexibility<'_> {
    fn coordinates(&self) -> usize {
        self.at.shapes.nrows()
    }

    fn terms(&self) -> Terms<'_> {
        let AtPlace { half, shapes, .. } = &*self.at;
        Terms { matrix: self.compliance, factor: 1.0 / self.stiffening, product: Some([half, shapes]) }
    }
}

impl Flexible for StepFlexibility<'_> {
    fn kept(&self) -> &Mat<f64> {
        self.at.flexibility.get_or_init(|| {
            let size = self.coordinates();
            let mut all = Mat::from_fn(size, size, |row, column| {
                if row < self.contact && column < self.contact {
                    self.compliance[(row, column)] / self.stiffening
                } else {
                    0.0
                }
            });
            let (half, shapes) = (self.at.half.as_ref(), self.at.shapes.transpose());
            matmul(all.as_mut(), Accum::Add, half, shapes, 1.0, Par::Seq);
            all
        })
    }

    fn under(&self, rows: &[usize], forces: &[(usize, f64)]) -> Vec<f64> {
        let contact = self.contact;
        let on_all = self.at.on_all(&in_runs(forces.iter().copied()));
        let on_nodes = in_runs(forces.iter().copied().filter(|(row, _)| *row < contact));
        let mut moved = Vec::with_capacity(rows.len());
        // rows of neighbouring nodes at once, with those between them
        for run in in_runs(rows.iter().map(|&row| (row, 0.0))) {
            let Range { start, end } = run.rows;
            let mut all = run.forces;
            add_product(self.at.half.subrows(start, end - start), on_all.as_slice(), 1.0, &mut all);
            let of_nodes = start..end.min(contact);
            for Load { rows, forces } in on_nodes.iter().filter(|_| !of_nodes.is_empty()) {
                let part = self.compliance.submatrix(start, rows.start, of_nodes.len(), rows.len());
                add_product(part, forces, 1.0 / self.stiffening, &mut all[..of_nodes.len()]);
            }
            let wanted = rows[moved.len()..].iter().take_while(|row| run.rows.contains(row));
            let wanted: Vec<f64> = wanted.map(|row| all[row - start]).collect();
            moved.extend(wanted);
        }
        moved
    }

    fn place(&self) -> Option<&Arc<AtPlace>> {
        Some(&self.at)
    }

    fn beyond(&self, other: &Arc<AtPlace>, forces: &[(usize, f64)]) -> Vec<f64> {
        let mut moved = vec![0.0; self.coordinates()];
        if Arc::ptr_eq(&self.at, other) {
            return moved;
        }
        let loads = in_runs(forces.iter().copied());
        for (at, sign) in [(&self.at, 1.0), (other, -1.0)] {
            add_product(at.half.as_ref(), at.on_all(&loads).as_slice(), sign, &mut moved);
        }
        moved
    }
}
