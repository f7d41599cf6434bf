//! The chapter on cross-validation: one self-contained page that can be handed over.

use minijinja::value::Serde;
use nalgebra::{Point2, Vector3};
use plotters::prelude::*;
use railspring_calibrate::mesh::HexMesh;
use serde_json::{Value, json};

use super::compare::{Cause, Check, ReferenceResult};
use super::{CrosscheckRecord, Prepared};
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{BLUE, DARK, Dash, GREY, Marker, ORANGE, RED, Series, px, svg, text};

/// Template of the page.
const TEMPLATE: &str = include_str!("page.html");
/// Width of figures, px.
const WIDTH: u32 = 860;
/// Differences that the colours span, as powers of ten of the largest displacement.
const DECADES: (f64, f64) = (-16.0, -8.0);

/// `crosscheck.html`.
pub fn page(record: &CrosscheckRecord, prepared: &Prepared, reference: &ReferenceResult) -> String {
    let mut figures = vec![json!({
        "svg": inline(&curves(record)),
        "caption": "Difference of hub displacement and tangent stiffness from the judges, relative to the tool, over the load.",
    })];
    for (k, (name, mesh, answer)) in [
        ("rail", &prepared.meshes.rail, &prepared.answers.rail),
        ("wheel", &prepared.meshes.wheel, &prepared.answers.wheel),
    ]
    .into_iter()
    .enumerate()
    {
        let theirs = reference.displacement(k);
        // a mesh that is not swept may have no section there
        if theirs.len() == answer.displacement.len() && !mesh.middle_section().is_empty() {
            figures.push(json!({
                "svg": inline(&section(mesh, &answer.displacement, theirs)),
                "caption": format!("Where the {name}'s displacements under the given forces differ: the section under the load, coloured by the power of ten of the difference over the largest displacement."),
            }));
        }
    }
    let mut environment = minijinja::Environment::new();
    environment.set_auto_escape_callback(|_| minijinja::AutoEscape::Html);
    let context = json!({
        "r": record,
        "failed": record.checks.iter().filter(|c| !c.holds).count(),
        "summary": summary(&record.checks),
        "rows": record.checks.iter().map(row).collect::<Vec<_>>(),
        "figures": figures,
    });
    environment
        .render_str(TEMPLATE, minijinja::Value::from(Serde(context)))
        .unwrap_or_else(|cause| format!("<!doctype html><p>The page could not be written: {cause}</p>"))
}

fn inline(svg: &str) -> String {
    svg.trim_start_matches("<?xml version=\"1.0\" encoding=\"UTF-8\"?>").to_string()
}

/// The worst check of each quantity of each problem, in order of appearance.
pub fn worst(checks: &[Check]) -> Vec<(&Check, bool)> {
    let mut found: Vec<(&Check, bool)> = Vec::new();
    for check in checks {
        let same =
            |c: &Check| c.problem == check.problem && c.quantity == check.quantity && c.judge == check.judge;
        match found.iter_mut().find(|(c, _)| same(c)) {
            // differences that are not a number are the worst of all
            Some((c, holds)) => {
                *holds &= check.holds;
                if check.difference.total_cmp(&c.difference).is_gt() {
                    *c = check;
                }
            }
            None => found.push((check, check.holds)),
        }
    }
    found
}

fn summary(checks: &[Check]) -> Vec<Value> {
    worst(checks)
        .into_iter()
        .map(|(c, holds)| {
            json!({
                "problem": c.problem,
                "quantity": c.quantity,
                "judge": c.judge,
                "difference": format!("{:.2e}", c.difference),
                "load": c.load_kn.map_or_else(String::new, |l| l.to_string()),
                "limit": format!("{:.0e}", c.limit),
                "cause": match c.cause {
                    Cause::Roundoff => "ROUNDOFF",
                    Cause::Solver => "SOLVER",
                    Cause::Discretisation => "DISCRETISATION",
                    Cause::Model => "MODEL",
                },
                "holds": holds,
            })
        })
        .collect()
}

fn row(c: &Check) -> Value {
    json!({
        "problem": c.problem,
        "quantity": c.quantity,
        "load": c.load_kn.map_or_else(String::new, |l| l.to_string()),
        "tool": format!("{:.6}", c.tool),
        "judged": format!("{:.6}", c.judged),
        "unit": c.unit,
        "difference": format!("{:.2e}", c.difference),
        "holds": c.holds,
    })
}

/// Differences over the load, a panel for each quantity.
fn curves(record: &CrosscheckRecord) -> String {
    const LOOKS: [(RGBColor, Marker); 5] = [
        (DARK, Marker::Disc),
        (RED, Marker::Circle),
        (ORANGE, Marker::Square),
        (BLUE, Marker::Triangle),
        (GREY, Marker::Disc),
    ];
    let panel = |quantity: &str, label: &str| {
        let mut problems: Vec<(&str, &str)> = Vec::new();
        for c in record.checks.iter().filter(|c| c.quantity == quantity) {
            if !problems.contains(&(&c.problem, &c.judge)) {
                problems.push((&c.problem, &c.judge));
            }
        }
        let series = problems
            .iter()
            .zip(LOOKS)
            .map(|(&(problem, judge), (color, marker))| {
                let points = record
                    .checks
                    .iter()
                    .filter(|c| c.problem == problem && c.judge == judge && c.quantity == quantity)
                    .filter_map(|c| Some((c.load_kn?, 100.0 * (c.judged / c.tool - 1.0))))
                    .collect();
                Series::joined(&format!("{problem} ({judge})"), points, color, Dash::Solid, marker)
            })
            .collect();
        Panel { x_label: "load, kN".into(), y_label: label.into(), from_zero: true, series }
    };
    stacked(
        WIDTH,
        220,
        &[
            panel("hub displacement", "hub displacement, %"),
            panel("tangent stiffness", "tangent stiffness, %"),
        ],
    )
}

/// The section of a mesh under the load, every quadrilateral coloured by the largest
/// difference at its corners.
fn section(mesh: &HexMesh, own: &[Vector3<f64>], theirs: &[Vector3<f64>]) -> String {
    const MARGIN: f64 = 12.0;
    const BAR: f64 = 34.0;
    let scale = own.iter().map(Vector3::norm).fold(0.0, f64::max);
    let quads = mesh.middle_section();
    // across the track to the right, height up; the layer is a plane through the axle or across the rail
    let at = |n: usize| Point2::new(mesh.nodes[n].y, mesh.nodes[n].z);
    let corners = || quads.iter().flatten().map(|&n| at(n));
    let bound = |f: fn(f64, f64) -> f64, start: f64, axis: usize| corners().map(|p| p[axis]).fold(start, f);
    let (y0, y1) = (bound(f64::min, f64::INFINITY, 0), bound(f64::max, f64::NEG_INFINITY, 0));
    let (z0, z1) = (bound(f64::min, f64::INFINITY, 1), bound(f64::max, f64::NEG_INFINITY, 1));
    let zoom = ((f64::from(WIDTH) - 2.0 * MARGIN) / (y1 - y0)).min(420.0 / (z1 - z0));
    let height = ((z1 - z0) * zoom + 2.0 * MARGIN + BAR) as u32;
    let left = 0.5 * (f64::from(WIDTH) - (y1 - y0) * zoom);
    svg(WIDTH, height, |area| {
        let pixel = |x: f64, y: f64| ((x * f64::from(px(1))) as i32, (y * f64::from(px(1))) as i32);
        for quad in &quads {
            let difference = quad.iter().map(|&n| (own[n] - theirs[n]).norm()).fold(0.0, f64::max) / scale;
            let shape: Vec<(i32, i32)> = quad
                .iter()
                .map(|&n| at(n))
                .map(|p| pixel(left + (p.x - y0) * zoom, MARGIN + BAR + (p.y - z0) * zoom))
                .collect();
            area.draw(&Polygon::new(shape, shade(difference.max(1e-300).log10()).filled()))?;
        }
        for decade in DECADES.0 as i32..=DECADES.1 as i32 {
            let x = MARGIN + 70.0 * f64::from(decade - DECADES.0 as i32);
            area.draw(&Rectangle::new(
                [pixel(x, 8.0), pixel(x + 14.0, 20.0)],
                shade(f64::from(decade)).filled(),
            ))?;
            area.draw(&Text::new(format!("1e{decade}"), pixel(x + 18.0, 8.0), text(11, BLACK)))?;
        }
        Ok(())
    })
}

/// Light for small, dark red for large powers of ten.
fn shade(power: f64) -> RGBColor {
    let t = ((power - DECADES.0) / (DECADES.1 - DECADES.0)).clamp(0.0, 1.0);
    let mix = |a: f64, b: f64| (a + (b - a) * t) as u8;
    RGBColor(mix(228.0, 130.0), mix(236.0, 16.0), mix(244.0, 20.0))
}
