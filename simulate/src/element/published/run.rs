//! The time loop of the moving solver.

use std::cell::Cell;

use nalgebra::{Matrix3, Point2, SVector, Vector2, Vector3};

use crate::time::energy::{EnergyBalance, EnergyLedger, PartEnergy};
use crate::time::history::{ContactMode, ContactState, Ending, History, HistoryRow};
use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::{Motion, Newmark};
use crate::time::scenario::Scenario;
use railspring_calibrate::beam::RailBeam;
use railspring_profiles::error::{Error, Result, StopReason};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::placement::PlacedRail;
use railspring_profiles::profile::ProfileCurve;

use super::departure::Outline;
use super::element::to_plane;
use super::interface::Interface;
use super::model::{MovingModel, MovingRun, RunStatistics, SectionMotion};
use super::solve::{Mount, Solution, StepSystem, Surroundings};
use super::support::{RailDynamics, RailState};
use super::surface::{ActiveNode, ContactLaw, ContactSurface, Pose, SlidingMatrix};
use super::travel::Travel;
use super::wheel::{WheelDynamics, WheelState};

/// Nodes further apart than this on the rail belong to different contacts, m.
const PATCH_GAP: f64 = 2e-3;

/// A step that does not converge is halved at most so many times.
const MOST_HALVINGS: usize = 5;

/// Evaluations of the contact that a run may take: at once, and for each time step begun. The published cases take
/// 20 a step in the mean and 1200 in the worst; a load case that needs a hundred times the mean is not followed by its time step.
const EVALUATIONS_AT_ONCE: usize = 50_000;
pub(super) const EVALUATIONS_A_STEP: usize = 200;

/// State between two steps.
#[derive(Clone)]
struct State {
    pose: Pose,
    wheel: WheelState,
    rail: Option<RailState>,
    spring_force: f64,
    /// Forces on the section of the rail in directions 1, 2 and moment 3.
    on_rail: Vector3<f64>,
    /// Friction limits of the rail nodes, N.
    limits: Vec<f64>,
    ledger: EnergyLedger,
}

impl State {
    fn is_finite(&self) -> bool {
        let wheel = [self.wheel.centre[0], self.wheel.centre[1], self.wheel.roll, self.wheel.suspended];
        self.pose.iter().all(|value| value.is_finite())
            && self.spring_force.is_finite()
            && wheel.iter().all(Motion::is_finite)
            // which the motion of the rail is in
            && self.ledger.balance().stored().is_finite()
    }
}

/// Everything that stays the same during a run.
pub(super) struct Run<'a> {
    pub(super) model: &'a MovingModel,
    scenario: &'a Scenario,
    dynamics: WheelDynamics<'a>,
    rail: Option<RailDynamics<'a>>,
    pub(super) law: ContactLaw,
    /// Arc length and rest position of the rail nodes in the rail's profile frame.
    pub(super) nodes: Vec<(f64, Point2<f64>)>,
    travel: Travel<'a>,
    outline: Outline,
    pub(super) evaluations_left: Cell<usize>,
    /// The memory of the last state of the rail but one, for the next.
    spare_rail: Cell<RailState>,
}

/// What became of a time step.
enum Advanced {
    /// Balance at its end.
    OnRail(Box<Solution>),
    /// The run ends before it.
    Ended(Ending),
}

impl MovingModel {
    /// Runs a scenario.
    ///
    /// # Errors
    /// [`railspring_profiles::error::InputError`] for values out of range or a wheel that starts beyond the rail's ends;
    /// [`railspring_profiles::error::NumericsError`] with step, iteration, residual and touching nodes when a step does not converge.
    pub fn run(&self, scenario: &Scenario, monitor: &dyn Monitor) -> Result<MovingRun> {
        self.check(scenario)?;
        let run = Run::new(self, scenario)?;
        let mut surface = run.surface();
        let mut statistics = RunStatistics::default();
        let mut penalty_errors = Vec::with_capacity(scenario.steps);
        let (mut state, solution) = run.start(&mut surface)?;
        let mut rows = vec![run.row(0.0, &solution, state.ledger.balance())];
        let mut rail = vec![section_motion(&solution)];
        let mut ending = Ending::Completed;
        let inner = scenario.shortest_step();
        let inner_steps = scenario.inner_steps.most();
        for number in 0..scenario.steps * inner_steps {
            let step = number / inner_steps;
            monitor.progress("simulate", step, scenario.steps)?;
            let left = run.evaluations_left.get() + EVALUATIONS_A_STEP;
            run.evaluations_left.set(left);
            let advanced = run
                .advance(&mut surface, &mut state, number as f64 * inner, inner, 0, &mut statistics)
                .map_err(|error| error.at_step(step + 1))?;
            statistics.evaluations += left - run.evaluations_left.get();
            let solution = match advanced {
                Advanced::OnRail(solution) => solution,
                Advanced::Ended(reason) => {
                    ending = reason;
                    break;
                }
            };
            penalty_errors.push(run.penalty_error(&solution));
            if (number + 1) % inner_steps == 0 {
                let time = (step + 1) as f64 * scenario.time_step;
                rows.push(run.row(time, &solution, state.ledger.balance()));
                rail.push(section_motion(&solution));
            }
        }
        let largest = penalty_errors.iter().fold(0.0, |m: f64, e| m.max(e.0));
        let counted = penalty_errors.iter().filter(|e| e.0 >= 0.1 * largest);
        statistics.penalty_error = counted.fold(0.0, |m: f64, e| m.max(e.1));
        monitor.progress("simulate", scenario.steps, scenario.steps)?;
        let history = History { rows, degrees_of_freedom: run.degrees_of_freedom(), ending };
        Ok(MovingRun { history, rail, statistics })
    }
}

impl<'a> Run<'a> {
    pub(super) fn new(model: &'a MovingModel, scenario: &'a Scenario) -> Result<Self> {
        let nodes = rail_nodes(&model.rail, model.node_spacing);
        let MovingModel { rail, wheel, wheel_radius, tape, support, .. } = model;
        let outline = Outline::new(rail, (wheel, *wheel_radius, *tape), support.reference(rail), &nodes);
        Ok(Self {
            model,
            scenario,
            dynamics: WheelDynamics {
                scenario,
                mass: scenario.wheel_mass.unwrap_or(model.wheel_mass),
                roll_inertia: (!scenario.rotations_held).then_some(model.wheel_inertia[0]),
                axle: model.axle,
            },
            rail: model.support.dynamics(),
            law: ContactLaw {
                penalty: model.penalty,
                friction: scenario.friction,
                frictionless: model.frictionless,
                sliding: model.sliding,
            },
            nodes,
            travel: Travel::new(scenario, &model.support),
            outline,
            evaluations_left: Cell::new(EVALUATIONS_AT_ONCE),
            spare_rail: Cell::default(),
        })
    }

    pub(super) fn surface(&self) -> ContactSurface<'a> {
        let MovingModel { rail, wheel, wheel_radius, tape, support, .. } = self.model;
        let master = support.reference(rail);
        surface_of(rail, &self.nodes, master, (wheel, *wheel_radius, *tape))
    }

    /// State at t = 0: wheel centre and rail where the initial motion puts them, the contact master in balance between them.
    fn start(&self, surface: &mut ContactSurface) -> Result<(State, Solution)> {
        let initial = &self.model.initial;
        let mut wheel = WheelState::default();
        let (u, v) = (to_plane(initial.displacement.into()), to_plane(initial.velocity.into()));
        for i in 0..2 {
            wheel.centre[i] = Motion { u: u[i], v: v[i], a: 0.0 };
        }
        // The suspended mass starts along with the wheel.
        wheel.suspended = wheel.centre[1];
        wheel.suspended.u -= initial.stroke(self.scenario, self.dynamics.mass);
        let mut pose = Pose::zeros();
        pose.fixed_rows_mut::<2>(0).copy_from(&u);
        surface.list(&pose, u.norm());
        let system = StepSystem {
            springs: [&self.model.springs],
            law: &self.law,
            surroundings: Surroundings {
                rails: [Interface::held(Vector3::zeros())],
                body: Interface::held(Vector3::new(u.x, u.y, 0.0)),
            },
            mounts: [Mount::OWN],
            load: self.load(0.0),
            start: unknowns(&pose, &u),
            start_force: [0.0],
            start_limits: [vec![0.0; self.nodes.len()]],
            evaluations_left: &self.evaluations_left,
        };
        let solved = system.solve(std::array::from_mut(surface)).map_err(|error| error.at_step(0))?;
        let [solution] = solved.wheels;
        surface.commit(&solution.pose, &solution.active);
        self.dynamics.start(&mut wheel, solution.on_wheel());
        let rail =
            self.rail.as_ref().map(|r| r.start(&self.travel.load(0.0), solution.on_rail())).transpose()?;
        let of_rail = self.rail.as_ref().zip(rail.as_ref());
        let of_rail = of_rail.map(|(dynamics, rail)| dynamics.stored(rail));
        // the springs and the contact start in balance, and nothing has slid
        let of_contact = PartEnergy { friction: 0.0, ..self.contact_energy(surface, &solution) };
        let ledger = EnergyLedger::new(
            self.dynamics.energy(&wheel, &wheel, [0.0; 2]) + of_rail.unwrap_or_default() + of_contact,
        );
        let state = State {
            ledger,
            pose: solution.pose,
            wheel,
            rail,
            spring_force: solution.spring_force.y,
            on_rail: solution.on_rail(),
            limits: self.limits(&solution),
        };
        Ok((state, solution))
    }

    /// Largest external force at `time`, N.
    fn load(&self, time: f64) -> f64 {
        let s = self.scenario;
        s.lateral_force.at(time).abs().max(s.vertical_force.at(time).abs())
    }

    /// Advances from `time` by `step`; a step that does not converge is done in two halves.
    fn advance(
        &self,
        surface: &mut ContactSurface,
        state: &mut State,
        time: f64,
        step: f64,
        halvings: usize,
        statistics: &mut RunStatistics,
    ) -> Result<Advanced> {
        if let Some(ending) = self.travel.ending(time + step) {
            return Ok(Advanced::Ended(ending));
        }
        match self.step(surface, state, time + step, step) {
            Ok((next, solution)) => {
                if let Some(ending) = self.outline.ending(&solution, time + step) {
                    return Ok(Advanced::Ended(ending));
                }
                surface.commit(&solution.pose, &solution.active);
                let last = std::mem::replace(state, next);
                self.spare_rail.set(last.rail.unwrap_or_default());
                statistics.steps += 1;
                statistics.iterations += solution.iterations;
                let turned_to_consistent = self.law.sliding == SlidingMatrix::Symmetric
                    && solution.sliding == SlidingMatrix::Consistent;
                statistics.consistent_steps += usize::from(turned_to_consistent);
                statistics.most_iterations = statistics.most_iterations.max(solution.iterations);
                Ok(Advanced::OnRail(Box::new(solution)))
            }
            Err(Error::Numerics(error))
                if halvings < MOST_HALVINGS && error.reason != StopReason::WorkBound =>
            {
                statistics.halved_steps += 1;
                let half = 0.5 * step;
                match self.advance(surface, state, time, half, halvings + 1, statistics)? {
                    Advanced::OnRail(_) => {
                        self.advance(surface, state, time + half, half, halvings + 1, statistics)
                    }
                    ended => Ok(ended),
                }
            }
            Err(error) => Err(error),
        }
    }

    /// One step that ends at `time`.
    fn step(
        &self,
        surface: &mut ContactSurface,
        state: &State,
        time: f64,
        step: f64,
    ) -> Result<(State, Solution)> {
        let scheme = Newmark::new(step, self.model.dissipation);
        let wheel = self.dynamics.over(&scheme);
        let mut moved_wheel = WheelState::default();
        let wheel_step = wheel.predict(&state.wheel, &self.dynamics.load(time), &mut moved_wheel);
        let rail = self.rail.as_ref().map(|dynamics| dynamics.over(&scheme)).transpose()?;
        let mut moved_rail = rail.as_ref().map(|_| self.spare_rail.take());
        let rail_step = rail.as_ref().zip(state.rail.as_ref()).zip(moved_rail.as_mut());
        let rail_step =
            rail_step.map(|((rail, state), next)| rail.predict(state, &self.travel.load(time), next));
        let start = Vector2::new(state.wheel.centre[0].u, state.wheel.centre[1].u);
        let predicted = step
            * (state.wheel.centre[0].v.hypot(state.wheel.centre[1].v)
                + step * state.wheel.centre[0].a.hypot(state.wheel.centre[1].a));
        surface.list(&state.pose, predicted);
        let system = StepSystem {
            springs: [&self.model.springs],
            law: &self.law,
            surroundings: Surroundings {
                rails: [match &rail_step {
                    Some(rail) => Interface::of(rail, "rail")?,
                    None => Interface::held(state.pose.fixed_rows::<3>(2).into_owned()),
                }],
                body: Interface::of(&wheel_step, "wheel")?,
            },
            mounts: [Mount::OWN],
            load: self.load(time),
            start: unknowns(&state.pose, &start),
            start_force: [state.spring_force],
            start_limits: [state.limits.clone()],
            evaluations_left: &self.evaluations_left,
        };
        let solved = system.solve(std::array::from_mut(surface))?;
        let ([on_rail], on_wheel) = system.surroundings.forces(&solved.x);
        let [solution] = solved.wheels;
        wheel_step.finish(on_wheel.as_slice());
        if let Some(rail_step) = rail_step {
            rail_step.finish(on_rail.as_slice());
        }
        let torsion = |time: f64| self.travel.load(time).torsion;
        let of_rail = match (&self.rail, &state.rail, &moved_rail) {
            (Some(dynamics), Some(before), Some(after)) => {
                let times = [time - step, time];
                let driven =
                    dynamics.driven([before, after], [Matrix3::identity(); 2], [state.on_rail, on_rail]);
                let driven = PartEnergy { work: driven, ..PartEnergy::default() };
                dynamics.energy(before, after, 0.5 * (torsion(times[0]) + torsion(times[1])), step) + driven
            }
            _ => PartEnergy::default(),
        };
        let of_wheel = self.dynamics.energy(&state.wheel, &moved_wheel, [time - step, time]);
        let next = State {
            ledger: state.ledger.entered(of_wheel + of_rail + self.contact_energy(surface, &solution)),
            pose: solution.pose,
            wheel: moved_wheel,
            rail: moved_rail,
            spring_force: solution.spring_force.y,
            on_rail,
            limits: self.limits(&solution),
        };
        if !next.is_finite() {
            return Err(solution.failure(StopReason::NotFinite));
        }
        Ok((next, solution))
    }

    /// Energy of the springs between centre and contact and of the contact's penalty, and what friction took in the step that ends with
    /// `solution`, J.
    fn contact_energy(&self, surface: &ContactSurface, solution: &Solution) -> PartEnergy {
        let difference = solution.pose.fixed_rows::<2>(0) - solution.centre;
        let springs = self.model.springs.energy(difference, solution.spring_force.y);
        let contact = surface.energy(self.law.penalty, &solution.active);
        PartEnergy { elastic: springs, ..PartEnergy::default() } + contact
    }

    pub(super) fn limits(&self, solution: &Solution) -> Vec<f64> {
        let mut limits = vec![0.0; self.nodes.len()];
        for active in &solution.active {
            limits[active.node] = self.law.friction * active.normal_force;
        }
        limits
    }

    fn degrees_of_freedom(&self) -> usize {
        let beam = self.model.support.beam().map_or(0, RailBeam::unknowns);
        // A and B in two directions, their common rotation if free, and the suspended mass.
        beam + 4
            + usize::from(!self.scenario.rotations_held)
            + usize::from(self.scenario.suspended_mass > 0.0)
    }

    /// Contact force, N, and the penetration over the deformation of the springs.
    fn penalty_error(&self, solution: &Solution) -> (f64, f64) {
        let springs = (solution.pose.fixed_rows::<2>(0) - solution.centre).norm();
        let force = solution.active.iter().map(|a| a.normal_force).sum();
        let penetration = solution.active.iter().map(|a| a.penetration).fold(0.0, f64::max);
        (force, if penetration > 0.0 { penetration / springs } else { 0.0 })
    }

    fn row(&self, time: f64, solution: &Solution, energy: EnergyBalance) -> HistoryRow {
        let centre = to_plane(solution.centre);
        let start = self.model.initial.displacement;
        let on_rail = to_plane(solution.on_rail().xy());
        HistoryRow {
            time,
            vertical_force: on_rail.y,
            lateral_force: on_rail.x,
            wheel_y: centre.x - start[0],
            wheel_z: centre.y - start[1],
            load_y: self.scenario.load_travel(time, centre.x - start[0]),
            energy: Some(energy),
            contacts: contacts_of(&self.nodes, &self.model.wheel, &solution.active),
        }
    }
}

/// Arc length and rest position in the rail's profile frame of rail nodes `spacing` (m) apart or less.
pub(super) fn rail_nodes(rail: &PlacedRail, spacing: f64) -> Vec<(f64, Point2<f64>)> {
    let length = rail.curve.length();
    let intervals = (length / spacing).ceil().max(1.0);
    (0..=intervals as usize)
        .map(|i| length * i as f64 / intervals)
        .map(|s| (s, rail.to_profile(&rail.curve.point(s))))
        .collect()
}

/// The surface of a rail with a `master` (m) and `nodes`, and of a wheel with its radius (m) and the place of its profile's origin at rest (m).
pub(super) fn surface_of<'a>(
    rail: &PlacedRail,
    nodes: &[(f64, Point2<f64>)],
    master: Point2<f64>,
    (wheel, radius, tape): (&'a ProfileCurve, f64, Point2<f64>),
) -> ContactSurface<'a> {
    let centre = tape - Vector2::new(0.0, radius);
    let points: Vec<Vector2<f64>> =
        nodes.iter().map(|&(s, _)| to_plane(rail.curve.point(s) - master)).collect();
    ContactSurface::new(&points, wheel, radius, to_plane(centre - master))
}

/// Touching nodes gathered to contacts, from the gauge side to the field side.
pub(super) fn contacts_of(
    nodes: &[(f64, Point2<f64>)],
    wheel: &ProfileCurve,
    active: &[ActiveNode],
) -> Vec<ContactState> {
    let apart = |a: &ActiveNode, b: &ActiveNode| nodes[b.node].0 - nodes[a.node].0 > PATCH_GAP;
    active.chunk_by(|a, b| !apart(a, b)).map(|patch| contact(nodes, wheel, patch)).collect()
}

fn contact(nodes: &[(f64, Point2<f64>)], wheel: &ProfileCurve, patch: &[ActiveNode]) -> ContactState {
    let normal_force: f64 = patch.iter().map(|a| a.normal_force).sum();
    let mean = |point: &dyn Fn(&ActiveNode) -> Point2<f64>| {
        let sum: Vector2<f64> = patch.iter().map(|a| point(a).coords * a.normal_force).sum();
        Point2::from(sum / normal_force)
    };
    let sticks = patch.iter().any(|a| a.mode == ContactMode::Stick);
    ContactState {
        mode: if sticks { ContactMode::Stick } else { ContactMode::Slip },
        rail: mean(&|a| nodes[a.node].1),
        wheel: mean(&|a| wheel.point(a.place)),
        normal_force,
        // The internal force resists the rail node; the wheel pushes the rail the other way.
        tangential_force: -patch.iter().map(|a| a.tangential_force).sum::<f64>(),
    }
}

/// Pose of the masters and displacement of the wheel centre as unknowns of a step.
pub(super) fn unknowns(pose: &Pose, centre: &Vector2<f64>) -> SVector<f64, 8> {
    let mut x = SVector::<f64, 8>::zeros();
    x.fixed_rows_mut::<6>(0).copy_from(pose);
    x.fixed_rows_mut::<2>(6).copy_from(centre);
    x
}

fn section_motion(solution: &Solution) -> SectionMotion {
    let displacement = to_plane(solution.pose.fixed_rows::<2>(2).into_owned());
    // Direction 3 is −x.
    SectionMotion { displacement: displacement.into(), rotation: -solution.pose[4] }
}

#[cfg(test)]
pub(crate) mod tests;
#[cfg(test)]
mod endings;
