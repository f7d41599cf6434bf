//! Rows of two coordinates among lines of other things, and what is passed over on the way.

use std::collections::BTreeMap;

use super::finding::{Action, Finding, FindingKind};
use super::text::{DecimalMark, Field, begins_like_a_number, error_at, fields, number, shown, unit_of};
use crate::error::Error;

const BRACKETS: [char; 6] = ['[', ']', '(', ')', '{', '}'];

/// What a line of a table is.
#[derive(Debug, PartialEq)]
pub(super) enum Row {
    /// Both coordinates.
    Point(Numbers),
    /// A row that says that it has no values, such as `nan nan`.
    NoValues,
    /// One coordinate alone: where the other one is missing, and what stands there.
    Broken(usize, String),
    /// No row.
    Text,
}

/// The numbers of a row.
#[derive(Debug, PartialEq)]
pub(super) struct Numbers {
    pub y: f64,
    pub z: f64,
    /// The fields in their order; `None` for what is no number.
    pub all: Vec<Option<f64>>,
    /// What follows the coordinates and is no number.
    pub words: String,
    /// Length of the unit that stands in the row, m.
    pub unit: Option<f64>,
}

/// A field without brackets: a number with its unit, if it has one.
fn value(text: &str, mark: DecimalMark) -> (Option<f64>, Option<f64>) {
    let bare = text.trim_matches(BRACKETS);
    if let Some(value) = number(bare, mark) {
        return (Some(value), None);
    }
    let split = bare.trim_end_matches(|c: char| c.is_alphabetic() || BRACKETS.contains(&c));
    match (number(split, mark), unit_of(bare[split.len()..].trim_matches(BRACKETS))) {
        (Some(value), Some(unit)) => (Some(value), Some(unit)),
        _ => (None, unit_of(bare)),
    }
}

/// Reads a line as a row with y and z in these columns, counted from zero.
pub(super) fn row(line: &str, mark: DecimalMark, columns: (usize, usize)) -> Row {
    let all = fields(line, mark);
    let taken = take(&all, mark, columns);
    if let Row::Point(_) = taken {
        return taken;
    }
    // A unit may stand in a separate field beside each number.
    let (bare, units): (Vec<Field>, Vec<Field>) = all.iter().partition(|field| {
        let word = field.text.trim_matches(BRACKETS);
        !(unit_of(word).is_some() || (word.is_empty() && !field.text.is_empty()))
    });
    match (take(&bare, mark, columns), units.iter().find_map(|field| value(field.text, mark).1)) {
        (Row::Point(numbers), unit) => Row::Point(Numbers { unit: unit.or(numbers.unit), ..numbers }),
        _ => match taken {
            Row::Broken(0, _) => Row::Broken(line.trim_end().chars().count() + 1, line.trim().into()),
            // A line of words is no row, whatever numbers are among them.
            Row::Broken(_, ref found) if columns.0 == 0 && !begins_like_a_number(line) && !is_nan(found) => {
                Row::Text
            }
            taken => taken,
        },
    }
}

fn take(fields: &[Field], mark: DecimalMark, columns: (usize, usize)) -> Row {
    let values: Vec<(Option<f64>, Option<f64>)> =
        fields.iter().map(|field| value(field.text, mark)).collect();
    let at = |column: usize| values.get(column).and_then(|value| value.0);
    match (at(columns.0), at(columns.1)) {
        (Some(y), Some(z)) => {
            let after = columns.0.max(columns.1) + 1;
            let words: Vec<&str> = (after..fields.len())
                .filter(|&i| values[i] == (None, None) && !fields[i].text.is_empty())
                .map(|i| fields[i].text)
                .collect();
            let unit = [columns.0, columns.1, after].into_iter().find_map(|at| values.get(at)?.1);
            let all = values.iter().map(|value| value.0).collect();
            Row::Point(Numbers { y, z, all, words: words.join(" "), unit })
        }
        (None, None) => {
            let both = fields.get(columns.0).zip(fields.get(columns.1));
            if both.is_some_and(|(a, b)| no_value(a.text) && no_value(b.text)) {
                Row::NoValues
            } else {
                Row::Text
            }
        }
        (y, _) => match fields.get(if y.is_none() { columns.0 } else { columns.1 }) {
            Some(field) => Row::Broken(field.column, field.text.into()),
            None => Row::Broken(0, String::new()),
        },
    }
}

/// What programs write where there is no value.
fn no_value(text: &str) -> bool {
    is_nan(text) || text.trim_matches(BRACKETS).chars().all(|c| ['-', '*', '?', '\u{2013}'].contains(&c))
}

fn is_nan(text: &str) -> bool {
    let lower = text.trim_matches(BRACKETS).to_lowercase();
    ["nan", "-nan", "n/a", "na", "null", "none"].contains(&lower.as_str())
}

/// The error for a row with one coordinate only.
pub(super) fn broken(name: &str, line: usize, column: usize, text: &str) -> Error {
    let remedy = "complete the row, or turn it into a comment";
    error_at(name, line, column, text, "a row with two finite numbers", remedy)
}

/// What is no point, so that it can be listed.
#[derive(Default)]
pub(super) struct PassedOver {
    lines: Vec<(usize, String)>,
    without_values: Vec<usize>,
    /// How often words follow the numbers, and on which lines first and last.
    words: BTreeMap<String, (usize, usize, usize)>,
    /// The lines of all these rows.
    pub worded: Vec<usize>,
}

impl PassedOver {
    /// A line that was not understood.
    pub fn line(&mut self, line: usize, text: &str) {
        self.lines.push((line, shown(text)));
    }

    /// A row that says that it has no values.
    pub fn no_values(&mut self, line: usize) {
        self.without_values.push(line);
    }

    /// Words after the numbers of a row.
    pub fn words(&mut self, line: usize, words: &str) {
        if !words.is_empty() {
            self.worded.push(line);
            let entry = self.words.entry(shown(words)).or_insert((0, line, line));
            *entry = (entry.0 + 1, entry.1, line);
        }
    }

    /// The findings about it.
    pub fn findings(mut self) -> Vec<Finding> {
        /// Most findings of each sort.
        const MOST: usize = 20;
        /// Most texts in a finding.
        const TEXTS: usize = 3;
        let mut findings = Vec::new();
        let mut add = |action, lines: (usize, usize), text: String| {
            findings.push(Finding::new(FindingKind::PassedOver, action, text).on_lines(lines.0, lines.1));
        };
        self.lines.sort();
        let mut groups = self.lines.chunk_by(|a, b| b.0 <= a.0 + 1);
        for group in groups.by_ref().take(MOST) {
            let texts: Vec<String> =
                group.iter().take(TEXTS).map(|(_, text)| format!("\"{text}\"")).collect();
            let more = if group.len() > TEXTS { ", \u{2026}" } else { "" };
            let text = format!("neither points nor anything known: {}{more}", texts.join(", "));
            add(Action::Noted, (group[0].0, group[group.len() - 1].0), text);
        }
        let rest: Vec<_> = groups.flatten().collect();
        if let (Some(first), Some(last)) = (rest.first(), rest.last()) {
            let text = format!("{} more lines that are neither points nor anything known", rest.len());
            add(Action::Noted, (first.0, last.0), text);
        }
        if let (Some(first), Some(last)) = (self.without_values.first(), self.without_values.last()) {
            let text = format!("{} rows without values", self.without_values.len());
            add(Action::Noted, (*first, *last), text);
        }
        let mut words: Vec<_> = self.words.into_iter().collect();
        words.sort_by_key(|(_, (_, first, _))| *first);
        let rest = words.split_off(words.len().min(MOST));
        for (text, (count, first, last)) in words {
            let rows = if count == 1 { "a row".into() } else { format!("{count} rows") };
            if doubts(&text) {
                let text =
                    format!("\"{text}\" after the numbers of {rows}: kept; remove them if they are wrong");
                add(Action::Left, (first, last), text);
            } else {
                add(Action::Noted, (first, last), format!("\"{text}\" after the numbers of {rows}"));
            }
        }
        if let Some((_, (_, first, _))) = rest.first() {
            let last = rest.iter().map(|(_, (_, _, last))| *last).max().unwrap_or(*first);
            let doubted = rest.iter().any(|(text, _)| doubts(text));
            let action = if doubted { Action::Left } else { Action::Noted };
            add(action, (*first, last), format!("{} more texts after numbers", rest.len()));
        }
        findings
    }
}

/// Whether words after a row may mean that it is not valid.
fn doubts(words: &str) -> bool {
    const DOUBTS: [&str; 10] =
        ["invalid", "bad", "error", "err", "outlier", "fail", "failed", "rejected", "excluded", "doubtful"];
    let lower = words.to_lowercase();
    lower.split(|c: char| !c.is_alphanumeric()).any(|word| DOUBTS.contains(&word))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(line: &str, columns: (usize, usize)) -> (f64, f64, String, Option<f64>) {
        match row(line, DecimalMark::Point, columns) {
            Row::Point(Numbers { y, z, words, unit, .. }) => (y, z, words, unit),
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn rows_of_many_programs_are_understood() {
        for (line, columns, expected) in [
            ("-1.5 2", (0, 1), (-1.5, 2.0, "", None)),
            ("-1.5 2 0.1 ok 3 low", (0, 1), (-1.5, 2.0, "ok low", None)),
            ("\"-1.5\";\"2\"", (0, 1), (-1.5, 2.0, "", None)),
            ("'-1.5' '2'", (0, 1), (-1.5, 2.0, "", None)),
            ("-1.5 [mm] 2 [mm]", (0, 1), (-1.5, 2.0, "", Some(1e-3))),
            ("-1.5 [ m ] 2 [ m ]", (0, 1), (-1.5, 2.0, "", Some(1.0))),
            ("-1.5mm 2mm", (0, 1), (-1.5, 2.0, "", Some(1e-3))),
            ("-1.5 in, 2 in", (0, 1), (-1.5, 2.0, "", Some(0.0254))),
            ("-1.5;mm;2;mm", (0, 2), (-1.5, 2.0, "", Some(1e-3))),
            ("[-1.5, 2]", (0, 1), (-1.5, 2.0, "", None)),
            ("P7 -1.5 2", (1, 2), (-1.5, 2.0, "", None)),
            ("7,2,0,-1.5", (3, 1), (-1.5, 2.0, "", None)),
        ] {
            let (y, z, words, unit) = numbers(line, columns);
            assert_eq!((y, z, words.as_str(), unit), expected, "{line}");
        }
    }

    #[test]
    fn half_a_row_is_broken_and_words_are_text() {
        let read = |line, columns| row(line, DecimalMark::Point, columns);
        assert_eq!(read("36 x5", (0, 1)), Row::Broken(4, "x5".into()));
        assert_eq!(read("36", (0, 1)), Row::Broken(3, "36".into()));
        assert_eq!(read("3,", (0, 1)), Row::Broken(3, "3,".into()));
        assert_eq!(read("P7 1.0 x", (1, 2)), Row::Broken(8, "x".into()));
        for line in ["", "; 1 2", "' 1", "$ 1 2", "radius 300 mm", "Alarm"] {
            assert_eq!(read(line, (0, 1)), Row::Text, "{line}");
        }
        for line in ["nan NaN", "--- ---", "**** ****", "n/a;n/a"] {
            assert_eq!(read(line, (0, 1)), Row::NoValues, "{line}");
        }
    }
}
