//! The steps of a run, whatever the order of its bodies.

use super::body::{BodyLoad, ElasticBody};
use super::contact::{StepContact, failure};
use super::last_contact::LastContact;
use super::load_case::longest;
use super::model::TransientModel;
use super::transient_run::{StepCounts, TransientRun};
use crate::time::energy::{EnergyLedger, PartEnergy};
use crate::time::history::{ContactMode, ContactState, Ending, History, HistoryRow, SurfaceEnd};
use crate::time::newmark::{Motion, Newmark};
use crate::time::scenario::Scenario;
use crate::time::steps::StepSequence;
use crate::time::suspension::{Suspension, SuspensionStep};
use nalgebra::{Point2, Vector2};
use railspring_calibrate::contact::{ContactPoint, PointMode, Side, Solution, resultant};
use railspring_profiles::error::{Error, Result, StopReason};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::placement::{departure, lateral_extent};

/// A run that goes on from step to step.
pub(super) struct Run<'m, B: ElasticBody> {
    model: &'m TransientModel<'m>,
    scenario: &'m Scenario,
    /// What steps of each length need: those of the whole time step first, each of the others half as long as the one before.
    lengths: Vec<StepLength<'m, B>>,
    /// Makes the bodies for steps of another length.
    shorter: &'m ShorterSteps<'m, B>,
    sequence: StepSequence,
    states: [B::State; 2],
    hub: HubMotion,
    contact: LastContact,
    rows: Vec<HistoryRow>,
    ending: Ending,
    steps: StepCounts,
    /// None of bodies that do not give their energies.
    ledger: Option<EnergyLedger>,
}

/// Rail and wheel for steps of one length.
pub(super) type ShorterSteps<'m, B> = dyn Fn(&Newmark) -> Result<[B; 2]> + 'm;

/// What steps of one length need.
struct StepLength<'m, B> {
    scheme: Newmark,
    /// Rail and wheel.
    bodies: [MaybeOwned<'m, B>; 2],
    suspension: Suspension,
    contact: StepContact<'m>,
}

/// The bodies of the longest steps are the caller's.
enum MaybeOwned<'m, B> {
    Borrowed(&'m B),
    Owned(B),
}

impl<B> MaybeOwned<'_, B> {
    fn get(&self) -> &B {
        match self {
            Self::Borrowed(body) => body,
            Self::Owned(body) => body,
        }
    }
}

impl<'m, B> StepLength<'m, B> {
    fn new(
        model: &'m TransientModel<'m>,
        scenario: &Scenario,
        scheme: Newmark,
        bodies: [MaybeOwned<'m, B>; 2],
    ) -> Self {
        let suspension = Suspension::new(scenario, &scheme);
        Self { scheme, bodies, suspension, contact: StepContact::new(model, scenario, &scheme) }
    }

    fn bodies(&self) -> [&B; 2] {
        self.bodies.each_ref().map(MaybeOwned::get)
    }
}

/// The end of a step, which is not yet the state of the run.
struct StepEnd<B: ElasticBody> {
    states: [B::State; 2],
    hub: HubMotion,
    contact: LastContact,
    /// Contact forces on the retained equations of each body, N.
    forces: [Vec<f64>; 2],
    row: HistoryRow,
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
    /// Its length, s.
    #[cfg(test)]
    pub length: f64,
    /// Of rail and wheel.
    #[cfg(test)]
    pub sums: [super::body::Sums; 2],
}

/// Where the wheel meets the rail, and the end of the meshed surfaces before it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reached {
    pub end: SurfaceEnd,
    /// The place in the rail's profile frame, m.
    pub rail: Point2<f64>,
}

/// Sees every finished step; the run ends before a step that has reached an end of the surfaces.
pub(super) type Observer<'o> = dyn FnMut(&Step) -> Result<Option<Reached>> + 'o;

impl<'m, B: ElasticBody> Run<'m, B> {
    /// Just touching, the wheel and the suspended mass with a velocity (y, z), m/s.
    pub fn new(
        model: &'m TransientModel<'m>,
        scenario: &'m Scenario,
        velocity: &Vector2<f64>,
        bodies: [&'m B; 2],
        shorter: &'m ShorterSteps<'m, B>,
    ) -> Self {
        let [rail, wheel] = bodies;
        let hub = HubMotion::at_start(scenario, velocity, wheel.mass());
        let rest = Vector2::zeros();
        let states = [rail.in_motion(&rest, &rest), wheel.in_motion(&hub.velocity(), &hub.acceleration())];
        let at_start =
            rail.energy(&states[0], &states[0], 0.0).zip(wheel.energy(&states[1], &states[1], 0.0));
        let ledger = at_start
            .map(|(rail, wheel)| EnergyLedger::new(rail + wheel + hub.energy(&hub, scenario, [0.0; 2])));
        Self {
            model,
            scenario,
            lengths: vec![StepLength::new(
                model,
                scenario,
                longest(scenario),
                bodies.map(MaybeOwned::Borrowed),
            )],
            shorter,
            sequence: StepSequence::new(scenario.inner_steps, scenario.largest_load()),
            states,
            hub,
            contact: LastContact::default(),
            rows: vec![HistoryRow {
                time: 0.0,
                vertical_force: 0.0,
                lateral_force: 0.0,
                wheel_y: 0.0,
                wheel_z: 0.0,
                load_y: scenario.load_travel(0.0, 0.0),
                energy: ledger.map(|ledger| ledger.balance()),
                contacts: Vec::new(),
            }],
            ending: Ending::Completed,
            steps: StepCounts::default(),
            ledger,
        }
    }

    /// All time steps, unless the wheel leaves the rail or the contact the surfaces before.
    pub fn finish(&mut self, (stage, monitor): (&str, &dyn Monitor), observe: &mut Observer) -> Result<()> {
        let most = self.scenario.inner_steps.most();
        while self.rows.len() <= self.scenario.steps && self.ending == Ending::Completed {
            let step = self.rows.len();
            monitor.progress(stage, step - 1, self.scenario.steps)?;
            let mut row = None;
            while self.sequence.ticks() < step * most {
                row = self.step(observe).map_err(|e| e.at_step(step))?;
                if row.is_none() {
                    break;
                }
            }
            self.rows
                .extend(row.map(|row| HistoryRow { time: step as f64 * self.scenario.time_step, ..row }));
        }
        monitor.progress(stage, self.rows.len() - 1, self.scenario.steps)
    }

    /// The next step of the integration, as short as it has to be, and the state at its end; none where the wheel has left the rail, or
    /// the contact the surfaces.
    fn step(&mut self, observe: &mut Observer) -> Result<Option<HistoryRow>> {
        loop {
            let level = self.sequence.level();
            self.prepare(level)?;
            let time = self.sequence.end() as f64 * self.scenario.shortest_step();
            let end = match self.attempt(level, time) {
                Err(Error::Numerics(_)) if self.sequence.shorten() => continue,
                end => end?,
            };
            self.steps.tried += 1;
            let force = [end.row.vertical_force, end.row.lateral_force];
            let [rail, wheel] = self.lengths[level].bodies();
            let elastic = [rail.elastic(&end.states[0]), wheel.elastic(&end.states[1])].concat();
            if !self.sequence.accept(&force, &elastic, 0.0) {
                continue;
            }
            let model = self.model;
            let rail_extent = lateral_extent(model.placed_rail.curve.knot_points());
            let hub = end.hub.position();
            if let Some(departure) = departure(rail_extent, model.wheel_extent().map(|y| y + hub.x)) {
                self.ending = Ending::Departed { time, departure };
                return Ok(None);
            }
            let reached = observe(&Step {
                displacements: [
                    rail.contact_displacement(&end.states[0]),
                    wheel.contact_displacement(&end.states[1]),
                ],
                contact: &end.contact,
                forces: &end.forces,
                hub: &end.hub,
                #[cfg(test)]
                length: self.lengths[level].scheme.step(),
                #[cfg(test)]
                sums: [rail.sums(&end.states[0]), wheel.sums(&end.states[1])],
            })?;
            if let Some(Reached { end, rail }) = reached {
                self.ending = Ending::EndOfSurface { time, end, rail };
                return Ok(None);
            }
            let before = time - self.lengths[level].scheme.step();
            self.ledger = self.entered([rail, wheel], &end, [before, time]);
            let row = HistoryRow { energy: self.ledger.map(|ledger| ledger.balance()), ..end.row };
            self.steps.taken += 1;
            self.states = end.states;
            self.hub = end.hub;
            self.contact = end.contact;
            return Ok(Some(row));
        }
    }

    /// The balance of energy with the step to `end` between two `times`, s.
    fn entered(&self, [rail, wheel]: [&B; 2], end: &StepEnd<B>, times: [f64; 2]) -> Option<EnergyLedger> {
        let ([rail_before, wheel_before], [rail_after, wheel_after]) = (&self.states, &end.states);
        let bodies = rail.energy(rail_before, rail_after, 0.0)?
            + wheel.energy(wheel_before, wheel_after, self.scenario.gravity)?;
        let contact = end
            .contact
            .energy(rail.contact_displacement(rail_after), wheel.contact_displacement(wheel_after));
        let loads = end.hub.energy(&self.hub, self.scenario, times);
        self.ledger.map(|ledger| ledger.entered(bodies + contact + loads))
    }

    /// Prepares for steps with so many halvings of the longest ones.
    fn prepare(&mut self, level: usize) -> Result<()> {
        while self.lengths.len() <= level {
            let halvings = self.lengths.len() as i32;
            let scheme = Newmark::new(longest(self.scenario).step() * 0.5_f64.powi(halvings), 0.0);
            let bodies = (self.shorter)(&scheme)?.map(MaybeOwned::Owned);
            self.lengths.push(StepLength::new(self.model, self.scenario, scheme, bodies));
        }
        Ok(())
    }

    /// A step of a length from the state of the run to `time`, s.
    fn attempt(&self, level: usize, time: f64) -> Result<StepEnd<B>> {
        let scenario = self.scenario;
        let StepLength { scheme, suspension, contact, .. } = &self.lengths[level];
        let bodies = self.lengths[level].bodies();
        let (hub, suspended) = self.hub.forces(scenario, time, suspension);
        let wheel_load = BodyLoad { hub, gravity: scenario.gravity, ..BodyLoad::default() };
        let [rail_state, wheel_state] = &self.states;
        let mut states = [B::State::default(), B::State::default()];
        let rail_load = self.model.on_rail(scenario, time);
        let loads = [&rail_load, &wheel_load];
        let steps = B::predict_both(bodies, [rail_state, wheel_state], loads, states.each_mut());
        let interfaces = [B::interface(&steps[0]), B::interface(&steps[1])];
        let [rail_step, wheel_step] = &interfaces;
        let predicted = self.hub.predicted(scheme.step());
        let solved = contact.solve([rail_step, wheel_step], &predicted, &self.contact)?;
        let on = |side, free: &[f64]| solved.nodal_forces(side, free.len());
        let forces = [on(Side::Base, rail_step.free), on(Side::Opposing, wheel_step.free)];
        B::finish_both(steps, &forces);
        let (points, solution) = (&solved.points, &solved.solution);
        let hub = bodies[1].hub(&states[1]);
        if !(hub.x.is_finite() && hub.y.is_finite()) {
            return Err(failure(f64::NAN, solution.active(), StopReason::NotFinite));
        }
        let force = resultant(points, &solution.forces);
        let row = HistoryRow {
            time,
            vertical_force: -force.z,
            lateral_force: -force.y,
            wheel_y: hub.x,
            wheel_z: hub.y,
            load_y: scenario.load_travel(time, hub.x),
            energy: None,
            contacts: self.model.contacts(points, solution),
        };
        let hub = self.hub.advanced(scheme, &hub, suspension, &suspended);
        Ok(StepEnd { states, hub, contact: solved, forces, row })
    }

    /// The run as far as it has come.
    pub fn ended(self) -> TransientRun {
        let [rail, wheel] = self.lengths[0].bodies();
        TransientRun {
            history: History {
                rows: self.rows,
                degrees_of_freedom: rail.equations() + wheel.equations() + 1,
                ending: self.ending,
            },
            wheel_mass: wheel.mass(),
            steps: self.steps,
            longer: None,
            other: None,
            reduction: None,
        }
    }
}

impl TransientModel<'_> {
    /// What acts on the rail at time `t`, s, besides the contact, and where that is.
    fn on_rail(&self, scenario: &Scenario, t: f64) -> BodyLoad {
        let place = self.path.map_or(0.0, |path| path.place(scenario, t));
        let torsion = scenario.rail_torsion.as_ref().map_or(0.0, |torsion| torsion.at(t));
        BodyLoad { place, torsion, ..BodyLoad::default() }
    }

    /// Lateral positions of the ends of the wheel's running surface at t = 0, m.
    fn wheel_extent(&self) -> [f64; 2] {
        let surface = &self.wheel_surface;
        lateral_extent(surface.curve.knot_points()).map(|y| y + surface.origin.x)
    }

    /// The most loaded point at the edge of the surfaces, in the rail's profile frame, m.
    pub(super) fn loaded_edge(&self, contact: &LastContact) -> Point2<f64> {
        let at_edge = contact.points.iter().zip(&contact.solution.forces).filter(|(point, _)| point.at_edge);
        let most = at_edge.max_by(|a, b| a.1.total_cmp(b.1));
        let s = most.map_or(f64::NAN, |(point, _)| point.position.x);
        self.placed_rail.to_profile(&self.rail_surface.world(s))
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
    pub(super) fn at_start(scenario: &Scenario, velocity: &Vector2<f64>, wheel_mass: f64) -> Self {
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

    /// Energy of the suspended mass and its spring, and the work of the forces in the step from `before` between two `times` (s), J.
    fn energy(&self, before: &Self, scenario: &Scenario, times: [f64; 2]) -> PartEnergy {
        let mean = |of: &dyn Fn(f64) -> f64| 0.5 * (of(times[0]) + of(times[1]));
        let lateral = mean(&|t| scenario.lateral_force.at(t)) * (self.hub[0].u - before.hub[0].u);
        let vertical = Suspension::energy(
            scenario,
            [&before.hub[1], &before.suspended],
            [&self.hub[1], &self.suspended],
            mean(&|t| load(scenario, t)),
            times[1] - times[0],
        );
        PartEnergy { work: lateral, ..PartEnergy::default() } + vertical
    }

    /// The motion at the end of a step, with the hub at `hub` (m).
    fn advanced(
        &self,
        scheme: &Newmark,
        hub: &Vector2<f64>,
        suspension: &Suspension,
        step: &SuspensionStep,
    ) -> Self {
        Self {
            hub: [0, 1].map(|i| scheme.advance(&self.hub[i], hub[i])),
            suspended: suspension.finish(step, &self.suspended, hub.y),
        }
    }
}

/// Vertical load on the suspended mass at time `t`, its weight included, N.
fn load(scenario: &Scenario, t: f64) -> f64 {
    scenario.vertical_force.at(t) + scenario.suspended_mass * scenario.gravity
}
