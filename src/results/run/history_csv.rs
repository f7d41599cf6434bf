//! `history.csv` and `solid_history.csv`: one row per time step.
//!
//! Forces in kN, positions in mm, each in the frame that its name says. The
//! contacts of a row follow each other from the gauge side to the field side;
//! a contact that does not exist has the mode `separated` and empty cells.

use std::path::Path;

use nalgebra::Point2;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use railspring_simulate::time::energy::EnergyBalance;
use railspring_simulate::time::history::{ContactMode, ContactState, Ending, History, HistoryRow};

/// Columns before those of the contacts.
const COMMON: [&str; 14] = [
    "time_s",
    "p_kn",
    "q_kn",
    "q_over_p",
    "wheel_y_mm",
    "wheel_z_mm",
    "load_y_mm",
    "mode",
    "kinetic_j",
    "elastic_j",
    "work_j",
    "damped_j",
    "friction_j",
    "energy_drift_j",
];
/// The first of the columns of the balance of energy, which are empty where the run has none.
const ENERGY: usize = 8;
/// Columns of one contact.
const OF_CONTACT: [&str; 7] =
    ["mode", "normal_kn", "tangential_kn", "rail_y_mm", "rail_z_mm", "wheel_y_mm", "wheel_z_mm"];
/// Tread and flange: every file has room for these.
const CONTACTS_AT_LEAST: usize = 2;

/// The file's bytes.
pub fn write(history: &History) -> Vec<u8> {
    let contacts =
        history.rows.iter().map(|row| row.contacts.len()).max().unwrap_or(0).max(CONTACTS_AT_LEAST);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut heading: Vec<String> = COMMON.iter().map(ToString::to_string).collect();
    for contact in 1..=contacts {
        heading.extend(OF_CONTACT.iter().map(|name| format!("contact_{contact}_{name}")));
    }
    writer.write_record(&heading).expect("a vector grows");
    for row in &history.rows {
        writer.write_record(cells(row, contacts)).expect("a vector grows");
    }
    writer.into_inner().expect("a vector grows")
}

/// One line of the file, with room for `contacts`.
fn cells(row: &HistoryRow, contacts: usize) -> Vec<String> {
    let mut cells = vec![
        number(row.time),
        number(row.vertical_force / KILONEWTON),
        number(row.lateral_force / KILONEWTON),
        if row.vertical_force > 0.0 { number(row.lateral_force / row.vertical_force) } else { String::new() },
        number(row.wheel_y / MILLIMETRE),
        number(row.wheel_z / MILLIMETRE),
        number(row.load_y / MILLIMETRE),
        row.mode().name().to_string(),
    ];
    cells.extend(match row.energy {
        Some(EnergyBalance { kinetic, elastic, work, damped, friction, drift }) => {
            [kinetic, elastic, work, damped, friction, drift].map(number)
        }
        None => Default::default(),
    });
    for index in 0..contacts {
        match row.contacts.get(index) {
            Some(contact) => {
                cells.push(contact.mode.name().to_string());
                cells.push(number(contact.normal_force / KILONEWTON));
                cells.push(number(contact.tangential_force / KILONEWTON));
                for point in [contact.rail, contact.wheel] {
                    cells.push(number(point.x / MILLIMETRE));
                    cells.push(number(point.y / MILLIMETRE));
                }
            }
            None => {
                cells.push(ContactMode::Separated.name().to_string());
                cells.extend(std::iter::repeat_n(String::new(), OF_CONTACT.len() - 1));
            }
        }
    }
    cells
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
/// [`InputError`] whose key is the path with the line, if the file has another content: other columns, no row, a value
/// that is not a finite number, a time that is not after that of the row before, cells of a row that contradict each other.
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
    let fits = heading.len() >= COMMON.len()
        && (heading.len() - COMMON.len()).is_multiple_of(OF_CONTACT.len())
        && heading.iter().zip(COMMON).all(|(found, expected)| found == expected)
        && heading.iter().skip(COMMON.len()).enumerate().all(|(n, found)| {
            *found == format!("contact_{}_{}", n / OF_CONTACT.len() + 1, OF_CONTACT[n % OF_CONTACT.len()])
        });
    if !fits {
        return Err(broken(1, heading.iter().collect::<Vec<_>>().join(",")));
    }
    let room = (heading.len() - COMMON.len()) / OF_CONTACT.len();
    let mut rows: Vec<HistoryRow> = Vec::new();
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
        for start in (COMMON.len()..heading.len()).step_by(OF_CONTACT.len()) {
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
        let energy = match (ENERGY..COMMON.len()).all(|column| cell(column).is_empty()) {
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
        let written = cells(&row, room);
        let differs = record.iter().zip(&written).position(|(found, expected)| !same(found, expected));
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
            (good.replace("slip,12", "glide,12"), "x.csv:2 = \"glide\" in column 15"),
            (
                good.replace("slip,,,,,,,slip,12", "stick,,,,,,,slip,12"),
                "x.csv:2 = \"stick\" in column 8 where the rest of",
            ),
            (good.replace("slip,,,,,,,slip,12", "slip,1,,,,,,slip,12"), "x.csv:2 = \"\" in column 10"),
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
