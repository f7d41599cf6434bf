//! Columns of a CSV file as a table: name with its unit, what it means, and where its value comes from. File, schema and reference page
//! follow from it.

use std::borrow::Cow;

use serde::Serialize;
use serde_json::{Map, Value, json};

/// What a spreadsheet takes for the beginning of a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

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

/// A text as a cell of a CSV file: a spreadsheet takes one that begins with `=`, `+`, `-`, `@`, a tab or a carriage return for a formula, which
/// may call other programs. So a quote comes before it, which shows it as a text. Numbers stay as they are.
pub fn defused(text: &str) -> Cow<'_, str> {
    match is_formula(text) {
        true => format!("'{text}").into(),
        false => text.into(),
    }
}

/// A sign by itself, as in the place of a name, calls nothing.
fn is_formula(text: &str) -> bool {
    text.starts_with(FORMULA) && text.len() > 1 && text.parse::<f64>().is_err()
}

/// The text that [`defused`] made a cell of.
pub fn as_given(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|text| is_formula(text)).unwrap_or(cell)
}

/// The CSV file of rows, with the names of the columns first.
pub fn csv<T>(columns: &[Column<T>], rows: &[T]) -> Vec<u8> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    let written = writer.write_record(columns.iter().map(|column| column.name)).and_then(|()| {
        rows.iter().try_for_each(|row| {
            let cell = |column: &Column<T>| match (column.value)(row) {
                Cell::Text(text) => Cell::Text(defused(&text).into_owned()),
                number => number,
            };
            writer.serialize(columns.iter().map(cell).collect::<Vec<Cell>>())
        })
    });
    written.expect("rows of numbers and texts are written to memory");
    writer.into_inner().expect("memory has room")
}

/// Rows of texts as CSV; the first has the names of the columns.
pub fn csv_of_texts<R: IntoIterator<Item: AsRef<str>>>(rows: impl IntoIterator<Item = R>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = rows.into_iter().try_for_each(|row| {
        row.into_iter().try_for_each(|cell| writer.write_field(defused(cell.as_ref()).as_bytes()))?;
        writer.write_record(None::<&[u8]>)
    });
    written.expect("a row goes into memory");
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: OWASP, CSV injection. Goal: a text that a spreadsheet would run stands behind a quote in both ways to write a row, and is read back as it
    /// was given; numbers, also negative ones, and texts with such a letter further on stay.
    #[test]
    fn formulas_are_defused() {
        let kept = ["-1.5", "+2e3", "-inf", "S1002", "a=b", "", "-", "'quoted"];
        let formulas = ["=1+1", "@SUM(1)|cmd", "+A1", "-A1", "\t=1", "\r=1"];
        for text in kept {
            assert_eq!((defused(text).as_ref(), as_given(text)), (text, text));
        }
        for text in formulas {
            assert_eq!(defused(text), format!("'{text}"));
            assert_eq!(as_given(&defused(text)), text);
        }
        let of_texts = csv_of_texts([vec!["=1", "-2"], vec!["a", "b"]]);
        assert_eq!(String::from_utf8(of_texts).unwrap(), "'=1,-2\na,b\n");
        let columns = columns! { &str:
            "name", "", |text| (*text).to_owned();
            "number", "", |_at| -2.0;
        };
        assert_eq!(String::from_utf8(csv(&columns, &["=1"])).unwrap(), "name,number\n'=1,-2.0\n");
    }
}
