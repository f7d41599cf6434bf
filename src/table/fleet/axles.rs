//! Left and right of an axle: which wheelsets are unequal.

use std::collections::BTreeMap;

use super::bodies::{Bodies, Body};
use super::kind::Kind;
use super::quantity::Role;
use super::section::{Section, Table};
use crate::report::number::number;
use crate::table::axle::side;

/// Axles of a quantity that are listed.
const LISTED: usize = 15;

/// Two wheels of an axle that were measured on a day.
pub struct Axle<'b> {
    /// Vehicle, axle and date.
    pub name: [String; 3],
    /// Left and right.
    pub wheels: [&'b Body; 2],
}

/// The axles of which both wheels were measured.
pub fn axles<'b>(bodies: &'b Bodies<'_>) -> Vec<Axle<'b>> {
    let mut axles: BTreeMap<[String; 3], [Vec<&Body>; 2]> = BTreeMap::new();
    for body in &bodies.bodies {
        let text = |name: &str| bodies.text(body, &bodies.own(name));
        let (Some(vehicle), Some(axle)) = (text("vehicle"), text("axle")) else { continue };
        let Some(side) = text("side").or_else(|| text("wheel")).and_then(|text| side(&text)) else {
            continue;
        };
        let date = text("date").unwrap_or_default();
        axles.entry([vehicle, axle, date]).or_default()[side].push(body);
    }
    let both = |(name, [left, right]): ([String; 3], [Vec<&'b Body>; 2])| match (&left[..], &right[..]) {
        // several of a side and of a day cannot be told apart
        ([left], [right]) => Some(Axle { name, wheels: [*left, *right] }),
        _ => None,
    };
    axles.into_iter().filter_map(both).collect()
}

/// The section; none of rails.
pub fn section(bodies: &Bodies<'_>) -> Option<Section> {
    if bodies.kind != Kind::Wheel {
        return None;
    }
    let mut section = Section::new("wheel-axles", "Left and right of an axle");
    let axles = axles(bodies);
    if axles.is_empty() {
        section.missing.push(
            "No axle has one left and one right wheel of a date in `wheel_vehicle`, `wheel_axle` and `wheel_side`.".into(),
        );
        return Some(section);
    }
    section.text.push(format!(
        "{} axles have a left and a right wheel of the same date. The largest differences come first.",
        axles.len()
    ));
    section.text.push("Rolling radii follow from the diameters that the table of springs gives.".into());
    let radius = bodies.rows.column("rolling_radius_mm");
    let of_main = |body: &Body| {
        let row = body.main.first()?;
        bodies.rows.rows[*row][radius?].number()
    };
    compare(&mut section, &axles, "rolling radius, mm", &of_main);
    let quantities = bodies.quantities.iter().filter(|quantity| match quantity.role {
        Some(Role::Wear) => ["hollow", "tread wear"].contains(&&*quantity.name),
        role => role == Some(Role::Conicity),
    });
    for quantity in quantities {
        compare(&mut section, &axles, &quantity.with_unit(), &|body| bodies.value(body, quantity));
    }
    Some(section)
}

/// Adds the axles with the largest differences of a value.
fn compare(section: &mut Section, axles: &[Axle<'_>], name: &str, value: &dyn Fn(&Body) -> Option<f64>) {
    let of_both = axles.iter().filter_map(|axle| {
        let [left, right] = axle.wheels;
        let values = [value(left)?, value(right)?];
        Some((values[0] - values[1], axle, values))
    });
    let mut of_both: Vec<(f64, &Axle<'_>, [f64; 2])> = of_both.collect();
    if of_both.is_empty() {
        section.missing.push(format!("No axle has both values of {name}."));
        return;
    }
    of_both.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let listed = of_both.len().min(LISTED);
    let caption = format!("Left less right, {name}: the largest {listed} of {} axles.", of_both.len());
    let mut table = Table::new(caption, &["vehicle", "axle", "date", "#left", "#right", "#difference"]);
    table.rows.extend(of_both.iter().take(LISTED).map(|(difference, axle, values)| {
        let mut row = axle.name.to_vec();
        row.extend(values.map(number));
        row.push(signed(*difference));
        row
    }));
    section.table(table);
}

/// A difference with its sign.
pub fn signed(difference: f64) -> String {
    let plus = if difference > 0.0 { "+" } else { "" };
    format!("{plus}{}", number(difference))
}
