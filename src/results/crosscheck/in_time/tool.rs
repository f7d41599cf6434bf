//! The tool's own run of the load case.

use std::time::Instant;

use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::monitor::Monitor;
use railspring_simulate::solid::TransientModel;
use railspring_simulate::time::history::{Ending, History};
use railspring_simulate::time::scenario::Scenario;
use railspring_simulate::time::steps::InnerSteps;

use super::input::InTimeInput;
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::Meshes;

/// The histories of the tool.
pub struct ToolRuns {
    /// With the study's steps.
    pub history: History,
    /// With steps twice as long.
    pub longer: History,
    /// Time of both, s.
    pub seconds: f64,
}

/// Runs the load case on both bodies at full order, with contact nodes, as the reference has them.
///
/// # Errors
/// Those of the run, and [`InputError`] with its time for a load case that ends early.
pub fn runs(
    input: &InTimeInput<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    monitor: &dyn Monitor,
) -> Result<ToolRuns> {
    let clock = Instant::now();
    let statics = input.statics();
    let damped = [&statics.rail.materials, &statics.wheel.materials].map(|own| own.damped(input.damping));
    let model = TransientModel::of_pair(
        &geometry.pair,
        [&meshes.rail, &meshes.wheel],
        damped.each_ref(),
        statics.element.formulation(),
        (Enforcement::Exact, ContactField::Elements),
    );
    let scenario = Scenario { inner_steps: InnerSteps::Equal(input.inner_steps), ..input.case.clone() };
    let run = model.run(&scenario, monitor)?;
    if run.history.ending != Ending::Completed {
        return InputError::refuse(
            InputField::Steps,
            format!("{}, but {}", input.case.steps, run.history.ending),
            "a load case that runs to its end on the meshes of the study",
            "take fewer steps, or a larger contact zone",
        );
    }
    let longer = run.longer.unwrap_or_else(|| Err("no longer steps".into()));
    let longer = longer.map_err(|reason| {
        InputError::new(
            InputField::InnerSteps,
            format!("{}, of which half do not run: {reason}", input.inner_steps),
            "steps of which half as many run as well",
            "take more",
        )
    })?;
    Ok(ToolRuns { history: run.history, longer, seconds: clock.elapsed().as_secs_f64() })
}
