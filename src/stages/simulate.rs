//! A load case on the moving solver and on the transient solid model.

use railspring_calibrate::error::Result;
use railspring_calibrate::history::History;
use railspring_calibrate::law::NormalLaw;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::transient::TransientModel;

use super::{Geometry, Meshes, contact_field, enforcement, formulation};
use crate::study::{SlidingMatrixKey, Study, StudyScenario};
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

/// The solid model under the same load case.
///
/// # Errors
/// Contact iterations that do not converge.
pub fn simulate_solid(
    study: &Study,
    geometry: &Geometry,
    meshes: &Meshes,
    scenario: &StudyScenario,
    monitor: &dyn Monitor,
) -> Result<History> {
    let model = TransientModel::of_pair(
        &geometry.pair,
        [&meshes.rail, &meshes.wheel],
        study.material,
        formulation(study),
        (enforcement(study), contact_field(study)),
    );
    Ok(model.run(&scenario.scenario, monitor)?.history)
}
