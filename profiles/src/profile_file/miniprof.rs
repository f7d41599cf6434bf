//! MiniProf's `.ban` (rail) and `.whl` (wheel).
//!
//! A header of `key=value` lines, or of free lines in old files, before or after rows whose columns the key ColumnDef
//! names. `"`, `!` and `%` start comments. Lengths are in mm, unless the columns or the rows name another unit.

use std::fmt::Write;

use super::blocks::{Blocks, heads_others};
use super::finding::{Action, Finding, FindingKind};
use super::format::ProfileFormat;
use super::measured::MeasuredPoint;
use super::part::Part;
use super::raw::{Convention, Raw};
use super::text::{
    begins_like_a_number, column_names, decimal_mark, error_at, lines, number_with_any_mark, unit_of,
};
use crate::error::Result;
use crate::profile::{ProfileKind, TAPE_CIRCLE_FROM_FLANGE_BACK};
use crate::units::MILLIMETRE;

/// Keys of which one is enough to recognise the format.
const KEYS: [&str; 7] =
    ["columndef", "xypoints", "mptypeno", "mpserno", "programver", "xoffset", "refpoint1"];
/// Keys that are understood without `=`, too: without them the points would be others.
const PLAIN_KEYS: [&str; 2] = ["columndef", "xypoints"];
/// Longest of these as they are written, characters.
const LONGEST_KEY: usize = 24;
/// Lines in which the format is looked for.
const HEADER_LINES: usize = 200;
/// Columns among which X and Y are looked for.
const MOST_COLUMNS: usize = 8;

fn old_style(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default().trim_start_matches(['#', ' ']).to_ascii_uppercase();
    first.starts_with("MINI")
}

/// A header line as key (lower case, without blanks, dots and what stands in brackets) and value.
fn key_value(line: &str) -> Option<(String, &str)> {
    let line = line.trim_start_matches(['"', '\'', ' ', '\t']);
    let normal = |key: &str| -> String {
        let key = key.split(['[', '(']).next().unwrap_or_default();
        key.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
    };
    let (key, value) = match line.split_once('=') {
        Some((key, value)) => (normal(key), value),
        None => line
            .match_indices([':', ' ', '\t', ';'])
            .take_while(|(at, _)| *at < LONGEST_KEY)
            .map(|(at, _)| (normal(&line[..at]), &line[at + 1..]))
            .find(|(key, _)| PLAIN_KEYS.contains(&key.as_str()))?,
    };
    let value = value.trim_start_matches([':', '=']).trim_matches(['"', '\'', ' ', '\t']);
    key.starts_with(char::is_alphabetic).then_some((key, value))
}

pub(super) fn recognises(text: &str, ending: &str) -> bool {
    let known = |line: &str| key_value(line).is_some_and(|(key, _)| KEYS.contains(&key.as_str()));
    matches!(ending, "ban" | "whl")
        || old_style(text)
        || lines(text).take(HEADER_LINES).any(|(_, line)| known(line))
}

/// The line without its comment; a quote around a number starts none.
fn without_comment(line: &str) -> &str {
    let mut after_quoted = 0;
    for (index, c) in line.char_indices() {
        match c {
            '!' | '%' => return &line[..index],
            '"' if index >= after_quoted => {
                let inside = line[index + 1..].split('"').next().unwrap_or_default();
                let closed = line.len() > index + 1 + inside.len();
                if !closed || number_with_any_mark(inside).is_none() {
                    return &line[..index];
                }
                after_quoted = index + inside.len() + 2;
            }
            _ => {}
        }
    }
    line
}

/// The columns of X and Y, and the unit that they are in.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Columns {
    at: (usize, usize),
    unit: Option<f64>,
}

/// Columns of the line, if it is nothing but the names of columns, X and Y among them.
fn names_columns(text: &str) -> Option<Columns> {
    let names = column_names(text);
    let bare = |name: &str| name.split(['[', '(', ' ', '_']).next().unwrap_or_default().to_ascii_uppercase();
    let find = |wanted: &str| names.iter().take(MOST_COLUMNS).position(|name| bare(name) == wanted);
    let at = find("X").zip(find("Y"))?;
    let unit = names[at.0].split(['[', '(', ' ', '_', ']', ')']).skip(1).find_map(unit_of);
    Some(Columns { at, unit })
}

/// What the header says, wherever it stands.
struct Header {
    /// Definitions of columns, with their lines.
    columns: Vec<(usize, Columns)>,
    /// What each XYPoints says, and its line.
    announced: Vec<(usize, usize)>,
    kind: Option<ProfileKind>,
    /// Last line of the free header of an old file.
    free_until: usize,
    findings: Vec<Finding>,
}

impl Header {
    fn read(name: &str, text: &str) -> Result<Self> {
        let mut header = Self {
            columns: Vec::new(),
            announced: Vec::new(),
            kind: None,
            free_until: 0,
            findings: Vec::new(),
        };
        if old_style(text) {
            let empty = |(n, line): &(usize, &str)| *n > 1 && without_comment(line).trim().is_empty();
            header.free_until = lines(text).find(empty).map_or(1, |(n, _)| n);
        }
        for (n, line) in lines(text) {
            let upper = line.to_ascii_uppercase();
            if n <= 2 && upper.contains("WHEEL") {
                header.kind = Some(ProfileKind::Wheel);
            } else if n <= 2 && upper.contains("RAIL") {
                header.kind = Some(ProfileKind::Rail);
            }
            if let Some((key, value)) = key_value(line) {
                header.entry(name, n, line, &key, value)?;
            } else if !begins_like_a_number(line)
                && let Some(columns) = names_columns(line)
            {
                header.columns.push((n, columns));
            }
        }
        Ok(header)
    }

    fn entry(&mut self, name: &str, n: usize, line: &str, key: &str, value: &str) -> Result<()> {
        match key {
            "columndef" if !value.is_empty() => {
                let columns = names_columns(value).ok_or_else(|| {
                    let column = line.chars().take_while(|c| *c != '=').count() + 2;
                    error_at(
                        name,
                        n,
                        column,
                        value,
                        "columns X and Y among the first eight",
                        "correct ColumnDef",
                    )
                })?;
                self.columns.push((n, columns));
            }
            "xypoints" => self.announced.extend(value.parse().ok().map(|count| (count, n))),
            "xoffset" | "yoffset" | "tilt" => {
                if let Some(value) = number_with_any_mark(value).filter(|value| *value != 0.0) {
                    let text = format!("{key} = {value} is not applied: the points are taken as they stand");
                    self.findings.push(Finding::new(FindingKind::Header, Action::Noted, text).on_lines(n, n));
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Columns of a row: those of the definition before it, or else of the first one after it.
    fn columns_at(&self, n: usize) -> Columns {
        let before = self.columns.iter().rev().find(|(line, _)| *line < n);
        before.or(self.columns.first()).map_or(Columns { at: (0, 1), unit: None }, |(_, columns)| *columns)
    }
}

pub(super) fn parse(name: &str, text: &str, ending: &str, part: &Part) -> Result<Raw> {
    let header = Header::read(name, text)?;
    let rows = lines(text)
        .filter(|(n, line)| *n > header.free_until && !line.contains('='))
        .map(|(n, line)| (n, without_comment(line)));
    let mark = decimal_mark(name, rows.filter(|(_, row)| begins_like_a_number(row)))?;
    let mut blocks = Blocks::new(name, mark);
    let mut unit: Option<(f64, usize)> = None;
    // A key heads points only where they follow it.
    let mut headed_by_key = false;
    for (n, line) in lines(text).filter(|(n, _)| *n > header.free_until) {
        let row = without_comment(line);
        if let Some((key, _)) = key_value(line) {
            if key == "xypoints" {
                // Behind all points of the one before it, it begins another profile.
                let before = header.announced.iter().rev().find(|(_, line)| *line < n);
                blocks.measured(before.is_some_and(|(count, _)| blocks.last_count() >= (*count).max(1)));
            } else if key.ends_with("points") || heads_others(&key) {
                blocks.head(line.split('=').next().unwrap_or(line).trim_matches(['"', ' ', '\t']));
                headed_by_key = true;
            } else if std::mem::take(&mut headed_by_key) {
                blocks.measured(false);
            } else {
                blocks.part();
            }
            continue;
        }
        let columns = header.columns_at(n);
        if blocks.line(n, row, columns.at)? {
            unit = unit.or(columns.unit.map(|unit| (unit, n)));
            continue;
        }
        let words = row.trim();
        if words.is_empty() {
            blocks.part();
        } else if let Some(title) = words.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            blocks.head(title);
            headed_by_key = false;
        } else if heads_others(words) {
            blocks.head(words.trim_end_matches([':', ' ']));
            headed_by_key = false;
        } else {
            blocks.part();
            let is_names = header.columns.iter().any(|(line, _)| *line == n);
            if !is_names {
                blocks.passed.line(n, line);
            }
        }
    }
    // Several numbers of points tell of none which one is the profile.
    let count =
        header.announced.first().filter(|(first, _)| header.announced.iter().all(|(c, _)| c == first));
    let chosen = blocks.choose(part, count.map(|(count, _)| *count))?;
    let mut findings = header.findings;
    findings.extend(chosen.findings);
    if let Some((count, line)) = header.announced.last()
        && header.announced.iter().all(|(count, _)| *count != chosen.points.len())
    {
        let text =
            format!("XYPoints says {count}, the file has {}; the rows were counted", chosen.points.len());
        findings.push(Finding::new(FindingKind::Header, Action::Noted, text).on_lines(*line, *line));
    }
    let kind = match ending {
        "ban" => Some(ProfileKind::Rail),
        "whl" => Some(ProfileKind::Wheel),
        _ => header.kind,
    };
    Ok(Raw {
        format: ProfileFormat::MiniProf,
        kind,
        convention: Convention::MiniProf,
        unit: chosen.unit.or(unit).or(Some((MILLIMETRE, 0))),
        points: chosen.points,
        findings,
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
