//! The bodies that are unlike all others: robust scores.

use std::collections::BTreeMap;

use super::bodies::Bodies;
use super::quantity::{Quantity, Source};
use super::robust::Spread;
use super::section::{Section, Table, deviations};
use super::shape::Shapes;
use crate::report::number::number;

/// Score from which a value is an outlier (Iglewicz and Hoaglin, 1993).
const OUTLIER: f64 = 3.5;
/// Values of which a median is worth a comparison.
const LEAST: usize = 10;
/// Outliers that are listed.
const LISTED: usize = 50;
/// Outliers whose shape is drawn.
const DRAWN: usize = 12;

/// A body by the value that is farthest from all others.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlier {
    /// Its number.
    pub body: usize,
    /// How many deviations that value is from the median.
    pub score: f64,
    /// The quantity, by its number.
    quantity: usize,
    /// The conditions in words.
    condition: String,
    /// The value and the median.
    values: [f64; 2],
    /// Quantities of the body with a value that is an outlier.
    quantities: usize,
}

/// The bodies by their largest score, the largest first.
pub fn outliers(bodies: &Bodies<'_>) -> Vec<Outlier> {
    let mut worst: Vec<Option<Outlier>> = vec![None; bodies.bodies.len()];
    for (number, quantity) in bodies.quantities.iter().enumerate() {
        let mut is_one = vec![false; bodies.bodies.len()];
        for (condition, values) in values(bodies, quantity) {
            let Some(spread) = Spread::of(values.iter().map(|(_, value)| *value)) else { continue };
            if values.len() < LEAST {
                continue;
            }
            for (body, value) in values {
                let Some(score) = spread.score(value) else { continue };
                is_one[body] |= score.abs() > OUTLIER;
                if worst[body].as_ref().is_none_or(|other| score.abs() > other.score.abs()) {
                    let values = [value, spread.median];
                    let quantities = worst[body].as_ref().map_or(0, |other| other.quantities);
                    worst[body] = Some(Outlier {
                        body,
                        score,
                        quantity: number,
                        condition: condition.into(),
                        values,
                        quantities,
                    });
                }
            }
        }
        for (worst, _) in worst.iter_mut().zip(is_one).filter(|(_, is_one)| *is_one) {
            worst.iter_mut().for_each(|worst| worst.quantities += 1);
        }
    }
    let mut worst: Vec<Outlier> = worst.into_iter().flatten().collect();
    worst.sort_by(|a, b| b.score.abs().total_cmp(&a.score.abs()));
    worst
}

/// The values of a quantity that are compared with each other, by conditions in words, each with its body.
fn values<'b>(bodies: &'b Bodies<'_>, quantity: &Quantity) -> BTreeMap<&'b str, Vec<(usize, f64)>> {
    let mut values: BTreeMap<&str, Vec<(usize, f64)>> = BTreeMap::new();
    for (number, body) in bodies.bodies.iter().enumerate() {
        for row in &body.rows {
            let condition = &bodies.conditions[bodies.condition[row]];
            let condition = match quantity.source {
                Source::Body => "",
                Source::Pair => &condition.of_pair,
                Source::Place => &condition.words,
            };
            let Some(value) = quantity.of_row(&bodies.rows.rows[*row]) else { continue };
            let of = values.entry(condition).or_default();
            // what does not depend on the place is in every row
            if quantity.source == Source::Place || of.last().is_none_or(|(last, _)| *last != number) {
                of.push((number, value));
            }
        }
    }
    values
}

/// The section.
pub fn section(bodies: &Bodies<'_>, shapes: &Shapes<'_>) -> Section {
    let kind = bodies.kind;
    let title = format!("The {} that are unlike the others", kind.several());
    let mut section = Section::new(&format!("{}-outliers", kind.name()), &title);
    let all = outliers(bodies);
    let found: Vec<&Outlier> = all.iter().filter(|outlier| outlier.score.abs() > OUTLIER).collect();
    section.text.push(format!(
        "Each value is compared with those of all other {} under the same conditions: its distance from their median, in deviations. A deviation is 1.4826 times the median distance, which is the standard deviation of a normal distribution; where half of the values are equal it is 1.2533 times the mean distance. Beyond {OUTLIER} deviations a value is an outlier; {} of {} {} have one.",
        kind.several(),
        found.len(),
        bodies.bodies.len(),
        kind.several()
    ));
    if all.is_empty() {
        section.missing.push(format!("No column has values of {LEAST} {} that differ.", kind.several()));
        return section;
    }
    if found.is_empty() {
        return section;
    }
    let caption = format!(
        "The {} of {} outliers that are farthest from the median, each by the value that is farthest.",
        found.len().min(LISTED),
        found.len()
    );
    let head =
        [kind.name(), "quantity", "#value", "#median", "#deviations", "#quantities beyond", "conditions"];
    let mut table = Table::new(caption, &head);
    table.rows.extend(found.iter().take(LISTED).map(|outlier| {
        vec![
            bodies.bodies[outlier.body].name.clone(),
            bodies.quantities[outlier.quantity].with_unit(),
            number(outlier.values[0]),
            number(outlier.values[1]),
            rounded(outlier.score),
            outlier.quantities.to_string(),
            outlier.condition.clone(),
        ]
    }));
    section.table(table);
    if shapes.y_mm.is_empty() {
        section
            .missing
            .push(format!("The shapes of these {} are not known here, so none is drawn.", kind.several()));
        return section;
    }
    let band = shapes.band(0..shapes.of.len());
    for outlier in found.iter().take(DRAWN) {
        let Some(shape) = shapes.of[outlier.body] else { continue };
        let caption = format!(
            "{}: {} is {} deviations from the median. Line: its deviation from the standard; grey: 5 to 95 % of all.",
            bodies.bodies[outlier.body].name,
            bodies.quantities[outlier.quantity].name,
            rounded(outlier.score)
        );
        section.small.push(deviations(shapes.y_mm, &band, &shape.off_um, caption));
    }
    section
}

/// A score with its sign and one decimal.
fn rounded(score: f64) -> String {
    crate::rounding::with_minus_signs(&format!("{score:+.1}"))
}
