//! Asks the reference solver for a load case, and compares.

use railspring_profiles::error::Result;

use super::compare::{ReferenceRuns, checks, forces, limits};
use super::input::InTimeInput;
use super::{question, tool};
use crate::engine::measure::begin;
use crate::engine::output::OutputFolder;
use crate::python::{self, Python};
use crate::results::bodies::estimate::{self, Resources};
use crate::results::bodies::{geometry, zones};
use crate::results::crosscheck::questions::same_mesh;
use crate::results::crosscheck::record::{CrosscheckRecord, Provenance, Question, Timing};

/// Runs the load case on the tool and asks the reference; question and answer are exchanged in `folder`.
///
/// # Errors
/// Those of the bodies, of the runs, and of Python.
pub fn crosscheck(
    input: &InTimeInput<'_>,
    folder: &OutputFolder,
    python: &Python,
    resources: &Resources<'_>,
) -> Result<CrosscheckRecord> {
    let begun = begin();
    let monitor = resources.monitor;
    let statics = input.statics();
    let geometry = geometry::geometry(statics)?;
    let options = zones::mesh_options(statics, &geometry);
    let (meshes, _) = estimate::meshes(&input.solids(), &geometry, options, &input.work(), resources)?;
    let tool = tool::runs(input, &geometry, &meshes, monitor)?;
    let exchange = question::exchange(input, &geometry, &meshes);
    exchange.write(folder)?;
    python.run_in_time(folder.path(), monitor)?;
    let reference = ReferenceRuns::read(folder)?;
    let forces = forces(input, &tool, &reference)?;
    let checks = checks(&forces);
    let solver = reference.solver_name();
    let text = format!(
        "Load case {} from just touching and at rest, {:.4} ms, on both bodies with the tool's mesh and fully integrated \
         first-order bricks, the wheel's hub free along y and z: vertical and lateral force after each of {} time steps, with \
         {} and with {} steps of the bodies in each.",
        input.name,
        1e3 * input.case.time_step * input.case.steps as f64,
        input.case.steps,
        input.inner_steps,
        input.inner_steps / 2,
    );
    Ok(CrosscheckRecord {
        study: input.study().into(),
        holds: checks.iter().all(|check| check.holds),
        input_hash: input.key(),
        version: env!("CARGO_PKG_VERSION").into(),
        begun_utc: begun.begun_utc,
        host: begun.host,
        questions: vec![Question { name: "in_time".into(), reference_solver: solver.clone(), text }],
        calculix: None,
        meshes: same_mesh(&exchange),
        limits: limits(),
        curves: Vec::new(),
        timings: vec![Timing {
            problem: checks[0].problem.clone(),
            reference_solver: solver,
            degrees_of_freedom: reference.degrees_of_freedom,
            loads: input.case.steps,
            tool_seconds: tool.seconds,
            reference_seconds: reference.provenance.seconds,
        }],
        checks,
        reference: Provenance { package_hash: python::package_hash_in_time(), ..reference.provenance },
        in_time: Some(forces),
        content_blake3: String::new(),
    })
}
