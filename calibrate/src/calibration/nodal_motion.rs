//! What the contact nodes of a body move by under a load.

use crate::contact::{ContactPoint, Side};
use crate::superelement::add_times;
use faer::Mat;
use std::sync::OnceLock;

/// Displacements of the contact nodes of a body under forces on them. A patch asks for few lines of its grid, so that each line is found when it is asked for.
pub(super) struct NodalMotion {
    /// By `3·node + axis`, N.
    forces: Vec<f64>,
    /// Nodes of a line of the grid.
    columns: usize,
    /// By line along the profile, and then by `3·(node of the line) + axis`, m.
    lines: Vec<OnceLock<Vec<f64>>>,
}

impl NodalMotion {
    /// That under `forces` (`3·node + axis`, N) on a grid with so many lines along the track.
    pub fn new(forces: Vec<f64>, columns: usize) -> Self {
        let lines = vec![OnceLock::new(); forces.len() / (3 * columns)];
        Self { forces, columns, lines }
    }

    /// Mean over the patch of a point on one `side` in a direction, m; `body` is the compliance of its contact nodes, m/N, always the same one.
    pub fn at(&self, body: &Mat<f64>, point: &ContactPoint, side: Side, direction: usize) -> f64 {
        let width = 3 * self.columns;
        let of_row = |(row, weight): (usize, f64)| {
            let line = self.lines[row / width].get_or_init(|| {
                let mut line = vec![0.0; width];
                add_times(body.subrows(row / width * width, width), &self.forces, &mut line);
                line
            });
            weight * line[row % width]
        };
        point.row(side, direction).map(of_row).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{NodeWeight, flat_grid};
    use crate::superelement::times;
    use nalgebra::Vector2;

    /// Source: the product of the whole compliance, m/N, with the forces, N. Goal: points that have weights in several lines of a grid move as its rows say, in all
    /// directions. Accuracy over the largest value: ROUNDOFF of sums of some tens of terms in another order.
    #[test]
    fn lines_are_those_of_the_whole_product() {
        const ROUNDOFF: f64 = 1e-13;
        let (lines, columns) = (5, 4);
        let rows = 3 * lines * columns;
        let wave = |n: usize| (1.3 * n as f64 + 0.4).sin();
        let body = Mat::from_fn(rows, rows, |r, c| wave(r + c) + wave(r * c));
        let forces: Vec<f64> = (0..rows).map(|row| if row % 7 < 3 { wave(row) } else { 0.0 }).collect();
        let whole = times(&body, &forces);
        let largest = whole.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
        let motion = NodalMotion::new(forces, columns);
        let mut points = flat_grid((2, 3), 1e-3, |_, _| 0.0);
        for (j, point) in points.iter_mut().enumerate() {
            point.base = (0..4)
                .map(|k| NodeWeight {
                    node: (3 * j + 5 * k) % (lines * columns),
                    normal: Vector2::new(wave(k), wave(j)),
                    scalar: wave(j + k),
                })
                .collect();
            for direction in 0..3 {
                let exact = point.displacement(Side::Base, direction, &whole);
                let found = motion.at(&body, point, Side::Base, direction);
                assert!((found - exact).abs() < ROUNDOFF * largest, "{j} {direction}: {found} {exact}");
            }
        }
    }
}
