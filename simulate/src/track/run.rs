//! The time loop on a track.

use railspring_calibrate::law::NormalLaw;
use railspring_profiles::error::{InputError, NumericsError, Result, StopReason};
use railspring_profiles::monitor::Monitor;

use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::{Motion, Newmark};

use super::case::{Start, TrackCase};
use super::dynamics::{Seen, TrackDynamics, TrackLoad};
use super::running::{Loads, Running, Vehicle};
use super::state::TrackState;

/// Most iterations of a contact; bisection alone ends with sixty.
const MOST_ITERATIONS: usize = 200;
/// Most rounds over the contacts of a wheelset.
const MOST_ROUNDS: usize = 500;
/// Change of an approach at which contacts are in balance, against that without forces, and m.
const SETTLED: f64 = 1e-13;
/// The same of the rounds over several contacts: forces follow their approaches to 1e-12 of themselves.
const SETTLED_ROUNDS: f64 = 1e-11;
const SMALLEST: f64 = 1e-18;
/// A step's worth of rounding at the far end does not lead off the rail, m.
const PAST_THE_END: f64 = 1e-9;

/// How a run ended; one that ends early is a result with all rows before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TrackEnding {
    /// All steps were done.
    Completed,
    /// The wheel came to an end of the rail.
    RailEnd {
        /// End of the first step that has it beyond, s.
        time: f64,
    },
}

/// A wheel at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelRow {
    /// Force on the rail, N.
    pub force: f64,
    /// Approach of hub and rail, m; negative for a gap.
    pub approach: f64,
    /// Displacement of the hub downwards, m.
    pub z: f64,
    /// Deflection of the rail under it, m.
    pub rail: f64,
}

/// What a probe sees.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProbeRow {
    /// Deflection downwards against the ground, m.
    pub deflection: f64,
    /// Bending moment, N·m, positive where the lower side is in tension.
    pub moment: f64,
    /// Acceleration downwards, that of the ground included, m/s².
    pub acceleration: f64,
}

/// The end of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackRow {
    /// Time, s.
    pub time: f64,
    /// Place of the wheels, m from the rail's first end.
    pub x: f64,
    /// Each wheel, the right one first.
    pub wheels: Vec<WheelRow>,
    /// Displacement (m) and acceleration (m/s², with the ground's) of the mass above, downwards.
    pub above: Option<[f64; 2]>,
    /// Each probe.
    pub probes: Vec<ProbeRow>,
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackRun {
    /// Rows, the first at t = 0.
    pub rows: Vec<TrackRow>,
    /// How it ended.
    pub ending: TrackEnding,
    /// Unknowns of the model.
    pub unknowns: usize,
}

impl TrackCase {
    /// Runs it.
    ///
    /// # Errors
    /// [`InputError`] with key `start` where there is no equilibrium to start from; [`NumericsError`] where numbers grow beyond all bounds.
    pub fn run(&self, monitor: &dyn Monitor) -> Result<TrackRun> {
        match &self.track {
            Some(track) if track.bridge.is_some() => self.on(Some(&TrackDynamics::<4>::new(track)), monitor),
            Some(track) => self.on(Some(&TrackDynamics::<2>::new(track)), monitor),
            None => self.on::<2>(None, monitor),
        }
    }

    fn on<const N: usize>(
        &self,
        dynamics: Option<&TrackDynamics<'_, N>>,
        monitor: &dyn Monitor,
    ) -> Result<TrackRun> {
        let vehicle = Vehicle::new(&self.running);
        let scheme = Newmark::new(self.inner_step(), 0.0);
        let run = Run { case: self, dynamics, vehicle: &vehicle };
        let mut state = run.start()?;
        let steps = dynamics.map(|dynamics| dynamics.over(scheme)).transpose()?;
        let vehicle_steps = vehicle.over(scheme);
        let mut spare: Vec<TrackState<N>> = vec![TrackState::default(); state.rails.len()];
        let mut rows = vec![run.row(0.0, &state)];
        let mut ending = TrackEnding::Completed;
        let inner = self.inner_step();
        'time: for row in 1..=self.steps {
            monitor.progress("simulate", row - 1, self.steps)?;
            for number in 1..=self.inner_steps {
                let time = (row - 1) as f64 * self.time_step + number as f64 * inner;
                let x = self.way.x(time);
                if run.is_off(x) {
                    ending = TrackEnding::RailEnd { time };
                    break 'time;
                }
                let free = vehicle_steps.free(&state.vehicle, &run.loads(time));
                let load = TrackLoad { x, ground: self.ground.at(time) };
                let mut rail_steps = Vec::with_capacity(2);
                if let Some(steps) = &steps {
                    for (rail, next) in state.rails.iter().zip(&mut spare) {
                        rail_steps.push(steps.predict(rail, &load, next));
                    }
                }
                let drops: Vec<f64> = self.wheels.unevenness.iter().map(|one| one.drop(x)).collect();
                let mut contacts = Contacts {
                    law: &self.wheels.law,
                    damper: self.wheels.damping / inner,
                    before: &state.approaches,
                    free: Vec::with_capacity(2),
                    flexibility: [[0.0; 2]; 2],
                };
                for wheel in 0..state.approaches.len() {
                    let rail = rail_steps.get(wheel).map_or(0.0, |step: &_| LinearStep::free(step)[0]);
                    contacts
                        .free
                        .push(vehicle.contact(wheel, &free) - rail - drops.get(wheel).unwrap_or(&0.0));
                    for other in 0..state.approaches.len() {
                        contacts.flexibility[wheel][other] = vehicle_steps.flexibility[(wheel, other)];
                    }
                    contacts.flexibility[wheel][wheel] +=
                        rail_steps.get(wheel).map_or(0.0, |step: &_| LinearStep::flexibility(step)[(0, 0)]);
                }
                let (approaches, forces) = match self.running {
                    Running::Force => (vec![0.0], vec![self.force.at(time)]),
                    _ => contacts.balance(&state.forces)?,
                };
                for (step, force) in rail_steps.into_iter().zip(&forces) {
                    step.finish(&[*force]);
                }
                std::mem::swap(&mut state.rails, &mut spare);
                state.vehicle = vehicle_steps.with_contacts(&free, &forces);
                state.approaches = approaches;
                state.forces = forces;
            }
            let time = row as f64 * self.time_step;
            if !run.is_finite(&state) {
                let error = NumericsError::new("track", StopReason::NotFinite, f64::NAN, state.forces.len());
                return Err(railspring_profiles::error::Error::from(error).at_step(row));
            }
            rows.push(run.row(time, &state));
        }
        monitor.progress("simulate", self.steps, self.steps)?;
        let of_track = dynamics.map_or(0, TrackDynamics::unknowns) * state.rails.len();
        Ok(TrackRun { rows, ending, unknowns: of_track + vehicle.coordinates() })
    }
}

/// State between two steps.
struct State<const N: usize> {
    rails: Vec<TrackState<N>>,
    vehicle: Vec<Motion>,
    approaches: Vec<f64>,
    forces: Vec<f64>,
}

struct Run<'r, const N: usize> {
    case: &'r TrackCase,
    dynamics: Option<&'r TrackDynamics<'r, N>>,
    vehicle: &'r Vehicle,
}

impl<const N: usize> Run<'_, N> {
    fn is_off(&self, x: f64) -> bool {
        let length = self.case.track.as_ref().map(|track| track.length);
        length.is_some_and(|length| x < -PAST_THE_END || x > length + PAST_THE_END)
    }

    fn loads(&self, time: f64) -> Loads {
        let case = self.case;
        Loads {
            force: case.force.at(time),
            roll: case.roll.at(time),
            gravity: case.gravity - case.ground.at(time),
        }
    }

    /// State at t = 0.
    fn start(&self) -> Result<State<N>> {
        let (case, x) = (self.case, self.case.way.x(0.0));
        let wheels = case.running.wheels();
        if self.is_off(x) {
            let expected = "a place on the rail";
            return InputError::refuse(
                "start",
                format!("{x} m"),
                expected,
                "start elsewhere, or take a longer rail",
            );
        }
        let mut loads = self.loads(0.0);
        let (mut state, loads) = match (case.start, case.running) {
            (Start::Equilibrium, _) | (_, Running::Force) => {
                // the ground rests until then
                loads.gravity = case.gravity;
                let resting = case.start == Start::Equilibrium;
                let forces =
                    if resting { self.vehicle.carried(&case.running, &loads) } else { vec![loads.force] };
                self.check(&forces)?;
                let mut rails = Vec::new();
                for force in &forces {
                    if let Some(dynamics) = self.dynamics {
                        let carried = if resting { *force } else { 0.0 };
                        rails.push(dynamics.at_rest(x, carried).ok_or_else(nothing_holds)?);
                    }
                }
                let approaches: Vec<f64> = match case.running {
                    Running::Force => vec![0.0],
                    _ => forces.iter().map(|force| case.wheels.law.displacement(*force)).collect(),
                };
                let contacts: Vec<f64> = (0..wheels)
                    .map(|wheel| {
                        let rail = rails.get(wheel).zip(self.dynamics);
                        let rail = rail.map_or(0.0, |(rail, dynamics)| dynamics.deflection(rail, x));
                        approaches[wheel] + rail + self.drop(wheel, x)
                    })
                    .collect();
                let vehicle = self.vehicle.at_rest(&case.running, &loads, &contacts);
                (State { rails, vehicle, approaches, forces }, self.loads(0.0))
            }
            (Start::Above { height, velocity }, _) => {
                let rails: Option<Vec<_>> = self
                    .dynamics
                    .map(|dynamics| (0..wheels).map(|_| dynamics.at_rest(x, 0.0)).collect())
                    .unwrap_or_else(|| Some(Vec::new()));
                let down = Motion { u: -height, v: velocity, a: 0.0 };
                let mut vehicle = vec![down; self.vehicle.coordinates()];
                if let Running::Wheelset(_) = case.running {
                    // roll is at rest
                    vehicle.iter_mut().skip(1).step_by(2).for_each(|roll| *roll = Motion::default());
                }
                let approaches = (0..wheels).map(|wheel| -height - self.drop(wheel, x)).collect();
                let forces = vec![0.0; wheels];
                (State { rails: rails.ok_or_else(nothing_holds)?, vehicle, approaches, forces }, loads)
            }
        };
        self.vehicle.accelerate(&mut state.vehicle, &loads, &state.forces);
        if let Some(dynamics) = self.dynamics {
            let load = TrackLoad { x, ground: case.ground.at(0.0) };
            for (rail, force) in state.rails.iter_mut().zip(&state.forces) {
                dynamics.accelerate(rail, &load, *force)?;
            }
        }
        Ok(state)
    }

    fn drop(&self, wheel: usize, x: f64) -> f64 {
        self.case.wheels.unevenness.get(wheel).map_or(0.0, |one| one.drop(x))
    }

    /// Whether there is an equilibrium with these forces of the wheels.
    fn check(&self, forces: &[f64]) -> Result<()> {
        if self.case.running == Running::Force {
            return Ok(());
        }
        if self.case.running.hangs() {
            return InputError::refuse(
                "start",
                "equilibrium",
                "a spring under the mass above, which has none to rest on",
                "give the suspension a stiffness, or start from a height",
            );
        }
        if let Some(force) = forces.iter().find(|force| !(**force > 0.0)) {
            return InputError::refuse(
                "start",
                format!("equilibrium, with {:.3} kN under a wheel", force * 1e-3),
                "weights and forces that press every wheel on its rail",
                "set gravity or a force down, or start from a height",
            );
        }
        Ok(())
    }

    fn is_finite(&self, state: &State<N>) -> bool {
        state.forces.iter().all(|force| force.is_finite())
            && state.vehicle.iter().all(Motion::is_finite)
            && self.dynamics.is_none_or(|dynamics| state.rails.iter().all(|rail| dynamics.is_finite(rail)))
    }

    fn row(&self, time: f64, state: &State<N>) -> TrackRow {
        let (case, x) = (self.case, self.case.way.x(time));
        let ground = case.ground.at(time);
        let wheels = (0..state.forces.len())
            .map(|wheel| {
                let rail = self.dynamics.zip(state.rails.get(wheel));
                WheelRow {
                    force: state.forces[wheel],
                    approach: state.approaches[wheel],
                    z: self.vehicle.contact(wheel, &state.vehicle),
                    rail: rail.map_or(0.0, |(dynamics, rail)| dynamics.deflection(rail, x)),
                }
            })
            .collect();
        let probes = case
            .probes
            .iter()
            .map(|probe| {
                let Some((dynamics, rail)) = self.dynamics.zip(state.rails.get(probe.rail)) else {
                    return ProbeRow { acceleration: ground, ..ProbeRow::default() };
                };
                let Seen { deflection, moment, acceleration } =
                    dynamics.seen(rail, probe.of, probe.x, (x, state.forces[probe.rail]));
                ProbeRow { deflection, moment, acceleration: acceleration + ground }
            })
            .collect();
        let above = self.vehicle.above(&state.vehicle).map(|motion| [motion.u, motion.a + ground]);
        TrackRow { time, x, wheels, above, probes }
    }
}

fn nothing_holds() -> InputError {
    InputError::new(
        "start",
        "equilibrium",
        "a rail that its supports hold vertically at rest, which nothing does here",
        "give the rail supports with a stiffness, or start from a height",
    )
}

/// The contacts of a step: approaches without forces, and what forces take of them.
struct Contacts<'c> {
    law: &'c NormalLaw,
    /// Force per change of the approach over the step, N/m.
    damper: f64,
    before: &'c [f64],
    free: Vec<f64>,
    flexibility: [[f64; 2]; 2],
}

impl Contacts<'_> {
    /// Approaches and forces in balance, from the forces of the last step. Each contact in turn is solved with the others as they are: the flexibility is
    /// positive definite and forces grow with the approach, so that the rounds descend to the only solution.
    fn balance(&self, last: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        let count = self.free.len();
        let (mut approaches, mut forces) = (vec![0.0; count], last.to_vec());
        // the wheel that is pressed on more comes first, so that the mirrored case is solved in the mirrored order
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| {
            let pressed = |wheel: usize| (self.free[wheel], last[wheel]);
            let ((a, of_a), (b, of_b)) = (pressed(a), pressed(b));
            b.total_cmp(&a).then(of_b.total_cmp(&of_a))
        });
        for _ in 0..MOST_ROUNDS {
            let mut change = 0.0_f64;
            for &wheel in &order {
                let others: f64 =
                    (0..count).filter(|i| *i != wheel).map(|i| self.flexibility[wheel][i] * forces[i]).sum();
                let (approach, force) = self.alone(wheel, self.free[wheel] - others, forces[wheel]);
                change =
                    change.max((approach - approaches[wheel]).abs() / (self.free[wheel].abs() + SMALLEST));
                (approaches[wheel], forces[wheel]) = (approach, force);
            }
            if count == 1 || change <= SETTLED_ROUNDS {
                return Ok((approaches, forces));
            }
        }
        Err(NumericsError::new("track contacts", StopReason::IterationLimit, f64::NAN, count).into())
    }

    /// Approach and force of a wheel whose approach without a force is `free`.
    fn alone(&self, wheel: usize, free: f64, guess: f64) -> (f64, f64) {
        let flexibility = self.flexibility[wheel][wheel];
        if !(free > 0.0) {
            // also where it is not a number, which ends the run
            return (free, if free.is_nan() { f64::NAN } else { 0.0 });
        }
        let before = self.before[wheel];
        let force = |approach: f64, guess: f64| {
            let spring = self.law.force_from(approach, guess);
            let sum = spring + self.damper * (approach - before);
            (spring, sum.max(0.0), if sum > 0.0 { self.law.tangent(spring) + self.damper } else { 0.0 })
        };
        let (mut low, mut high) = (0.0, free);
        let mut approach = (free - flexibility * guess).max(0.5 * SMALLEST).min(free);
        let mut spring = guess;
        for _ in 0..MOST_ITERATIONS {
            let (own, sum, slope) = force(approach, spring);
            spring = own;
            let off = approach - free + flexibility * sum;
            if off > 0.0 {
                high = approach
            } else {
                low = approach
            }
            let newton = approach - off / (1.0 + flexibility * slope);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let settled = (next - approach).abs() <= SETTLED * approach + SMALLEST;
            approach = next;
            if settled || high - low <= SETTLED * high {
                break;
            }
        }
        // where a damper makes the force jump as the wheel touches, only the balance knows it
        let jumps = self.damper > 0.0 && flexibility > 0.0;
        (approach, if jumps { (free - approach) / flexibility } else { force(approach, spring).1 })
    }
}
