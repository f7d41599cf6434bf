//! Simpack's `.prr` and `.prw`.
//!
//! Blocks `header`, `spline` and, inside that, `point`, of which any may be missing as long as it stays clear what the
//! points are; `!` and `%` start a comment outside quotes. The header's processing is applied in its own order: least
//! distance, shift, rotation, bounds, mirrors, inversion, unit.

use std::collections::BTreeMap;
use std::fmt::Write;

use nalgebra::Rotation2;

use super::blocks::drop_strangers;
use super::finding::{Action, Finding, FindingKind};
use super::format::ProfileFormat;
use super::measured::{MeasuredPoint, push};
use super::part::Part;
use super::raw::{Convention, Raw};
use super::rows::{Numbers, PassedOver, Row as Read, broken, row};
use super::text::{
    DecimalMark, before_comment, begins_like_a_number, decimal_mark, error_at, error_on, lines,
    number_with_any_mark, unit_of,
};
use crate::error::Result;
use crate::profile::ProfileKind;
use crate::units::MILLIMETRE;

/// Keys whose value is a number.
const NUMERIC: [&str; 14] = [
    "point.dist.min",
    "shift.y",
    "shift.z",
    "rotate",
    "bound.y.min",
    "bound.y.max",
    "bound.z.min",
    "bound.z.max",
    "mirror.y",
    "mirror.z",
    "inversion",
    "units.len.f",
    "units.ang.f",
    "approx.smooth",
];

/// Quotes and blanks around a text.
const QUOTES: [char; 3] = ['\'', '"', ' '];

pub(super) fn recognises(text: &str, ending: &str) -> bool {
    const ENOUGH_LINES: usize = 2000;
    let by_ending = matches!(ending, "prr" | "prw");
    lines(text).take(ENOUGH_LINES).any(|(_, line)| {
        let line = line.trim_start().to_ascii_lowercase();
        let block = ["header.", "spline.", "point."]
            .into_iter()
            .filter_map(|block| line.strip_prefix(block))
            .any(|rest| rest.starts_with("begin") || (by_ending && rest.starts_with("end")));
        let key = || line.split_once('=').is_some_and(|(key, _)| NUMERIC.contains(&key.trim()));
        block || (by_ending && key())
    })
}

/// The line without its comment.
fn without_comment(line: &str) -> &str {
    let (before, open) = before_comment(line);
    // An unclosed quote is an apostrophe.
    if open { line.split(['!', '%']).next().unwrap_or(line) } else { before }
}

/// A header value with its place.
struct Entry {
    value: f64,
    line: usize,
}

pub(super) fn parse(name: &str, text: &str, ending: &str, part: &Part) -> Result<Raw> {
    if let Some(wanted) = part.name {
        let remedy = format!("remove {}: a Simpack file holds a single profile", part.field);
        return Err(error_on(name, 1, wanted, "no part", remedy));
    }
    let rows = lines(text).map(|(n, line)| (n, without_comment(line)));
    let mark = decimal_mark(name, rows.clone().filter(|(_, row)| begins_like_a_number(row)))?;
    let begins = |row: &str| row.trim().eq_ignore_ascii_case("point.begin");
    let mut file = Blocks::new(name, mark, rows.clone().any(|(_, row)| begins(row)));
    for (line, text) in rows {
        file.row(&Row { line, text })?;
    }
    file.finish(lines(text).count(), ending)
}

/// A line of the file without its comment.
struct Row<'a> {
    line: usize,
    text: &'a str,
}

/// What has been read of the file so far.
struct Blocks<'a> {
    name: &'a str,
    mark: DecimalMark,
    /// The blocks that are open, the innermost last.
    open: Vec<&'static str>,
    /// Whether the file has a line that begins the points.
    points_begin: bool,
    /// Whether the block of points has begun.
    has_points: bool,
    header: BTreeMap<String, Entry>,
    /// What units.len names, m, and its line.
    named_unit: Option<(f64, usize)>,
    /// The line in which units.ang names degrees.
    degrees: Option<usize>,
    kind: Option<ProfileKind>,
    points: Vec<MeasuredPoint>,
    passed: PassedOver,
    findings: Vec<Finding>,
}

impl<'a> Blocks<'a> {
    fn new(name: &'a str, mark: DecimalMark, points_begin: bool) -> Self {
        Self {
            name,
            mark,
            open: Vec::new(),
            points_begin,
            has_points: false,
            header: BTreeMap::new(),
            named_unit: None,
            degrees: None,
            kind: None,
            points: Vec::new(),
            passed: PassedOver::default(),
            findings: Vec::new(),
        }
    }

    fn row(&mut self, row: &Row) -> Result<()> {
        match row.text.trim().to_ascii_lowercase().as_str() {
            "" => Ok(()),
            "header.begin" => self.begin("header", row),
            "spline.begin" => self.begin("spline", row),
            "point.begin" => self.begin("point", row),
            "header.end" => self.end("header", row),
            "spline.end" => self.end("spline", row),
            "point.end" => self.end("point", row),
            _ if self.open.last() == Some(&"point") => self.point(row),
            _ => self.entry(row),
        }
    }

    fn note(&mut self, line: usize, what: String) {
        /// A file that is no Simpack file must give no endless list.
        const MOST: usize = 20;
        if self.findings.len() >= MOST {
            return;
        }
        self.findings.push(Finding::new(FindingKind::Header, Action::Noted, what).on_lines(line, line));
    }

    fn begin(&mut self, block: &'static str, row: &Row) -> Result<()> {
        if block == "point" {
            if self.has_points {
                let remedy = "the file holds several profiles: save each of them to a separate file";
                let column = row.text.chars().take_while(|c| c.is_whitespace()).count() + 1;
                let expected = "a single block of points";
                return Err(error_at(self.name, row.line, column, row.text.trim(), expected, remedy));
            }
            self.has_points = true;
        } else {
            // Only points lie inside another block.
            while let Some(open) = self.open.pop() {
                self.note(row.line, format!("the block {open} is not ended before {block} begins"));
            }
        }
        self.open.push(block);
        Ok(())
    }

    fn end(&mut self, block: &'static str, row: &Row) -> Result<()> {
        if !self.open.contains(&block) {
            self.note(row.line, format!("the end of the block {block}, which has not begun"));
            return Ok(());
        }
        while let Some(open) = self.open.pop().filter(|open| *open != block) {
            self.note(row.line, format!("the block {open} is not ended before {block} ends"));
        }
        Ok(())
    }

    fn point(&mut self, given: &Row) -> Result<()> {
        match row(given.text, self.mark, (0, 1)) {
            Read::Point(numbers) => self.push(given.line, &numbers),
            Read::NoValues => {
                self.passed.no_values(given.line);
                Ok(())
            }
            Read::Broken(column, text) => Err(broken(self.name, given.line, column, &text)),
            Read::Text => {
                self.passed.line(given.line, given.text);
                Ok(())
            }
        }
    }

    fn push(&mut self, line: usize, numbers: &Numbers) -> Result<()> {
        let weight = numbers.all.get(2).copied().flatten().unwrap_or(1.0);
        if weight < 0.0 {
            let remedy = "give 1, or 0 for a point that does not count in smoothing";
            return Err(error_on(self.name, line, &weight.to_string(), "a weight of 0 or more", remedy));
        }
        self.passed.words(line, &numbers.words);
        push(self.name, &mut self.points, numbers.y, numbers.z, line, weight)
    }

    /// Takes `key = value`, where the key matters, and rows of points where no line begins these.
    fn entry(&mut self, given: &Row) -> Result<()> {
        let Some((key, value)) = given.text.trim().split_once('=') else {
            if !self.points_begin
                && self.open.last() != Some(&"header")
                && let Read::Point(_) = row(given.text, self.mark, (0, 1))
            {
                self.note(given.line, "points without point.begin: taken from here on".into());
                self.begin("point", given)?;
                return self.point(given);
            }
            self.passed.line(given.line, given.text);
            return Ok(());
        };
        let (key, value) = (key.trim().to_ascii_lowercase(), value.trim());
        let column = given.text.chars().take_while(|c| *c != '=').count() + 2;
        let fault = |expected, remedy| error_at(self.name, given.line, column, value, expected, remedy);
        // Inside the spline `type` is that of the original file.
        if self.open.last().is_none_or(|open| *open == "header") && key == "type" {
            self.kind = Some(match value {
                "0" => ProfileKind::Rail,
                "1" => ProfileKind::Wheel,
                _ => return Err(fault("0 for a rail or 1 for a wheel", "correct the type")),
            });
        } else if self.open.last() != Some(&"header") && NUMERIC.contains(&key.as_str()) {
            let value =
                number_with_any_mark(value).ok_or_else(|| fault("a finite number", "correct the value"))?;
            let before = self.header.insert(key.clone(), Entry { value, line: given.line });
            if let Some(before) = before.filter(|before| before.value != value) {
                let expected = format!("{key} = {} as in line {}", before.value, before.line);
                let value = value.to_string();
                return Err(error_at(
                    self.name,
                    given.line,
                    column,
                    &value,
                    expected,
                    "remove one of the two",
                ));
            }
        } else if key == "units.len" {
            self.named_unit = unit_of(value.trim_matches(QUOTES)).map(|unit| (unit, given.line));
        } else if key == "units.ang" && value.trim_matches(QUOTES).to_lowercase().starts_with("deg") {
            // A factor that the file gives comes first, wherever it stands.
            self.degrees = Some(given.line);
        }
        Ok(())
    }

    /// The profile of a file that ends with the line `last`; its kind is that of its header, or else of the `ending` of
    /// its name.
    fn finish(mut self, last: usize, ending: &str) -> Result<Raw> {
        if !self.has_points {
            let expected = "a block of points from point.begin to point.end";
            return Err(error_on(self.name, last, "", expected, "complete the file"));
        }
        let unit = self.unit()?;
        let kind = self.kind.or(match ending {
            "prr" => Some(ProfileKind::Rail),
            "prw" => Some(ProfileKind::Wheel),
            _ => None,
        });
        let note = |what: String| Finding::new(FindingKind::Header, Action::Noted, what);
        let mut findings = std::mem::take(&mut self.findings);
        let unended =
            self.open.last().map(|b| format!("the block {b} is not ended; the file may be cut off"));
        findings.extend(unended.map(note));
        let worded = std::mem::take(&mut self.passed.worded);
        findings.extend(self.passed.findings());
        drop_strangers(&mut self.points, &worded, &mut findings);
        let weighted = self.points.iter().filter(|p| p.weight != 1.0);
        if let (Some(first), Some(last)) = (weighted.clone().next(), weighted.clone().next_back()) {
            let what = format!(
                "{} points with weights other than 1: they count in smoothing; without it every point is taken",
                weighted.clone().count()
            );
            findings.push(note(what).on_lines(first.line, last.line));
        }
        if let Some(line) = self.degrees {
            let value = 1.0f64.to_degrees();
            self.header.entry("units.ang.f".into()).or_insert(Entry { value, line });
        }
        let points = process(&self.header, self.points, &mut findings);
        if let Some(entry) = self.header.get("approx.smooth").filter(|entry| entry.value != 0.0) {
            let what = format!(
                "approx.smooth = {} is not applied, its meaning is that of one program: smoothing is asked for by a \
                 wavelength",
                entry.value
            );
            findings.push(note(what).on_lines(entry.line, entry.line));
        }
        let (format, convention) = (ProfileFormat::Simpack, Convention::Stated);
        Ok(Raw { format, kind, convention, unit, points, findings })
    }

    /// Length of the unit, m, and the line that says so: the factor, or the name where there is no factor.
    fn unit(&self) -> Result<Option<(f64, usize)>> {
        match self.header.get("units.len.f") {
            None => Ok(self.named_unit),
            Some(entry) if entry.value > 0.0 => Ok(Some((1.0 / entry.value, entry.line))),
            Some(entry) => {
                let (value, expected) = (entry.value.to_string(), "units.len.f above 0, in units a metre");
                Err(error_on(self.name, entry.line, &value, expected, "give 1000 for mm"))
            }
        }
    }
}

/// Applies the header's processing but for the unit.
fn process(
    header: &BTreeMap<String, Entry>,
    points: Vec<MeasuredPoint>,
    findings: &mut Vec<Finding>,
) -> Vec<MeasuredPoint> {
    let value = |key: &str, default: f64| header.get(key).map_or(default, |entry| entry.value);
    let line = |key: &str| header.get(key).map_or(0, |entry| entry.line);
    let mut note = |key: &str, what: String| {
        let text = format!("{key} of the header applied: {what}");
        findings.push(Finding::new(FindingKind::Header, Action::Noted, text).on_lines(line(key), line(key)));
    };
    let before = points.len();
    let least = value("point.dist.min", 0.0);
    let mut kept: Vec<MeasuredPoint> = Vec::with_capacity(before);
    for point in points {
        // By |dy| alone: that is what the format means by distance.
        if least <= 0.0 || kept.last().is_none_or(|last| (point.point.x - last.point.x).abs() >= least) {
            kept.push(point);
        }
    }
    if kept.len() < before {
        note("point.dist.min", format!("{} points dropped", before - kept.len()));
    }
    let (shift_y, shift_z) = (value("shift.y", 0.0), value("shift.z", 0.0));
    let angle = value("rotate", 0.0) / value("units.ang.f", 1.0);
    let turn = Rotation2::new(if angle.is_finite() { angle } else { 0.0 });
    for (key, applied) in [("shift.y", shift_y), ("shift.z", shift_z)] {
        if applied != 0.0 {
            note(key, format!("{applied}"));
        }
    }
    if angle != 0.0 {
        note("rotate", format!("{} rad", turn.angle()));
    }
    for p in &mut kept {
        p.point.x += shift_y;
        p.point.y += shift_z;
        p.point = turn * p.point;
    }
    // A lower bound above the upper one switches the bound off.
    let bounds = |axis: &str| {
        let (low, high) =
            (value(&format!("bound.{axis}.min"), 1.0), value(&format!("bound.{axis}.max"), 0.0));
        (low < high).then_some((low, high))
    };
    if let Some((low, high)) = bounds("y") {
        let before = kept.len();
        kept.retain(|p| (low..=high).contains(&p.point.x));
        note("bound.y.min", format!("{} points outside {low} to {high} dropped", before - kept.len()));
    }
    if let Some((low, high)) = bounds("z") {
        kept.iter_mut().for_each(|p| p.point.y = p.point.y.clamp(low, high));
        note("bound.z.min", format!("heights held within {low} to {high}"));
    }
    if value("mirror.y", 0.0) != 0.0 {
        kept.iter_mut().for_each(|p| p.point.x = -p.point.x);
        note("mirror.y", "y turned over".into());
    }
    if value("mirror.z", 0.0) != 0.0 {
        kept.iter_mut().for_each(|p| p.point.y = -p.point.y);
        note("mirror.z", "z turned over".into());
    }
    if value("inversion", 0.0) != 0.0 {
        kept.reverse();
        note("inversion", "order of the points reversed".into());
    }
    kept
}

/// A Simpack file in mm; the points of a wheel run from the field side to the flange, as the format has it.
pub(super) fn write(kind: ProfileKind, points: &[MeasuredPoint], comment: &str) -> String {
    let (number, order): (_, Box<dyn Iterator<Item = &MeasuredPoint>>) = match kind {
        ProfileKind::Rail => (0, Box::new(points.iter())),
        ProfileKind::Wheel => (1, Box::new(points.iter().rev())),
    };
    let mut out = format!(
        "! Wheel or rail profile, y to the field side, z down\nheader.begin\n  version  = 1\n  type     = {number}  \
         ! 0 rail, 1 wheel\nheader.end\nspline.begin\n  approx.smooth = 0\n  comment = '{comment}'\n  \
         units.len = 'mm'\n  units.ang = 'rad'\n  units.len.f = 1000\n  units.ang.f = 1\n  point.begin\n"
    );
    for p in order {
        let (y, z) = (p.point.x / MILLIMETRE, p.point.y / MILLIMETRE);
        // Writing to a string cannot fail.
        let _ = match p.weight {
            1.0 => writeln!(out, "{y}\t{z}"),
            weight => writeln!(out, "{y}\t{z}\t{weight}"),
        };
    }
    out.push_str("  point.end\nspline.end\n");
    out
}
