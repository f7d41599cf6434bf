//! Newton-Raphson iteration of one time step on the condensed system.
//!
//! Rail and wheel are linear parts and are condensed exactly to their interfaces, so that
//! eight unknowns remain of a wheel: the pose of the contact masters B and C, and the
//! wheel centre A in directions 1 and 2. Two wheels of an axle share its motion, so that thirteen remain.

use std::cell::Cell;

use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};

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

/// Unknowns of a wheel alone: the displacements of its masters B and C and the rotation of C. Those of the body that carries
/// the wheels follow all of them: its rotation, and its displacements in directions 1 and 2.
pub(super) const OWN: usize = 5;

/// Unknowns at the interface of the rail among those of its wheel: the master C in directions 1, 2 and rotation 3.
const RAIL: [usize; 3] = [2, 3, 4];

/// The linear parts around the contacts of `W` wheels.
pub(super) struct Surroundings<const W: usize> {
    pub rails: [Interface; W],
    /// What carries the wheels: a wheel itself, or the axle.
    pub body: Interface,
}

impl<const W: usize> Surroundings<W> {
    /// Forces at the interfaces of rails and body that move them to where the unknowns `x` have them. From the forces of contact and
    /// springs they differ by what is left of the balance, so that no gap opens between a part and its contact.
    pub fn forces<const N: usize>(&self, x: &SVector<f64, N>) -> ([Vector3<f64>; W], Vector3<f64>) {
        let rail = |wheel: usize| x.fixed_rows::<3>(OWN * wheel + RAIL[0]).into_owned();
        let at = OWN * W;
        let body = Vector3::new(x[at + 1], x[at + 2], x[at]);
        (std::array::from_fn(|wheel| self.rails[wheel].forces(rail(wheel))), self.body.forces(body))
    }
}

/// Where a wheel sits on the body that carries it: so far from its middle, on the side with this sign. Directions 1 and 3 of a wheel on the
/// other side are the opposite of the body's, so that both wheels have the field side where direction 1 points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mount {
    pub side: f64,
    /// m; 0 for a wheel that is the body.
    pub arm: f64,
}

impl Mount {
    /// A wheel that is the body itself.
    pub const OWN: Self = Self { side: 1.0, arm: 0.0 };

    /// Rotation of B and displacements of A from those of the body.
    pub fn moved(&self, body: &Vector3<f64>) -> Vector3<f64> {
        let turn = self.side * body[0];
        let (sin, cos) = turn.sin_cos();
        Vector3::new(turn, self.side * body[1] + self.arm * (cos - 1.0), body[2] + self.arm * sin)
    }

    /// Its derivative, and the second one of the displacements after the rotation.
    fn derivatives(&self, body: &Vector3<f64>) -> (Matrix3<f64>, Vector2<f64>) {
        let (sin, cos) = (self.side * body[0]).sin_cos();
        let (side, arm) = (self.side, self.arm);
        let first = Matrix3::new(side, 0.0, 0.0, -side * arm * sin, side, 0.0, side * arm * cos, 0.0, 1.0);
        (first, Vector2::new(-arm * cos, -arm * sin))
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

/// Converged end of a step of `W` wheels with `N` unknowns.
#[derive(Debug, Clone)]
pub(super) struct Solved<const W: usize, const N: usize> {
    pub x: SVector<f64, N>,
    pub wheels: [Solution; W],
}

/// The nonlinear system of one step, of `W` wheels on one body; `N` is 5·W + 3.
pub(super) struct StepSystem<'a, const W: usize, const N: usize> {
    pub springs: [&'a WheelSprings; W],
    pub law: &'a ContactLaw,
    pub surroundings: Surroundings<W>,
    pub mounts: [Mount; W],
    /// External force that the residual is compared with when nothing touches, N.
    pub load: f64,
    /// Unknowns at the last converged state.
    pub start: SVector<f64, N>,
    pub start_force: [f64; W],
    /// Friction limits of the rail nodes at the last converged state, N.
    pub start_limits: [Vec<f64>; W],
    /// Evaluations of the balance that the run has left.
    pub evaluations_left: &'a Cell<usize>,
}

struct Balance<const W: usize, const N: usize> {
    residual: SVector<f64, N>,
    stiffness: SMatrix<f64, N, N>,
    wheels: [WheelBalance; W],
    /// Largest out-of-balance force over the forces at work.
    error: f64,
    provisional: bool,
}

/// Contact and springs of a wheel.
struct WheelBalance {
    pose: Pose,
    centre: Vector2<f64>,
    contact: Vector6,
    spring_force: Vector2<f64>,
    active: Vec<ActiveNode>,
}

impl<const W: usize, const N: usize> Balance<W, N> {
    fn failure(&self, iteration: usize, reason: StopReason) -> Error {
        let active = self.wheels.iter().map(|wheel| wheel.active.len()).sum();
        failure(iteration, self.error, active, reason)
    }

    fn guesses(&self) -> [f64; W] {
        std::array::from_fn(|wheel| self.wheels[wheel].spring_force.y)
    }

    fn solved(self, x: SVector<f64, N>, iterations: usize, sliding: SlidingMatrix) -> Solved<W, N> {
        let wheels = self.wheels.map(|wheel| Solution {
            pose: wheel.pose,
            centre: wheel.centre,
            contact: wheel.contact,
            spring_force: wheel.spring_force,
            active: wheel.active,
            iterations,
            sliding,
        });
        Solved { x, wheels }
    }
}

/// A sum over wheels, the same whichever is the first of two.
fn over_wheels<const W: usize>(of: impl Fn(usize) -> f64) -> f64 {
    (0..W).map(of).sum()
}

/// Surfaces of the wheels.
type Surfaces<'s, const W: usize> = [ContactSurface<'s>; W];

impl<const W: usize, const N: usize> StepSystem<'_, W, N> {
    /// The unknowns of the body.
    const BODY: usize = OWN * W;

    /// Iterates from the last state to balance.
    ///
    /// Contacts as stiff as the penalty open, close and turn within a fraction of a Newton step. Where Newton does
    /// not settle from the last state, the friction limits are held at the last normal forces: that problem has a convex
    /// potential, which damped Newton steps descend from anywhere. Its solution gives new limits, and a new start for Newton. Where Newton never settles, the limits do: in the end their balance is
    /// as good as Newton's.
    pub fn solve(&self, surfaces: &mut Surfaces<W>) -> Result<Solved<W, N>> {
        let mut x = self.start;
        let (direct, retry) = (DIRECT_ITERATIONS, RETRY_ITERATIONS);
        if self.law.sliding == SlidingMatrix::Symmetric {
            let outcome = self.iterate(surfaces, &x, SYMMETRIC_ITERATIONS, SlidingMatrix::Symmetric);
            if outcome.is_ok() {
                return outcome;
            }
        }
        let mut outcome = self.iterate(surfaces, &x, direct, SlidingMatrix::Consistent);
        let mut spent = direct;
        let mut limits = self.start_limits.clone();
        let mut within = DESCENT_TOLERANCE;
        let mut last = self.start_limits.each_ref().map(|limits| vec![0.0; limits.len()]);
        let mut pace = 1.0;
        for _ in 0..LIMIT_UPDATES {
            if let Ok(solved) = &mut outcome {
                if spent > direct {
                    solved.wheels.iter_mut().for_each(|wheel| wheel.iterations += spent);
                }
                break;
            }
            let (next, balance, iterations) = self.descend(surfaces, &x, &limits, within)?;
            if iterations == 0 {
                within = (TIGHTER * within).max(TOLERANCE);
            }
            x = next;
            let change: [Vec<f64>; W] = std::array::from_fn(|wheel| {
                let mut change: Vec<f64> = limits[wheel].iter().map(|limit| -limit).collect();
                for node in &balance.wheels[wheel].active {
                    change[node.node] += self.law.friction * node.normal_force;
                }
                change
            });
            let along = over_wheels::<W>(|wheel| {
                change[wheel].iter().zip(&last[wheel]).map(|(now, before)| now * before).sum()
            });
            pace = if along > 0.0 { (FASTER * pace).min(FASTEST) } else { 1.0 };
            for (limit, change) in limits.iter_mut().flatten().zip(change.iter().flatten()) {
                *limit = (*limit + pace * change).max(0.0);
            }
            last = change;
            outcome = self.iterate(surfaces, &x, retry, SlidingMatrix::Consistent);
            spent += iterations + retry;
        }
        outcome
    }

    /// The step with the friction limits of its start, for one so short that they hardly change: always the only solution of a
    /// convex problem.
    ///
    /// # Errors
    /// [`NumericsError`] where even that does not settle.
    pub fn solve_with_last_limits(&self, surfaces: &mut Surfaces<W>) -> Result<Solved<W, N>> {
        let (x, balance, iterations) = self.descend(surfaces, &self.start, &self.start_limits, TOLERANCE)?;
        match balance.error <= TOLERANCE {
            true => Ok(balance.solved(x, iterations, SlidingMatrix::Consistent)),
            false => Err(balance.failure(iterations, StopReason::IterationLimit)),
        }
    }

    /// The product of a vector with the residual.
    fn slope(&self, step: &SVector<f64, N>, residual: &SVector<f64, N>) -> f64 {
        if W == 1 {
            return step.dot(residual);
        }
        let part = |from: usize, count: usize| step.rows(from, count).dot(&residual.rows(from, count));
        over_wheels::<W>(|wheel| part(OWN * wheel, OWN)) + part(Self::BODY, 3)
    }

    /// Damped Newton with given friction limits, until the out-of-balance force is `within` a share of the forces at work.
    fn descend(
        &self,
        surfaces: &mut Surfaces<W>,
        x: &SVector<f64, N>,
        limits: &[Vec<f64>; W],
        within: f64,
    ) -> Result<(SVector<f64, N>, Balance<W, N>, usize)> {
        let limit = limits.each_ref().map(|limits| FrictionLimit::Given(limits));
        let mut x = *x;
        let consistent = SlidingMatrix::Consistent;
        let mut balance = self.balance(surfaces, &x, self.start_force, limit, consistent);
        for iteration in 0..DESCENT_ITERATIONS {
            if balance.error <= within {
                return Ok((x, balance, iteration));
            }
            self.check_work(iteration, &balance)?;
            let step = -self.newton_step(iteration, &balance)?;
            // The slope of the potential along the step rises from negative; where it is zero lies the minimum.
            let slope = |balance: &Balance<W, N>| self.slope(&step, &balance.residual);
            let before = slope(&balance);
            let (mut low, mut high, mut length) = (0.0, f64::INFINITY, 1.0);
            let guess = balance.guesses();
            for _ in 0..LINE_SEARCH {
                balance = self.balance(surfaces, &(x + step * length), guess, limit, consistent);
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
            balance = self.balance(surfaces, &x, guess, limit, consistent);
        }
        Ok((x, balance, DESCENT_ITERATIONS))
    }

    /// Newton's method from `x`, with the symmetric matrix an approximation of it.
    fn iterate(
        &self,
        surfaces: &mut Surfaces<W>,
        x: &SVector<f64, N>,
        most: usize,
        sliding: SlidingMatrix,
    ) -> Result<Solved<W, N>> {
        let mut x = *x;
        let nothing: [&[ActiveNode]; W] = [&[]; W];
        let limit = nothing.map(FrictionLimit::Coulomb);
        let mut balance = self.balance(surfaces, &x, self.start_force, limit, sliding);
        for iteration in 0..most {
            if balance.error <= TOLERANCE && !balance.provisional {
                return Ok(balance.solved(x, iteration, sliding));
            }
            if !balance.error.is_finite() {
                return Err(balance.failure(iteration, StopReason::NotFinite));
            }
            self.check_work(iteration, &balance)?;
            x -= self.newton_step(iteration, &balance)?;
            let limit = balance.wheels.each_ref().map(|wheel| FrictionLimit::Coulomb(&wheel.active));
            balance = self.balance(surfaces, &x, balance.guesses(), limit, sliding);
        }
        Err(balance.failure(most, StopReason::IterationLimit))
    }

    fn check_work(&self, iteration: usize, balance: &Balance<W, N>) -> Result<()> {
        match self.evaluations_left.get() {
            0 => Err(balance.failure(iteration, StopReason::WorkBound)),
            _ => Ok(()),
        }
    }

    /// Rotation of the body and its displacements in directions 1 and 2.
    fn body(x: &SVector<f64, N>) -> Vector3<f64> {
        x.fixed_rows::<3>(Self::BODY).into_owned()
    }

    /// Pose of a wheel.
    pub fn pose(&self, x: &SVector<f64, N>, wheel: usize) -> Pose {
        self.wheel(x, wheel).fixed_rows::<6>(0).into_owned()
    }

    /// Pose and wheel centre of a wheel.
    fn wheel(&self, x: &SVector<f64, N>, wheel: usize) -> Vector8 {
        let moved = self.mounts[wheel].moved(&Self::body(x));
        let mut all = Vector8::zeros();
        all.fixed_rows_mut::<OWN>(0).copy_from(&x.fixed_rows::<OWN>(OWN * wheel));
        all.fixed_rows_mut::<3>(OWN).copy_from(&moved);
        all
    }

    fn balance(
        &self,
        surfaces: &mut Surfaces<W>,
        x: &SVector<f64, N>,
        guess: [f64; W],
        limits: [FrictionLimit; W],
        sliding: SlidingMatrix,
    ) -> Balance<W, N> {
        self.evaluations_left.set(self.evaluations_left.get().saturating_sub(1));
        let mut residual = SVector::<f64, N>::zeros();
        let mut matrix = SMatrix::<f64, N, N>::zeros();
        let Surroundings { rails, body } = &self.surroundings;
        let mut provisional = false;
        let at = Self::BODY;
        let wheels = std::array::from_fn(|wheel| {
            let own = self.wheel(x, wheel);
            let surface = &mut surfaces[wheel];
            let (of_wheel, forces, stiffness, unsure) = self.wheel_balance(
                surface,
                wheel,
                &own,
                guess[wheel],
                (limits[wheel], sliding),
                &rails[wheel],
            );
            provisional |= unsure;
            let (turned, bent) = self.mounts[wheel].derivatives(&Self::body(x));
            let from = OWN * wheel;
            residual.fixed_rows_mut::<OWN>(from).copy_from(&forces.fixed_rows::<OWN>(0));
            let on_body = turned.transpose() * forces.fixed_rows::<3>(OWN);
            let mut of_body = residual.fixed_rows_mut::<3>(at);
            of_body += on_body;
            matrix.fixed_view_mut::<OWN, OWN>(from, from).copy_from(&stiffness.fixed_view::<OWN, OWN>(0, 0));
            let across = stiffness.fixed_view::<OWN, 3>(0, OWN) * turned;
            matrix.fixed_view_mut::<OWN, 3>(from, at).copy_from(&across);
            let back = turned.transpose() * stiffness.fixed_view::<3, OWN>(OWN, 0);
            matrix.fixed_view_mut::<3, OWN>(at, from).copy_from(&back);
            let mut on_body = turned.transpose() * stiffness.fixed_view::<3, 3>(OWN, OWN) * turned;
            on_body[(0, 0)] += forces[OWN + 1] * bent.x + forces[OWN + 2] * bent.y;
            let mut of_body = matrix.fixed_view_mut::<3, 3>(at, at);
            of_body += on_body;
            of_wheel
        });
        body.add_to([at + 1, at + 2, at], x, &mut residual, &mut matrix);
        // In a step that was halved many times the wheel's inertia is the stiffest part.
        let inertia = 0.1 * body.largest_stiffness();
        let floor = self.law.penalty.max(inertia) * RESOLUTION / TOLERANCE;
        let of_wheel =
            |wheel: &WheelBalance| wheel.spring_force.norm().max(wheel.contact.fixed_rows::<4>(0).amax());
        let scale = wheels.iter().map(of_wheel).fold(self.load.max(floor), f64::max);
        let is_moment = |i: usize| i == at || (i < at && i % OWN == RAIL[2]);
        let error = (0..N)
            .map(|i| if is_moment(i) { residual[i].abs() / LEVER } else { residual[i].abs() })
            // Not f64::max, which would hide a value that is not a number.
            .fold(0.0, |m: f64, r| if r > m || r.is_nan() { r } else { m })
            / scale;
        Balance { residual, stiffness: matrix, wheels, error, provisional }
    }

    /// Contact, springs and rail of a wheel with the unknowns `own`: their forces and stiffness, and whether they are no state to end with.
    fn wheel_balance(
        &self,
        surface: &mut ContactSurface,
        wheel: usize,
        own: &Vector8,
        guess: f64,
        (limit, sliding): (FrictionLimit, SlidingMatrix),
        rail: &Interface,
    ) -> (WheelBalance, Vector8, Matrix8, bool) {
        let pose: Pose = own.fixed_rows::<6>(0).into_owned();
        let centre: Vector2<f64> = own.fixed_rows::<2>(6).into_owned();
        if let Some(motion) = surface.beyond_reach(&pose).filter(|m| m.is_finite()) {
            surface.list(&self.pose(&self.start, wheel), 2.0 * motion);
        }
        let contact = surface.evaluate(&ContactLaw { sliding, ..*self.law }, &pose, limit);
        let (force, stiffness) = self.springs[wheel].forces(pose.fixed_rows::<2>(0) - centre, guess);
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
        rail.add_to(RAIL, own, &mut residual, &mut matrix);
        let balance = WheelBalance {
            pose,
            centre,
            contact: contact.force,
            spring_force: force,
            active: contact.active,
        };
        (balance, residual, matrix, contact.provisional)
    }

    /// Stiffness into residual. Two wheels are eliminated into their body each by itself, so that exchanging them changes no bit.
    fn newton_step(&self, iteration: usize, balance: &Balance<W, N>) -> Result<SVector<f64, N>> {
        let singular = || balance.failure(iteration, StopReason::Singular);
        let (matrix, residual) = (&balance.stiffness, &balance.residual);
        let at = Self::BODY;
        let mut step = SVector::<f64, N>::zeros();
        if W == 1 {
            let whole = matrix.fixed_view::<8, 8>(0, 0).into_owned().lu();
            let found = whole.solve(&residual.fixed_rows::<8>(0).into_owned()).ok_or_else(singular)?;
            step.fixed_rows_mut::<8>(0).copy_from(&found);
            return Ok(step);
        }
        let mut taken = (Matrix3::zeros(), Vector3::zeros());
        let mut eliminated = [(SMatrix::<f64, OWN, 3>::zeros(), SVector::<f64, OWN>::zeros()); W];
        for (wheel, eliminated) in eliminated.iter_mut().enumerate() {
            let from = OWN * wheel;
            let own = matrix.fixed_view::<OWN, OWN>(from, from).into_owned().lu();
            let across =
                own.solve(&matrix.fixed_view::<OWN, 3>(from, at).into_owned()).ok_or_else(singular)?;
            let free = own.solve(&residual.fixed_rows::<OWN>(from).into_owned()).ok_or_else(singular)?;
            let back = matrix.fixed_view::<3, OWN>(at, from);
            taken.0 += back * across;
            taken.1 += back * free;
            *eliminated = (across, free);
        }
        let of_body = matrix.fixed_view::<3, 3>(at, at) - taken.0;
        let on_body = residual.fixed_rows::<3>(at) - taken.1;
        let body = of_body.lu().solve(&on_body).ok_or_else(singular)?;
        step.fixed_rows_mut::<3>(at).copy_from(&body);
        for (wheel, (across, free)) in eliminated.iter().enumerate() {
            step.fixed_rows_mut::<OWN>(OWN * wheel).copy_from(&(free - across * body));
        }
        Ok(step)
    }
}

fn failure(iteration: usize, residual: f64, active: usize, reason: StopReason) -> Error {
    NumericsError::new("moving solver", reason, residual, active).after(iteration).into()
}
