//! Numbers with a power of ten.

use crate::report::number::number;

/// A difference or limit: plain from a thousandth on, else with a power of ten.
pub(super) fn scientific(value: f64) -> String {
    if !value.is_finite() {
        return "none".into();
    }
    if value == 0.0 || value.abs() >= 1e-3 {
        return number(value);
    }
    let text = format!("{value:.1e}");
    let (lead, power) = text.split_once('e').unwrap_or((&text, "0"));
    let lead = lead.trim_end_matches(".0");
    format!("{lead}\u{b7}{}", power_of_ten(power.parse().unwrap_or(0)))
}

/// Ten with a raised exponent.
pub(super) fn power_of_ten(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised: String = power
        .to_string()
        .chars()
        .map(|c| c.to_digit(10).map_or('\u{207b}', |digit| DIGITS[digit as usize]))
        .collect();
    format!("10{raised}")
}
