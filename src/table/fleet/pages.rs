//! The page of a fleet and the table of its typical profiles.

use serde_json::json;

use super::about::About;
use super::bodies::Bodies;
use super::kind::Kind;
use super::section::Section;
use super::shape::{Shape, Shapes};
use super::{axles, campaign, counts, outliers, spreads, trends, typical};
use crate::report::html;
use crate::table::rows::Rows;

/// Measured bodies from which on they are a fleet.
const FLEET: usize = 20;

/// The files of a fleet.
#[derive(Debug, Clone, PartialEq)]
pub struct Pages {
    /// `table_fleet.html`; self-contained.
    pub html: String,
    /// `table_typical.toml`, if shapes of wheels are known.
    pub typical: Option<String>,
}

/// The page of rows and of the shapes beside them, `None` for a row without one; none where neither wheels nor rails are a fleet.
///
/// A body's shape is that of its first row that has one. Shapes beyond the last row play no part.
pub fn page(rows: &Rows, shapes: &[Option<Shape>], about: &About<'_>) -> Option<Pages> {
    let fleets = [(Kind::Wheel, &about.wheels), (Kind::Rail, &about.rails)];
    let fleets: Vec<Bodies<'_>> = fleets
        .into_iter()
        .filter(|(_, names)| names.len() > FLEET)
        .map(|(kind, names)| Bodies::of(kind, rows, names))
        .filter(|bodies| bodies.bodies.len() > FLEET)
        .collect();
    if fleets.is_empty() {
        return None;
    }
    let (mut sections, mut table): (Vec<Section>, _) = (Vec::new(), None);
    for bodies in &fleets {
        // shapes are of wheels: rails have none yet
        let of_row =
            |row: &usize| shapes.get(*row).and_then(Option::as_ref).filter(|_| bodies.kind == Kind::Wheel);
        let shapes = Shapes::of(bodies.bodies.iter().map(|body| body.rows.iter().find_map(of_row)).collect());
        sections.push(counts::section(bodies));
        sections.push(spreads::section(bodies));
        sections.push(trends::section(bodies));
        sections.push(outliers::section(bodies, &shapes));
        let (section, found) = typical::section(bodies, &shapes);
        sections.push(section);
        if bodies.kind == Kind::Wheel && !found.is_empty() {
            table = typical::table(about, &found);
        }
        sections.extend(axles::section(bodies));
        sections.extend(about.earlier.map(|earlier| campaign::section(bodies, earlier)));
    }
    let context = json!({
        "name": about.name,
        "description": about.description,
        "places": rows.rows.len(),
        "sections": sections,
        "typical": table.is_some(),
        "diff": about.earlier.is_some(),
    });
    Some(Pages { html: html::render("table_fleet.html", context), typical: table })
}

#[cfg(test)]
mod tests;
