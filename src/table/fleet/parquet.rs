//! `table.parquet`: the rows of `table.csv` for programs that read columns.

use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::engine::columns::Cell;
use crate::table::rows::Rows;

/// Rows of a group: what a reader takes at once.
const GROUP: usize = 10_000;

/// The rows as Parquet: numbers as doubles, texts as UTF-8, nothing where a cell is empty; compressed with Snappy.
///
/// The bytes follow from the rows alone.
///
/// # Panics
/// Never for rows of a table: writing to memory cannot fail.
pub fn parquet(rows: &Rows) -> Vec<u8> {
    written(rows).expect("rows of numbers and texts are written to memory")
}

fn written(rows: &Rows) -> Result<Vec<u8>> {
    let has_text: Vec<bool> = (0..rows.columns.len()).map(|column| is_text(rows, column)).collect();
    let fields = rows.columns.iter().zip(&has_text).map(|(name, text)| {
        let field = match text {
            true => Type::primitive_type_builder(name, Physical::BYTE_ARRAY)
                .with_logical_type(Some(LogicalType::String)),
            false => Type::primitive_type_builder(name, Physical::DOUBLE),
        };
        field.with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
    });
    let schema = Type::group_type_builder("table").with_fields(fields.collect::<Result<_>>()?).build()?;
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    for group in rows.rows.chunks(GROUP) {
        let mut out = writer.next_row_group()?;
        for (column, text) in has_text.iter().enumerate() {
            let Some(mut into) = out.next_column()? else { break };
            let cells = || group.iter().map(|row| &row[column]);
            // of each row, whether it has a value
            let there: Vec<i16> = cells().map(|cell| i16::from(has_value(cell))).collect();
            match text {
                true => {
                    let values: Vec<ByteArray> = cells()
                        .filter(|cell| has_value(cell))
                        .map(|cell| cell.text().into_bytes().into())
                        .collect();
                    into.typed::<ByteArrayType>().write_batch(&values, Some(&there), None)?;
                }
                false => {
                    let values: Vec<f64> = cells().filter_map(Cell::number).collect();
                    into.typed::<DoubleType>().write_batch(&values, Some(&there), None)?;
                }
            }
            into.close()?;
        }
        out.close()?;
    }
    writer.into_inner()
}

/// Whether a column has texts: one, or nothing but empty ones.
fn is_text(rows: &Rows, column: usize) -> bool {
    let cells = || rows.rows.iter().map(|row| &row[column]);
    let is_text = |cell: &Cell| matches!(cell, Cell::Text(_));
    cells().any(|cell| is_text(cell) && has_value(cell))
        || cells().all(|cell| cell.number().is_none()) && cells().any(is_text)
}

fn has_value(cell: &Cell) -> bool {
    match cell {
        Cell::Number(number) => number.is_some(),
        Cell::Text(text) => !text.is_empty(),
    }
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;

    /// 25,000 rows of three columns: a text, a number with gaps, and reasons that are mostly empty.
    fn rows() -> Rows {
        let row = |n: usize| {
            let number = (!n.is_multiple_of(7)).then_some(n as f64 / 3.0);
            let reason = if n.is_multiple_of(1000) { "off the rail, früh" } else { "" };
            vec![Cell::from(format!("wheel {}", n / 10)), number.into(), reason.into()]
        };
        let columns = ["wheel", "k_kn_per_m", "reason"].map(String::from).to_vec();
        Rows { columns, rows: (0..25_000).map(row).collect(), metadata: 0..0 }
    }

    /// Source: the reader of the same library. Goal: every value comes back to the last bit, empty cells as nothing, in groups of 10,000 rows.
    #[test]
    fn what_is_written_is_read() {
        let rows = rows();
        let bytes = parquet(&rows);
        // for looking at the file with another program
        if let Some(folder) = std::env::var_os("RAILSPRING_SAMPLE_REPORT") {
            std::fs::write(std::path::Path::new(&folder).join("table.parquet"), &bytes).unwrap();
        }
        assert_eq!(bytes, parquet(&rows), "the same bytes each time");
        let mut file = tempfile::tempfile().unwrap();
        std::io::Write::write_all(&mut file, &bytes).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        assert_eq!(reader.num_row_groups(), 3);
        let mut count = 0;
        for (read, row) in reader.get_row_iter(None).unwrap().zip(&rows.rows) {
            for ((name, field), (expected, cell)) in
                read.unwrap().get_column_iter().zip(rows.columns.iter().zip(row))
            {
                assert_eq!(name, expected);
                match field {
                    Field::Null => assert!(!has_value(cell)),
                    Field::Double(value) => assert_eq!(Some(*value), cell.number()),
                    Field::Str(text) => assert_eq!(*text, cell.text()),
                    other => panic!("{other:?}"),
                }
            }
            count += 1;
        }
        assert_eq!(count, 25_000);
    }

    /// Goal: a column of numbers and texts is one of texts, one of numbers and empty texts is one of numbers; one without any value is what its cells are; no rows are a file.
    #[test]
    fn columns_have_one_type() {
        let columns = ["mixed", "gap", "no number", "no text"].map(String::from).to_vec();
        let row = |mixed: Cell, gap: Cell| vec![mixed, gap, Cell::Number(None), "".into()];
        let rows = Rows {
            columns,
            rows: vec![row(1.5.into(), 2.5.into()), row("a".into(), "".into())],
            metadata: 0..0,
        };
        assert_eq!([0, 1, 2, 3].map(|column| is_text(&rows, column)), [true, false, false, true]);
        assert_eq!(&parquet(&rows)[..4], b"PAR1");
        assert_eq!(&parquet(&Rows { columns: Vec::new(), rows: Vec::new(), metadata: 0..0 })[..4], b"PAR1");
        let twice =
            Rows { columns: vec!["a".into(); 2], rows: vec![vec![1.0.into(), 2.0.into()]], metadata: 0..0 };
        assert_eq!(&parquet(&twice)[..4], b"PAR1");
    }
}
