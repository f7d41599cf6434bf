//! Rows of a file before they are turned into the frame of the profile.

use super::finding::Finding;
use super::format::ProfileFormat;
use super::measured::MeasuredPoint;
use crate::profile::ProfileKind;

/// What the axes of a file are known to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Convention {
    /// Stated by the file: nothing is turned over.
    Stated,
    /// MiniProf's: a rail's y counts towards the track centre, z upwards; a wheel's y from the flange back.
    MiniProf,
    /// Unknown: y to the field side is assumed, the rest inferred from the shape.
    Free,
}

/// Rows of a file as they stand there, or as its header says.
pub(super) struct Raw {
    pub format: ProfileFormat,
    /// What the file itself says.
    pub kind: Option<ProfileKind>,
    pub convention: Convention,
    /// Length of the unit, m, and the line that says so (0: the format's own unit).
    pub unit: Option<(f64, usize)>,
    pub points: Vec<MeasuredPoint>,
    pub findings: Vec<Finding>,
}
