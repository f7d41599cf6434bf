//! The figures of the report, each from plain values to SVG.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use railspring_calibrate::law::StiffnessLaw;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE};

use crate::report::bars::ValueAxis;
use crate::report::legend::{Entry, draw_legend, legend_height};
use crate::report::number::{WIDTH, number};
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{
    BLUE, DARK, Dash, GREY, LIGHT, Marker, ORANGE, RED, Series, frame, label, px, stroke, svg,
};
use crate::results::bodies::touch::HertzRecord;
use crate::results::patches::record::PatchRecord;
use crate::results::springs::band_record::BandPointRecord;
use crate::results::springs::record::{
    ComplianceRecord, HorizontalRecord, LoadCurveRow, ReferenceRecord, StiffnessRecord, TangentRecord,
};
use crate::rounding::with_minus_signs;

/// Share of the longest bar below which a negative part is left to the files.
const HARDLY_SEEN: f64 = 0.004;
/// Points of a smooth curve.
const CURVE_POINTS: usize = 160;

/// Tangent stiffness of Hertz at a load, kN/m and kN, from that at 1 kN.
pub(crate) fn hertz_tangent(at_one_kn: f64, force_kn: f64) -> f64 {
    at_one_kn * force_kn.cbrt()
}

/// Tangent stiffness over load: the solid, the fitted laws, Hertz and the published law.
pub fn law(stiffness: &StiffnessRecord) -> String {
    let largest = stiffness.law.range_kn[1];
    let forces: Vec<f64> = (0..=CURVE_POINTS)
        // Denser at small loads, where the curves bend.
        .map(|n| largest * (n as f64 / CURVE_POINTS as f64).powi(2))
        .collect();
    let curve = |f: &dyn Fn(f64) -> f64| forces.iter().map(|x| (*x, f(*x) * 1e-6)).collect::<Vec<_>>();
    let hertz = stiffness.touch.hertz_kn_per_m;
    let name = "Hertz at the first touch";
    let mut series = vec![Series::line(name, curve(&|f| hertz_tangent(hertz, f)), GREY, Dash::Dotted)];
    let mut marks = Vec::new();
    for reference in &stiffness.references {
        let (marker, color) = reference_style(&reference.reference);
        let name = format!("solid and its law: {}", reference_name(&reference.reference));
        series.push(Series::line("", curve(&|f| reference.law.constants.tangent(f)), color, Dash::Solid));
        let points = reference.points.iter().map(|p| (p.force_kn, p.tangent_kn_per_m * 1e-6)).collect();
        marks.push(Series::marks(&name, points, color, marker).sampled(Dash::Solid));
        let bars = error_bars(stiffness, reference, |p, band| {
            let (tangent, force) = (p.tangent_kn_per_m * 1e-6, p.force_kn);
            [-1.0, 1.0].map(|side| (force, tangent * (1.0 + side * band.tangent.unwrap_or(f64::NAN))))
        });
        marks.extend(bars.map(|points| Series::line("", points, color, Dash::Solid)));
    }
    // On top of the lines, so that it is seen where it coincides with one of them.
    let published = StiffnessLaw::published();
    let tangent = |f: f64| published.tangent(f * KILONEWTON) / KILONEWTON_PER_METRE;
    series.push(Series::line("published law", curve(&tangent), RED, Dash::Dashed));
    series.extend(marks);
    stacked(
        WIDTH,
        380,
        &[Panel::from_zero("load P, kN", "tangent stiffness dP/d\u{3b4}, 10\u{2076} kN/m", series)],
    )
}

/// Load over displacement: the solid with each reference and the published law.
pub fn displacement(stiffness: &StiffnessRecord) -> String {
    let largest = stiffness.law.range_kn[1];
    let published = StiffnessLaw::published();
    let mut series = Vec::new();
    for reference in &stiffness.references {
        let (marker, color) = reference_style(&reference.reference);
        let name = format!("solid: {}", reference_name(&reference.reference));
        let points = reference.points.iter().map(|p| (p.displacement_mm, p.force_kn)).collect();
        series.push(Series::joined(&name, points, color, Dash::Solid, marker));
        let bars = error_bars(stiffness, reference, |p, band| {
            let side = |side: f64| 1.0 + side * band.displacement.unwrap_or(f64::NAN);
            [-1.0, 1.0].map(|sign| (p.displacement_mm * side(sign), p.force_kn))
        });
        series.extend(bars.map(|points| Series::line("", points, color, Dash::Solid)));
    }
    let law = (0..=CURVE_POINTS)
        .map(|n| largest * (n as f64 / CURVE_POINTS as f64).powi(2))
        .map(|f| (published.displacement(f * KILONEWTON) / MILLIMETRE, f))
        .collect();
    series.push(Series::line("published law", law, RED, Dash::Dashed));
    let hertz = stiffness.touch.hertz_kn_per_m;
    if hertz.is_finite() && hertz > 0.0 {
        // the integral of df/(h·f^(1/3)), mm
        let approach = |f: f64| 1e3 * 1.5 * f.cbrt().powi(2) / hertz;
        let curve = (0..=CURVE_POINTS).map(|n| largest * (n as f64 / CURVE_POINTS as f64).powi(2));
        let curve = curve.map(|f| (approach(f), f)).collect();
        series.push(Series::line("Hertz at the first touch", curve, GREY, Dash::Dotted));
    }
    stacked(WIDTH, 340, &[Panel::from_zero("displacement \u{3b4}, mm", "load P, kN", series)])
}

/// The error band of a reference as a line beside each point, between the two `ends`; none where there is no band.
fn error_bars(
    stiffness: &StiffnessRecord,
    reference: &ReferenceRecord,
    ends: impl Fn(&TangentRecord, &BandPointRecord) -> [(f64, f64); 2],
) -> Option<Vec<(f64, f64)>> {
    let band = stiffness.error_band.as_ref()?.of(&reference.reference)?;
    let bar = |(point, band)| -> [(f64, f64); 3] {
        let [low, high] = ends(point, band);
        // what is not finite parts one bar from the next
        [low, high, (f64::NAN, f64::NAN)]
    };
    band.largest().map(|_| reference.points.iter().zip(&band.points).flat_map(bar).collect())
}

/// The error band of a value as a line through each of its points; empty where there are no bands.
fn value_bars(rows: &[LoadCurveRow], value: impl Fn(&LoadCurveRow) -> Option<(f64, f64)>) -> Vec<(f64, f64)> {
    let bar = |row: &LoadCurveRow| {
        let (value, band) = value(row)?;
        let (low, high) = (value * (1.0 - band), value * (1.0 + band));
        // what is not finite parts one bar from the next
        Some([(row.force_kn, low), (row.force_kn, high), (f64::NAN, f64::NAN)])
    };
    rows.iter().filter_map(bar).flatten().collect()
}

/// Semi-axes and largest pressure of the patch over load, Hertz beside them.
pub fn patch(rows: &[LoadCurveRow], hertz: Option<HertzRecord>) -> String {
    let of = |value: fn(&LoadCurveRow) -> f64| {
        rows.iter().map(|row| (row.force_kn, value(row))).collect::<Vec<_>>()
    };
    let largest = rows.last().map_or(0.0, |row| row.force_kn);
    let of_hertz = |name: &str, color, value: fn(HertzRecord) -> f64| {
        let loads = (0..=CURVE_POINTS).map(|n| largest * (n as f64 / CURVE_POINTS as f64).powi(3));
        hertz.map(|hertz| {
            Series::line(name, loads.map(|f| (f, value(hertz.at(f)))).collect(), color, Dash::Dotted)
        })
    };
    let axes = [
        Series::joined("along the track", of(|r| r.semi_axis_along_mm), BLUE, Dash::Solid, Marker::Disc),
        Series::joined("across", of(|r| r.semi_axis_across_mm), RED, Dash::Dashed, Marker::Square),
    ];
    let pressure =
        Series::joined("largest pressure", of(|r| r.max_pressure_mpa), DARK, Dash::Solid, Marker::Circle);
    let bars = value_bars(rows, |row| Some((row.max_pressure_mpa, row.max_pressure_rel_error_band?)));
    let band = (!bars.is_empty()).then(|| Series::line("its error band", bars, DARK, Dash::Solid));
    let of_axes = [
        of_hertz("Hertz, along", GREY, |h| h.semi_axis_along_mm),
        of_hertz("Hertz, across", ORANGE, |h| h.semi_axis_across_mm),
    ];
    let of_pressure = of_hertz("Hertz, pressure", GREY, |h| h.max_pressure_mpa);
    stacked(
        WIDTH,
        230,
        &[
            Panel::from_zero(
                "load P, kN",
                "semi-axis, mm",
                of_axes.into_iter().flatten().chain(axes).collect(),
            ),
            Panel::from_zero(
                "load P, kN",
                "largest pressure, MPa",
                of_pressure.into_iter().chain([pressure]).chain(band).collect(),
            ),
        ],
    )
}

/// The largest stresses below the patch over the load, with their depths; then over the depth for the loads of `patches`. `None` for a contact
/// between elements, which does not resolve them.
pub fn subsurface(rows: &[LoadCurveRow], patches: &[PatchRecord]) -> Option<String> {
    let of = |value: fn(&LoadCurveRow) -> Option<f64>| -> Option<Vec<(f64, f64)>> {
        rows.iter().map(|row| Some((row.force_kn, value(row)?))).collect()
    };
    let mises = |points| Series::joined("von Mises", points, DARK, Dash::Solid, Marker::Disc);
    let shear = |points| Series::joined("largest shear", points, ORANGE, Dash::Dashed, Marker::Square);
    let over_load = |name: &str, series| Panel::from_zero("load P, kN", name, series);
    let looks = [(GREY, Dash::Dotted), (BLUE, Dash::Dashed), (DARK, Dash::Solid)];
    let mut profiles = Vec::new();
    for (patch, (color, dash)) in patches.iter().zip(looks) {
        let below = patch.below.as_ref()?;
        let points = |values: &[f64]| below.depth_mm.iter().copied().zip(values.iter().copied()).collect();
        let load = number((patch.force_kn * 10.0).round() / 10.0);
        let name = format!("{load} kN: von Mises (broad), shear");
        profiles.push(Series::line(&name, points(&below.von_mises_mpa), color, dash).broad());
        profiles.push(Series::line("", points(&below.shear_mpa), color, dash));
    }
    let with_bands = |series: [Series; 2], bars: [Vec<(f64, f64)>; 2]| -> Vec<Series> {
        let looks = [(DARK, "error bands"), (ORANGE, "")];
        let bars = bars.into_iter().zip(looks).filter(|(bars, _)| !bars.is_empty());
        let bars = bars.map(|(bars, (color, name))| Series::line(name, bars, color, Dash::Solid));
        series.into_iter().chain(bars).collect()
    };
    let stresses = with_bands(
        [mises(of(|row| row.max_von_mises_mpa)?), shear(of(|row| row.max_shear_mpa)?)],
        [
            value_bars(rows, |row| Some((row.max_von_mises_mpa?, row.von_mises_rel_error_band?))),
            value_bars(rows, |row| Some((row.max_shear_mpa?, row.shear_rel_error_band?))),
        ],
    );
    let depths = with_bands(
        [mises(of(|row| row.von_mises_depth_mm)?), shear(of(|row| row.shear_depth_mm)?)],
        [
            value_bars(rows, |row| Some((row.von_mises_depth_mm?, row.von_mises_depth_rel_error_band?))),
            value_bars(rows, |row| Some((row.shear_depth_mm?, row.shear_depth_rel_error_band?))),
        ],
    );
    Some(stacked(
        WIDTH,
        220,
        &[
            over_load("largest stress, MPa", stresses),
            over_load("its depth, mm", depths),
            Panel::from_zero(
                "depth below the place of the largest von Mises stress, mm",
                "stress, MPa",
                profiles,
            ),
        ],
    ))
}

/// Where the compliance sits, one bar per load.
pub fn compliance(rows: &[ComplianceRecord]) -> String {
    let rows = &some_loads(rows);
    const ROW: u32 = 34;
    const LEFT: u32 = 84;
    type Part = (&'static str, RGBColor, fn(&ComplianceRecord) -> f64);
    let parts: [Part; 5] = [
        ("local contact", DARK, |r| r.local_um_per_kn),
        ("wheel body", BLUE, |r| r.wheel_um_per_kn),
        ("rail body", ORANGE, |r| r.rail_um_per_kn),
        ("rail as a beam", LIGHT, |r| r.beam_um_per_kn),
        ("missed by the beam", RED, |r| r.beam_missing_um_per_kn),
    ];
    let entries: Vec<Entry> = parts.iter().map(|(name, color, _)| Entry::patch(name, *color)).collect();
    let top = legend_height(WIDTH, &entries);
    let height = top + ROW * rows.len() as u32 + 52;
    svg(WIDTH, height, |root| {
        let (legend, rest) = root.split_vertically(px(top));
        draw_legend(&legend, WIDTH, &entries)?;
        // Negative parts stand left of zero, so that the sum is right end less left end.
        let side = |row: &ComplianceRecord, sign: f64| {
            parts.iter().map(|(_, _, value)| value(row)).filter(|v| v * sign > 0.0).sum::<f64>()
        };
        let longest = rows.iter().map(|row| side(row, 1.0)).fold(0.0, f64::max);
        // a part that would hardly be seen takes no room left of zero
        let seen = |end: f64| if end < -HARDLY_SEEN * longest { end } else { end.max(0.0) };
        let values = rows.iter().flat_map(|row| [side(row, 1.0), seen(side(row, -1.0))]);
        let axis = ValueAxis::over(values, LEFT, ROW * rows.len() as u32 + 4);
        axis.draw_grid(&rest)?;
        for (index, row) in rows.iter().enumerate() {
            let (a, b) = (px(ROW * index as u32 + 5), px(ROW * (index as u32 + 1) - 5));
            let middle = (a + b) / 2;
            let style = label(12, HPos::Right, VPos::Center);
            rest.draw(&Text::new(
                format!("{} kN", number((row.force_kn * 10.0).round() / 10.0)),
                (px(LEFT - 8), middle),
                style,
            ))?;
            let mut ends = [0.0f64, 0.0];
            for (_, color, value) in &parts {
                let value = value(row);
                if value < 0.0 && value > -HARDLY_SEEN * longest {
                    continue;
                }
                let end = &mut ends[usize::from(value < 0.0)];
                let (left, right) = (axis.x(end.min(*end + value)), axis.x(end.max(*end + value)));
                *end += value;
                let corners = [(left, a), (right, b)];
                rest.draw(&Rectangle::new(corners, color.filled()))?;
                rest.draw(&frame(corners, stroke(BLACK, 6)))?;
                let dark = *color == DARK || *color == BLUE;
                let text = with_minus_signs(&format!("{value:.3}"));
                // A number that does not fit its part is left to the files.
                if right - left > px(text.chars().count() as u32 * 7) {
                    let style =
                        label(11, HPos::Center, VPos::Center).color(if dark { &WHITE } else { &BLACK });
                    rest.draw(&Text::new(text, ((left + right) / 2, middle), style))?;
                }
            }
        }
        axis.draw_axis(&rest, "tangent compliance d\u{3b4}/dP, \u{b5}m/kN")
    })
}

/// A handful of loads over the whole range.
fn some_loads(rows: &[ComplianceRecord]) -> Vec<ComplianceRecord> {
    let largest = rows.iter().map(|row| row.force_kn).fold(0.0, f64::max);
    let mut chosen: Vec<ComplianceRecord> = Vec::new();
    for share in [0.02, 0.05, 0.12, 0.3, 0.6, 1.0] {
        let distance = |row: &ComplianceRecord| (row.force_kn - share * largest).abs();
        let near = rows.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        chosen.extend(near.filter(|row| !chosen.contains(row)).copied());
    }
    chosen
}

/// The horizontal stiffness over the preload; `constant_kn_per_m` is the one in use.
pub fn horizontal(horizontal: &HorizontalRecord, constant_kn_per_m: f64) -> String {
    let points: Vec<(f64, f64)> =
        horizontal.points.iter().map(|p| (p.preload_kn, p.stiffness_kn_per_m * 1e-6)).collect();
    let ends = points.iter().fold((f64::INFINITY, 0.0f64), |(a, b), (x, _)| (a.min(*x), b.max(*x)));
    let constant = constant_kn_per_m * 1e-6;
    let band = horizontal.error_band.as_ref().and_then(|band| band.band);
    // what is not finite parts one bar from the next
    let bar = |&(x, y): &(f64, f64)| {
        band.map(|band| [(x, y * (1.0 - band)), (x, y * (1.0 + band)), (f64::NAN, f64::NAN)])
    };
    let bars: Vec<(f64, f64)> = points.iter().filter_map(bar).flatten().collect();
    stacked(
        WIDTH,
        240,
        &[Panel::from_zero(
            "vertical preload, kN",
            "dQ/dy, 10\u{2076} kN/m",
            vec![
                Series::line(
                    "constant in use",
                    vec![(ends.0, constant), (ends.1, constant)],
                    RED,
                    Dash::Dashed,
                ),
                Series::line("", bars, BLUE, Dash::Solid),
                Series::marks("solid, sticking", points, BLUE, Marker::Disc),
            ],
        )],
    )
}

/// What the figure of the horizontal stiffness shows.
pub fn horizontal_caption(horizontal: &HorizontalRecord) -> String {
    let bars = match horizontal.error_band.as_ref().is_some_and(|band| band.band.is_some()) {
        true => " The bars are the error band.",
        false => "",
    };
    format!("Horizontal stiffness under sticking at several preloads, and the constant in use.{bars}")
}

fn reference_style(reference: &str) -> (Marker, RGBColor) {
    match reference {
        "foot" => (Marker::Square, BLUE),
        "beam" => (Marker::Disc, DARK),
        "half-spaces" => (Marker::Circle, GREY),
        _ => (Marker::Triangle, ORANGE),
    }
}

/// How the report names a reference.
fn reference_name(reference: &str) -> &str {
    match reference {
        "foot" => "hub against rail foot",
        "beam" => "hub against rail section",
        "local" => "approach of the surfaces",
        "half-spaces" => "profiles on half-spaces",
        other => other,
    }
}

/// Keeps the references in one order for all figures.
pub fn in_order(references: &mut [ReferenceRecord]) {
    let rank = |name: &str| {
        ["half-spaces", "local", "beam", "foot"].iter().position(|known| *known == name).unwrap_or(4)
    };
    references.sort_by_key(|reference| rank(&reference.reference));
}
