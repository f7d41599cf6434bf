//! The law beside a measured curve: displacement, and the error with its uncertainty.

use crate::report::number::WIDTH;
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{BLUE, DARK, Dash, LIGHT, Marker, Series};
use crate::results::verdict::validation::{TWICE, ValidationPointRecord, ValidationRecord};

/// Displacement of both over the force, and model less measurement with `±2 u_val`; none without two points.
pub fn figure(of: &ValidationRecord) -> Option<String> {
    let points = &of.points;
    if points.len() < 2 {
        return None;
    }
    let over = |value: fn(&ValidationPointRecord) -> f64| -> Vec<(f64, f64)> {
        points.iter().map(|point| (point.force_kn, value(point))).collect()
    };
    let both = vec![
        Series::joined("model", over(|p| p.model_mm), DARK, Dash::Solid, Marker::Disc),
        Series::marks("measured", over(|p| p.measured_mm), BLUE, Marker::Square),
    ];
    let ends = |p: &ValidationPointRecord| {
        (p.force_kn, [-1.0, 1.0].map(|side| 1e3 * (p.error_mm + side * TWICE * p.validation_mm)))
    };
    let bands: Vec<_> = points.iter().map(ends).collect();
    let mut errors = Series::band("error \u{b1} 2 u_val", &bands, LIGHT);
    errors.push(Series::joined("", over(|p| 1e3 * p.error_mm), DARK, Dash::Solid, Marker::Disc));
    let force = "force, kN";
    Some(stacked(
        WIDTH,
        250,
        &[
            Panel::from_zero(force, "displacement, mm", both),
            Panel::from_zero(force, "model less measurement, \u{b5}m", errors),
        ],
    ))
}

/// What the figure shows.
pub fn caption(of: &ValidationRecord) -> String {
    format!(
        "Displacement against {} of the solid and of the measured curve {}, and their difference. Where its band contains zero, the error of the model cannot be distinguished from zero (ASME V&V 20).",
        of.reference, of.file
    )
}
