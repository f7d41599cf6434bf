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

impl Cell {
    /// The cell of a row.
    pub fn of<T, V: CellValue>(row: &T, value: fn(&T) -> V) -> Self {
        value(row).into()
    }

    /// The value as a text; a number to the last bit, a whole one without a point.
    pub fn text(&self) -> String {
        match self {
            Self::Number(number) => number.map_or_else(String::new, |number| number.to_string()),
            Self::Text(text) => text.clone(),
        }
    }

    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => *number,
            Self::Text(_) => None,
        }
    }
}

/// What the cells of a column are made from; a number that is not finite is none.
pub trait CellValue: Into<Cell> {
    /// What such a column holds.
    const HOLDS: Holds;
}

/// A column's values by their type: what it holds, and the cell of a value.
macro_rules! values {
    ($($type:ty: $holds:ident, |$value:ident| $cell:expr;)*) => {$(
        impl From<$type> for Cell {
            fn from($value: $type) -> Self {
                $cell
            }
        }

        impl CellValue for $type {
            const HOLDS: Holds = Holds::$holds;
        }
    )*};
}

values! {
    f64: Number, |value| Some(value).into();
    Option<f64>: NumberOrNone, |value| Self::Number(value.filter(|value| value.is_finite()));
    &str: Text, |value| Self::Text(value.into());
    String: Text, |value| Self::Text(value);
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

impl Holds {
    /// What the values of a column are.
    pub fn of<T, V: CellValue>(_: fn(&T) -> V) -> Self {
        V::HOLDS
    }
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

/// A table of columns: of each its name with its unit, what it means, and its value in a row of this type.
macro_rules! columns {
    ($row:ty: $($name:literal, $text:literal, |$at:ident| $value:expr;)*) => {
        vec![$($crate::engine::columns::Column {
            name: $name,
            holds: $crate::engine::columns::Holds::of(|$at: &$row| $value),
            text: $text,
            value: |row| $crate::engine::columns::Cell::of(row, |$at: &$row| $value),
        }),*]
    };
}
pub(crate) use columns;

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

/// Rows of texts as CSV; the first has the names of the columns.
pub fn csv_of_texts<R: IntoIterator<Item: AsRef<[u8]>>>(rows: impl IntoIterator<Item = R>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.into_iter().try_for_each(|row| writer.write_record(row)).expect("a row goes into memory");
    writer.into_inner().expect("memory has room")
}

/// The JSON schema of a row with these [`properties`].
pub fn schema(title: &str, text: &str, properties: &Map<String, Value>) -> Value {
    json!({ "title": title, "description": text, "type": "object", "properties": properties })
}

/// The JSON schemas of the cells of a row.
pub fn properties<T>(columns: &[Column<T>]) -> Map<String, Value> {
    let property = |column: &Column<T>| {
        let of = match column.holds {
            Holds::Number => json!("number"),
            Holds::NumberOrNone => json!(["number", "null"]),
            Holds::Text => json!("string"),
        };
        (column.name.to_string(), json!({ "type": of, "description": column.text }))
    };
    columns.iter().map(property).collect()
}
