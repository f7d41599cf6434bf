//! `table.html`: the rows to sort and filter, what they look like together, and which are odd.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use super::made::Status;
use super::rows::Rows;
use crate::engine::columns::Cell;
use crate::report::accessible::inline;
use crate::report::html;
use crate::report::number::{WIDTH, number};
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{BLUE, DARK, Marker, RED, Series};
use crate::rounding::{ratio, with_minus_signs};
use crate::verify::quantile;

/// Most points of a curve.
const POINTS: usize = 2000;
/// Most wheels, and most rails, of the table of all pairs.
const PAIRS: usize = 40;
/// Places that are listed as odd.
const ODD: usize = 10;
/// Places whose reasons are listed.
const REASONS: usize = 50;
/// Rows up to which the page has all columns.
const ALL_COLUMNS: usize = 50_000;

/// A place as the page needs it.
struct Seen<'a> {
    wheel: String,
    rail: String,
    shift: f64,
    angle: Option<f64>,
    stiffness: Option<f64>,
    row: &'a [Cell],
}

/// The page; self-contained. `fleet` is the file beside it with the page of many measured profiles, if there is one.
pub fn page(name: &str, description: &str, rows: &Rows, fleet: Option<&str>) -> String {
    let loads: Vec<&str> =
        rows.columns.iter().filter_map(|column| column.strip_prefix("stiffness_kn_per_m_at_")).collect();
    let seen = seen(rows, loads.last().copied().unwrap_or_default());
    let load = loads.last().map_or_else(String::new, |load| load.replace("kn", " kN"));
    let count = |status: Status| {
        let column = rows.column("status").unwrap_or_default();
        rows.rows.iter().filter(|row| row[column].text() == status.name()).count()
    };
    let direction = rows.column("direction").and_then(|at| rows.rows.first().map(|row| row[at].text()));
    let reasons = reasons(rows, &seen);
    html::render(
        "table.html",
        json!({
            "name": name,
            "description": description,
            "fleet": fleet,
            "places": rows.rows.len(),
            "complete": count(Status::Complete),
            "early": count(Status::EndsEarly),
            "failed": count(Status::Failed),
            "direction": direction,
            "figures": over_angle(rows, &loads),
            "heat": heat(&seen, &load),
            "odd": odd(&seen),
            "odd_caption": format!("Stiffness at {load} against the median of the nearest places whose contact angles are within 2 degrees; the ten that are farthest from it."),
            "reasons": reasons,
            "reasons_caption": format!("{} of {} places.", reasons.len(), count(Status::EndsEarly) + count(Status::Failed)),
            "data": embedded(rows),
        }),
    )
}

/// The rows by what the page compares.
fn seen<'a>(rows: &'a Rows, load: &str) -> Vec<Seen<'a>> {
    let at = |name: &str| rows.column(name);
    let [wheel, rail, diameter, inclination, shift, angle] =
        ["wheel", "rail", "tape_diameter_m", "rail_inclination", "shift_mm", "contact_angle_deg"].map(at);
    let stiffness = at(&format!("stiffness_kn_per_m_at_{load}"));
    let several = |column: Option<usize>| {
        column.is_some_and(|at| rows.rows.iter().any(|row| row[at] != rows.rows[0][at]))
    };
    let (diameters, inclinations) = (several(diameter), several(inclination));
    let text = |row: &[Cell], at: Option<usize>| at.map_or_else(String::new, |at| row[at].text());
    let value = |row: &[Cell], at: Option<usize>| at.and_then(|at| row[at].number());
    rows.rows
        .iter()
        .map(|row| {
            let mut names = [text(row, wheel), text(row, rail)];
            if let (true, Some(diameter)) = (diameters, value(row, diameter)) {
                names[0] += &format!(", {diameter} m");
            }
            if let (true, Some(slope)) = (inclinations, value(row, inclination)) {
                names[1] += &if slope == 0.0 { ", upright".into() } else { format!(", {}", ratio(slope)) };
            }
            let [wheel, rail] = names;
            let shift = value(row, shift).unwrap_or(f64::NAN);
            Seen { wheel, rail, shift, angle: value(row, angle), stiffness: value(row, stiffness), row }
        })
        .collect()
}

/// Stiffness over the contact angle, for up to three loads.
fn over_angle(rows: &Rows, loads: &[&str]) -> Vec<Value> {
    let Some(angle) = rows.column("contact_angle_deg") else { return Vec::new() };
    let chosen: BTreeSet<usize> = [0, loads.len() / 2, loads.len().saturating_sub(1)].into();
    let series: Vec<Series> = chosen
        .into_iter()
        .filter_map(|index| loads.get(index))
        .zip([(DARK, Marker::Circle), (BLUE, Marker::Triangle), (RED, Marker::Disc)])
        .filter_map(|(load, (color, marker))| {
            let column = rows.column(&format!("stiffness_kn_per_m_at_{load}"))?;
            let points: Vec<(f64, f64)> = rows
                .rows
                .iter()
                .filter_map(|row| Some((row[angle].number()?, 1e-6 * row[column].number()?)))
                .collect();
            let every = points.len().div_ceil(POINTS).max(1);
            let points: Vec<(f64, f64)> = points.into_iter().step_by(every).collect();
            (!points.is_empty()).then(|| Series::marks(&load.replace("kn", " kN"), points, color, marker))
        })
        .collect();
    if series.is_empty() {
        return Vec::new();
    }
    let panel = Panel::from_zero(
        "contact angle at the first touch, degrees",
        "tangent stiffness, 10\u{2076} kN/m",
        series,
    );
    let svg = stacked(WIDTH, 330, &[panel]);
    let every = rows.rows.len().div_ceil(POINTS);
    let some = if every > 1 { format!(" Every {every}th place is drawn.") } else { String::new() };
    let caption = format!(
        "Tangent stiffness of all places over their contact angle, a mark for each place and load.{some}"
    );
    vec![json!({ "svg": inline(&svg, &caption), "caption": caption })]
}

/// Stiffness of every wheel on every rail at the shift nearest to zero, in shades of grey.
fn heat(seen: &[Seen<'_>], load: &str) -> Option<Value> {
    let nearest = seen.iter().map(|place| place.shift.abs()).fold(f64::INFINITY, f64::min);
    let mut pairs: BTreeMap<(usize, usize), Vec<f64>> = BTreeMap::new();
    let (mut wheels, mut rails): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    let number_of = |names: &mut Vec<_>, name| match names.iter().position(|known| *known == name) {
        Some(at) => Some(at),
        None if names.len() < PAIRS => {
            names.push(name);
            Some(names.len() - 1)
        }
        None => None,
    };
    for place in seen.iter().filter(|place| place.shift.abs() == nearest) {
        let at = (number_of(&mut wheels, place.wheel.as_str()), number_of(&mut rails, place.rail.as_str()));
        if let (Some(wheel), Some(rail)) = at {
            pairs.entry((wheel, rail)).or_default().extend(place.stiffness);
        }
    }
    let medians: BTreeMap<(usize, usize), f64> =
        pairs.into_iter().filter_map(|(pair, mut values)| Some((pair, median(&mut values)?))).collect();
    if wheels.len() * rails.len() < 2 || medians.is_empty() {
        return None;
    }
    let low = medians.values().copied().fold(f64::INFINITY, f64::min);
    let high = medians.values().copied().fold(f64::NEG_INFINITY, f64::max);
    let cell = |pair| match medians.get(&pair) {
        None => json!({ "back": "#fff", "front": "#1a1a1a", "text": "none" }),
        Some(value) => {
            let shade = if high > low { (value - low) / (high - low) } else { 0.0 };
            // from white to a grey that is dark enough for white letters
            let level = (245.0 - 175.0 * shade).round();
            let front = if shade > 0.55 { "#fff" } else { "#1a1a1a" };
            let back = format!("rgb({level},{level},{level})");
            json!({ "back": back, "front": front, "text": format!("{:.3}", 1e-6 * value) })
        }
    };
    let rows: Vec<Value> = wheels
        .iter()
        .enumerate()
        .map(|(wheel, name)| {
            let cells: Vec<Value> = (0..rails.len()).map(|rail| cell((wheel, rail))).collect();
            json!({ "wheel": name, "cells": cells })
        })
        .collect();
    let caption = format!(
        "Tangent stiffness at {load} with a shift of {} mm, 10\u{2076} kN/m; the darker, the stiffer. Where a pair has several such places, their median.",
        number(nearest)
    );
    Some(json!({ "caption": caption, "rails": rails, "rows": rows }))
}

/// The median of some values, which it sorts.
fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    quantile(values, 0.5)
}

/// The places whose stiffness is farthest from the median of those with the nearest contact angles.
fn odd(seen: &[Seen<'_>]) -> Vec<Value> {
    /// Places on either side of one with which it is compared, at most.
    const BESIDE: usize = 12;
    /// How far their contact angles may be from its own, degrees.
    const NEAR: f64 = 2.0;
    /// Places that a median is of, at least.
    const LEAST: usize = 5;
    let mut places: Vec<(f64, f64, &Seen<'_>)> =
        seen.iter().filter_map(|place| Some((place.angle?, place.stiffness?, place))).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut off: Vec<(f64, usize)> = (0..places.len())
        .filter_map(|at| {
            let beside = &places[at.saturating_sub(BESIDE)..(at + BESIDE + 1).min(places.len())];
            let near = beside.iter().filter(|other| (other.0 - places[at].0).abs() <= NEAR);
            let mut values: Vec<f64> = near.map(|place| place.1).collect();
            let median = (values.len() >= LEAST).then(|| median(&mut values)).flatten()?;
            Some((places[at].1 / median - 1.0, at))
        })
        .collect();
    off.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let row = |(off, at): &(f64, usize)| {
        let (angle, stiffness, place) = places[*at];
        json!({
            "wheel": place.wheel,
            "rail": place.rail,
            "shift": number(place.shift),
            "angle": format!("{angle:.1}"),
            "stiffness": format!("{:.3}", 1e-6 * stiffness),
            "off": with_minus_signs(&format!("{:+.1} %", 1e2 * off)),
        })
    };
    off.iter().take(ODD).map(row).collect()
}

/// The first places without a whole law, and why.
fn reasons(rows: &Rows, seen: &[Seen<'_>]) -> Vec<Value> {
    let (Some(status), Some(reason)) = (rows.column("status"), rows.column("reason")) else {
        return Vec::new();
    };
    seen.iter()
        .filter(|place| place.row[status].text() != Status::Complete.name())
        .take(REASONS)
        .map(|place| {
            json!({
                "wheel": place.wheel,
                "rail": place.rail,
                "shift": number(place.shift),
                "status": place.row[status].text(),
                "reason": place.row[reason].text(),
            })
        })
        .collect()
}

/// The rows for the page's own program, column by column: numbers rounded, words once each, and what is the same everywhere once.
fn embedded(rows: &Rows) -> String {
    const OF_MANY: [&str; 8] = [
        "wheel",
        "rail",
        "tape_diameter_m",
        "rail_inclination",
        "friction",
        "shift_mm",
        "contact_angle_deg",
        "status",
    ];
    let is_shown = |name: &str| {
        rows.rows.len() <= ALL_COLUMNS
            || OF_MANY.contains(&name)
            || name.starts_with("stiffness_kn_per_m_at_")
    };
    let column = |(at, name): (usize, &String)| {
        let mut cells = rows.rows.iter().map(|row| &row[at]);
        let first = cells.clone().next();
        if let Some(first) = first.filter(|first| cells.all(|cell| cell == *first)) {
            let constant = first.number().map_or_else(|| Value::from(first.text()), rounded);
            return json!({ "name": name, "constant": constant });
        }
        let cells = rows.rows.iter().map(|row| &row[at]);
        if cells.clone().all(|cell| !matches!(cell, Cell::Text(_))) {
            let values: Vec<Value> = cells.map(|cell| cell.number().map_or(Value::Null, rounded)).collect();
            return json!({ "name": name, "values": values });
        }
        let words: BTreeSet<String> = cells.clone().map(Cell::text).collect();
        let place: BTreeMap<&String, usize> = words.iter().enumerate().map(|(at, word)| (word, at)).collect();
        let values: Vec<usize> = cells.map(|cell| place[&cell.text()]).collect();
        json!({ "name": name, "words": words, "values": values })
    };
    let columns: Vec<Value> =
        rows.columns.iter().enumerate().filter(|(_, name)| is_shown(name)).map(column).collect();
    // nothing in a name may end the script that it stands in
    json!({ "rows": rows.rows.len(), "columns": columns }).to_string().replace('<', "\\u003c")
}

/// What is smaller, in the unit of its column, is 0: no quantity of a place is, but for rounding.
const NOTHING: f64 = 1e-9;

/// A number of six digits.
fn rounded(number: f64) -> Value {
    if number.abs() < NOTHING {
        return 0.into();
    }
    format!("{number:.5e}").parse::<f64>().map_or(Value::Null, Value::from)
}

#[cfg(test)]
mod tests;
