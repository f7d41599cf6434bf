//! Cross-validation: independent judges repeat what the tool computed.
//!
//! * [`exchange`]: the questions, as files that know nothing of the tool's formulations;
//! * [`python`]: the environment of the scikit-fem reference, and running it;
//! * [`compare`]: answers against answers, with limits and their causes.

pub mod compare;
pub mod exchange;
pub mod python;

use std::path::Path;

use railspring_calibrate::error::Result;
use railspring_calibrate::monitor::Monitor;
use serde::{Deserialize, Serialize};

use crate::measure::begin;
use crate::output::OutputFolder;
use crate::stages::{self, Answers, Geometry, Meshes};
use crate::study::Study;
use compare::{Check, Provenance, ReferenceResult, Timing, compare};
use exchange::{Case, Exchange};
use python::Python;

/// Result of the cross-check.
pub const CROSSCHECK: &str = "crosscheck.json";
/// Folder of the exchange inside the output folder.
pub const EXCHANGE_FOLDER: &str = "crosscheck";
/// How much coarser the contact elements of the second-order mesh are.
const COARSER: f64 = 2.0;

/// `crosscheck.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CrosscheckRecord {
    /// Name of the study.
    pub study: String,
    /// Whether all limits hold.
    pub holds: bool,
    /// Hash of the study.
    pub input_hash: String,
    /// Version of the tool.
    pub version: String,
    /// When it began.
    pub begun_utc: String,
    /// The computer.
    pub host: String,
    /// Where the reference's numbers come from.
    pub reference: Provenance,
    /// Quantity by quantity.
    pub checks: Vec<Check>,
    /// Times.
    pub timings: Vec<Timing>,
}

/// A study with the tool's answers and the questions.
pub struct Prepared {
    /// Geometry of the study.
    pub geometry: Geometry,
    /// The study's meshes.
    pub meshes: Meshes,
    /// The tool's answers.
    pub answers: Answers,
    /// The questions.
    pub exchange: Exchange,
}

/// Computes the tool's answers and collects the questions.
///
/// # Errors
/// Those of meshing and calibration.
pub fn prepare(study: &Study, cases: &[Case], monitor: &dyn Monitor) -> Result<Prepared> {
    let geometry = stages::geometry(study)?;
    let meshes = stages::meshes(study, &geometry)?;
    let answers = stages::answers(study, &geometry, &meshes, monitor)?;
    let mut coarser = study.clone();
    coarser.mesh.contact_element *= COARSER;
    let coarse = stages::meshes(&coarser, &geometry)?;
    let exchange = Exchange::new(study, &geometry, &meshes, &coarse, &answers, cases.to_vec());
    Ok(Prepared { geometry, meshes, answers, exchange })
}

/// Runs the whole cross-check and writes its files; the record says whether all limits hold.
///
/// # Errors
/// A Python that is missing, and those of the stages.
pub fn crosscheck(
    study: &Study,
    folder: &OutputFolder,
    interpreter: Option<&Path>,
    cases: &[Case],
    monitor: &dyn Monitor,
) -> Result<CrosscheckRecord> {
    let begun = begin();
    // first, so that a missing Python is told before anything is computed
    let python = Python::prepare(interpreter, &python::cache_folder(), monitor)?;
    let prepared = prepare(study, cases, monitor)?;
    let exchange_folder = OutputFolder::create(&folder.file(EXCHANGE_FOLDER))?;
    prepared.exchange.write(&exchange_folder)?;
    python.run(exchange_folder.path(), monitor)?;
    let reference = ReferenceResult::read(&exchange_folder)?;
    let (checks, timings) = compare(&prepared.answers, study.mesh.contact_element, cases, &reference)?;
    let record = CrosscheckRecord {
        study: study.name.clone(),
        holds: checks.iter().all(|check| check.holds),
        input_hash: study.input_hash.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        begun_utc: begun.begun_utc,
        host: begun.host,
        reference: reference.provenance.clone(),
        checks,
        timings,
    };
    folder.write_json(CROSSCHECK, &record)?;
    Ok(record)
}
