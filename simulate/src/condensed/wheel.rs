//! The elastic wheel with its suspended mass over time steps.
//!
//! Hub and modes together are turned into the natural modes of a wheel whose hub is free, so that a step of each is a division.
//! A step is the implicit midpoint rule, which is average acceleration without its accelerations: loads and contact forces
//! are their means over the step, and a linear part keeps its energy to rounding.

use nalgebra::{Cholesky, DMatrix, Matrix3, SymmetricEigen, Vector3};

use railspring_calibrate::element::ElasticWheel;
use railspring_calibrate::energy::PartEnergy;
use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::scenario::Scenario;

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
}

/// The wheel under a scenario.
#[derive(Debug, Clone)]
pub(super) struct Wheel<'a> {
    scenario: &'a Scenario,
    modes: Vec<Mode>,
    /// Flexibility of the rim beyond the modes, which follows the forces at once.
    pub rest: Matrix3<f64>,
}

/// Displacement and velocity of the modes and of the suspended mass (z).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct WheelState {
    modes: Vec<[f64; 2]>,
    suspended: [f64; 2],
}

/// A step length prepared.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    step: f64,
    /// Displacement of each mode per mean force.
    response: Vec<f64>,
    suspended_response: f64,
    /// Of the suspension: mean force per distance at the end of the step, and per distance at its start.
    coupling: [f64; 2],
    /// Share of that force that is left beside the compliance of both its ends.
    share: f64,
    /// Displacement of the rim per mean force of the suspension on the hub.
    from_hub: Vector3<f64>,
    /// Displacement of the rim per mean force there.
    pub flexibility: Matrix3<f64>,
}

/// A step of the wheel without contact forces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Free {
    /// Displacement of the rim beyond the rest.
    pub rim: Vector3<f64>,
    /// Mean force of the suspension on the hub, N.
    suspension: f64,
    /// Mean loads on hub (y, z) and suspended mass, N.
    loads: [f64; 3],
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
            InputError::new(
                "wheel_mass",
                format!("{:?} kg", scenario.wheel_mass),
                "a mass no smaller than that which moves in the wheel's modes",
                "leave the mass to the solid wheel, or calibrate a lighter wheel",
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
            }
        };
        Ok(Self { scenario, modes: order.into_iter().map(mode).collect(), rest: wheel.rest })
    }

    /// How many coordinates it has, the suspended mass included.
    pub fn count(&self) -> usize {
        self.modes.len() + usize::from(self.scenario.suspended_mass > 0.0)
    }

    /// At rest with the hub at a displacement and a velocity (y, z; m, m/s).
    pub fn start(&self, displacement: [f64; 2], velocity: [f64; 2]) -> WheelState {
        // the coordinates of a translation are its impulses, as the modes have unit mass; the weight is that downwards
        let across = |mode: &Mode| mode.hub;
        let rigid: Vec<&Mode> = self.modes.iter().filter(|mode| mode.square == 0.0).collect();
        let mut state =
            WheelState { modes: vec![[0.0; 2]; self.modes.len()], suspended: [displacement[1], velocity[1]] };
        // two rigid motions span the translations of the hub
        if let [a, b, ..] = rigid[..] {
            let (p, q) = (across(a), across(b));
            let determinant = p[0] * q[1] - p[1] * q[0];
            let solve = |v: [f64; 2]| {
                [(v[0] * q[1] - v[1] * q[0]) / determinant, (p[0] * v[1] - p[1] * v[0]) / determinant]
            };
            let (u, v) = (solve(displacement), solve(velocity));
            state.modes[0] = [u[0], v[0]];
            state.modes[1] = [u[1], v[1]];
        }
        state
    }

    /// Displacement (y, z) of the hub, m.
    pub fn hub(&self, state: &WheelState) -> [f64; 2] {
        [0, 1].map(|i| self.modes.iter().zip(&state.modes).map(|(mode, [u, _])| mode.hub[i] * u).sum())
    }

    /// Motion of the rim's section without the rest.
    pub fn rim(&self, state: &WheelState) -> Vector3<f64> {
        self.modes.iter().zip(&state.modes).map(|(mode, [u, _])| mode.rim * *u).sum()
    }

    /// Prepares steps of one length, s.
    pub fn prepare(&self, step: f64) -> Prepared {
        let response: Vec<f64> =
            self.modes.iter().map(|m| step / (2.0 / step + 0.5 * step * m.square + m.damping)).collect();
        let (mut own, mut from_hub, mut hub) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
        for (mode, response) in self.modes.iter().zip(&response) {
            own += mode.rim * mode.rim.transpose() * *response;
            from_hub += mode.rim * (mode.hub[1] * response);
            hub += mode.hub[1] * mode.hub[1] * response;
        }
        let scenario = self.scenario;
        let (spring, mass) = (scenario.vertical_suspension, scenario.suspended_mass);
        let (suspended_response, coupling) = match mass > 0.0 {
            true => {
                let (half, damper) = (0.5 * spring.stiffness, spring.damping / step);
                (0.5 * step * step / mass, [half + damper, half - damper])
            }
            false => (0.0, [0.0; 2]),
        };
        let share = 1.0 / (1.0 + coupling[0] * (suspended_response + hub));
        let flexibility = own - from_hub * from_hub.transpose() * (coupling[0] * share);
        Prepared { step, response, suspended_response, coupling, share, from_hub, flexibility }
    }

    /// Loads on hub (y, z) and suspended mass (z) at a time, N, without weights.
    fn loads(&self, time: f64) -> [f64; 2] {
        [self.scenario.lateral_force.at(time), self.scenario.vertical_force.at(time)]
    }

    fn mean_loads(&self, [from, to]: [f64; 2]) -> [f64; 3] {
        let (a, b) = (self.loads(from), self.loads(to));
        let weight = self.scenario.suspended_mass * self.scenario.gravity;
        let (lateral, vertical) = (0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
        if self.scenario.suspended_mass > 0.0 {
            [lateral, 0.0, vertical + weight]
        } else {
            [lateral, vertical, 0.0]
        }
    }

    /// Displacement at the end of a step of a coordinate of mass 1 under a mean force.
    fn moved(mode: &Mode, [u, v]: [f64; 2], response: f64, step: f64, force: f64) -> f64 {
        u + response * (force - mode.square * u + 2.0 * v / step)
    }

    /// The step from `state` between two `times` (s) without contact forces.
    pub fn free(&self, prepared: &Prepared, state: &WheelState, times: [f64; 2]) -> Free {
        let loads = self.mean_loads(times);
        let step = prepared.step;
        let (mut rim, mut hub, mut hub_now) = (Vector3::zeros(), 0.0, 0.0);
        for ((mode, at), response) in self.modes.iter().zip(&state.modes).zip(&prepared.response) {
            let force = mode.hub[0] * loads[0] + mode.hub[1] * loads[1] + mode.weight * self.scenario.gravity;
            let end = Self::moved(mode, *at, *response, step, force);
            rim += mode.rim * end;
            hub += mode.hub[1] * end;
            hub_now += mode.hub[1] * at[0];
        }
        let [w, velocity] = state.suspended;
        let suspended = w + step * velocity + prepared.suspended_response * loads[2];
        let [end, start] = prepared.coupling;
        let suspension = prepared.share * (end * (suspended - hub) + start * (w - hub_now));
        Free { rim: rim + prepared.from_hub * suspension, suspension, loads }
    }

    /// The state after a step under the mean `force` on the rim.
    pub fn finish(
        &self,
        prepared: &Prepared,
        state: &WheelState,
        free: &Free,
        force: &Vector3<f64>,
        next: &mut WheelState,
    ) {
        let step = prepared.step;
        let suspension =
            free.suspension - prepared.share * prepared.coupling[0] * prepared.from_hub.dot(force);
        let modes = self.modes.iter().zip(&state.modes).zip(&prepared.response).zip(&mut next.modes);
        let mut hub = 0.0;
        for (((mode, at), response), after) in modes {
            let load = mode.hub[0] * free.loads[0]
                + mode.hub[1] * (free.loads[1] + suspension)
                + mode.weight * self.scenario.gravity
                + mode.rim.dot(force);
            let end = Self::moved(mode, *at, *response, step, load);
            *after = [end, 2.0 * (end - at[0]) / step - at[1]];
            hub += mode.hub[1] * end;
        }
        let [w, velocity] = state.suspended;
        next.suspended = if self.scenario.suspended_mass > 0.0 {
            let end = w + step * velocity + prepared.suspended_response * (free.loads[2] - suspension);
            [end, 2.0 * (end - w) / step - velocity]
        } else {
            [hub, 0.0]
        };
    }

    /// Energies after a step of `step` s that went on from `free`, with the works in it, J; without a step those of a state.
    pub fn energy(&self, before: &WheelState, after: &WheelState, taken: Option<(f64, &Free)>) -> PartEnergy {
        let (step, loads) = taken.map_or((0.0, [0.0; 3]), |(step, free)| (step, free.loads));
        let scenario = self.scenario;
        let mut energy = PartEnergy::default();
        for ((mode, a), b) in self.modes.iter().zip(&before.modes).zip(&after.modes) {
            let moved = b[0] - a[0];
            energy.kinetic += 0.5 * b[1] * b[1];
            energy.elastic += 0.5 * mode.square * b[0] * b[0];
            let load = mode.hub[0] * loads[0] + mode.hub[1] * loads[1] + mode.weight * scenario.gravity;
            energy.work += load * moved;
            energy.damped += if step > 0.0 { mode.damping * moved * moved / step } else { 0.0 };
        }
        if scenario.suspended_mass > 0.0 {
            let spring = scenario.vertical_suspension;
            let stroke = |state: &WheelState| state.suspended[0] - self.hub(state)[1];
            let (now, moved) = (stroke(after), stroke(after) - stroke(before));
            energy.kinetic += 0.5 * scenario.suspended_mass * after.suspended[1].powi(2);
            energy.elastic += 0.5 * spring.stiffness * now * now;
            energy.work += loads[2] * (after.suspended[0] - before.suspended[0]);
            energy.damped += if step > 0.0 { spring.damping * moved * moved / step } else { 0.0 };
        }
        energy
    }
}

impl WheelState {
    /// Whether all of it are numbers.
    pub fn is_finite(&self) -> bool {
        self.modes.iter().chain([&self.suspended]).flatten().all(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests;
