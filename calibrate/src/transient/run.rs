//! The steps of a run, whatever the order of its bodies.

use super::body::{BodyLoad, ElasticBody};
use super::contact::{StepContact, failure};
use super::last_contact::LastContact;
use super::{TransientModel, TransientRun, scheme};
use crate::contact::{ContactPoint, PointMode, Side, Solution, resultant};
use crate::error::{Result, StopReason};
use crate::history::{ContactMode, ContactState, Ending, History, HistoryRow};
use crate::monitor::Monitor;
use crate::newmark::{Motion, Newmark};
use crate::placement::{departure, lateral_extent};
use crate::scenario::Scenario;
use crate::suspension::{Suspension, SuspensionStep};
use nalgebra::{Point2, Vector2};

/// A run that goes on from step to step.
pub(super) struct Run<'m, B: ElasticBody> {
    model: &'m TransientModel<'m>,
    scenario: &'m Scenario,
    /// Rail and wheel.
    bodies: [&'m B; 2],
    states: [B::State; 2],
    hub: HubMotion,
    suspension: Suspension,
    step_contact: StepContact<'m>,
    contact: LastContact,
    rows: Vec<HistoryRow>,
    ending: Ending,
    most_active: usize,
}

/// What an observer sees of a finished step.
#[cfg_attr(not(test), expect(dead_code, reason = "the energy balance of the tests is made from it"))]
pub(super) struct Step<'s> {
    /// Displacements of the contact nodes of rail and wheel, m.
    pub displacements: [&'s [f64]; 2],
    pub contact: &'s LastContact,
    /// Contact forces on the retained equations of each body, N.
    pub forces: &'s [Vec<f64>; 2],
    pub hub: &'s HubMotion,
    /// Of rail and wheel.
    #[cfg(test)]
    pub sums: [super::body::Sums; 2],
}

impl<'m, B: ElasticBody> Run<'m, B> {
    /// Just touching, the wheel and the suspended mass with a velocity (y, z), m/s.
    pub fn new(
        model: &'m TransientModel<'m>,
        scenario: &'m Scenario,
        velocity: &Vector2<f64>,
        bodies: [&'m B; 2],
    ) -> Self {
        let scheme = scheme(scenario);
        let [rail, wheel] = bodies;
        let hub = HubMotion::at_start(scenario, velocity, wheel.mass());
        let rest = Vector2::zeros();
        Self {
            model,
            scenario,
            bodies,
            states: [rail.in_motion(&rest, &rest), wheel.in_motion(&hub.velocity(), &hub.acceleration())],
            hub,
            suspension: Suspension::new(scenario, &scheme),
            step_contact: StepContact::new(model, scenario, &scheme),
            contact: LastContact::default(),
            rows: vec![HistoryRow {
                time: 0.0,
                vertical_force: 0.0,
                lateral_force: 0.0,
                wheel_y: 0.0,
                wheel_z: 0.0,
                load_y: scenario.load_travel(0.0, 0.0),
                contacts: Vec::new(),
            }],
            ending: Ending::Completed,
            most_active: 0,
        }
    }

    /// The states so far.
    pub fn rows(&self) -> &[HistoryRow] {
        &self.rows
    }

    /// Goes on to the end of step `last`, unless the wheel leaves the rail before.
    pub fn to(
        &mut self,
        last: usize,
        monitor: &dyn Monitor,
        observe: &mut dyn FnMut(&Step) -> Result<()>,
    ) -> Result<()> {
        while self.rows.len() <= last && self.ending == Ending::Completed {
            let step = self.rows.len();
            monitor.progress("transient solid model", step - 1, self.scenario.steps)?;
            let mut row = None;
            for inner in 1..=self.scenario.inner_steps {
                let number = (step - 1) * self.scenario.inner_steps + inner;
                row = self.step(number, observe).map_err(|e| e.at_step(step))?;
                if row.is_none() {
                    break;
                }
            }
            self.rows
                .extend(row.map(|row| HistoryRow { time: step as f64 * self.scenario.time_step, ..row }));
        }
        monitor.progress("transient solid model", self.rows.len() - 1, self.scenario.steps)
    }

    /// Step `number` of the integration, and the state at its end; none where the wheel has left the rail.
    fn step(
        &mut self,
        number: usize,
        observe: &mut dyn FnMut(&Step) -> Result<()>,
    ) -> Result<Option<HistoryRow>> {
        let scenario = self.scenario;
        let scheme = scheme(scenario);
        let t = number as f64 * scheme.step();
        let (hub, suspended) = self.hub.forces(scenario, t, &self.suspension);
        let wheel_load = BodyLoad { hub, gravity: scenario.gravity };
        let [rail_state, wheel_state] = &self.states;
        let steps =
            B::predict_both(self.bodies, [rail_state, wheel_state], [&BodyLoad::default(), &wheel_load]);
        let interfaces = [B::interface(&steps[0]), B::interface(&steps[1])];
        let [rail_step, wheel_step] = &interfaces;
        let predicted = self.hub.predicted(scheme.step());
        let solved = self.step_contact.solve([rail_step, wheel_step], &predicted, &self.contact)?;
        let on = |side, free: &[f64]| solved.nodal_forces(side, free.len());
        let forces = [on(Side::Base, rail_step.free), on(Side::Opposing, wheel_step.free)];
        let states = B::finish_both(steps, &forces);
        let (points, solution) = (&solved.points, &solved.solution);
        self.most_active = self.most_active.max(solution.active());
        let hub = self.bodies[1].hub(&states[1]);
        if !(hub.x.is_finite() && hub.y.is_finite()) {
            return Err(failure(f64::NAN, solution.active(), StopReason::NotFinite));
        }
        let model = self.model;
        let rail_extent = lateral_extent(model.placed_rail.curve.knot_points());
        if let Some(departure) = departure(rail_extent, model.wheel_extent().map(|y| y + hub.x)) {
            self.ending = Ending::Departed { time: t, departure };
            return Ok(None);
        }
        self.hub.advance(&scheme, &hub, &self.suspension, &suspended);
        let force = resultant(points, &solution.forces);
        let row = HistoryRow {
            time: t,
            vertical_force: -force.z,
            lateral_force: -force.y,
            wheel_y: hub.x,
            wheel_z: hub.y,
            load_y: scenario.load_travel(t, hub.x),
            contacts: model.contacts(points, solution),
        };
        let [rail, wheel] = self.bodies;
        observe(&Step {
            displacements: [rail.contact_displacement(&states[0]), wheel.contact_displacement(&states[1])],
            contact: &solved,
            forces: &forces,
            hub: &self.hub,
            #[cfg(test)]
            sums: [rail.sums(&states[0]), wheel.sums(&states[1])],
        })?;
        self.states = states;
        self.contact = solved;
        Ok(Some(row))
    }

    /// The run as far as it has come.
    pub fn ended(self, reduction: Option<super::Reduction>) -> TransientRun {
        let [rail, wheel] = self.bodies;
        TransientRun {
            history: History {
                rows: self.rows,
                degrees_of_freedom: rail.equations() + wheel.equations() + 1,
                ending: self.ending,
            },
            wheel_mass: wheel.mass(),
            factor_values: rail.factor_values() + wheel.factor_values(),
            most_active: self.most_active,
            reduction,
        }
    }
}

impl TransientModel<'_> {
    /// Lateral positions of the ends of the wheel's running surface at t = 0, m.
    fn wheel_extent(&self) -> [f64; 2] {
        let surface = &self.wheel_surface;
        lateral_extent(surface.curve.knot_points()).map(|y| y + surface.origin.x)
    }

    /// The patches that carry load: runs of load-carrying grid lines with at least two free lines between them.
    fn contacts(&self, points: &[ContactPoint], solution: &Solution) -> Vec<ContactState> {
        let n = points.len();
        let active: Vec<usize> = (0..n).filter(|&j| solution.forces[j] > 0.0).collect();
        let mut patches: Vec<Vec<usize>> = Vec::new();
        for &j in &active {
            match patches.last_mut() {
                Some(patch) if points[j].index.0 <= points[patch[patch.len() - 1]].index.0 + 2 => {
                    patch.push(j)
                }
                _ => patches.push(vec![j]),
            }
        }
        patches
            .iter()
            .map(|patch| {
                let force: f64 = patch.iter().map(|&j| solution.forces[j]).sum();
                let mean = |value: &dyn Fn(usize) -> f64| {
                    patch.iter().map(|&j| solution.forces[j] * value(j)).sum::<f64>() / force
                };
                let s = mean(&|j| points[j].position.x);
                let slipping = mean(&|j| f64::from(solution.modes[j] == PointMode::Slip));
                ContactState {
                    mode: if slipping > 0.5 { ContactMode::Slip } else { ContactMode::Stick },
                    rail: self.placed_rail.to_profile(&self.rail_surface.world(s)),
                    wheel: Point2::new(
                        mean(&|j| points[j].opposing_position.x),
                        mean(&|j| points[j].opposing_position.y),
                    ),
                    normal_force: force,
                    tangential_force: patch
                        .iter()
                        .map(|&j| solution.forces.get(n + j).copied().unwrap_or(0.0))
                        .sum(),
                }
            })
            .collect()
    }
}

/// Motion of the hub and of the suspended mass, positive down and to the field side.
pub(super) struct HubMotion {
    /// Of the hub along y and z.
    hub: [Motion; 2],
    /// Of the suspended mass along z.
    pub suspended: Motion,
}

impl HubMotion {
    /// With the accelerations of the rigid bodies under the forces of t = 0.
    fn at_start(scenario: &Scenario, velocity: &Vector2<f64>, wheel_mass: f64) -> Self {
        let mut hub = [velocity.x, velocity.y].map(|v| Motion { v, ..Motion::default() });
        let mut suspended = hub[1];
        let (force, acceleration) = Suspension::start(scenario, &hub[1], &suspended, load(scenario, 0.0));
        hub[0].a = scenario.lateral_force.at(0.0) / wheel_mass;
        hub[1].a = scenario.gravity + force / wheel_mass;
        suspended.a = acceleration;
        Self { hub, suspended }
    }

    pub fn position(&self) -> Vector2<f64> {
        Vector2::new(self.hub[0].u, self.hub[1].u)
    }

    fn velocity(&self) -> Vector2<f64> {
        Vector2::new(self.hub[0].v, self.hub[1].v)
    }

    fn acceleration(&self) -> Vector2<f64> {
        Vector2::new(self.hub[0].a, self.hub[1].a)
    }

    /// Position at the end of a step of constant acceleration.
    fn predicted(&self, dt: f64) -> Vector2<f64> {
        self.position() + self.velocity() * dt + self.acceleration() * (0.5 * dt * dt)
    }

    /// Forces (y, z) on the hub at time `t` with the suspended mass condensed, and the step of the suspension.
    fn forces(&self, scenario: &Scenario, t: f64, suspension: &Suspension) -> ([f64; 2], SuspensionStep) {
        let step = suspension.step(&self.hub[1], &self.suspended, load(scenario, t));
        ([scenario.lateral_force.at(t), step.transmitted + step.damper], step)
    }

    fn advance(
        &mut self,
        scheme: &Newmark,
        hub: &Vector2<f64>,
        suspension: &Suspension,
        step: &SuspensionStep,
    ) {
        self.hub = [0, 1].map(|i| scheme.advance(&self.hub[i], hub[i]));
        self.suspended = suspension.finish(step, &self.suspended, hub.y);
    }
}

/// Vertical load on the suspended mass at time `t`, its weight included, N.
fn load(scenario: &Scenario, t: f64) -> f64 {
    scenario.vertical_force.at(t) + scenario.suspended_mass * scenario.gravity
}
