//! The time loop of a wheelset across the track.

use nalgebra::{Matrix3, Vector3};

use crate::element::published::{AxleContacts, AxleStep, Friction, Interface};
use crate::time::newmark::{Motion, Newmark};
use railspring_profiles::error::{Error, InputError, NumericsError, Result, StopReason};
use railspring_profiles::monitor::Monitor;

use super::across::{AcrossCase, AcrossEnding, AcrossRow, AcrossRun, AcrossWork, StartAcross, WheelAcross};
use super::rails::{RailsDynamics, RailsLoad, RailsState, RailsSteps, Twisting};
use super::swaying::{Sway, SwayLoads, SwayState, SwaySteps};

/// A step that does not settle is halved at most so often; then it takes the friction limits of its start.
const MOST_HALVINGS: usize = 4;
/// A step's worth of rounding at the far end does not lead off the rail, m.
const PAST_THE_END: f64 = 1e-9;

/// The start is looked for with a stiffness against each move that falls from one to the other, N/m, by this factor.
const FIRST_STIFFNESS: f64 = 1e9;
const LEAST_STIFFNESS: f64 = 1e2;
const SOFTER: f64 = 0.25;
/// Most moves, and the force of that stiffness at which the axle is in balance, of its weight and loads.
const MOST_MOVES: usize = 400;
const SETTLED: f64 = 1e-9;

impl AcrossCase {
    /// Runs it.
    ///
    /// # Errors
    /// [`InputError`] with key `start` where there is no equilibrium to start from; [`NumericsError`] for a step that does not settle, or where numbers grow beyond
    /// all bounds.
    pub fn run(&self, monitor: &dyn Monitor) -> Result<AcrossRun> {
        let dynamics = self.rails.as_ref().map(RailsDynamics::new);
        let run =
            Run { case: self, dynamics: dynamics.as_ref(), sway: Sway::new(&self.wheelset, self.gravity) };
        let mut prepared: Vec<Option<Prepared>> = (0..=MOST_HALVINGS).map(|_| None).collect();
        let (mut state, first) = run.start()?;
        let mut rows = vec![run.row(0.0, &state, &first)];
        let mut work = AcrossWork::default();
        let mut ending = AcrossEnding::Completed;
        let inner = self.inner_step();
        'time: for row in 1..=self.steps {
            monitor.progress("simulate", row - 1, self.steps)?;
            let mut last = None;
            for number in 0..self.inner_steps {
                let time = (row - 1) as f64 * self.time_step + number as f64 * inner;
                let advanced = run
                    .advance(&mut state, (time, inner, 0), &mut prepared, &mut work)
                    .map_err(|error| error.at_step(row))?;
                match advanced {
                    Advanced::On(step) => last = Some(step),
                    Advanced::Ended(reason) => {
                        ending = reason;
                        break 'time;
                    }
                }
            }
            if let Some(step) = last {
                rows.push(run.row(row as f64 * self.time_step, &state, &step));
            }
        }
        monitor.progress("simulate", self.steps, self.steps)?;
        let of_rails = dynamics.as_ref().map_or(0, RailsDynamics::unknowns);
        // of each wheel the contact's place
        let unknowns = of_rails + 4 + if self.wheelset.above > 0.0 { 6 } else { 3 };
        Ok(AcrossRun { rows, ending, unknowns, work })
    }
}

/// State between two steps.
struct State<'a> {
    rails: RailsState,
    /// Memory for the next.
    spare: RailsState,
    sway: SwayState,
    contacts: AxleContacts<'a>,
}

/// What steps of one length need.
struct Prepared {
    rails: Option<RailsSteps>,
    sway: SwaySteps,
    flexibility: Matrix3<f64>,
}

enum Advanced {
    On(Box<AxleStep>),
    Ended(AcrossEnding),
}

struct Run<'r> {
    case: &'r AcrossCase,
    dynamics: Option<&'r RailsDynamics<'r>>,
    sway: Sway,
}

impl<'r> Run<'r> {
    fn is_off(&self, x: f64) -> bool {
        let length = self.case.rails.as_ref().map(|rails| rails.rail.length);
        length.is_some_and(|length| x < -PAST_THE_END || x > length + PAST_THE_END)
    }

    fn ground(&self, time: f64) -> [f64; 2] {
        self.case.ground.each_ref().map(|ground| ground.at(time))
    }

    fn loads(&self, time: f64) -> SwayLoads {
        let case = self.case;
        SwayLoads {
            lateral: case.lateral_force.at(time),
            vertical: case.vertical_force.at(time),
            roll: case.roll.at(time),
            ground: self.ground(time),
            gravity: case.gravity,
        }
    }

    fn twisting(&self, time: f64) -> Vec<Twisting> {
        let of = |one: &super::across::RailTorsion| {
            let mut moment = [0.0; 2];
            moment[one.rail] = one.moment.at(time);
            Twisting { x: one.x, moment }
        };
        self.case.torsion.iter().map(of).collect()
    }

    /// Where the running surfaces lie against the sections of the rails, directions 1, 2 and 3 of each side.
    fn offsets(&self, x: f64) -> [Vector3<f64>; 2] {
        self.case.uneven.each_ref().map(|uneven| {
            let aside: f64 = uneven.lateral.iter().map(|one| one.height(x)).sum();
            Vector3::new(aside, -uneven.vertical.drop(x), 0.0)
        })
    }

    /// The size of the forces at work, N.
    fn size(&self, loads: &SwayLoads) -> f64 {
        loads.lateral.abs().max(loads.vertical.abs()).max(self.case.wheelset.weight(self.case.gravity))
    }

    /// Advances from `time` by `step`, halved `level` times; a step that does not settle is done in two halves.
    fn advance(
        &self,
        state: &mut State<'r>,
        (time, step, level): (f64, f64, usize),
        prepared: &mut [Option<Prepared>],
        work: &mut AcrossWork,
    ) -> Result<Advanced> {
        if self.is_off(self.case.way.x(time + step)) {
            return Ok(Advanced::Ended(AcrossEnding::RailEnd { time: time + step }));
        }
        if prepared[level].is_none() {
            prepared[level] = Some(self.prepare(step)?);
        }
        let Some(ready) = &prepared[level] else { unreachable!("prepared just now") };
        let mut outcome = self.step(state, (time + step, step), ready, Friction::Coulomb);
        if level == MOST_HALVINGS && matches!(outcome, Err(Error::Numerics(_))) {
            outcome = self.step(state, (time + step, step), ready, Friction::OfTheStart);
            work.with_last_limits += usize::from(outcome.is_ok());
        }
        match outcome {
            Ok((step, advanced)) => {
                work.steps += 1;
                work.iterations += step;
                Ok(advanced)
            }
            Err(Error::Numerics(_)) if level < MOST_HALVINGS => {
                work.halved += 1;
                let half = 0.5 * step;
                match self.advance(state, (time, half, level + 1), prepared, work)? {
                    Advanced::On(_) => self.advance(state, (time + half, half, level + 1), prepared, work),
                    ended => Ok(ended),
                }
            }
            Err(error) => Err(error),
        }
    }

    fn prepare(&self, step: f64) -> Result<Prepared> {
        let scheme = Newmark::new(step, 0.0);
        let sway = self.sway.over(scheme);
        let flexibility = sway.flexibility();
        let rails = self.dynamics.map(|dynamics| dynamics.over(scheme)).transpose()?;
        Ok(Prepared { rails, sway, flexibility })
    }

    /// One step that ends at `time`; its iterations, and what became of it.
    fn step(
        &self,
        state: &mut State<'r>,
        (time, step): (f64, f64),
        ready: &Prepared,
        friction: Friction,
    ) -> Result<(usize, Advanced)> {
        let x = self.case.way.x(time);
        let loads = self.loads(time);
        let free = ready.sway.free(&self.sway, &state.sway, &loads);
        let body = Interface::of_flexibility(SwaySteps::axle(&free), &ready.flexibility, "wheelset")?;
        let offsets = self.offsets(x);
        let twisting = self.twisting(time);
        let load = RailsLoad { x, ground: loads.ground, twisting: &twisting };
        let mut rails_step = None;
        let mut rails = offsets.map(Interface::held);
        if let Some((dynamics, steps)) = self.dynamics.zip(ready.rails.as_ref()) {
            let step = dynamics.predict(steps, &state.rails, &load, &mut state.spare);
            for (side, rail) in rails.iter_mut().enumerate() {
                let free = step.free[side] + offsets[side];
                *rail = Interface::of_flexibility(free, &step.flexibility, "rail")?;
            }
            rails_step = Some((dynamics, steps, step));
        }
        let [y, z, roll, ..] = &state.sway;
        let arm = self.case.contact.sides[0].arm.max(self.case.contact.sides[1].arm);
        let speed = |of: fn(&Motion) -> f64| of(y).hypot(of(z)) + arm * of(roll).abs();
        let reach = step * (speed(|m| m.v) + step * speed(|m| m.a));
        let solved = state.contacts.step(rails, body, (reach, self.size(&loads)), friction)?;
        if let Some(ending) = self.derailed(state, &solved, time) {
            return Ok((solved.iterations(), Advanced::Ended(ending)));
        }
        let sway = ready.sway.with_contacts(&free, &solved.on_axle);
        if !sway.iter().all(Motion::is_finite) {
            return Err(not_finite());
        }
        if let Some((dynamics, steps, step)) = &rails_step {
            dynamics.finish(steps, step, &mut state.spare, &solved.on_rails);
            std::mem::swap(&mut state.rails, &mut state.spare);
        }
        state.sway = sway;
        state.contacts.commit(&solved);
        Ok((solved.iterations(), Advanced::On(Box::new(solved))))
    }

    fn derailed(&self, state: &State, step: &AxleStep, time: f64) -> Option<AcrossEnding> {
        let (wheel, how) = state.contacts.derailed(step, time)?;
        Some(match how {
            Ok(how) => AcrossEnding::Derailed { time, wheel, how },
            Err(_) => AcrossEnding::EndOfProfile { time, wheel },
        })
    }

    /// State at t = 0, and the contacts there.
    fn start(&self) -> Result<(State<'r>, AxleStep)> {
        let (case, x) = (self.case, self.case.way.x(0.0));
        if self.is_off(x) {
            let remedy = "start elsewhere, or take a longer rail";
            return InputError::refuse("start", format!("{x} m"), "a place on the rail", remedy);
        }
        let mut contacts = case.contact.contacts();
        let mut loads = self.loads(0.0);
        let twisting = self.twisting(0.0);
        let (rails, mut sway, first) = match case.start {
            StartAcross::Equilibrium => {
                // the ground rests until then
                loads.ground = [0.0; 2];
                self.settled(&mut contacts, &loads, &twisting)?
            }
            StartAcross::Above { height, velocity: [right, down] } => {
                let still = Motion::default();
                let (side, fall) = (Motion { v: right, ..still }, Motion { u: -height, v: down, ..still });
                let sway = [side, fall, still, side, fall, still];
                let axle = SwaySteps::axle(&sway);
                contacts.place(axle);
                let held = self.offsets(x).map(Interface::held);
                let first = contacts.step(
                    held,
                    Interface::held(axle),
                    (0.0, self.size(&loads)),
                    Friction::Coulomb,
                )?;
                (self.dynamics.map_or_else(RailsState::default, RailsDynamics::unloaded), sway, first)
            }
        };
        loads.ground = self.ground(0.0);
        contacts.commit(&first);
        self.sway.accelerate(&mut sway, &loads, &first.on_axle);
        let mut rails = rails;
        if let Some(dynamics) = self.dynamics {
            let load = RailsLoad { x, ground: loads.ground, twisting: &twisting };
            dynamics.accelerate(&mut rails, &load, &first.on_rails)?;
        }
        Ok((State { rails, spare: RailsState::default(), sway, contacts }, first))
    }

    /// The equilibrium without friction: a wheel that has rolled there has let go of its friction forces. The axle goes there in moves against a stiffness that
    /// falls; each is the minimum of a potential, so that it comes to a stable one wherever it lies.
    fn settled(
        &self,
        contacts: &mut AxleContacts<'r>,
        loads: &SwayLoads,
        twisting: &[Twisting],
    ) -> Result<(RailsState, SwayState, AxleStep)> {
        let x = self.case.way.x(0.0);
        let nothing_carries = || {
            InputError::new(
                "start",
                "equilibrium",
                "springs that carry the mass above at rest, and hold it upright",
                "give the suspension stiffness, or start from a height",
            )
        };
        let (own, force) = self.sway.at_rest(loads).ok_or_else(nothing_carries)?;
        let nothing_holds = || {
            InputError::new(
                "start",
                "equilibrium",
                "rails that their supports hold at rest, vertically, laterally and against twist",
                "give the rails supports with such stiffness, or start from a height",
            )
        };
        let offsets = self.offsets(x);
        let mut rails = offsets.map(Interface::held);
        if let Some(dynamics) = self.dynamics {
            let flexibility = dynamics.flexibility(x).ok_or_else(nothing_holds)?;
            let unloaded = dynamics.at_rest(x, &[Vector3::zeros(); 2], twisting).ok_or_else(nothing_holds)?;
            let free = dynamics.at_wheels(&unloaded, x);
            for side in 0..2 {
                let free = free[side] + offsets[side];
                rails[side] = Interface::of_flexibility(free, &flexibility, "rail")?;
            }
        }
        let size = self.size(loads);
        let arm = self.case.contact.sides[0].arm;
        let against = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, arm * arm));
        let no_balance = |why: &str| {
            InputError::new(
                "start",
                "equilibrium",
                format!("weights and forces in balance with both wheels on their rails: {why}"),
                "set gravity or a force down, lower the lateral force or roll moment, or start from a height",
            )
        };
        let (mut axle, mut stiffness) = (Vector3::<f64>::zeros(), FIRST_STIFFNESS);
        for _ in 0..MOST_MOVES {
            let matrix = own + against * stiffness;
            let free = matrix.lu().solve(&(force + against * axle * stiffness));
            let Some(free) = free else {
                stiffness *= 2.0;
                continue;
            };
            let body = Interface::of_stiffness(free, matrix);
            let reach = 2.0 * (free - axle).xy().norm() + 2.0 * arm * (free.z - axle.z).abs();
            let moved = match contacts.step(rails, body, (reach.min(2e-3), size), Friction::None) {
                Ok(moved) => moved,
                Err(Error::Numerics(_)) if stiffness < 1e3 * FIRST_STIFFNESS => {
                    stiffness *= 10.0;
                    continue;
                }
                Err(error) => return Err(error),
            };
            if contacts.derailed(&moved, 0.0).is_some() {
                return Err(no_balance("the wheelset leaves them").into());
            }
            let way = moved.axle() - axle;
            let left = stiffness * way.xy().norm().max(arm * way.z.abs());
            axle = moved.axle();
            if left <= SETTLED * size {
                if !contacts.seen(&moved).iter().all(|wheel| wheel.vertical_force > 0.0) {
                    return Err(no_balance("a wheel carries nothing").into());
                }
                let state = self.dynamics.map(|dynamics| dynamics.at_rest(x, &moved.on_rails, twisting));
                let rails = match state {
                    None => RailsState::default(),
                    Some(state) => state.ok_or_else(nothing_holds)?,
                };
                let sway = self.sway.with_axle(loads, &axle).ok_or_else(nothing_carries)?;
                return Ok((rails, sway, moved));
            }
            contacts.commit(&moved);
            stiffness = (SOFTER * stiffness).max(LEAST_STIFFNESS);
        }
        Err(no_balance("none is found").into())
    }

    fn row(&self, time: f64, state: &State, step: &AxleStep) -> AcrossRow {
        let (case, x) = (self.case, self.case.way.x(time));
        let [right, down] = self.ground(time);
        let sway = &state.sway;
        let offsets = self.offsets(x);
        let [of_right, of_left] = state.contacts.seen(step);
        let mut side = 0;
        let wheels = [of_right, of_left].map(|contact| {
            let rail = step.rail(side) - offsets[side];
            side += 1;
            WheelAcross { contact, rail: [rail.x, -rail.y, -rail.z] }
        });
        let probes = case
            .probes
            .iter()
            .map(|probe| match self.dynamics {
                Some(dynamics) => {
                    let mut seen = dynamics.seen(&state.rails, probe.rail, probe.x);
                    seen.acceleration[0] += if probe.rail == 0 { right } else { -right };
                    seen.acceleration[1] += down;
                    seen
                }
                None => Default::default(),
            })
            .collect();
        let has = case.wheelset.above > 0.0;
        AcrossRow {
            time,
            x,
            axle: [sway[0].u, sway[1].u, sway[2].u],
            above: has.then_some([sway[3].u, sway[4].u, sway[5].u]),
            above_acceleration: [sway[3].a + right, sway[4].a + down],
            suspension: self.sway.suspension(sway),
            wheels,
            probes,
        }
    }
}

fn not_finite() -> Error {
    NumericsError::new("wheelset", StopReason::NotFinite, f64::NAN, 2).into()
}
