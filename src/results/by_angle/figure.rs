//! The figure of the laws by contact angle, and the table of their error bands.

use plotters::prelude::*;
use serde::Serialize;

use crate::report::number::{WIDTH, number};
use crate::report::panel::{Panel, stacked_over_names};
use crate::report::plot::{BLUE, DARK, DARK_RED, Dash, GREY, Marker, ORANGE, RED, Series};
use crate::results::by_angle::record::{ShiftRecord, StiffnessByAngleRecord};
use crate::results::springs::band_record::ErrorBandRecord;
use crate::rounding::{significant, with_minus_signs};

/// References, what their panels are called, and their columns.
const PANELS: [(&str, &str, &str); 3] = [
    ("local", "approach of the surfaces", "approach alone"),
    ("beam", "against the rail's section", "against the section"),
    ("foot", "against the foot", "against the foot"),
];

/// All panels, but that of the foot only where there are laws against it.
fn panels(laws: &StiffnessByAngleRecord) -> Vec<(&'static str, &'static str, &'static str)> {
    let mut all = laws.shifts.iter().flat_map(|shift| &shift.laws);
    let foot_held = all.any(|law| law.reference == "foot");
    PANELS.into_iter().filter(|(reference, ..)| foot_held || *reference != "foot").collect()
}

/// How the curve of a load looks; colour, line and marker differ, so that it is read in grey.
fn look(index: usize) -> (RGBColor, Dash, Marker) {
    const COLORS: [RGBColor; 6] = [DARK, RED, BLUE, ORANGE, DARK_RED, GREY];
    const MARKERS: [Marker; 4] = [Marker::Disc, Marker::Circle, Marker::Square, Marker::Triangle];
    const DASHES: [Dash; 3] = [Dash::Solid, Dash::Dashed, Dash::Dotted];
    (COLORS[index % 6], DASHES[index % 3], MARKERS[index % 4])
}

/// Distance of the points of two loads at one shift, over that of two shifts: error bars do not cover each other.
const BESIDE: f64 = 0.06;

/// Tangent stiffness along the normal over the contact angle, a curve for each fixed load, a panel for each reference. The shifts stand at
/// equal distances in the order of their angles: most angles lie within a few degrees, and some are the same. Error bands are bars.
pub fn stiffness(laws: &StiffnessByAngleRecord) -> String {
    let mut shifts: Vec<(f64, &ShiftRecord)> =
        laws.shifts.iter().filter_map(|shift| Some((shift.angle()?, shift))).collect();
    shifts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.shift_mm.total_cmp(&b.1.shift_mm)));
    let mut loads: Vec<f64> =
        shifts.iter().flat_map(|(_, shift)| shift.loads.iter().map(|load| load.force_kn)).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let panel = |(reference, name, _): (&str, &str, &str)| Panel {
        x_label: "contact angle at the first touch, and lateral shift of the wheelset".into(),
        y_label: format!("{name}, 10\u{2076} kN/m"),
        from_zero: true,
        series: loads
            .iter()
            .enumerate()
            .flat_map(|(index, load)| {
                let (color, dash, marker) = look(index);
                let beside = BESIDE * (index as f64 - 0.5 * (loads.len() - 1) as f64);
                let at = |place: usize| place as f64 + beside;
                let tangent = |shift: &ShiftRecord| {
                    let at = shift.loads.iter().find(|at| at.force_kn == *load)?;
                    let point = at.reference(reference)?;
                    Some(point.tangent_kn_per_m * 1e-6)
                };
                // a shift that does not carry the load interrupts the line
                let points = shifts
                    .iter()
                    .enumerate()
                    .map(|(place, (_, shift))| (at(place), tangent(shift).unwrap_or(f64::NAN)))
                    .collect();
                let bar = |(place, (_, shift)): (usize, &(f64, &ShiftRecord))| {
                    let (tangent, band) = (tangent(shift)?, shift.band(reference, *load)?.tangent?);
                    let end = |sign: f64| (at(place), tangent * (1.0 + sign * band));
                    // what is not finite parts one bar from the next
                    Some([end(-1.0), end(1.0), (f64::NAN, f64::NAN)])
                };
                let bars: Vec<(f64, f64)> = shifts.iter().enumerate().filter_map(bar).flatten().collect();
                let curve = Series::joined(&format!("{} kN", number(*load)), points, color, dash, marker);
                [Series::line("", bars, color, Dash::Solid), curve]
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
    let drawn: Vec<Panel> = panels(laws).into_iter().map(panel).collect();
    stacked_over_names(WIDTH, 255, &drawn, &notes, &names)
}

/// A contact angle with a decimal.
fn degrees(angle: f64) -> String {
    with_minus_signs(&format!("{angle:.1}\u{b0}"))
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

/// Error bands of the laws, as the page shows them.
#[derive(Debug, Serialize)]
pub struct LawErrors {
    /// What the laws are measured against, of each two columns after the third.
    against: Vec<&'static str>,
    /// Shift, mm, contact angle and largest load of the law, kN; then the largest band of displacement and of tangent over the fixed
    /// loads in per cent, for every reference.
    rows: Vec<Vec<String>>,
    /// The parts that are missing, with their reasons.
    missing: Vec<String>,
}

/// The error bands of the shifts that have a law, if there are any.
pub fn law_errors(laws: &StiffnessByAngleRecord) -> Option<LawErrors> {
    let banded = || laws.shifts.iter().filter_map(|shift| Some((shift, shift.error_band.as_ref()?)));
    banded().next()?;
    let none = || "\u{2013}".to_string();
    let percent = |value: Option<f64>| value.map_or_else(none, |v| significant(1e2 * v, 2));
    let row = |shift: &ShiftRecord| {
        let mut row = vec![
            number(shift.shift_mm),
            shift.angle().map_or_else(none, degrees),
            shift.laws.first().map_or_else(none, |law| number(law.law.range_kn[1])),
        ];
        for (reference, ..) in panels(laws) {
            let band = shift.error_band.as_ref().and_then(|band| band.of(reference));
            row.extend([band.and_then(|b| b.displacement), band.and_then(|b| b.tangent)].map(percent));
        }
        row
    };
    let missing = |(shift, band): (&ShiftRecord, &ErrorBandRecord)| {
        let (at, parts) = (number(shift.shift_mm), band.missing.join("; "));
        (!parts.is_empty()).then(|| format!("Shift {at} mm: {parts}"))
    };
    let with_law = laws.shifts.iter().filter(|shift| !shift.laws.is_empty());
    Some(LawErrors {
        against: panels(laws).into_iter().map(|(.., column)| column).collect(),
        rows: with_law.map(row).collect(),
        missing: banded().filter_map(missing).collect(),
    })
}

/// What the figure shows.
pub fn caption(laws: &StiffnessByAngleRecord) -> String {
    let is_banded = |shift: &ShiftRecord| {
        let bands = shift.error_band.iter().flat_map(|band| &band.references);
        bands.into_iter().any(|band| band.tangent.is_some())
    };
    let bars = match laws.shifts.iter().any(is_banded) {
        true => " The bars are the error bands.",
        false => "",
    };
    let foot = match panels(laws).iter().any(|(reference, ..)| *reference == "foot") {
        true => ", and against its foot",
        false => "",
    };
    format!(
        "Tangent stiffness along the contact normal over the contact angle at fixed loads along that normal, friction {}: \
         of the approach of the surfaces alone, against the rail's section{foot}. The shifts of the wheelset stand in the \
         order of their contact angles, at equal distances; a line is interrupted where a load is not carried.{bars} \
         {}The laws are in `stiffness_by_angle.json`.{}",
        number(laws.friction),
        shared(laws),
        published_secants(laws)
    )
}

/// At which shifts and from which loads on two contacts share the load; empty without any.
fn shared(laws: &StiffnessByAngleRecord) -> String {
    let places = laws.shifts.iter().filter_map(|shift| {
        Some(format!("{} mm from {} kN on", number(shift.shift_mm), number(shift.shared_from_kn?)))
    });
    let places: Vec<String> = places.collect();
    if places.is_empty() {
        return String::new();
    }
    format!(
        "Two contacts with different normals share the load at a shift of {}: there the stiffness is that of the pair along the normal of the first touch. ",
        places.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::by_angle::record::ShiftTouchRecord;
    use crate::results::samples;

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
                let touch = shift.touch.map(|touch| ShiftTouchRecord { contact_angle_deg: *angle, ..touch });
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

    /// Goal: a bar beside every point of every panel, from the tangent less its band to the tangent and its band (10⁶ kN/m), at the place
    /// of the point; none without bands. The table has a row for each law, dashes and the reason where a part is missing.
    #[test]
    fn bands_are_bars_and_a_table() {
        let mut laws = samples::by_angle();
        // upright lines of two points in the colours of the loads
        let colors = [0, 1, 2].map(|index| {
            let RGBColor(r, g, b) = look(index).0;
            format!("stroke=\"#{r:02X}{g:02X}{b:02X}\"")
        });
        let is_bar = |line: &&str| {
            let points = line.split("points=\"").nth(1).and_then(|rest| rest.split('"').next());
            let points: Vec<&str> = points.unwrap_or_default().split_whitespace().collect();
            let upright = |a: &str, b: &str| a.split(',').next() == b.split(',').next() && a != b;
            matches!(points[..], [a, b] if upright(a, b)) && colors.iter().any(|color| line.contains(color))
        };
        let bars = |laws: &StiffnessByAngleRecord| stiffness(laws).split("<polyline").filter(is_bar).count();
        let points: usize = laws.shifts.iter().map(|shift| shift.loads.len()).sum();
        assert_eq!(bars(&laws), PANELS.len() * points);
        assert!(caption(&laws).contains("The bars are the error bands."));
        let table = law_errors(&laws).unwrap();
        assert_eq!(table.rows.len(), laws.shifts.iter().filter(|shift| !shift.laws.is_empty()).count());
        // local first, as the panels; the widest band is that of the smallest load, 20 kN: 0.02/√20 + 0.004, and twice the first + 0.01
        let percent = ["0.85", "1.9"];
        assert_eq!(table.rows[0][..3], ["0", "1.4\u{b0}", "150"]);
        assert_eq!(table.rows[0][3..5], percent);
        assert!(table.missing.is_empty());
        let band = laws.shifts[1].error_band.as_mut().unwrap();
        band.missing = vec!["coarser meshes: the contact reached the end".into()];
        band.references.iter_mut().for_each(|of| (of.displacement, of.tangent) = (None, None));
        let table = law_errors(&laws).unwrap();
        assert_eq!(table.rows[0][3..], ["\u{2013}"; 6]);
        assert_eq!(table.missing, ["Shift 0 mm: coarser meshes: the contact reached the end"]);
        laws.shifts.iter_mut().for_each(|shift| shift.error_band = None);
        assert_eq!(bars(&laws), 0);
        assert!(law_errors(&laws).is_none() && !caption(&laws).contains("bars"));
    }
}
