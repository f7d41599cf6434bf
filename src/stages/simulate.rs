//! A load case on the moving solver and on the transient solid model.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use railspring_calibrate::element::PairElement;
use railspring_calibrate::error::{Error, Result, StopReason};
use railspring_calibrate::history::History;
use railspring_calibrate::law::NormalLaw;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::pair::CondensedPair;
use railspring_calibrate::scenario::Scenario;
use railspring_calibrate::step_control::InnerSteps;
use railspring_calibrate::superelement::CondensedBody;
use railspring_calibrate::transient::{ModeCount, RailPath, START_MODES, TransientModel, TransientRun};

use super::{Geometry, Meshes, contact_field, enforcement, formulation};
use crate::study::{ContactElementKey, SlidingMatrixKey, Study, StudyScenario, TransientKey};
use crate::verify::{Spread, StepChange, Worth, disturbed};
use railspring_calibrate::beam::BeamCorrection;
use railspring_simulate::condensed::CondensedModel;
use railspring_simulate::moving::{MovingModel, SlidingMatrix, WheelSprings};

/// The springs and the mass that the simple model runs with.
#[derive(Debug, Clone)]
pub struct Springs {
    /// Normal law.
    pub normal: NormalLaw,
    /// Horizontal stiffness, N/m.
    pub horizontal: f64,
    /// Mass of the solid wheel, kg, which scenarios without a mass of their own take.
    pub wheel_mass: f64,
    /// What makes the rail beam as flexible as the solid that the law was calibrated on.
    pub beam: BeamCorrection,
    /// The condensed contact element; without one the springs run in the published one.
    pub element: Option<PairElement>,
}

/// The simple model with one of its contact elements.
enum SimpleModel {
    Published(Box<MovingModel>),
    Condensed(Box<CondensedModel>),
}

impl SimpleModel {
    fn new(study: &Study, geometry: &Geometry, springs: &Springs) -> Result<Self> {
        let (pair, material) = (&geometry.pair, &study.material);
        let beam = geometry.beam.corrected(&springs.beam)?;
        if let Some(element) = &springs.element {
            let model = CondensedModel::of_pair(pair, beam, material, element.clone());
            return Ok(Self::Condensed(Box::new(model)));
        }
        let wheel_springs = WheelSprings {
            horizontal: springs.horizontal,
            normal: springs.normal.clone(),
            longitudinal: springs.horizontal,
        };
        let mut model = MovingModel::of_pair(pair, beam, material, wheel_springs, springs.wheel_mass);
        model.penalty = study.simulation.contact_penalty;
        model.node_spacing = study.simulation.rail_node_spacing;
        model.sliding = match study.simulation.sliding_matrix {
            SlidingMatrixKey::Unsymmetric => SlidingMatrix::Consistent,
            SlidingMatrixKey::Symmetric => SlidingMatrix::Symmetric,
        };
        Ok(Self::Published(Box::new(model)))
    }

    fn element(&self) -> ContactElementKey {
        match self {
            Self::Published(_) => ContactElementKey::Published,
            Self::Condensed(_) => ContactElementKey::Condensed,
        }
    }

    /// Other steps that say what those of a run are worth. The condensed element's longest ones are as long as its scheme is of fourth order: with twice the length it is not, and the change is ten times the
    /// error. Those of the published element are worth as much in either direction, and longer ones take less time; where the history has no longer ones they are half as long.
    fn other_steps(&self, steps: InnerSteps) -> InnerSteps {
        match self {
            Self::Published(_) if steps.doubled() != steps => steps.doubled(),
            _ => steps.halved(),
        }
    }

    fn run(&self, scenario: &Scenario, monitor: &dyn Monitor) -> Result<History> {
        let run = match self {
            Self::Published(model) => model.run(scenario, monitor)?,
            Self::Condensed(model) => model.run(scenario, monitor)?,
        };
        Ok(run.history)
    }
}

/// A run that another one is compared with, or why there is none.
type Other = std::result::Result<History, String>;

/// What a run is worth, and the run with an input that is 0.1 % larger, if it could be done.
pub struct Tried {
    /// What the run is worth.
    pub worth: Worth,
    /// The run with the larger input.
    pub disturbed: Option<History>,
}

impl Tried {
    /// From the run of a load case to those with other steps and with a larger input, of which `more_of` says which it is.
    fn new(
        scenario: &Scenario,
        history: &History,
        (inner_steps, other): (InnerSteps, Other),
        (more_of, larger): (&str, Other),
    ) -> Self {
        let spread = larger.clone().and_then(|larger| Spread::between(history, &larger, more_of));
        let determined_until = spread.as_ref().ok().and_then(|spread| spread.determined_until_s);
        let lengths = [scenario.inner_steps, inner_steps];
        let steps = other.and_then(|other| {
            StepChange::between([history, &other], lengths, scenario.time_step, determined_until)
        });
        let disturbed = larger.ok().filter(|_| spread.is_ok());
        Self { worth: Worth { steps, spread }, disturbed }
    }
}

/// A run that another one is compared with; an interruption ends both.
fn or_reason(run: Result<History>) -> Result<Other> {
    match run {
        Err(Error::Interrupted) => Err(Error::Interrupted),
        run => Ok(run.map_err(|error| error.to_string())),
    }
}

/// Why there is no run with a larger input.
const NO_LOAD: &str = "the load case has no load";

/// Runs of a load case at the same time.
const RUNS: usize = 3;

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

/// The simple model under a load case, and what that run is worth.
///
/// # Errors
/// Newton iterations that do not converge.
pub fn simulate(
    study: &Study,
    geometry: &Geometry,
    springs: &Springs,
    scenario: &StudyScenario,
    monitor: &dyn Monitor,
) -> Result<(History, Tried)> {
    let model = SimpleModel::new(study, geometry, springs)?;
    let progress = Shared { monitor, done: AtomicUsize::new(0) };
    let run = |scenario: &Scenario| model.run(scenario, &progress.share());
    let steps = study.simulation.steps(model.element());
    let scenario = Scenario { inner_steps: steps, ..scenario.scenario.clone() };
    let inner_steps = model.other_steps(steps);
    let larger = disturbed(&scenario);
    // each run has a thread if there is one
    let (history, (other, disturbed)) = rayon::join(
        || run(&scenario),
        || {
            rayon::join(
                || run(&Scenario { inner_steps, ..scenario.clone() }),
                || larger.as_ref().map(|(larger, _)| run(larger)),
            )
        },
    );
    let (history, other) = (history?, or_reason(other)?);
    let (larger, more_of) = match (disturbed, &larger) {
        (Some(run), Some((_, more_of))) => (or_reason(run)?, *more_of),
        _ => (Err(NO_LOAD.into()), ""),
    };
    let tried = Tried::new(&scenario, &history, (inner_steps, other), (more_of, larger));
    Ok((history, tried))
}

/// Most modes that are asked for; with these a run goes on whatever the estimate of their error says.
const MOST_MODES: usize = 4 * START_MODES;

/// The rail between its ends and the wheel, with modes.
pub enum MovingBodies {
    /// Those of a calibration.
    OfCalibration(Arc<CondensedPair>),
    /// By themselves.
    Own(Box<[CondensedBody; 2]>),
}

impl MovingBodies {
    /// Rail and wheel.
    pub fn both(&self) -> [&CondensedBody; 2] {
        match self {
            Self::OfCalibration(pair) => [&pair.rail_on_ends, &pair.wheel],
            Self::Own(bodies) => bodies.each_ref(),
        }
    }
}

/// The solid model under the same load case, and what that run is worth; `bodies` gives those of the meshes with so many modes.
///
/// # Errors
/// Contact iterations that do not converge, and those of `bodies`.
pub fn simulate_solid(
    study: &Study,
    geometry: &Geometry,
    meshes: &Meshes,
    bodies: &dyn Fn(usize) -> Result<Arc<MovingBodies>>,
    scenario: &StudyScenario,
    monitor: &dyn Monitor,
) -> Result<(TransientRun, Tried)> {
    let pair = &geometry.pair;
    let contact = (enforcement(study), contact_field(study));
    let scenario = Scenario { inner_steps: study.solid.steps(), ..scenario.scenario.clone() };
    if study.solid.transient == TransientKey::Full {
        let meshes = [&meshes.rail, &meshes.wheel];
        let materials = [&study.rail.materials, &study.wheel.materials];
        let model = TransientModel::of_pair(pair, meshes, materials, formulation(study), contact);
        let run = model.run(&scenario, monitor)?;
        let tried = tried(&scenario, &run, "");
        return Ok((run, tried));
    }
    let larger = disturbed(&scenario);
    let with = |modes, count| {
        let bodies = bodies(modes)?;
        let path = path_of(study, geometry, meshes, (bodies.both()[0], &scenario, modes))?;
        let model = TransientModel::reduced(pair, bodies.both(), count, study.material.damping, contact);
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
    let run = match study.solid.modes {
        Some(modes) => with(modes, ModeCount::Given(modes))?,
        None => estimated()?,
    };
    let tried = tried(&scenario, &run, larger.as_ref().map_or("", |(_, more_of)| more_of));
    Ok((run, tried))
}

/// The rail at all places of a wheel that moves along it, or stands elsewhere than in its middle, with as many modes as the bodies.
fn path_of(
    study: &Study,
    geometry: &Geometry,
    meshes: &Meshes,
    (rail, scenario, modes): (&CondensedBody, &Scenario, usize),
) -> Result<Option<RailPath>> {
    let length = study.rail.length;
    let wanted = RailPath::is_wanted(scenario, length);
    let of = (length, modes);
    let path =
        || RailPath::new(&geometry.pair, rail, meshes.options(), &study.material, formulation(study), of);
    wanted.then(path).transpose()
}

/// What a run of the solid model is worth: what the longer steps and the larger input of the runs beside it change.
fn tried(scenario: &Scenario, run: &TransientRun, more_of: &str) -> Tried {
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
    Tried::new(scenario, &run.history, (scenario.inner_steps.doubled(), longer), (more_of, larger))
}
