//! The page of a comparison: self-contained, in the style of all pages.

use plotters::style::RGBColor;
use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::history::HistoryRow;
use serde_json::{Value, json};

use super::comparison::Comparison;
use super::rows::{LineChange, common_shifts, tangent_at};
use super::side::Side;
use crate::report::accessible::inline;
use crate::report::html;
use crate::report::number::{WIDTH, number};
use crate::report::panel::{Panel, stacked, stacked_over_names};
use crate::report::plot::{DARK, Dash, GREY, Marker, ORANGE, RED, Series};
use crate::results::by_angle::record::ShiftRecord;
use crate::results::springs::band_record::BandPointRecord;
use crate::results::springs::figures::hertz_tangent;
use crate::results::springs::record::LawRecord;
use crate::results::springs::record::{LoadCurveRow, ReferenceRecord, TangentRecord};
use crate::rounding::with_minus_signs;

/// Points of a smooth curve.
const CURVE_POINTS: usize = 160;
/// Most loads of the figure over the contact angle: the smallest, the largest and one between them.
const PANELS: usize = 3;
/// Distance of the points of A and B at one shift, over that of two shifts.
const BESIDE: f64 = 0.1;

/// How A and B are drawn: colour, line and marker differ, so that they differ in grey, too.
const LOOKS: [(&str, RGBColor, Dash, Marker); 2] =
    [("A", DARK, Dash::Solid, Marker::Disc), ("B", RED, Dash::Dashed, Marker::Square)];

/// The page.
pub fn page(a: &Side, b: &Side, found: &Comparison) -> String {
    let sides = [a, b];
    let mut figures = Figures::default();
    let reference = &found.reference;
    figures.add(
        tangents(&sides, reference),
        format!("Tangent stiffness over load of A and B against {reference}. Points: the solids, with their error bands as bars. Lines: the laws fitted to them. Dotted: Hertz for the curvatures at each first touch, which is the contact alone."),
    );
    figures.add(
        displacements(&sides, reference),
        format!(
            "Load over displacement of the solids A and B against {reference}, with error bands as bars."
        ),
    );
    if sides.iter().any(|side| side.stiffness.horizontal.is_some()) {
        figures.add(
            horizontal(&sides),
            "Horizontal stiffness under sticking over the preload, with error bands as bars, and the constants in use as lines.".into(),
        );
    }
    if let Some(figure) = by_angle(&sides, reference) {
        figures.add(figure, format!("Tangent stiffness of A and B along the contact normal over the contact angle, against {reference}, a panel for each of up to three loads that both carry; error bands as bars. Below each shift the contact angles of A and of B."));
    }
    if sides.iter().all(|side| !side.load_curve.is_empty()) {
        figures.add(
            patch(&sides),
            "Semi-axes of the contact patch and largest pressure in the solids A and B, with the references that they use.".into(),
        );
    }
    for (name, _) in a.runs.iter().filter(|(name, _)| b.runs.iter().any(|(other, _)| other == name)) {
        figures.add(
            forces(&sides, name),
            format!("Load case {name}: vertical force P and lateral force Q of the wheel on the rail over time, simple models of A and B."),
        );
    }
    let groups: Vec<Value> = found
        .groups
        .iter()
        .map(|group| {
            // one unit of all is said once
            let common = group.unit();
            let rows = group.rows.iter().map(|row| {
                let unit = if common.is_some() || row.unit == "1" { "" } else { &row.unit };
                json!({ "quantity": row.quantity, "unit": unit, "cells": row.texts(), "beyond": row.beyond == Some(true) })
            });
            json!({ "name": group.name, "caption": group.caption, "unit": common, "rows": rows.collect::<Vec<_>>() })
        })
        .collect();
    let line = |line: &LineChange| {
        let worse = line.b.as_ref().is_some_and(|b| !b.holds) && line.a.as_ref().is_none_or(|a| a.holds);
        json!({ "subject": line.subject, "meaning": line.meaning, "cells": line.texts(), "worse": worse })
    };
    html::render(
        "compare.html",
        json!({
            "found": found,
            "sides": [("A", &found.a), ("B", &found.b)],
            "groups": groups,
            "lines": found.lines.iter().map(line).collect::<Vec<_>>(),
            "figures": figures.0,
            "program": crate::version::FULL,
        }),
    )
}

/// Figures with their captions and numbers.
#[derive(Default)]
struct Figures(Vec<Value>);

impl Figures {
    fn add(&mut self, svg: String, caption: String) {
        let number = self.0.len() + 1;
        self.0.push(json!({ "svg": inline(&svg, &caption), "caption": caption, "number": number }));
    }
}

/// The curves that `of` makes of each side.
fn of_both(sides: &[&Side; 2], of: impl Fn(&Side, usize) -> Vec<Series>) -> Vec<Series> {
    sides.iter().enumerate().flat_map(|(n, side)| of(side, n)).collect()
}

/// What A or B is called in a legend.
fn named(n: usize, what: &str) -> String {
    format!("{}: {what}", LOOKS[n].0)
}

fn reference_of<'s>(side: &'s Side, name: &str) -> Option<&'s ReferenceRecord> {
    side.stiffness.references.iter().find(|found| found.reference == name)
}

/// A bar from end to end, parted from the next by what is not finite.
fn bar(ends: [(f64, f64); 2]) -> [(f64, f64); 3] {
    [ends[0], ends[1], (f64::NAN, f64::NAN)]
}

/// Both ends of the band of a value, which is this share of it to either side.
pub(super) fn ends_of(value: f64, share: f64) -> [f64; 2] {
    [-1.0, 1.0].map(|sign| value * (1.0 + sign * share))
}

/// Points with bars: `place` of a point, and of a point with its band the two ends.
fn points_and_bars(
    side: &Side,
    n: usize,
    reference: &str,
    place: impl Fn(&TangentRecord) -> (f64, f64),
    ends: impl Fn(&TangentRecord, &BandPointRecord) -> Option<[(f64, f64); 2]>,
) -> Vec<Series> {
    let Some(found) = reference_of(side, reference) else { return Vec::new() };
    let (_, color, dash, marker) = LOOKS[n];
    let band = side.stiffness.error_band.as_ref().and_then(|band| band.of(reference));
    let with_band = found.points.iter().zip(band.iter().flat_map(|band| &band.points));
    let bars = with_band.filter_map(|(point, band)| ends(point, band)).flat_map(bar);
    let bars = Series::line("", bars.collect(), color, Dash::Solid);
    let points = found.points.iter().map(place).collect();
    vec![bars, Series::marks(&named(n, &side.stiffness.study), points, color, marker).sampled(dash)]
}

fn forces_to(largest: f64) -> impl Iterator<Item = f64> {
    // denser at small loads, where the curves bend
    (0..=CURVE_POINTS).map(move |n| largest * (n as f64 / CURVE_POINTS as f64).powi(2))
}

fn tangents(sides: &[&Side; 2], reference: &str) -> String {
    let mut series = of_both(sides, |side, n| {
        let hertz = side.stiffness.touch.hertz_kn_per_m;
        let color = [GREY, ORANGE][n];
        let curve = forces_to(side.stiffness.law.range_kn[1]).map(|f| (f, hertz_tangent(hertz, f) * 1e-6));
        vec![Series::line(&named(n, "Hertz at the first touch"), curve.collect(), color, Dash::Dotted)]
    });
    series.extend(of_both(sides, |side, n| {
        let (_, color, dash, _) = LOOKS[n];
        let law = reference_of(side, reference).map(|found| found.law);
        let curve = |law: LawRecord| {
            forces_to(law.range_kn[1]).map(|f| (f, law.constants.tangent(f) * 1e-6)).collect()
        };
        law.map(|law| Series::line("", curve(law), color, dash)).into_iter().collect()
    }));
    series.extend(of_both(sides, |side, n| {
        let place = |p: &TangentRecord| (p.force_kn, p.tangent_kn_per_m * 1e-6);
        points_and_bars(side, n, reference, place, |p, band| {
            let (force, tangent) = place(p);
            Some(ends_of(tangent, band.tangent?).map(|tangent| (force, tangent)))
        })
    }));
    stacked(
        WIDTH,
        360,
        &[Panel::from_zero("load P, kN", "tangent stiffness dP/d\u{3b4}, 10\u{2076} kN/m", series)],
    )
}

fn displacements(sides: &[&Side; 2], reference: &str) -> String {
    let series = of_both(sides, |side, n| {
        let (_, color, dash, _) = LOOKS[n];
        let place = |p: &TangentRecord| (p.displacement_mm, p.force_kn);
        let points = reference_of(side, reference)
            .map_or_else(Vec::new, |found| found.points.iter().map(place).collect());
        let mut series = vec![Series::line("", points, color, dash)];
        series.extend(points_and_bars(side, n, reference, place, |p, band| {
            Some(ends_of(p.displacement_mm, band.displacement?).map(|mm| (mm, p.force_kn)))
        }));
        series
    });
    stacked(WIDTH, 340, &[Panel::from_zero("displacement \u{3b4}, mm", "load P, kN", series)])
}

fn horizontal(sides: &[&Side; 2]) -> String {
    let series = of_both(sides, |side, n| {
        let (_, color, dash, marker) = LOOKS[n];
        let Some(record) = &side.stiffness.horizontal else { return Vec::new() };
        let points: Vec<(f64, f64)> =
            record.points.iter().map(|p| (p.preload_kn, p.stiffness_kn_per_m * 1e-6)).collect();
        let band = record.error_band.as_ref().and_then(|band| band.band);
        let bars = points.iter().filter_map(|&(x, y)| Some(bar(ends_of(y, band?).map(|y| (x, y)))));
        let bars = Series::line("", bars.flatten().collect(), color, Dash::Solid);
        let ends = points.first().zip(points.last()).map(|(first, last)| [first.0, last.0]);
        let constant = side
            .stiffness
            .horizontal_kn_per_m
            .zip(ends)
            .map(|(value, ends)| Series::line("", ends.map(|x| (x, value * 1e-6)).to_vec(), color, dash));
        let marks = Series::marks(&named(n, &side.stiffness.study), points, color, marker).sampled(dash);
        constant.into_iter().chain([bars, marks]).collect()
    });
    stacked(WIDTH, 240, &[Panel::from_zero("vertical preload, kN", "dQ/dy, 10\u{2076} kN/m", series)])
}

/// Loads that both have at a shift, some of them from the smallest to the largest, kN.
pub(super) fn panel_loads(shifts: &[[&ShiftRecord; 2]]) -> Vec<f64> {
    let of_both = shifts.iter().flat_map(|[a, b]| {
        a.loads.iter().filter(|load| b.loads.iter().any(|other| other.force_kn == load.force_kn))
    });
    let mut loads: Vec<f64> = of_both.map(|load| load.force_kn).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let chosen = PANELS.min(loads.len());
    (0..chosen).map(|n| loads[n * (loads.len() - 1) / (chosen - 1).max(1)]).collect()
}

/// Over the shifts that both have, in the order of A's contact angles; none where there are none.
fn by_angle(sides: &[&Side; 2], reference: &str) -> Option<String> {
    let mut shifts = common_shifts(sides[0], sides[1]);
    shifts.retain(|both| both.iter().all(|shift| shift.touch.is_some()));
    shifts.sort_by(|x, y| x[0].angle().unwrap_or(0.0).total_cmp(&y[0].angle().unwrap_or(0.0)));
    let loads = panel_loads(&shifts);
    if loads.is_empty() {
        return None;
    }
    let names: Vec<[String; 2]> = shifts
        .iter()
        .map(|[a, b]| {
            let angle = |at: Option<f64>| with_minus_signs(&format!("{:.1}\u{b0}", at.unwrap_or(f64::NAN)));
            [format!("{} mm", number(a.shift_mm)), format!("{}, {}", angle(a.angle()), angle(b.angle()))]
        })
        .collect();
    let panel = |load: &f64| {
        let series = of_both(sides, |side, n| {
            let (_, color, dash, marker) = LOOKS[n];
            let at = |place: usize| place as f64 + BESIDE * (n as f64 - 0.5);
            let values: Vec<_> = shifts.iter().map(|both| tangent_at(both[n], *load, reference)).collect();
            let points = values.iter().enumerate();
            let points =
                points.map(|(place, value)| (at(place), value.map_or(f64::NAN, |value| value.value * 1e-6)));
            let bars = values.iter().enumerate().filter_map(|(place, value)| {
                let (value, error) = (value.as_ref()?.value, value.as_ref()?.error?);
                Some(bar([value - error, value + error].map(|tangent| (at(place), tangent * 1e-6))))
            });
            let bars = Series::line("", bars.flatten().collect(), color, Dash::Solid);
            vec![
                bars,
                Series::joined(&named(n, &side.stiffness.study), points.collect(), color, dash, marker),
            ]
        });
        let label = format!("k at {} kN, 10\u{2076} kN/m", number(*load));
        Panel::from_zero("lateral shift of the wheelset, and contact angles of A and B", &label, series)
    };
    let panels: Vec<Panel> = loads.iter().map(panel).collect();
    Some(stacked_over_names(WIDTH, 235, &panels, &[], &names))
}

fn patch(sides: &[&Side; 2]) -> String {
    let curve = |name: &str, value: fn(&LoadCurveRow) -> f64| {
        let series = of_both(sides, |side, n| {
            let (_, color, dash, marker) = LOOKS[n];
            let points = side.load_curve.iter().map(|row| (row.force_kn, value(row))).collect();
            vec![Series::joined(&named(n, &side.stiffness.study), points, color, dash, marker)]
        });
        Panel::from_zero("load P, kN", name, series)
    };
    stacked(
        WIDTH,
        200,
        &[
            curve("semi-axis along, mm", |row| row.semi_axis_along_mm),
            curve("semi-axis across, mm", |row| row.semi_axis_across_mm),
            curve("largest pressure, MPa", |row| row.max_pressure_mpa),
        ],
    )
}

fn forces(sides: &[&Side; 2], scenario: &str) -> String {
    let panel = |label: &str, value: fn(&HistoryRow) -> f64| {
        let series = of_both(sides, |side, n| {
            let (_, color, dash, _) = LOOKS[n];
            let run = side.runs.iter().find(|(name, _)| name == scenario);
            let points = run
                .iter()
                .flat_map(|(_, history)| &history.rows)
                .map(|row| (row.time, value(row) / KILONEWTON));
            vec![Series::line(&named(n, &side.stiffness.study), points.collect(), color, dash)]
        });
        Panel::from_zero("time, s", label, series)
    };
    stacked(
        WIDTH,
        260,
        &[
            panel("vertical force P, kN", |row| row.vertical_force),
            panel("lateral force Q, kN", |row| row.lateral_force),
        ],
    )
}
