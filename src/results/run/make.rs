//! A load case on the moving solver and on the transient solid model.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use railspring_calibrate::beam::{BeamCorrection, RailBeam};
use railspring_calibrate::law::NormalLaw;
use railspring_calibrate::pair::Pair;
use railspring_element::pair_element::PairElement;
use railspring_profiles::error::{Error, Result, StopReason, or_reason};
use railspring_profiles::monitor::Monitor;
use railspring_simulate::element::condensed::CondensedModel;
use railspring_simulate::element::published::{MovingModel, SlidingMatrix, WheelSprings};
use railspring_simulate::solid::{ModeCount, OtherRun, START_MODES, TransientModel, TransientRun};
use railspring_simulate::time::history::History;
use railspring_simulate::time::scenario::Scenario;
use railspring_simulate::time::steps::InnerSteps;

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::input::SolidRunInput;
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::other_solids::{CoarserContact, OtherSolids, path_on};
use crate::results::bodies::solids::MovingBodies;
use crate::results::run::input::SimpleRunInput;
use crate::study::{ContactElementKey, SlidingMatrixKey, TransientKey};
use crate::verify::{ModelChange, NumericalUncertainty, Spread, StepChange, disturbed};

/// The springs and the mass that the simple model runs with.
#[derive(Debug, Clone)]
pub struct Springs {
    /// Normal law.
    pub normal: NormalLaw,
    /// Horizontal stiffness, N/m.
    pub horizontal: f64,
    /// Mass of the solid wheel, kg; an element that is made from the solids has its own.
    pub wheel_mass: f64,
    /// What makes the rail beam as flexible as the solid that the law was calibrated on.
    pub beam: BeamCorrection,
    /// The condensed or the lumped contact element, and which it is; without one the springs run in the published one.
    pub element: Option<(ContactElementKey, PairElement)>,
}

impl Springs {
    /// Mass of the wheel of load cases without a mass of their own, kg.
    pub fn mass(&self) -> f64 {
        self.element.as_ref().map_or(self.wheel_mass, |(_, element)| element.wheel.mass[(1, 1)])
    }
}

/// The simple model with one of its contact elements.
pub(crate) enum SimpleModel {
    Published(Box<MovingModel>),
    OfSolids(ContactElementKey, Box<CondensedModel>),
}

impl SimpleModel {
    /// The model of a pair on a rail `beam`, which is corrected to the solid rail.
    ///
    /// # Errors
    /// Those of the beam.
    pub fn new(input: &SimpleRunInput<'_>, pair: &Pair, beam: &RailBeam, springs: &Springs) -> Result<Self> {
        if let Some((key, element)) = &springs.element {
            let model = model_of_solids(input, pair, beam, &springs.beam, element.clone())?;
            return Ok(Self::OfSolids(*key, Box::new(model)));
        }
        let damped = [&input.rail.material, &input.wheel.material].map(|own| own.damped(input.damping));
        let beam = beam.corrected(&springs.beam)?;
        let wheel_springs = WheelSprings {
            horizontal: springs.horizontal,
            normal: springs.normal.clone(),
            longitudinal: springs.horizontal,
        };
        let mut model =
            MovingModel::of_pair(pair, beam, damped.each_ref(), wheel_springs, springs.wheel_mass);
        model.penalty = input.simulation.contact_penalty;
        model.node_spacing = input.simulation.rail_node_spacing;
        model.sliding = match input.simulation.sliding_matrix {
            SlidingMatrixKey::Unsymmetric => SlidingMatrix::Consistent,
            SlidingMatrixKey::Symmetric => SlidingMatrix::Symmetric,
        };
        Ok(Self::Published(Box::new(model)))
    }

    /// Its contact element.
    pub fn element(&self) -> ContactElementKey {
        match self {
            Self::Published(_) => ContactElementKey::Published,
            Self::OfSolids(key, _) => *key,
        }
    }

    /// Other steps, which show the error of those of a run. The condensed model's longest ones are as long as its scheme is of fourth order: with twice the length it is not, and the change is ten times the
    /// error. With the published element the change is as large in either direction, and longer ones take less time; where the history has no longer ones they are half as long.
    fn other_steps(&self, steps: InnerSteps) -> InnerSteps {
        match self {
            Self::Published(_) if steps.doubled() != steps => steps.doubled(),
            _ => steps.halved(),
        }
    }

    /// A load case on it.
    ///
    /// # Errors
    /// Iterations that do not converge.
    pub fn run(&self, scenario: &Scenario, monitor: &dyn Monitor) -> Result<History> {
        let run = match self {
            Self::Published(model) => model.run(scenario, monitor)?,
            Self::OfSolids(_, model) => model.run(scenario, monitor)?,
        };
        Ok(run.history)
    }
}

/// The model of a pair with an element of the solids on a rail `beam`, which is corrected to the solid rail.
///
/// # Errors
/// Those of the beam.
pub fn model_of_solids(
    input: &SimpleRunInput<'_>,
    pair: &Pair,
    beam: &RailBeam,
    correction: &BeamCorrection,
    element: PairElement,
) -> Result<CondensedModel> {
    let damped = [&input.rail.material, &input.wheel.material].map(|own| own.damped(input.damping));
    Ok(CondensedModel::of_pair(pair, beam.corrected(correction)?, damped.each_ref(), element))
}

/// The numerical uncertainty of a run, and the run with an input that is 0.1 % larger, if it could be done.
pub struct RunWithErrors {
    /// The numerical uncertainty of the run.
    pub uncertainty: NumericalUncertainty,
    /// The run with the larger input.
    pub disturbed: Option<History>,
}

impl RunWithErrors {
    /// The changes from the run of a load case to other runs, each with its changes: those with other steps,
    /// with a larger input, which `more_of` names, and of other models. These have the steps of the history,
    /// or of the longer ones where `models_have_longer_steps`.
    fn new(
        scenario: &Scenario,
        history: &History,
        (inner_steps, other): (InnerSteps, OtherRun),
        (more_of, larger): (&str, OtherRun),
        (models_have_longer_steps, models): (bool, Vec<(String, OtherRun)>),
    ) -> Self {
        let spread = larger.clone().and_then(|larger| Spread::between(history, &larger, more_of));
        let determined_until = spread.as_ref().ok().and_then(|spread| spread.determined_until_s);
        let lengths = [scenario.inner_steps, inner_steps];
        let of_models = other.clone().ok().filter(|_| models_have_longer_steps);
        let of_models = of_models.as_ref().unwrap_or(history);
        let steps = other.and_then(|other| {
            StepChange::between([history, &other], lengths, scenario.time_step, determined_until)
        });
        let disturbed = larger.ok().filter(|_| spread.is_ok());
        let changed = |(with, other): (String, OtherRun)| {
            let change =
                other.and_then(|other| ModelChange::between([of_models, &other], &with, determined_until));
            change.map_err(|reason| format!("the change with {with} is not known: {reason}"))
        };
        let discretisation = models.into_iter().map(changed).collect();
        Self { uncertainty: NumericalUncertainty { steps, spread, discretisation }, disturbed }
    }
}

/// Why there is no run with a larger input.
const NO_LOAD: &str = "the load case has no load";

/// Runs of a load case at the same time.
const RUNS: usize = 4;

/// Progress of runs at the same time as that of one stage.
struct Shared<'a> {
    monitor: &'a dyn Monitor,
    done: AtomicUsize,
}

/// The part of one run.
struct Share<'a> {
    of: &'a Shared<'a>,
    done: AtomicUsize,
}

impl Shared<'_> {
    fn share(&self) -> Share<'_> {
        Share { of: self, done: AtomicUsize::new(0) }
    }
}

impl Monitor for Share<'_> {
    fn progress(&self, stage: &str, done: usize, total: usize) -> Result<()> {
        let before = self.done.swap(done, Ordering::Relaxed);
        let all = &self.of.done;
        let all = all.fetch_add(done.saturating_sub(before), Ordering::Relaxed) + done.saturating_sub(before);
        self.of.monitor.progress(stage, all, RUNS * total)
    }

    fn notice(&self, text: &str) {
        self.of.monitor.notice(text);
    }
}

/// The simple model under a load case, and the uncertainty of that run.
///
/// # Errors
/// Newton iterations that do not converge.
pub fn simulate(
    input: &SimpleRunInput<'_>,
    geometry: &Geometry,
    springs: &Springs,
    monitor: &dyn Monitor,
) -> Result<(History, RunWithErrors)> {
    let model = SimpleModel::new(input, &geometry.pair, &geometry.beam, springs)?;
    let progress = Shared { monitor, done: AtomicUsize::new(0) };
    let run = |scenario: &Scenario| model.run(scenario, &progress.share());
    let finer = || {
        let elements = FINER_BEAM * input.simulation.rail_elements;
        let beam = geometry.pair.beam(&input.rail.material, input.rail.length, elements)?;
        Ok::<_, Error>((elements, SimpleModel::new(input, &geometry.pair, &beam, springs)?))
    };
    let (elements, finer) = finer()?;
    let steps = input.simulation.steps(model.element());
    let scenario = Scenario { inner_steps: steps, ..input.case.clone() };
    let inner_steps = model.other_steps(steps);
    let larger = disturbed(&scenario);
    // each run has a thread if there is one
    let ((history, of_finer), (other, disturbed)) = rayon::join(
        || rayon::join(|| run(&scenario), || finer.run(&scenario, &progress.share())),
        || {
            rayon::join(
                || run(&Scenario { inner_steps, ..scenario.clone() }),
                || larger.as_ref().map(|(larger, _)| run(larger)),
            )
        },
    );
    let (history, other) = (history?, or_reason(other)?);
    let models = vec![(format!("{elements} elements of the rail beam"), or_reason(of_finer)?)];
    let (larger, more_of) = match (disturbed, &larger) {
        (Some(run), Some((_, more_of))) => (or_reason(run)?, *more_of),
        _ => (Err(NO_LOAD.into()), ""),
    };
    let tried =
        RunWithErrors::new(&scenario, &history, (inner_steps, other), (more_of, larger), (false, models));
    Ok((history, tried))
}

/// Elements of the rail beam in the run that shows their error, over those of the model.
const FINER_BEAM: usize = 2;

/// Most modes that are asked for; with these a run goes on whatever the estimate of their error says.
const MOST_MODES: usize = 4 * START_MODES;

/// The solid model under the same load case, and the uncertainty of that run; `bodies` gives those of the meshes with so many modes, and `coarser` those of
/// coarser contact elements.
///
/// # Errors
/// Contact iterations that do not converge, and those of `bodies` and `coarser`.
pub fn simulate_solid(
    input: &SolidRunInput<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    bodies: &dyn Fn(usize) -> Result<Arc<MovingBodies>>,
    coarser: &(dyn Fn(usize) -> Result<CoarserContact> + Sync),
    monitor: &dyn Monitor,
) -> Result<(TransientRun, RunWithErrors)> {
    let pair = &geometry.pair;
    let contact = input.pair.contact.of_solids();
    let scenario = Scenario { inner_steps: input.solid.steps(), ..input.case.clone() };
    if input.solid.transient == TransientKey::Full {
        let meshes = [&meshes.rail, &meshes.wheel];
        let damped =
            [&input.pair.rail.materials, &input.pair.wheel.materials].map(|own| own.damped(input.damping));
        let element = input.pair.element.formulation();
        let model = TransientModel::of_pair(pair, meshes, damped.each_ref(), element, contact);
        let run = model.run(&scenario, monitor)?;
        let tried = tried(&scenario, &run, "", Vec::new());
        return Ok((run, tried));
    }
    let larger = disturbed(&scenario);
    let with = |modes, count| {
        let bodies = bodies(modes)?;
        let path = path_on(input, geometry, meshes.options(), (bodies.both()[0], &scenario, modes))?;
        let model = TransientModel::reduced(pair, bodies.both(), count, input.damping, contact)?;
        let model = match &path {
            Some(path) => model.along(path),
            None => model,
        };
        match &larger {
            Some((larger, _)) => model.run_beside(&scenario, larger, monitor),
            None => model.run(&scenario, monitor),
        }
    };
    let estimated = || -> Result<TransientRun> {
        let mut modes = START_MODES;
        while modes < MOST_MODES {
            match with(modes, ModeCount::Estimated) {
                Err(Error::Numerics(cause)) if cause.reason == StopReason::TooFewModes => modes *= 2,
                done => return done,
            }
        }
        with(modes, ModeCount::Given(modes))
    };
    let run = match input.solid.modes {
        Some(modes) => with(modes, ModeCount::Given(modes))?,
        None => estimated()?,
    };
    let others = match &run.reduction {
        Some(reduction) if input.error_band => {
            let modes = reduction.modes[0].max(reduction.modes[1]);
            let own = bodies(input.solid.modes.unwrap_or(modes))?;
            let solid = OtherSolids { input: *input, geometry, scenario: &scenario, modes, monitor };
            solid.runs(&run, (meshes, &own), coarser)?
        }
        _ => Vec::new(),
    };
    let tried = tried(&scenario, &run, larger.as_ref().map_or("", |(_, more_of)| more_of), others);
    Ok((run, tried))
}

/// The numerical uncertainty of a run of the solid model: what the longer steps and the larger input of the runs beside it change.
fn tried(
    scenario: &Scenario,
    run: &TransientRun,
    more_of: &str,
    models: Vec<(String, OtherRun)>,
) -> RunWithErrors {
    let longer = run.longer.clone().unwrap_or_else(|| {
        // half the length would take twice as long as the run
        Err("`solid.inner_steps` is 1; of more, half as many are tried as well".into())
    });
    let larger = run.other.clone().unwrap_or_else(|| {
        Err(match run.reduction {
            Some(_) => NO_LOAD.into(),
            None => "bodies at full order would take as long again".into(),
        })
    });
    RunWithErrors::new(
        scenario,
        &run.history,
        (scenario.inner_steps.doubled(), longer),
        (more_of, larger),
        (true, models),
    )
}
