//! Lines and arcs as a profile file.

use super::finding::{Action, Finding, FindingKind, Findings};
use super::format::ProfileFormat;
use super::measured::{MeasuredPoint, MeasuredProfile};
use super::options::ReadOptions;
use super::part::part_field;
use crate::error::{InputError, Result};
use crate::profile::Sketch;
use crate::profile::lines_and_arcs::{LinesAndArcs, Overrides, parse_drawn};
use crate::units::MILLIMETRE;

/// A turn at a joint from here on is a corner, degrees: what a drawing in 0.001 mm leaves of a tangent is less on lines and arcs from 1 mm on.
const CORNER: f64 = 0.06;
/// A gap from here on was worth closing, m: more than the digits of a file.
const WORTH_CLOSING: f64 = 1e-5 * MILLIMETRE;

/// The profile of a table; its line as it is drawn, and its steps, are put into `sketch`.
pub(super) fn read(
    name: &str,
    text: &str,
    options: &ReadOptions,
    sketch: &mut Sketch,
) -> Result<MeasuredProfile> {
    if let Some(part) = &options.part {
        return InputError::refuse(
            name,
            format!("the part {part:?}"),
            "no part: a table of lines and arcs is one profile",
            format!("leave {} out", part_field(options.kind)),
        );
    }
    let overrides = Overrides { unit: options.unit, mirrored: options.mirror_y == Some(true) };
    let drawn = parse_drawn(name, text, &overrides, sketch)?;
    if let Some(kind) = options.kind.filter(|kind| *kind != drawn.kind) {
        return InputError::refuse(
            name,
            format!("lines and arcs of a {}", drawn.kind.name()),
            format!("those of a {}", kind.name()),
            "give another file, or correct `# profile:` in it",
        );
    }
    let points = drawn.points().into_iter().map(|(point, line)| MeasuredPoint { point, line, weight: 1.0 });
    Ok(MeasuredProfile {
        name: name.to_owned(),
        format: ProfileFormat::LinesAndArcs,
        kind: drawn.kind,
        points: points.collect(),
        findings: joints(&drawn),
        drawn: Some(drawn),
        side_by_groove: false,
    })
}

/// Gaps that were closed, and corners.
fn joints(drawn: &LinesAndArcs) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut gaps = Findings::new(&mut findings, FindingKind::Gap);
    for joint in drawn.joints.iter().filter(|joint| joint.gap > WORTH_CLOSING) {
        let value = (joint.gap / (1e-3 * MILLIMETRE), "\u{b5}m");
        gaps.add(joint.lines, value, Action::Repaired, "ends that do not quite meet: both moved half of it");
    }
    drop(gaps);
    let mut corners = Findings::new(&mut findings, FindingKind::Kink);
    for joint in drawn.joints.iter().filter(|joint| joint.turn.to_degrees().abs() > CORNER) {
        let value = (joint.turn.to_degrees(), "degrees");
        corners.add(joint.lines, value, Action::Noted, "a corner between two lines or arcs: kept as one");
    }
    drop(corners);
    findings
}
