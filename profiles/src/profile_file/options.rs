//! What the caller knows about a profile file.

use crate::profile::{ProfileKind, TAPE_CIRCLE_FROM_FLANGE_BACK};

/// What the caller knows about a file; the reader determines what is `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Wheel or rail.
    pub kind: Option<ProfileKind>,
    /// Length of the file's unit, m; replaces what the file says.
    pub unit: Option<f64>,
    /// Whether y counts towards the track centre in the file, as in that of a left rail or wheel. What the header of
    /// a Simpack file says comes first: `true` turns over what it leaves.
    pub mirror_y: Option<bool>,
    /// Whether z counts upwards in the file; not for Simpack files, whose header says so.
    pub mirror_z: Option<bool>,
    /// Name or number of the part of the file that is the profile, where a file has several: a slice, a layer of a
    /// drawing, a block of points.
    pub part: Option<String>,
    /// Distance of a wheel's tape circle from its flange back, m, for files that count y from there; `None` is 70 mm.
    pub tape_circle: Option<f64>,
}

impl ReadOptions {
    /// Distance of a wheel's tape circle from its flange back, m.
    pub(super) fn tape_circle_distance(&self) -> f64 {
        self.tape_circle.unwrap_or(TAPE_CIRCLE_FROM_FLANGE_BACK)
    }
}
