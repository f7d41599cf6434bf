//! The text of a profile file: encodings, lines, fields and numbers, and errors that name line and column.

use super::LARGEST_FILE;
use crate::error::{Error, InputError, Result};

/// Most fields of a row.
const MOST_FIELDS: usize = 16;
/// Longest number, characters: a tiny one without exponent has more than 300.
const LONGEST_NUMBER: usize = 512;

/// An error at a place of a file; line and column count from one.
pub(super) fn error_at(
    name: &str,
    line: usize,
    column: usize,
    value: &str,
    expected: impl Into<String>,
    remedy: impl Into<String>,
) -> Error {
    let shown: String = value.chars().take(40).flat_map(char::escape_debug).collect();
    InputError::new(format!("{name}:{line}:{column}"), format!("\"{shown}\""), expected, remedy).into()
}

/// Text of a file: UTF-8 with or without byte-order mark, UTF-16 with one, else Latin-1.
///
/// # Errors
/// A file that is too large or is no text.
pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<String> {
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(error_at(
            name,
            1,
            1,
            &format!("{} MiB", bytes.len() >> 20),
            format!("a profile file of at most {} MiB", LARGEST_FILE >> 20),
            "give a single profile, thinned out",
        ));
    }
    let utf16 = |order: fn([u8; 2]) -> u16| {
        let units = bytes[2..].chunks_exact(2).map(|pair| order([pair[0], pair[1]]));
        char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect::<String>()
    };
    let text = match bytes {
        [0xff, 0xfe, ..] => utf16(u16::from_le_bytes),
        [0xfe, 0xff, ..] => utf16(u16::from_be_bytes),
        _ => {
            let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            match std::str::from_utf8(bytes) {
                Ok(text) => text.to_owned(),
                Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
            }
        }
    };
    // Files of old Macintosh programs end their lines with a carriage return alone.
    let text = if text.contains('\n') { text } else { text.replace('\r', "\n") };
    if let Some((line, column)) = place_of(&text, '\0') {
        return Err(error_at(name, line, column, "\0", "text", "the file is binary; export it as text"));
    }
    Ok(text)
}

fn place_of(text: &str, wanted: char) -> Option<(usize, usize)> {
    lines(text)
        .find_map(|(number, line)| line.chars().position(|c| c == wanted).map(|before| (number, before + 1)))
}

/// Lines with their numbers, counted from one, without their ends.
pub(super) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> + Clone {
    text.split('\n').enumerate().map(|(index, line)| (index + 1, line.strip_suffix('\r').unwrap_or(line)))
}

/// The character before the decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DecimalMark {
    Point,
    Comma,
}

/// A field of a row and the column in which it begins, counted from one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Field<'a> {
    pub text: &'a str,
    pub column: usize,
}

/// Fields of a row, separated by blanks, tabs, semicolons, and commas unless these are decimal marks. Two marks
/// with nothing between them enclose an empty field; quotes around a field are taken off. At most
/// [`MOST_FIELDS`] are returned.
pub(super) fn fields(line: &str, mark: DecimalMark) -> Vec<Field<'_>> {
    let delimits = |c: char| c == ';' || (c == ',' && mark == DecimalMark::Point);
    let mut found = Vec::new();
    let mut start: Option<(usize, usize)> = None;
    let mut after_delimiter = true;
    let mut quoted = false;
    let mut column = 0;
    for (index, c) in line.char_indices() {
        column += 1;
        if c == '"' {
            quoted = !quoted;
        }
        if !quoted && (c.is_whitespace() || delimits(c)) {
            if let Some((begin, at)) = start.take() {
                found.push(Field { text: line[begin..index].trim_matches('"'), column: at });
                after_delimiter = false;
            }
            if delimits(c) {
                if after_delimiter {
                    found.push(Field { text: "", column });
                }
                after_delimiter = true;
            }
            if found.len() >= MOST_FIELDS {
                return found;
            }
        } else if start.is_none() {
            start = Some((index, column));
        }
    }
    if let Some((begin, at)) = start {
        found.push(Field { text: line[begin..].trim_matches('"'), column: at });
    }
    found
}

/// A finite number; with Fortran's exponents (1.5D+01, 1.5+01) and the decimal mark of the file.
pub(super) fn number(text: &str, mark: DecimalMark) -> Option<f64> {
    if text.len() > LONGEST_NUMBER {
        return None;
    }
    let mut plain = String::with_capacity(text.len() + 1);
    let mut exponent = false;
    for c in text.chars() {
        match c {
            '0'..='9' | '.' => plain.push(c),
            ',' if mark == DecimalMark::Comma => plain.push('.'),
            'e' | 'E' | 'd' | 'D' => {
                exponent = true;
                plain.push('e');
            }
            '+' | '-' | '\u{2212}' => {
                if !exponent && plain.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
                    exponent = true;
                    plain.push('e');
                }
                plain.push(if c == '+' { '+' } else { '-' });
            }
            _ => return None,
        }
    }
    plain.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Whether a line begins like a row of numbers.
pub(super) fn begins_like_a_number(line: &str) -> bool {
    let line = line.trim_start();
    let digits = line.trim_start_matches(['+', '-', '\u{2212}', '.', ',', '"']);
    line.len() - digits.len() <= 4 && digits.starts_with(|c: char| c.is_ascii_digit())
}

/// Tells the decimal mark from the rows of numbers of a file.
///
/// # Errors
/// Rows in which commas might both separate fields and mark decimals.
pub(super) fn decimal_mark<'a>(
    name: &str,
    rows: impl Iterator<Item = (usize, &'a str)> + Clone,
) -> Result<DecimalMark> {
    if rows.clone().any(|(_, row)| row.contains('.')) {
        return Ok(DecimalMark::Point);
    }
    for (line, row) in rows {
        let row = row.trim();
        if !row.contains(',') {
            continue;
        }
        let by_commas = row.split(',').collect::<Vec<_>>();
        let digits_around = by_commas.windows(2).any(|pair| {
            pair[0].ends_with(|c: char| c.is_ascii_digit())
                && pair[1].starts_with(|c: char| c.is_ascii_digit())
        });
        let separated = by_commas.iter().any(|part| part.trim().contains([' ', '\t', ';']));
        if digits_around && separated {
            return Ok(DecimalMark::Comma);
        }
        if digits_around && by_commas.len() >= 4 {
            return Err(error_at(
                name,
                line,
                row.chars().take_while(|c| *c != ',').count() + 1,
                row,
                "a separator other than the decimal mark",
                "the commas may separate columns or mark decimals: separate the columns by semicolons",
            ));
        }
    }
    Ok(DecimalMark::Point)
}

/// The numbers of a row from the field `first` on, up to `count` of them; `least` must be there.
///
/// # Errors
/// A field that is no number, or too few of them.
pub(super) fn row_numbers(
    name: &str,
    line: usize,
    row: &str,
    mark: DecimalMark,
    least: usize,
) -> Result<Vec<f64>> {
    let fields = fields(row, mark);
    if fields.len() < least {
        let end = row.trim_end().chars().count() + 1;
        return Err(error_at(
            name,
            line,
            end,
            row.trim(),
            format!("at least {least} numbers"),
            "complete the row, or turn it into a comment",
        ));
    }
    fields
        .iter()
        .map(|field| {
            number(field.text, mark).ok_or_else(|| {
                error_at(
                    name,
                    line,
                    field.column,
                    field.text,
                    "a finite number",
                    "correct the row, or turn it into a comment",
                )
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_many_programs_are_understood() {
        use DecimalMark::{Comma, Point};
        for (text, mark, value) in [
            ("-4.3704898E+01", Point, -43.704898),
            ("+1.5D+01", Point, 15.0),
            ("1.5d-1", Point, 0.15),
            ("1.5-01", Point, 0.15),
            ("-1,25", Comma, -1.25),
            ("\u{2212}2.", Point, -2.0),
            (".5", Point, 0.5),
        ] {
            assert_eq!(number(text, mark), Some(value), "{text}");
        }
        for text in ["", "nan", "inf", "1e999", "1,5", "0x10", "1.2.3", "-", "1e", "e5", "+-1"] {
            assert_eq!(number(text, Point), None, "{text}");
        }
    }

    #[test]
    fn fields_know_their_columns() {
        let found = fields("  1,5\t;\"2,5\" ; ; x", DecimalMark::Comma);
        let texts: Vec<_> = found.iter().map(|f| (f.text, f.column)).collect();
        assert_eq!(texts, [("1,5", 3), ("2,5", 8), ("", 16), ("x", 18)]);
        assert_eq!(fields("1,2,", DecimalMark::Point).len(), 2);
    }

    #[test]
    fn decimal_commas_are_told_from_separators() {
        let mark = |rows: &'static [&'static str]| {
            decimal_mark("f", rows.iter().enumerate().map(|(i, row)| (i + 1, *row)))
        };
        assert_eq!(mark(&["1,5 2,5"]).unwrap(), DecimalMark::Comma);
        assert_eq!(mark(&["1,5;2"]).unwrap(), DecimalMark::Comma);
        assert_eq!(mark(&["1, 2"]).unwrap(), DecimalMark::Point);
        assert_eq!(mark(&["1,2"]).unwrap(), DecimalMark::Point);
        assert_eq!(mark(&["1.5,2,5"]).unwrap(), DecimalMark::Point);
        let message = mark(&["3,4", "1,5,2,5"]).unwrap_err().to_string();
        assert!(message.starts_with("f:2:2 = "), "{message}");
    }

    #[test]
    fn encodings_are_decoded() {
        assert_eq!(decode("f", b"\xef\xbb\xbf1 2").unwrap(), "1 2");
        assert_eq!(decode("f", b"\xff\xfe1\0 \x002\0").unwrap(), "1 2");
        assert_eq!(decode("f", b"caf\xe9\r1").unwrap(), "caf\u{e9}\n1");
        assert!(decode("f", b"1 2\n3\0").unwrap_err().to_string().starts_with("f:2:2 = "));
    }
}
