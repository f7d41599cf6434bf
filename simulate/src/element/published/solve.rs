//! Newton-Raphson iteration of one time step on the condensed system.
//!
//! Rail and wheel are linear parts and are condensed exactly to their interfaces, so that
//! eight unknowns remain: the pose of the contact masters B and C, and the
//! wheel centre A in directions 1 and 2.

use std::cell::Cell;

use nalgebra::{SMatrix, SVector, Vector2, Vector3};

use railspring_profiles::error::{Error, NumericsError, Result, StopReason};

use super::interface::Interface;
use super::surface::{ActiveNode, ContactLaw, ContactSurface, FrictionLimit, Pose, SlidingMatrix, Vector6};
use super::wheel::WheelSprings;

type Vector8 = SVector<f64, 8>;
type Matrix8 = SMatrix<f64, 8, 8>;

/// Newton iterations from the last state, and after each update of the friction limits.
const DIRECT_ITERATIONS: usize = 15;
const RETRY_ITERATIONS: usize = 10;
/// Iterations with the symmetric matrix of equation (4), which converges linearly.
const SYMMETRIC_ITERATIONS: usize = 30;

/// Updates of the friction limits, and damped iterations with each, when Newton alone does not settle. The limits settle slowly where a flange slides up the
/// gauge corner: of 150 load cases that pull a wheel off, 3 do not end with 20, 2 not with 40.
const LIMIT_UPDATES: usize = 60;
/// Limits that go on in one direction go this much farther with each update, and so much at most. Near a balance that a wheel on a steep flange is about to lose they change by less than a
/// hundredth an update for hundreds of updates; limits that have gone too far come back, and go as far as they should from there.
const FASTER: f64 = 1.2;
const FASTEST: f64 = 50.0;
const DESCENT_ITERATIONS: usize = 40;
const LINE_SEARCH: usize = 20;

/// Out-of-balance force relative to the forces at work at which a step has converged.
const TOLERANCE: f64 = 1e-8;

/// What rounding of coordinates of up to a metre leaves of a penetration, m; times the penalty it bounds the reachable balance.
const RESOLUTION: f64 = 1e-15;

/// The same at which damped iterations with given friction limits stop at first. Where new limits leave less than that they would not move, and Newton would fail from the same place again: from then on
/// they stop at a share of it.
const DESCENT_TOLERANCE: f64 = 1e-4;
const TIGHTER: f64 = 0.1;

/// Lever that turns a moment into a force when residuals are compared, m.
const LEVER: f64 = 0.1;

/// Unknowns at the interfaces of rail and wheel, directions 1, 2 and rotation 3: the master C; the wheel centre A with the
/// rotation of B.
const RAIL: [usize; 3] = [2, 3, 4];
const WHEEL: [usize; 3] = [6, 7, 5];

/// The linear parts around the contact.
pub(super) struct Surroundings {
    pub rail: Interface,
    pub wheel: Interface,
}

impl Surroundings {
    /// Forces at the interfaces of rail and wheel that move them to where `solution` has them. From the forces of contact and
    /// springs they differ by what is left of the balance, so that no gap opens between a part and its contact.
    pub fn forces(&self, solution: &Solution) -> [Vector3<f64>; 2] {
        let Solution { pose, centre, .. } = solution;
        let rail = self.rail.forces(pose.fixed_rows::<3>(2).into_owned());
        [rail, self.wheel.forces(Vector3::new(centre.x, centre.y, pose[5]))]
    }
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
    /// Matrix with which it converged.
    pub sliding: SlidingMatrix,
}

impl Solution {
    /// Forces of the contact at the interface of the rail, directions 1, 2 and moment 3.
    pub fn on_rail(&self) -> Vector3<f64> {
        -self.contact.fixed_rows::<3>(2).into_owned()
    }

    /// Forces of springs and contact at the interface of the wheel, directions 1, 2 and moment 3.
    pub fn on_wheel(&self) -> Vector3<f64> {
        Vector3::new(self.spring_force.x, self.spring_force.y, -self.contact[5])
    }

    /// A step that ends with this solution but not with a state to go on from.
    pub fn failure(&self, reason: StopReason) -> Error {
        failure(self.iterations, 0.0, self.active.len(), reason)
    }
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
    /// Friction limits of the rail nodes at the last converged state, N.
    pub start_limits: Vec<f64>,
    /// Evaluations of the balance that the run has left.
    pub evaluations_left: &'a Cell<usize>,
}

struct Balance {
    residual: Vector8,
    stiffness: Matrix8,
    contact: Vector6,
    spring_force: Vector2<f64>,
    active: Vec<ActiveNode>,
    /// Largest out-of-balance force over the forces at work.
    error: f64,
    provisional: bool,
}

impl Balance {
    fn failure(&self, iteration: usize, reason: StopReason) -> Error {
        failure(iteration, self.error, self.active.len(), reason)
    }
}

impl StepSystem<'_> {
    /// Iterates from the last state to balance.
    ///
    /// Contacts as stiff as the penalty open, close and turn within a fraction of a Newton step. Where Newton does
    /// not settle from the last state, the friction limits are held at the last normal forces: that problem has a convex
    /// potential, which damped Newton steps descend from anywhere. Its solution gives new limits, and a new start for Newton. Where Newton never settles, the limits do: in the end their balance is
    /// as good as Newton's.
    pub fn solve(&self, surface: &mut ContactSurface) -> Result<Solution> {
        let mut x = Vector8::zeros();
        x.fixed_rows_mut::<6>(0).copy_from(&self.start.0);
        x.fixed_rows_mut::<2>(6).copy_from(&self.start.1);
        let (direct, retry) = (DIRECT_ITERATIONS, RETRY_ITERATIONS);
        if self.law.sliding == SlidingMatrix::Symmetric {
            let outcome = self.iterate(surface, &x, SYMMETRIC_ITERATIONS, SlidingMatrix::Symmetric);
            if outcome.is_ok() {
                return outcome;
            }
        }
        let mut outcome = self.iterate(surface, &x, direct, SlidingMatrix::Consistent);
        let mut spent = direct;
        let mut limits = self.start_limits.clone();
        let mut within = DESCENT_TOLERANCE;
        let (mut last, mut pace) = (vec![0.0; limits.len()], 1.0);
        for _ in 0..LIMIT_UPDATES {
            if let Ok(solution) = &mut outcome {
                if spent > direct {
                    solution.iterations += spent;
                }
                break;
            }
            let (next, balance, iterations) = self.descend(surface, &x, &limits, within)?;
            if iterations == 0 {
                within = (TIGHTER * within).max(TOLERANCE);
            }
            x = next;
            let mut change: Vec<f64> = limits.iter().map(|limit| -limit).collect();
            for node in &balance.active {
                change[node.node] += self.law.friction * node.normal_force;
            }
            let along: f64 = change.iter().zip(&last).map(|(now, before)| now * before).sum();
            pace = if along > 0.0 { (FASTER * pace).min(FASTEST) } else { 1.0 };
            for (limit, change) in limits.iter_mut().zip(&change) {
                *limit = (*limit + pace * change).max(0.0);
            }
            last = change;
            outcome = self.iterate(surface, &x, retry, SlidingMatrix::Consistent);
            spent += iterations + retry;
        }
        outcome
    }

    /// Damped Newton with given friction limits, until the out-of-balance force is `within` a share of the forces at work.
    fn descend(
        &self,
        surface: &mut ContactSurface,
        x: &Vector8,
        limits: &[f64],
        within: f64,
    ) -> Result<(Vector8, Balance, usize)> {
        let limit = FrictionLimit::Given(limits);
        let mut x = *x;
        let consistent = SlidingMatrix::Consistent;
        let mut balance = self.balance(surface, &x, self.start_force, limit, consistent);
        for iteration in 0..DESCENT_ITERATIONS {
            if balance.error <= within {
                return Ok((x, balance, iteration));
            }
            self.check_work(iteration, &balance)?;
            let step = -newton_step(iteration, &balance)?;
            // The slope of the potential along the step rises from negative; where it is zero lies the minimum.
            let slope = |balance: &Balance| step.dot(&balance.residual);
            let before = slope(&balance);
            let (mut low, mut high, mut length) = (0.0, f64::INFINITY, 1.0);
            let guess = balance.spring_force.y;
            for _ in 0..LINE_SEARCH {
                balance = self.balance(surface, &(x + step * length), guess, limit, consistent);
                let now = slope(&balance);
                if now.abs() <= 0.5 * before.abs() {
                    break;
                }
                if now < 0.0 {
                    low = length;
                    length = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * length };
                } else {
                    high = length;
                    length = 0.5 * (low + high);
                }
                if now.is_nan() {
                    return Err(balance.failure(iteration, StopReason::NotFinite));
                }
            }
            x += step * length;
            balance = self.balance(surface, &x, guess, limit, consistent);
        }
        Ok((x, balance, DESCENT_ITERATIONS))
    }

    /// Newton's method from `x`, with the symmetric matrix an approximation of it.
    fn iterate(
        &self,
        surface: &mut ContactSurface,
        x: &Vector8,
        most: usize,
        sliding: SlidingMatrix,
    ) -> Result<Solution> {
        let mut x = *x;
        let balance_at = |surface: &mut ContactSurface, x: &Vector8, guess: f64, last: &[ActiveNode]| {
            self.balance(surface, x, guess, FrictionLimit::Coulomb(last), sliding)
        };
        let mut balance = balance_at(surface, &x, self.start_force, &[]);
        for iteration in 0..most {
            if balance.error <= TOLERANCE && !balance.provisional {
                return Ok(Solution {
                    pose: x.fixed_rows::<6>(0).into_owned(),
                    centre: x.fixed_rows::<2>(6).into_owned(),
                    contact: balance.contact,
                    spring_force: balance.spring_force,
                    active: balance.active,
                    iterations: iteration,
                    sliding,
                });
            }
            if !balance.error.is_finite() {
                return Err(balance.failure(iteration, StopReason::NotFinite));
            }
            self.check_work(iteration, &balance)?;
            x -= newton_step(iteration, &balance)?;
            let last = std::mem::take(&mut balance.active);
            balance = balance_at(surface, &x, balance.spring_force.y, &last);
        }
        Err(balance.failure(most, StopReason::IterationLimit))
    }

    fn check_work(&self, iteration: usize, balance: &Balance) -> Result<()> {
        match self.evaluations_left.get() {
            0 => Err(balance.failure(iteration, StopReason::WorkBound)),
            _ => Ok(()),
        }
    }

    fn balance(
        &self,
        surface: &mut ContactSurface,
        x: &Vector8,
        guess: f64,
        limit: FrictionLimit,
        sliding: SlidingMatrix,
    ) -> Balance {
        self.evaluations_left.set(self.evaluations_left.get().saturating_sub(1));
        let pose: Pose = x.fixed_rows::<6>(0).into_owned();
        let centre: Vector2<f64> = x.fixed_rows::<2>(6).into_owned();
        if let Some(motion) = surface.beyond_reach(&pose).filter(|m| m.is_finite()) {
            surface.list(&self.start.0, 2.0 * motion);
        }
        let contact = surface.evaluate(&ContactLaw { sliding, ..*self.law }, &pose, limit);
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
        let Surroundings { rail, wheel } = &self.surroundings;
        rail.add_to(RAIL, x, &mut residual, &mut matrix);
        wheel.add_to(WHEEL, x, &mut residual, &mut matrix);
        // In a step that was halved many times the wheel's inertia is the stiffest part.
        let inertia = 0.1 * wheel.largest_stiffness();
        let floor = self.law.penalty.max(inertia) * RESOLUTION / TOLERANCE;
        let scale = self.load.max(force.norm()).max(contact.force.fixed_rows::<4>(0).amax()).max(floor);
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
            provisional: contact.provisional,
        }
    }
}

fn newton_step(iteration: usize, balance: &Balance) -> Result<Vector8> {
    let step = balance.stiffness.lu().solve(&balance.residual);
    step.ok_or_else(|| balance.failure(iteration, StopReason::Singular))
}

fn failure(iteration: usize, residual: f64, active: usize, reason: StopReason) -> Error {
    NumericsError::new("moving solver", reason, residual, active).after(iteration).into()
}
