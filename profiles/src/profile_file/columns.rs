//! Two or more columns of text or CSV.
//!
//! `#`, `!`, `%`, `"`, `*` and `//` start comments; what begins like no number is none of the rows, whatever it is. Lines
//! before the first row may name the columns and the unit ("y [mm]", "z_m") and say whether the profile is a wheel or a
//! rail.

use std::fmt::Write;

use super::blocks::{Blocks, heads_others};
use super::finding::{Action, Finding, FindingKind};
use super::format::ProfileFormat;
use super::measured::MeasuredPoint;
use super::part::Part;
use super::raw::{Convention, Raw};
use super::rows::{Row, row};
use super::several::{chosen_pair, pairs, stations};
use super::text::{
    DecimalMark, begins_like_a_number, column_names, decimal_mark, error_on, fields, lines, number, unit_of,
    without_thousands,
};
use crate::error::Result;
use crate::profile::ProfileKind;
use crate::units::MILLIMETRE;

/// Lines before the first row that are taken for a heading.
const HEADING_LINES: usize = 200;
/// Columns among which y and z are looked for.
const MOST_COLUMNS: usize = 8;
/// Signs and blanks before a comment.
const COMMENT_SIGNS: [char; 8] = ['#', '!', '%', '*', '/', '"', ' ', '\t'];
/// What y and z are called, in pairs.
const NAMES: [(&str, &str); 6] = [
    ("y", "z"),
    ("x", "y"),
    ("x", "z"),
    ("lateral", "vertical"),
    ("lat", "vert"),
    ("horizontal", "vertical"),
];

fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    line.is_empty() || line.starts_with(['#', '!', '%', '*']) || line.starts_with("//") || {
        // A quote starts a comment too, unless it encloses a number or the name of a column.
        line.starts_with('"') && line.matches('"').count() % 2 == 1 && !begins_like_a_number(line)
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
    /// Names of the columns and their line.
    names: Option<(Vec<String>, usize)>,
}

/// Names of a column that may hold the place of a section along the track.
const STATIONS: [&str; 14] = [
    "x", "y", "z", "s", "station", "chainage", "section", "scan", "profile", "slice", "km", "mileage",
    "distance", "position",
];

/// Columns of y and z.
#[derive(Default)]
struct Columns {
    at: (usize, usize),
    unit: Option<(f64, usize)>,
    finding: Option<Finding>,
    /// Whether they are one of several pairs, which the part of the file named.
    chosen: bool,
    /// The column that tells several sections apart, its name, and its values.
    station: Option<(usize, String, Vec<f64>)>,
}

impl Heading {
    /// Takes what a line says; whether that is anything.
    fn note(&mut self, n: usize, line: &str) -> bool {
        let lower = line.to_lowercase();
        let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).collect();
        let says = |word: &str| words.contains(&word);
        let kind = match (says("rail"), says("wheel")) {
            (true, false) => Some(ProfileKind::Rail),
            (false, true) => Some(ProfileKind::Wheel),
            _ => None,
        };
        let unit = ["mm", "inch", "inches"].into_iter().find(|word| says(word)).and_then(unit_of);
        let unit = unit.or_else(|| marked_unit(&lower));
        self.kind = kind.or(self.kind);
        self.unit = unit.map(|unit| (unit, n)).or(self.unit);
        kind.is_some() || unit.is_some()
    }

    /// Takes the names of columns, such as `y_mm,z_mm`, `s; y [mm]; z [mm]` or `x y`; whether the line has them.
    fn note_columns(&mut self, n: usize, line: &str) -> bool {
        let heads: Vec<String> = column_names(line.trim()).iter().map(|head| head.to_lowercase()).collect();
        let found = NAMES.iter().any(|(y, z)| {
            position(&heads, y).is_some() && position(&heads, z).is_some() || pairs(&heads, [y, z]).len() > 1
        });
        if found {
            self.names = Some((heads, n));
        }
        found
    }

    /// Columns by their names; `rows` are all rows.
    fn columns(&self, rows: &[Vec<f64>], name: &str, part: &Part) -> Result<Option<Columns>> {
        let Some((heads, line)) = &self.names else { return Ok(None) };
        for (y, z) in NAMES {
            if let Some((pair, finding)) = chosen_pair(name, (heads, *line), (y, z), part)? {
                let unit = self.unit_of_columns(pair.at, name)?;
                let finding = Some(finding);
                return Ok(Some(Columns { at: pair.at, unit, finding, chosen: true, station: None }));
            }
        }
        let find = |(y, z): &(&str, &str)| position(heads, y).zip(position(heads, z));
        let Some(mut at) = NAMES.iter().find_map(find) else { return Ok(None) };
        // Sections of a body in space: their points have one coordinate in common.
        if let Some(x) = position(heads, "x").filter(|x| *x != at.0 && *x != at.1)
            && rows.len() > 2
            && (constant(rows, at.0) && !constant(rows, x) || stations(rows, at.0, x).is_some())
            && stations(rows, x, at.0).is_none()
        {
            at.0 = x;
        }
        let along = |&i: &usize| i != at.0 && i != at.1 && STATIONS.contains(&bare(&heads[i]));
        let station = (0..heads.len())
            .filter(along)
            .find_map(|i| Some((i, bare(&heads[i]).to_owned(), stations(rows, i, at.0)?)));
        let unit = self.unit_of_columns(at, name)?;
        let again = (0..heads.len()).any(|i| i != at.0 && bare(&heads[i]) == bare(&heads[at.0]));
        let finding = (again || heads.len() > 2 && bare(&heads[at.0]) != "y").then(|| {
            let text = format!("columns {} and {} are y and z, by their names", at.0 + 1, at.1 + 1);
            Finding::new(FindingKind::Columns, Action::Noted, text).on_lines(*line, *line)
        });
        Ok(Some(Columns { at, unit, finding, chosen: false, station }))
    }

    /// The unit that the names of the columns say, m, and their line.
    fn unit_of_columns(&self, at: (usize, usize), name: &str) -> Result<Option<(f64, usize)>> {
        let Some((heads, line)) = &self.names else { return Ok(None) };
        let [y, z] = [at.0, at.1].map(|column| marked_unit(&heads[column]));
        if let (Some(unit_y), Some(unit_z)) = (y, z)
            && unit_y != unit_z
        {
            let value = format!("{}, {}", heads[at.0], heads[at.1]);
            return Err(error_on(name, *line, &value, "y and z in one unit", "convert one of the columns"));
        }
        Ok(y.or(z).map(|unit| (unit, *line)))
    }
}

/// The letters that a column's name begins with.
fn bare(head: &str) -> &str {
    head.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default()
}

fn position(heads: &[String], wanted: &str) -> Option<usize> {
    heads.iter().take(MOST_COLUMNS).position(|head| bare(head) == wanted)
}

/// A unit after a bracket, an underscore or a stroke: `[m]`, `(in)`, `_mm`, `/ mm`.
fn marked_unit(lower: &str) -> Option<f64> {
    let marks = ['[', '(', '_', '/'];
    let after = |at: usize| lower[at + 1..].trim_start().split(|c: char| !c.is_alphabetic()).next();
    lower.match_indices(marks).take(HEADING_LINES).find_map(|(at, _)| unit_of(after(at)?))
}

pub(super) fn parse(name: &str, text: &str, ending: &str, part: &Part) -> Result<Raw> {
    let Some((line, plain)) = without_thousands(text) else { return parse_plain(name, text, ending, part) };
    let mut raw = parse_plain(name, &plain, ending, part)?;
    let text = "numbers with a mark between their thousands: read without it";
    raw.findings.push(Finding::new(FindingKind::Columns, Action::Noted, text).on_lines(line, line));
    Ok(raw)
}

fn parse_plain(name: &str, text: &str, ending: &str, part: &Part) -> Result<Raw> {
    let rows = lines(text).filter(|(_, line)| !is_comment(line)).map(|(n, line)| (n, without_comment(line)));
    let numeric = rows.clone().filter(|(_, row)| begins_like_a_number(row));
    let mark = decimal_mark(name, numeric.clone())?;
    let no_rows = |expected: String, remedy: &str| {
        error_on(name, 1, text.lines().next().unwrap_or_default(), expected, remedy)
    };
    let mut heading = Heading::default();
    // A comment names the columns if it has as many words as the rows have fields.
    let mut commented = Heading::default();
    let mut passed = Vec::new();
    let mut first_row = None;
    for (n, line) in lines(text).take(HEADING_LINES + 1) {
        let given = heading.columns(&[], name, part)?.map_or((0, 1), |columns| columns.at);
        if !is_comment(line) && matches!(row(without_comment(line), mark, given), Row::Point(_)) {
            first_row = Some(n);
            break;
        }
        refuse_other_formats(name, n, line)?;
        let understood = heading.note(n, line);
        if is_comment(line) {
            commented.note_columns(n, line.trim_start_matches(COMMENT_SIGNS));
        } else if !heading.note_columns(n, line) && !understood {
            passed.push((n, line));
        }
    }
    let Some(first_row) = first_row else {
        return Err(if lines(text).count() > HEADING_LINES && numeric.clone().next().is_some() {
            let expected = format!("rows of numbers within the first {HEADING_LINES} lines");
            no_rows(expected, "shorten the heading, or put `#` before its lines")
        } else {
            no_rows("rows of numbers".into(), "give y and z in columns")
        });
    };
    let all_of = |row: &str| -> Vec<f64> {
        fields(row, mark).iter().map(|field| number(field.text, mark).unwrap_or(f64::NAN)).collect()
    };
    let from_first = rows.clone().skip_while(|(n, _)| *n < first_row);
    let fields = from_first.clone().next().map_or(0, |(_, row)| all_of(row).len());
    // A table of two columns is one profile; nothing but its first rows is looked at.
    let looked_at = if fields > 2 { usize::MAX } else { 100 };
    let all: Vec<Vec<f64>> = from_first.clone().take(looked_at).map(|(_, row)| all_of(row)).collect();
    if heading.names.is_none() && commented.names.as_ref().is_some_and(|(heads, _)| heads.len() == fields) {
        heading.names = commented.names;
    }
    let columns = match heading.columns(&all, name, part)? {
        Some(columns) => columns,
        None if all.first().is_none_or(|row| row.iter().filter(|v| !v.is_nan()).count() < 3) => {
            Columns { at: (0, 1), ..Columns::default() }
        }
        None => {
            let (at, why, values) = guess_columns(&all);
            let text = format!("columns {} and {} are y and z: {why}", at.0 + 1, at.1 + 1);
            let finding =
                Finding::new(FindingKind::Columns, Action::Noted, text).on_lines(first_row, first_row);
            let station = values.map(|values| (0, "column 1".into(), values));
            Columns { at, finding: Some(finding), station, ..Columns::default() }
        }
    };
    let by_marks = from_first.clone().next().is_some_and(|(_, row)| mark_separates(row, mark));
    let format = if ending == "csv" || by_marks { ProfileFormat::Csv } else { ProfileFormat::Text };
    let mut blocks = Blocks::new(name, mark);
    passed.into_iter().for_each(|(n, line)| blocks.passed.line(n, line));
    let rest = lines(text).skip_while(|(n, _)| *n < first_row);
    match &columns.station {
        Some((column, head, values)) => {
            let mut of_station: Vec<Vec<(usize, &str)>> = vec![Vec::new(); values.len()];
            let mut last = 0;
            for (n, line) in rest.filter(|(_, line)| !is_comment(line)) {
                if let Row::Point(numbers) = row(without_comment(line), mark, columns.at)
                    && let Some(value) = numbers.all.get(*column).copied().flatten()
                {
                    last = values.iter().position(|other| *other == value).unwrap_or(last);
                }
                of_station[last].push((n, without_comment(line)));
            }
            for (value, rows) in values.iter().zip(of_station) {
                blocks.head(&format!("{head} = {value}"));
                for (n, line) in rows {
                    if !blocks.line(n, line, columns.at)? && !line.trim().is_empty() {
                        blocks.passed.line(n, line);
                    }
                }
            }
        }
        None => {
            for (n, line) in rest {
                let bare = line.trim_start_matches(COMMENT_SIGNS);
                if heads_others(bare) {
                    blocks.head(bare.trim_end_matches([':', ' ']));
                } else if is_comment(line) {
                    blocks.part();
                } else if !blocks.line(n, without_comment(line), columns.at)? {
                    blocks.part();
                    if !without_comment(line).trim().is_empty() {
                        blocks.passed.line(n, line);
                    }
                }
            }
        }
    }
    let within = Part { name: part.name.filter(|_| !columns.chosen), field: part.field.clone() };
    let chosen = blocks.choose(&within, None)?;
    let mut findings: Vec<Finding> = columns.finding.into_iter().collect();
    findings.extend(chosen.findings);
    let kind = heading.kind.or(match ending {
        "prr" | "ban" => Some(ProfileKind::Rail),
        "prw" | "whl" => Some(ProfileKind::Wheel),
        _ => None,
    });
    let unit = chosen.unit.or(columns.unit).or(heading.unit);
    Ok(Raw { format, kind, convention: Convention::Free, unit, points: chosen.points, findings })
}

/// Whether commas or semicolons separate the fields of a row.
fn mark_separates(row: &str, mark: DecimalMark) -> bool {
    row.contains(';') || (mark == DecimalMark::Point && row.contains(','))
}

/// Formats of other programs that would be misread as columns.
fn refuse_other_formats(name: &str, n: usize, line: &str) -> Result<()> {
    let upper = line.trim().to_ascii_uppercase();
    let other = match upper.as_str() {
        "WHEELPROFILE" | "RAILPROFILE" => "Vampire",
        "[FILEINFO]" => "MiniProf .mpt",
        _ => return Ok(()),
    };
    Err(error_on(
        name,
        n,
        line.trim(),
        "a Simpack, MiniProf, text or CSV file",
        format!("{other} files are not read: export the profile as two columns"),
    ))
}

fn constant(rows: &[Vec<f64>], column: usize) -> bool {
    let values = rows.iter().filter_map(|row| row.get(column));
    values.clone().zip(values.skip(1)).all(|(a, b)| a == b)
}

/// Columns of y and z among three or more, why, and the values of the first one where it tells sections apart.
fn guess_columns(rows: &[Vec<f64>]) -> ((usize, usize), &'static str, Option<Vec<f64>>) {
    let first = rows.iter().filter_map(|row| row.first());
    let counts = first.clone().zip(first.skip(1)).all(|(a, b)| b - a == 1.0);
    if rows.len() > 2 && counts {
        ((1, 2), "the first one counts the points", None)
    } else if rows.len() > 2 && constant(rows, 0) {
        ((1, 2), "the first one is constant", None)
    } else if let Some(values) = stations(rows, 0, 1) {
        ((1, 2), "the first one tells sections apart", Some(values))
    } else {
        ((0, 1), "they come first", None)
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
