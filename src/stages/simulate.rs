//! A load case on the moving solver and on the transient solid model.

use std::sync::Arc;

use railspring_calibrate::error::{Error, Result, StopReason};
use railspring_calibrate::history::History;
use railspring_calibrate::law::NormalLaw;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::scenario::Scenario;
use railspring_calibrate::step_control::InnerSteps;
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
    let with = |inner_steps| -> Result<History> {
        Ok(model.run(&Scenario { inner_steps, ..scenario.scenario.clone() }, monitor)?.history)
    };
    let steps = InnerSteps::Equal(study.simulation.inner_steps);
    let history = with(steps)?;
    // steps of twice the length; where the history has no longer ones, of half the length
    let other = if steps.doubled() == steps { InnerSteps::Equal(2) } else { steps.doubled() };
    let change = match with(other) {
        Ok(changed) => StepChange::between([&history, &changed], [steps, other], scenario.scenario.time_step),
        Err(Error::Interrupted) => return Err(Error::Interrupted),
        Err(error) => Err(error.to_string()),
    };
    Ok((history, change))
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
    let scenario = Scenario { inner_steps: study.solid.steps(), ..scenario.scenario.clone() };
    if study.solid.transient == TransientKey::Full {
        let meshes = [&meshes.rail, &meshes.wheel];
        let model = TransientModel::of_pair(pair, meshes, material, formulation(study), contact);
        let run = model.run(&scenario, monitor)?;
        let change = change(&scenario, &run);
        return Ok((run, change));
    }
    let with = |modes, count| {
        let bodies = bodies(modes)?;
        let [rail, wheel] = &*bodies;
        TransientModel::reduced(pair, [rail, wheel], count, material, contact).run(&scenario, monitor)
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
    let change = change(&scenario, &run);
    Ok((run, change))
}

/// What longer steps of the integration change in a run of the solid model.
fn change(scenario: &Scenario, run: &TransientRun) -> OtherSteps {
    match &run.longer {
        Some(Ok(longer)) => {
            let steps = [scenario.inner_steps, scenario.inner_steps.doubled()];
            StepChange::between([&run.history, longer], steps, scenario.time_step)
        }
        Some(Err(reason)) => Err(reason.clone()),
        // half the length would take twice as long as the run
        None => Err("`solid.inner_steps` is 1; of more, half as many are tried as well".into()),
    }
}
