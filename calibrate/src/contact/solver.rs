//! Unilateral contact with Coulomb friction on a dense compliance.
//!
//! Unknown are the forces at the contact points and the free motions of the
//! wheel's hub. The conditions of Signorini and Coulomb are written as
//! projections (P. Alart, A. Curnier, "A mixed formulation for frictional
//! contact problems prone to Newton like solution methods", Comput. Methods
//! Appl. Mech. Eng. 92 (1991)) and solved by a semismooth Newton iteration on
//! the points that carry load; where that cycles, projected Gauss-Seidel sweeps
//! (M. Jean, "The non-smooth contact dynamics method", ibid. 177 (1999)) bring
//! it near the solution and Newton finishes.

use super::ContactPoints;
use crate::error::{NumericsError, Result, StopReason};
use faer::Mat;
use nalgebra::{DMatrix, DVector, Vector2};

/// State of one contact point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointMode {
    /// No force.
    Open,
    /// Force inside the friction cone.
    Stick,
    /// Force on the friction cone.
    Slip,
}

/// A contact problem on condensed bodies.
pub struct Problem<'a> {
    /// The points (their directions are needed for the hub).
    pub points: &'a ContactPoints,
    /// Compliance, `direction·points + point`; one direction without friction, else three, m/N.
    pub compliance: &'a Mat<f64>,
    /// Gap (and slip since the last state) of every row without contact forces, m.
    pub free: &'a [f64],
    /// Coulomb friction coefficient; ignored with one direction.
    pub friction: f64,
    /// World axes (0 x, 1 y, 2 z) in which the hub is free, with the contact force wanted there on
    /// the opposing body, N. Empty when the compliance already contains the hub.
    pub hub: &'a [(usize, f64)],
}

/// Forces that satisfy the contact conditions.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Contact forces on the opposing body, `direction·points + point`, N; normal ones are not negative.
    pub forces: Vec<f64>,
    /// Gap and slip of every row, m.
    pub separation: Vec<f64>,
    /// State of every point.
    pub modes: Vec<PointMode>,
    /// Hub displacement along its free axes, m.
    pub hub: Vec<f64>,
    /// Newton iterations used.
    pub iterations: usize,
}

impl Solution {
    /// Number of points that carry load.
    pub fn active(&self) -> usize {
        self.modes.iter().filter(|m| **m != PointMode::Open).count()
    }
}

const NEWTON_LIMIT: usize = 60;
const SWEEP_LIMIT: usize = 4000;
/// Relative size of the last force correction.
const SOLVER_TOLERANCE: f64 = 1e-10;

/// Solves `problem` from the forces `start` (same layout; zero if nothing is known).
///
/// # Errors
/// [`NumericsError`] with the number of load-carrying points if the iteration does not settle, or if
/// a wanted hub force cannot be carried.
pub fn solve(problem: &Problem, start: &[f64]) -> Result<Solution> {
    let mut state = State::new(problem, start);
    match state.newton() {
        Err(_) if problem.hub.is_empty() => {
            state.forces.copy_from_slice(start);
            state.sweep();
            state.newton()
        }
        outcome => outcome,
    }
}

struct State<'a> {
    problem: &'a Problem<'a>,
    directions: usize,
    forces: Vec<f64>,
    hub: Vec<f64>,
    separation: Vec<f64>,
    /// Scale that turns metres into newtons, for normal and tangential rows.
    scale: f64,
}

impl<'a> State<'a> {
    fn new(problem: &'a Problem<'a>, start: &[f64]) -> Self {
        let rows = problem.free.len();
        let count = problem.points.len();
        assert_eq!(problem.compliance.nrows(), rows);
        assert_eq!(start.len(), rows);
        let diagonal: f64 = (0..rows).map(|i| problem.compliance[(i, i)]).sum();
        let mut state = Self {
            problem,
            directions: rows.checked_div(count).unwrap_or(1),
            forces: start.to_vec(),
            hub: vec![0.0; problem.hub.len()],
            separation: vec![0.0; rows],
            scale: if diagonal > 0.0 { rows as f64 / diagonal } else { 1.0 },
        };
        if !problem.hub.is_empty() && start.iter().all(|f| *f == 0.0) {
            state.touch_down();
        }
        state
    }

    /// Without a start, moves the hub along its first free axis until the nearest point overlaps a little.
    fn touch_down(&mut self) {
        let count = self.problem.points.len();
        let (axis, force) = self.problem.hub[0];
        let reach = (0..count)
            .filter_map(|j| {
                let slope = self.problem.points.direction(j, 0)[axis];
                (slope * force > 0.0).then(|| self.problem.free[j] / slope)
            })
            .min_by(|a, b| a.abs().total_cmp(&b.abs()));
        if let Some(reach) = reach {
            // the wheel moves against the contact force by the gap and the overlap of a light load
            let overlap = force.abs() / (self.scale * (count as f64).sqrt());
            self.hub[0] = -reach - overlap.min(2e-5) * force.signum();
        }
    }

    fn hub_weight(&self, row: usize, axis: usize) -> f64 {
        let count = self.problem.points.len();
        self.problem.points.direction(row % count, row / count)[axis]
    }

    fn update_separation(&mut self) {
        self.separation.copy_from_slice(self.problem.free);
        for (j, &f) in self.forces.iter().enumerate() {
            if f != 0.0 {
                let column = self.problem.compliance.col_as_slice(j);
                self.separation.iter_mut().zip(column).for_each(|(s, c)| *s += c * f);
            }
        }
        for h in 0..self.hub.len() {
            let axis = self.problem.hub[h].0;
            for row in 0..self.separation.len() {
                self.separation[row] += self.hub_weight(row, axis) * self.hub[h];
            }
        }
    }

    /// Friction bound and trial tangential force of point `j`.
    fn trial(&self, j: usize) -> (f64, Vector2<f64>) {
        let n = self.problem.points.len();
        let pressure = self.forces[j] - self.scale * self.separation[j];
        let trial = |d: usize| self.forces[d * n + j] - self.scale * self.separation[d * n + j];
        (self.problem.friction * pressure.max(0.0), Vector2::new(trial(1), trial(2)))
    }

    fn mode(&self, j: usize) -> PointMode {
        if self.forces[j] - self.scale * self.separation[j] <= 0.0 {
            PointMode::Open
        } else if self.directions == 1 {
            PointMode::Stick
        } else {
            let (bound, trial) = self.trial(j);
            if trial.norm() <= bound { PointMode::Stick } else { PointMode::Slip }
        }
    }

    fn newton(&mut self) -> Result<Solution> {
        let count = self.problem.points.len();
        let mut previous: Vec<PointMode> = Vec::new();
        let mut correction = f64::NAN;
        let mut active_count = 0;
        for iteration in 0..NEWTON_LIMIT {
            self.update_separation();
            let modes: Vec<PointMode> = (0..count).map(|j| self.mode(j)).collect();
            if modes == previous && correction < SOLVER_TOLERANCE {
                return Ok(Solution {
                    forces: self.forces.clone(),
                    separation: self.separation.clone(),
                    modes,
                    hub: self.hub.clone(),
                    iterations: iteration,
                });
            }
            let active: Vec<usize> = (0..count).filter(|&j| modes[j] != PointMode::Open).collect();
            active_count = active.len();
            let before = self.forces.clone();
            if !self.step(&modes, &active) {
                return Err(self.failure(iteration, correction, active_count, StopReason::Singular));
            }
            let size = self.forces.iter().map(|f| f.abs()).fold(0.0, f64::max);
            let change = self.forces.iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if !size.is_finite() {
                return Err(self.failure(iteration, correction, active_count, StopReason::NotFinite));
            }
            correction = if size > 0.0 { change / size } else { 0.0 };
            previous = modes;
        }
        Err(self.failure(NEWTON_LIMIT, correction, active_count, StopReason::IterationLimit))
    }

    fn failure(
        &self,
        iteration: usize,
        residual: f64,
        active: usize,
        reason: StopReason,
    ) -> crate::error::Error {
        NumericsError { stage: "contact".into(), step: None, iteration, residual, active, reason }.into()
    }

    /// One Newton step on the load-carrying points; the others are set free of force.
    fn step(&mut self, modes: &[PointMode], active: &[usize]) -> bool {
        let n = self.problem.points.len();
        let rows: Vec<usize> =
            (0..self.directions).flat_map(|d| active.iter().map(move |&j| d * n + j)).collect();
        for j in (0..n).filter(|&j| modes[j] == PointMode::Open) {
            (0..self.directions).for_each(|d| self.forces[d * n + j] = 0.0);
        }
        self.update_separation();
        let (m, k) = (rows.len(), self.hub.len());
        if m == 0 {
            return k == 0;
        }
        let mut matrix = DMatrix::zeros(m + k, m + k);
        let mut rhs = DVector::zeros(m + k);
        for (r, &row) in rows.iter().enumerate() {
            // gap (and slip while sticking) closes; in newtons, so that all rows have one scale
            for (c, &column) in rows.iter().enumerate() {
                matrix[(r, c)] = self.scale * self.problem.compliance[(row, column)];
            }
            for h in 0..k {
                matrix[(r, m + h)] = self.hub_weight(row, self.problem.hub[h].0);
            }
            rhs[r] = -self.scale * self.separation[row];
        }
        for (h, &(axis, wanted)) in self.problem.hub.iter().enumerate() {
            let mut carried = 0.0;
            for (c, &column) in rows.iter().enumerate() {
                matrix[(m + h, c)] = self.hub_weight(column, axis);
                carried += self.hub_weight(column, axis) * self.forces[column];
            }
            rhs[m + h] = wanted - carried;
        }
        if self.directions == 3 {
            self.slip_rows(modes, active, &mut matrix, &mut rhs);
        }
        let Some(step) = matrix.lu().solve(&rhs) else { return false };
        for (r, &row) in rows.iter().enumerate() {
            self.forces[row] += step[r];
        }
        for h in 0..k {
            self.hub[h] += step[m + h] / self.scale;
        }
        true
    }

    /// Replaces the tangential rows of slipping points by the linearised cone condition
    /// `τ = μ·p·v/|v|`, `v = τ - scale·slip`.
    fn slip_rows(
        &self,
        modes: &[PointMode],
        active: &[usize],
        matrix: &mut DMatrix<f64>,
        rhs: &mut DVector<f64>,
    ) {
        let n = self.problem.points.len();
        let a = active.len();
        for (local, &j) in active.iter().enumerate().filter(|(_, j)| modes[**j] == PointMode::Slip) {
            let (_, v) = self.trial(j);
            let length = v.norm();
            let unit = v / length;
            let limit = self.problem.friction * self.forces[j].max(0.0);
            let turn = limit / length;
            let (row1, row2) = (a + local, 2 * a + local);
            let across = |x: f64, y: f64| {
                let along = unit.x * x + unit.y * y;
                (turn * (x - along * unit.x), turn * (y - along * unit.y))
            };
            for c in 0..matrix.ncols() {
                // these rows hold scale·d(slip); v changes by -d(slip)·scale and +dτ
                let (s1, s2) = across(matrix[(row1, c)], matrix[(row2, c)]);
                matrix[(row1, c)] = s1;
                matrix[(row2, c)] = s2;
            }
            let (e11, e21) = across(1.0, 0.0);
            let (e12, e22) = across(0.0, 1.0);
            matrix[(row1, row1)] += 1.0 - e11;
            matrix[(row2, row1)] -= e21;
            matrix[(row1, row2)] -= e12;
            matrix[(row2, row2)] += 1.0 - e22;
            matrix[(row1, local)] -= self.problem.friction * unit.x;
            matrix[(row2, local)] -= self.problem.friction * unit.y;
            rhs[row1] = limit * unit.x - self.forces[n + j];
            rhs[row2] = limit * unit.y - self.forces[2 * n + j];
        }
    }

    /// Projected Gauss-Seidel sweeps until the forces change by less than 1e-5 of the largest.
    fn sweep(&mut self) {
        let n = self.problem.points.len();
        self.update_separation();
        for _ in 0..SWEEP_LIMIT {
            let mut change = 0.0_f64;
            let mut size = 0.0_f64;
            for j in 0..n {
                let mut wanted = [0.0; 3];
                for (d, w) in wanted.iter_mut().enumerate().take(self.directions) {
                    let row = d * n + j;
                    *w = self.forces[row] - self.separation[row] / self.problem.compliance[(row, row)];
                }
                wanted[0] = wanted[0].max(0.0);
                let limit = self.problem.friction * wanted[0];
                let tangential = wanted[1].hypot(wanted[2]);
                if tangential > limit {
                    wanted[1] *= limit / tangential;
                    wanted[2] *= limit / tangential;
                }
                for d in 0..self.directions {
                    let row = d * n + j;
                    let delta = wanted[d] - self.forces[row];
                    if delta != 0.0 {
                        self.forces[row] = wanted[d];
                        let column = self.problem.compliance.col_as_slice(row);
                        self.separation.iter_mut().zip(column).for_each(|(s, c)| *s += c * delta);
                    }
                    change = change.max(delta.abs());
                    size = size.max(wanted[d].abs());
                }
            }
            if change <= 1e-5 * size {
                break;
            }
        }
    }
}

/// How the contact answers small motions of the hub at a converged state.
pub struct HubResponse {
    /// Force the hub must apply against its displacement along the asked axes, N/m.
    pub stiffness: DMatrix<f64>,
    /// Change of the contact forces (rows as in the compliance) for a unit displacement along each axis, N/m.
    pub forces: DMatrix<f64>,
}

/// Linearises the contact at a converged state for hub motions along world `axes`: all load-carrying
/// points move as their modes say; `sticking` holds the slipping ones too. No differences of load
/// steps are involved. `None` if no point carries load.
pub fn hub_response(
    problem: &Problem,
    solution: &Solution,
    axes: &[usize],
    sticking: bool,
) -> Option<HubResponse> {
    let held = Problem { hub: &[], ..*problem };
    let mut state = State::new(&held, &solution.forces);
    state.separation.copy_from_slice(&solution.separation);
    let modes: Vec<PointMode> = solution
        .modes
        .iter()
        .map(|m| if sticking && *m == PointMode::Slip { PointMode::Stick } else { *m })
        .collect();
    let n = problem.points.len();
    let active: Vec<usize> = (0..n).filter(|&j| modes[j] != PointMode::Open).collect();
    let rows: Vec<usize> =
        (0..state.directions).flat_map(|d| active.iter().map(move |&j| d * n + j)).collect();
    let (m, k) = (rows.len(), axes.len());
    // columns: contact forces, then hub motions
    let mut system = DMatrix::from_fn(m, m + k, |r, c| {
        state.scale
            * if c < m {
                problem.compliance[(rows[r], rows[c])]
            } else {
                state.hub_weight(rows[r], axes[c - m])
            }
    });
    if state.directions == 3 {
        state.slip_rows(&modes, &active, &mut system, &mut DVector::zeros(m));
    }
    let motion = system.columns(m, k).into_owned();
    let response = system.columns(0, m).into_owned().lu().solve(&motion)?;
    let stiffness = DMatrix::from_fn(k, k, |a, h| {
        (0..m).map(|r| state.hub_weight(rows[r], axes[a]) * response[(r, h)]).sum()
    });
    let mut forces = DMatrix::zeros(problem.free.len(), k);
    for (r, &row) in rows.iter().enumerate() {
        for h in 0..k {
            forces[(row, h)] = -response[(r, h)];
        }
    }
    Some(HubResponse { stiffness, forces })
}
