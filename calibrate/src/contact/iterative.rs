//! Newton steps by products with the compliance, for more rows than are worth a dense factor.
//!
//! Y. Saad, M.H. Schultz, "GMRES: a generalized minimal residual algorithm for solving nonsymmetric linear systems",
//! SIAM J. Sci. Stat. Comput. 7 (1986), preconditioned from the right. The directions of contact are weakly coupled
//! (normal and tangential ones not at all on half-spaces of one material), so the preconditioner has a dense factor for
//! each of them, at a twenty-seventh of the work of one for all.

use super::dense::DenseFactor;
use super::state::{PointMode, State};
use faer::Mat;
use nalgebra::{Vector2, Vector3};

/// Rows from which products are faster than a dense factor.
const ROWS: usize = 450;
/// Products at most, before a dense factor takes over.
const LIMIT: usize = 60;

/// The friction cone of a sliding point, linearised: `v = τ - scale·slip` is the trial force.
pub(super) struct Cone {
    /// Direction of the trial force.
    pub unit: Vector2<f64>,
    /// Friction at the present normal force, N.
    pub limit: f64,
    /// Friction over the length of the trial force.
    turn: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

impl Cone {
    pub fn new(state: &State, j: usize) -> Self {
        let (_, v) = state.trial(j);
        let length = v.norm();
        let friction = state.problem.friction;
        let limit = friction * state.forces[j].max(0.0);
        Self {
            unit: if length > 0.0 { v / length } else { v },
            limit,
            turn: if limit > 0.0 { limit / length } else { 0.0 },
            friction,
        }
    }

    /// What a change of the trial force by (x, y) turns the friction by.
    pub fn across(&self, x: f64, y: f64) -> (f64, f64) {
        let along = self.unit.x * x + self.unit.y * y;
        (self.turn * (x - along * self.unit.x), self.turn * (y - along * self.unit.y))
    }
}

/// Linearised conditions of contact: of the load-carrying points, normal rows, then lateral ones, then those along the track,
/// and of the hub.
pub(super) struct Linearised<'a> {
    pub state: &'a State<'a>,
    pub modes: &'a [PointMode],
    /// Points that carry load.
    pub active: &'a [usize],
    /// Their rows.
    pub rows: &'a [usize],
    /// Free directions of the hub.
    pub along: &'a [Vector3<f64>],
    /// What the hub's displacement is multiplied by in its columns, m/N.
    pub hub_unit: f64,
}

/// An approximate inverse: direction by direction, sliding points without what their friction turns.
struct Preconditioner {
    normal: DenseFactor,
    tangential: [Option<DenseFactor>; 2],
    /// Solutions for the hub's columns.
    hub: Vec<Vec<f64>>,
    /// The hub's rows of these.
    reduced: Option<DenseFactor>,
}

impl Linearised<'_> {
    /// What hub motions by one along `directions` do to the rows, sliding points with their share of the slip only.
    pub fn motions(&self, directions: &[Vector3<f64>]) -> Vec<Vec<f64>> {
        let a = self.active.len();
        let motion = |along: &Vector3<f64>| {
            let of_row = |&row: &usize| self.state.scale[row] * self.state.hub_weight(row, along);
            let mut column: Vec<f64> = self.rows.iter().map(of_row).collect();
            for (local, cone) in self.sliding() {
                let (row1, row2) = (a + local, 2 * a + local);
                (column[row1], column[row2]) = cone.across(column[row1], column[row2]);
            }
            column
        };
        directions.iter().map(motion).collect()
    }

    /// Solutions for right-hand sides as long as rows and hub directions, to a residual of `tolerance` times these; `None` where this way is not worth it or does not
    /// lead there.
    pub fn solve(&self, sides: &[Vec<f64>], tolerance: f64) -> Option<Vec<Vec<f64>>> {
        if !self.state.problem.compliance.has_fast_products() || self.rows.len() < ROWS {
            return None;
        }
        let preconditioner = self.preconditioner()?;
        sides
            .iter()
            .map(|side| gmres(side, tolerance, |x| self.product(x), |r| self.inverse(&preconditioner, r)))
            .collect()
    }

    fn product(&self, x: &[f64]) -> Vec<f64> {
        let state = self.state;
        let m = self.rows.len();
        let mut forces = vec![0.0; state.forces.len()];
        self.rows.iter().zip(x).for_each(|(&row, &value)| forces[row] = value);
        let mut motion = vec![0.0; forces.len()];
        state.problem.compliance.add_product(&forces, &mut motion);
        let mut product = vec![0.0; x.len()];
        for (r, &row) in self.rows.iter().enumerate() {
            let hub: f64 = self
                .along
                .iter()
                .zip(&x[m..])
                .map(|(along, h)| state.hub_weight(row, along) * self.hub_unit * h)
                .sum();
            product[r] = state.scale[row] * (motion[row] + hub);
        }
        for (h, along) in self.along.iter().enumerate() {
            product[m + h] = self.rows.iter().zip(x).map(|(&row, x)| state.hub_weight(row, along) * x).sum();
        }
        let a = self.active.len();
        for (local, cone) in self.sliding() {
            let (row1, row2) = (a + local, 2 * a + local);
            let (s1, s2) = cone.across(product[row1] - x[row1], product[row2] - x[row2]);
            product[row1] = s1 + x[row1] - cone.friction * cone.unit.x * x[local];
            product[row2] = s2 + x[row2] - cone.friction * cone.unit.y * x[local];
        }
        product
    }

    /// The sliding points, by their place among the active ones.
    fn sliding(&self) -> impl Iterator<Item = (usize, Cone)> {
        let three = self.state.directions == 3;
        let points = self.active.iter().enumerate();
        points
            .filter(move |(_, j)| three && self.modes[**j] == PointMode::Slip)
            .map(|(local, &j)| (local, Cone::new(self.state, j)))
    }

    /// Places among the active points of those that stick.
    fn sticking(&self) -> Vec<usize> {
        (0..self.active.len()).filter(|&local| self.modes[self.active[local]] != PointMode::Slip).collect()
    }

    fn preconditioner(&self) -> Option<Preconditioner> {
        let a = self.active.len();
        let compliance = self.state.problem.compliance;
        let factor = |places: &[usize], direction: usize| -> DenseFactor {
            let rows: Vec<usize> = places.iter().map(|&local| self.rows[direction * a + local]).collect();
            DenseFactor::new(compliance.block(&rows))
        };
        let all: Vec<usize> = (0..a).collect();
        let sticking = self.sticking();
        let tangential = [1, 2].map(|direction| {
            (self.state.directions == 3 && !sticking.is_empty()).then(|| factor(&sticking, direction))
        });
        let mut preconditioner =
            Preconditioner { normal: factor(&all, 0), tangential, hub: Vec::new(), reduced: None };
        for mut column in self.motions(self.along) {
            column.iter_mut().for_each(|value| *value *= self.hub_unit);
            preconditioner.hub.push(self.inverse(&preconditioner, &column));
        }
        if !self.along.is_empty() {
            let k = self.along.len();
            let reduced = Mat::from_fn(k, k, |h, l| self.hub_row(h, &preconditioner.hub[l]));
            preconditioner.reduced = Some(DenseFactor::new(reduced));
        }
        Some(preconditioner)
    }

    fn hub_row(&self, h: usize, x: &[f64]) -> f64 {
        self.rows.iter().zip(x).map(|(&row, x)| self.state.hub_weight(row, &self.along[h]) * x).sum()
    }

    fn inverse(&self, preconditioner: &Preconditioner, residual: &[f64]) -> Vec<f64> {
        let (a, m) = (self.active.len(), self.rows.len());
        let scaled = |r: usize| residual[r] / self.state.scale[self.rows[r]];
        let mut x = residual.to_vec();
        let mut normal: Vec<f64> = (0..a).map(scaled).collect();
        preconditioner.normal.solve(&mut normal);
        x[..a].copy_from_slice(&normal);
        let sticking = self.sticking();
        for (d, factor) in preconditioner.tangential.iter().enumerate() {
            let Some(factor) = factor else { continue };
            let first = (d + 1) * a;
            let mut values: Vec<f64> = sticking.iter().map(|local| scaled(first + local)).collect();
            factor.solve(&mut values);
            sticking.iter().zip(values).for_each(|(local, value)| x[first + local] = value);
        }
        for (local, cone) in self.sliding() {
            x[a + local] += cone.friction * cone.unit.x * x[local];
            x[2 * a + local] += cone.friction * cone.unit.y * x[local];
        }
        if let Some(reduced) = &preconditioner.reduced {
            let mut hub: Vec<f64> =
                (0..self.along.len()).map(|h| self.hub_row(h, &x) - residual[m + h]).collect();
            reduced.solve(&mut hub);
            for (h, solution) in hub.iter().zip(&preconditioner.hub) {
                x.iter_mut().zip(solution).for_each(|(x, s)| *x -= h * s);
            }
            x[m..].copy_from_slice(&hub);
        }
        x
    }
}

/// Solution of `product(x) = side` to a residual of `tolerance` times `side`, with the approximate `inverse`; `None` where it does
/// not settle.
fn gmres(
    side: &[f64],
    tolerance: f64,
    product: impl Fn(&[f64]) -> Vec<f64>,
    inverse: impl Fn(&[f64]) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let size = dot(side, side).sqrt();
    if size == 0.0 {
        return Some(vec![0.0; side.len()]);
    }
    let mut basis: Vec<Vec<f64>> = vec![side.iter().map(|v| v / size).collect()];
    let mut searched: Vec<Vec<f64>> = Vec::new();
    // columns of the triangle, rotations, and the rotated right-hand side
    let (mut triangle, mut rotations, mut rotated) =
        (Vec::<Vec<f64>>::new(), Vec::<(f64, f64)>::new(), vec![size]);
    for step in 0..LIMIT {
        let direction = inverse(&basis[step]);
        let mut next = product(&direction);
        searched.push(direction);
        let mut column = Vec::with_capacity(step + 2);
        for known in &basis {
            let part = dot(known, &next);
            next.iter_mut().zip(known).for_each(|(n, k)| *n -= part * k);
            column.push(part);
        }
        let rest = dot(&next, &next).sqrt();
        for (i, (c, s)) in rotations.iter().enumerate() {
            (column[i], column[i + 1]) =
                (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let length = column[step].hypot(rest);
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let (c, s) = (column[step] / length, rest / length);
        rotations.push((c, s));
        column[step] = length;
        triangle.push(column);
        rotated.push(-s * rotated[step]);
        rotated[step] *= c;
        if rotated[step + 1].abs() <= tolerance * size {
            let mut weights = rotated[..=step].to_vec();
            for i in (0..=step).rev() {
                weights[i] /= triangle[i][i];
                for k in 0..i {
                    weights[k] -= triangle[i][k] * weights[i];
                }
            }
            let mut x = vec![0.0; side.len()];
            for (direction, weight) in searched.iter().zip(weights) {
                x.iter_mut().zip(direction).for_each(|(x, d)| *x += weight * d);
            }
            return x.iter().all(|v| v.is_finite()).then_some(x);
        }
        basis.push(next.iter().map(|v| v / rest).collect());
    }
    None
}
