//! The text of a profile file: encodings, lines, fields and numbers, and errors that name line and column.

use crate::error::{Error, InputError, Result};
use crate::units::MILLIMETRE;

/// Largest profile file that is read, bytes.
pub const LARGEST_FILE: u64 = 256 << 20;

/// Most fields of a row.
const MOST_FIELDS: usize = 16;
/// Quotes that are taken off a field.
const QUOTES: [char; 2] = ['"', '\''];
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
    InputError::new(format!("{name}:{line}:{column}"), format!("\"{}\"", cut(value, 60)), expected, remedy)
        .into()
}

/// The same where a line begins.
pub(super) fn error_on(
    name: &str,
    line: usize,
    value: &str,
    expected: impl Into<String>,
    remedy: impl Into<String>,
) -> Error {
    error_at(name, line, 1, value, expected, remedy)
}

/// Text of a file: UTF-8 with or without byte-order mark, UTF-16 with one or recognised by its zeros, else Windows-1252,
/// which has Latin-1 in it.
///
/// # Errors
/// A file that is too large or is no text.
pub fn decode(name: &str, bytes: &[u8]) -> Result<String> {
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(error_on(
            name,
            1,
            &format!("{} MiB", bytes.len() >> 20),
            format!("a profile file of at most {} MiB", LARGEST_FILE >> 20),
            "give a single profile, thinned out",
        ));
    }
    let utf16 = |bytes: &[u8], order: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).map(|pair| order([pair[0], pair[1]]));
        char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect::<String>()
    };
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ if all_zero(bytes, 1) => utf16(bytes, u16::from_le_bytes),
        _ if all_zero(bytes, 0) => utf16(bytes, u16::from_be_bytes),
        _ => {
            let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            match std::str::from_utf8(bytes) {
                Ok(text) => text.to_owned(),
                Err(_) => bytes.iter().map(|&byte| windows_1252(byte)).collect(),
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

/// Whether nearly every second byte from `first` on is zero and hardly any other: UTF-16 of a Western language.
fn all_zero(bytes: &[u8], first: usize) -> bool {
    const LEAST: usize = 8;
    const NEARLY: f64 = 0.95;
    let zeros = |first: usize| bytes.iter().skip(first).step_by(2).filter(|byte| **byte == 0).count() as f64;
    let half = (bytes.len() / 2) as f64;
    bytes.len() >= LEAST && zeros(first) > NEARLY * half && zeros(1 - first) < (1.0 - NEARLY) * half
}

/// A character of Windows-1252; the five codes that it leaves open are those of Latin-1.
fn windows_1252(byte: u8) -> char {
    /// The characters from 0x80 to 0x9f.
    const HIGH: &str = "\u{20ac}\u{81}\u{201a}\u{192}\u{201e}\u{2026}\u{2020}\u{2021}\u{2c6}\u{2030}\u{160}\u{2039}\u{152}\
                        \u{8d}\u{17d}\u{8f}\u{90}\u{2018}\u{2019}\u{201c}\u{201d}\u{2022}\u{2013}\u{2014}\u{2dc}\u{2122}\
                        \u{161}\u{203a}\u{153}\u{9d}\u{17e}\u{178}";
    match byte {
        0x80..=0x9f => HIGH.chars().nth(usize::from(byte - 0x80)).unwrap_or(char::from(byte)),
        _ => char::from(byte),
    }
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

/// Fields of a row, separated by blanks, tabs, semicolons, and commas unless these are decimal marks, which a comma beside
/// a quote never is. Two marks with nothing between them enclose an empty field; quotes around a field are taken off. At
/// most [`MOST_FIELDS`] are returned.
pub(super) fn fields(line: &str, mark: DecimalMark) -> Vec<Field<'_>> {
    let quoted_at = |index: usize| line[..index].ends_with('"') || line[index + 1..].starts_with('"');
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
        let delimits = c == ';' || (c == ',' && (mark == DecimalMark::Point || quoted_at(index)));
        if !quoted && (c.is_whitespace() || delimits) {
            if let Some((begin, at)) = start.take() {
                found.push(Field { text: line[begin..index].trim_matches(QUOTES), column: at });
                after_delimiter = false;
            }
            if delimits {
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
        found.push(Field { text: line[begin..].trim_matches(QUOTES), column: at });
    }
    found
}

/// A finite number; with Fortran's exponents (1.5D+01, 1.5+01), the decimal mark of the file, and a dash that an editor has
/// put for a minus.
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
            '+' | '-' | '\u{2212}' | '\u{2013}' => {
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

/// A finite number with either decimal mark.
pub(super) fn number_with_any_mark(text: &str) -> Option<f64> {
    number(text, DecimalMark::Point).or_else(|| number(text, DecimalMark::Comma))
}

/// The line up to a `!` or `%` outside quotes, which starts a comment, and whether a quote is left open.
pub(super) fn before_comment(line: &str) -> (&str, bool) {
    let mut quote = None;
    for (index, c) in line.char_indices() {
        match (c, quote) {
            ('!' | '%', None) => return (&line[..index], false),
            ('\'' | '"', None) => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            _ => {}
        }
    }
    (line, quote.is_some())
}

/// Names of columns: between semicolons, commas and tabs, or else between blanks and without what is in brackets there.
pub(super) fn column_names(line: &str) -> Vec<&str> {
    let marks = [';', ',', '\t'];
    let names: Vec<&str> = if line.contains(marks) {
        line.split(marks).collect()
    } else {
        line.split_whitespace().filter(|name| !name.starts_with(['[', '('])).collect()
    };
    names.into_iter().map(|name| name.trim_matches([' ', '"', '\''])).collect()
}

/// Whether a line begins like a row of numbers.
pub(super) fn begins_like_a_number(line: &str) -> bool {
    let line = line.trim_start();
    let digits = line.trim_start_matches(['+', '-', '\u{2212}', '\u{2013}', '.', ',', '"', '\'', '(', '[']);
    line.chars().count() - digits.chars().count() <= 4 && digits.starts_with(|c: char| c.is_ascii_digit())
}

/// Tells the decimal mark from the rows of numbers of a file.
///
/// # Errors
/// Rows in which commas might both separate fields and mark decimals; rows with either mark.
pub(super) fn decimal_mark<'a>(
    name: &str,
    rows: impl Iterator<Item = (usize, &'a str)> + Clone,
) -> Result<DecimalMark> {
    let mut points = None;
    let mut commas = None;
    for (line, row) in rows.clone() {
        let numbers = row
            .split(|c: char| c.is_whitespace() || [';', '"', '\''].contains(&c))
            .filter(|part| {
                part.split(',').all(|part| part.is_empty() || number(part, DecimalMark::Point).is_some())
            })
            .filter(|part| part.contains(|c: char| c.is_ascii_digit()));
        let several = numbers.clone().count() > 1;
        if numbers.clone().any(|part| part.contains('.') && (several || part.contains(','))) {
            points = points.or(Some((line, row)));
        } else if several && numbers.clone().any(with_decimal_comma) {
            commas = commas.or(Some((line, row)));
        }
    }
    match (points, commas) {
        (Some(_), None) => return Ok(DecimalMark::Point),
        (None, Some(_)) => return Ok(DecimalMark::Comma),
        (Some(point), Some(comma)) => {
            // The later one is most likely the odd one out.
            let (line, row) = if point.0 > comma.0 { point } else { comma };
            return Err(error_on(
                name,
                line,
                row.trim(),
                format!("one decimal mark: line {} has the other", point.0.min(comma.0)),
                "write all numbers with a decimal point",
            ));
        }
        (None, None) => {}
    }
    for (line, row) in rows {
        let row = row.trim();
        let by_commas = row.split(',').collect::<Vec<_>>();
        let digits_around = by_commas.windows(2).any(|pair| {
            pair[0].ends_with(|c: char| c.is_ascii_digit())
                && pair[1].starts_with(|c: char| c.is_ascii_digit())
        });
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

/// The mark between thousands in a number with decimals, such as `-36,733.2`, `1.463,267` or `1'463.267`.
fn mark_of_thousands(part: &str) -> Option<char> {
    let part = part.trim().trim_matches(QUOTES).trim_start_matches(['+', '-', '\u{2212}', '\u{2013}']);
    let (whole, decimals) = part.rsplit_once(['.', ','])?;
    let decimal = part[whole.len()..].chars().next()?;
    let mark = whole.chars().find(|c| !c.is_ascii_digit())?;
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let mut groups = whole.split(mark);
    let first = groups.next().is_some_and(|group| digits(group) && group.len() <= 3);
    let known = [',', '.', '\'', '\u{2019}'].contains(&mark) && mark != decimal;
    (known && first && digits(decimals) && groups.all(|group| digits(group) && group.len() == 3))
        .then_some(mark)
}

/// The text without the marks between thousands, if its numbers with decimals have one, with the first line that does. Only numbers between semicolons
/// or tabs are looked at: between commas a mark would be a separator.
pub(super) fn without_thousands(text: &str) -> Option<(usize, String)> {
    let separators = [';', '\t'];
    let parts = |line| str::split(line, separators);
    let rows = || lines(text).filter(|(_, line)| line.contains(separators) && begins_like_a_number(line));
    let (first, mark) = rows().find_map(|(n, line)| Some((n, parts(line).find_map(mark_of_thousands)?)))?;
    let without = |line: &str| -> String {
        let cleared = |part: &str| match mark_of_thousands(part) {
            Some(found) if found == mark => part.replace(mark, ""),
            _ => part.to_owned(),
        };
        // The separators keep their place: each part ends with the one that follows it.
        line.split_inclusive(separators)
            .map(|part| match part.strip_suffix(separators) {
                Some(bare) => cleared(bare) + &part[bare.len()..],
                None => cleared(part),
            })
            .collect()
    };
    let all = text.split('\n').map(|line| {
        if line.contains(separators) && begins_like_a_number(line) { without(line) } else { line.to_owned() }
    });
    Some((first, all.collect::<Vec<_>>().join("\n")))
}

/// Whether a part of a row without blanks is one number with decimals after a comma.
fn with_decimal_comma(part: &str) -> bool {
    let sides: Vec<&str> = part.split(',').collect();
    matches!(sides[..], [before, after]
        if before.ends_with(|c: char| c.is_ascii_digit()) && after.starts_with(|c: char| c.is_ascii_digit()))
}

/// Length of a unit, m, by its sign or name.
pub(super) fn unit_of(word: &str) -> Option<f64> {
    Some(match word.to_lowercase().as_str() {
        "um" | "\u{b5}m" | "\u{3bc}m" => 1e-6,
        "mm" | "millimetre" | "millimeter" | "millimetres" | "millimeters" => MILLIMETRE,
        "cm" => 1e-2,
        "m" | "metre" | "meter" | "metres" | "meters" => 1.0,
        "in" | "inch" | "inches" | "zoll" => 25.4 * MILLIMETRE,
        _ => return None,
    })
}

/// Text of a file for a message: short, without control characters.
pub(super) fn shown(text: &str) -> String {
    cut(text.trim(), 40)
}

/// At most about `longest` characters of a text, cut after a word, without control characters.
fn cut(text: &str, longest: usize) -> String {
    let escaped = |text: &str| -> String { text.chars().flat_map(char::escape_debug).collect() };
    let Some((at, _)) = text.char_indices().nth(longest) else { return escaped(text) };
    let words = text[..at].trim_end();
    // A word that is longer than half of the text is cut as it is.
    let whole = match text[at..].starts_with(char::is_whitespace) {
        true => words,
        false => {
            words.rfind(char::is_whitespace).filter(|i| 2 * i > at).map_or(words, |i| words[..i].trim_end())
        }
    };
    format!("{}\u{2026}", escaped(whole))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_between_thousands_are_left_out_where_they_are_certain() {
        for (text, expected) in [
            ("y;z\n-36,733.2;28,996.0\n1.5;2.25\r\n", Some("y;z\n-36733.2;28996.0\n1.5;2.25\r\n")),
            ("1.463,267\t-28,996\n", Some("1463,267\t-28,996\n")),
            ("1'463.267;28.996", Some("1463.267;28.996")),
            ("1,463.267;28.996;2'000.5", Some("1463.267;28.996;2'000.5")),
            ("12,345.678\n", None),
            ("1,46.2;3.0", None),
            ("1463.267;28.996", None),
            ("-36,733;28,996", None),
        ] {
            let found = without_thousands(text).map(|(_, text)| text);
            assert_eq!(found.as_deref(), expected, "{text}");
        }
    }

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
            ("\u{2013}2.", Point, -2.0),
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
        let found = fields("\"1,5\",\"2,5\"", DecimalMark::Comma);
        assert_eq!(found.iter().map(|f| f.text).collect::<Vec<_>>(), ["1,5", "2,5"]);
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
        // Words after the numbers have marks of their own.
        assert_eq!(mark(&["1,5 2,5 o.k.", "0,1 3 1.Lauf"]).unwrap(), DecimalMark::Comma);
        assert_eq!(mark(&["\"1,5\",\"2,5\""]).unwrap(), DecimalMark::Comma);
        let message = mark(&["1.5 2.5", "1,5 2,5"]).unwrap_err().to_string();
        assert!(message.starts_with("f:2:1 = ") && message.contains("line 1 has the other"), "{message}");
        let message = mark(&["3,4", "1,5,2,5"]).unwrap_err().to_string();
        assert!(message.starts_with("f:2:2 = "), "{message}");
    }

    #[test]
    fn encodings_are_decoded() {
        assert_eq!(decode("f", b"\xef\xbb\xbf1 2").unwrap(), "1 2");
        assert_eq!(decode("f", b"\xff\xfe1\0 \x002\0").unwrap(), "1 2");
        assert_eq!(decode("f", b"\xfe\xff\x001\0 \x002").unwrap(), "1 2");
        assert_eq!(decode("f", b"1\0 \x002\0\n\x003\0").unwrap(), "1 2\n3");
        assert_eq!(decode("f", b"\x001\0 \x002\0\n\x003").unwrap(), "1 2\n3");
        assert_eq!(decode("f", b"caf\xe9\r1").unwrap(), "caf\u{e9}\n1");
        assert_eq!(decode("f", b"\x961 \x80").unwrap(), "\u{2013}1 \u{20ac}");
        assert!(decode("f", b"1 2\n3\0").unwrap_err().to_string().starts_with("f:2:2 = "));
    }
}
