//! Cross-validation: independent judges repeat what the tool computed.
//!
//! * [`exchange`]: the questions, as files that know nothing of the tool's formulations;
//! * [`deck`] and [`calculix`]: the same problem as a deck for CalculiX or Abaqus, and running it;
//! * [`mod@compare`]: answers against answers, with limits and their causes;
//! * [`page`]: the page for whoever must trust the numbers.

pub mod calculix;
pub mod compare;
pub mod deck;
pub mod exchange;
pub mod page;

use std::path::Path;
use std::time::Instant;

use railspring_calibrate::error::Result;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::units::MILLIMETRE;
use serde::{Deserialize, Serialize};

use crate::measure::begin;
use crate::output::OutputFolder;
use crate::python::{self, Python};
use crate::stages::{self, Answers, Geometry, Meshes};
use crate::study::Study;
use calculix::displacement_at;
use compare::{Cause, Check, MODEL, Provenance, ReferenceResult, Timing, compare};
use deck::{Deck, Format};
use exchange::{Case, Exchange};

/// Result of the cross-check.
pub const CROSSCHECK: &str = "crosscheck.json";
/// The page about it.
pub const PAGE: &str = "crosscheck.html";
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

/// Computes the tool's answers and collects the questions; `interpreter` is the Python that reads mesh files.
///
/// Elements of second order are asked for on coarser meshes; a mesh from a file stays as it is.
///
/// # Errors
/// Those of meshing and calibration.
pub fn prepare(
    study: &Study,
    cases: &[Case],
    interpreter: Option<&Path>,
    monitor: &dyn Monitor,
) -> Result<Prepared> {
    let geometry = stages::geometry(study)?;
    let meshes = stages::meshes(study, &geometry, interpreter, monitor)?;
    let answers = stages::answers(study, &geometry, &meshes, monitor)?;
    let mut coarser = study.clone();
    coarser.mesh.contact_element *= COARSER;
    coarser.mesh.contact_element_along *= COARSER;
    let coarse = stages::remeshed(&coarser, &geometry, &meshes)?;
    let exchange = Exchange::new(study, &geometry, &meshes, &coarse, &answers, cases.to_vec());
    Ok(Prepared { geometry, meshes, answers, exchange })
}

/// Writes a deck of the study's problem into `folder`: its own element and friction, a step for every
/// judged load; the name of the file.
///
/// # Errors
/// Those of meshing and calibration, and a folder that cannot be written.
pub fn export(
    study: &Study,
    format: Format,
    folder: &OutputFolder,
    interpreter: Option<&Path>,
    monitor: &dyn Monitor,
) -> Result<String> {
    let geometry = stages::geometry(study)?;
    let meshes = stages::meshes(study, &geometry, interpreter, monitor)?;
    let answers = stages::answers(study, &geometry, &meshes, monitor)?;
    let lowerings: Vec<f64> = answers.own_element.points.iter().map(|p| p.displacement).collect();
    let deck = Deck {
        study,
        geometry: &geometry,
        meshes: &meshes,
        element: study.element,
        friction: study.contact.friction,
        lowerings: &lowerings,
    };
    let name = match format {
        Format::Calculix => "calculix.inp",
        Format::Abaqus => "abaqus.inp",
    };
    folder.write(name, deck.text(format)?.as_bytes())?;
    Ok(name.into())
}

/// Lets CalculiX solve the frictionless problem with the study's element.
fn calculix_checks(
    study: &Study,
    prepared: &Prepared,
    folder: &OutputFolder,
    monitor: &dyn Monitor,
) -> Result<(Vec<Check>, Timing)> {
    const PROBLEM: &str = "contact without friction, faceted surfaces";
    let (program, judge) = calculix::version()?;
    let curve = &prepared.answers.own_element;
    let lowerings: Vec<f64> = curve.points.iter().map(|p| p.displacement).collect();
    let deck = Deck {
        study,
        geometry: &prepared.geometry,
        meshes: &prepared.meshes,
        element: study.element,
        friction: 0.0,
        lowerings: &lowerings,
    };
    folder.write("calculix.inp", deck.text(Format::Calculix)?.as_bytes())?;
    monitor.progress("CalculiX", 0, 1)?;
    let clock = Instant::now();
    let steps = calculix::run(program, folder.path(), "calculix")?;
    let seconds = clock.elapsed().as_secs_f64();
    monitor.progress("CalculiX", 1, 1)?;
    let checks = curve
        .points
        .iter()
        .map(|point| {
            let judged = displacement_at(&steps, point.force).unwrap_or(f64::NAN);
            Check::new(
                PROBLEM,
                "hub displacement",
                Some(point.force),
                "mm",
                (point.displacement / MILLIMETRE, judged / MILLIMETRE),
                &judge,
                (judged / point.displacement - 1.0).abs(),
                (MODEL, Cause::Model),
            )
        })
        .collect();
    let timing = Timing {
        problem: PROBLEM.into(),
        judge,
        degrees_of_freedom: 3 * (prepared.meshes.rail.nodes.len() + prepared.meshes.wheel.nodes.len()),
        loads: lowerings.len(),
        tool_seconds: curve.seconds,
        judge_seconds: seconds,
    };
    Ok((checks, timing))
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
    with_calculix: bool,
    monitor: &dyn Monitor,
) -> Result<CrosscheckRecord> {
    let begun = begin();
    if with_calculix {
        calculix::version()?;
    }
    // first, so that a missing Python is told before anything is computed
    let python = Python::prepare(interpreter, &python::cache_folder(), monitor)?;
    let prepared = prepare(study, cases, interpreter, monitor)?;
    let exchange_folder = OutputFolder::create(&folder.file(EXCHANGE_FOLDER))?;
    prepared.exchange.write(&exchange_folder)?;
    python.run(exchange_folder.path(), monitor)?;
    let reference = ReferenceResult::read(&exchange_folder)?;
    let (mut checks, mut timings) =
        compare(&prepared.answers, prepared.meshes.contact_element, cases, &reference)?;
    if with_calculix {
        let (more, timing) = calculix_checks(study, &prepared, &exchange_folder, monitor)?;
        checks.extend(more);
        timings.push(timing);
    }
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
    folder.write(PAGE, page::page(&record, &prepared, &reference).as_bytes())?;
    Ok(record)
}
