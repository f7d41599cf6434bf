//! The elastic wheel with its suspended mass over time steps.
//!
//! Hub and modes together are turned into the natural modes of a wheel whose hub is free, so that a step of each is a division.
//! A step is Newmark's, with `γ = 1/2`; of rigid motions `β` is 1/4, and of the others it is from 1/12 on: `u' = u + h·v + h²·((1/2 - β)·a + β·a')`, `v' = v + h/2·(a + a')`. With 1/12, the
//! method of L. Fox and E.T. Goodwin, periods are right to the fourth order of the step, where average acceleration (1/4) has the second; it is stable as long
//! as no frequency of wheel and contact together is above `√6/h` (T.J.R. Hughes, "The Finite Element Method" (1987), chapter 9).
//! Whatever `β`, a linear wheel keeps `½v² + ½κ·a²` with `κ = (β - 1/4)·h²` and its elastic energy together to rounding.
//!
//! So the velocities of a step differ from those of the motion: by `-½κ·ä` to the second order. A step of another `κ` takes them over with the difference, or it would change the energy of a vibration with its
//! phase, and steps that change with the phase would drive it.

use nalgebra::{Cholesky, DMatrix, Matrix3, SymmetricEigen, Vector3};

use crate::time::energy::PartEnergy;
use crate::time::scenario::Scenario;
use railspring_element::wheel::ElasticWheel;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::units::TONNE;

use crate::element::published::InitialMotion;

/// A natural mode of mass 1 kg.
#[derive(Debug, Clone, Copy)]
struct Mode {
    /// Square of the angular frequency, 1/s².
    square: f64,
    /// Damping, 1/s.
    damping: f64,
    /// Displacements y and z of the hub.
    hub: [f64; 2],
    /// Motion of the rim's section.
    rim: Vector3<f64>,
    /// Force of the wheel's weight under an acceleration of 1 m/s² downwards.
    weight: f64,
    /// Vertical force on the rim that has the elastic energy of a unit displacement, N.
    as_force: f64,
}

/// The wheel under a scenario.
#[derive(Debug, Clone)]
pub(super) struct Wheel<'a> {
    scenario: &'a Scenario,
    modes: Vec<Mode>,
    /// Its mass, kg.
    mass: f64,
    /// Flexibility of the rim beyond the modes, which follows the forces at once.
    pub rest: Matrix3<f64>,
}

/// Stiffness of the stiffest contact, N/m: twice that of Hertz's under 300 kN.
const STIFFEST_CONTACT: f64 = 4e9;

/// `(1/4 - β)·h²·Ω²` at most, with `Ω` the highest frequency of wheel and contact together; 1 is the limit of stability.
const STABLE: f64 = 0.7;

/// Displacement, velocity and acceleration of the modes, displacement and velocity of the suspended mass (z).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct WheelState {
    modes: Vec<[f64; 3]>,
    suspended: [f64; 2],
    /// The force on the rim, and its change over the step to here, N and N/s.
    force: Vector3<f64>,
    rate: Vector3<f64>,
    /// `κ` of each mode in the step to here, s².
    kept: Vec<f64>,
}

/// A step length prepared.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    step: f64,
    /// Of each mode.
    modes: Vec<PreparedMode>,
    /// Share of the suspension's force that is left beside the compliance of both its ends.
    share: f64,
    /// Displacement of the rim at the end of the step per force of the suspension on the hub there.
    from_hub: Vector3<f64>,
    /// Force of the suspension that a force on the rim takes off where its other end stands.
    coupling: Vector3<f64>,
    /// Displacement of the rim per force there at the end.
    pub flexibility: Matrix3<f64>,
}

/// A mode over steps of one length.
#[derive(Debug, Clone, Copy)]
struct PreparedMode {
    /// Newmark's `β·h²`, and `κ`, s².
    of_end: f64,
    kept: f64,
    /// Acceleration per force at the end of the step.
    response: f64,
}

/// A step of the wheel without contact forces at its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Free {
    /// Displacement of the rim beyond the rest.
    pub rim: Vector3<f64>,
    /// Force of the suspension on the hub at the start and at the end, N.
    suspension: [f64; 2],
    /// Loads on hub (y, z) and suspended mass at the end, and their means over the step, N.
    loads: [f64; 3],
    mean_loads: [f64; 3],
}

impl<'a> Wheel<'a> {
    /// A wheel with its mass, or that of the scenario, and `roll` the stiffness of the axle against its rotation about x (N·m/rad) where
    /// rotations are free; `damping` is proportional to stiffness, s.
    ///
    /// # Errors
    /// [`InputError`] for a mass matrix that is not positive definite.
    pub fn new(wheel: &ElasticWheel, scenario: &'a Scenario, roll: f64, damping: f64) -> Result<Self> {
        let hub = if scenario.rotations_held { 2 } else { 3 };
        let size = hub + wheel.modes.len();
        let mut rigid = wheel.mass;
        if let Some(mass) = scenario.wheel_mass {
            // what the scenario's wheel weighs more sits at the hub
            let more = mass - rigid[(1, 1)];
            rigid[(0, 0)] += more;
            rigid[(1, 1)] += more;
        }
        let mass = DMatrix::from_fn(size, size, |i, j| match (i < hub, j < hub) {
            (true, true) => rigid[(i, j)],
            (true, false) => wheel.modes[j - hub].coupling[i],
            (false, true) => wheel.modes[i - hub].coupling[j],
            (false, false) => f64::from(u8::from(i == j)),
        });
        let stiffness = DMatrix::from_fn(size, size, |i, j| match i {
            _ if i != j || i < 2 => 0.0,
            _ if i < hub => roll,
            _ => wheel.modes[i - hub].square,
        });
        let root = Cholesky::new(mass.clone()).ok_or_else(|| {
            // in whole kilograms, rounded up but for rounding errors
            let in_modes = |i: usize| wheel.modes.iter().map(|mode| mode.coupling[i].powi(2)).sum::<f64>();
            InputError::new(
                InputField::WheelMass,
                format!("{} t", scenario.wheel_mass.unwrap_or(wheel.mass[(1, 1)]) / TONNE),
                format!(
                    "a mass above that which moves in the wheel's modes, {:.3} t",
                    (in_modes(0).max(in_modes(1)) * (1.0 - 1e-9)).ceil() / TONNE
                ),
                "give a larger mass, or leave it out and it is that of the solid wheel",
            )
        })?;
        let inverse = root.l().try_inverse().unwrap_or_else(|| DMatrix::zeros(size, size));
        let natural = SymmetricEigen::new(&inverse * stiffness * inverse.transpose());
        let shapes = inverse.transpose() * natural.eigenvectors;
        let of_hub = wheel.carried_by_hub();
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&a, &b| natural.eigenvalues[a].total_cmp(&natural.eigenvalues[b]));
        let mode = |n: usize| {
            let shape = shapes.column(n);
            let mut rim = Vector3::zeros();
            for i in 0..size {
                rim +=
                    shape[i] * if i < hub { of_hub.column(i).into_owned() } else { wheel.modes[i - hub].rim };
            }
            // rigid motions have none, but for rounding
            let rigid = natural.eigenvalues[n] < 1.0;
            let square = if rigid { 0.0 } else { natural.eigenvalues[n] };
            Mode {
                square,
                damping: damping * square,
                hub: [shape[0], shape[1]],
                rim,
                weight: (0..size).map(|i| shape[i] * mass[(i, 1)]).sum(),
                as_force: square.sqrt(),
            }
        };
        let mut modes: Vec<Mode> = order.into_iter().map(mode).collect();
        let elastic = modes.iter().filter(|mode| mode.square > 0.0);
        let of_modes: f64 = elastic.map(|mode| mode.rim.y * mode.rim.y / mode.square).sum();
        let flexibility = wheel.rest[(1, 1)] + of_modes;
        let stiffness = if flexibility > 0.0 { 1.0 / flexibility } else { 0.0 };
        modes.iter_mut().for_each(|mode| mode.as_force *= stiffness.sqrt());
        Ok(Self { scenario, modes, mass: rigid[(1, 1)], rest: wheel.rest })
    }

    /// How many coordinates it has, the suspended mass included.
    pub fn count(&self) -> usize {
        self.modes.len() + usize::from(self.scenario.suspended_mass > 0.0)
    }

    /// As an initial motion has hub, suspension and body, not yet accelerated.
    pub fn start(&self, initial: &InitialMotion) -> WheelState {
        let InitialMotion { displacement, velocity, carried } = *initial;
        let suspended = [displacement[1] + initial.stroke(self.scenario, self.mass), velocity[1]];
        let mut state = WheelState {
            modes: vec![[0.0; 3]; self.modes.len()],
            suspended,
            force: Vector3::zeros(),
            rate: Vector3::zeros(),
            kept: vec![0.0; self.modes.len()],
        };
        // the rail carries the rim, and weight and suspension hold it down
        let on_hub = carried - self.mass * self.scenario.gravity;
        for (mode, at) in self.modes.iter().zip(&mut state.modes).filter(|(mode, _)| mode.square > 0.0) {
            let held = self.load(mode, &[0.0; 3], on_hub) - carried * mode.rim.y;
            at[0] = if carried > 0.0 { held / mode.square } else { 0.0 };
        }
        // two rigid motions span the translations of the hub
        let mut rigid = (0..self.modes.len()).filter(|i| self.modes[*i].square == 0.0);
        if let (Some(a), Some(b)) = (rigid.next(), rigid.next()) {
            let (p, q) = (self.modes[a].hub, self.modes[b].hub);
            let determinant = p[0] * q[1] - p[1] * q[0];
            let solve = |v: [f64; 2]| {
                [(v[0] * q[1] - v[1] * q[0]) / determinant, (p[0] * v[1] - p[1] * v[0]) / determinant]
            };
            let deflected = self.hub(&state);
            let (u, v) = (solve([0, 1].map(|i| displacement[i] - deflected[i])), solve(velocity));
            state.modes[a] = [u[0], v[0], 0.0];
            state.modes[b] = [u[1], v[1], 0.0];
        }
        state
    }

    /// Accelerates a state at t = 0 by its loads and a `force` on the rim.
    pub fn accelerate(&self, state: &mut WheelState, force: &Vector3<f64>) {
        let (loads, suspension) = (self.loads(0.0), self.suspension(state));
        state.force = *force;
        for (mode, [u, v, a]) in self.modes.iter().zip(&mut state.modes) {
            *a = self.load(mode, &loads, suspension) + mode.rim.dot(force)
                - mode.square * *u
                - mode.damping * *v;
        }
    }

    /// Displacement and velocity of the suspended mass against the hub, m and m/s.
    fn stroke(&self, state: &WheelState) -> [f64; 2] {
        let mut stroke = state.suspended;
        for (mode, at) in self.modes.iter().zip(&state.modes) {
            stroke[0] -= mode.hub[1] * at[0];
            stroke[1] -= mode.hub[1] * at[1];
        }
        stroke
    }

    /// Force of the suspension on the hub, N.
    fn suspension(&self, state: &WheelState) -> f64 {
        if self.scenario.suspended_mass == 0.0 {
            return 0.0;
        }
        let (spring, [stroke, velocity]) = (self.scenario.vertical_suspension, self.stroke(state));
        spring.stiffness * stroke + spring.damping * velocity
    }

    /// Force on a mode of loads, weight and suspension.
    fn load(&self, mode: &Mode, loads: &[f64; 3], suspension: f64) -> f64 {
        mode.hub[0] * loads[0] + mode.hub[1] * (loads[1] + suspension) + mode.weight * self.scenario.gravity
    }

    /// Displacement (y, z) of the hub, m.
    pub fn hub(&self, state: &WheelState) -> [f64; 2] {
        [0, 1].map(|i| self.modes.iter().zip(&state.modes).map(|(mode, [u, ..])| mode.hub[i] * u).sum())
    }

    /// Motion of the rim's section without the rest.
    pub fn rim(&self, state: &WheelState) -> Vector3<f64> {
        self.modes.iter().zip(&state.modes).map(|(mode, [u, ..])| mode.rim * *u).sum()
    }

    /// Adds the elastic state of the modes as forces, N: vertical ones on the rim that have the same energy.
    pub fn elastic_state(&self, state: &WheelState, forces: &mut Vec<f64>) {
        forces.extend(self.modes.iter().zip(&state.modes).map(|(mode, [u, ..])| mode.as_force * u));
    }

    /// Prepares steps of one length, s.
    pub fn prepare(&self, step: f64) -> Prepared {
        // the square of the highest frequency of modes that a spring joins is no larger than their own and the spring's together
        let (mut highest, mut contact) = (0.0_f64, 0.0);
        for mode in &self.modes {
            highest = highest.max(mode.square);
            contact += STIFFEST_CONTACT * mode.rim.xy().norm_squared();
        }
        let beta = (0.25 - STABLE / (step * step * (highest + contact))).max(1.0 / 12.0);
        let of_mode = |mode: &Mode| {
            let beta = if mode.square > 0.0 { beta } else { 0.25 };
            let of_end = beta * step * step;
            let response = 1.0 / (1.0 + 0.5 * step * mode.damping + of_end * mode.square);
            PreparedMode { of_end, kept: of_end - 0.25 * step * step, response }
        };
        let modes: Vec<PreparedMode> = self.modes.iter().map(of_mode).collect();
        let (spring, mass) = (self.scenario.vertical_suspension, self.scenario.suspended_mass);
        let spring = if mass > 0.0 { [spring.stiffness, spring.damping] } else { [0.0; 2] };
        let (mut own, mut from_hub) = (Matrix3::zeros(), Vector3::zeros());
        let (mut coupling, mut of_hub) = (Vector3::zeros(), 0.0);
        for (mode, prepared) in self.modes.iter().zip(&modes) {
            let moved = prepared.of_end * prepared.response;
            let force = mode.hub[1] * (spring[0] * moved + spring[1] * 0.5 * step * prepared.response);
            own += mode.rim * mode.rim.transpose() * moved;
            from_hub += mode.rim * (mode.hub[1] * moved);
            coupling += mode.rim * force;
            of_hub += mode.hub[1] * force;
        }
        let of_mass =
            if mass > 0.0 { (spring[0] * 0.25 * step + spring[1] * 0.5) * step / mass } else { 0.0 };
        let share = 1.0 / (1.0 + of_mass + of_hub);
        let flexibility = own - from_hub * coupling.transpose() * share;
        Prepared { step, modes, share, from_hub, coupling, flexibility }
    }

    /// Loads on hub (y, z) and suspended mass (z) at a time, N, without the weight of the wheel.
    fn loads(&self, time: f64) -> [f64; 3] {
        let [lateral, vertical] =
            [&self.scenario.lateral_force, &self.scenario.vertical_force].map(|force| force.at(time));
        match self.scenario.suspended_mass > 0.0 {
            true => [lateral, 0.0, vertical + self.scenario.suspended_mass * self.scenario.gravity],
            false => [lateral, vertical, 0.0],
        }
    }

    /// The step from `state` between two `times` (s) without contact forces at its end.
    pub fn free(&self, prepared: &Prepared, state: &WheelState, times: [f64; 2]) -> Free {
        let step = prepared.step;
        let [before, loads] = times.map(|time| self.loads(time));
        let mean_loads = [0, 1, 2].map(|i| 0.5 * (before[i] + loads[i]));
        let (mut rim, mut hub, mut hub_velocity) = (Vector3::zeros(), 0.0, 0.0);
        for (i, (mode, of_mode)) in self.modes.iter().zip(&prepared.modes).enumerate() {
            let (u, v) = self.predicted(i, prepared, state);
            let a = of_mode.response * (self.load(mode, &loads, 0.0) - mode.square * u - mode.damping * v);
            let end = u + of_mode.of_end * a;
            rim += mode.rim * end;
            hub += mode.hub[1] * end;
            hub_velocity += mode.hub[1] * (v + 0.5 * step * a);
        }
        let start = self.suspension(state);
        let (mass, spring) = (self.scenario.suspended_mass, self.scenario.vertical_suspension);
        let end = if mass > 0.0 {
            let [w, velocity] = state.suspended;
            let pushed = (mean_loads[2] - 0.5 * start) * step / mass;
            let (w, velocity) = (w + step * (velocity + 0.5 * pushed), velocity + pushed);
            prepared.share * (spring.stiffness * (w - hub) + spring.damping * (velocity - hub_velocity))
        } else {
            0.0
        };
        let rim = rim + prepared.from_hub * end;
        Free { rim, suspension: [start, end], loads, mean_loads }
    }

    /// Displacement and velocity of a mode at the end of a step from a state without the acceleration there.
    fn predicted(&self, i: usize, prepared: &Prepared, state: &WheelState) -> (f64, f64) {
        let (mode, [u, v, a], step) = (&self.modes[i], state.modes[i], prepared.step);
        let change = prepared.modes[i].kept - state.kept[i];
        let jerk = || mode.rim.dot(&state.rate) - mode.square * v - mode.damping * a;
        let v = if change == 0.0 { v } else { v - 0.5 * change * jerk() };
        (u + step * v + (0.5 * step * step - prepared.modes[i].of_end) * a, v + 0.5 * step * a)
    }

    /// The state after a step under the `force` on the rim at its end.
    pub fn finish(
        &self,
        prepared: &Prepared,
        state: &WheelState,
        free: &Free,
        force: &Vector3<f64>,
        next: &mut WheelState,
    ) {
        let step = prepared.step;
        let [start, end] = free.suspension;
        let suspension = end - prepared.share * prepared.coupling.dot(force);
        let mut hub = [0.0; 2];
        for (i, (mode, of_mode)) in self.modes.iter().zip(&prepared.modes).enumerate() {
            let (u, v) = self.predicted(i, prepared, state);
            let load = self.load(mode, &free.loads, suspension) + mode.rim.dot(force);
            let a = of_mode.response * (load - mode.square * u - mode.damping * v);
            let after = [u + of_mode.of_end * a, v + 0.5 * step * a, a];
            (next.modes[i], next.kept[i]) = (after, of_mode.kept);
            hub[0] += mode.hub[1] * after[0];
            hub[1] += mode.hub[1] * after[1];
        }
        (next.force, next.rate) = (*force, (force - state.force) / step);
        let [w, velocity] = state.suspended;
        next.suspended = if self.scenario.suspended_mass > 0.0 {
            let pushed =
                (free.mean_loads[2] - 0.5 * (start + suspension)) * step / self.scenario.suspended_mass;
            [w + step * (velocity + 0.5 * pushed), velocity + pushed]
        } else {
            hub
        };
    }

    /// Energies of a state, J.
    pub fn stored(&self, state: &WheelState) -> PartEnergy {
        let mut energy = PartEnergy::default();
        for ((mode, [u, v, a]), kept) in self.modes.iter().zip(&state.modes).zip(&state.kept) {
            energy.kinetic += 0.5 * (v * v + kept * a * a);
            energy.elastic += 0.5 * mode.square * u * u;
        }
        let mass = self.scenario.suspended_mass;
        if mass > 0.0 {
            energy.kinetic += 0.5 * mass * state.suspended[1].powi(2);
            energy.elastic +=
                0.5 * self.scenario.vertical_suspension.stiffness * self.stroke(state)[0].powi(2);
        }
        energy
    }

    /// Works in a step that went on from `free`, J.
    pub fn worked(&self, before: &WheelState, after: &WheelState, free: &Free) -> PartEnergy {
        let loads = &free.mean_loads;
        let mut works = PartEnergy::default();
        for ((mode, a), b) in self.modes.iter().zip(&before.modes).zip(&after.modes) {
            let (moved, velocity) = (b[0] - a[0], 0.5 * (a[1] + b[1]));
            works.work += self.load(mode, loads, 0.0) * moved;
            works.damped += mode.damping * velocity * moved;
        }
        if self.scenario.suspended_mass > 0.0 {
            let damping = self.scenario.vertical_suspension.damping;
            let [from, to] = [before, after].map(|state| self.stroke(state));
            works.work += loads[2] * (after.suspended[0] - before.suspended[0]);
            works.damped += damping * 0.5 * (from[1] + to[1]) * (to[0] - from[0]);
        }
        works
    }
}

impl WheelState {
    /// Whether all of it are numbers.
    pub fn is_finite(&self) -> bool {
        self.modes.iter().flatten().chain(&self.suspended).all(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests;
