//! The columns of `history.csv` of a track study.

use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use railspring_simulate::track::{TrackCase, TrackRow, TrackRun};

use crate::engine::columns::csv_of_texts;

/// A column: its name with its unit, what it means, and its value in a row.
pub struct TrackColumn {
    /// Its name.
    pub name: String,
    /// What it means.
    pub text: String,
    value: Box<dyn Fn(&TrackRow) -> f64>,
}

impl TrackColumn {
    fn new(name: &str, text: &str, value: impl Fn(&TrackRow) -> f64 + 'static) -> Self {
        Self { name: name.into(), text: text.into(), value: Box::new(value) }
    }

    /// Its value in a row.
    pub fn of(&self, row: &TrackRow) -> f64 {
        (self.value)(row)
    }
}

/// How the columns of a wheel begin: of a single one there is only one.
pub(super) fn sides(case: &TrackCase) -> &'static [&'static str] {
    if case.running.wheels() == 2 { &["right_", "left_"] } else { &[""] }
}

/// The columns of a load case.
pub fn columns_of(case: &TrackCase) -> Vec<TrackColumn> {
    let mut columns = vec![
        TrackColumn::new("time_s", "Time, s", |row| row.time),
        TrackColumn::new("x_m", "Place of the wheel, m from the rail's first end", |row| row.x),
    ];
    for (wheel, side) in sides(case).iter().enumerate() {
        let mut of = |name: &str, text: &str, value: fn(&railspring_simulate::track::WheelRow) -> f64| {
            let name = format!("{side}{name}");
            columns.push(TrackColumn::new(&name, text, move |row| value(&row.wheels[wheel])));
        };
        of("p_kn", "Vertical force P of the wheel on the rail, kN, positive down", |w| w.force / KILONEWTON);
        of("approach_mm", "Approach of hub and rail, mm; negative for a gap", |w| w.approach / MILLIMETRE);
        of("wheel_z_mm", "Displacement of the wheel, mm, positive down", |w| w.z / MILLIMETRE);
        of("rail_at_wheel_mm", "Displacement of the rail under the wheel, mm, positive down", |w| {
            w.rail / MILLIMETRE
        });
    }
    let suspended = |row: &TrackRow, at: usize| row.above.map_or(f64::NAN, |above| above[at]);
    columns.push(TrackColumn::new(
        "suspended_z_mm",
        "Displacement of the suspended mass, mm, positive down",
        move |row| suspended(row, 0) / MILLIMETRE,
    ));
    columns.push(TrackColumn::new(
        "suspended_acceleration_m_per_s2",
        "Acceleration of the suspended mass with that of the ground, m/s², positive down",
        move |row| suspended(row, 1),
    ));
    for (index, probe) in case.probes.iter().enumerate() {
        let mut of = |name: &str, text: &str, value: fn(&railspring_simulate::track::ProbeRow) -> f64| {
            let name = format!("{}_{name}", probe.name);
            columns.push(TrackColumn::new(&name, text, move |row| value(&row.probes[index])));
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
pub(super) fn csv(columns: &[TrackColumn], run: &TrackRun) -> Vec<u8> {
    let text = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    let heading = columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>();
    let rows = run.rows.iter().map(|row| columns.iter().map(|column| text(column.of(row))).collect());
    csv_of_texts(std::iter::once(heading).chain(rows))
}
