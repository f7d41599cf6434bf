//! Tables of profiles: rows with comments between them.

use crate::error::InputError;

/// The error of a value on a line of a table.
pub(super) fn at(
    name: &str,
    line: usize,
    value: impl ToString,
    expected: &str,
    remedy: &str,
) -> crate::error::Error {
    InputError::new(format!("{name}:{line}"), value, expected, remedy).into()
}

/// Lines that are neither empty nor comments, with their numbers.
pub(super) fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}
