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
}
