//! Newton-Raphson iteration of one time step on the condensed system.
//!
//! Rail beam and suspended mass are linear and are condensed exactly, so that
//! eight unknowns remain: the pose of the contact masters B and C, and the
//! wheel centre A in directions 1 and 2.

use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};

use railspring_calibrate::error::{NumericsError, Result, StopReason};

use super::surface::{ActiveNode, ContactLaw, ContactSurface, Pose, Vector6};
use super::wheel::WheelSprings;

type Vector8 = SVector<f64, 8>;
type Matrix8 = SMatrix<f64, 8, 8>;

/// Iterations with full Newton steps, and in all.
const FULL_STEPS: usize = 20;
const MOST_ITERATIONS: usize = 60;

/// Out-of-balance force relative to the forces at work at which a step has converged.
const TOLERANCE: f64 = 1e-8;

/// Lever that turns a moment into a force when residuals are compared, m.
const LEVER: f64 = 0.1;

/// Stiffness with which held degrees of freedom enter the system, N/m; any value of the system's order does.
const HELD: f64 = 1e9;

/// The linear parts around the contact: stiffness and the displacement without contact. `None` holds the part where it is.
pub(super) struct Surroundings {
    pub rail: Option<(Matrix3<f64>, Vector3<f64>)>,
    pub wheel: Option<([f64; 2], [f64; 2])>,
    pub roll: Option<(f64, f64)>,
}

/// Converged end of a step.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    pub pose: Pose,
    pub centre: Vector2<f64>,
    /// Internal forces of the contact at the masters.
    pub contact: Vector6,
    /// Force of B on A, N.
    pub spring_force: Vector2<f64>,
    pub active: Vec<ActiveNode>,
    pub iterations: usize,
}

/// The nonlinear system of one step.
pub(super) struct StepSystem<'a> {
    pub springs: &'a WheelSprings,
    pub law: &'a ContactLaw,
    pub surroundings: Surroundings,
    /// External force that the residual is compared with when nothing touches, N.
    pub load: f64,
    /// Pose and wheel centre at the last converged state.
    pub start: (Pose, Vector2<f64>),
    pub start_force: f64,
}

struct Balance {
    residual: Vector8,
    stiffness: Matrix8,
    contact: Vector6,
    spring_force: Vector2<f64>,
    active: Vec<ActiveNode>,
    /// Largest out-of-balance force over the forces at work.
    error: f64,
}

impl StepSystem<'_> {
    /// Iterates from the last state to balance.
    pub fn solve(&self, surface: &mut ContactSurface) -> Result<Solution> {
        let mut x = Vector8::zeros();
        x.fixed_rows_mut::<6>(0).copy_from(&self.start.0);
        x.fixed_rows_mut::<2>(6).copy_from(&self.start.1);
        let mut balance = self.balance(surface, &x, self.start_force);
        for iteration in 0..MOST_ITERATIONS {
            if balance.error <= TOLERANCE {
                return Ok(Solution {
                    pose: x.fixed_rows::<6>(0).into_owned(),
                    centre: x.fixed_rows::<2>(6).into_owned(),
                    contact: balance.contact,
                    spring_force: balance.spring_force,
                    active: balance.active,
                    iterations: iteration,
                });
            }
            if !balance.error.is_finite() {
                return Err(failure(iteration, &balance, StopReason::NotFinite));
            }
            let step = balance
                .stiffness
                .lu()
                .solve(&balance.residual)
                .ok_or_else(|| failure(iteration, &balance, StopReason::Singular))?;
            (x, balance) = self.advance(surface, &x, &-step, balance, iteration >= FULL_STEPS);
        }
        Err(failure(MOST_ITERATIONS, &balance, StopReason::IterationLimit))
    }

    /// Goes along `step`: all of it, or with `search` to the first of halved lengths at which the
    /// out-of-balance force along the step has fallen.
    fn advance(
        &self,
        surface: &mut ContactSurface,
        x: &Vector8,
        step: &Vector8,
        from: Balance,
        search: bool,
    ) -> (Vector8, Balance) {
        let before = step.dot(&from.residual).abs();
        let mut length = 1.0;
        loop {
            let next = x + step * length;
            let balance = self.balance(surface, &next, from.spring_force.y);
            if !search || length < 0.02 || step.dot(&balance.residual).abs() <= 0.8 * before {
                return (next, balance);
            }
            length *= 0.5;
        }
    }

    fn balance(&self, surface: &mut ContactSurface, x: &Vector8, guess: f64) -> Balance {
        let pose: Pose = x.fixed_rows::<6>(0).into_owned();
        let centre: Vector2<f64> = x.fixed_rows::<2>(6).into_owned();
        if let Some(motion) = surface.beyond_reach(&pose).filter(|m| m.is_finite()) {
            surface.list(&self.start.0, 2.0 * motion);
        }
        let contact = surface.evaluate(self.law, &pose);
        let (force, stiffness) = self.springs.forces(pose.fixed_rows::<2>(0) - centre, guess);
        let mut residual = Vector8::zeros();
        let mut matrix = Matrix8::zeros();
        residual.fixed_rows_mut::<6>(0).copy_from(&contact.force);
        matrix.fixed_view_mut::<6, 6>(0, 0).copy_from(&contact.stiffness);
        for i in 0..2 {
            residual[i] += force[i];
            residual[6 + i] -= force[i];
            matrix[(i, i)] += stiffness[i];
            matrix[(6 + i, 6 + i)] += stiffness[i];
            matrix[(i, 6 + i)] -= stiffness[i];
            matrix[(6 + i, i)] -= stiffness[i];
        }
        let held = |residual: &mut Vector8, matrix: &mut Matrix8, i: usize, at: f64| {
            matrix.row_mut(i).fill(0.0);
            matrix[(i, i)] = HELD;
            residual[i] = HELD * (x[i] - at);
        };
        match &self.surroundings.rail {
            Some((rail, free)) => {
                let own = rail * (pose.fixed_rows::<3>(2) - free);
                for i in 0..3 {
                    residual[2 + i] += own[i];
                    for j in 0..3 {
                        matrix[(2 + i, 2 + j)] += rail[(i, j)];
                    }
                }
            }
            None => (2..5).for_each(|i| held(&mut residual, &mut matrix, i, self.start.0[i])),
        }
        match self.surroundings.roll {
            Some((own, free)) => {
                residual[5] += own * (x[5] - free);
                matrix[(5, 5)] += own;
            }
            None => held(&mut residual, &mut matrix, 5, self.start.0[5]),
        }
        match &self.surroundings.wheel {
            Some((own, free)) => {
                for i in 0..2 {
                    residual[6 + i] += own[i] * (centre[i] - free[i]);
                    matrix[(6 + i, 6 + i)] += own[i];
                }
            }
            None => (0..2).for_each(|i| held(&mut residual, &mut matrix, 6 + i, self.start.1[i])),
        }
        let scale = self.load.max(force.norm()).max(contact.force.fixed_rows::<4>(0).amax()).max(1.0);
        let error = (0..8)
            .map(|i| if i == 4 || i == 5 { residual[i].abs() / LEVER } else { residual[i].abs() })
            // Not f64::max, which would hide a value that is not a number.
            .fold(0.0, |m: f64, r| if r > m || r.is_nan() { r } else { m })
            / scale;
        Balance {
            residual,
            stiffness: matrix,
            contact: contact.force,
            spring_force: force,
            active: contact.active,
            error,
        }
    }
}

fn failure(iteration: usize, balance: &Balance, reason: StopReason) -> railspring_calibrate::error::Error {
    NumericsError {
        stage: "moving solver".into(),
        step: None,
        iteration,
        residual: balance.error,
        active: balance.active.len(),
        reason,
    }
    .into()
}
