//! What has changed since an earlier table of the same fleet.

use std::collections::{BTreeMap, BTreeSet};

use railspring_profiles::error::{InputError, Result};

use super::axles::signed;
use super::bodies::{Bodies, Body};
use super::quantity::Role;
use super::section::{Section, Table};
use super::spreads::or_all;
use crate::engine::columns::{Cell, as_given};
use crate::report::number::number;
use crate::table::earlier::Earlier;
use crate::table::rows::Rows;

/// Bodies of a quantity that are listed.
const LISTED: usize = 20;

/// The rows of an earlier `table.csv`.
///
/// # Errors
/// [`InputError`] for a file that cannot be read or is no CSV.
pub fn earlier(earlier: &Earlier) -> Result<Rows> {
    let refused = |cause: csv::Error| {
        let remedy = "name a table.csv that `railspring table` has written";
        InputError::new(earlier.path.display().to_string(), cause.to_string(), "a table in CSV", remedy)
    };
    let mut reader = csv::Reader::from_reader(earlier.text.as_bytes());
    let columns = reader.headers().map_err(refused)?.iter().map(str::to_owned).collect();
    let cell = |text: &str| match text.parse::<f64>() {
        // 007 is a name
        Ok(number) if number.is_finite() && number.to_string() == text => Cell::Number(Some(number)),
        _ => Cell::from(as_given(text)),
    };
    let rows = reader.records().map(|row| Ok(row.map_err(refused)?.iter().map(cell).collect()));
    Ok(Rows { columns, rows: rows.collect::<Result<_>>()?, metadata: 0..0 })
}

/// The section.
pub fn section(bodies: &Bodies<'_>, earlier: &Rows) -> Section {
    let kind = bodies.kind;
    let mut section = Section::new(
        &format!("{}-changes", kind.name()),
        &format!("Changes of the {} since the earlier table", kind.several()),
    );
    let name = earlier.column(kind.name());
    let names: BTreeSet<String> = earlier.rows.iter().filter_map(|row| Some(row[name?].text())).collect();
    let before = Bodies::of(kind, earlier, &names);
    let pairs = pairs(bodies, &before);
    if pairs.is_empty() {
        section.missing.push(format!(
            "No measured {} is in both tables, neither by its place on the vehicle nor by its name.",
            kind.name()
        ));
        return section;
    }
    section.text.push(format!(
        "{} of {} {} are in the earlier table, too: by vehicle, axle and side where both tables have them, else by name. Of several measurements the last counts. Conditions: {}; before: {}.",
        pairs.len(),
        bodies.bodies.len(),
        kind.several(),
        or_all(bodies.main_in_words()),
        or_all(before.main_in_words())
    ));
    for quantity in bodies.quantities.iter().filter(|quantity| quantity.role.is_some()) {
        let Some(old) = before.quantities.iter().find(|old| old.name == quantity.name) else { continue };
        let mut changed: Vec<(f64, &Body, [f64; 2])> = pairs
            .iter()
            .filter_map(|(now, then)| {
                let values = [before.value(then, old)?, bodies.value(now, quantity)?];
                Some((values[1] - values[0], *now, values))
            })
            .collect();
        if changed.is_empty() {
            continue;
        }
        changed.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        let middle = super::robust::Spread::of(changed.iter().map(|of| of.0)).map_or(0.0, |of| of.median);
        let caption = format!(
            "{}: the largest {} of {} changes; their median is {}.",
            quantity.with_unit(),
            changed.len().min(LISTED),
            changed.len(),
            signed(middle)
        );
        let is_relative = quantity.role != Some(Role::Wear);
        let mut head = vec![kind.name(), "#before", "#now", "#change"];
        head.extend(is_relative.then_some("#relative"));
        let mut table = Table::new(caption, &head);
        table.rows.extend(changed.iter().take(LISTED).map(|(change, body, values)| {
            let mut row = vec![body.name.clone()];
            row.extend(values.map(number));
            row.push(signed(*change));
            if is_relative {
                let part = (values[0] != 0.0).then(|| 1e3 * change / values[0]);
                row.push(part.map_or_else(String::new, |part| format!("{} %", signed(part.round() / 10.0))));
            }
            row
        }));
        section.table(table);
    }
    section
}

/// The bodies that are in both tables, now and before.
fn pairs<'b>(now: &'b Bodies<'_>, before: &'b Bodies<'_>) -> Vec<(&'b Body, &'b Body)> {
    let by_place = |bodies: &'b Bodies<'_>| -> BTreeMap<Vec<Option<String>>, &'b Body> {
        let mut last: BTreeMap<Vec<Option<String>>, &Body> = BTreeMap::new();
        for body in &bodies.bodies {
            let names = ["vehicle", "axle", "wheel", "side", "line", "position"];
            let place = names.map(|name| bodies.text(body, &bodies.own(name)));
            // one of these alone is no place
            if place.iter().flatten().count() < 2 {
                continue;
            }
            let held = last.entry(place.to_vec()).or_insert(body);
            if bodies.day(body).unwrap_or(f64::MIN) >= bodies.day(held).unwrap_or(f64::MIN) {
                *held = body;
            }
        }
        last
    };
    let (new, old) = (by_place(now), by_place(before));
    let placed: Vec<(&Body, &Body)> =
        new.into_iter().filter_map(|(place, body)| Some((body, *old.get(&place)?))).collect();
    if !placed.is_empty() {
        return placed;
    }
    let named: BTreeMap<&str, &Body> = before.bodies.iter().map(|body| (body.name.as_str(), body)).collect();
    now.bodies.iter().filter_map(|body| Some((body, *named.get(body.name.as_str())?))).collect()
}
