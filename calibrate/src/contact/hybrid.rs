//! Contact on a fine grid: half-spaces nearby, and what the bodies are beyond them interpolated from the nodes of their
//! meshes.

use super::near_field::NearField;
use super::operator::ComplianceOperator;
use faer::Mat;
use std::sync::Arc;

/// Shares of a fine point in the coarse points around it; those that it has none in are zero.
pub(crate) type Shares = [(usize, f64); 4];

/// Compliance `N + P·D·Pᵀ` of the points of a fine grid: half-spaces N between them, and the far field D of the bodies
/// between coarse points, with the bilinear interpolation P from these to the fine ones.
pub(crate) struct Hybrid {
    near: NearField,
    /// D, `direction·coarse points + coarse point`, m/N.
    far: Arc<Mat<f64>>,
    shares: Vec<Shares>,
    diagonal: Vec<f64>,
}

impl Hybrid {
    pub fn new(near: NearField, far: Arc<Mat<f64>>, shares: Vec<Shares>) -> Self {
        let mut hybrid = Self { near, far, shares, diagonal: Vec::new() };
        hybrid.diagonal =
            (0..hybrid.rows()).map(|row| hybrid.near.value(row, row) + hybrid.far_value(row, row)).collect();
        hybrid
    }

    /// The half-spaces alone.
    pub fn near(&self) -> &NearField {
        &self.near
    }

    /// Fine forces carried to the coarse points.
    pub fn carried(&self, forces: &[f64]) -> Vec<f64> {
        let mut coarse = vec![0.0; self.far.nrows()];
        for (row, force) in forces.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            for (c, weight) in self.coarse(row) {
                coarse[c] += weight * force;
            }
        }
        coarse
    }

    /// Rows of the far field with the weights of a row of the fine grid.
    fn coarse(&self, row: usize) -> [(usize, f64); 4] {
        let n = self.shares.len();
        let first = row / n * (self.far.nrows() / (self.rows() / n));
        self.shares[row % n].map(|(point, weight)| (first + point, weight))
    }

    fn far_value(&self, row: usize, column: usize) -> f64 {
        let mut sum = 0.0;
        for (c, weight) in self.coarse(column) {
            for (r, other) in self.coarse(row) {
                sum += weight * other * self.far[(r, c)];
            }
        }
        sum
    }

    /// Far displacements of the coarse points under forces on them.
    fn far_motion(&self, coarse: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
        let mut motion = vec![0.0; self.far.nrows()];
        for (c, force) in coarse.filter(|(_, force)| *force != 0.0) {
            motion.iter_mut().zip(self.far.col_as_slice(c)).for_each(|(m, d)| *m += d * force);
        }
        motion
    }

    fn interpolate(&self, coarse: &[f64], motion: &mut [f64]) {
        for (row, m) in motion.iter_mut().enumerate() {
            *m += self.coarse(row).iter().map(|&(c, weight)| weight * coarse[c]).sum::<f64>();
        }
    }
}

impl ComplianceOperator for Hybrid {
    fn rows(&self) -> usize {
        self.near.rows()
    }

    fn diagonal(&self, row: usize) -> f64 {
        self.diagonal[row]
    }

    fn add_product(&self, forces: &[f64], motion: &mut [f64]) {
        self.near.add_product(forces, motion);
        let coarse = self.far_motion(self.carried(forces).into_iter().enumerate());
        self.interpolate(&coarse, motion);
    }

    fn add_column(&self, row: usize, force: f64, motion: &mut [f64]) {
        self.near.add_column(row, force, motion);
        let coarse = self.far_motion(self.coarse(row).into_iter().map(|(c, weight)| (c, weight * force)));
        self.interpolate(&coarse, motion);
    }

    fn block(&self, rows: &[usize]) -> Mat<f64> {
        let m = rows.len();
        let mut block = Mat::zeros(m, m);
        let shares: Vec<[(usize, f64); 4]> = rows.iter().map(|&row| self.coarse(row)).collect();
        let mut motion = vec![0.0; self.far.nrows()];
        for (c, &column) in rows.iter().enumerate() {
            motion.fill(0.0);
            for (k, weight) in shares[c] {
                if weight != 0.0 {
                    motion.iter_mut().zip(self.far.col_as_slice(k)).for_each(|(m, d)| *m += weight * d);
                }
            }
            let values = &mut block.col_as_slice_mut(c)[c..];
            for (value, (share, &row)) in values.iter_mut().zip(shares[c..].iter().zip(&rows[c..])) {
                let far: f64 = share.iter().map(|&(k, weight)| weight * motion[k]).sum();
                *value = far + self.near.value(row, column);
            }
        }
        for c in 0..m {
            for r in 0..c {
                block[(r, c)] = block[(c, r)];
            }
        }
        block
    }
}

#[cfg(test)]
mod tests {
    use super::super::half_space::{HalfSpace, HatTable};
    use super::super::near_field::extent;
    use super::super::point::flat_grid;
    use super::*;
    use crate::solid::Material;
    use nalgebra::Vector2;

    /// Source: `N + P·D·Pᵀ` written out. Goal: diagonal, blocks, columns and products of the operator are all of this one
    /// matrix. Accuracy over the largest: ROUNDOFF.
    #[test]
    fn all_parts_are_of_one_matrix() {
        const ROUNDOFF: f64 = 1e-12;
        let points = flat_grid((6, 5), 1e-3, |_, _| 0.0);
        let (n, coarse) = (points.len(), 7);
        let indices: Vec<(usize, usize)> = points.iter().map(|point| point.index).collect();
        let table = Arc::new(HatTable::new(Vector2::new(1e-3, 1e-3), extent(&indices)));
        let factors = HalfSpace::both(&Material::STEEL)[0].factors();
        for directions in [1, 3] {
            let near = NearField::new(table.clone(), factors, directions, &indices);
            let far = Mat::from_fn(directions * coarse, directions * coarse, |i, j| {
                1e-10 * (1.0 + ((i + 1) * (j + 1) % 13) as f64)
            });
            let share = |j: usize| -> Shares {
                std::array::from_fn(|k| ((j + 2 * k) % coarse, 0.1 * (k + j % 3) as f64))
            };
            let shares: Vec<Shares> = (0..n).map(share).collect();
            let rows = directions * n;
            let matrix = Mat::from_fn(rows, rows, |r, c| {
                let (to, from) = (r / n * coarse, c / n * coarse);
                let mut sum = near.value(r, c);
                for (i, a) in shares[r % n] {
                    for (k, b) in shares[c % n] {
                        sum += a * b * far[(to + i, from + k)];
                    }
                }
                sum
            });
            let hybrid = Hybrid::new(near, Arc::new(far), shares);
            let tolerance = ROUNDOFF * matrix[(0, 0)] * rows as f64;
            let forces: Vec<f64> = (0..rows).map(|j| (j % 5) as f64 - 2.0).collect();
            let (mut product, mut columns) = (vec![0.0; rows], vec![0.0; rows]);
            hybrid.add_product(&forces, &mut product);
            (0..rows).for_each(|row| hybrid.add_column(row, forces[row], &mut columns));
            let some: Vec<usize> = (0..rows).step_by(3).collect();
            let block = hybrid.block(&some);
            for row in 0..rows {
                let exact: f64 = (0..rows).map(|c| matrix[(row, c)] * forces[c]).sum();
                assert!((product[row] - exact).abs() < tolerance, "{row}");
                assert!((columns[row] - exact).abs() < tolerance, "{row}");
                assert!((hybrid.diagonal(row) - matrix[(row, row)]).abs() < tolerance);
            }
            for (r, &row) in some.iter().enumerate() {
                for (c, &column) in some.iter().enumerate() {
                    assert!((block[(r, c)] - matrix[(row, column)]).abs() < tolerance, "{row} {column}");
                }
            }
        }
    }
}
