//! The moving solver: model, time loop, history.

use nalgebra::{Point2, Vector2, Vector3};

use railspring_calibrate::error::{Error, InputError, NumericsError, Result, StopReason};
use railspring_calibrate::history::{ContactMode, ContactState, History, HistoryRow};
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::placement::{PlacedRail, Touch};
use railspring_calibrate::profile::ProfileCurve;
use railspring_calibrate::scenario::Scenario;

use super::element::to_plane;
use super::newmark::{Motion, Newmark};
use super::solve::{Solution, StepSystem, Surroundings};
use super::support::{RailDynamics, RailState, RailStep, RailSupport};
use super::surface::{ActiveNode, ContactLaw, ContactSurface, Pose, SlidingMatrix};
use super::wheel::{WheelDynamics, WheelSprings, WheelState};

/// Nodes further apart than this on the rail belong to different contacts, m.
const PATCH_GAP: f64 = 2e-3;

/// A step that does not converge is halved at most so many times.
const MOST_HALVINGS: usize = 8;

/// Motion of the wheel centre at t = 0 relative to the just-touching position at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InitialMotion {
    /// Displacement (y, z), m; a negative z lifts the wheel (drop height), a positive one presses it on.
    pub displacement: [f64; 2],
    /// Velocity (y, z), m/s.
    pub velocity: [f64; 2],
}

/// A wheel on a rail, ready to run scenarios.
#[derive(Debug, Clone)]
pub struct MovingModel {
    /// The rail in the world frame.
    pub rail: PlacedRail,
    /// Running surface of the wheel, profile frame.
    pub wheel: ProfileCurve,
    /// Rolling radius at the tape circle, m: the wheel centre lies so far above the profile's origin.
    pub wheel_radius: f64,
    /// World position (y, z) of the wheel profile's origin, m, where the wheel just touches.
    pub tape: Point2<f64>,
    /// What carries the rail.
    pub support: RailSupport,
    /// Springs between wheel centre and contact.
    pub springs: WheelSprings,
    /// Mass of the wheel, kg, unless the scenario has one.
    pub wheel_mass: f64,
    /// Moments of inertia of the wheel about x, y and z, kg·m², for scenarios that free the
    /// rotations. The element loads only the one about x; pitch and yaw stay zero.
    pub wheel_inertia: [f64; 3],
    /// Penalty constant of each contact node, N/m.
    pub penalty: f64,
    /// Distance of the rail nodes along the profile, m.
    pub node_spacing: f64,
    /// Arc lengths of the wheel, m, between which friction is left out (the publication's region from a to b).
    pub frictionless: Option<(f64, f64)>,
    /// Iteration matrix of sliding contacts.
    pub sliding: SlidingMatrix,
    /// Numerical dissipation δ of Newmark's scheme (γ = 1/2 + δ); 0 is the published average acceleration.
    pub dissipation: f64,
    /// Motion at t = 0.
    pub initial: InitialMotion,
}

/// Counts and errors of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RunStatistics {
    /// Newton iterations of all steps.
    pub iterations: usize,
    /// Most iterations of one step.
    pub most_iterations: usize,
    /// Time steps that had to be halved.
    pub halved_steps: usize,
    /// Largest ratio of the penetration to the elastic deformation at the wheel centre (springs and rail) of the
    /// same step, over the steps with at least a tenth of the largest contact force. The published criterion asks for less
    /// than 1/1000.
    pub penalty_error: f64,
}

/// Displacement of a rail section since t = 0, at its node line.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SectionMotion {
    /// Displacement (y, z), m.
    pub displacement: [f64; 2],
    /// Rotation about x, rad, from y towards z.
    pub rotation: f64,
}

/// What a run leaves behind.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingRun {
    /// States, one a time step, the initial one first.
    pub history: History,
    /// Motion of the rail at the wheel, one for each row of the history.
    pub rail: Vec<SectionMotion>,
    /// Counts and errors.
    pub statistics: RunStatistics,
}

/// State between two steps.
#[derive(Clone)]
struct State {
    pose: Pose,
    wheel: WheelState,
    rail: Option<RailState>,
    spring_force: f64,
    /// Friction limits of the rail nodes, N.
    limits: Vec<f64>,
}

/// Everything that stays the same during a run.
struct Run<'a> {
    model: &'a MovingModel,
    scenario: &'a Scenario,
    dynamics: WheelDynamics<'a>,
    rail: Option<RailDynamics<'a>>,
    law: ContactLaw,
    /// Arc length and rest position of the rail nodes in the rail's profile frame.
    nodes: Vec<(f64, Point2<f64>)>,
    start_x: f64,
}

impl MovingModel {
    /// Default penalty, N/m: with the published law and scenarios the penetration stays below half of the published 1/1000.
    pub const DEFAULT_PENALTY: f64 = 1e12;
    /// Default distance of the rail nodes, m.
    pub const DEFAULT_NODE_SPACING: f64 = 0.25e-3;

    /// A wheel that just touches the rail at `touch`, its tape circle at the world position `tape_y` (m).
    #[expect(clippy::too_many_arguments, reason = "the parts of the model, each of its own type")]
    pub fn new(
        rail: PlacedRail,
        wheel: ProfileCurve,
        wheel_radius: f64,
        tape_y: f64,
        touch: &Touch,
        support: RailSupport,
        springs: WheelSprings,
        wheel_mass: f64,
    ) -> Self {
        Self {
            rail,
            wheel,
            wheel_radius,
            tape: Point2::new(tape_y, touch.tape_z),
            support,
            springs,
            wheel_mass,
            // A thin ring at the tape circle; studies that free the rotations give better values.
            wheel_inertia: [0.5, 1.0, 0.5].map(|share| share * wheel_mass * wheel_radius.powi(2)),
            penalty: Self::DEFAULT_PENALTY,
            node_spacing: Self::DEFAULT_NODE_SPACING,
            frictionless: None,
            sliding: SlidingMatrix::default(),
            dissipation: 0.0,
            initial: InitialMotion::default(),
        }
    }

    /// Runs a scenario.
    ///
    /// # Errors
    /// [`InputError`] for values out of range or a wheel that leaves the rail's end;
    /// [`NumericsError`] with step, iteration, residual and touching nodes when a step does not converge.
    pub fn run(&self, scenario: &Scenario, monitor: &dyn Monitor) -> Result<MovingRun> {
        let run = Run::new(self, scenario)?;
        let mut surface = run.surface();
        let mut statistics = RunStatistics::default();
        let mut penalty_errors = Vec::with_capacity(scenario.steps);
        let (mut state, solution) = run.start(&mut surface)?;
        let mut rows = vec![run.row(0.0, &solution)];
        let mut rail = vec![section_motion(&solution)];
        for step in 0..scenario.steps {
            monitor.progress("simulate", step, scenario.steps)?;
            let time = step as f64 * scenario.time_step;
            let solution = run
                .advance(&mut surface, &mut state, time, scenario.time_step, 0, &mut statistics)
                .map_err(|error| at_step(error, step + 1))?;
            rows.push(run.row((step + 1) as f64 * scenario.time_step, &solution));
            rail.push(section_motion(&solution));
            penalty_errors.push(run.penalty_error(&state, &solution));
        }
        let largest = penalty_errors.iter().fold(0.0, |m: f64, e| m.max(e.0));
        let counted = penalty_errors.iter().filter(|e| e.0 >= 0.1 * largest);
        statistics.penalty_error = counted.fold(0.0, |m: f64, e| m.max(e.1));
        monitor.progress("simulate", scenario.steps, scenario.steps)?;
        let history = History { rows, degrees_of_freedom: run.degrees_of_freedom() };
        Ok(MovingRun { history, rail, statistics })
    }

    fn check(&self, scenario: &Scenario) -> Result<()> {
        let mass = scenario.wheel_mass.unwrap_or(self.wheel_mass);
        let positive = [
            ("moving.penalty_kn_per_m", self.penalty),
            ("moving.node_spacing_mm", self.node_spacing),
            ("stiffness.horizontal_kn_per_m", self.springs.horizontal),
            ("wheel.diameter_mm", self.wheel_radius),
            ("scenario.wheel_mass_t", mass),
            ("scenario.time_step_s", scenario.time_step),
        ];
        let not_negative = [
            ("scenario.friction", scenario.friction),
            ("scenario.suspended_mass_t", scenario.suspended_mass),
            ("scenario.vertical_stiffness_kn_per_m", scenario.vertical_suspension.stiffness),
            ("scenario.vertical_damping_kn_s_per_m", scenario.vertical_suspension.damping),
            ("moving.dissipation", self.dissipation),
        ];
        for (entries, least, expected) in
            [(&positive[..], f64::MIN_POSITIVE, "a positive value"), (&not_negative[..], 0.0, "zero or more")]
        {
            if let Some((key, value)) = entries.iter().find(|(_, v)| !(v.is_finite() && *v >= least)) {
                return Err(InputError::new(*key, value, expected, "correct the value (SI units)").into());
            }
        }
        if self.rail.curve.length() / self.node_spacing > 1e5 {
            let remedy = "0.25 mm is fine enough";
            return Err(InputError::new("moving.node_spacing_mm", self.node_spacing, "a larger distance", remedy).into());
        }
        railspring_calibrate::law::StiffnessLaw::new(
            self.springs.normal.a,
            self.springs.normal.b,
            self.springs.normal.c,
        )?;
        self.check_travel(scenario)
    }

    fn check_travel(&self, scenario: &Scenario) -> Result<()> {
        let RailSupport::Beam { beam, .. } = &self.support else {
            return Ok(());
        };
        let from = scenario.start_x.unwrap_or(0.5 * beam.length());
        let to = from + scenario.speed * scenario.time_step * scenario.steps as f64;
        // A step's worth of rounding at the far end is no reason to refuse.
        let inside = -1e-9..=beam.length() + 1e-9;
        if inside.contains(&from) && inside.contains(&to) {
            return Ok(());
        }
        Err(InputError::new(
            "scenario.start_x_m",
            format!("{from} m, at {} m/s until {to} m", scenario.speed),
            format!("a path within the rail, 0 to {} m", beam.length()),
            "start elsewhere, move slower, or take a longer rail",
        )
        .into())
    }
}

impl<'a> Run<'a> {
    fn new(model: &'a MovingModel, scenario: &'a Scenario) -> Result<Self> {
        model.check(scenario)?;
        let (rail, middle) = match &model.support {
            RailSupport::Rigid => (None, 0.0),
            RailSupport::Beam { beam, damping_ratio, .. } => {
                (Some(RailDynamics::new(beam, *damping_ratio)?), 0.5 * beam.length())
            }
        };
        let length = model.rail.curve.length();
        let intervals = (length / model.node_spacing).ceil().max(1.0);
        let nodes = (0..=intervals as usize)
            .map(|i| length * i as f64 / intervals)
            .map(|s| (s, model.rail.to_profile(&model.rail.curve.point(s))))
            .collect();
        Ok(Self {
            model,
            scenario,
            dynamics: WheelDynamics {
                scenario,
                mass: scenario.wheel_mass.unwrap_or(model.wheel_mass),
                roll_inertia: (!scenario.rotations_held).then_some(model.wheel_inertia[0]),
            },
            rail,
            law: ContactLaw {
                penalty: model.penalty,
                friction: scenario.friction,
                frictionless: model.frictionless,
                sliding: model.sliding,
            },
            nodes,
            start_x: scenario.start_x.unwrap_or(middle),
        })
    }

    /// The world point of C at rest: the beam's node line, or the top of a rigid rail.
    fn master(&self) -> Point2<f64> {
        match &self.model.support {
            RailSupport::Rigid => self.model.rail.origin,
            RailSupport::Beam { node_line, .. } => *node_line,
        }
    }

    fn surface(&self) -> ContactSurface<'a> {
        let master = self.master();
        let centre = self.model.tape - Vector2::new(0.0, self.model.wheel_radius);
        let points: Vec<Vector2<f64>> = self
            .nodes
            .iter()
            .map(|&(s, _)| to_plane(self.model.rail.curve.point(s) - master))
            .collect();
        let wheel_centre = to_plane(centre - master);
        ContactSurface::new(&points, &self.model.wheel, self.model.wheel_radius, wheel_centre)
    }

    fn torsion(&self, time: f64) -> f64 {
        self.scenario.rail_torsion.as_ref().map_or(0.0, |t| t.at(time))
    }

    fn wheel_x(&self, time: f64) -> f64 {
        self.start_x + self.scenario.speed * time
    }

    /// State at t = 0: wheel centre and rail where they are told to be, the contact master in balance between them.
    fn start(&self, surface: &mut ContactSurface) -> Result<(State, Solution)> {
        let initial = &self.model.initial;
        let mut wheel = WheelState::default();
        let (u, v) = (to_plane(initial.displacement.into()), to_plane(initial.velocity.into()));
        for i in 0..2 {
            wheel.centre[i] = Motion { u: u[i], v: v[i], a: 0.0 };
        }
        // The suspended mass starts along with the wheel: its spring is at rest.
        wheel.suspended = wheel.centre[1];
        let mut pose = Pose::zeros();
        pose.fixed_rows_mut::<2>(0).copy_from(&u);
        surface.list(&pose, u.norm());
        let system = StepSystem {
            springs: &self.model.springs,
            law: &self.law,
            surroundings: Surroundings { rail: None, wheel: None, roll: None },
            load: self.load(0.0),
            start: (pose, u),
            start_force: 0.0,
            start_limits: vec![0.0; self.nodes.len()],
        };
        let solution = system.solve(surface).map_err(|error| at_step(error, 0))?;
        surface.commit(&solution.pose, &solution.active);
        self.dynamics.start(&mut wheel, solution.spring_force, -solution.contact[5]);
        let on_rail = -solution.contact.fixed_rows::<3>(2).into_owned();
        let rail = self.rail.as_ref().map(|r| r.start(self.torsion(0.0), self.start_x, on_rail));
        let state = State {
            pose: solution.pose,
            wheel,
            rail,
            spring_force: solution.spring_force.y,
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
    ) -> Result<Solution> {
        match self.step(surface, state, time + step, step) {
            Ok((next, solution)) => {
                surface.commit(&solution.pose, &solution.active);
                *state = next;
                statistics.iterations += solution.iterations;
                statistics.most_iterations = statistics.most_iterations.max(solution.iterations);
                Ok(solution)
            }
            // A contact that has left the profiles stays there in shorter steps.
            Err(Error::Numerics(error))
                if halvings < MOST_HALVINGS && error.reason != StopReason::EdgeOfCandidates =>
            {
                statistics.halved_steps += 1;
                let half = 0.5 * step;
                self.advance(surface, state, time, half, halvings + 1, statistics)?;
                self.advance(surface, state, time + half, half, halvings + 1, statistics)
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
        let wheel = self.dynamics.step(&scheme, &state.wheel, time);
        let rail: Option<RailStep> = match (&self.rail, &state.rail) {
            (Some(dynamics), Some(rail)) => {
                Some(dynamics.step(&scheme, rail, self.wheel_x(time), self.torsion(time))?)
            }
            _ => None,
        };
        let start = Vector2::new(state.wheel.centre[0].u, state.wheel.centre[1].u);
        let predicted = step
            * (state.wheel.centre[0].v.hypot(state.wheel.centre[1].v)
                + step * state.wheel.centre[0].a.hypot(state.wheel.centre[1].a));
        surface.list(&state.pose, predicted);
        let system = StepSystem {
            springs: &self.model.springs,
            law: &self.law,
            surroundings: Surroundings {
                rail: rail.as_ref().map(|r| (r.stiffness, r.free)),
                wheel: Some((wheel.stiffness, wheel.free)),
                roll: wheel.roll,
            },
            load: self.load(time),
            start: (state.pose, start),
            start_force: state.spring_force,
            start_limits: state.limits.clone(),
        };
        let solution = system.solve(surface)?;
        self.check_edges(&solution)?;
        let on_rail: Vector3<f64> = -solution.contact.fixed_rows::<3>(2).into_owned();
        let next = State {
            pose: solution.pose,
            wheel: wheel.finish(&scheme, &state.wheel, solution.centre.into(), solution.pose[5]),
            rail: rail.zip(state.rail.as_ref()).map(|(r, s)| r.finish(&scheme, s, on_rail)),
            spring_force: solution.spring_force.y,
            limits: self.limits(&solution),
        };
        Ok((next, solution))
    }

    fn limits(&self, solution: &Solution) -> Vec<f64> {
        let mut limits = vec![0.0; self.nodes.len()];
        for active in &solution.active {
            limits[active.node] = self.law.friction * active.normal_force;
        }
        limits
    }

    /// Contact on the last rail node or beyond the wheel's spline means that the profiles are too short.
    fn check_edges(&self, solution: &Solution) -> Result<()> {
        let edge = |a: &ActiveNode| {
            a.node == 0
                || a.node + 1 == self.nodes.len()
                || !(0.0..=self.model.wheel.length()).contains(&a.place)
        };
        if !solution.active.iter().any(edge) {
            return Ok(());
        }
        Err(NumericsError {
            stage: "moving solver".into(),
            step: None,
            iteration: solution.iterations,
            residual: 0.0,
            active: solution.active.len(),
            reason: StopReason::EdgeOfCandidates,
        }
        .into())
    }

    fn degrees_of_freedom(&self) -> usize {
        let beam = match &self.model.support {
            RailSupport::Rigid => 0,
            RailSupport::Beam { beam, .. } => beam.unknowns(),
        };
        // A and B in two directions, their common rotation if free, and the suspended mass.
        beam + 4 + usize::from(!self.scenario.rotations_held) + usize::from(self.scenario.suspended_mass > 0.0)
    }

    /// Contact force, N, and the penetration over the elastic deformation at the wheel centre.
    fn penalty_error(&self, state: &State, solution: &Solution) -> (f64, f64) {
        let springs = solution.pose.fixed_rows::<2>(0) - solution.centre;
        let arm = to_plane(self.model.tape - self.master());
        let rail = state.pose.fixed_rows::<2>(2) + Vector2::new(-arm.y, arm.x) * state.pose[4];
        let force = solution.active.iter().map(|a| a.normal_force).sum();
        let penetration = solution.active.iter().map(|a| a.penetration).fold(0.0, f64::max);
        (force, if penetration > 0.0 { penetration / (springs - rail).norm() } else { 0.0 })
    }

    fn row(&self, time: f64, solution: &Solution) -> HistoryRow {
        let centre = to_plane(solution.centre);
        let start = self.model.initial.displacement;
        let on_rail = to_plane(-solution.contact.fixed_rows::<2>(2).into_owned());
        HistoryRow {
            time,
            vertical_force: on_rail.y,
            lateral_force: on_rail.x,
            wheel_y: centre.x - start[0],
            wheel_z: centre.y - start[1],
            contacts: self.contacts(&solution.active),
        }
    }

    /// Touching nodes gathered to contacts, from the gauge side to the field side.
    fn contacts(&self, active: &[ActiveNode]) -> Vec<ContactState> {
        let apart = |a: &ActiveNode, b: &ActiveNode| self.nodes[b.node].0 - self.nodes[a.node].0 > PATCH_GAP;
        active.chunk_by(|a, b| !apart(a, b)).map(|patch| self.contact(patch)).collect()
    }

    fn contact(&self, patch: &[ActiveNode]) -> ContactState {
        let normal_force: f64 = patch.iter().map(|a| a.normal_force).sum();
        let mean = |point: &dyn Fn(&ActiveNode) -> Point2<f64>| {
            let sum: Vector2<f64> = patch.iter().map(|a| point(a).coords * a.normal_force).sum();
            Point2::from(sum / normal_force)
        };
        let sticks = patch.iter().any(|a| a.mode == ContactMode::Stick);
        ContactState {
            mode: if sticks { ContactMode::Stick } else { ContactMode::Slip },
            rail: mean(&|a| self.nodes[a.node].1),
            wheel: mean(&|a| self.model.wheel.point(a.place)),
            normal_force,
            // The internal force resists the rail node; the wheel pushes the rail the other way.
            tangential_force: -patch.iter().map(|a| a.tangential_force).sum::<f64>(),
        }
    }
}

fn section_motion(solution: &Solution) -> SectionMotion {
    let displacement = to_plane(solution.pose.fixed_rows::<2>(2).into_owned());
    // Direction 3 is −x.
    SectionMotion { displacement: displacement.into(), rotation: -solution.pose[4] }
}

fn at_step(error: Error, step: usize) -> Error {
    match error {
        Error::Numerics(numerics) => NumericsError { step: Some(step), ..numerics }.into(),
        other => other,
    }
}

#[cfg(test)]
mod tests;
