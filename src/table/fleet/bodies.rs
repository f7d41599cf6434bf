//! The measured wheels or rails of a table, and what is known of each.

use std::collections::{BTreeMap, BTreeSet};

use super::kind::{Kind, number};
use super::quantity::{Quantity, Source};
use crate::rounding::with_minus_signs;
use crate::table::rows::Rows;

/// A measured wheel or rail.
#[derive(Debug, Clone)]
pub struct Body {
    /// Its name in the rows.
    pub name: String,
    /// Its rows, by number.
    pub rows: Vec<usize>,
    /// Its rows under the main conditions.
    pub main: Vec<usize>,
}

/// Values of what varies beside the bodies, in words.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Condition {
    /// All of them.
    pub words: String,
    /// Those but the shift, which say which pair it is.
    pub of_pair: String,
}

/// The bodies of a table.
pub struct Bodies<'a> {
    /// Which they are.
    pub kind: Kind,
    /// The rows of the table.
    pub rows: &'a Rows,
    /// The bodies, by name.
    pub bodies: Vec<Body>,
    /// The conditions of each row of a body: the values of what else varies.
    pub condition: BTreeMap<usize, usize>,
    /// The conditions, in the order of their numbers.
    pub conditions: Vec<Condition>,
    /// Those that are compared where one has to do: nearest to a shift of zero, and of these with most rows.
    pub main: usize,
    /// What has columns.
    pub quantities: Vec<Quantity>,
}

impl<'a> Bodies<'a> {
    /// The bodies with these names.
    pub fn of(kind: Kind, rows: &'a Rows, names: &BTreeSet<String>) -> Self {
        let name = rows.column(kind.name());
        let varying = conditions(kind, rows);
        let mut bodies: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        let (mut condition, mut known, mut texts) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
        let mut sizes: Vec<(f64, usize)> = Vec::new();
        let shift = rows.column("shift_mm");
        for (number, row) in rows.rows.iter().enumerate() {
            let Some(name) = name.map(|name| row[name].text()).filter(|name| names.contains(name)) else {
                continue;
            };
            bodies.entry(name).or_default().push(number);
            let key: Vec<String> = varying.iter().map(|column| row[*column].text()).collect();
            let at = *known.entry(key).or_insert_with_key(|key| {
                let parts = || varying.iter().zip(key).map(|(column, text)| (&*rows.columns[*column], text));
                let of_pair = parts().filter(|(column, _)| *column != "shift_mm");
                texts.push(Condition { words: in_words(parts()), of_pair: in_words(of_pair) });
                sizes.push((shift.and_then(|shift| row[shift].number()).unwrap_or(0.0).abs(), 0));
                sizes.len() - 1
            });
            sizes[at].1 += 1;
            condition.insert(number, at);
        }
        let better = |a: &usize, b: &usize| {
            let ((a_shift, a_size), (b_shift, b_size)) = (sizes[*a], sizes[*b]);
            b_shift.total_cmp(&a_shift).then(a_size.cmp(&b_size)).then(b.cmp(a))
        };
        let main = (0..sizes.len()).max_by(better).unwrap_or_default();
        let of_main = |rows: &[usize]| rows.iter().copied().filter(|row| condition[row] == main).collect();
        let bodies =
            bodies.into_iter().map(|(name, rows)| Body { name, main: of_main(&rows), rows }).collect();
        Self { kind, rows, bodies, condition, conditions: texts, main, quantities: Quantity::all(kind, rows) }
    }

    /// A quantity of a body under the main conditions, in the unit of the page; of several rows the first that has it.
    pub fn value(&self, body: &Body, quantity: &Quantity) -> Option<f64> {
        let first = |rows: &[usize]| rows.iter().find_map(|row| quantity.of_row(&self.rows.rows[*row]));
        match quantity.source {
            Source::Body => first(&body.rows),
            Source::Pair => first(&body.main).or_else(|| first(&body.rows)),
            Source::Place => first(&body.main),
        }
    }

    /// The first text of a column among the rows of a body; none where it is empty or the column is not there.
    pub fn text(&self, body: &Body, column: &str) -> Option<String> {
        let column = self.rows.column(column)?;
        body.rows.iter().map(|row| self.rows.rows[*row][column].text()).find(|text| !text.is_empty())
    }

    /// The first number of a column among the rows of a body.
    pub fn number(&self, body: &Body, column: &str) -> Option<f64> {
        let column = self.rows.column(column)?;
        body.rows.iter().find_map(|row| number(&self.rows.rows[*row][column]))
    }

    /// A column of this kind of body: `wheel_date`.
    pub fn own(&self, name: &str) -> String {
        format!("{}_{name}", self.kind.name())
    }

    /// Days from 1970-01-01 to the date of a body.
    pub fn day(&self, body: &Body) -> Option<f64> {
        day(&self.text(body, &self.own("date"))?)
    }

    /// The main conditions in words.
    pub fn main_in_words(&self) -> &str {
        self.conditions.get(self.main).map_or("", |condition| &condition.words)
    }
}

/// The columns of what varies between the rows of a body: all of the place but its own.
fn conditions(kind: Kind, rows: &Rows) -> Vec<usize> {
    let end = rows.column("contact_angle_deg").unwrap_or(rows.columns.len().min(9));
    let own = |column: &str| match kind {
        Kind::Wheel => column == "wheel" || column == "tape_diameter_m" || column.starts_with("wheel_"),
        Kind::Rail => column == "rail" || column == "rail_inclination" || column.starts_with("rail_"),
    };
    (0..end)
        .filter(|column| !own(&rows.columns[*column]))
        .filter(|column| rows.rows.iter().any(|row| row[*column] != rows.rows[0][*column]))
        .collect()
}

/// Values of columns in words, with their units.
fn in_words<'t>(values: impl Iterator<Item = (&'t str, &'t String)>) -> String {
    let word = |(column, value): (&str, &String)| match column {
        "shift_mm" => format!("shift {value} mm"),
        "rail" | "wheel" => value.to_string(),
        "rail_inclination" => format!("inclination {value}"),
        "gauge_mm" => format!("gauge {value} mm"),
        "side" => format!("{value} side"),
        "tape_diameter_m" => format!("diameter {value} m"),
        _ => format!("{} {value}", column.replace('_', " ")),
    };
    with_minus_signs(&values.map(word).collect::<Vec<String>>().join(", "))
}

/// Days from 1970-01-01 to a date as ISO 8601 writes it: 2026-03-31, whatever follows.
fn day(text: &str) -> Option<f64> {
    let mut parts = text.get(..10)?.split('-');
    let mut next = || parts.next()?.parse::<i64>().ok();
    let (year, month, day) = (next()?, next()?, next()?);
    if !((1..=12).contains(&month) && (1..=31).contains(&day)) {
        return None;
    }
    // the year begins in March, so that the day of February is its last
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leap = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    Some((365 * year + leap + (153 * month + 2) / 5 + day - 1 - 719_468) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the calendar: 1970 to 2000 are 30 years with 7 leap days. Goal: days of dates, also around a leap day; other texts are no date.
    #[test]
    fn days_of_dates() {
        let days = ["1970-01-01", "2000-01-01", "2024-03-01T06:00", "2024-02-29"].map(day);
        assert_eq!(days, [Some(0.0), Some(10_957.0), Some(19_783.0), Some(19_782.0)]);
        assert_eq!(["", "March", "2024-13-01", "2024/03/01", "äöüäöüäöü"].map(day), [None; 5]);
    }
}
