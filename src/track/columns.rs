//! The columns of `history.csv` of a track study.

use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use railspring_simulate::track::{TrackCase, TrackRow, TrackRun};

use crate::engine::columns::csv_of_texts;

/// A column: its name with its unit, what it means, and its values over the rows; a cell without a value is no number.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackColumn {
    /// Its name.
    pub name: String,
    /// What it means.
    pub text: String,
    /// Its values.
    pub values: Vec<f64>,
}

impl TrackColumn {
    /// Of the rows of a run.
    pub(super) fn of<R>(rows: &[R], name: &str, text: &str, value: impl Fn(&R) -> f64) -> Self {
        Self { name: name.into(), text: text.into(), values: rows.iter().map(value).collect() }
    }
}

/// The columns of the wheels whose names end so, such as `p_kn`.
pub(super) fn of_wheels<'c>(columns: &'c [TrackColumn], end: &str) -> Vec<&'c TrackColumn> {
    let names = ["", "right_", "left_"].map(|side| format!("{side}{end}"));
    columns.iter().filter(|column| names.contains(&column.name)).collect()
}

/// How the columns of a wheel begin: of a single one there is only one.
pub(super) fn sides(case: &TrackCase) -> &'static [&'static str] {
    if case.running.wheels() == 2 { &["right_", "left_"] } else { &[""] }
}

/// The columns of a run in the vertical plane.
pub(super) fn columns_of(case: &TrackCase, run: &TrackRun) -> Vec<TrackColumn> {
    let column = |name: &str, text: &str, value: &dyn Fn(&TrackRow) -> f64| {
        TrackColumn::of(&run.rows, name, text, value)
    };
    let mut columns = vec![
        column("time_s", "Time, s", &|row| row.time),
        column("x_m", "Place of the wheel, m from the rail's first end", &|row| row.x),
    ];
    for (wheel, side) in sides(case).iter().enumerate() {
        let mut of = |name: &str, text: &str, value: fn(&railspring_simulate::track::WheelRow) -> f64| {
            let name = format!("{side}{name}");
            columns.push(column(&name, text, &|row| value(&row.wheels[wheel])));
        };
        of("p_kn", "Vertical force P of the wheel on the rail, kN, positive down", |w| w.force / KILONEWTON);
        of("approach_mm", "Approach of hub and rail, mm; negative for a gap", |w| w.approach / MILLIMETRE);
        of("wheel_z_mm", "Displacement of the wheel, mm, positive down", |w| w.z / MILLIMETRE);
        of("rail_at_wheel_mm", "Displacement of the rail under the wheel, mm, positive down", |w| {
            w.rail / MILLIMETRE
        });
    }
    let suspended = |row: &TrackRow, at: usize| row.above.map_or(f64::NAN, |above| above[at]);
    columns.push(column("suspended_z_mm", "Displacement of the suspended mass, mm, positive down", &|row| {
        suspended(row, 0) / MILLIMETRE
    }));
    columns.push(column(
        "suspended_acceleration_m_per_s2",
        "Acceleration of the suspended mass with that of the ground, m/s², positive down",
        &|row| suspended(row, 1),
    ));
    for (index, probe) in case.probes.iter().enumerate() {
        let mut of = |name: &str, text: &str, value: fn(&railspring_simulate::track::ProbeRow) -> f64| {
            let name = format!("{}_{name}", probe.name);
            columns.push(column(&name, text, &|row| value(&row.probes[index])));
        };
        of("deflection_mm", "Deflection at the probe against the ground, mm, positive down", |p| {
            p.deflection / MILLIMETRE
        });
        of("moment_kn_m", "Bending moment there, kN·m, positive where the lower side is in tension", |p| {
            p.moment / KILONEWTON
        });
        of(
            "acceleration_m_per_s2",
            "Acceleration there with that of the ground, m/s², positive down",
            |p| p.acceleration,
        );
    }
    columns
}

/// The history as CSV; a cell without a value is empty.
pub(super) fn csv(columns: &[TrackColumn]) -> Vec<u8> {
    let text = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    let heading = columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>();
    let count = columns.first().map_or(0, |column| column.values.len());
    let rows = (0..count).map(|row| columns.iter().map(|column| text(column.values[row])).collect());
    csv_of_texts(std::iter::once(heading).chain(rows))
}
