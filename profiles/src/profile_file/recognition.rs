//! The format of a file by its content and its ending.

use std::path::Path;

use super::format::ProfileFormat;
use super::{dxf, miniprof, simpack, text};
use crate::profile::lines_and_arcs;

/// The format that headings or the ending of the file's name show; none for what can only be columns.
pub(super) fn recognised(text: &str, ending: &str) -> Option<ProfileFormat> {
    if lines_and_arcs::recognises(text) {
        Some(ProfileFormat::LinesAndArcs)
    } else if dxf::recognises(text, ending) {
        Some(ProfileFormat::Dxf)
    } else if simpack::recognises(text, ending) {
        Some(ProfileFormat::Simpack)
    } else if miniprof::recognises(text, ending) {
        Some(ProfileFormat::MiniProf)
    } else {
        None
    }
}

/// The format of a profile file, if the content, or in some cases the ending of `name`, shows that it is one: headings
/// of Simpack or MiniProf, or nearly nothing but rows of numbers.
pub fn format_of(name: &str, bytes: &[u8]) -> Option<ProfileFormat> {
    /// Lines that are looked at.
    const MOST_LINES: usize = 2000;
    /// Share of rows of numbers that makes a file one of columns.
    const MOST: f64 = 0.8;
    let text = text::decode(name, bytes).ok()?;
    let ending = Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if toml_section(&text).is_some() {
        return None;
    }
    let recognised = recognised(&text, &ending);
    if recognised.is_some() {
        return recognised;
    }
    let filled =
        || text::lines(&text).map(|(_, line)| line).filter(|line| !line.trim().is_empty()).take(MOST_LINES);
    let rows = filled().filter(|line| text::begins_like_a_number(line) && !line.contains('=')).count();
    if rows < 4 || (rows as f64) < MOST * filled().count() as f64 {
        return None;
    }
    let separated = filled().any(|line| line.contains([',', ';']));
    Some(if separated { ProfileFormat::Csv } else { ProfileFormat::Text })
}

/// The first heading of a TOML file, `[word]` on a line, with its line; `None` for what is no TOML file.
pub(super) fn toml_section(text: &str) -> Option<(usize, &str)> {
    /// Lines that are looked at.
    const MOST_LINES: usize = 2000;
    let word =
        |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || "_-.".contains(c));
    let lines = || text::lines(text).map(|(n, line)| (n, line.trim())).take(MOST_LINES);
    let heading = |line: &str| {
        line.strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(']'))
            .is_some_and(|name| word(name) && name.starts_with(|c: char| c.is_ascii_alphabetic()))
    };
    let assignment = |line: &str| line.split_once(" = ").is_some_and(|(key, _)| word(key.trim()));
    lines().any(|(_, line)| assignment(line)).then(|| lines().find(|(_, line)| heading(line))).flatten()
}
