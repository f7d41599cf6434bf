//! A load case on the moving solver and on the transient solid model.

use std::sync::Arc;

use railspring_calibrate::error::{Error, Result, StopReason};
use railspring_calibrate::history::History;
use railspring_calibrate::law::NormalLaw;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::scenario::Scenario;
use railspring_calibrate::superelement::CondensedBody;
use railspring_calibrate::transient::{ModeCount, START_MODES, TransientModel, TransientRun};

use super::{Geometry, Meshes, contact_field, enforcement, formulation};
use crate::study::{SlidingMatrixKey, Study, StudyScenario, TransientKey};
use crate::verify::StepChange;
use railspring_calibrate::beam::BeamCorrection;
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
}

/// What steps of another length change, or why that is not known.
pub type OtherSteps = std::result::Result<StepChange, String>;

/// Time over which other steps are tried in the solid model, s: up to the impacts of a load case, whose runs diverge later.
const TRIED_TIME: f64 = 0.06;

/// The simple model under a load case.
///
/// # Errors
/// Newton iterations that do not converge.
pub fn simulate(
    study: &Study,
    geometry: &Geometry,
    springs: &Springs,
    scenario: &StudyScenario,
    monitor: &dyn Monitor,
) -> Result<(History, OtherSteps)> {
    let wheel_springs = WheelSprings {
        horizontal: springs.horizontal,
        normal: springs.normal.clone(),
        longitudinal: springs.horizontal,
    };
    let beam = geometry.beam.corrected(&springs.beam)?;
    let mut model =
        MovingModel::of_pair(&geometry.pair, beam, &study.material, wheel_springs, springs.wheel_mass);
    model.penalty = study.simulation.contact_penalty;
    model.node_spacing = study.simulation.rail_node_spacing;
    model.sliding = match study.simulation.sliding_matrix {
        SlidingMatrixKey::Unsymmetric => SlidingMatrix::Consistent,
        SlidingMatrixKey::Symmetric => SlidingMatrix::Symmetric,
    };
    let steps = study.simulation.inner_steps;
    let with = |scenario: &Scenario| -> Result<History> { Ok(model.run(scenario, monitor)?.history) };
    let scenario = Scenario { inner_steps: steps, ..scenario.scenario.clone() };
    let history = with(&scenario)?;
    let change = other_steps(&scenario, &history, with)?;
    Ok((history, change))
}

/// What steps of twice the length change in `history`, the run of `scenario`; where that has one step in each of the history, what half the
/// length changes.
///
/// # Errors
/// An interruption.
fn other_steps(
    scenario: &Scenario,
    history: &History,
    with: impl Fn(&Scenario) -> Result<History>,
) -> Result<OtherSteps> {
    let inner_steps = if scenario.inner_steps > 1 { scenario.inner_steps.div_ceil(2) } else { 2 };
    let other = Scenario { inner_steps, ..scenario.clone() };
    match with(&other) {
        Ok(changed) => {
            let steps = [scenario.inner_step(), other.inner_step()];
            Ok(Ok(StepChange::between([history, &changed], steps)))
        }
        Err(Error::Interrupted) => Err(Error::Interrupted),
        Err(error) => Ok(Err(error.to_string())),
    }
}

/// Most modes that are asked for; with these a run goes on whatever the estimate of their error says.
const MOST_MODES: usize = 4 * START_MODES;

/// The rail between its ends and the wheel, with modes.
pub type MovingBodies = [CondensedBody; 2];

/// The solid model under the same load case, and what other steps change; `bodies` gives those of the meshes with so many modes.
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
) -> Result<(TransientRun, OtherSteps)> {
    let (pair, material) = (&geometry.pair, study.material);
    let contact = (enforcement(study), contact_field(study));
    let scenario = Scenario { inner_steps: study.solid.inner_steps, ..scenario.scenario.clone() };
    let tried = (TRIED_TIME / scenario.time_step).ceil().min(scenario.steps as f64) as usize;
    let shorter = Scenario { steps: tried, ..scenario.clone() };
    let other = |run: &TransientRun, with: &dyn Fn(&Scenario) -> Result<TransientRun>| {
        if scenario.inner_steps == 1 {
            // half the length would take twice as long as the run
            return Ok(Err("`solid.inner_steps` is 1; of more, half as many are tried as well".into()));
        }
        other_steps(&shorter, &run.history, |scenario| Ok(with(scenario)?.history))
    };
    if study.solid.transient == TransientKey::Full {
        let meshes = [&meshes.rail, &meshes.wheel];
        let model = TransientModel::of_pair(pair, meshes, material, formulation(study), contact);
        let with = |scenario: &Scenario| model.run(scenario, monitor);
        let run = with(&scenario)?;
        let change = other(&run, &with)?;
        return Ok((run, change));
    }
    let with = |modes, count, scenario: &Scenario| {
        let bodies = bodies(modes)?;
        let [rail, wheel] = &*bodies;
        TransientModel::reduced(pair, [rail, wheel], count, material, contact).run(scenario, monitor)
    };
    let estimated = || -> Result<(TransientRun, usize)> {
        let mut modes = START_MODES;
        while modes < MOST_MODES {
            match with(modes, ModeCount::Estimated, &scenario) {
                Err(Error::Numerics(cause)) if cause.reason == StopReason::TooFewModes => modes *= 2,
                done => return Ok((done?, modes)),
            }
        }
        Ok((with(modes, ModeCount::Given(modes), &scenario)?, modes))
    };
    let (run, modes) = match study.solid.modes {
        Some(modes) => (with(modes, ModeCount::Given(modes), &scenario)?, modes),
        None => estimated()?,
    };
    let used = run.reduction.as_ref().map_or(modes, |reduction| reduction.modes[0].max(reduction.modes[1]));
    let change = other(&run, &|scenario| with(modes, ModeCount::Given(used), scenario))?;
    Ok((run, change))
}
