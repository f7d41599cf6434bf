//! What the contact nodes of a body move by under a load.

use crate::contact::{ContactPoint, Side};
use crate::superelement::{add_times, image_along, sign_along};
use faer::Mat;
use std::sync::OnceLock;

/// Displacements of the contact nodes of a body under forces on them. A patch asks for few lines of its grid, so that each line is found when it is asked for.
pub(super) struct NodalMotion {
    /// By `3·node + axis`, N.
    forces: Vec<f64>,
    /// Nodes of a line of the grid.
    columns: usize,
    /// Whether the motion is its own mirror image along the track.
    mirrored: bool,
    /// By line along the profile, and then by `3·(node of the line) + axis`, m.
    lines: Vec<OnceLock<Vec<f64>>>,
}

impl NodalMotion {
    /// That under `forces` (`3·node + axis`, N) on a grid with so many lines along the track; the body may be its own mirror image (`mirrored`).
    pub fn new(forces: Vec<f64>, columns: usize, mirrored: bool) -> Self {
        let lines = vec![OnceLock::new(); forces.len() / (3 * columns)];
        let mirrored = mirrored && are_images(&forces[..3 * columns * lines.len()], columns);
        Self { forces, columns, mirrored, lines }
    }

    /// The displacements of a line.
    fn line(&self, body: &Mat<f64>, line: usize) -> Vec<f64> {
        let width = 3 * self.columns;
        // where its own half begins
        let own = if self.mirrored { 3 * (self.columns / 2) } else { 0 };
        let mut moved = vec![0.0; width];
        add_times(body.subrows(line * width + own, width - own), &self.forces, &mut moved[own..]);
        for behind in 0..own {
            moved[behind] = sign_along(behind) * moved[image_along(behind, self.columns)];
        }
        moved
    }

    /// Mean over the patch of a point on one `side` in a direction, m; `body` is the compliance of its contact nodes, m/N, always the same one.
    pub fn at(&self, body: &Mat<f64>, point: &ContactPoint, side: Side, direction: usize) -> f64 {
        let width = 3 * self.columns;
        let of_row = |(row, weight): (usize, f64)| {
            let line = self.lines[row / width].get_or_init(|| self.line(body, row / width));
            weight * line[row % width]
        };
        point.row(side, direction).map(of_row).sum()
    }
}

/// Part of the largest force by which mirror images may differ: the displacements then differ by as little.
const ALIKE: f64 = 1e-9;

/// Whether forces on lines of so many nodes are their own mirror image along the track.
fn are_images(forces: &[f64], columns: usize) -> bool {
    let largest = forces.iter().fold(0.0_f64, |m, force| m.max(force.abs()));
    let odd = |(at, force): (usize, &f64)| force - sign_along(at) * forces[image_along(at, columns)];
    forces.iter().enumerate().map(odd).all(|odd| odd.abs() <= ALIKE * largest)
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
        let motion = NodalMotion::new(forces, columns, false);
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

    /// Source: the same motion by all of its lines. Goal: a body that is its own mirror image along the track moves its points by the same, m, under forces that are one and under
    /// such as are none, N. Accuracy over the largest value: ROUNDOFF.
    #[test]
    fn a_half_line_is_the_whole() {
        const ROUNDOFF: f64 = 1e-13;
        let (lines, columns) = (4, 5);
        let rows = 3 * lines * columns;
        let wave = |n: usize| (1.3 * n as f64 + 0.4).sin();
        let mirror =
            |row: usize| 3 * (row / 3 / columns * columns + columns - 1 - row / 3 % columns) + row % 3;
        let sign = |row: usize| if row.is_multiple_of(3) { -1.0 } else { 1.0 };
        let any = |r: usize, c: usize| wave(r + c) + wave(r * c);
        let body = Mat::from_fn(rows, rows, |r, c| any(r, c) + sign(r) * sign(c) * any(mirror(r), mirror(c)));
        let forces: Vec<f64> = (0..rows).map(wave).collect();
        let even: Vec<f64> = (0..rows).map(|r| forces[r] + sign(r) * forces[mirror(r)]).collect();
        for (forces, is_even) in [(forces, false), (even, true)] {
            let whole = NodalMotion::new(forces.clone(), columns, false);
            let found = NodalMotion::new(forces, columns, true);
            assert_eq!(found.mirrored, is_even);
            for line in 0..lines {
                let exact = whole.line(&body, line);
                let largest = exact.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
                for (found, exact) in found.line(&body, line).iter().zip(&exact) {
                    assert!((found - exact).abs() < ROUNDOFF * largest, "{line}: {found} {exact}");
                }
            }
        }
    }
}
