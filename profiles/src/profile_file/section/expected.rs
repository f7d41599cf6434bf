//! What the outline of a section is expected to be, and how an error says so.

use std::ops::RangeInclusive;

use crate::profile::ProfileKind;

/// Widths and heights of sections, m: from mine rails to crane rails; of a wheel from the bore to the tip of its flange.
pub(super) fn size_of(kind: ProfileKind) -> RangeInclusive<f64> {
    match kind {
        ProfileKind::Rail => 0.04..=0.3,
        ProfileKind::Wheel => 0.1..=0.8,
    }
}

pub(super) fn said_size(kind: ProfileKind) -> String {
    let size = size_of(kind);
    format!("a section of {} to {} mm", 1e3 * size.start(), 1e3 * size.end())
}

pub(super) fn outline_of(kind: ProfileKind) -> &'static str {
    match kind {
        ProfileKind::Rail => "the closed outline of one rail section",
        ProfileKind::Wheel => "the closed outline of one wheel section, on one side of the axle",
    }
}
