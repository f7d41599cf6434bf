//! The time loop of the condensed model, in steps of one length, or as short as the forces ask for.

use std::ops::ControlFlow;

use nalgebra::Point2;

use crate::time::history::{Ending, History};
use crate::time::scenario::Scenario;
use crate::time::steps::StepSequence;
use railspring_element::overlap::Profiles;
use railspring_element::strips::ContactStrips;
use railspring_profiles::error::{Error, Result};
use railspring_profiles::monitor::Monitor;

use super::model::CondensedModel;
use super::run::{Prepared, Run, State};
use crate::element::published::{MovingRun, RunStatistics};

/// A step that does not converge and is as short as can be is halved at most so many times.
const MOST_HALVINGS: usize = 8;

/// What a step may make of the energy of the normal forces, of the largest that they have had: it ends near where a contact begins or ends, and that is given back.
const ENERGY: f64 = 3e-4;

/// A state, and room for the next one.
struct States {
    now: Box<State>,
    next: Box<State>,
}

impl States {
    fn both(&mut self) -> [&mut State; 2] {
        [&mut *self.now, &mut *self.next]
    }
}

impl CondensedModel {
    /// Runs a scenario.
    ///
    /// # Errors
    /// [`railspring_profiles::error::InputError`] for values out of range or a wheel that starts beyond the rail's ends;
    /// [`railspring_profiles::error::NumericsError`] when a step does not converge.
    pub fn run(&self, scenario: &Scenario, monitor: &dyn Monitor) -> Result<MovingRun> {
        self.check(scenario)?;
        let run = Run::new(self, scenario)?;
        let profiles =
            Profiles::new(&self.rail.curve, &self.wheel, self.tape, Point2::from(run.references[1]));
        let mut strips = ContactStrips::new(profiles, &self.element.strips);
        let now = run.start(&mut strips)?;
        let mut steps = Steps::new(&run, &now);
        let mut states = States { next: Box::new(now.clone()), now: Box::new(now) };
        let mut rows = Vec::with_capacity(scenario.steps + 1);
        let mut rail = Vec::with_capacity(scenario.steps + 1);
        rows.push(run.row(0.0, &states.now));
        rail.push(states.now.section());
        let mut ending = Ending::Completed;
        for step in 1..=scenario.steps {
            monitor.progress("simulate", step - 1, scenario.steps)?;
            let time = step as f64 * scenario.time_step;
            let ended =
                steps.reach_row(step, &mut strips, &mut states).map_err(|error| error.at_step(step))?;
            if let Some(reason) = ended {
                ending = reason;
                break;
            }
            let state = &mut states.now;
            state.ledger = state.ledger.stored(&run.stored(state, time));
            rows.push(run.row(time, state));
            rail.push(state.section());
        }
        monitor.progress("simulate", scenario.steps, scenario.steps)?;
        let history = History { rows, degrees_of_freedom: run.degrees_of_freedom(), ending };
        Ok(MovingRun { history, rail, statistics: steps.statistics })
    }
}

/// The steps of a run, one after another.
struct Steps<'r> {
    run: &'r Run<'r>,
    sequence: StepSequence,
    /// By the halvings of the longest ones, as far as they were needed.
    lengths: Vec<Prepared<'r>>,
    /// The bodies' state as the sequence has it, N.
    elastic: Vec<f64>,
    /// The largest energy of the normal forces so far, J.
    largest: f64,
    statistics: RunStatistics,
}

impl<'r> Steps<'r> {
    /// From a state at the start of a run on.
    fn new(run: &'r Run<'r>, start: &State) -> Self {
        let mut sequence = StepSequence::new(run.scenario.inner_steps, run.scenario.largest_load());
        let mut elastic = Vec::new();
        run.elastic_state(start, &mut elastic);
        sequence.begin(&start.force(), &elastic);
        let statistics = RunStatistics::default();
        Self { run, sequence, lengths: Vec::new(), elastic, largest: start.normal_energy(), statistics }
    }

    /// Goes on to the end of a time step of the history, or to how the run ends before.
    fn reach_row(
        &mut self,
        row: usize,
        strips: &mut ContactStrips,
        states: &mut States,
    ) -> Result<Option<Ending>> {
        let ticks = row * self.run.scenario.inner_steps.most();
        while self.sequence.ticks() < ticks {
            let ending = self.advance(strips, states)?;
            if ending.is_some() {
                return Ok(ending);
            }
        }
        Ok(None)
    }

    /// The next step, as short as it has to be; how a run ends is found with the shortest ones.
    fn advance(&mut self, strips: &mut ContactStrips, states: &mut States) -> Result<Option<Ending>> {
        let run = self.run;
        loop {
            let level = self.sequence.level();
            while self.lengths.len() <= level {
                let [longest, _] = run.scenario.inner_steps.lengths(run.scenario.time_step);
                self.lengths.push(run.prepare(longest * 0.5_f64.powi(self.lengths.len() as i32))?);
            }
            let shortest = run.scenario.shortest_step();
            let times = [self.sequence.ticks(), self.sequence.end()].map(|ticks| ticks as f64 * shortest);
            match run.attempt(strips, states.both(), &self.lengths[level], times) {
                Err(Error::Numerics(_)) | Ok(ControlFlow::Break(_)) if self.sequence.shorten() => {}
                Ok(ControlFlow::Break(ending)) => return Ok(Some(ending)),
                Ok(ControlFlow::Continue(looks)) => {
                    self.statistics.evaluations += looks;
                    if self.accepts(&states.next, states.now.made) {
                        self.take(strips, states, looks);
                        return Ok(None);
                    }
                }
                Err(Error::Numerics(_)) => {
                    let ending = self.in_halves(strips, states, times, 1)?;
                    if ending.is_none() {
                        self.accepts(&states.now, states.now.made);
                    }
                    return Ok(ending);
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// A step between two times that does not converge, in two halves.
    fn in_halves(
        &mut self,
        strips: &mut ContactStrips,
        states: &mut States,
        [from, to]: [f64; 2],
        halvings: usize,
    ) -> Result<Option<Ending>> {
        self.statistics.halved_steps += 1;
        let middle = 0.5 * (from + to);
        let half = self.run.prepare(middle - from)?;
        for times in [[from, middle], [middle, to]] {
            match self.run.attempt(strips, states.both(), &half, times) {
                Ok(ControlFlow::Break(ending)) => return Ok(Some(ending)),
                Ok(ControlFlow::Continue(looks)) => {
                    self.statistics.evaluations += looks;
                    self.take(strips, states, looks);
                }
                Err(Error::Numerics(_)) if halvings < MOST_HALVINGS => {
                    let ending = self.in_halves(strips, states, times, halvings + 1)?;
                    if ending.is_some() {
                        return Ok(ending);
                    }
                }
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }

    /// Whether a step to a state is short enough, before which the steps had made an energy, J.
    fn accepts(&mut self, state: &State, before: f64) -> bool {
        if StepSequence::levels(self.run.scenario.inner_steps) == 0 {
            return self.sequence.accept(&[], &[], 0.0);
        }
        self.run.elastic_state(state, &mut self.elastic);
        let largest = self.largest.max(state.normal_energy());
        let made = (state.made - before).abs();
        let share = if made == 0.0 { 0.0 } else { made / (ENERGY * largest) };
        let accepted = self.sequence.accept(&state.force(), &self.elastic, share);
        if accepted {
            self.largest = largest;
        }
        accepted
    }

    /// Takes a step that looked so often at the contacts.
    fn take(&mut self, strips: &mut ContactStrips, states: &mut States, looks: usize) {
        if looks > 0 {
            strips.commit(self.run.scenario.friction);
        }
        std::mem::swap(&mut states.now, &mut states.next);
        let statistics = &mut self.statistics;
        statistics.steps += 1;
        statistics.iterations += looks;
        statistics.most_iterations = statistics.most_iterations.max(looks);
    }
}
