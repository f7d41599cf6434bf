//! Half of a contact that is its own mirror image along the track.
//!
//! A wheel that stands in the middle of its rail has the same gaps before and behind, and so the same forces; those along the track are opposite. The points
//! behind are then no unknowns of their own. The dense factors between points have an eighth of the work, and all vectors half the length.
//!
//! The unknown of a point is what it carries together with its twin, `q = w·f` with `w = 2`, and `w = 1` on the middle line. Its compliance
//! `C' = (C(point, point) ± C(point, twin))/2` is symmetric, its friction bound is that of both, and the hub takes `q` as it is.

use super::operator::ComplianceOperator;
use super::point::{ALONG, ContactPoint};
use super::state::{Problem, Solution};

/// Part of the largest gap or slip by which those of twins may differ: what condensed bodies that are alike but for their last digits leave of slips. The difference
/// acts on both sides the opposite way, so that forces and hub have the square of it.
const ALIKE: f64 = 1e-5;

/// Half of the points of a contact.
pub(super) struct Halves<'a> {
    /// The points in the middle and ahead of it.
    pub points: Vec<ContactPoint>,
    /// Their gaps and slips, as in [`Problem::free`].
    pub free: Vec<f64>,
    /// The compliance between them, each with its twin.
    pub compliance: Box<dyn ComplianceOperator + 'a>,
    /// Which these are among all, and how many all are.
    twins: Vec<Twins>,
    all: usize,
    directions: usize,
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

impl<'a> Halves<'a> {
    /// Half of a problem whose compliance is its own mirror image; none where points, gaps or slips are not, or where the hub moves along the track.
    pub fn of(problem: &Problem<'a>) -> Option<Self> {
        let Problem { points, compliance, free, hub, .. } = problem;
        let directions = free.len().checked_div(points.len())?;
        if hub.iter().any(|free| free.along.x != 0.0) {
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
        if !are_images(&twins, (directions, count), free) {
            return None;
        }
        let ahead: Vec<usize> = twins.iter().map(|twins| twins.ahead).collect();
        let half = Self {
            points: ahead.iter().map(|&j| points[j].clone()).collect(),
            free: Vec::new(),
            compliance: compliance.half(&ahead)?,
            twins,
            all: count,
            directions,
        };
        Some(Self { free: half.half(free), ..half })
    }

    /// The problem of the half, of that of `all` points.
    pub fn problem<'h>(&'h self, all: &Problem<'h>) -> Problem<'h> {
        Problem { points: &self.points, compliance: &*self.compliance, free: &self.free, ..*all }
    }

    /// Whether values of all points, by direction and point, are their own mirror image.
    pub fn are_of(&self, values: &[f64]) -> bool {
        are_images(&self.twins, (self.directions, self.all), values)
    }

    /// Values of the half, by direction and point, of those of all points.
    pub fn half(&self, values: &[f64]) -> Vec<f64> {
        let count = values.len() / self.directions;
        let of = |d: usize| self.twins.iter().map(move |twins| values[d * count + twins.ahead]);
        (0..self.directions).flat_map(of).collect()
    }

    /// The unknowns of the half for `forces` of all points.
    pub fn carried(&self, forces: &[f64]) -> Vec<f64> {
        let mut carried = self.half(forces);
        let weights = self.twins.iter().map(|twins| twins.weight()).cycle();
        carried.iter_mut().zip(weights).for_each(|(force, weight)| *force *= weight);
        carried
    }

    /// Values of all points of those of the half, divided by the weight of each point where they are `shared`.
    pub fn whole(&self, half: &[f64], shared: bool) -> Vec<f64> {
        let (count, n) = (self.all, self.twins.len());
        let mut whole = vec![0.0; self.directions * count];
        for d in 0..self.directions {
            for (j, twins) in self.twins.iter().enumerate() {
                let value = half[d * n + j] / if shared { twins.weight() } else { 1.0 };
                whole[d * count + twins.behind] = if d == ALONG { -value } else { value };
                // along the track nothing moves in the middle
                whole[d * count + twins.ahead] = if d == ALONG && twins.is_middle() { 0.0 } else { value };
            }
        }
        whole
    }

    /// A solution of all points of that of the half.
    pub fn solution(&self, half: Solution) -> Solution {
        let mut modes = vec![half.modes[0]; self.all];
        for (twins, mode) in self.twins.iter().zip(&half.modes) {
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
            modes: self.twins.iter().map(|twins| whole.modes[twins.ahead]).collect(),
            hub: whole.hub.clone(),
            iterations: whole.iterations,
        }
    }
}

/// Whether values in so many directions of all points, so many, are their own mirror image.
fn are_images(twins: &[Twins], (directions, count): (usize, usize), values: &[f64]) -> bool {
    let largest = values.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
    let odd = |d: usize, twins: &Twins| {
        let sign = if d == ALONG { -1.0 } else { 1.0 };
        (values[d * count + twins.ahead] - sign * values[d * count + twins.behind]).abs()
    };
    (0..directions).all(|d| twins.iter().all(|twins| odd(d, twins) <= ALIKE * largest))
}

#[cfg(test)]
mod tests {
    use super::super::solver::{FreeDirection, hub_response, solve, solve_held};
    use super::super::{Hybrid, NearField, Share, flat_grid, gaps, half_space::HalfSpace};
    use super::*;
    use crate::solid::Material;
    use faer::Mat;
    use nalgebra::{Unit, Vector2, Vector3};
    use std::sync::Arc;

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
        /// The same of forces whose points alone would change by 1e-6.
        const HELD: f64 = 1e-4;
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
            let twins = (0..21).map(|node| Some(node / 7 * 7 + 6 - node % 7)).collect();
            let (whole, mirrored) = (hybrid(), hybrid().mirrored(Some(Arc::new(twins))));
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
            // the normal forces alone, with the hub held where it came to
            let mut pressed = gaps(&points);
            pressed.iter_mut().zip(&points).for_each(|(gap, point)| *gap += point.normal.y * exact.hub[0]);
            let [whole_held, half_held] = [&whole, &mirrored].map(|hybrid| {
                let compliance = hybrid.normal().unwrap();
                let problem = Problem {
                    points: &points,
                    compliance: &*compliance,
                    free: &pressed,
                    friction: 0.0,
                    hub: &[],
                };
                assert_eq!(Halves::of(&problem).is_some(), std::ptr::eq(hybrid, &mirrored));
                solve_held(&problem, &vec![0.0; n], 1e-6).unwrap()
            });
            assert!(differ(&half_held, &whole_held) < HELD, "{}", differ(&half_held, &whole_held));
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
