//! Columns of a CSV file as a table: name with its unit, what it means, and where its value comes from. File, schema and reference page
//! follow from it.

use serde::Serialize;
use serde_json::{Map, Value, json};

/// A value of a row.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// A number, in the unit that the column names; none is an empty cell.
    Number(Option<f64>),
    /// A text, which may be empty.
    Text(String),
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(Some(value))
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        Self::Number(value)
    }
}

impl From<&str> for Cell {
    fn from(value: &str) -> Self {
        Self::Text(value.into())
    }
}

impl From<String> for Cell {
    fn from(value: String) -> Self {
        Self::Text(value)
    }
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// A number in every row.
    Number,
    /// A number, or none.
    NumberOrNone,
    /// A text.
    Text,
}

/// A column of rows that are made from a `T`.
pub struct Column<T> {
    /// Its name, with its unit.
    pub name: &'static str,
    /// What it holds.
    pub holds: Holds,
    /// What it means.
    pub text: &'static str,
    /// Its value in a row.
    pub value: fn(&T) -> Cell,
}

/// The CSV file of rows, with the names of the columns first.
pub fn csv<T>(columns: &[Column<T>], rows: &[T]) -> Vec<u8> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    let written = writer.write_record(columns.iter().map(|column| column.name)).and_then(|()| {
        rows.iter().try_for_each(|row| {
            writer.serialize(columns.iter().map(|column| (column.value)(row)).collect::<Vec<Cell>>())
        })
    });
    written.expect("rows of numbers and texts are written to memory");
    writer.into_inner().expect("memory has room")
}

/// The JSON schema of a row.
pub fn schema<T>(title: &str, text: &str, columns: &[Column<T>]) -> Value {
    let property = |column: &Column<T>| {
        let of = match column.holds {
            Holds::Number => json!("number"),
            Holds::NumberOrNone => json!(["number", "null"]),
            Holds::Text => json!("string"),
        };
        (column.name.to_string(), json!({ "type": of, "description": column.text }))
    };
    let properties: Map<String, Value> = columns.iter().map(property).collect();
    json!({ "title": title, "description": text, "type": "object", "properties": properties })
}
