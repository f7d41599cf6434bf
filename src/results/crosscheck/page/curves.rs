//! The reference solvers' load curves beside the tool's.

use plotters::prelude::*;

use crate::report::number::WIDTH;
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{BLUE, DARK, Dash, GREY, Marker, ORANGE, RED, Series};
use crate::results::crosscheck::record::{Check, CrosscheckRecord, HUB_DISPLACEMENT, TANGENT_STIFFNESS};

/// How the curves of one problem and reference solver look; the pairs repeat only after twelve.
fn look(index: usize) -> (RGBColor, Marker) {
    const COLORS: [RGBColor; 4] = [DARK, RED, BLUE, ORANGE];
    const MARKERS: [Marker; 3] = [Marker::Circle, Marker::Square, Marker::Triangle];
    (COLORS[index % COLORS.len()], MARKERS[index % MARKERS.len()])
}

/// Problems and reference solvers of a quantity, in order of appearance.
fn pairs<'a>(record: &'a CrosscheckRecord, quantity: &str) -> Vec<(&'a str, &'a str)> {
    let mut found = Vec::new();
    for check in record.checks.iter().filter(|c| c.quantity == quantity && c.load_kn.is_some()) {
        let pair = (check.problem.as_str(), check.reference_solver.as_str());
        if !found.contains(&pair) {
            found.push(pair);
        }
    }
    found
}

/// The loads of one curve.
fn of<'a>(
    record: &'a CrosscheckRecord,
    quantity: &'a str,
    (problem, reference_solver): (&'a str, &'a str),
) -> impl Iterator<Item = (f64, &'a Check)> {
    let same = move |c: &&Check| {
        c.problem == problem && c.reference_solver == reference_solver && c.quantity == quantity
    };
    record.checks.iter().filter(same).filter_map(|c| Some((c.load_kn?, c)))
}

/// Relative difference of the hub displacement over the load.
pub fn displacement(record: &CrosscheckRecord) -> String {
    differences(record, HUB_DISPLACEMENT)
}

/// Relative difference of the tangent stiffness over the load.
pub fn tangent(record: &CrosscheckRecord) -> String {
    differences(record, TANGENT_STIFFNESS)
}

/// A panel for each limit, so that small limits are seen beside large ones.
fn differences(record: &CrosscheckRecord, quantity: &str) -> String {
    let looks = pairs(record, HUB_DISPLACEMENT);
    let mut limits: Vec<f64> = Vec::new();
    for check in record.checks.iter().filter(|c| c.quantity == quantity) {
        if !limits.contains(&check.limit) {
            limits.push(check.limit);
        }
    }
    let panels: Vec<Panel> = limits
        .into_iter()
        .map(|limit| {
            let mut series = Vec::new();
            let mut ends = (f64::INFINITY, f64::NEG_INFINITY);
            for pair in pairs(record, quantity) {
                let points: Vec<(f64, f64)> = of(record, quantity, pair)
                    .filter(|(_, check)| check.limit == limit)
                    .map(|(load, check)| (load, 100.0 * (check.reference_value / check.tool - 1.0)))
                    .collect();
                if points.is_empty() {
                    continue;
                }
                ends = points.iter().fold(ends, |(a, b), (load, _)| (a.min(*load), b.max(*load)));
                let (color, marker) = look(looks.iter().position(|p| *p == pair).unwrap_or(looks.len()));
                series.push(Series::joined(&named(pair), points, color, Dash::Solid, marker));
            }
            for (name, side) in [("limit", 100.0 * limit), ("", -100.0 * limit)] {
                series.push(Series::line(name, vec![(ends.0, side), (ends.1, side)], GREY, Dash::Dashed));
                // not drawn: keeps the limit off the frame
                series.push(Series::line("", vec![(ends.0, 1.1 * side)], GREY, Dash::None));
            }
            Panel::from_zero("load, kN", &format!("{quantity}, %"), series)
        })
        .collect();
    stacked(WIDTH, 200, &panels)
}

/// Load over hub displacement: lines of the tool, marks of the reference solvers.
pub fn load_over_displacement(record: &CrosscheckRecord) -> String {
    let mut series: Vec<Series> = Vec::new();
    let mut marks = Vec::new();
    for (index, pair) in pairs(record, HUB_DISPLACEMENT).into_iter().enumerate() {
        let (color, marker) = look(index);
        let tool: Vec<(f64, f64)> = of(record, HUB_DISPLACEMENT, pair).map(|(l, c)| (c.tool, l)).collect();
        // problems that ask the same of the tool share its line
        if !series.iter().any(|s| s.points == tool) {
            let dash = [Dash::Solid, Dash::Dashed, Dash::Dotted][series.len() % 3];
            series.push(Series::line(&format!("tool: {}", pair.0), tool, color, dash));
        }
        let theirs = of(record, HUB_DISPLACEMENT, pair).map(|(l, c)| (c.reference_value, l)).collect();
        marks.push(Series::marks(&named(pair), theirs, color, marker));
    }
    series.extend(marks);
    stacked(WIDTH, 340, &[Panel::from_zero("hub displacement, mm", "load, kN", series)])
}

fn named((problem, reference_solver): (&str, &str)) -> String {
    format!("{reference_solver}: {problem}")
}
