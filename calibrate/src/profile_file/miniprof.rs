//! MiniProf's `.ban` (rail) and `.whl` (wheel).
//!
//! A header of `key=value` lines, or of free lines in old files, then rows whose columns the key ColumnDef
//! names. `"`, `!` and `%` start comments. Lengths are in mm.

use std::fmt::Write;

use super::finding::{Action, Finding, FindingKind};
use super::text::{begins_like_a_number, decimal_mark, error_at, lines, row_numbers};
use super::{Convention, MeasuredPoint, ProfileFormat, ProfileKind, Raw, push};
use crate::error::Result;
use crate::profile::wheels::TAPE_CIRCLE_FROM_FLANGE_BACK;
use crate::units::MILLIMETRE;

/// Keys of which one is enough to recognise the format.
const KEYS: [&str; 7] =
    ["columndef", "xypoints", "mptypeno", "mpserno", "programver", "xoffset", "refpoint1"];
/// Lines in which the format is looked for.
const HEADER_LINES: usize = 200;

fn old_style(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default().trim_start_matches(['#', ' ']).to_ascii_uppercase();
    first.starts_with("MINI")
}

/// A header line as key (lower case, without blanks and dots) and value.
fn key_value(line: &str) -> Option<(String, &str)> {
    let (key, value) = line.trim_start_matches(['"', ' ', '\t']).split_once('=')?;
    let key: String =
        key.chars().filter(|c| !c.is_whitespace() && *c != '.').flat_map(char::to_lowercase).collect();
    key.starts_with(char::is_alphabetic).then_some((key, value.trim().trim_end_matches('"')))
}

pub(super) fn recognises(text: &str, ending: &str) -> bool {
    let known = |line: &str| key_value(line).is_some_and(|(key, _)| KEYS.contains(&key.as_str()));
    matches!(ending, "ban" | "whl")
        || old_style(text)
        || lines(text).take(HEADER_LINES).any(|(_, line)| known(line))
}

fn without_comment(line: &str) -> &str {
    line.split(['"', '!', '%']).next().unwrap_or_default()
}

pub(super) fn parse(name: &str, text: &str, ending: &str) -> Result<Raw> {
    let old = old_style(text);
    let rows = lines(text).map(|(n, line)| (n, without_comment(line)));
    let is_row = |row: &str| begins_like_a_number(row) && !row.contains('=');
    let mark = decimal_mark(name, rows.clone().filter(|(_, row)| is_row(row)))?;
    let mut columns = (0, 1);
    let mut announced = None;
    let mut kind = None;
    let mut in_header = true;
    let mut points = Vec::new();
    for (n, line) in lines(text) {
        let row = without_comment(line);
        if in_header {
            if let Some((key, value)) = key_value(line) {
                match key.as_str() {
                    "columndef" if !value.is_empty() => columns = columns_of(name, n, line, value)?,
                    "xypoints" => announced = value.parse::<usize>().ok().map(|count| (count, n)),
                    _ => {}
                }
                continue;
            }
            // In old files the header is free text and ends at an empty line.
            let free = old && !row.trim().is_empty();
            if free || !is_row(row) {
                let upper = line.to_ascii_uppercase();
                if n <= 2 && upper.contains("WHEEL") {
                    kind = Some(ProfileKind::Wheel);
                } else if n <= 2 && upper.contains("RAIL") {
                    kind = Some(ProfileKind::Rail);
                }
                if old && row.trim().is_empty() {
                    in_header = false;
                } else if !old && !row.trim().is_empty() {
                    let column = line.chars().take_while(|c| c.is_whitespace()).count() + 1;
                    return Err(error_at(
                        name,
                        n,
                        column,
                        row.trim(),
                        "key=value, or two columns of numbers",
                        "correct the line, or put `\"` before a comment",
                    ));
                }
                continue;
            }
            in_header = false;
        }
        if row.trim().is_empty() {
            continue;
        }
        let numbers = row_numbers(name, n, row, mark, columns.0.max(columns.1) + 1)?;
        push(name, &mut points, numbers[columns.0], numbers[columns.1], n, 1.0)?;
    }
    let mut findings = Vec::new();
    if let Some((count, line)) = announced.filter(|(count, _)| *count != points.len()) {
        let text = format!("XYPoints says {count}, the file has {}; the rows were counted", points.len());
        findings.push(Finding::new(FindingKind::Header, Action::Noted, text).on_lines(line, line));
    }
    kind = match ending {
        "ban" => Some(ProfileKind::Rail),
        "whl" => Some(ProfileKind::Wheel),
        _ => kind,
    };
    Ok(Raw {
        format: ProfileFormat::MiniProf,
        kind,
        convention: Convention::MiniProf,
        unit: Some((MILLIMETRE, 0)),
        points,
        findings,
    })
}

/// Columns of X and Y.
fn columns_of(name: &str, n: usize, line: &str, value: &str) -> Result<(usize, usize)> {
    let names: Vec<String> = value.split([',', ';']).map(|c| c.trim().to_ascii_uppercase()).collect();
    let find = |wanted: &str| names.iter().take(8).position(|c| c == wanted);
    find("X").zip(find("Y")).ok_or_else(|| {
        let column = line.chars().take_while(|c| *c != '=').count() + 2;
        error_at(name, n, column, value, "columns X and Y among the first eight", "correct ColumnDef")
    })
}

/// A MiniProf file: a rail with X towards the track centre and Y up, a wheel with X from the flange back and Y
/// towards the flange tip.
pub(super) fn write(kind: ProfileKind, points: &[MeasuredPoint], comment: &str) -> String {
    let mut out = format!(
        "Filename={comment}\nProgramName=railspring\nMPTypeNo={}\nXYPoints={}\nXOffset=0.0000\nYOffset=0.0000\n\
         ColumnDef=X,Y\n\n",
        if kind == ProfileKind::Rail { "299" } else { "201" },
        points.len()
    );
    for p in points {
        let (x, y) = match kind {
            ProfileKind::Rail => (-p.point.x, -p.point.y),
            ProfileKind::Wheel => (p.point.x + TAPE_CIRCLE_FROM_FLANGE_BACK, p.point.y),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{}\t{}", x / MILLIMETRE, y / MILLIMETRE);
    }
    out
}
