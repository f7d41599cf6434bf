//! `report.html` of a track study: what was verified, the largest values, curves and keys.

use serde_json::{Value, json};

use super::columns::{TrackColumn, of_wheels};
use super::record::TrackRecord;
use crate::report::accessible::inline;
use crate::report::html;
use crate::report::number::{WIDTH, number};
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{BLUE, DARK, Dash, Series};

/// Most intervals of a curve; of each its smallest and its largest value are drawn.
const INTERVALS: usize = 600;
/// Height of a panel, pixels.
const HEIGHT: u32 = 220;

/// A figure: panels, each the end of its columns' names and its label, and a caption.
type Figure = (&'static [(&'static str, &'static str)], &'static str);

/// The figures that a wheelset across the track has besides.
const LATERAL: [Figure; 4] = [
    (
        &[("q_kn", "Q, kN"), ("q_over_p", "Q/P"), ("q_over_p_2m", "Q/P, 2 m mean")],
        "Lateral force of the wheels on the rails to their field sides, its ratio to the vertical force, and that of forces below 20 Hz averaged over the last 2 m (EN 14363), over time.",
    ),
    (
        &[("unloading", "unloading"), ("flange_tip_mm", "flange tip, mm"), ("contacts", "contacts")],
        "Wheel unloading, height of the flange's tip above the rail's top (a wheel with a positive one is not guided), and number of contacts over time.",
    ),
    (
        &[
            ("wheelset_y_mm", "wheelset y, mm"),
            ("wheelset_z_mm", "wheelset z, mm"),
            ("wheelset_roll_mrad", "roll, mrad"),
            ("suspended_y_mm", "suspended y, mm"),
            ("suspended_roll_mrad", "suspended roll, mrad"),
        ],
        "Wheelset and suspended mass over time: displacements to the right and down against the ground, and roll, positive where it lowers the right side.",
    ),
    (
        &[("suspension_y_kn", "lateral, kN"), ("suspension_z_kn", "vertical, kN")],
        "Forces of the suspensions on the wheelset along its own axes, to the right and down, over time.",
    ),
];

/// The page; self-contained.
pub(super) fn page(record: &TrackRecord, columns: &[TrackColumn]) -> String {
    let time = &columns[0].values;
    let mut figures = Vec::new();
    let both = |end: &str| of_wheels(columns, end);
    figures.push(drawn(
        &[panel(&both("p_kn"), time, "P, kN")],
        "Vertical force of the wheel on the rail over time.",
    ));
    for (all, caption) in LATERAL {
        let panels: Vec<Panel> = all
            .iter()
            .filter_map(|(end, label)| Some((both(end), label)).filter(|(columns, _)| !columns.is_empty()))
            .map(|(columns, label)| panel(&columns, time, label))
            .collect();
        if !panels.is_empty() {
            figures.push(drawn(&panels, caption));
        }
    }
    for column in columns.iter().filter(|column| column.name.ends_with("_deflection_mm")) {
        let probe = column.name.trim_end_matches("_deflection_mm");
        let named = |end: &str| columns.iter().find(|column| column.name == format!("{probe}_{end}"));
        let panels: Vec<Panel> = [
            (Some(column), "deflection, mm"),
            (named("lateral_mm"), "lateral, mm"),
            (named("twist_mrad"), "rotation, mrad"),
            (named("moment_kn_m"), "moment, kN·m"),
            (named("torsion_kn_m"), "torsion, kN·m"),
            (named("acceleration_m_per_s2"), "acceleration, m/s²"),
        ]
        .into_iter()
        .filter_map(|(column, label)| Some(panel(&[column?], time, label)))
        .collect();
        let what = if named("twist_mrad").is_some() {
            "displacements, moments"
        } else {
            "deflection, bending moment"
        };
        let caption = format!("Probe {probe}: {what} and acceleration over time.");
        figures.push(drawn(&panels, &caption));
    }
    let row = |at: &super::record::Extreme| json!([number(at.value), number(at.time_s), number(at.x_m)]);
    let rows: Vec<Value> = record
        .figures
        .iter()
        .map(|f| json!({ "name": f.column, "text": f.text, "smallest": row(&f.smallest), "largest": row(&f.largest) }))
        .collect();
    let mut keys = Vec::new();
    flatten("", &record.keys, &mut keys);
    html::render(
        "track.html",
        json!({
            "name": record.study,
            "description": record.description,
            "completed": record.ending == "completed",
            "lateral": columns.iter().any(|column| column.name == "wheelset_y_mm"),
            "rows": record.rows,
            "unknowns": record.unknowns,
            "verification": record.verification.reason,
            "notes": record.notes,
            "figures": figures,
            "extremes": rows,
            "files": record.files,
            "keys": keys,
            "version": format!("{} ({})", record.version, record.commit),
        }),
    )
}

fn drawn(panels: &[Panel], caption: &str) -> Value {
    json!({ "svg": inline(&stacked(WIDTH, HEIGHT, panels), caption), "caption": caption })
}

fn panel(columns: &[&TrackColumn], time: &[f64], label: &str) -> Panel {
    let styles = [(DARK, Dash::Solid), (BLUE, Dash::Dashed)];
    let series = columns.iter().zip(styles).map(|(column, (color, dash))| {
        let name = if columns.len() > 1 { column.name.split('_').next().unwrap_or_default() } else { "" };
        Series::line(name, thinned(column, time), color, dash)
    });
    Panel::from_zero("time, s", label, series.collect())
}

/// A curve over time; of many rows the smallest and the largest value of each interval.
fn thinned(column: &TrackColumn, time: &[f64]) -> Vec<(f64, f64)> {
    let all: Vec<(f64, f64)> = time.iter().copied().zip(column.values.iter().copied()).collect();
    if all.len() <= 2 * INTERVALS {
        return all;
    }
    let mut kept = Vec::with_capacity(2 * INTERVALS);
    for interval in all.chunks(all.len().div_ceil(INTERVALS)) {
        let by = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let ends = [interval.iter().min_by(by), interval.iter().max_by(by)];
        let mut ends: Vec<(f64, f64)> = ends.into_iter().flatten().copied().collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.extend(ends);
    }
    kept
}

/// Keys with their values, each with its path.
fn flatten(path: &str, value: &Value, keys: &mut Vec<[String; 2]>) {
    match value {
        Value::Object(inner) => {
            for (key, value) in inner.iter().filter(|(key, _)| *key != "description") {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                flatten(&path, value, keys);
            }
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            for (index, item) in items.iter().enumerate() {
                flatten(&format!("{path}[{index}]"), item, keys);
            }
        }
        Value::Null => {}
        Value::String(text) => keys.push([path.into(), text.clone()]),
        other => keys.push([path.into(), other.to_string()]),
    }
}
