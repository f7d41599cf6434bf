//! Sections of the page: sentences, figures, tables, and what is missing.

use serde::Serialize;

use crate::report::accessible::inline;
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{DARK, Dash, RGBColor, Series};

/// Grey of what lies behind a curve.
pub const BAND: RGBColor = RGBColor(200, 204, 209);
/// Width and height of a small figure, px.
const SMALL: [u32; 2] = [400, 215];

/// A section of the page.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Section {
    /// Where links lead to.
    pub id: String,
    /// Its heading, a question's answer.
    pub title: String,
    /// Sentences below the heading.
    pub text: Vec<String>,
    /// Figures of the width of the page and tables, in their order.
    pub parts: Vec<Part>,
    /// Figures that stand side by side below them.
    pub small: Vec<Figure>,
    /// What the table of springs does not have, so that the section says less.
    pub missing: Vec<String>,
}

/// What stands below the sentences.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// A figure of the width of the page.
    Figure(Figure),
    /// A table.
    Table(Table),
}

/// A drawing with its caption.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// SVG with a text for those who do not see it.
    pub svg: String,
    /// What it shows.
    pub caption: String,
}

/// A table of the page.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Table {
    /// What it shows.
    pub caption: String,
    /// Headings.
    pub head: Vec<Head>,
    /// Rows of as many texts.
    pub rows: Vec<Vec<String>>,
}

/// The heading of a column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Head {
    /// What it says.
    pub text: String,
    /// Whether the column has numbers.
    pub number: bool,
}

impl Section {
    /// A section without content.
    pub fn new(id: &str, title: &str) -> Self {
        Self { id: id.into(), title: title.into(), ..Self::default() }
    }

    /// Adds a table.
    pub fn table(&mut self, table: Table) {
        self.parts.push(Part::Table(table));
    }

    /// Adds a figure of the width of the page.
    pub fn figure(&mut self, figure: Figure) {
        self.parts.push(Part::Figure(figure));
    }
}

impl Figure {
    /// A figure from a drawing.
    pub fn new(svg: &str, caption: String) -> Self {
        Self { svg: inline(svg, &caption), caption }
    }
}

impl Table {
    /// A table without rows; the headings of columns of numbers begin with `#`.
    pub fn new(caption: String, head: &[&str]) -> Self {
        let head = head.iter().map(|text| Head {
            text: text.trim_start_matches('#').to_string(),
            number: text.starts_with('#'),
        });
        Self { caption, head: head.collect(), rows: Vec::new() }
    }
}

/// A curve of deviations with a band behind it, as a small figure.
pub fn deviations(y_mm: &[f64], band_um: &[[f64; 2]], curve_um: &[f64], caption: String) -> Figure {
    /// Points of a curve: a small figure shows no more.
    const POINTS: usize = 100;
    let every = y_mm.len().div_ceil(POINTS).max(1);
    let at = |n: usize, value: f64| (y_mm[n], 1e-3 * value);
    let ends: Vec<(f64, [f64; 2])> = band_um
        .iter()
        .enumerate()
        .step_by(every)
        .map(|(n, ends)| (y_mm[n], ends.map(|end| 1e-3 * end)))
        .collect();
    let curve = curve_um.iter().enumerate().step_by(every).map(|(n, value)| at(n, *value)).collect();
    let mut series = Series::band("", &ends, BAND);
    series.push(Series::line("", curve, DARK, Dash::Solid));
    let panel = Panel::new("y, mm", "missing material, mm", series);
    Figure::new(&stacked(SMALL[0], SMALL[1], &[panel]), caption)
}
