//! Cross-validation: independent programs repeat what the tool computed.
//!
//! * [`exchange`]: the questions, as files without the tool's formulations;
//! * [`deck`] and [`calculix`]: the same problem as a deck for CalculiX or Abaqus, and running it;
//! * [`mod@compare`]: answers against answers, with limits and their causes;
//! * [`questions`]: the questions in words and numbers;
//! * [`mod@sections`]: where on the bodies the answers differ.

pub mod record;
pub mod input;
pub mod answers;
pub mod calculix;
pub mod exchange;
pub mod compare;
pub mod deck;
pub mod questions;
pub mod sections;
pub mod stage;
pub mod page;

use std::time::Instant;

use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::MILLIMETRE;

use crate::engine::measure::begin;
use crate::engine::output::OutputFolder;
use crate::python::{self, Purpose, Python};
use crate::results::bodies::estimate::{self, Resources, Work};
use crate::results::bodies::geometry::{self, Geometry};
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::zones;
use crate::results::crosscheck::answers::Answers;
use crate::results::crosscheck::calculix::displacement_at;
use crate::results::crosscheck::compare::{MODEL, ReferenceResult, compare, limits};
use crate::results::crosscheck::deck::{Deck, Format};
use crate::results::crosscheck::exchange::{BODIES, Case, Exchange};
use crate::results::crosscheck::input::CrosscheckInput;
use crate::results::crosscheck::record::{
    Cause, Check, CrosscheckRecord, Differences, HUB_DISPLACEMENT, Provenance, Timing,
};
use crate::study::Statics;

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

/// Computes the tool's answers and collects the questions.
///
/// Elements of second order are on finer meshes; a mesh from a file stays as it is.
///
/// # Errors
/// Those of meshing and calibration, and sizes that the machine cannot hold.
pub fn prepare(input: &CrosscheckInput<'_>, cases: &[Case], resources: &Resources<'_>) -> Result<Prepared> {
    let statics = input.statics();
    let geometry = geometry::geometry(statics)?;
    let (options, work) = (zones::mesh_options(statics, &geometry), Work::of_crosscheck(purpose(cases)));
    let (meshes, _) = estimate::meshes(&input.solids(), &geometry, options, &work, resources)?;
    let answers = answers::answers(statics, &geometry, &meshes, resources.monitor)?;
    let fine = if cases.contains(&Case::SecondOrder) {
        let mut finer = statics.mesh.clone();
        finer.contact_element *= FINER;
        finer.contact_element_along *= FINER;
        Some(zones::remeshed(Statics { mesh: &finer, ..statics }, &geometry, &meshes)?)
    } else {
        None
    };
    let exchange = Exchange::new(input, &geometry, &meshes, fine.as_ref(), &answers, cases.to_vec());
    Ok(Prepared { geometry, meshes, answers, exchange })
}

/// Writes a deck of the study's problem into `folder`: its own element and friction, a step for every
/// wanted load; the name of the file.
///
/// # Errors
/// Those of meshing and calibration, sizes that the machine cannot hold, and a folder that cannot be written.
pub fn write_deck(
    input: &CrosscheckInput<'_>,
    format: Format,
    folder: &OutputFolder,
    resources: &Resources<'_>,
) -> Result<String> {
    let statics = input.statics();
    let geometry = geometry::geometry(statics)?;
    let (options, work) =
        (zones::mesh_options(statics, &geometry), Work { calibrate: true, ..Work::default() });
    let (meshes, _) = estimate::meshes(&input.solids(), &geometry, options, &work, resources)?;
    let curve = answers::faceted(statics, &geometry, &meshes, resources.monitor)?;
    let lowerings: Vec<f64> = curve.points.iter().map(|p| p.displacement).collect();
    let deck = Deck {
        input,
        geometry: &geometry,
        meshes: &meshes,
        friction: statics.contact.friction,
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
    input: &CrosscheckInput<'_>,
    prepared: &Prepared,
    (program, reference_solver): (&str, &str),
    folder: &OutputFolder,
    monitor: &dyn Monitor,
) -> Result<(Vec<Check>, Timing)> {
    const PROBLEM: &str = "contact without friction, faceted surfaces";
    let curve = &prepared.answers.faceted;
    let lowerings: Vec<f64> = curve.points.iter().map(|p| p.displacement).collect();
    let deck = Deck {
        input,
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

fn purpose(cases: &[Case]) -> Purpose {
    if cases.contains(&Case::SecondOrder) { Purpose::SecondOrder } else { Purpose::FirstOrder }
}

/// The reference solvers, found and able to run.
pub struct Solvers {
    python: Python,
    /// Program and name of CalculiX, if it is to run, too.
    calculix: Option<(&'static str, String)>,
}

impl Solvers {
    /// Finds the programs for some questions, with or without CalculiX.
    ///
    /// # Errors
    /// [`railspring_profiles::error::InputError`] that says which program is missing and how to get it.
    pub fn find(cases: &[Case], calculix: bool, resources: &Resources<'_>) -> Result<Self> {
        let calculix = calculix.then(calculix::version).transpose()?;
        let cache = python::cache_folder();
        let python = Python::prepare(resources.interpreter, &cache, purpose(cases), resources.monitor)?;
        Ok(Self { python, calculix })
    }

    /// What an answer of theirs depends on besides the questions: the versions of all programs.
    pub fn versions(&self) -> (String, &str, Option<&str>) {
        (
            python::package_hash(),
            self.python.versions(),
            self.calculix.as_ref().map(|(_, name)| name.as_str()),
        )
    }
}

/// Asks the reference solvers, and compares. Questions and answers are exchanged in `folder`.
///
/// # Errors
/// Those of the stages and of the programs.
pub fn crosscheck(
    input: &CrosscheckInput<'_>,
    folder: &OutputFolder,
    cases: &[Case],
    solvers: &Solvers,
    resources: &Resources<'_>,
) -> Result<(CrosscheckRecord, Differences)> {
    let begun = begin();
    let monitor = resources.monitor;
    let prepared = prepare(input, cases, resources)?;
    prepared.exchange.write(folder)?;
    solvers.python.run(folder.path(), monitor)?;
    let reference = ReferenceResult::read(folder)?;
    let (mut checks, mut timings) =
        compare(&prepared.answers, prepared.meshes.contact_element(), cases, &reference)?;
    if let Some((program, reference_solver)) = &solvers.calculix {
        let (more, timing) = calculix_checks(input, &prepared, (program, reference_solver), folder, monitor)?;
        checks.extend(more);
        timings.push(timing);
    }
    let calculix_name = solvers.calculix.as_ref().map(|(_, name)| name.as_str());
    let record = CrosscheckRecord {
        study: input.name().into(),
        holds: checks.iter().all(|check| check.holds),
        input_hash: input.key(),
        version: env!("CARGO_PKG_VERSION").into(),
        begun_utc: begun.begun_utc,
        host: begun.host,
        questions: questions::questions(cases, &prepared.answers, &reference.solver_name(), calculix_name),
        calculix: calculix_name.map(str::to_owned),
        reference: Provenance { package_hash: python::package_hash(), ..reference.provenance.clone() },
        meshes: questions::meshes(&prepared.exchange),
        limits: limits(&checks),
        curves: questions::tool_curves(&prepared.answers),
        checks,
        timings,
    };
    let differences = differences(&record, &prepared, &reference);
    Ok((record, differences))
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
