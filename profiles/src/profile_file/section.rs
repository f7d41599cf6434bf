//! The closed outline of a rail or a wheel in a file: lines and arcs, a drawing, or columns of points.
//!
//! Lines and arcs say how they lie; an outline of the other kinds is turned upright and moved into the frame of its profile, and every such step
//! is a finding.

mod ring;
mod frame;
mod outline;
mod divide;
mod rail;
mod wheel;

use std::ops::RangeInclusive;

use self::outline::Outline;
use super::finding::Finding;
use super::{ProfileFormat, ProfileKind};
use crate::error::{Error, InputError, Result};
use crate::profile::{ProfileCurve, Segment, Sketch};
use crate::units::MILLIMETRE;

/// Step on arcs where an outline is looked at by points, m.
const STEP: f64 = 0.2 * MILLIMETRE;

/// The closed section of a rail or a wheel from a file, in the profile frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedSection {
    /// Rail or wheel.
    pub kind: ProfileKind,
    /// Format of the file.
    pub format: ProfileFormat,
    /// Points, or lines and arcs, that the file gives.
    pub count: usize,
    /// The running surface, towards the field side.
    pub running: ProfileCurve,
    /// The rest of the outline, from the end of `running` back to its start.
    pub rest: Vec<Segment>,
    /// What was found and done.
    pub findings: Vec<Finding>,
}

/// Reads the closed section of a rail from the content of a file: top at z = 0, the middle of the foot at y = 0. `name` is used in messages, and its
/// ending tells the format where the content does not.
///
/// # Errors
/// [`InputError`] with the line of the file for an outline that is open, crosses itself or steps back, that has no head or
/// not the size of a rail, or of which it is not certain which side is up.
pub fn parse_rail_section(name: &str, bytes: &[u8]) -> Result<ClosedSection> {
    sketch_section(name, bytes, ProfileKind::Rail, None).1
}

/// Reads the closed section of a wheel from the content of a file: tape circle at the origin, the bore at the least z. `name` is used in messages, and
/// its ending tells the format where the content does not. `tape_circle` is the distance of the tape circle from the flange back, m, of drawings and
/// columns; 70 mm if there is none. A table of lines and arcs says itself where its tape circle is.
///
/// # Errors
/// [`InputError`] with the line of the file for an outline that is open, crosses itself or steps back, that has no flange, tread or bore
/// or not the size of a wheel, or of which it is not certain which end is the bore.
pub fn parse_wheel_section(name: &str, bytes: &[u8], tape_circle: Option<f64>) -> Result<ClosedSection> {
    sketch_section(name, bytes, ProfileKind::Wheel, tape_circle).1
}

/// The outline of the file of a section as it is drawn, with the section itself or what is wrong with it, as [`parse_rail_section`] and
/// [`parse_wheel_section`] say; `tape_circle` is that of a wheel.
pub fn sketch_section(
    name: &str,
    bytes: &[u8],
    kind: ProfileKind,
    tape_circle: Option<f64>,
) -> (Sketch, Result<ClosedSection>) {
    let mut sketch = Sketch::default();
    let outline = Outline::read(name, bytes, kind, &mut sketch);
    let section = outline.and_then(|outline| match kind {
        ProfileKind::Rail => rail::section(name, outline),
        ProfileKind::Wheel => wheel::section(name, outline, tape_circle),
    });
    (sketch, section)
}

/// Widths and heights of sections, m: from mine rails to crane rails; of a wheel from the bore to the tip of its flange.
fn size_of(kind: ProfileKind) -> RangeInclusive<f64> {
    match kind {
        ProfileKind::Rail => 0.04..=0.3,
        ProfileKind::Wheel => 0.1..=0.8,
    }
}

fn said_size(kind: ProfileKind) -> String {
    let size = size_of(kind);
    format!("a section of {} to {} mm", 1e3 * size.start(), 1e3 * size.end())
}

fn outline_of(kind: ProfileKind) -> &'static str {
    match kind {
        ProfileKind::Rail => "the closed outline of one rail section",
        ProfileKind::Wheel => "the closed outline of one wheel section, on one side of the axle",
    }
}

fn at_line(name: &str, line: usize, value: &str, expected: impl Into<String>, remedy: &str) -> Error {
    InputError::new(format!("{name}:{line}"), value, expected, remedy).into()
}

#[cfg(test)]
mod tests;
