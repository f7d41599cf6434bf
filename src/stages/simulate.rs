//! A load case on the moving solver and on the transient solid model.

use std::sync::Arc;

use railspring_calibrate::error::{Error, Result, StopReason};
use railspring_calibrate::history::History;
use railspring_calibrate::law::NormalLaw;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::superelement::CondensedBody;
use railspring_calibrate::transient::{ModeCount, START_MODES, TransientModel, TransientRun};

use super::{Geometry, Meshes, contact_field, enforcement, formulation};
use crate::study::{SlidingMatrixKey, Study, StudyScenario, TransientKey};
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
) -> Result<History> {
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
    Ok(model.run(&scenario.scenario, monitor)?.history)
}

/// Most modes that are asked for; with these a run goes on whatever the estimate of their error says.
const MOST_MODES: usize = 4 * START_MODES;

/// The rail between its ends and the wheel, with modes.
pub type MovingBodies = [CondensedBody; 2];

/// The solid model under the same load case; `bodies` gives those of the meshes with so many modes.
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
) -> Result<TransientRun> {
    let (pair, material) = (&geometry.pair, study.material);
    let contact = (enforcement(study), contact_field(study));
    if study.solid.transient == TransientKey::Full {
        let meshes = [&meshes.rail, &meshes.wheel];
        let model = TransientModel::of_pair(pair, meshes, material, formulation(study), contact);
        return model.run(&scenario.scenario, monitor);
    }
    let run = |modes, count| {
        let bodies = bodies(modes)?;
        let [rail, wheel] = &*bodies;
        TransientModel::reduced(pair, [rail, wheel], count, material, contact)
            .run(&scenario.scenario, monitor)
    };
    if let Some(modes) = study.solid.modes {
        return run(modes, ModeCount::Given(modes));
    }
    let mut modes = START_MODES;
    while modes < MOST_MODES {
        match run(modes, ModeCount::Estimated) {
            Err(Error::Numerics(cause)) if cause.reason == StopReason::TooFewModes => modes *= 2,
            done => return done,
        }
    }
    run(modes, ModeCount::Given(modes))
}
