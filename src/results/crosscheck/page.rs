//! The cross-validation: a chapter of the report, and a separate page for
//! whoever must trust the numbers.

mod curves;
mod histories;
mod scientific;
mod section;

use scientific::scientific;
use serde_json::{Value, json};

use crate::report::collector::{Collector, Figure};
use crate::report::html;
use crate::report::number::number;
use crate::results::crosscheck::record::{Check, CrosscheckRecord, ForcesInTime, SectionDifference};
use crate::results::verdict::tables;
use crate::rounding::with_minus_signs;
use crate::study::ResolvedKey;

/// The state of the cross-validation in the output folder.
#[derive(Debug, Clone, Copy)]
pub enum Crosscheck<'a> {
    /// Nothing.
    Absent,
    /// One of another study or of another version of the program.
    Stale,
    /// That of this study.
    Fresh(&'a CrosscheckRecord, &'a [SectionDifference]),
}

/// Everything that the separate page shows.
#[derive(Debug, Clone, Copy)]
pub struct PageData<'a> {
    /// What the study is about.
    pub description: &'a str,
    /// The study's keys.
    pub inputs: &'a [ResolvedKey],
    /// The cross-validation.
    pub record: &'a CrosscheckRecord,
    /// Where the displacements differ.
    pub sections: &'a [SectionDifference],
    /// Whether there is a report in the same folder.
    pub report: bool,
}

/// `crosscheck.html`: self-contained and printable.
pub fn page(data: &PageData<'_>) -> String {
    let mut collected = Collector::default();
    let mut common = context(data.record, data.sections, &mut collected);
    common["report"] = data.report.into();
    let limits: Vec<Value> = data
        .record
        .limits
        .iter()
        .map(|limit| {
            json!({
                "value": scientific(limit.value),
                "cause": limit.cause.name(),
                "applies_to": limit.applies_to,
                "derivation": limit.derivation,
            })
        })
        .collect();
    common["limits"] = limits.into();
    html::render(
        "crosscheck.html",
        json!({
            "c": common,
            "description": data.description,
            "every": groups(data.record.checks.iter().map(|check| (check, check.holds))),
            "inputs": tables::grouped(data.inputs),
        }),
    )
}

/// What the report's template needs for its chapter.
pub(crate) fn chapter(state: &Crosscheck<'_>, collected: &mut Collector) -> Value {
    match state {
        Crosscheck::Absent => json!({ "state": "absent" }),
        Crosscheck::Stale => json!({ "state": "stale" }),
        Crosscheck::Fresh(record, sections) => context(record, sections, collected),
    }
}

/// What chapter and page have in common.
fn context(record: &CrosscheckRecord, sections: &[SectionDifference], collected: &mut Collector) -> Value {
    let failed = record.checks.iter().filter(|check| !check.holds).count();
    let verdict = if record.holds && failed == 0 {
        format!("All limits hold ({} checks)", record.checks.len())
    } else {
        format!("{failed} of {} checks fail", record.checks.len())
    };
    json!({
        "state": "fresh",
        "verdict": verdict,
        "record": record,
        "groups": groups(record.worst().into_iter()),
        "figures": figures(record, sections, collected),
    })
}

/// The forces of a load case, and what they differ by.
fn over_time(forces: &ForcesInTime, collected: &mut Collector) -> Vec<Figure> {
    let case = &forces.case;
    vec![
        collected.add(
            "crosscheck-forces",
            histories::forces(forces),
            format!("Load case {case}: vertical (P) and lateral force (Q) of both programs over time."),
        ),
        collected.add(
            "crosscheck-force-differences",
            histories::differences(forces),
            "P and Q of the reference solver less those of the tool, and the change of each program with steps twice as long, \
             relative to the largest force of the reference solver."
                .into(),
        ),
    ]
}

/// Load curves, and what they differ by.
fn over_loads(record: &CrosscheckRecord, collected: &mut Collector) -> Vec<Figure> {
    vec![
        collected.add(
            "crosscheck-load",
            curves::load_over_displacement(record),
            "Load over hub displacement. Lines: the tool. Marks: the reference solvers.".into(),
        ),
        collected.add(
            "crosscheck-displacement",
            curves::displacement(record),
            "Hub displacement of each reference solver less that of the tool, relative to the tool, with the limits. One panel per limit.".into(),
        ),
        collected.add(
            "crosscheck-tangent",
            curves::tangent(record),
            "The same for the tangent stiffness.".into(),
        ),
    ]
}

fn figures(
    record: &CrosscheckRecord,
    sections: &[SectionDifference],
    collected: &mut Collector,
) -> Vec<Figure> {
    let mut found = match &record.in_time {
        Some(forces) => over_time(forces, collected),
        None => over_loads(record, collected),
    };
    for section in sections.iter().filter(|section| !section.cells.is_empty()) {
        let [x, y, z] = section.largest_at_mm.map(number);
        let (body, place) = match section.turned_deg {
            Some(angle) => (
                "Wheel",
                format!(
                    "Half a plane through the axle, turned by {}° from the load; y from the tape circle",
                    number(angle.round())
                ),
            ),
            None => (
                "Rail",
                format!(
                    "Section at x = {x} mm, the load at 0; y from the middle of the track, z from the top of the rail"
                ),
            ),
        };
        let caption = format!(
            "{body}: where the nodal displacements of tool and reference differ most under the same given forces. {place}. Every element with the largest difference of its corners. Circle: the largest of the whole body, {} mm at x = {x}, y = {y}, z = {z} mm, which is {} of the largest displacement, {} mm.",
            scientific(section.largest_difference_mm),
            scientific(section.largest_difference_mm / section.largest_displacement_mm),
            number(section.largest_displacement_mm),
        );
        let name = format!("crosscheck-{}", section.body);
        found.push(collected.add(&name, section::picture(section), caption));
    }
    found
}

/// Checks by problem and reference solver, in order of appearance, as text.
fn groups<'a>(checks: impl Iterator<Item = (&'a Check, bool)>) -> Vec<Value> {
    let mut found: Vec<(&str, &str, Vec<Value>)> = Vec::new();
    for (check, holds) in checks {
        let key = (check.problem.as_str(), check.reference_solver.as_str());
        let at = found
            .iter()
            .position(|(problem, reference_solver, _)| (*problem, *reference_solver) == key)
            .unwrap_or_else(|| {
                found.push((key.0, key.1, Vec::new()));
                found.len() - 1
            });
        found[at].2.push(row(check, holds));
    }
    found
        .into_iter()
        .map(|(problem, reference_solver, rows)| json!({ "problem": problem, "reference_solver": reference_solver, "rows": rows }))
        .collect()
}

fn row(check: &Check, holds: bool) -> Value {
    json!({
        "quantity": check.quantity,
        "load": check.load_kn.map_or_else(String::new, number),
        "tool": value(check.tool),
        "reference_value": value(check.reference_value),
        "unit": check.unit,
        "difference": scientific(check.difference),
        "limit": scientific(check.limit),
        "cause": check.cause.name(),
        "holds": holds,
    })
}

/// A value with enough digits to see the difference of two formulations.
fn value(value: f64) -> String {
    if !value.is_finite() {
        return "none".into();
    }
    let whole = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    with_minus_signs(&format!("{value:.*}", (5 - whole).clamp(0, 12) as usize))
}

#[cfg(test)]
mod tests;
