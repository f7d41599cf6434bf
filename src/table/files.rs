//! Files that a table names, and lists in CSV among them.

use std::path::{Path, PathBuf};

use railspring_profiles::error::InputError;
use railspring_profiles::input;
use railspring_profiles::profile_file::{LARGEST_FILE, decode};

/// A file as the table names it.
pub(super) fn beside(table: &Path, file: &str) -> PathBuf {
    table.parent().unwrap_or(Path::new("")).join(file)
}

/// A list in a CSV file with a header.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct List {
    /// Names of the columns.
    pub header: Vec<String>,
    /// Lines of the file with their fields, as many as there are columns.
    pub rows: Vec<(u64, Vec<String>)>,
}

impl List {
    /// Reads the file that a table names; `key` is the key that names it.
    ///
    /// # Errors
    /// [`InputError`] for a file that cannot be read, or is no CSV.
    pub fn read(table: &Path, file: &str, key: &str) -> Result<Self, InputError> {
        let path = beside(table, file);
        let refused = |cause: String| {
            let expected =
                format!("a CSV file with the names of its columns first; {}: {cause}", path.display());
            InputError::new(key, format!("{file:?}"), expected, "give its path relative to the table")
        };
        let bytes = input::read(&path, LARGEST_FILE).map_err(|cause| refused(cause.to_string()))?;
        let text = decode(file, &bytes).map_err(|cause| refused(cause.to_string()))?;
        Self::parse(&text).map_err(refused)
    }

    /// The list in a text; its first line shows whether tabs, semicolons or commas separate the fields.
    fn parse(text: &str) -> Result<Self, String> {
        let first = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
        let separates = ['\t', ';', ','].into_iter().find(|mark| first.contains(*mark)).unwrap_or(',');
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(separates as u8)
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let header: Vec<String> =
            reader.headers().map_err(|cause| cause.to_string())?.iter().map(str::to_owned).collect();
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|cause| cause.to_string())?;
            let line = record.position().map_or(0, |at| line_of(text, at));
            let mut fields: Vec<String> = record.iter().map(str::to_owned).collect();
            if fields[header.len().min(fields.len())..].iter().any(|field| !field.is_empty()) {
                return Err(format!(
                    "line {line} has {} fields, the first line {}",
                    fields.len(),
                    header.len()
                ));
            }
            if fields.iter().any(|field| !field.is_empty()) {
                fields.resize(header.len(), String::new());
                rows.push((line, fields));
            }
        }
        Ok(Self { header, rows })
    }

    /// Number of the column of a name, whatever its case.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column.eq_ignore_ascii_case(name))
    }
}

/// Line of a record, which is said to begin with the empty lines before it.
fn line_of(text: &str, at: &csv::Position) -> u64 {
    let from = text.as_bytes().get(at.byte() as usize..).unwrap_or_default();
    let empty = from.iter().take_while(|byte| matches!(byte, b'\n' | b'\r'));
    at.line() + empty.filter(|byte| **byte == b'\n').count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: commas, semicolons and tabs are told apart by the first line; quotes and missing last fields are understood, empty lines passed over;
    /// too many fields are said with their line.
    #[test]
    fn lists_are_read_as_they_are_written() {
        let rows = |text: &str| List::parse(text).map(|list| list.rows);
        let expected =
            Ok(vec![(2, vec!["a".to_owned(), "1,5".into()]), (4, vec!["b".into(), String::new()])]);
        assert_eq!(rows("file;km\na;1,5\n\nb\n"), expected);
        assert_eq!(rows("file\tkm\na\t1,5\n\nb\t\n"), expected);
        assert_eq!(rows("file,km\n\"a\",\"1,5\"\n\nb,,\n"), expected);
        assert!(rows("file,km\na,1,5\n").unwrap_err().contains("line 2 has 3 fields"));
        assert_eq!(List::parse("x;File\n").unwrap().column("file"), Some(1));
        assert_eq!(rows(""), Ok(Vec::new()));
    }
}
