//! `history.csv` and `solid_history.csv`: one row per time step.
//!
//! Forces in kN, positions in mm, each in the frame that its name says. The
//! contacts of a row follow each other from the gauge side to the field side;
//! a contact that does not exist has the mode `separated` and empty cells.

use std::iter::once;
use std::path::Path;

use nalgebra::Point2;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use railspring_simulate::time::energy::EnergyBalance;
use railspring_simulate::time::history::{ContactMode, ContactState, Ending, History, HistoryRow};
use serde_json::Value;

use crate::engine::columns::{Cell, Column, columns, csv_of_texts, properties, schema};
use crate::verify::low_passed;

/// Columns before those of the contacts.
fn of_row() -> Vec<Column<HistoryRow>> {
    columns! { HistoryRow:
        "time_s", "Time, s", |row| row.time;
        "p_kn", "Vertical force P of the wheel on the rail, kN, positive down", |row| row.vertical_force / KILONEWTON;
        "q_kn", "Lateral force Q of the wheel on the rail, kN, positive to the field side",
            |row| row.lateral_force / KILONEWTON;
        "q_over_p", "Q over P; none where P is not positive",
            |row| (row.vertical_force > 0.0).then(|| row.lateral_force / row.vertical_force);
        "wheel_y_mm", "Lateral displacement of the wheel centre, mm, positive to the field side",
            |row| row.wheel_y / MILLIMETRE;
        "wheel_z_mm", "Vertical displacement of the wheel centre, mm, positive down", |row| row.wheel_z / MILLIMETRE;
        "load_y_mm", "Lateral displacement of the point where the lateral force acts, mm",
            |row| row.load_y / MILLIMETRE;
        "mode", "`stick` where a contact sticks, `slip` where all slide, `separated` without one",
            |row| row.mode().name();
        "kinetic_j", "Kinetic energy of all masses, J; none at full order, as the columns that follow",
            |row| Some(row.energy?.kinetic);
        "elastic_j", "Elastic energy of bodies, springs and contact, J", |row| Some(row.energy?.elastic);
        "work_j", "Work of forces and weights, J", |row| Some(row.energy?.work);
        "damped_j", "Energy dissipated by material and dampers, J", |row| Some(row.energy?.damped);
        "friction_j", "Energy dissipated by friction, J", |row| Some(row.energy?.friction);
        "energy_drift_j", "Excess of the energy over the balance, J", |row| Some(row.energy?.drift);
    }
}

/// The forces of a row below 20 Hz (EN 14363), kN.
#[derive(Debug, Clone, Copy, Default)]
struct LowPassed {
    p: Option<f64>,
    q: Option<f64>,
}

impl LowPassed {
    /// Of all rows. They are made from what the file has of the rows, with its digits, so that a history that was read has the same.
    fn of(rows: &[HistoryRow]) -> Vec<Self> {
        let written = |value: f64| number(value).parse().unwrap_or(value);
        let times: Vec<f64> = rows.iter().map(|row| written(row.time)).collect();
        let of = |force: fn(&HistoryRow) -> f64| {
            low_passed(&times, rows.iter().map(|row| written(force(row) / KILONEWTON)).collect())
        };
        match (of(|row| row.vertical_force), of(|row| row.lateral_force)) {
            (Some(p), Some(q)) => {
                p.into_iter().zip(q).map(|(p, q)| Self { p: Some(p), q: Some(q) }).collect()
            }
            _ => vec![Self::default(); rows.len()],
        }
    }
}

/// Columns of the forces below 20 Hz, which follow those of the row.
fn of_low_passed() -> Vec<Column<LowPassed>> {
    columns! { LowPassed:
        "p_20hz_kn", "P below 20 Hz by EN 14363, kN, 21 ms late; none where time steps are unequal or longer than 5 ms",
            |at| at.p;
        "q_20hz_kn", "The same of Q, kN", |at| at.q;
        "q_over_p_20hz", "Q over P of these two; none where P is not positive",
            |at| at.p.zip(at.q).filter(|(p, _)| *p > 0.0).map(|(p, q)| q / p);
    }
}

/// Columns of one contact, with its number in the place of the star.
fn of_contact() -> Vec<Column<Option<ContactState>>> {
    columns! { Option<ContactState>:
        "contact_*_mode", "`stick`, `slip`, or `separated` for a contact that does not exist",
            |at| at.map_or(ContactMode::Separated, |at| at.mode).name();
        "contact_*_normal_kn", "Normal force, kN", |at| at.map(|at| at.normal_force / KILONEWTON);
        "contact_*_tangential_kn", "Lateral tangential force, kN", |at| at.map(|at| at.tangential_force / KILONEWTON);
        "contact_*_rail_y_mm", "Place on the rail, rail profile frame, lateral, mm",
            |at| at.map(|at| at.rail.x / MILLIMETRE);
        "contact_*_rail_z_mm", "The same, vertical, mm", |at| at.map(|at| at.rail.y / MILLIMETRE);
        "contact_*_wheel_y_mm", "Place on the wheel, wheel profile frame, lateral, mm",
            |at| at.map(|at| at.wheel.x / MILLIMETRE);
        "contact_*_wheel_z_mm", "The same, vertical, mm", |at| at.map(|at| at.wheel.y / MILLIMETRE);
    }
}

/// The JSON schema of a row.
pub fn row_schema() -> Value {
    let mut all = properties(&of_row());
    all.extend(properties(&of_low_passed()));
    all.extend(properties(&of_contact()));
    schema(
        "HistoryRow",
        "One row of a history: a time step. Contacts have numbers from the gauge side on.",
        &all,
    )
}

/// The number of the first of the columns of the balance of energy, which are empty where the run has none.
const ENERGY: usize = 8;
/// Tread and flange: every file has room for these.
const CONTACTS_AT_LEAST: usize = 2;

/// A file with room for some contacts.
struct Layout {
    of_row: Vec<Column<HistoryRow>>,
    /// None in a file of a version without them.
    of_low_passed: Vec<Column<LowPassed>>,
    of_contact: Vec<Column<Option<ContactState>>>,
    contacts: usize,
}

impl Layout {
    fn new(contacts: usize) -> Self {
        Self { of_row: of_row(), of_low_passed: of_low_passed(), of_contact: of_contact(), contacts }
    }

    /// Columns before those of the contacts.
    fn before_contacts(&self) -> usize {
        self.of_row.len() + self.of_low_passed.len()
    }

    /// Names of the columns.
    fn heading(&self) -> Vec<String> {
        let of_contact = |number: usize| {
            self.of_contact.iter().map(move |column| column.name.replace('*', &number.to_string()))
        };
        let of_row = self.of_row.iter().map(|column| column.name.to_owned());
        let of_row = of_row.chain(self.of_low_passed.iter().map(|column| column.name.to_owned()));
        of_row.chain((1..=self.contacts).flat_map(of_contact)).collect()
    }

    /// One line of the file.
    fn cells(&self, row: &HistoryRow, low_passed: &LowPassed) -> Vec<String> {
        let contacts = (0..self.contacts).map(|index| row.contacts.get(index).copied());
        let of_contacts = contacts.flat_map(|at| self.of_contact.iter().map(move |of| (of.value)(&at)));
        let of_low_passed = self.of_low_passed.iter().map(|of| (of.value)(low_passed));
        self.of_row
            .iter()
            .map(|of| (of.value)(row))
            .chain(of_low_passed)
            .chain(of_contacts)
            .map(cell_text)
            .collect()
    }
}

/// A cell as it is written.
fn cell_text(cell: Cell) -> String {
    match cell {
        Cell::Number(value) => value.map_or_else(String::new, number),
        Cell::Text(text) => text,
    }
}

/// The file's bytes.
pub fn write(history: &History) -> Vec<u8> {
    let contacts = history.rows.iter().map(|row| row.contacts.len()).max().unwrap_or(0);
    let layout = Layout::new(contacts.max(CONTACTS_AT_LEAST));
    let low_passed = LowPassed::of(&history.rows);
    let rows = history.rows.iter().zip(&low_passed).map(|(row, low)| layout.cells(row, low));
    csv_of_texts(once(layout.heading()).chain(rows))
}

/// Twelve significant digits, in the shortest form.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    let magnitude = rounded.abs();
    if (1e-4..1e9).contains(&magnitude) { format!("{rounded}") } else { format!("{rounded:e}") }
}

/// Reads a history back; the degrees of freedom and how the run ended are not in the file.
///
/// # Errors
/// [`InputError`] whose key is the path with the line, if the file has another content. That is other
/// columns, no row, or a value that is not a finite number. It is also a time that is not after that of the
/// row before, and cells of a row that contradict each other.
pub fn read(path: &Path, text: &str, degrees_of_freedom: usize, ending: Ending) -> Result<History> {
    let broken = |row: u64, what: String| -> railspring_profiles::error::Error {
        InputError::new(
            format!("{}:{row}", path.display()),
            what,
            "a history as `railspring simulate` or `railspring verify` writes it",
            "write it again with that command",
        )
        .into()
    };
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let heading = reader.headers().map_err(|cause| broken(1, cause.to_string()))?.clone();
    let mut layout = Layout::new(0);
    if !heading.iter().any(|name| name == layout.of_low_passed[0].name) {
        layout.of_low_passed.clear();
    }
    let (of_row, before, each) = (layout.of_row.len(), layout.before_contacts(), layout.of_contact.len());
    layout.contacts = heading.len().saturating_sub(before) / each;
    if heading != layout.heading() {
        return Err(broken(1, heading.iter().collect::<Vec<_>>().join(",")));
    }
    let mut rows: Vec<HistoryRow> = Vec::new();
    // what follows from all rows: line and cells
    let mut low_passed: Vec<(u64, Vec<String>)> = Vec::new();
    for record in reader.records() {
        let record = record
            .map_err(|cause| broken(cause.position().map_or(1, csv::Position::line), cause.to_string()))?;
        let line = record.position().map_or(1, csv::Position::line);
        let cell = |column: usize| record.get(column).unwrap_or_default();
        // A number may be finite in the file and too large in SI units.
        let value = |column: usize, unit: f64| -> Result<f64> {
            let value: Option<f64> = cell(column).parse().ok();
            value
                .map(|value| value * unit)
                .filter(|value| value.is_finite())
                .ok_or_else(|| broken(line, format!("{:?} in column {}", cell(column), column + 1)))
        };
        let point = |column: usize| -> Result<Point2<f64>> {
            Ok(Point2::new(value(column, MILLIMETRE)?, value(column + 1, MILLIMETRE)?))
        };
        let mut contacts = Vec::new();
        for start in (before..heading.len()).step_by(each) {
            let mode = match cell(start) {
                "stick" => ContactMode::Stick,
                "slip" => ContactMode::Slip,
                "separated" => continue,
                other => return Err(broken(line, format!("{other:?} in column {}", start + 1))),
            };
            contacts.push(ContactState {
                mode,
                normal_force: value(start + 1, KILONEWTON)?,
                tangential_force: value(start + 2, KILONEWTON)?,
                rail: point(start + 3)?,
                wheel: point(start + 5)?,
            });
        }
        let energy = match (ENERGY..of_row).all(|column| cell(column).is_empty()) {
            true => None,
            false => Some(EnergyBalance {
                kinetic: value(ENERGY, 1.0)?,
                elastic: value(ENERGY + 1, 1.0)?,
                work: value(ENERGY + 2, 1.0)?,
                damped: value(ENERGY + 3, 1.0)?,
                friction: value(ENERGY + 4, 1.0)?,
                drift: value(ENERGY + 5, 1.0)?,
            }),
        };
        let row = HistoryRow {
            time: value(0, 1.0)?,
            vertical_force: value(1, KILONEWTON)?,
            lateral_force: value(2, KILONEWTON)?,
            wheel_y: value(4, MILLIMETRE)?,
            wheel_z: value(5, MILLIMETRE)?,
            load_y: value(6, MILLIMETRE)?,
            energy,
            contacts,
        };
        // What follows from other cells, or is empty because there is no contact, must say the same.
        let written = layout.cells(&row, &LowPassed::default());
        low_passed.push((line, (of_row..before).map(|column| cell(column).to_owned()).collect()));
        let differs = record
            .iter()
            .zip(&written)
            .enumerate()
            .position(|(i, (found, expected))| !(of_row..before).contains(&i) && !same(found, expected));
        if let Some(column) = differs {
            let (found, expected) = (cell(column), &written[column]);
            let what =
                format!("{found:?} in column {} where the rest of the row has {expected:?}", column + 1);
            return Err(broken(line, what));
        }
        rows.push(row);
        if let [.., before, last] = &rows[..]
            && last.time <= before.time
        {
            return Err(broken(line, format!("{} s after {} s", last.time, before.time)));
        }
    }
    if rows.is_empty() {
        return Err(broken(2, "no row".into()));
    }
    for ((line, found), of) in low_passed.iter().zip(LowPassed::of(&rows)) {
        let expected: Vec<String> =
            layout.of_low_passed.iter().map(|column| cell_text((column.value)(&of))).collect();
        if let Some(i) = found.iter().zip(&expected).position(|(found, expected)| !same(found, expected)) {
            let what = format!(
                "{:?} in column {} where the forces of all rows have {:?}",
                found[i],
                of_row + i + 1,
                expected[i]
            );
            return Err(broken(*line, what));
        }
    }
    Ok(History { rows, degrees_of_freedom, ending })
}

/// Whether two cells say the same: the same text, or numbers that differ by the rounding to twelve digits alone.
fn same(a: &str, b: &str) -> bool {
    const ROUNDOFF: f64 = 2e-11;
    let number = |text: &str| text.parse::<f64>().ok();
    a == b
        || number(a)
            .zip(number(b))
            .is_some_and(|(a, b)| (a - b).abs() <= ROUNDOFF * a.abs().max(b.abs()) + f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time: f64, contacts: usize) -> HistoryRow {
        let contact = |i: usize| ContactState {
            mode: if i == 0 { ContactMode::Slip } else { ContactMode::Stick },
            rail: Point2::new(-0.0123456 * (i + 1) as f64, 1e-3),
            wheel: Point2::new(-0.02, 2e-7),
            normal_force: 12345.678,
            tangential_force: -1e-9,
        };
        HistoryRow {
            time,
            vertical_force: 1e5 / 3.0 * contacts as f64,
            lateral_force: -2e4 / 7.0,
            wheel_y: 0.0067,
            wheel_z: -1e-12,
            load_y: 0.0167,
            energy: (contacts != 1).then_some(EnergyBalance {
                kinetic: 280.0 / 3.0,
                elastic: 1e-7,
                work: -7.5,
                damped: 0.0,
                friction: 2.25,
                drift: -1e-15,
            }),
            contacts: (0..contacts).map(contact).collect(),
        }
    }

    #[test]
    fn a_history_survives_the_file() {
        // ROUNDOFF: twelve digits are written.
        const ROUNDOFF: f64 = 1e-11;
        let history = History {
            rows: (0..4).map(|n| row(n as f64 * 0.0005, n)).collect(),
            degrees_of_freedom: 116,
            ending: Ending::Completed,
        };
        let bytes = write(&history);
        let text = String::from_utf8(bytes.clone()).unwrap();
        assert!(text.starts_with("time_s,p_kn,q_kn,q_over_p,"), "{text}");
        let back = read(Path::new("x.csv"), &text, 116, Ending::Completed).unwrap();
        assert_eq!(back.rows.len(), 4);
        for (a, b) in history.rows.iter().zip(&back.rows) {
            assert_eq!(a.contacts.len(), b.contacts.len());
            assert_eq!(a.mode(), b.mode());
            assert!((a.vertical_force - b.vertical_force).abs() <= ROUNDOFF * a.vertical_force.abs());
            assert!((a.wheel_z - b.wheel_z).abs() <= ROUNDOFF * a.wheel_z.abs());
            for (a, b) in a.contacts.iter().zip(&b.contacts) {
                assert!((a.rail - b.rail).norm() <= ROUNDOFF * a.rail.coords.norm());
                assert!((a.wheel - b.wheel).norm() <= ROUNDOFF * a.wheel.coords.norm());
            }
        }
        assert_eq!(write(&back), bytes, "writing what was read gives the same bytes");
    }

    /// Goal: forces below 20 Hz that are not those of the rows are refused with line and column; a file of a version without these columns is read.
    #[test]
    fn forces_below_20_hz_follow_from_the_rows() {
        let rows = (0..4).map(|n| row(n as f64 * 0.0005, n)).collect();
        let history = History { rows, degrees_of_freedom: 1, ending: Ending::Completed };
        let text = String::from_utf8(write(&history)).unwrap();
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let first = lines[0].iter().position(|name| *name == "p_20hz_kn").unwrap();
        assert!(lines[3][first].parse::<f64>().unwrap() > 0.0, "{text}");
        let joined = |lines: &[Vec<&str>]| lines.iter().map(|line| line.join(",") + "\n").collect::<String>();
        let mut other = lines.clone();
        other[3][first] = "7";
        let error = read(Path::new("x.csv"), &joined(&other), 1, Ending::Completed).unwrap_err().to_string();
        let start = format!("x.csv:4 = \"7\" in column {} where the forces of all rows have", first + 1);
        assert!(error.starts_with(&start), "{error}");
        let mut without = lines;
        without.iter_mut().for_each(|line| drop(line.drain(first..first + 3)));
        let back = read(Path::new("x.csv"), &joined(&without), 1, Ending::Completed).unwrap();
        assert_eq!(write(&back), text.as_bytes());
    }

    /// Goal: content that is no history is refused with file, line and what stands there.
    #[test]
    fn broken_rows_are_named() {
        let history = History {
            rows: vec![row(0.0, 1), row(0.0005, 1)],
            degrees_of_freedom: 1,
            ending: Ending::Completed,
        };
        let good = String::from_utf8(write(&history)).unwrap();
        let heading = good.lines().next().unwrap();
        for (text, start) in [
            (good.replace("0.0005,", "soon,"), "x.csv:3 = \"soon\" in column 1: expected a history"),
            (good.replace("0.0005,", "NaN,"), "x.csv:3 = \"NaN\" in column 1"),
            (good.replace("0.0005,", "inf,"), "x.csv:3 = \"inf\" in column 1"),
            (good.replace("33.3333333333", "1e308"), "x.csv:2 = \"1e308\" in column 2"),
            (good.replace("0.0005,", "0,"), "x.csv:3 = 0 s after 0 s"),
            (good.replace("0.0005,", "-1,"), "x.csv:3 = -1 s after 0 s"),
            (good.replace("slip,12", "glide,12"), "x.csv:2 = \"glide\" in column 18"),
            (
                good.replace("slip,,,,,,,", "stick,,,,,,,"),
                "x.csv:2 = \"stick\" in column 8 where the rest of",
            ),
            (good.replace("slip,,,,,,,", "slip,1,,,,,,"), "x.csv:2 = \"\" in column 10"),
            (good.replace("contact_2_mode", "contact_3_mode"), "x.csv:1 = time_s,"),
            (good.replacen(",", "", 1), "x.csv:1 = "),
            (heading.into(), "x.csv:2 = no row"),
            (format!("{good}1,2"), "x.csv:4 = CSV error: record 3 (line: 4"),
            (String::new(), "x.csv:1 = "),
        ] {
            let error = read(Path::new("x.csv"), &text, 1, Ending::Completed).unwrap_err().to_string();
            assert!(error.starts_with(start), "{start:?}: {error}");
        }
    }
}
