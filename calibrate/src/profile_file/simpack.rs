//! Simpack's `.prr` and `.prw`.
//!
//! Blocks `header`, `spline` and, inside that, `point`; `!` starts a comment outside quotes. The header's
//! processing is applied in its own order: least distance, shift, rotation, bounds, mirrors, inversion, unit.

use std::collections::BTreeMap;
use std::fmt::Write;

use nalgebra::Rotation2;

use super::finding::{Action, Finding, FindingKind};
use super::text::{DecimalMark, begins_like_a_number, decimal_mark, error_at, lines, number, row_numbers};
use super::{Convention, MeasuredPoint, ProfileFormat, ProfileKind, Raw, push};
use crate::error::Result;
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

pub(super) fn recognises(text: &str) -> bool {
    const ENOUGH_LINES: usize = 2000;
    lines(text).take(ENOUGH_LINES).any(|(_, line)| {
        let line = line.trim_start().to_ascii_lowercase();
        ["header.begin", "spline.begin", "point.begin"].iter().any(|word| line.starts_with(word))
    })
}

/// The line without its comment; a `!` in quotes starts none.
fn without_comment(line: &str) -> &str {
    let mut quote = None;
    for (index, c) in line.char_indices() {
        match (c, quote) {
            ('!', None) => return &line[..index],
            ('\'' | '"', None) => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            _ => {}
        }
    }
    // An unclosed quote is an apostrophe.
    if quote.is_some() { line.split('!').next().unwrap_or(line) } else { line }
}

/// A header value with its place.
struct Entry {
    value: f64,
    line: usize,
}

pub(super) fn parse(name: &str, text: &str, ending: &str) -> Result<Raw> {
    let mut header: BTreeMap<String, Entry> = BTreeMap::new();
    let mut type_of_profile = None;
    let mut points = Vec::new();
    let mut findings = Vec::new();
    let mut block: Vec<&str> = Vec::new();
    let mut point_block = None;
    let rows = lines(text).map(|(n, line)| (n, without_comment(line)));
    let mark = decimal_mark(name, rows.clone().filter(|(_, row)| begins_like_a_number(row)))?;
    for (n, line) in rows {
        let trimmed = line.trim();
        let column = line.chars().take_while(|c| c.is_whitespace()).count() + 1;
        let lower = trimmed.to_ascii_lowercase();
        if trimmed.is_empty() {
            continue;
        }
        match lower.as_str() {
            "header.begin" => block.push("header"),
            "spline.begin" => block.push("spline"),
            "point.begin" => {
                if point_block.replace(n).is_some() {
                    return Err(error_at(
                        name,
                        n,
                        column,
                        trimmed,
                        "a single block of points",
                        "the file holds several profiles: give each a file of its own",
                    ));
                }
                block.push("point");
            }
            "header.end" | "spline.end" | "point.end" => {
                let ended = &lower[..lower.len() - ".end".len()];
                if block.pop() != Some(ended) {
                    return Err(error_at(
                        name,
                        n,
                        column,
                        trimmed,
                        "the end of the block that is open",
                        "make each .end match its .begin",
                    ));
                }
            }
            _ if block.last() == Some(&"point") => {
                let numbers = row_numbers(name, n, line, mark, 2)?;
                push(name, &mut points, numbers[0], numbers[1], n, numbers.get(2).copied().unwrap_or(1.0))?;
            }
            _ => {
                let Some((key, value)) = trimmed.split_once('=') else {
                    return Err(error_at(
                        name,
                        n,
                        column,
                        trimmed,
                        "key = value, the begin or end of a block, or a comment",
                        "put points between point.begin and point.end, and `!` before comments",
                    ));
                };
                let (key, value) = (key.trim().to_ascii_lowercase(), value.trim());
                let value_column = line.chars().take_while(|c| *c != '=').count() + 2;
                let in_header = block.last() == Some(&"header");
                if in_header && key == "type" {
                    type_of_profile = Some(match value {
                        "0" => ProfileKind::Rail,
                        "1" => ProfileKind::Wheel,
                        _ => {
                            return Err(error_at(
                                name,
                                n,
                                value_column,
                                value,
                                "0 for a rail or 1 for a wheel",
                                "correct the type",
                            ));
                        }
                    });
                } else if !in_header && NUMERIC.contains(&key.as_str()) {
                    let value = number(value, DecimalMark::Point)
                        .or_else(|| number(value, DecimalMark::Comma))
                        .ok_or_else(|| {
                            error_at(name, n, value_column, value, "a finite number", "correct the value")
                        })?;
                    header.insert(key, Entry { value, line: n });
                }
            }
        }
    }
    if point_block.is_none() {
        let last = lines(text).count();
        return Err(error_at(
            name,
            last,
            1,
            "",
            "a block of points from point.begin to point.end",
            "complete the file",
        ));
    }
    if let Some(open) = block.last() {
        findings.push(Finding::new(
            FindingKind::Header,
            Action::Noted,
            format!("the block {open} is not ended; the file may be cut off"),
        ));
    }
    let kind = type_of_profile.or(match ending {
        "prr" => Some(ProfileKind::Rail),
        "prw" => Some(ProfileKind::Wheel),
        _ => None,
    });
    let points = process(&header, points, &mut findings);
    if let Some(entry) = header.get("approx.smooth").filter(|entry| entry.value != 0.0) {
        findings.push(
            Finding::new(
                FindingKind::Header,
                Action::Noted,
                "approx.smooth is not applied: smoothing is asked for, and reported, in this program",
            )
            .on_lines(entry.line, entry.line),
        );
    }
    let unit = match header.get("units.len.f") {
        Some(entry) if entry.value > 0.0 => Some((1.0 / entry.value, entry.line)),
        Some(entry) => {
            let value = entry.value.to_string();
            return Err(error_at(
                name,
                entry.line,
                1,
                &value,
                "units.len.f above 0, in units a metre",
                "give 1000 for mm",
            ));
        }
        None => None,
    };
    Ok(Raw { format: ProfileFormat::Simpack, kind, convention: Convention::Stated, unit, points, findings })
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
