//! The closed section of a file.

use crate::profile::{ProfileCurve, ProfileKind, Segment};
use crate::profile_file::finding::Finding;
use crate::profile_file::format::ProfileFormat;

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
