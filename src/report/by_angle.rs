//! The figure of the laws by contact angle.

use plotters::prelude::*;

use crate::records::{ShiftRecord, StiffnessByAngleRecord};

use super::figures::WIDTH;
use super::panel::{Panel, stacked_over_names};
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

/// Tangent stiffness along the normal over the contact angle, a curve for each fixed load, a panel for each reference. The shifts stand at
/// equal distances in the order of their angles: most angles lie within a few degrees, and some are the same.
pub fn stiffness(laws: &StiffnessByAngleRecord) -> String {
    let mut shifts: Vec<(f64, &ShiftRecord)> =
        laws.shifts.iter().filter_map(|shift| Some((shift.angle()?, shift))).collect();
    shifts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.shift_mm.total_cmp(&b.1.shift_mm)));
    let mut loads: Vec<f64> =
        shifts.iter().flat_map(|(_, shift)| shift.loads.iter().map(|load| load.force_kn)).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let panel = |(reference, name): (&str, &str)| Panel {
        x_label: "contact angle at the first touch, and lateral shift of the wheelset".into(),
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
                    .enumerate()
                    .map(|(place, (_, shift))| (place as f64, tangent(shift).unwrap_or(f64::NAN)))
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
    let names: Vec<[String; 2]> = shifts
        .iter()
        .map(|(angle, shift)| [degrees(*angle), format!("{} mm", number(shift.shift_mm))])
        .collect();
    stacked_over_names(WIDTH, 255, &PANELS.map(panel), &notes, &names)
}

/// A contact angle with a decimal.
fn degrees(angle: f64) -> String {
    format!("{angle:.1}\u{b0}").replace('-', "\u{2212}")
}

/// The secants over those of the published law, shift by shift, where there are any.
fn published_secants(laws: &StiffnessByAngleRecord) -> String {
    let ratio = |shift: &ShiftRecord| {
        shift.published_secant_ratio.map(|ratio| format!("{ratio:.3} at {} mm", number(shift.shift_mm)))
    };
    let ratios: Vec<String> = laws.shifts.iter().filter_map(ratio).collect();
    if ratios.is_empty() {
        return String::new();
    }
    format!(
        " Secant stiffness against the foot from 20 to 120 kN over that of the published law: {}.",
        ratios.join(", ")
    )
}

/// What the figure shows.
pub fn caption(laws: &StiffnessByAngleRecord) -> String {
    format!(
        "Tangent stiffness along the contact normal over the contact angle at fixed loads along that normal, friction {}: \
         of the approach of the surfaces alone, against the rail's section, and against its foot. The shifts of the wheelset stand in the \
         order of their contact angles, at equal distances; a line is interrupted where one contact does not carry the load. \
         The laws are in `stiffness_by_angle.json`.{}",
        number(laws.friction),
        published_secants(laws)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::samples;

    /// Goal: places of the shifts, px of the figure: those of angles that are a tenth of a degree apart, or the same, stand as far from each other
    /// as any, and nothing is lost.
    #[test]
    fn every_shift_has_its_own_place() {
        let mut laws = samples::by_angle();
        let shift = laws.shifts.iter().find(|shift| !shift.loads.is_empty()).unwrap().clone();
        laws.shifts = [0.55, 0.62, 4.5, 70.0, 70.0]
            .iter()
            .zip(-2..)
            .map(|(angle, shift_mm)| {
                let touch = shift
                    .touch
                    .map(|touch| crate::records::ShiftTouchRecord { contact_angle_deg: *angle, ..touch });
                ShiftRecord { shift_mm: f64::from(shift_mm), touch, ..shift.clone() }
            })
            .collect();
        let figure = stiffness(&laws);
        let mut places: Vec<f64> = figure
            .split("<text ")
            .filter(|text| text.contains('\u{b0}'))
            .filter_map(|text| text.split("x=\"").nth(1)?.split('"').next()?.parse().ok())
            .collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        assert_eq!(places.len(), laws.shifts.len(), "{places:?}");
        let apart: Vec<f64> = places.windows(2).map(|w| w[1] - w[0]).collect();
        assert!(apart.iter().all(|d| (d - apart[0]).abs() <= 1.0 && *d > 300.0), "{apart:?}");
        assert_eq!(figure.matches("70.0\u{b0}").count(), 2 * PANELS.len());
    }
}
