//! Half of a contact that is its own mirror image along the track.
//!
//! A wheel that stands in the middle of its rail has the same gaps before and behind, and so the same forces; those along the track are opposite. The points
//! behind are then no unknowns of their own. The dense factors between points have an eighth of the work, and all vectors half the length.
//!
//! The unknown of a point is what it carries together with its twin, `q = w·f` with `w = 2`, and `w = 1` on the middle line. Its compliance
//! `C' = (C(point, point) ± C(point, twin))/2` is symmetric, its friction bound is that of both, and the hub takes `q` as it is.

use super::operator::ComplianceOperator;
use super::point::ContactPoint;
use super::state::{Problem, Solution};
use faer::Mat;
use std::sync::Arc;

/// Direction along the track, in which the twin of a point has the opposite values.
const ALONG: usize = 2;
/// Part of the largest gap or slip by which those of twins may differ: what condensed bodies that are alike but for their last digits leave of slips. The difference
/// acts on both sides the opposite way, so that forces and hub have the square of it.
const ALIKE: f64 = 1e-5;

/// Half of the points of a contact.
pub(super) struct Halves {
    /// The points in the middle and ahead of it.
    pub points: Vec<ContactPoint>,
    /// Their gaps and slips, as in [`Problem::free`].
    pub free: Vec<f64>,
    /// Which these are among all.
    pairs: Arc<Pairs>,
    directions: usize,
}

/// The points of a half, each with its twin, and how many all are.
struct Pairs {
    twins: Vec<Twins>,
    all: usize,
}

/// A point and its mirror image; the same on the middle line.
#[derive(Clone, Copy)]
struct Twins {
    ahead: usize,
    behind: usize,
}

impl Twins {
    fn is_middle(self) -> bool {
        self.ahead == self.behind
    }

    /// What the point and its twin carry together, over what it carries.
    fn weight(self) -> f64 {
        if self.is_middle() { 1.0 } else { 2.0 }
    }
}

impl Halves {
    /// Half of a problem whose compliance is its own mirror image; none where points, gaps or slips are not, or where the hub moves along the track.
    pub fn of(problem: &Problem) -> Option<Self> {
        let Problem { points, free, hub, .. } = problem;
        let directions = free.len().checked_div(points.len())?;
        if !problem.compliance.is_mirrored() || hub.iter().any(|free| free.along.x != 0.0) {
            return None;
        }
        let first = points.first()?;
        // twice the number of the middle line
        let both = 2.0 * (first.index.1 as f64 - first.position.y / first.widths.y);
        let both = (both >= 0.0).then_some(both.round() as usize)?;
        let count = points.len();
        let mut twins = Vec::with_capacity(count / 2 + 1);
        for (ahead, point) in points.iter().enumerate() {
            let (line, column) = point.index;
            let twin = (line, both.checked_sub(column)?);
            let behind = points.binary_search_by_key(&twin, |point| point.index).ok()?;
            if twin.1 <= column {
                twins.push(Twins { ahead, behind });
            }
        }
        let half = Self {
            points: twins.iter().map(|twins| points[twins.ahead].clone()).collect(),
            free: Vec::new(),
            directions,
            pairs: Arc::new(Pairs { twins, all: count }),
        };
        half.are_of(free).then(|| Self { free: half.half(free), ..half })
    }

    /// The compliance of the half, of the `whole` one.
    pub fn compliance<'a>(&'a self, whole: &'a dyn ComplianceOperator) -> Mirrored<'a> {
        Mirrored { whole: Whole::Borrowed(whole), pairs: self.pairs.clone(), directions: self.directions }
    }

    /// Whether values of all points, by direction and point, are their own mirror image.
    pub fn are_of(&self, values: &[f64]) -> bool {
        let count = self.pairs.all;
        let largest = values.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
        let odd = |d: usize, twins: &Twins| {
            let sign = if d == ALONG { -1.0 } else { 1.0 };
            (values[d * count + twins.ahead] - sign * values[d * count + twins.behind]).abs()
        };
        let pairs = self.pairs.twins.iter();
        pairs
            .flat_map(|twins| (0..self.directions).map(move |d| (d, twins)))
            .all(|(d, twins)| odd(d, twins) <= ALIKE * largest)
    }

    /// Values of the half, by direction and point, of those of all points.
    pub fn half(&self, values: &[f64]) -> Vec<f64> {
        let count = values.len() / self.directions;
        let of = |d: usize| self.pairs.twins.iter().map(move |twins| values[d * count + twins.ahead]);
        (0..self.directions).flat_map(of).collect()
    }

    /// The unknowns of the half for `forces` of all points.
    pub fn carried(&self, forces: &[f64]) -> Vec<f64> {
        let mut carried = self.half(forces);
        let weights = self.pairs.twins.iter().map(|twins| twins.weight()).cycle();
        carried.iter_mut().zip(weights).for_each(|(force, weight)| *force *= weight);
        carried
    }

    /// Values of all points of those of the half, divided by the weight of each point where they are `shared`.
    pub fn whole(&self, half: &[f64], shared: bool) -> Vec<f64> {
        self.pairs.spread(self.directions, half, shared)
    }

    /// A solution of all points of that of the half.
    pub fn solution(&self, half: Solution) -> Solution {
        let mut modes = vec![half.modes[0]; self.pairs.all];
        for (twins, mode) in self.pairs.twins.iter().zip(&half.modes) {
            (modes[twins.ahead], modes[twins.behind]) = (*mode, *mode);
        }
        Solution {
            forces: self.whole(&half.forces, true),
            separation: self.whole(&half.separation, false),
            modes,
            ..half
        }
    }

    /// The half of a solution.
    pub fn half_of(&self, whole: &Solution) -> Solution {
        Solution {
            forces: self.carried(&whole.forces),
            separation: self.half(&whole.separation),
            modes: self.pairs.twins.iter().map(|twins| whole.modes[twins.ahead]).collect(),
            hub: whole.hub.clone(),
            iterations: whole.iterations,
        }
    }
}

impl Pairs {
    /// Values of all points of those of the half, divided by the weight of each point where they are `shared`.
    fn spread(&self, directions: usize, half: &[f64], shared: bool) -> Vec<f64> {
        let (count, n) = (self.all, self.twins.len());
        let mut whole = vec![0.0; directions * count];
        for d in 0..directions {
            for (j, twins) in self.twins.iter().enumerate() {
                let value = half[d * n + j] / if shared { twins.weight() } else { 1.0 };
                whole[d * count + twins.behind] = if d == ALONG { -value } else { value };
                // along the track nothing moves in the middle
                whole[d * count + twins.ahead] = if d == ALONG && twins.is_middle() { 0.0 } else { value };
            }
        }
        whole
    }
}

enum Whole<'a> {
    Borrowed(&'a dyn ComplianceOperator),
    Owned(Box<dyn ComplianceOperator + 'a>),
}

/// The compliance between the points of a half, each with its twin.
pub(super) struct Mirrored<'a> {
    whole: Whole<'a>,
    /// Their places in the rows of the whole.
    pairs: Arc<Pairs>,
    directions: usize,
}

impl Mirrored<'_> {
    fn whole(&self) -> &dyn ComplianceOperator {
        match &self.whole {
            Whole::Borrowed(whole) => *whole,
            Whole::Owned(whole) => &**whole,
        }
    }

    /// Rows of the whole for some of the half, and for their twins.
    fn rows_of(&self, rows: &[usize]) -> [Vec<usize>; 2] {
        let (n, count) = (self.pairs.twins.len(), self.pairs.all);
        let of = |place: fn(Twins) -> usize| {
            rows.iter().map(|row| row / n * count + place(self.pairs.twins[row % n])).collect()
        };
        [of(|twins| twins.ahead), of(|twins| twins.behind)]
    }

    /// Whether a row is that of a point on the middle line along the track, which does not move.
    fn rests(&self, row: usize) -> bool {
        row / self.pairs.twins.len() == ALONG && self.pairs.twins[row % self.pairs.twins.len()].is_middle()
    }
}

impl ComplianceOperator for Mirrored<'_> {
    fn rows(&self) -> usize {
        self.directions * self.pairs.twins.len()
    }

    /// Without what the twin adds, which is small beside it.
    fn diagonal(&self, row: usize) -> f64 {
        let (n, count) = (self.pairs.twins.len(), self.pairs.all);
        let twins = self.pairs.twins[row % n];
        self.whole().diagonal(row / n * count + twins.ahead) / twins.weight()
    }

    fn add_product(&self, forces: &[f64], motion: &mut [f64]) {
        let whole = self.pairs.spread(self.directions, forces, true);
        let mut moved = vec![0.0; whole.len()];
        self.whole().add_product(&whole, &mut moved);
        let (n, count) = (self.pairs.twins.len(), self.pairs.all);
        for (row, motion) in motion.iter_mut().enumerate() {
            *motion += if self.rests(row) {
                self.diagonal(row) * forces[row]
            } else {
                moved[row / n * count + self.pairs.twins[row % n].ahead]
            };
        }
    }

    fn add_column(&self, row: usize, force: f64, motion: &mut [f64]) {
        let mut forces = vec![0.0; self.rows()];
        forces[row] = force;
        self.add_product(&forces, motion);
    }

    fn block(&self, rows: &[usize]) -> Mat<f64> {
        let [ahead, behind] = self.rows_of(rows);
        let mut block = self.whole().block(&ahead);
        let of_twins = self.whole().between(&ahead, &behind);
        let n = self.pairs.twins.len();
        for (c, &column) in rows.iter().enumerate() {
            let weight = self.pairs.twins[column % n].weight();
            let sign = if column / n == ALONG { -1.0 } else { 1.0 };
            for (r, &row) in rows.iter().enumerate() {
                if self.rests(row) || self.rests(column) {
                    block[(r, c)] = if row == column { self.diagonal(row) } else { 0.0 };
                } else if weight > 1.0 {
                    block[(r, c)] = (block[(r, c)] + sign * of_twins[(r, c)]) / weight;
                }
            }
        }
        block
    }

    fn between(&self, rows: &[usize], columns: &[usize]) -> Mat<f64> {
        let mut all: Vec<usize> = rows.iter().chain(columns).copied().collect();
        all.sort_unstable();
        all.dedup();
        let block = self.block(&all);
        let place = |row: &usize| all.binary_search(row).expect("among all rows");
        Mat::from_fn(rows.len(), columns.len(), |r, c| block[(place(&rows[r]), place(&columns[c]))])
    }

    fn among(&self, points: &[usize]) -> Option<Box<dyn ComplianceOperator + '_>> {
        let mut places: Vec<usize> = points.iter().map(|&j| self.pairs.twins[j].ahead).collect();
        let mut twins = Vec::with_capacity(points.len());
        for (ahead, &j) in points.iter().enumerate() {
            let behind = if self.pairs.twins[j].is_middle() {
                ahead
            } else {
                places.push(self.pairs.twins[j].behind);
                places.len() - 1
            };
            twins.push(Twins { ahead, behind });
        }
        let whole = Whole::Owned(self.whole().among(&places)?);
        let pairs = Arc::new(Pairs { all: places.len(), twins });
        Some(Box::new(Mirrored { whole, pairs, directions: self.directions }))
    }

    fn normal(&self) -> Option<Box<dyn ComplianceOperator + '_>> {
        let whole = Whole::Owned(self.whole().normal()?);
        Some(Box::new(Mirrored { whole, pairs: self.pairs.clone(), directions: 1 }))
    }

    fn nearly_inverse(&self, direction: usize, motion: &[f64]) -> Option<Vec<f64>> {
        let mut moved = vec![0.0; self.pairs.all];
        for (value, twins) in motion.iter().zip(&self.pairs.twins) {
            moved[twins.behind] = if direction == ALONG { -value } else { *value };
            moved[twins.ahead] = *value;
        }
        let forces = self.whole().nearly_inverse(direction, &moved)?;
        Some(self.pairs.twins.iter().map(|twins| twins.weight() * forces[twins.ahead]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::super::solver::{FreeDirection, hub_response, solve};
    use super::super::{Hybrid, NearField, Share, flat_grid, gaps, half_space::HalfSpace};
    use super::*;
    use crate::solid::Material;
    use nalgebra::{Unit, Vector2, Vector3};

    /// A far field on seven lines of nodes along the track at three places across it, its own mirror image, and shares of points on a grid 1 to 7 mm wide.
    fn far_field(points: &[ContactPoint]) -> (Mat<f64>, Vec<[Share; 4]>) {
        let (across, along) = (3, 7);
        let n = across * along;
        let place = |row: usize| {
            let node = row % n;
            (row / n, (node / along) as f64, (node % along) as f64 - 3.0)
        };
        let far = Mat::from_fn(3 * n, 3 * n, |r, c| {
            let ((to, i, k), (from, l, m)) = (place(r), place(c));
            let smooth = 1e-10 / (2.0 + (i - l).powi(2) + 0.2 * (k - m).powi(2));
            match (to, from) {
                (0 | 1, 2) => 0.1 * (m - k) * smooth,
                (2, 0 | 1) => 0.1 * (k - m) * smooth,
                (a, b) if a == b => smooth,
                _ => 0.2 * smooth,
            }
        });
        let middle = points.iter().map(|point| point.index.1).max().unwrap() / 2;
        let shares = points.iter().map(|point| {
            let across = (point.index.0 as f64 / 8.0).min(1.999);
            let along = 3.0 + (point.index.1 as f64 - middle as f64) / 4.0;
            let ((i, u), (k, v)) = ((across.floor(), across.fract()), (along.floor().min(5.0), 0.0));
            let v = v + along - k;
            [(0, 0, (1.0 - u) * (1.0 - v)), (0, 1, (1.0 - u) * v), (1, 0, u * (1.0 - v)), (1, 1, u * v)].map(
                |(a, b, weight)| {
                    let node = (i as usize + a) * 7 + k as usize + b;
                    Share::new(node, weight, &Vector2::new(0.0, -1.0), &Vector2::new(0.1, -1.0).normalize())
                },
            )
        });
        (far, shares.collect())
    }

    /// Source: the same problem of all points. Goal: a contact with sticking and sliding points that is its own mirror image has the same forces (N), separations (m),
    /// modes, approach of the hub and stiffness (N/m) by its half, few points and many, with materials that couple the directions and without. One
    /// whose gaps are no mirror image is solved as a whole. Accuracy over the largest: SOLVER.
    #[test]
    fn a_half_is_the_whole() {
        /// Residual of 1e-10 of the largest force; the forces answer a hundred times as much to what all points have in common.
        const SOLVER: f64 = 2e-8;
        /// The same of forces that are solved to 1e-8.
        const RESPONSE: f64 = 1e-6;
        let soft = Material { young: 70e9, poisson: 0.2, ..Material::STEEL };
        let bodies = |other: &Material| {
            let [rail, _] = HalfSpace::both(&Material::STEEL);
            let [_, wheel] = HalfSpace::both(other);
            [rail, wheel]
        };
        for (lines, other) in [(9, Material::STEEL), (17, Material::STEEL), (17, soft)] {
            let columns = lines + 4;
            let mut points = flat_grid((lines, columns), 0.5e-3, |s, x| 0.5 * (s * s + x * x) / 0.3);
            points.iter_mut().for_each(|point| point.normal = Vector2::new(0.1, -1.0).normalize());
            let n = points.len();
            let (far, shares) = far_field(&points);
            let hybrid = || {
                let near = NearField::new(&bodies(&other), &points, 3);
                Hybrid::new(near, &far, shares.clone(), None)
            };
            let (whole, mirrored) = (hybrid(), hybrid().mirrored(true));
            let mut free = gaps(&points);
            free.resize(3 * n, 0.0);
            free[n..2 * n].fill(0.4e-6);
            let along = Unit::new_normalize(Vector3::new(0.0, 0.0, 1.0));
            let hub = [FreeDirection { along, force: -3e3 }];
            let problem =
                |compliance| Problem { points: &points, compliance, free: &free, friction: 0.3, hub: &hub };
            let start = vec![0.0; 3 * n];
            let exact = solve(&problem(&whole), &start).unwrap();
            assert!(Halves::of(&problem(&whole)).is_none() && Halves::of(&problem(&mirrored)).is_some());
            let found = solve(&problem(&mirrored), &start).unwrap();
            let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let differ = |a: &[f64], b: &[f64]| {
                a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest(b)
            };
            let slipping = exact.modes.iter().filter(|mode| **mode == super::super::PointMode::Slip).count();
            println!("{lines}: {} carry, {slipping} slip", exact.active());
            assert!(slipping > 0 && slipping < exact.active());
            assert_eq!(found.modes, exact.modes);
            assert!(
                differ(&found.forces, &exact.forces) < SOLVER,
                "{}",
                differ(&found.forces, &exact.forces)
            );
            assert!(differ(&found.separation, &exact.separation) < SOLVER);
            assert!((found.hub[0] / exact.hub[0] - 1.0).abs() < SOLVER);
            let directions = [Vector3::y_axis(), Vector3::z_axis()];
            for sticking in [false, true] {
                let [whole, half] = [problem(&whole), problem(&mirrored)]
                    .map(|problem| hub_response(&problem, &exact, &directions, sticking).unwrap());
                let over = (&whole.stiffness - &half.stiffness).amax() / whole.stiffness.amax();
                assert!(over < SOLVER, "{over}");
                for column in 0..2 {
                    let over = differ(half.forces.col_as_slice(column), whole.forces.col_as_slice(column));
                    assert!(over < RESPONSE, "{over}");
                }
            }
            // along the track the answer is no mirror image
            let [whole_along, half_along] = [problem(&whole), problem(&mirrored)]
                .map(|problem| hub_response(&problem, &exact, &[Vector3::x_axis()], true).unwrap());
            assert!((half_along.stiffness[(0, 0)] / whole_along.stiffness[(0, 0)] - 1.0).abs() < RESPONSE);
            let mut tilted = free.clone();
            tilted.iter_mut().zip(&points).for_each(|(gap, point)| *gap += 1e-4 * point.position.y);
            let tilted = Problem { free: &tilted, ..problem(&mirrored) };
            assert!(Halves::of(&tilted).is_none());
        }
    }
}
