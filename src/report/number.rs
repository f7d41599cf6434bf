//! Numbers and sizes that all figures and pages share.

use crate::rounding::with_minus_signs;

/// Width of the figures of a page, pixels.
pub const WIDTH: u32 = 860;

/// A number with four significant digits, without an exponent where it can be read without.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { value.to_string() };
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = if value.abs() >= 1e-6 { format!("{value:.digits$}") } else { format!("{value:.3e}") };
    let text = if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text
    };
    with_minus_signs(&grouped_by_thousands(&text))
}

/// Thin spaces between groups of three digits, from five digits on.
fn grouped_by_thousands(text: &str) -> String {
    let whole = text.trim_start_matches('-').chars().take_while(char::is_ascii_digit).count();
    if whole < 5 {
        return text.into();
    }
    let begin = text.len() - text.trim_start_matches('-').len();
    let mut grouped = text[..begin].to_string();
    for (index, digit) in text[begin..].chars().enumerate() {
        if index > 0 && index < whole && (whole - index).is_multiple_of(3) {
            grouped.push('\u{202f}');
        }
        grouped.push(digit);
    }
    grouped
}

/// A number without needless decimals.
pub fn round(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    format!("{rounded}")
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_short_and_readable() {
        let cases = [
            (0.0, "0"),
            (0.241104, "0.2411"),
            (-0.5, "\u{2212}0.5"),
            (294_000.0, "294\u{202f}000"),
            (-12_345.6, "\u{2212}12\u{202f}346"),
            (1234.5, "1234"),
            (6.2e-4, "0.00062"),
            (1.5e-9, "1.500e\u{2212}9"),
        ];
        for (value, expected) in cases {
            assert_eq!(number(value), expected, "{value}");
        }
    }
}
