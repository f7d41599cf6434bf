//! Cross-validation: independent programs repeat what the tool computed.
//!
//! * [`exchange`]: the questions, as files without the tool's formulations;
//! * [`deck`] and [`calculix`]: the same problem as a deck for CalculiX or Abaqus, and running it;
//! * [`mod@compare`]: answers against answers, with limits and their causes;
//! * [`questions`]: the questions in words and numbers;
//! * [`mod@sections`]: where on the bodies the answers differ.

pub mod calculix;
pub mod exchange;
pub mod compare;
pub mod deck;
pub mod questions;
pub mod sections;

use std::path::Path;
use std::time::Instant;

use railspring_calibrate::error::{Error, InputError, Result};
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::units::MILLIMETRE;

use crate::estimate::{self, Budget, Work};
use crate::measure::begin;
use crate::output::OutputFolder;
use crate::pipeline::{CROSSCHECK, DIFFERENCES, Pipeline};
use crate::python::{self, Purpose, Python};
use crate::records::crosscheck::{
    Cause, Check, CrosscheckRecord, Differences, HUB_DISPLACEMENT, Provenance, Timing,
};
use crate::stages::{self, Answers, Geometry, Meshes};
use crate::study::Study;
use calculix::displacement_at;
use compare::{MODEL, ReferenceResult, compare, limits};
use deck::{Deck, Format};
use exchange::{BODIES, Case, Exchange};

/// Folder of the exchange inside the output folder.
pub const EXCHANGE_FOLDER: &str = "crosscheck";
/// Size of the contact elements of the second-order mesh over that of the study's mesh.
const FINER: f64 = 0.75;

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

/// Computes the tool's answers and collects the questions, within the memory of `settings`.
///
/// Elements of second order are on finer meshes; a mesh from a file stays as it is.
///
/// # Errors
/// Those of meshing and calibration, and sizes that the machine cannot hold.
pub fn prepare(study: &Study, settings: &Settings<'_>, monitor: &dyn Monitor) -> Result<Prepared> {
    let Settings { cases, interpreter, budget, .. } = *settings;
    let geometry = stages::geometry(study)?;
    let work = Work::of_crosscheck(settings.purpose());
    let meshes = estimate::meshes(study, &geometry, &work, budget, interpreter, monitor)?;
    let answers = stages::answers(study, &geometry, &meshes, monitor)?;
    let fine = if cases.contains(&Case::SecondOrder) {
        let mut finer = study.clone();
        finer.mesh.contact_element *= FINER;
        finer.mesh.contact_element_along *= FINER;
        Some(stages::remeshed(&finer, &geometry, &meshes)?)
    } else {
        None
    };
    let exchange = Exchange::new(study, &geometry, &meshes, fine.as_ref(), &answers, cases.to_vec());
    Ok(Prepared { geometry, meshes, answers, exchange })
}

/// Writes a deck of the study's problem into `folder`: its own element and friction, a step for every
/// wanted load; the name of the file. `interpreter` is the Python that reads mesh files.
///
/// # Errors
/// Those of meshing and calibration, sizes that the machine cannot hold, and a folder that cannot be written.
pub fn export(
    study: &Study,
    format: Format,
    folder: &OutputFolder,
    (interpreter, budget): (Option<&Path>, Budget),
    monitor: &dyn Monitor,
) -> Result<String> {
    let geometry = stages::geometry(study)?;
    let work = Work::of(study, true, false);
    let meshes = estimate::meshes(study, &geometry, &work, budget, interpreter, monitor)?;
    let curve = stages::faceted(study, &geometry, &meshes, monitor)?;
    let lowerings: Vec<f64> = curve.points.iter().map(|p| p.displacement).collect();
    let deck = Deck {
        study,
        geometry: &geometry,
        meshes: &meshes,
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
    (program, reference_solver): (&str, &str),
    folder: &OutputFolder,
    monitor: &dyn Monitor,
) -> Result<(Vec<Check>, Timing)> {
    const PROBLEM: &str = "contact without friction, faceted surfaces";
    let curve = &prepared.answers.faceted;
    let lowerings: Vec<f64> = curve.points.iter().map(|p| p.displacement).collect();
    let deck = Deck {
        study,
        geometry: &prepared.geometry,
        meshes: &prepared.meshes,
        friction: 0.0,
        lowerings: &lowerings,
    };
    folder.write("calculix.inp", deck.text(Format::Calculix)?.as_bytes())?;
    let clock = Instant::now();
    let steps = calculix::run(program, folder.path(), "calculix", lowerings.len(), monitor)?;
    let seconds = clock.elapsed().as_secs_f64();
    let checks = curve
        .points
        .iter()
        .map(|point| {
            let theirs = displacement_at(&steps, point.force).unwrap_or(f64::NAN);
            Check::new(
                PROBLEM,
                HUB_DISPLACEMENT,
                Some(point.force),
                "mm",
                (point.displacement / MILLIMETRE, theirs / MILLIMETRE),
                reference_solver,
                (theirs / point.displacement - 1.0).abs(),
                (MODEL, Cause::Model),
            )
        })
        .collect();
    let timing = Timing {
        problem: PROBLEM.into(),
        reference_solver: reference_solver.into(),
        degrees_of_freedom: 3 * (prepared.meshes.rail.nodes.len() + prepared.meshes.wheel.nodes.len()),
        loads: lowerings.len(),
        tool_seconds: curve.seconds,
        reference_seconds: seconds,
    };
    Ok((checks, timing))
}

/// Which questions, to which programs, and where a copy goes.
#[derive(Debug, Clone, Default)]
pub struct Settings<'a> {
    /// Python with the packages of the reference; `None`: the virtual environment of the cache folder.
    pub interpreter: Option<&'a Path>,
    /// The questions to the reference.
    pub cases: &'a [Case],
    /// Whether CalculiX runs, too.
    pub calculix: bool,
    /// File that gets a copy of the record.
    pub keep: Option<&'a Path>,
    /// How much memory there is.
    pub budget: Budget,
}

impl Settings<'_> {
    fn purpose(&self) -> Purpose {
        if self.cases.contains(&Case::SecondOrder) { Purpose::SecondOrder } else { Purpose::FirstOrder }
    }
}

/// Runs the whole cross-check and writes its files, and the report again if the folder has the
/// study's other results; the record says whether all limits hold.
///
/// # Errors
/// A Python that is missing, a copy that cannot be written, and those of the stages.
pub fn crosscheck(
    study: &Study,
    folder: &OutputFolder,
    settings: &Settings<'_>,
    monitor: &dyn Monitor,
) -> Result<CrosscheckRecord> {
    let begun = begin();
    // first, so that whatever is missing is reported before anything is computed
    let keep = settings.keep.map(kept_in).transpose()?;
    let calculix = settings.calculix.then(calculix::version).transpose()?;
    let calculix_name = calculix.as_ref().map(|(_, name)| name.as_str());
    let python = Python::prepare(settings.interpreter, &python::cache_folder(), settings.purpose(), monitor)?;
    let prepared = prepare(study, settings, monitor)?;
    let exchange_folder = OutputFolder::create(&folder.file(EXCHANGE_FOLDER))?;
    prepared.exchange.write(&exchange_folder)?;
    python.run(exchange_folder.path(), monitor)?;
    let reference = ReferenceResult::read(&exchange_folder)?;
    let (mut checks, mut timings) =
        compare(&prepared.answers, prepared.meshes.contact_element(), settings.cases, &reference)?;
    if let Some((program, reference_solver)) = &calculix {
        let (more, timing) =
            calculix_checks(study, &prepared, (program, reference_solver), &exchange_folder, monitor)?;
        checks.extend(more);
        timings.push(timing);
    }
    let record = CrosscheckRecord {
        study: study.name.clone(),
        holds: checks.iter().all(|check| check.holds),
        input_hash: study.keys.study.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        begun_utc: begun.begun_utc,
        host: begun.host,
        questions: questions::questions(
            settings.cases,
            &prepared.answers,
            &reference.solver_name(),
            calculix_name,
        ),
        calculix: calculix_name.map(str::to_owned),
        reference: Provenance { package_hash: python::package_hash(), ..reference.provenance.clone() },
        meshes: questions::meshes(&prepared.exchange),
        limits: limits(&checks),
        curves: questions::tool_curves(&prepared.answers),
        checks,
        timings,
    };
    folder.write_json(CROSSCHECK, &record)?;
    if let Some((kept, name)) = keep {
        kept.write_json(&name, &record)?;
    }
    folder.write_json(DIFFERENCES, &differences(&record, &prepared, &reference))?;
    Pipeline::new(study, folder, settings.interpreter, monitor).crosscheck_pages()?;
    Ok(record)
}

/// Folder and name of the copy.
fn kept_in(path: &Path) -> Result<(OutputFolder, String)> {
    let refused = |value: String| {
        InputError::new("--keep", value, "a file in a folder that can be written", "choose another one")
    };
    let name = path.file_name().filter(|_| !path.is_dir());
    let name = name.ok_or_else(|| refused(path.display().to_string()))?.to_string_lossy().into_owned();
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = OutputFolder::create(parent).map_err(|error| match error {
        Error::Input(cause) => refused(cause.value).into(),
        other => other,
    })?;
    Ok((folder, name))
}

/// The sections of both bodies, where the reference has answered for every node.
fn differences(record: &CrosscheckRecord, prepared: &Prepared, reference: &ReferenceResult) -> Differences {
    let bodies =
        [(&prepared.meshes.rail, &prepared.answers.rail), (&prepared.meshes.wheel, &prepared.answers.wheel)];
    let sections = BODIES.iter().zip(bodies).enumerate().filter_map(|(k, (name, (mesh, answer)))| {
        let theirs = reference.displacement(k);
        let complete = theirs.len() == answer.displacement.len();
        complete.then(|| sections::section(name, mesh, &answer.displacement, theirs))
    });
    Differences {
        input_hash: record.input_hash.clone(),
        begun_utc: record.begun_utc.clone(),
        sections: sections.collect(),
    }
}
