//! Numbers for a reader, with the digits that are known of them.

/// A value in so many significant digits.
pub fn significant(value: f64, digits: i32) -> String {
    match value != 0.0 && value.is_finite() {
        true => rounded(value, value.abs().log10().floor() as i32 + 1 - digits),
        false => value.to_string(),
    }
}

/// A value rounded to the power of ten of the second digit of its standard error, and the error; a value whose error is not known in six
/// digits, without it.
pub fn rounded_to(value: f64, error: f64) -> (String, Option<String>) {
    if !(error > 0.0 && error.is_finite()) {
        return (significant(value, 6), None);
    }
    let power = error.log10().floor() as i32 - 1;
    (rounded(value, power), Some(rounded(error, power)))
}

/// A value rounded to a power of ten.
fn rounded(value: f64, power: i32) -> String {
    match power {
        0.. => {
            let unit = 10f64.powi(power);
            format!("{:.0}", (value / unit).round() * unit)
        }
        decimals => format!("{value:.*}", decimals.unsigned_abs() as usize),
    }
}

/// A text for a page with the minus sign U+2212 where its negative numbers and exponents have a hyphen. Ranges, dates and names keep theirs, and so does what
/// stands between backticks, which may be copied into a command.
pub fn with_minus_signs(text: &str) -> String {
    let mut signed = String::with_capacity(text.len() + 2);
    let mut before = [' '; 2];
    let mut code = false;
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        code ^= c == '`';
        let begins = before[1].is_whitespace() || "([{<|\u{b1}".contains(before[1]);
        let exponent = matches!(before, ['0'..='9' | '.', 'e' | 'E']);
        let number = rest.peek().is_some_and(|next| next.is_ascii_digit() || *next == '.');
        signed.push(if c == '-' && !code && number && (begins || exponent) { '\u{2212}' } else { c });
        before = [before[1], c];
    }
    signed
}

/// A slope as it is written in the track: 1:40 for 0.025.
pub fn ratio(slope: f64) -> String {
    let run = significant(1.0 / slope, 4);
    match run.contains('.') {
        true => format!("1:{}", run.trim_end_matches('0').trim_end_matches('.')),
        false => format!("1:{run}"),
    }
}

/// A value of a line as plain text.
pub fn with_unit(value: Option<f64>, unit: &str) -> String {
    let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
    match value {
        None => "without a value".into(),
        // As many decimals as six digits need; limits are often short.
        Some(value) => format!("{}{unit}", (value * 1e4).round() / 1e4),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: values have the digits that their errors leave them, and no others.
    #[test]
    fn values_are_rounded_to_their_errors() {
        let both = |value, error| rounded_to(value, error);
        assert_eq!(both(301_234.0, 1834.0), ("301200".into(), Some("1800".into())));
        assert_eq!(both(0.287_41, 0.001_26), ("0.2874".into(), Some("0.0013".into())));
        assert_eq!(both(12.0, 340.0), ("10".into(), Some("340".into())));
        assert_eq!(both(301_234.567, 0.0), ("301235".into(), None));
        assert_eq!(both(0.0, 0.0), ("0".into(), None));
        assert_eq!(both(1.5, f64::NAN), ("1.50000".into(), None));
        assert_eq!([significant(92_345.6, 4), significant(0.621_9, 2)], ["92350", "0.62"]);
    }

    /// Goal: negative numbers and exponents have the minus sign, and nothing else changes.
    #[test]
    fn numbers_have_the_minus_sign() {
        for (text, expected) in [
            ("-0.5", "\u{2212}0.5"),
            ("moved by -1.2 mm, (-.5, 3e-4) mm", "moved by \u{2212}1.2 mm, (\u{2212}.5, 3e\u{2212}4) mm"),
            (
                "lines 3-5, 2026-11-25, 60E1-1:40, wheel-2.csv, a - 3",
                "lines 3-5, 2026-11-25, 60E1-1:40, wheel-2.csv, a - 3",
            ),
            ("`--set track.lateral_shift_mm -4` or -4", "`--set track.lateral_shift_mm -4` or \u{2212}4"),
        ] {
            assert_eq!(with_minus_signs(text), expected);
        }
    }

    /// Goal: a slope is 1 to a length.
    #[test]
    fn slopes_are_ratios() {
        assert_eq!([0.025, 0.05, 0.03].map(ratio), ["1:40", "1:20", "1:33.33"]);
    }
}
