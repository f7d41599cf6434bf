//! How fast each vehicle changes: a robust line over mileage or date.

use std::collections::BTreeMap;

use super::bodies::{Bodies, Body};
use super::quantity::Quantity;
use super::robust::{Slope, Spread};
use super::section::{Figure, Section, Table};
use super::spreads::or_all;
use crate::report::number::{WIDTH, number};
use crate::report::panel::{Panel, stacked_over_names};
use crate::report::plot::{DARK, Dash, GREY, Marker, PALE_BLUE, Series};

/// Vehicles of a quantity that are listed.
const LISTED: usize = 10;

/// A vehicle's slope of a quantity.
pub struct Trend {
    /// Name of the vehicle.
    pub vehicle: String,
    /// Its slope per 100,000 km or per year.
    pub slope: Slope,
    /// Deviations of the slopes of all vehicles by which it is from their median; none where all are equal.
    pub score: Option<f64>,
}

/// The section.
pub fn section(bodies: &Bodies<'_>) -> Section {
    let [column, group] = bodies.kind.group();
    let title = format!("How fast each {group} changes");
    let mut section = Section::new(&format!("{}-trends", bodies.kind.name()), &title);
    let vehicles = vehicles(bodies, column);
    if vehicles.is_empty() {
        section.missing.push(format!("No row has a `{column}`."));
        return section;
    }
    let Some((per, value)) = over(bodies) else {
        let [mileage, date] = ["mileage_km", "date"].map(|name| bodies.own(name));
        section
            .missing
            .push(format!("No {group} has two measurements with another `{mileage}` or `{date}`."));
        return section;
    };
    section.text.push(format!(
        "The slope is the median of the slopes between measurements ({}): of one {}, or of one {group} where each was measured once. Its interval is of 95 %; it is left out where there are too few measurements for one. A {group} stands higher the farther its slope is from the median of all. Reprofiling counts as a change like any other.",
        "Theil and Sen",
        bodies.kind.name()
    ));
    section.text.push(format!("Conditions: {}.", or_all(bodies.main_in_words())));
    for quantity in bodies.quantities.iter().filter(|quantity| quantity.role.is_some()) {
        let trends = trends(bodies, &vehicles, quantity, &*value);
        if trends.is_empty() {
            continue;
        }
        let middle = Spread::of(trends.iter().map(|trend| trend.slope.slope)).map_or(0.0, |of| of.median);
        let caption = format!(
            "{} {per}: the {} of {} {group}s that are farthest from the median of all, {}; {} of all have an interval on one side of zero.",
            quantity.with_unit(),
            trends.len().min(LISTED),
            trends.len(),
            number(middle),
            trends.iter().filter(|trend| trend.slope.is_sure()).count()
        );
        let head = [group, "#slope", "#from", "#to", "#measurements", "#deviations from the median"];
        let mut table = Table::new(caption, &head);
        table.rows.extend(trends.iter().take(LISTED).map(|trend| {
            let end = |at: usize| trend.slope.interval.map_or_else(String::new, |ends| number(ends[at]));
            vec![
                trend.vehicle.clone(),
                number(trend.slope.slope),
                end(0),
                end(1),
                trend.slope.points.to_string(),
                trend.score.map_or_else(String::new, |score| number((10.0 * score).round() / 10.0)),
            ]
        }));
        section.figure(figure(&trends, middle, &format!("{} {per}", quantity.with_unit()), group));
        section.table(table);
    }
    section
}

/// The slopes of the listed vehicles with their intervals, beside the median of all.
fn figure(trends: &[Trend], middle: f64, name: &str, group: &str) -> Figure {
    /// Height of the panel, px.
    const HEIGHT: u32 = 300;
    let listed = || trends.iter().take(LISTED).enumerate().map(|(at, trend)| (at as f64, trend));
    let interval = |(at, trend): (f64, &Trend)| {
        let [low, high] = trend.slope.interval.unwrap_or([f64::NAN; 2]);
        // a gap after each
        [(at, low), (at, high), (at, f64::NAN)]
    };
    let marks = listed().map(|(at, trend)| (at, trend.slope.slope)).collect();
    let ends = [-0.5, listed().count() as f64 - 0.5].map(|at| (at, middle)).to_vec();
    let series = vec![
        Series::line("median of all", ends, GREY, Dash::Dashed),
        Series::line("interval of 95 %", listed().flat_map(interval).collect(), PALE_BLUE, Dash::Solid)
            .broad(),
        Series::marks("slope", marks, DARK, Marker::Disc),
    ];
    let names: Vec<[String; 2]> = listed().map(|(_, trend)| [trend.vehicle.clone(), String::new()]).collect();
    let svg = stacked_over_names(WIDTH, HEIGHT, &[Panel::new(group, name, series)], &[], &names);
    Figure::new(&svg, format!("{name}: the {group}s that are farthest from the median of all."))
}

/// The bodies of each vehicle.
pub fn vehicles<'b>(bodies: &'b Bodies<'_>, column: &str) -> BTreeMap<String, Vec<&'b Body>> {
    let mut vehicles: BTreeMap<String, Vec<&Body>> = BTreeMap::new();
    for body in &bodies.bodies {
        if let Some(vehicle) = bodies.text(body, column) {
            vehicles.entry(vehicle).or_default().push(body);
        }
    }
    vehicles
}

/// What is known of when a body was measured.
type When<'b> = Box<dyn Fn(&Body) -> Option<f64> + 'b>;

/// Mileage in 100,000 km where it is known, else the date in years, and what a slope over it is called.
fn over<'b>(bodies: &'b Bodies<'_>) -> Option<(&'static str, When<'b>)> {
    let differs = |value: &When<'_>| {
        let mut values = bodies.bodies.iter().filter_map(value);
        let first = values.next();
        first.is_some_and(|first| values.any(|value| value != first))
    };
    let mileage: When<'b> = Box::new(|body| Some(1e-5 * bodies.number(body, &bodies.own("mileage_km"))?));
    if differs(&mileage) {
        return Some(("per 100,000 km", mileage));
    }
    let date: When<'b> = Box::new(|body| Some(bodies.day(body)? / 365.2425));
    differs(&date).then_some(("per year", date))
}

/// The slopes of all vehicles, the one that is farthest from the median first.
pub fn trends(
    bodies: &Bodies<'_>,
    vehicles: &BTreeMap<String, Vec<&Body>>,
    quantity: &Quantity,
    when: &dyn Fn(&Body) -> Option<f64>,
) -> Vec<Trend> {
    let slope = |members: &[&Body]| {
        let mut groups: BTreeMap<Vec<Option<String>>, Vec<(f64, f64)>> = BTreeMap::new();
        for body in members {
            let position =
                ["axle", "wheel", "side", "position"].map(|name| bodies.text(body, &bodies.own(name)));
            if let (Some(when), Some(value)) = (when(body), bodies.value(body, quantity)) {
                groups.entry(position.to_vec()).or_default().push((when, value));
            }
        }
        let groups: Vec<Vec<(f64, f64)>> = groups.into_values().collect();
        Slope::of(&groups).or_else(|| Slope::of(&[groups.concat()]))
    };
    let slopes: Vec<(&String, Slope)> =
        vehicles.iter().filter_map(|(name, members)| Some((name, slope(members)?))).collect();
    let spread = Spread::of(slopes.iter().map(|(_, slope)| slope.slope));
    let mut trends: Vec<Trend> = slopes
        .into_iter()
        .map(|(vehicle, slope)| {
            let score = spread.and_then(|spread| spread.score(slope.slope));
            Trend { vehicle: vehicle.clone(), slope, score }
        })
        .collect();
    let far = |trend: &Trend| trend.score.map_or(0.0, f64::abs);
    trends.sort_by(|a, b| far(b).total_cmp(&far(a)));
    trends
}

/// The slopes of a quantity over what is known of the time.
#[cfg(test)]
pub fn of_quantity(bodies: &Bodies<'_>, quantity: &Quantity) -> Vec<Trend> {
    let (_, when) = over(bodies).unwrap();
    trends(bodies, &vehicles(bodies, bodies.kind.group()[0]), quantity, &*when)
}
