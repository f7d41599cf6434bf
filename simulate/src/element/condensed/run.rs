//! The state of a run of the condensed model, and its steps.

use std::ops::ControlFlow;

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::time::energy::{EnergyBalance, EnergyLedger, PartEnergy};
use crate::time::history::{ContactMode, ContactState, Ending, HistoryRow};
use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::Newmark;
use crate::time::scenario::Scenario;
use railspring_calibrate::beam::RailBeam;
use railspring_element::overlap::Pose;
use railspring_element::strips::{Contact, ContactStrips};
use railspring_profiles::error::{NumericsError, Result, StopReason};
use railspring_profiles::placement::departure;

use super::model::CondensedModel;
use super::wheel::{self, Free, Wheel, WheelState};
use crate::element::published::{Rail, RailDynamics, RailState, SectionMotion, Travel, at_end};
use railspring_element::contact::SLIDING;
use railspring_element::head::{Head, HeadAt};
use railspring_element::outline::Outline;
use railspring_element::step::{Meeting, Side, Step, arm, transport};

/// What a force may be off at the end of a step, N: a ten-thousandth of a usual load.
const FORCE: f64 = 10.0;

/// The largest share of the normal forces with which energy that steps have made is given back, and the work in a step, of their energy, in which half of it is. A contact that begins and ends within steps
/// of a study makes a thousandth of its energy.
const MOST_GIVEN_BACK: f64 = 0.002;
const LEAST_WORK: f64 = 0.03;

/// State between two steps.
#[derive(Clone)]
pub(super) struct State {
    at: Meeting,
    /// The head where the wheel is.
    head: HeadAt,
    wheel: WheelState,
    rail: Option<RailState>,
    pub ledger: EnergyLedger,
    /// Energy that the steps have made of the normal forces, J.
    pub made: f64,
    /// What of it is to be given back, J: all that had been made when nothing touched for the last time. As long as a contact lasts, most of what its steps make comes back by itself, as the wheel goes back
    /// over the same forces, and to give that back turns an error of the fourth order of the step into one of the second.
    owed: f64,
    /// Velocity of the wheel against the rail in the step to here.
    velocity: Vector3<f64>,
}

/// Everything that stays the same during a run.
pub(super) struct Run<'a> {
    model: &'a CondensedModel,
    pub scenario: &'a Scenario,
    wheel: Wheel<'a>,
    rail: Option<RailDynamics<'a>>,
    travel: Travel<'a>,
    pub references: [Vector2<f64>; 2],
    head: Head,
    /// Static stiffness of the middle of the rail with its head (y, z), N/m.
    rail_stiffness: [f64; 2],
    /// Points of both running surfaces from their reference points, m.
    outlines: [Outline; 2],
}

/// Steps of one length prepared.
pub(super) struct Prepared<'r> {
    wheel: wheel::Prepared,
    rail: Option<Rail<'r>>,
}

impl State {
    /// Force of the contacts on the wheel (y, z), N.
    pub fn force(&self) -> [f64; 2] {
        self.at.contacts.all.force.xy().into()
    }

    /// Motion of the rail's section at the wheel.
    pub fn section(&self) -> SectionMotion {
        let rail = self.at.pose.rail;
        SectionMotion { displacement: [rail.x, rail.y], rotation: rail.z }
    }

    /// Energy of the normal forces, J.
    pub fn normal_energy(&self) -> f64 {
        self.at.contacts.elastic()[0]
    }
}

/// Between directions 1, 2 and rotation 3 and the world: its own inverse.
fn to_world() -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))
}

impl<'a> Run<'a> {
    pub fn new(model: &'a CondensedModel, scenario: &'a Scenario) -> Result<Self> {
        let references = [model.tape.coords, model.support.reference(&model.rail).coords];
        let outlines = [
            Outline::new(model.wheel.knot_points().collect()),
            Outline::new(model.rail.curve.knot_points().map(|p| p - references[1]).collect()),
        ];
        let head = model.head();
        let rail_stiffness = model.support.beam().map_or([0.0; 2], |beam| {
            let middle = 0.5 * beam.length();
            let flexibility = beam.section_flexibility(middle) + head.at(middle).flexibility;
            [0, 1].map(|i| 1.0 / flexibility[(i, i)])
        });
        Ok(Self {
            model,
            scenario,
            rail_stiffness,
            wheel: Wheel::new(&model.element.wheel, scenario, model.axle, model.damping)?,
            head,
            rail: model.support.dynamics(),
            travel: Travel::new(scenario, &model.support),
            references,
            outlines,
        })
    }

    /// State at t = 0: hub and rail where the initial motion puts them, rim and head as statics have them between them.
    pub fn start(&self, strips: &mut ContactStrips) -> Result<State> {
        let mut wheel = self.wheel.start(&self.model.initial);
        let rim = self.wheel.rim(&wheel);
        let load = self.travel.load(0.0);
        let head = self.head.at(load.x);
        let step = Step {
            wheel: Side { free: rim, flexibility: self.wheel.rest },
            rail: Side { free: head.moved(&Vector3::zeros(), load.torsion), flexibility: head.flexibility },
            law: &self.model.element.strips,
            friction: 0.0,
            beside: Vector3::zeros(),
            tolerance: FORCE,
            references: self.references,
        };
        let (at_rest, mut at) = (Meeting::default(), Meeting::default());
        step.solve(strips, &at_rest, &mut at).map_err(|error| error.at_step(0))?;
        strips.commit(step.friction);
        // from here on there is friction, which has taken up nothing yet
        at.contacts.look(strips, step.law, &at.pose, self.scenario.friction);
        self.wheel.accelerate(&mut wheel, &at.contacts.all.force);
        let on_beam = to_world() * head.share * self.on_rail(&at);
        let rail = self.rail.as_ref().map(|rail| rail.start(&load, on_beam)).transpose()?;
        let (ledger, velocity) = (EnergyLedger::default(), Vector3::zeros());
        let mut state = State { at, head, wheel, rail, ledger, made: 0.0, owed: 0.0, velocity };
        state.ledger = EnergyLedger::new(self.stored(&state, 0.0));
        Ok(state)
    }

    /// Force on the rail's section with its moment about the reference point, world.
    fn on_rail(&self, at: &Meeting) -> Vector3<f64> {
        -transport(&arm(&self.references, &at.pose)).tr_mul(&at.force())
    }

    /// Energy of contacts and of the parts that follow their forces at a `time` (s), J.
    fn elastic(&self, State { at, head, .. }: &State, time: f64) -> f64 {
        let force = at.force();
        let of_head = head.stored(&self.on_rail(at), self.travel.load(time).torsion);
        at.contacts.elastic().iter().sum::<f64>() + 0.5 * force.dot(&(self.wheel.rest * force)) + of_head
    }

    /// Tries a step to a state; how often it looked at the contacts, or how the run ends in it.
    pub fn attempt(
        &self,
        strips: &mut ContactStrips,
        [now, next]: [&mut State; 2],
        prepared: &Prepared<'_>,
        times: [f64; 2],
    ) -> Result<ControlFlow<Ending, usize>> {
        if let Some(ending) = self.travel.ending(times[1]) {
            return Ok(ControlFlow::Break(ending));
        }
        let looks = self.step(strips, now, next, prepared, times)?;
        Ok(self.ending(next, times[1]).map_or(ControlFlow::Continue(looks), ControlFlow::Break))
    }

    /// Prepares steps of one length, s.
    pub fn prepare(&self, step: f64) -> Result<Prepared<'_>> {
        let rail = self.rail.as_ref().map(|rail| rail.over(&Newmark::new(step, 0.0))).transpose()?;
        Ok(Prepared { wheel: self.wheel.prepare(step), rail })
    }

    /// One step from `state` to `next`; its iterations.
    fn step(
        &self,
        strips: &mut ContactStrips,
        state: &State,
        next: &mut State,
        prepared: &Prepared<'_>,
        times: [f64; 2],
    ) -> Result<usize> {
        let Prepared { wheel, rail } = prepared;
        let free = self.wheel.free(wheel, &state.wheel, times);
        let rim = Side { free: free.rim, flexibility: wheel.flexibility + self.wheel.rest };
        let load = self.travel.load(times[1]);
        let rail_step = match (rail, &state.rail, &mut next.rail) {
            (Some(rail), Some(before), Some(after)) => Some(rail.predict(before, &load, after)),
            _ => None,
        };
        next.head = if self.scenario.speed == 0.0 { state.head } else { self.head.at(load.x) };
        let of_head = &next.head;
        let mut on_head =
            Side { free: of_head.moved(&Vector3::zeros(), load.torsion), flexibility: of_head.flexibility };
        if let Some(step) = &rail_step {
            let share = of_head.share * to_world();
            let flexibility = Matrix3::from_fn(|i, j| step.flexibility()[(i, j)]);
            on_head.free += share * Vector3::from_column_slice(step.free());
            on_head.flexibility += share * flexibility * share.transpose();
        }
        let step = Step {
            wheel: rim,
            rail: on_head,
            law: &self.model.element.strips,
            friction: self.scenario.friction,
            beside: give_back(state, times[1] - times[0]),
            tolerance: FORCE,
            references: self.references,
        };
        let looks = step.solve(strips, &state.at, &mut next.at)?;
        self.wheel.finish(wheel, &state.wheel, &free, &next.at.force(), &mut next.wheel);
        if let Some(step) = rail_step {
            step.finish((to_world() * next.head.share * self.on_rail(&next.at)).as_slice());
        }
        let moved = self.moved(&state.at, &next.at);
        let works = self.worked(state, next, times, &free, &moved);
        next.ledger = state.ledger.worked(&works);
        next.made = state.made + made(&state.at, &next.at, &moved);
        let given = 0.5 * (state.at.beside + next.at.beside).dot(&moved);
        next.owed = if next.at.contacts.list.is_empty() { next.made } else { state.owed + given };
        next.velocity = moved / (times[1] - times[0]);
        if next.wheel.is_finite() && (works.work + works.damped + works.friction).is_finite() {
            return Ok(looks);
        }
        let active = next.at.contacts.list.len();
        Err(NumericsError::new("condensed element", StopReason::NotFinite, f64::NAN, active)
            .after(looks)
            .into())
    }

    /// Energies of a state at a `time` (s), J.
    pub fn stored(&self, state: &State, time: f64) -> PartEnergy {
        let of_rail = self.rail.as_ref().zip(state.rail.as_ref()).map(|(rail, state)| rail.stored(state));
        let of_contact = PartEnergy { elastic: self.elastic(state, time), ..PartEnergy::default() };
        self.wheel.stored(&state.wheel) + of_rail.unwrap_or_default() + of_contact
    }

    /// Motion of the wheel against the rail in a step.
    fn moved(&self, before: &Meeting, after: &Meeting) -> Vector3<f64> {
        let to_wheel = transport(&arm(&self.references, &after.pose));
        after.pose.wheel - before.pose.wheel - to_wheel * (after.pose.rail - before.pose.rail)
    }

    /// Works in a step in which the wheel has `moved` against the rail, J.
    fn worked(
        &self,
        state: &State,
        next: &State,
        times: [f64; 2],
        free: &Free,
        moved: &Vector3<f64>,
    ) -> PartEnergy {
        let [before, after] = [&state.at, &next.at];
        let of_rail = match (&self.rail, &state.rail, &next.rail) {
            (Some(dynamics), Some(before), Some(after)) => {
                let torsions = times.map(|time| self.travel.load(time).torsion);
                let torsion = 0.5 * (torsions[0] + torsions[1]);
                let (heads, forces) =
                    ([&state.head, &next.head], [&state.at, &next.at].map(|at| self.on_rail(at)));
                let shares = heads.map(|head| to_world() * head.share * to_world());
                let of_beam =
                    dynamics.driven([before, after], shares, forces.map(|force| to_world() * force));
                let of_head = heads[0].driven(heads[1], [&forces[0], &forces[1]], torsions);
                let turned = heads[1].turned(&forces[1]) - heads[0].turned(&forces[0]);
                let work = of_beam + of_head + torsion * turned;
                let beside = PartEnergy { work, ..PartEnergy::default() };
                dynamics.worked(before, after, torsion, times[1] - times[0]) + beside
            }
            _ => PartEnergy::default(),
        };
        let work = 0.5 * (before.contacts.friction() + after.contacts.friction()).dot(moved);
        // what friction took and the springs along the contacts do not have
        let friction = before.contacts.elastic()[1] - after.contacts.elastic()[1] - work;
        let of_contact = PartEnergy { friction, ..PartEnergy::default() };
        self.wheel.worked(&state.wheel, &next.wheel, free) + of_rail + of_contact
    }

    /// Elastic state of the bodies as forces, N: those that would displace rim and rail as much in rest.
    pub fn elastic_state(&self, state: &State, forces: &mut Vec<f64>) {
        forces.clear();
        self.wheel.elastic_state(&state.wheel, forces);
        let rail = state.at.pose.rail;
        forces.extend([0, 1].map(|i| self.rail_stiffness[i] * rail[i]));
    }

    pub fn degrees_of_freedom(&self) -> usize {
        self.model.support.beam().map_or(0, RailBeam::unknowns) + self.wheel.count()
    }

    /// How a run ends whose step to `time` (s) has this state, if it does.
    fn ending(&self, state: &State, time: f64) -> Option<Ending> {
        let Pose { wheel, rail } = state.at.pose;
        let [of_wheel, of_rail] = &self.outlines;
        let places = [self.references[0].x + wheel.x, self.references[1].x + rail.x];
        if !of_wheel.is_over(of_rail, [wheel.z, rail.z], places) {
            let on_wheel = of_wheel.extent(wheel.z, places[0]);
            let on_rail = of_rail.extent(rail.z, places[1]);
            if let Some(departure) = departure(on_rail, on_wheel) {
                return Some(Ending::Departed { time, departure });
            }
        }
        let (rail_length, wheel_length) = (self.model.rail.curve.length(), self.model.wheel.length());
        state.at.contacts.list.iter().find_map(|contact| {
            let on_rail_end = [contact.extent[0] <= 0.0, contact.extent[1] >= rail_length];
            let rail_end = |side: usize| {
                let s = [0.0, rail_length][side];
                self.model.rail.to_profile(&self.model.rail.curve.point(s))
            };
            at_end([contact.wheel_s, wheel_length], on_rail_end, wheel.x - rail.x, time, rail_end)
        })
    }

    pub fn row(&self, time: f64, state: &State) -> HistoryRow {
        let [y, z] = self.wheel.hub(&state.wheel);
        let start = self.model.initial.displacement;
        let Meeting { contacts, .. } = &state.at;
        let energy: EnergyBalance = state.ledger.balance();
        HistoryRow {
            time,
            vertical_force: -contacts.all.force.y,
            lateral_force: -contacts.all.force.x,
            wheel_y: y - start[0],
            wheel_z: z - start[1],
            load_y: self.scenario.load_travel(time, y - start[0]),
            energy: Some(energy),
            contacts: contacts.list.iter().map(|contact| self.contact(contact)).collect(),
        }
    }

    fn contact(&self, contact: &Contact) -> ContactState {
        let slides = contact.sliding_share > SLIDING;
        ContactState {
            mode: if slides { ContactMode::Slip } else { ContactMode::Stick },
            rail: self.model.rail.to_profile(&self.model.rail.curve.point(contact.rail_s)),
            wheel: self.model.wheel.point(contact.wheel_s),
            normal_force: contact.normal_force,
            tangential_force: contact.tangential_force(),
        }
    }
}

/// What a step in which the wheel has `moved` against the rail makes of the energy of the normal forces, J: what they store more, less what has been done against them.
fn made(before: &Meeting, after: &Meeting, moved: &Vector3<f64>) -> f64 {
    let done = |at: &Meeting| (at.force() - at.contacts.friction()).dot(moved);
    let stored = |at: &Meeting| at.contacts.elastic()[0];
    stored(after) - stored(before) + 0.5 * (done(before) + done(after))
}

/// A share of the normal forces that gives back over a step of a length (s) what the contacts before have made of their energy.
fn give_back(state: &State, step: f64) -> Vector3<f64> {
    let normal = state.at.contacts.all.force - state.at.contacts.friction();
    let work = normal.dot(&state.velocity) * step;
    // where the wheel hardly moves, a force does no work
    let least = LEAST_WORK * state.normal_energy();
    let share = -state.owed * work / (work * work + least * least);
    if share.is_finite() { normal * share.clamp(-MOST_GIVEN_BACK, MOST_GIVEN_BACK) } else { Vector3::zeros() }
}
