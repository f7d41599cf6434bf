//! The stages of one size, each with its time and its peak of the memory.

use railspring::engine::measure::Stopwatch;
use railspring::results::bodies::estimate::{condensing, stepping};
use railspring::results::bodies::geometry::Geometry;
use railspring::results::springs::make;
use railspring::study::Study;
use railspring_calibrate::calibration::{Reference, load_points, press_loads};
use railspring_calibrate::pair::{PairBody, PairSolids};
use railspring_calibrate::superelement::{CondensedBody, FactorSize, Step};
use railspring_profiles::error::{Error, Result};
use railspring_profiles::monitor::Monitor;
use railspring_simulate::solid::{ModeCount, TransientModel};
use railspring_simulate::time::function::TimeFunction;
use railspring_simulate::time::scenario::Scenario;
use railspring_simulate::time::steps::InnerSteps;

use super::clock::Clock;
use super::record::{ScalingBody, ScalingSize, ScalingStage};

/// Shares of the study's largest load that are pressed.
const LOADS: [f64; 3] = [0.25, 0.5, 1.0];
/// Steps in time.
const STEPS: usize = 24;
/// Their length, s, in a study without a load case.
const TIME_STEP: f64 = 5e-4;

/// Does something and measures it.
pub(super) fn timed<T>(stage: &str, make: impl FnOnce() -> Result<T>) -> Result<(T, ScalingStage)> {
    let watch = Stopwatch::start();
    let made = make()?;
    Ok((made, measured(stage, &watch)))
}

fn measured(stage: &str, watch: &Stopwatch) -> ScalingStage {
    let (seconds, peak_memory_mib) = watch.read();
    ScalingStage { stage: stage.into(), seconds, peak_memory_mib }
}

/// A body whose equations have their order, and whose factors are counted.
pub(super) struct Ordered<'a> {
    body: PairBody,
    solids: PairSolids<'a>,
    nodes: usize,
    size: FactorSize,
    ordering: ScalingStage,
    /// Bytes that it takes on the way to its condensed form.
    pub memory: f64,
    /// Bytes that it takes in steps in time.
    pub stepping: f64,
}

impl<'a> Ordered<'a> {
    /// The rail between its ends and the wheel, which are to have so many modes.
    ///
    /// # Errors
    /// A mesh that cannot be ordered, and an interruption.
    pub fn both(solids: &PairSolids<'a>, modes: usize, monitor: &dyn Monitor) -> Result<[Self; 2]> {
        let one = |body: PairBody, nodes: usize| -> Result<Self> {
            monitor.progress(body.name(), 0, 5)?;
            let (parts, ordering) = timed("ordering", || solids.parts(body))?;
            let (size, memory) = condensing(&parts, modes)?;
            let stepping = stepping(&size, modes, 1);
            Ok(Self { body, solids: *solids, nodes, size, ordering, memory, stepping })
        };
        Ok([
            one(PairBody::RailOnEnds, solids.rail.nodes.len())?,
            one(PairBody::Wheel, solids.wheel.nodes.len())?,
        ])
    }

    /// Assembles, factors and condenses the body; `product` is the speed of the dense product, multiplications a second.
    ///
    /// # Errors
    /// An inverted element, and an interruption.
    pub fn condensed(
        self,
        modes: usize,
        product: f64,
        monitor: &dyn Monitor,
    ) -> Result<(CondensedBody, ScalingBody)> {
        let Self { body, solids, nodes, size, ordering, .. } = self;
        let mut clock = StepClock::new(body.name(), monitor);
        // nothing is kept of it, so that it needs no key
        let condensed =
            solids.condense_in_steps(body, String::new(), modes, &mut |step, _, _| clock.begin(step))?;
        let stages = clock.stages()?;
        let factorisation =
            stages.iter().find(|stage| stage.stage == "factorisation").map(|stage| stage.seconds);
        let share_of_product = size.multiplications / factorisation.unwrap_or(f64::NAN) / product;
        let record = ScalingBody {
            body: body.name().into(),
            nodes,
            degrees_of_freedom: condensed.equations,
            retained: size.retained,
            factor_values: size.parts * size.values,
            multiplications: size.multiplications,
            share_of_product,
            stages: std::iter::once(ordering).chain(stages).collect(),
        };
        Ok((condensed, record))
    }
}

/// Adds up what the steps of a body take, of all its parts.
struct StepClock<'m> {
    body: &'static str,
    monitor: &'m dyn Monitor,
    /// Time and largest memory of the stages so far.
    stages: [ScalingStage; 4],
    /// The stage that is being done.
    running: Option<(usize, Stopwatch)>,
    /// The last stage that was begun; a second part of the body begins again.
    furthest: usize,
    interrupted: Result<()>,
}

impl<'m> StepClock<'m> {
    fn new(body: &'static str, monitor: &'m dyn Monitor) -> Self {
        let stages = ["assembly", "factorisation", "condensation", "modes"].map(|stage| ScalingStage {
            stage: stage.into(),
            seconds: 0.0,
            peak_memory_mib: None,
        });
        Self { body, monitor, stages, running: None, furthest: 0, interrupted: Ok(()) }
    }

    fn begin(&mut self, step: Step) {
        self.end();
        let stage = match step {
            Step::Assembly => 0,
            Step::Factorisation => 1,
            Step::Condensation => 2,
            Step::Modes => 3,
        };
        self.furthest = self.furthest.max(stage);
        if self.interrupted.is_ok() {
            self.interrupted = self.monitor.progress(self.body, self.furthest + 1, 5);
        }
        self.running = Some((stage, Stopwatch::start()));
    }

    fn end(&mut self) {
        if let Some((stage, watch)) = self.running.take() {
            let (seconds, peak) = watch.read();
            let stage = &mut self.stages[stage];
            stage.seconds += seconds;
            stage.peak_memory_mib = [stage.peak_memory_mib, peak].into_iter().flatten().reduce(f64::max);
        }
    }

    fn stages(mut self) -> Result<[ScalingStage; 4]> {
        self.end();
        self.interrupted?;
        self.monitor.progress(self.body, 5, 5)?;
        Ok(self.stages)
    }
}

/// A load and a step of both bodies; where the contact has no answer, that is a note.
///
/// # Errors
/// An interruption, and what is wrong with the study.
pub(super) fn contact(
    study: &Study,
    geometry: &Geometry,
    [rail, wheel]: [&CondensedBody; 2],
    size: &mut ScalingSize,
    monitor: &dyn Monitor,
) -> Result<()> {
    let conditions = make::contact_conditions(study.statics());
    let largest = study.calibration.loads.last().copied().unwrap_or(0.0);
    let pair = &geometry.pair;
    let (on_rail, on_wheel) =
        (pair.contact_body(PairBody::RailOnEnds, rail)?, pair.contact_body(PairBody::Wheel, wheel)?);
    let on_rail = pair.wheel_on_rail(on_rail, on_wheel, conditions);
    one(size, ("one load", "loads"), monitor, |clock| {
        let states = press_loads(&on_rail, &LOADS.map(|share| share * largest), "loads", clock)?;
        let begun = std::time::Instant::now();
        load_points(&on_rail, &states, Reference::Foot)?;
        // every load has its tangent
        Ok(begun.elapsed().as_secs_f64() / LOADS.len() as f64)
    })?;
    let modes = ModeCount::Given(size_of_modes(rail, wheel));
    let contact = (conditions.enforcement, conditions.field);
    let model = TransientModel::reduced(pair, [rail, wheel], modes, study.damping, contact)?;
    let scenario = scenario(study);
    one(size, ("one step", "transient solid model"), monitor, |clock| {
        model.run(&scenario, clock).map(|_| 0.0)
    })
}

/// Adds a stage: the median of the pieces that are heard of, and what `run` says of the rest.
fn one(
    size: &mut ScalingSize,
    (stage, heard): (&str, &str),
    monitor: &dyn Monitor,
    run: impl FnOnce(&Clock<'_>) -> Result<f64>,
) -> Result<()> {
    let clock = Clock::new(heard, stage, monitor);
    let watch = Stopwatch::start();
    let rest = match run(&clock) {
        Ok(rest) => Some(rest),
        Err(Error::Numerics(failure)) => {
            size.notes.push(format!("{stage}: {failure}"));
            None
        }
        Err(other) => return Err(other),
    };
    let whole = measured(stage, &watch);
    if let (Some(rest), Some(median)) = (rest, clock.median()) {
        size.stages.push(ScalingStage { seconds: median + rest, ..whole });
    }
    Ok(())
}

fn size_of_modes(rail: &CondensedBody, wheel: &CondensedBody) -> usize {
    [rail, wheel].into_iter().flat_map(|body| &body.modes).map(|modes| modes.count()).max().unwrap_or(0)
}

/// The first steps of the study's first load case on the solid model; without one, of a wheel under half the largest load.
fn scenario(study: &Study) -> Scenario {
    let mut cases = study.scenarios.values().filter(|case| case.solid);
    match cases.next() {
        Some(case) => Scenario {
            steps: STEPS,
            inner_steps: InnerSteps::Equal(study.solid.inner_steps.unwrap_or(1)),
            ..case.scenario.clone()
        },
        None => Scenario {
            vertical_force: TimeFunction::constant(
                0.5 * study.calibration.loads.last().copied().unwrap_or(0.0),
            ),
            ..Scenario::new(STEPS, TIME_STEP, study.contact.friction)
        },
    }
}
