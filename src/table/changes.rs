//! What is different between a table and an earlier one.

use std::collections::BTreeMap;
use std::iter::once;

use railspring_profiles::error::{InputError, Result};

use super::earlier::Earlier;
use super::rows::{INPUTS, Rows};
use crate::engine::columns::{Cell, as_given, csv_of_texts};

/// A value that is another one now.
#[derive(Debug, Clone, PartialEq)]
pub struct Changed {
    /// The place: values of the columns that identify it.
    pub place: Vec<String>,
    /// The column.
    pub column: String,
    /// What it was, and what it is.
    pub values: [String; 2],
    /// By how much, relative to what it was; none for texts and where it was zero.
    pub relative: Option<f64>,
    /// Which inputs are others.
    pub because: String,
}

/// The differences between two tables.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Changes {
    /// Columns that identify a place in both.
    pub identity: Vec<String>,
    /// Places that the earlier table does not have.
    pub new: Vec<Vec<String>>,
    /// Places that only the earlier table has.
    pub gone: Vec<Vec<String>>,
    /// Values that are others.
    pub changed: Vec<Changed>,
    /// Places with such a value.
    pub places_changed: usize,
}

/// Compares a table with an earlier one.
///
/// # Errors
/// [`InputError`] for rows that are no table.
pub fn since(earlier: &Earlier, now: &Rows) -> Result<Changes> {
    let refused = |value: String, expected: &str| {
        InputError::new(
            earlier.path.display().to_string(),
            value,
            expected,
            "name a table.csv that `railspring table` has written",
        )
    };
    let mut reader = csv::Reader::from_reader(earlier.text.as_bytes());
    let header: Vec<String> = match reader.headers() {
        Ok(header) => header.iter().map(str::to_owned).collect(),
        Err(cause) => return Err(refused(cause.to_string(), "a table in CSV").into()),
    };
    // what comes before the contact angle says which place it is
    let end = |columns: &[String]| {
        columns.iter().position(|column| column == "contact_angle_deg").unwrap_or(columns.len())
    };
    // what is known of a measurement says nothing of the place, and is no result
    let known = &now.columns[now.metadata.clone()];
    let identity: Vec<String> = now.columns[..end(&now.columns)]
        .iter()
        .filter(|column| header[..end(&header)].contains(column) && !known.contains(column))
        .cloned()
        .collect();
    let numbers = |columns: &[String]| -> Vec<usize> {
        identity.iter().filter_map(|name| columns.iter().position(|column| column == name)).collect()
    };
    let (in_old, in_new) = (numbers(&header), numbers(&now.columns));
    let place = |numbers: &[usize], row: &[String]| -> Vec<String> {
        numbers.iter().map(|at| row.get(*at).cloned().unwrap_or_default()).collect()
    };
    // of each column its number in the earlier table, and whether it is a result
    let columns: Vec<(&String, Option<usize>, bool)> = now
        .columns
        .iter()
        .map(|name| {
            let is_input = INPUTS.iter().any(|(input, _)| input == name);
            let is_result = !identity.contains(name) && !is_input && !known.contains(name);
            (name, header.iter().position(|column| column == name), is_result)
        })
        .collect();
    let mut before: BTreeMap<Vec<String>, Vec<String>> = BTreeMap::new();
    for row in reader.records() {
        let row =
            row.map_err(|cause| refused(cause.to_string(), "rows of as many fields as there are columns"))?;
        let row: Vec<String> = row.iter().map(|cell| as_given(cell).to_owned()).collect();
        before.insert(place(&in_old, &row), row);
    }
    let mut changes = Changes { identity: identity.clone(), ..Changes::default() };
    for row in &now.rows {
        let row: Vec<String> = row.iter().map(Cell::text).collect();
        let here = place(&in_new, &row);
        let Some(old) = before.remove(&here) else {
            changes.new.push(here);
            continue;
        };
        let because = because(&columns, &row, &old);
        let count = changes.changed.len();
        for ((column, at, _), new) in columns.iter().zip(&row).filter(|((_, _, is_result), _)| *is_result) {
            let Some(old) = at.and_then(|at| old.get(at)).filter(|old| *old != new) else { continue };
            changes.changed.push(Changed {
                place: here.clone(),
                column: (*column).clone(),
                values: [old.clone(), new.clone()],
                relative: relative(old, new),
                because: because.clone(),
            });
        }
        changes.places_changed += usize::from(changes.changed.len() > count);
    }
    changes.gone = before.into_keys().collect();
    Ok(changes)
}

/// The inputs that are others, in words.
fn because(columns: &[(&String, Option<usize>, bool)], row: &[String], old: &[String]) -> String {
    let other = INPUTS.iter().filter(|(input, _)| {
        let of_it = columns.iter().zip(row).find(|((name, ..), _)| name == input);
        of_it.is_none_or(|((_, at, _), new)| at.and_then(|at| old.get(at)) != Some(new))
    });
    let other: Vec<&str> = other.map(|(_, meaning)| *meaning).collect();
    match other.is_empty() {
        true => "another build of the program".into(),
        false => other.join(", "),
    }
}

fn relative(old: &str, new: &str) -> Option<f64> {
    let (old, new): (f64, f64) = (old.parse().ok()?, new.parse().ok()?);
    (old != 0.0).then(|| new / old - 1.0)
}

impl Changes {
    /// The changes as CSV, a row for each value.
    pub fn csv(&self) -> Vec<u8> {
        let row = |place: &[String], rest: [&str; 6]| -> Vec<String> {
            place.iter().cloned().chain(rest.map(str::to_owned)).collect()
        };
        let header = ["change", "column", "before", "now", "relative_change", "because"];
        let new = self.new.iter().map(|place| row(place, ["new place", "", "", "", "", ""]));
        let gone = self.gone.iter().map(|place| row(place, ["place is gone", "", "", "", "", ""]));
        let changed =
            self.changed.iter().map(|Changed { place, column, values: [old, new], relative, because }| {
                let relative = relative.map_or_else(String::new, |relative| relative.to_string());
                row(place, ["value", column, old, new, &relative, because])
            });
        csv_of_texts(once(row(&self.identity, header)).chain(new).chain(gone).chain(changed))
    }

    /// The changes in a few lines: how many there are, and the largest.
    pub fn lines(&self) -> Vec<String> {
        const LISTED: usize = 10;
        let Self { new, gone, changed, places_changed, .. } = self;
        let mut lines = vec![format!(
            "since the earlier table: {places_changed} places with other values, {} new, {} gone",
            new.len(),
            gone.len()
        )];
        let mut by_size: Vec<&Changed> =
            changed.iter().filter(|changed| changed.column.starts_with("stiffness_kn_per_m_at_")).collect();
        let size = |changed: &Changed| changed.relative.map_or(f64::INFINITY, f64::abs);
        by_size.sort_by(|a, b| size(b).total_cmp(&size(a)));
        lines.extend(by_size.iter().take(LISTED).map(|changed| {
            let by =
                changed.relative.map_or_else(String::new, |relative| format!(" ({:+.2} %)", 1e2 * relative));
            let [old, new] = &changed.values;
            format!(
                "{}: {} {old} -> {new}{by}, because of {}",
                changed.place.join(", "),
                changed.column,
                changed.because
            )
        }));
        lines
    }
}
