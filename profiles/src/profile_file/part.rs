//! The part of a file that is wanted, where the file has several.

use crate::field::InputField;
use crate::profile::ProfileKind;

/// The part of a file that is wanted.
pub(super) struct Part<'a> {
    pub name: Option<&'a str>,
    /// What it is called in messages.
    pub field: String,
}

pub(super) fn part_field(kind: Option<ProfileKind>) -> String {
    match kind {
        Some(ProfileKind::Rail) => format!("`{}`", InputField::RailProfilePart),
        Some(ProfileKind::Wheel) => format!("`{}`", InputField::WheelProfilePart),
        None => format!("`{}`", InputField::ProfilePart),
    }
}
