//! Uncertainty of springs by their inputs: the law with its band, and which input changes it most.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use serde_json::{Value, json};

use crate::report::bars::ValueAxis;
use crate::report::legend::{Entry, draw_legend, legend_height};
use crate::report::number::{WIDTH, number};
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{DARK, Dash, LIGHT, Marker, ORANGE, Series, frame, label, px, stroke, svg};
use crate::results::springs::record::{StiffnessRecord, TangentRecord};
use crate::results::springs::uncertainty_record::{
    InputUncertaintyRecord, UncertainInputRecord, UncertainPointRecord, UncertainRecord, between_loads,
};
use crate::rounding::significant;

/// Inputs that the figure names.
const NAMED: usize = 8;

/// The tangent of the solid with its band by the inputs.
pub fn band(stiffness: &StiffnessRecord) -> Option<String> {
    let uncertain = stiffness.input_uncertainty.as_ref().filter(|of| of.points.len() > 1)?;
    let of = stiffness.references.iter().find(|of| of.reference == stiffness.reference)?;
    let points = &uncertain.points;
    let ends = |point: &UncertainPointRecord| {
        let of = &point.tangent;
        // the width has all inputs, the percentiles those of the samples alone
        let middle = of.percentiles.map_or(0.0, |[low, high]| 0.5 * (low + high));
        [middle - of.input, middle + of.input]
    };
    let loads: Vec<f64> = points.iter().map(|point| point.force_kn).collect();
    let band = |p: &TangentRecord| {
        let (below, part) = between_loads(&loads, p.force_kn);
        let (from, to) = (ends(&points[below]), ends(&points[below + 1]));
        let change = |side: usize| 1.0 + from[side] + part * (to[side] - from[side]);
        (p.force_kn, [0, 1].map(|side| p.tangent_kn_per_m * 1e-6 * change(side)))
    };
    let solid = of.points.iter().map(|p| (p.force_kn, p.tangent_kn_per_m * 1e-6)).collect();
    let bands: Vec<(f64, [f64; 2])> = of.points.iter().map(band).collect();
    let mut series = Series::band("95 % band by the inputs", &bands, LIGHT);
    series.push(Series::joined("solid", solid, DARK, Dash::Solid, Marker::Disc));
    let panel = Panel::from_zero("load P, kN", "tangent stiffness dP/d\u{3b4}, 10\u{2076} kN/m", series);
    Some(stacked(WIDTH, 300, &[panel]))
}

/// What the band's figure shows.
pub fn band_caption(of: &InputUncertaintyRecord) -> String {
    let made = match of.points.first().and_then(|point| point.tangent.percentiles) {
        Some(_) => format!(
            "between 2.5 and 97.5 % of {} quasi-random samples, widened by the inputs that are known by their effect alone",
            of.samples
        ),
        None => "twice the standard uncertainty, to first order".into(),
    };
    format!("Tangent stiffness of the law in use with inputs that are not known exactly: the band is {made}.")
}

/// Change of the tangent at the middle load and of the horizontal stiffness over one standard uncertainty of each input, the largest first.
pub fn inputs(of: &InputUncertaintyRecord) -> Option<String> {
    const ROW: u32 = 40;
    const LEFT: u32 = 250;
    let point = of.middle()?;
    let mut values: Vec<(&str, RGBColor, &UncertainRecord)> =
        vec![("tangent stiffness", DARK, &point.tangent)];
    values.extend(of.horizontal.iter().map(|of| ("horizontal stiffness", ORANGE, of)));
    let size = |input: usize| values.iter().map(|(_, _, of)| of.changes[input].abs()).fold(0.0, f64::max);
    let mut named: Vec<usize> = (0..of.inputs.len()).filter(|&input| size(input) > 0.0).collect();
    named.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
    named.truncate(NAMED);
    let entries: Vec<Entry> = values.iter().map(|(name, color, _)| Entry::patch(name, *color)).collect();
    let top = legend_height(WIDTH, &entries);
    let height = top + ROW * named.len() as u32 + 52;
    Some(svg(WIDTH, height, |root| {
        let (legend, rest) = root.split_vertically(px(top));
        draw_legend(&legend, WIDTH, &entries)?;
        let ends = named.iter().flat_map(|&input| [-1e2 * size(input), 1e2 * size(input)]);
        let rows = ROW * named.len() as u32 + 4;
        let axis = ValueAxis::over(ends, LEFT, rows);
        axis.draw_grid(&rest)?;
        for (row, &input) in named.iter().enumerate() {
            let (first, last) = (px(ROW * row as u32 + 5), px(ROW * (row as u32 + 1) - 5));
            let style = label(12, HPos::Right, VPos::Center);
            let name = of.inputs[input].name.clone();
            rest.draw(&Text::new(name, (px(LEFT - 8), (first + last) / 2), style))?;
            let bar = (last - first) / values.len() as i32;
            for (index, (_, color, of)) in values.iter().enumerate() {
                let change = 1e2 * of.changes[input];
                let (left, right) = (axis.x(change.min(0.0)), axis.x(change.max(0.0)));
                let upper = first + bar * index as i32;
                let corners = [(left, upper), (right, upper + bar)];
                rest.draw(&Rectangle::new(corners, color.filled()))?;
                rest.draw(&frame(corners, stroke(BLACK, 6)))?;
            }
        }
        rest.draw(&PathElement::new([(axis.x(0.0), 0), (axis.x(0.0), px(rows))], stroke(BLACK, 8)))?;
        axis.draw_axis(&rest, "change over one standard uncertainty, %")
    }))
}

/// What the figure of the inputs shows.
pub fn inputs_caption(of: &InputUncertaintyRecord) -> String {
    let load = of.middle().map_or(f64::NAN, |point| point.force_kn);
    format!(
        "Which input changes the springs most: change of the tangent stiffness at {} kN and of the horizontal stiffness with each input one standard uncertainty up.",
        number((10.0 * load).round() / 10.0)
    )
}

/// The springs at each load with their uncertainty, and the inputs; null without any.
pub fn table(stiffness: &StiffnessRecord) -> Value {
    let Some(of) = &stiffness.input_uncertainty else { return Value::Null };
    let percent = |value: Option<f64>| value.map_or_else(|| "\u{2013}".into(), |v| significant(1e2 * v, 2));
    let row = |what: String, value: &UncertainRecord| {
        let leading: Vec<String> = value
            .ranked()
            .into_iter()
            .take(3)
            .map(|i| format!("{} {:+.2} %", of.inputs[i].name, 1e2 * value.changes[i]))
            .collect();
        json!({
            "what": what,
            "linear": percent(Some(value.linear)),
            "sampled": percent(value.sampled),
            "input": percent(Some(value.input)),
            "numerical": percent(value.numerical),
            "combined": percent(value.combined),
            "leading": leading.join(", "),
        })
    };
    let mut rows = Vec::new();
    for point in &of.points {
        let at = |what: &str| format!("{what} at {} kN", significant(point.force_kn, 3));
        rows.push(row(at("displacement"), &point.displacement));
        rows.push(row(at("tangent"), &point.tangent));
        rows.push(row(at("patch area"), &point.area));
        rows.push(row(at("largest pressure"), &point.pressure));
    }
    rows.extend(of.horizontal.as_ref().map(|value| row("horizontal stiffness".into(), value)));
    let input = |input: &UncertainInputRecord| {
        let standard = input.standard.map_or_else(
            || "by its effect".into(),
            |value| format!("{} {}", significant(value, 2), input.unit).trim().to_owned(),
        );
        [input.name.clone(), standard, input.distribution.clone(), input.key.clone().unwrap_or_default()]
    };
    let law = of.law.as_ref().map(|law| {
        let [a, b, c] = [law.a_kn_per_m, law.b_kn_per_m, law.c].map(|value| significant(value, 2));
        let correlation = law.covariance[1][2] / (law.b_kn_per_m * law.c);
        format!(
            "Standard uncertainty of the constants over the samples: a {a} kN/m, b {b} kN/m, c {c}; correlation of b and c {}.",
            significant(correlation, 2)
        )
    });
    json!({
        "missing": of.missing,
        "rows": rows,
        "inputs": of.inputs.iter().map(input).collect::<Vec<_>>(),
        "samples": of.samples,
        "failed": of.failed,
        "law": law,
    })
}
