//! Two or three columns of text or CSV.
//!
//! `#`, `!`, `%`, `"`, `*` and `//` start comments. Lines before the first row may name the columns and the unit
//! ("y [mm]", "z_m") and say whether the profile is a wheel or a rail.

use std::fmt::Write;

use super::finding::{Action, Finding, FindingKind};
use super::text::{begins_like_a_number, decimal_mark, error_at, fields, lines, number, row_numbers};
use super::{Convention, MeasuredPoint, ProfileFormat, ProfileKind, Raw, push};
use crate::error::Result;
use crate::units::MILLIMETRE;

/// Lines before the first row that are taken for a heading.
const HEADING_LINES: usize = 200;

fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    line.is_empty() || line.starts_with(['#', '!', '%', '*']) || line.starts_with("//") || {
        // A quote starts a comment too, unless it encloses a number.
        line.starts_with('"') && !begins_like_a_number(line)
    }
}

fn without_comment(line: &str) -> &str {
    line.split(['#', '!', '%']).next().unwrap_or_default()
}

/// What the lines before the first row say.
#[derive(Default)]
struct Heading {
    kind: Option<ProfileKind>,
    unit: Option<(f64, usize)>,
    /// Columns of y and z.
    columns: Option<(usize, usize)>,
}

impl Heading {
    fn note(&mut self, n: usize, line: &str) {
        let lower = line.to_lowercase();
        let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).collect();
        let says = |word: &str| words.contains(&word);
        match (says("rail"), says("wheel")) {
            (true, false) => self.kind = Some(ProfileKind::Rail),
            (false, true) => self.kind = Some(ProfileKind::Wheel),
            _ => {}
        }
        if says("mm") {
            self.unit = Some((MILLIMETRE, n));
        } else if ["[m]", "(m)", "_m,", "_m;", "_m\t", "_m "].iter().any(|unit| lower.contains(unit))
            || lower.trim_end().ends_with("_m")
        {
            self.unit = Some((1.0, n));
        }
    }

    /// Columns from a line that names them, such as `y_mm,z_mm`, `s; y [mm]; z [mm]` or `x y`.
    fn note_columns(&mut self, line: &str) {
        let marks = [';', ',', '\t'];
        let heads: Vec<&str> = if line.contains(marks) {
            line.trim().split(marks).collect()
        } else {
            line.split_whitespace().filter(|word| !word.starts_with(['[', '('])).collect()
        };
        let names: Vec<String> = heads
            .iter()
            .map(|head| head.trim_matches([' ', '"']).to_lowercase())
            .map(|head| head.chars().take_while(|c| c.is_alphanumeric()).collect())
            .collect();
        let find = |wanted: &str| names.iter().take(8).position(|name| name == wanted);
        self.columns = find("y").zip(find("z")).or_else(|| find("x").zip(find("y"))).or(self.columns);
    }
}

pub(super) fn parse(name: &str, text: &str, ending: &str) -> Result<Raw> {
    let rows = lines(text).filter(|(_, line)| !is_comment(line)).map(|(n, line)| (n, without_comment(line)));
    let numeric = rows.clone().filter(|(_, row)| begins_like_a_number(row));
    let mark = decimal_mark(name, numeric.clone())?;
    let mut findings = Vec::new();
    let mut heading = Heading::default();
    let first_row = numeric.clone().next().map(|(n, _)| n).ok_or_else(|| {
        error_at(
            name,
            1,
            1,
            text.lines().next().unwrap_or_default(),
            "rows of numbers",
            "give y and z in columns",
        )
    })?;
    if first_row > HEADING_LINES {
        let shown = text.lines().next().unwrap_or_default();
        let expected = format!("numbers within the first {HEADING_LINES} lines");
        return Err(error_at(
            name,
            1,
            1,
            shown,
            expected,
            "shorten the heading, or put `#` before its lines",
        ));
    }
    for (n, line) in lines(text).take_while(|(n, _)| *n < first_row) {
        refuse_other_formats(name, n, line)?;
        heading.note(n, line);
        if !is_comment(line) {
            heading.note_columns(line);
        }
    }
    let first_fields = numeric.clone().next().map(|(_, row)| fields(row, mark)).unwrap_or_default();
    let by_marks = numeric.clone().next().is_some_and(|(_, row)| row.contains([',', ';']));
    let format = if ending == "csv" || by_marks { ProfileFormat::Csv } else { ProfileFormat::Text };
    let (y, z) = match heading.columns {
        Some(columns) => columns,
        None if first_fields.len() < 3 => (0, 1),
        None => {
            let samples: Vec<Vec<f64>> = numeric
                .clone()
                .take(100)
                .map(|(_, row)| fields(row, mark).iter().filter_map(|f| number(f.text, mark)).collect())
                .collect();
            let (columns, why) = guess_columns(&samples);
            findings.push(
                Finding::new(
                    FindingKind::Columns,
                    Action::Noted,
                    format!("columns {} and {} are y and z: {why}", columns.0 + 1, columns.1 + 1),
                )
                .on_lines(first_row, first_row),
            );
            columns
        }
    };
    let mut points = Vec::new();
    for (n, row) in rows.filter(|(n, row)| *n >= first_row && !row.trim().is_empty()) {
        let numbers = row_numbers(name, n, row, mark, y.max(z) + 1)?;
        push(name, &mut points, numbers[y], numbers[z], n, 1.0)?;
    }
    let kind = heading.kind.or(match ending {
        "prr" | "ban" => Some(ProfileKind::Rail),
        "prw" | "whl" => Some(ProfileKind::Wheel),
        _ => None,
    });
    Ok(Raw { format, kind, convention: Convention::Free, unit: heading.unit, points, findings })
}

/// Formats of other programs that would be misread as columns.
fn refuse_other_formats(name: &str, n: usize, line: &str) -> Result<()> {
    let upper = line.trim().to_ascii_uppercase();
    let other = match upper.as_str() {
        "WHEELPROFILE" | "RAILPROFILE" => "Vampire",
        "[FILEINFO]" => "MiniProf .mpt",
        _ => return Ok(()),
    };
    Err(error_at(
        name,
        n,
        1,
        line.trim(),
        "a Simpack, MiniProf, text or CSV file",
        format!("{other} files are not read: export the profile as two columns"),
    ))
}

/// Columns of y and z among three or more, and why.
fn guess_columns(rows: &[Vec<f64>]) -> ((usize, usize), &'static str) {
    let column = |k: usize| rows.iter().filter_map(|row| row.get(k).copied()).collect::<Vec<f64>>();
    let first = column(0);
    let constant = |values: &[f64]| values.windows(2).all(|pair| pair[0] == pair[1]);
    let counts = |values: &[f64]| values.windows(2).all(|pair| pair[1] - pair[0] == 1.0);
    if rows.len() > 2 && counts(&first) {
        ((1, 2), "the first one counts the points")
    } else if rows.len() > 2 && constant(&first) {
        ((1, 2), "the first one is constant")
    } else {
        ((0, 1), "they come first")
    }
}

/// Two columns in mm with a heading that says what they are.
pub(super) fn write(kind: ProfileKind, points: &[MeasuredPoint], comment: &str, separator: &str) -> String {
    let mut out =
        format!("# {comment}\n# {} profile, y to the field side, z down\ny_mm{separator}z_mm\n", kind.name());
    for p in points {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{}{separator}{}", p.point.x / MILLIMETRE, p.point.y / MILLIMETRE);
    }
    out
}
