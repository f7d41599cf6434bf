//! How stiffness and conicity go with mileage and wear: quantiles over bins of equal counts.

use super::bodies::{Bodies, Body};
use super::kind::Kind;
use super::quantity::{Quantity, Role, with_role};
use super::robust::{band, bins, sorted};
use super::section::{BAND, Figure, Section, Table};
use crate::report::number::{WIDTH, number};
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{DARK, Dash, Marker, Series};
use crate::verify::quantile;

/// Bins at most.
const BINS: usize = 12;
/// Bodies of a bin: fewer say nothing of quantiles of 5 and 95 %.
const OF_A_BIN: usize = 20;
/// Height of a panel, px.
const PANEL: u32 = 190;

/// What values are shown over.
struct Over {
    name: String,
    unit: &'static str,
    /// Of each body.
    values: Vec<Option<f64>>,
}

/// The section.
pub fn section(bodies: &Bodies<'_>) -> Section {
    let mut section = Section::new(
        &format!("{}-spread", bodies.kind.name()),
        &format!("Stiffness and conicity of the {} over mileage and wear", bodies.kind.several()),
    );
    let shown: Vec<&Quantity> = [Role::Stiffness, Role::Horizontal, Role::Conicity]
        .into_iter()
        .filter_map(|role| with_role(&bodies.quantities, role))
        .collect();
    for (role, name) in [(Role::Horizontal, "lateral stiffness"), (Role::Conicity, "equivalent conicity")] {
        if with_role(&bodies.quantities, role).is_none() {
            section.missing.push(format!("The table has no column of {name}."));
        }
    }
    if shown.is_empty() {
        section.missing.push("The table has no column of stiffness.".into());
        return section;
    }
    section.text.push(format!(
        "Each bin has as many {} as the others. Half of the values lie below the median, 90 % within the band. Conditions: {}.",
        bodies.kind.several(),
        or_all(bodies.main_in_words())
    ));
    for over in overs(bodies, &mut section.missing) {
        add(&mut section, bodies, &shown, &over);
    }
    section
}

/// Words for conditions that do not vary.
pub fn or_all(conditions: &str) -> &str {
    if conditions.is_empty() { "the only ones of the table" } else { conditions }
}

/// Mileage or date, and the measures of wear; those without columns are named.
fn overs(bodies: &Bodies<'_>, missing: &mut Vec<String>) -> Vec<Over> {
    let of = |value: &dyn Fn(&Body) -> Option<f64>| bodies.bodies.iter().map(value).collect::<Vec<_>>();
    let has_some = |values: &[Option<f64>]| values.iter().flatten().count() >= OF_A_BIN;
    let mut overs = Vec::new();
    let mileage = of(&|body| Some(1e-3 * bodies.number(body, &bodies.own("mileage_km"))?));
    let date = of(&|body| Some(1970.0 + bodies.day(body)? / 365.2425));
    if has_some(&mileage) {
        overs.push(Over { name: "mileage".into(), unit: "1000 km", values: mileage });
    } else if has_some(&date) {
        overs.push(Over { name: "date".into(), unit: "year", values: date });
    } else {
        missing.push(format!(
            "Fewer than {OF_A_BIN} {} have a `{}` or a `{}`.",
            bodies.kind.several(),
            bodies.own("mileage_km"),
            bodies.own("date")
        ));
    }
    let wear: Vec<&Quantity> = bodies.quantities.iter().filter(|of| of.role == Some(Role::Wear)).collect();
    if wear.is_empty() {
        let example =
            if bodies.kind == Kind::Wheel { "wheel_tread_wear_mm" } else { "rail_vertical_wear_mm" };
        missing.push(format!("The table has no measure of wear, such as `{example}`."));
    }
    for quantity in wear {
        let values = of(&|body| bodies.value(body, quantity));
        if has_some(&values) {
            overs.push(Over { name: quantity.name.clone(), unit: quantity.unit, values });
        }
    }
    overs
}

/// Adds the figure and the table of the quantities over a measure.
fn add(section: &mut Section, bodies: &Bodies<'_>, shown: &[&Quantity], over: &Over) {
    let mut order: Vec<(f64, &Body)> =
        over.values.iter().zip(&bodies.bodies).filter_map(|(value, body)| Some(((*value)?, body))).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let places: Vec<f64> = order.iter().map(|(place, _)| *place).collect();
    let bins = bins(&places, (places.len() / OF_A_BIN).clamp(1, BINS));
    let label = format!("{}, {}", over.name, over.unit);
    let mut head = vec![label.clone(), format!("#{}", bodies.kind.several())];
    let mut rows: Vec<Vec<String>> = bins
        .iter()
        .map(|bin| {
            let [low, high] = [places[bin.start], places[bin.end - 1]].map(number);
            vec![format!("{low} to {high}"), bin.len().to_string()]
        })
        .collect();
    let mut panels = Vec::new();
    for quantity in shown {
        let (mut ends, mut medians) = (Vec::new(), Vec::new());
        for (bin, row) in bins.iter().zip(&mut rows) {
            let values = order[bin.clone()].iter().filter_map(|(_, body)| bodies.value(body, quantity));
            match (quantile(&sorted(places[bin.clone()].iter().copied()), 0.5), band(values)) {
                (Some(place), Some([low, middle, high])) => {
                    ends.push((place, [low, high]));
                    medians.push((place, middle));
                    row.extend([low, middle, high].map(number));
                }
                _ => row.extend(["", "", ""].map(String::from)),
            }
        }
        head.extend(["5 %", "50 %", "95 %"].map(|part| format!("#{}, {part}", quantity.name)));
        let mut series = Series::band("5 to 95 %", &ends, BAND);
        series.push(Series::joined("median", medians, DARK, Dash::Solid, Marker::Disc));
        panels.push(Panel::new(&label, &quantity.with_unit(), series));
    }
    let caption = format!(
        "{} over {}: {} {} in {} bins.",
        shown.iter().map(|quantity| quantity.name.as_str()).collect::<Vec<_>>().join(", "),
        over.name,
        places.len(),
        bodies.kind.several(),
        bins.len()
    );
    if bins.len() > 1 {
        section.figure(Figure::new(&stacked(WIDTH, PANEL, &panels), caption.clone()));
    }
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    section.table(Table { rows, ..Table::new(format!("{caption} Stiffness in 10\u{2076} kN/m."), &head) });
}
