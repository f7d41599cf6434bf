//! Dates as they are written, in ISO 8601.

/// Names of the months by their first three letters.
const MONTHS: [&str; 12] =
    ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];

/// A date, with a time of day behind it if there is one, in ISO 8601; none where it can be read in two ways, or is none.
///
/// Points stand between day, month and year in this order. With slashes or dashes that order is certain only where the other one is no date.
pub(super) fn iso(text: &str) -> Option<String> {
    let text = text.trim();
    let (date, time) = match time_of_day(text) {
        Some(at) => (text[..at].trim_end_matches(['T', ' ']), Some(text[at..].trim())),
        None => (text, None),
    };
    let [year, month, day] = year_month_day(date)?;
    let date = format!("{year:04}-{month:02}-{day:02}");
    Some(time.map_or(date.clone(), |time| format!("{date}T{time}")))
}

/// Where a time of day, `HH:MM` or `HH:MM:SS`, begins at the end of a text.
fn time_of_day(text: &str) -> Option<usize> {
    let at = text.rfind(['T', ' '])? + 1;
    let parts: Vec<&str> = text[at..].split(':').collect();
    let is_number = |(part, most): (&&str, u32)| {
        part.len() == 2
            && part.bytes().all(|c| c.is_ascii_digit())
            && part.parse().is_ok_and(|n: u32| n < most)
    };
    ((2..=3).contains(&parts.len()) && parts.iter().zip([24, 60, 60]).all(is_number)).then_some(at)
}

fn year_month_day(text: &str) -> Option<[u32; 3]> {
    let digits = |text: &str| text.bytes().all(|c| c.is_ascii_digit()) && !text.is_empty();
    let number = |text: &str| digits(text).then(|| text.parse::<u32>().ok()).flatten();
    if text.len() == 8 && digits(text) {
        return valid([number(&text[..4])?, number(&text[4..6])?, number(&text[6..])?]);
    }
    let words: Vec<&str> = text.split([' ', ',', '.', '-', '/']).filter(|word| !word.is_empty()).collect();
    let [a, b, c] = words[..] else { return None };
    let month = |word: &str| {
        let begin: String = word.chars().take(3).flat_map(char::to_lowercase).collect();
        let is_word = word.chars().all(char::is_alphabetic);
        MONTHS.iter().position(|month| is_word && *month == begin).map(|at| at as u32 + 1)
    };
    match (a.len(), c.len(), month(a), month(b)) {
        (_, 4, None, Some(month)) => valid([number(c)?, month, number(a)?]),
        (_, 4, Some(month), None) => valid([number(c)?, month, number(b)?]),
        (4, _, None, None) => valid([number(a)?, number(b)?, number(c)?]),
        (_, 4, None, None) => {
            let day_first = valid([number(c)?, number(b)?, number(a)?]);
            let month_first = valid([number(c)?, number(a)?, number(b)?]);
            match (day_first, month_first) {
                (Some(day_first), _) if text.contains('.') => Some(day_first),
                (Some(one), Some(other)) if one != other => None,
                (one, other) => one.or(other),
            }
        }
        _ => None,
    }
}

/// The date, if the calendar has it.
fn valid([year, month, day]: [u32; 3]) -> Option<[u32; 3]> {
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        2 if leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    };
    ((1900..2200).contains(&year) && (1..=12).contains(&month) && (1..=days).contains(&day))
        .then_some([year, month, day])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: ISO 8601. Goal: dates that can be read in one way are in its form, others are left.
    #[test]
    fn dates_without_doubt_are_iso() {
        for (text, expected) in [
            ("2024-05-12", "2024-05-12"),
            ("2024/5/12", "2024-05-12"),
            ("20240512", "2024-05-12"),
            ("12.05.2024", "2024-05-12"),
            ("1.2.2024", "2024-02-01"),
            ("13/05/2024", "2024-05-13"),
            ("05-13-2024", "2024-05-13"),
            ("5/5/2024", "2024-05-05"),
            ("12 May 2024", "2024-05-12"),
            ("12-Sep-2024", "2024-09-12"),
            ("June 3, 2024", "2024-06-03"),
            ("12.05.2024 10:24", "2024-05-12T10:24"),
            ("2024-05-12T10:24:33", "2024-05-12T10:24:33"),
            ("29.02.2024", "2024-02-29"),
        ] {
            assert_eq!(iso(text).as_deref(), Some(expected), "{text}");
        }
        for text in ["05/06/2024", "12.05.24", "29.02.2023", "2024-13-01", "yesterday", "", "12345678", "1 2"]
        {
            assert_eq!(iso(text), None, "{text}");
        }
    }
}
