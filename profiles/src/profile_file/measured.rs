//! The points of a profile as its file gives them.

use nalgebra::Point2;

use super::finding::Finding;
use super::format::ProfileFormat;
use super::text::error_on;
use crate::error::Result;
use crate::profile::ProfileKind;
use crate::profile::lines_and_arcs::LinesAndArcs;

/// Most points of a profile that are read.
const MOST_POINTS: usize = 5_000_000;

/// A point of a profile with the place it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// Position in the profile frame, m.
    pub point: Point2<f64>,
    /// Line of the file, counted from one.
    pub line: usize,
    /// Weight in smoothing, 1 unless the file gives another.
    pub weight: f64,
}

/// A profile as its file gives it, in the profile frame: y to the field side, z down, in order of increasing y.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredProfile {
    /// Name of the file.
    pub name: String,
    /// Format of the file.
    pub format: ProfileFormat,
    /// Wheel or rail.
    pub kind: ProfileKind,
    /// The points; a wheel's run from the flange to the field side, a rail's from the gauge to the field side.
    pub points: Vec<MeasuredPoint>,
    /// What the reader found and did.
    pub findings: Vec<Finding>,
    /// The lines and arcs of a file of that format, of which `points` are samples.
    pub drawn: Option<LinesAndArcs>,
    /// Whether a groove beside the head, which was set aside, told which side of a rail is that of the gauge.
    pub side_by_groove: bool,
}

/// Adds a point.
///
/// # Errors
/// More points than a profile can have.
pub(super) fn push(
    name: &str,
    points: &mut Vec<MeasuredPoint>,
    y: f64,
    z: f64,
    line: usize,
    weight: f64,
) -> Result<()> {
    if points.len() >= MOST_POINTS {
        return Err(error_on(
            name,
            line,
            "",
            format!("at most {MOST_POINTS} points"),
            "give a single profile, thinned out",
        ));
    }
    points.push(MeasuredPoint { point: Point2::new(y, z), line, weight });
    Ok(())
}
