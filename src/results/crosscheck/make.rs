//! Asks the reference solvers, and compares.

use std::time::Instant;

use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};

use crate::engine::measure::begin;
use crate::engine::output::OutputFolder;
use crate::python;
use crate::results::bodies::estimate::Resources;
use crate::results::crosscheck::answers::Answers;
use crate::results::crosscheck::calculix::{self, displacement_at};
use crate::results::crosscheck::compare::{MODEL, MODEL_ELEMENT, ReferenceResult, compare, limits};
use crate::results::crosscheck::deck::{Deck, Format};
use crate::results::crosscheck::exchange::{BODIES, Case};
use crate::results::crosscheck::input::CrosscheckInput;
use crate::results::crosscheck::prepared::{Prepared, prepare};
use crate::results::crosscheck::record::{
    Cause, Check, CrosscheckRecord, Differences, HUB_DISPLACEMENT, LATERAL_FLEXIBILITY, Provenance, Timing,
};
use crate::results::crosscheck::solvers::Solvers;
use crate::results::crosscheck::{questions, sections};

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
        in_time: None,
        content_blake3: String::new(),
    };
    let differences = differences(&record, &prepared, &reference);
    Ok((record, differences))
}

/// Lets CalculiX solve the frictionless problem with the study's element, and each body alone under lateral forces.
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
    let contact = curve.points.iter().map(|point| {
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
    });
    let mut checks: Vec<Check> = contact.collect();
    checks.extend(lateral_checks(&deck, &prepared.answers, (program, reference_solver), folder, monitor)?);
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

/// The lateral flexibility of each body by CalculiX.
fn lateral_checks(
    deck: &Deck<'_>,
    answers: &Answers,
    (program, reference_solver): (&str, &str),
    folder: &OutputFolder,
    monitor: &dyn Monitor,
) -> Result<[Check; 2]> {
    const FILE: &str = "calculix-lateral";
    let bodies = [&answers.rail, &answers.wheel];
    let text = deck.lateral_text(bodies.map(|body| body.lateral.as_slice()));
    folder.write(&format!("{FILE}.inp"), text.as_bytes())?;
    let moved = calculix::displacements(program, folder.path(), FILE, monitor)?;
    let offsets = [0, deck.meshes.rail.nodes.len()];
    Ok([0, 1].map(|k| {
        let forces = bodies[k].lateral.iter();
        // a node without an answer makes the whole none
        let lateral = |node: usize| moved.get(&(node + offsets[k] + 1)).map_or(f64::NAN, |u| u.y);
        let theirs: f64 = forces.map(|&(node, force)| force * lateral(node)).sum();
        let own = bodies[k].lateral_flexibility;
        Check::new(
            &format!("{}, lateral forces", BODIES[k]),
            LATERAL_FLEXIBILITY,
            None,
            "mm/kN",
            (own * KILONEWTON / MILLIMETRE, theirs * KILONEWTON / MILLIMETRE),
            reference_solver,
            (theirs / own - 1.0).abs(),
            (MODEL_ELEMENT, Cause::Model),
        )
    }))
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
        content_blake3: String::new(),
    }
}
