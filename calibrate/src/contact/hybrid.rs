//! Contact on a fine grid: half-spaces nearby, and what the bodies are beyond them interpolated from the nodes of their
//! meshes.

use super::near_field::NearField;
use super::operator::ComplianceOperator;
use faer::Mat;
use nalgebra::Vector2;
use std::sync::Arc;

/// Share of a fine point in a coarse one.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Share {
    /// The coarse point.
    pub point: usize,
    /// Its weight.
    pub weight: f64,
    /// Cosine and sine of the angle from the coarse point's normal to the fine one's, towards the lateral tangent.
    pub turn: Vector2<f64>,
}

impl Share {
    /// A share by the normals (y, z) of both points.
    pub fn new(point: usize, weight: f64, coarse: &Vector2<f64>, fine: &Vector2<f64>) -> Self {
        Self { point, weight, turn: Vector2::new(fine.dot(coarse), fine.y * coarse.x - fine.x * coarse.y) }
    }
}

/// Shares of a fine point in the coarse points around it.
pub(crate) type Shares = [Share; 4];

/// Compliance `N + P·D·Pᵀ` of the points of a fine grid: half-spaces N between them, and the far field D of the bodies
/// between coarse points, with the bilinear interpolation P from these to the fine ones. Where the far field has lateral directions, P
/// turns them with the profile, so that the forces keep their resultant; with the normal one alone it cannot.
pub(crate) struct Hybrid {
    near: NearField,
    /// D, `direction·coarse points + coarse point`, m/N: with the normal direction, with that and the lateral one, or with all.
    far: Arc<Mat<f64>>,
    coarse_points: usize,
    shares: Vec<Shares>,
    diagonal: Vec<f64>,
}

impl Hybrid {
    /// The far field has the directions of the half-spaces.
    pub fn new(near: NearField, far: Arc<Mat<f64>>, shares: Vec<Shares>) -> Self {
        let directions = near.rows().checked_div(shares.len()).unwrap_or(1);
        let coarse_points = far.nrows() / directions;
        let mut hybrid = Self { near, far, coarse_points, shares, diagonal: Vec::new() };
        hybrid.diagonal =
            (0..hybrid.rows()).map(|row| hybrid.near.value(row, row) + hybrid.far_value(row, row)).collect();
        hybrid
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.shares.len()
    }

    /// The half-spaces alone.
    pub fn near(&self) -> &NearField {
        &self.near
    }

    /// Number of unknowns a point.
    fn directions(&self) -> usize {
        self.rows().checked_div(self.points()).unwrap_or(1)
    }

    /// Whether the far field has lateral directions.
    fn turns(&self) -> bool {
        self.far.nrows() > self.coarse_points
    }

    /// The compliance between some of the `points` in their first `directions`, with the coarse points alone in which these have a
    /// share.
    fn part(&self, points: &[usize], directions: usize) -> Self {
        let n = self.points();
        let mut place = vec![None; self.coarse_points];
        let mut used = Vec::new();
        let mut shares: Vec<Shares> = points.iter().map(|&j| self.shares[j]).collect();
        for share in shares.iter_mut().flatten() {
            share.point = *place[share.point].get_or_insert_with(|| {
                used.push(share.point);
                used.len() - 1
            });
        }
        let m = used.len();
        let row = |r: usize| r / m * self.coarse_points + used[r % m];
        let coarse_directions = if self.turns() { directions.max(2) } else { 1 };
        let far =
            Mat::from_fn(coarse_directions * m, coarse_directions * m, |r, c| self.far[(row(r), row(c))]);
        let diagonal =
            (0..directions).flat_map(|d| points.iter().map(move |&j| self.diagonal[d * n + j])).collect();
        let near = self.near.between(points, directions);
        Self { near, far: Arc::new(far), coarse_points: m, shares, diagonal }
    }

    /// Fine forces carried to the coarse points.
    pub fn carried(&self, forces: &[f64]) -> Vec<f64> {
        let (n, m) = (self.points(), self.coarse_points);
        let (three, turns) = (self.directions() == 3, self.turns());
        let mut coarse = vec![0.0; self.far.nrows()];
        for (j, shares) in self.shares.iter().enumerate() {
            let normal = forces[j];
            let [lateral, along] = if three { [forces[n + j], forces[2 * n + j]] } else { [0.0; 2] };
            if normal == 0.0 && lateral == 0.0 && along == 0.0 {
                continue;
            }
            for Share { point, weight, turn } in shares {
                if !turns {
                    coarse[*point] += weight * normal;
                    continue;
                }
                coarse[*point] += weight * (turn.x * normal - turn.y * lateral);
                coarse[m + point] += weight * (turn.x * lateral + turn.y * normal);
                if three {
                    coarse[2 * m + point] += weight * along;
                }
            }
        }
        coarse
    }

    /// Rows of the far field with the weights of a row of the fine grid.
    fn coarse(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let n = self.shares.len();
        let (direction, points) = (row / n, self.coarse_points);
        let turns = self.turns() && direction < 2;
        let mut found = [(0, 0.0); 8];
        for (k, Share { point, weight, turn }) in self.shares[row % n].iter().enumerate() {
            found[k] = (direction * points + point, weight * if turns { turn.x } else { 1.0 });
            if turns {
                // the normal has the sine of the coarse tangent, the tangent minus that of the coarse normal
                let across = if direction == 0 { turn.y } else { -turn.y };
                found[4 + k] = ((1 - direction) * points + point, weight * across);
            }
        }
        found.into_iter().take(if turns { 8 } else { 4 })
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

    /// Adds what the points move by with the coarse ones, both by direction and point.
    pub fn interpolate(&self, coarse: &[f64], motion: &mut [f64]) {
        let (n, m) = (self.points(), self.coarse_points);
        let (three, turns) = (self.directions() == 3, self.turns());
        for (j, shares) in self.shares.iter().enumerate() {
            for Share { point, weight, turn } in shares {
                if !turns {
                    motion[j] += weight * coarse[*point];
                    continue;
                }
                let [normal, lateral] = [coarse[*point], coarse[m + point]];
                motion[j] += weight * (turn.x * normal + turn.y * lateral);
                if three {
                    motion[n + j] += weight * (turn.x * lateral - turn.y * normal);
                    motion[2 * n + j] += weight * coarse[2 * m + point];
                }
            }
        }
    }
}

impl ComplianceOperator for Hybrid {
    fn rows(&self) -> usize {
        self.near.rows()
    }

    fn among(&self, points: &[usize]) -> Option<Box<dyn ComplianceOperator + '_>> {
        Some(Box::new(self.part(points, self.directions())))
    }

    fn normal(&self) -> Option<Box<dyn ComplianceOperator + '_>> {
        let all: Vec<usize> = (0..self.points()).collect();
        Some(Box::new(self.part(&all, 1)))
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
        let coarse = self.far_motion(self.coarse(row).map(|(c, weight)| (c, weight * force)));
        self.interpolate(&coarse, motion);
    }

    fn block(&self, rows: &[usize]) -> Mat<f64> {
        let m = rows.len();
        let values = self.near.values(rows);
        let shares: Vec<Vec<(usize, f64)>> = rows.iter().map(|&row| self.coarse(row).collect()).collect();
        // P·D, of the coarse rows that are used
        let mut spread: Vec<Option<Vec<f64>>> = vec![None; self.far.nrows()];
        for &(k, _) in shares.iter().flatten() {
            spread[k].get_or_insert_with(|| {
                let far = self.far.col_as_slice(k);
                shares.iter().map(|share| share.iter().map(|&(l, weight)| weight * far[l]).sum()).collect()
            });
        }
        let mut block = Mat::zeros(m, m);
        for c in 0..m {
            let column = &mut block.col_as_slice_mut(c)[c..];
            for (k, weight) in &shares[c] {
                let spread = spread[*k].iter().flat_map(|spread| &spread[c..]);
                column.iter_mut().zip(spread).for_each(|(value, far)| *value += weight * far);
            }
            column.iter_mut().enumerate().for_each(|(r, value)| *value += values.at(c + r, c));
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
    use super::super::half_space::HalfSpace;
    use super::super::point::flat_grid;
    use super::*;
    use crate::solid::Material;

    /// Source: `N + P·D·Pᵀ` written out. Goal: diagonal, blocks, columns and products of the operator, those among some of
    /// its points, and those of the normal rows, are all of this one matrix. Accuracy over the largest: ROUNDOFF.
    #[test]
    fn all_parts_are_of_one_matrix() {
        const ROUNDOFF: f64 = 1e-12;
        let points = flat_grid((6, 5), 1e-3, |_, _| 0.0);
        let (n, coarse_points) = (points.len(), 7);
        let body = HalfSpace::both(&Material::STEEL)[0];
        for directions in [1, 3] {
            let near = NearField::new(&[body], &points, directions);
            let far = Mat::from_fn(directions * coarse_points, directions * coarse_points, |i, j| {
                1e-10 * (1.0 + ((i + 1) * (j + 1) % 13) as f64)
            });
            let share = |j: usize| -> Shares {
                std::array::from_fn(|k| {
                    let angle = 0.1 * (j % 4) as f64 - 0.2 * k as f64;
                    let (fine, coarse) = (Vector2::new(angle.sin(), -angle.cos()), Vector2::new(0.0, -1.0));
                    Share::new((j + 2 * k) % coarse_points, 0.1 * (k + j % 3) as f64, &coarse, &fine)
                })
            };
            let shares: Vec<Shares> = (0..n).map(share).collect();
            let rows = directions * n;
            // P by world axes: the direction of a row in those of the coarse points
            let mut spread = Mat::<f64>::zeros(rows, directions * coarse_points);
            for row in 0..rows {
                for (k, share) in shares[row % n].iter().enumerate() {
                    let angle = 0.1 * (row % n % 4) as f64 - 0.2 * k as f64;
                    let turned = match row / n {
                        _ if directions == 1 => [1.0, 0.0, 0.0],
                        0 => [angle.cos(), angle.sin(), 0.0],
                        1 => [-angle.sin(), angle.cos(), 0.0],
                        _ => [0.0, 0.0, 1.0],
                    };
                    for d in 0..directions {
                        spread[(row, d * coarse_points + share.point)] += share.weight * turned[d];
                    }
                }
            }
            let far_part = &spread * &far * spread.transpose();
            let matrix = Mat::from_fn(rows, rows, |r, c| near.value(r, c) + far_part[(r, c)]);
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
            let few: Vec<usize> = (0..n).filter(|j| j % 4 == 1).collect();
            let of_few = (0..directions).flat_map(|d| few.iter().map(move |j| d * n + j)).collect();
            let parts: [(_, Vec<usize>); 2] =
                [(hybrid.among(&few).unwrap(), of_few), (hybrid.normal().unwrap(), (0..n).collect())];
            for (part, rows) in parts {
                let forces: Vec<f64> = rows.iter().map(|&row| forces[row]).collect();
                let mut product = vec![0.0; rows.len()];
                part.add_product(&forces, &mut product);
                let all: Vec<usize> = (0..rows.len()).collect();
                let block = part.block(&all);
                for (r, &row) in rows.iter().enumerate() {
                    let exact: f64 = rows.iter().zip(&forces).map(|(&c, f)| matrix[(row, c)] * f).sum();
                    assert!((product[r] - exact).abs() < tolerance, "{row}");
                    assert!((part.diagonal(r) - matrix[(row, row)]).abs() < tolerance);
                    for (c, &column) in rows.iter().enumerate() {
                        assert!((block[(r, c)] - matrix[(row, column)]).abs() < tolerance, "{row} {column}");
                    }
                }
            }
        }
    }
}
