//! The figure of the laws by contact angle.

use plotters::prelude::*;

use crate::records::{ShiftRecord, StiffnessByAngleRecord};

use super::figures::WIDTH;
use super::panel::{Panel, stacked_with_notes};
use super::plot::{BLUE, DARK, DARK_RED, Dash, GREY, Marker, ORANGE, RED, Series};
use super::tables::number;

/// References and what their panels are called.
const PANELS: [(&str, &str); 3] = [
    ("local", "approach of the surfaces"),
    ("beam", "against the rail's section"),
    ("foot", "against the foot"),
];

/// How the curve of a load looks; colour, line and marker differ, so that it is read in grey.
fn look(index: usize) -> (RGBColor, Dash, Marker) {
    const COLORS: [RGBColor; 6] = [DARK, RED, BLUE, ORANGE, DARK_RED, GREY];
    const MARKERS: [Marker; 4] = [Marker::Disc, Marker::Circle, Marker::Square, Marker::Triangle];
    const DASHES: [Dash; 3] = [Dash::Solid, Dash::Dashed, Dash::Dotted];
    (COLORS[index % 6], DASHES[index % 3], MARKERS[index % 4])
}

/// Tangent stiffness along the normal over the contact angle, a curve for each fixed load, a panel for each reference.
pub fn stiffness(laws: &StiffnessByAngleRecord) -> String {
    let mut shifts: Vec<(f64, &ShiftRecord)> =
        laws.shifts.iter().filter_map(|shift| Some((shift.angle()?, shift))).collect();
    shifts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.shift_mm.total_cmp(&b.1.shift_mm)));
    let mut loads: Vec<f64> =
        shifts.iter().flat_map(|(_, shift)| shift.loads.iter().map(|load| load.force_kn)).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let panel = |(reference, name): (&str, &str)| Panel {
        x_label: "contact angle at the first touch, degrees".into(),
        y_label: format!("{name}, 10\u{2076} kN/m"),
        from_zero: true,
        series: loads
            .iter()
            .enumerate()
            .map(|(index, load)| {
                let (color, dash, marker) = look(index);
                let tangent = |shift: &ShiftRecord| {
                    let at = shift.loads.iter().find(|at| at.force_kn == *load)?;
                    let point = at.references.iter().find(|point| point.reference == reference)?;
                    Some(point.tangent_kn_per_m * 1e-6)
                };
                // a shift that does not carry the load interrupts the line
                let points = shifts
                    .iter()
                    .map(|(angle, shift)| (*angle, tangent(shift).unwrap_or(f64::NAN)))
                    .collect();
                Series::joined(&format!("{} kN", number(*load)), points, color, dash, marker)
            })
            .collect(),
    };
    let missing = |shift: &ShiftRecord| {
        let reason = shift.reason.as_ref()?;
        let until = shift
            .laws
            .first()
            .map_or_else(|| "no law".into(), |law| format!("law up to {} kN", number(law.law.range_kn[1])));
        Some(format!("Shift {} mm: {until}: {reason}", number(shift.shift_mm)))
    };
    let notes: Vec<String> = laws.shifts.iter().filter_map(missing).collect();
    stacked_with_notes(WIDTH, 240, &PANELS.map(panel), &notes)
}

/// What the figure shows.
pub fn caption(laws: &StiffnessByAngleRecord) -> String {
    let shifts = laws
        .shifts
        .iter()
        .filter_map(|shift| {
            Some(format!(
                "{} mm ({}\u{b0})",
                number(shift.shift_mm),
                number((shift.angle()? * 10.0).round() / 10.0)
            ))
        })
        .collect::<Vec<_>>()
        .join(", ");
    format!(
        "Tangent stiffness along the contact normal over the contact angle at fixed loads along that normal, friction {}: \
         of the approach of the surfaces alone, against the rail's section, and against its foot. Shifts of the wheelset and contact angles: {shifts}. \
         The laws are in `stiffness_by_angle.json`.",
        number(laws.friction)
    )
}
