//! Contact on a fine grid: half-spaces nearby, and what the bodies are beyond them interpolated from the nodes of their
//! meshes.

use super::near_field::NearField;
use super::operator::ComplianceOperator;
use super::point::ALONG;
use crate::superelement::add_times;
use faer::Mat;
use nalgebra::Vector2;
use std::sync::{Arc, OnceLock};

/// Share of a fine point in a coarse one.
#[derive(Debug, Clone, Copy, Default)]
pub struct Share {
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
pub type Shares = [Share; 4];

/// A far field between points in use serves for some of them, if it has at most so many times as many.
const MORE: usize = 2;

/// Compliance `N + P·D·Pᵀ` of the points of a fine grid: half-spaces N between them, and the far field D of the bodies
/// between coarse points, with the bilinear interpolation P from these to the fine ones. Where the far field has lateral directions, P
/// turns them with the profile, so that the forces keep their resultant; with the normal one alone it cannot.
pub struct Hybrid {
    near: NearField,
    far: Arc<Far>,
    /// Directions of D that count: the first, with the lateral one, or all.
    far_directions: usize,
    /// How many coarse points there are.
    coarse_points: usize,
    /// With the places among the coarse points in use.
    shares: Arc<Vec<Shares>>,
    diagonal: Vec<f64>,
    /// The mirror image of each coarse point, where the far field is its own mirror image along the track.
    twins: Option<Arc<Vec<Option<usize>>>>,
}

/// A far field between the coarse points in which there are shares.
struct Far {
    /// D between them, `direction·(number of these) + place among these`, m/N: with the normal direction, or with all.
    matrix: Mat<f64>,
    /// Their numbers among all coarse points, ascending.
    used: Vec<usize>,
    /// That of half of the points, made when it is wanted; none where a mirror image is missing.
    half: OnceLock<Option<Arc<Far>>>,
}

impl Far {
    fn new(matrix: Mat<f64>, used: Vec<usize>) -> Self {
        Self { matrix, used, half: OnceLock::new() }
    }

    /// Between the points in the middle and ahead of it, where a force is what a point carries together with its mirror image. It is the mean of both sides, which are
    /// alike but for rounding. Points come line by line, so that those ahead follow their `twins`.
    fn half(&self, twins: &[Option<usize>]) -> Option<Arc<Self>> {
        let make = || {
            let m = self.used.len();
            let place = |point: usize| self.used.binary_search(&point).ok();
            let ahead: Vec<(usize, usize)> = (0..m)
                .filter_map(|at| Some((at, place(twins[self.used[at]]?)?)))
                .filter(|(at, twin)| twin <= at)
                .collect();
            let n = ahead.len();
            let directions = self.matrix.nrows().checked_div(m)?;
            // rows of a point and of its mirror image, and the sign of what that has
            let row = |row: usize| {
                let (d, (ahead, behind)) = (row / n, ahead[row % n]);
                (d * m + ahead, d * m + behind, if d == ALONG { -1.0 } else { 1.0 })
            };
            let rows: Vec<_> = (0..directions * n).map(row).collect();
            let mut half = Mat::zeros(rows.len(), rows.len());
            for (c, (ahead, behind, sign)) in rows.iter().enumerate() {
                let [ahead, behind] = [*ahead, *behind].map(|column| self.matrix.col_as_slice(column));
                let of = |row: usize| ahead[row] + sign * behind[row];
                let values = half.col_as_slice_mut(c).iter_mut().zip(&rows);
                // nothing in the middle moves along the track: the two cancel
                values.for_each(|(value, (ahead, behind, sign))| {
                    *value = 0.25 * (of(*ahead) + sign * of(*behind));
                });
            }
            Some(Arc::new(Self::new(half, ahead.iter().map(|(at, _)| self.used[*at]).collect())))
        };
        self.half.get_or_init(make).clone()
    }

    /// Between some of the points, by their places among them, in its first `directions`.
    fn part(&self, places: &[usize], directions: usize) -> Self {
        let used = places.iter().map(|&place| self.used[place]).collect();
        Self::new(between(&self.matrix, self.used.len(), places, directions), used)
    }
}

/// ROUNDOFF: a share of a point in the middle in what lies behind it.
const NO_SHARE: f64 = 1e-9;

impl Hybrid {
    /// The `far` field has the directions of the half-spaces. What was `known` of it serves again where that has all points that are needed,
    /// and few more.
    pub fn new(near: NearField, far: &Mat<f64>, mut shares: Vec<Shares>, known: Option<&Self>) -> Self {
        let directions = near.rows().checked_div(shares.len()).unwrap_or(1);
        let coarse_points = far.nrows() / directions;
        let there = used_in(&shares, coarse_points);
        let serves = |known: &&Self| {
            let used = &known.far.used;
            let all = || there.iter().all(|point| used.binary_search(point).is_ok());
            known.far_directions == directions && used.len() <= MORE * there.len() && all()
        };
        let far = match known.filter(serves) {
            Some(known) => known.far.clone(),
            None => Arc::new(Far::new(between(far, coarse_points, &there, directions), there)),
        };
        number(&mut shares, &far.used, coarse_points);
        let mut hybrid = Self {
            near,
            far,
            far_directions: directions,
            coarse_points,
            shares: Arc::new(shares),
            diagonal: Vec::new(),
            twins: None,
        };
        hybrid.diagonal =
            (0..hybrid.rows()).map(|row| hybrid.near.value(row, row) + hybrid.far_diagonal(row)).collect();
        hybrid
    }

    /// The same with a far field that is its own mirror image along the track, where there are the mirror images of its points.
    #[must_use]
    pub fn mirrored(mut self, twins: Option<Arc<Vec<Option<usize>>>>) -> Self {
        self.twins = twins;
        self
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
        self.far_directions > 1
    }

    /// The compliance between some of the `points`.
    fn part(&self, points: &[usize]) -> Self {
        let (n, directions) = (self.points(), self.directions());
        let mut shares: Vec<Shares> = points.iter().map(|&j| self.shares[j]).collect();
        let used = used_in(&shares, self.far.used.len());
        number(&mut shares, &used, self.far.used.len());
        Self {
            near: self.near.between(points),
            far: Arc::new(self.far.part(&used, self.far_directions)),
            far_directions: self.far_directions,
            coarse_points: self.coarse_points,
            shares: Arc::new(shares),
            diagonal: (0..directions)
                .flat_map(|d| points.iter().map(move |&j| self.diagonal[d * n + j]))
                .collect(),
            twins: None,
        }
    }

    /// The compliance between the points `ahead` and in the middle, each with its mirror image.
    fn half_of(&self, ahead: &[usize]) -> Option<Self> {
        let twins = self.twins.as_ref()?;
        let near = self.near.half(ahead)?;
        let far = self.far.half(twins)?;
        let mut shares: Vec<Shares> = ahead.iter().map(|&j| self.shares[j]).collect();
        for share in shares.iter_mut().flatten() {
            let point = self.far.used[share.point];
            share.point = match far.used.binary_search(&point) {
                Ok(place) => place,
                Err(_) if share.weight.abs() < NO_SHARE => 0,
                Err(_) => return None,
            };
        }
        let mut half = Self {
            near,
            far,
            far_directions: self.far_directions,
            coarse_points: self.coarse_points,
            shares: Arc::new(shares),
            diagonal: Vec::new(),
            twins: None,
        };
        half.diagonal =
            (0..half.rows()).map(|row| half.near.value(row, row) + half.far_diagonal(row)).collect();
        Some(half)
    }

    /// Fine forces carried to all coarse points.
    pub fn carried(&self, forces: &[f64]) -> Vec<f64> {
        let mut coarse = vec![0.0; self.far_directions * self.coarse_points];
        for (row, force) in self.carried_to_used(forces).into_iter().enumerate() {
            coarse[self.whole_row(row)] = force;
        }
        coarse
    }

    /// Row of all coarse points of one of those in use.
    fn whole_row(&self, row: usize) -> usize {
        let m = self.far.used.len();
        row / m * self.coarse_points + self.far.used[row % m]
    }

    /// Fine forces carried to the coarse points in use.
    fn carried_to_used(&self, forces: &[f64]) -> Vec<f64> {
        let (n, m) = (self.points(), self.far.used.len());
        let (three, turns) = (self.directions() == 3, self.turns());
        let mut coarse = vec![0.0; self.far_directions * m];
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
        let (direction, points) = (row / n, self.far.used.len());
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

    /// The far field's value of a row alone; it is symmetric.
    fn far_diagonal(&self, row: usize) -> f64 {
        let mut found = [(0, 0.0); 8];
        let mut count = 0;
        for share in self.coarse(row).filter(|(_, weight)| *weight != 0.0) {
            found[count] = share;
            count += 1;
        }
        let weights = &found[..count];
        let mut sum = 0.0;
        for (n, &(c, weight)) in weights.iter().enumerate() {
            let column = self.far.matrix.col_as_slice(c);
            let before: f64 = weights[..n].iter().map(|&(r, other)| other * column[r]).sum();
            sum += weight * (2.0 * before + weight * column[c]);
        }
        sum
    }

    /// Far displacements of the coarse points in use under `forces` on them.
    fn far_motion(&self, forces: &[f64]) -> Vec<f64> {
        let m = forces.len();
        let mut motion = vec![0.0; m];
        // with the directions that count
        add_times(self.far.matrix.submatrix(0, 0, m, m), forces, &mut motion);
        motion
    }

    /// Adds what the points move by with the coarse ones, by direction and point; `of` is asked for those in use, by direction
    /// and number.
    pub fn interpolate(&self, of: impl Fn(usize, usize) -> f64, motion: &mut [f64]) {
        let used = &self.far.used;
        let m = used.len();
        let of_used: Vec<f64> = (0..self.far_directions * m).map(|row| of(row / m, used[row % m])).collect();
        self.interpolate_used(&of_used, motion);
    }

    /// The same with the coarse points in use.
    fn interpolate_used(&self, coarse: &[f64], motion: &mut [f64]) {
        let (n, m) = (self.points(), self.far.used.len());
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

    /// P·D: what the far field does to `rows`, by the rows of the far field in which they have shares.
    fn spread(&self, rows: &[usize]) -> Vec<Option<Vec<f64>>> {
        let shares: Vec<Vec<(usize, f64)>> = rows.iter().map(|&row| self.coarse(row).collect()).collect();
        let mut spread = vec![None; self.far_directions * self.far.used.len()];
        for (k, _) in rows.iter().flat_map(|&row| self.coarse(row)) {
            spread[k].get_or_insert_with(|| {
                let far = self.far.matrix.col_as_slice(k);
                shares.iter().map(|share| share.iter().map(|&(l, weight)| weight * far[l]).sum()).collect()
            });
        }
        spread
    }
}

/// Those of so many coarse points in which there are shares, ascending.
fn used_in(shares: &[Shares], coarse_points: usize) -> Vec<usize> {
    let mut there = vec![false; coarse_points];
    shares.iter().flatten().for_each(|share| there[share.point] = true);
    (0..coarse_points).filter(|&point| there[point]).collect()
}

/// Gives the coarse points of `shares`, some of so many, their numbers among those in use.
fn number(shares: &mut [Shares], used: &[usize], coarse_points: usize) {
    let mut place = vec![0; coarse_points];
    used.iter().enumerate().for_each(|(number, &point)| place[point] = number);
    shares.iter_mut().flatten().for_each(|share| share.point = place[share.point]);
}

/// A far field of so many coarse points between some of them, in its first `directions`.
fn between(far: &Mat<f64>, coarse_points: usize, some: &[usize], directions: usize) -> Mat<f64> {
    let rows: Vec<usize> =
        (0..directions).flat_map(|d| some.iter().map(move |point| d * coarse_points + point)).collect();
    let mut part = Mat::zeros(rows.len(), rows.len());
    for (c, &column) in rows.iter().enumerate() {
        let from = far.col_as_slice(column);
        let mut to = part.col_as_slice_mut(c);
        // neighbours at once
        for run in rows.chunk_by(|a, b| *b == a + 1) {
            let (values, rest) = to.split_at_mut(run.len());
            values.copy_from_slice(&from[run[0]..][..run.len()]);
            to = rest;
        }
    }
    part
}

impl ComplianceOperator for Hybrid {
    fn rows(&self) -> usize {
        self.near.rows()
    }

    fn among(&self, points: &[usize]) -> Option<Box<dyn ComplianceOperator + '_>> {
        Some(Box::new(self.part(points)))
    }

    fn normal(&self) -> Option<Box<dyn ComplianceOperator + '_>> {
        Some(Box::new(Self {
            near: self.near.in_normal_direction(),
            far: self.far.clone(),
            // the normal forces have shares in the lateral direction of the coarse points
            far_directions: self.far_directions.min(2),
            coarse_points: self.coarse_points,
            shares: self.shares.clone(),
            diagonal: self.diagonal[..self.points()].to_vec(),
            twins: self.twins.clone(),
        }))
    }

    fn nearly_inverse(&self, direction: usize, motion: &[f64]) -> Option<Vec<f64>> {
        self.near.nearly_inverse(direction, motion)
    }

    fn half(&self, ahead: &[usize]) -> Option<Box<dyn ComplianceOperator + '_>> {
        Some(Box::new(self.half_of(ahead)?))
    }

    fn diagonal(&self, row: usize) -> f64 {
        self.diagonal[row]
    }

    fn add_product(&self, forces: &[f64], motion: &mut [f64]) {
        self.near.add_product(forces, motion);
        self.interpolate_used(&self.far_motion(&self.carried_to_used(forces)), motion);
    }

    fn add_column(&self, row: usize, force: f64, motion: &mut [f64]) {
        self.near.add_column(row, force, motion);
        let mut coarse = vec![0.0; self.far_directions * self.far.used.len()];
        self.coarse(row).for_each(|(c, weight)| coarse[c] += weight * force);
        self.interpolate_used(&self.far_motion(&coarse), motion);
    }

    fn block(&self, rows: &[usize]) -> Mat<f64> {
        let m = rows.len();
        let values = self.near.values(rows);
        let spread = self.spread(rows);
        let mut block = Mat::zeros(m, m);
        for c in 0..m {
            let column = &mut block.col_as_slice_mut(c)[c..];
            for (k, weight) in self.coarse(rows[c]) {
                let spread = spread[k].iter().flat_map(|spread| &spread[c..]);
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
            let hybrid = Hybrid::new(near, &far, shares, None);
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
