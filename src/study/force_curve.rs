//! A measured curve of force and displacement, from a table with units in its names.

use std::path::Path;

use csv::StringRecord;
use railspring_profiles::error::InputError;
use railspring_profiles::input;
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use serde::Serialize;

use super::document::ZeroKey;
use crate::hash::hash;

/// Key that names the file.
const KEY: &str = "validation.measured";
/// Largest file, bytes.
const LARGEST: u64 = 16 << 20;
/// Fewest lines with a force that make a curve.
const FEWEST: usize = 3;
/// What the first line has to be.
const HEADING: &str =
    "a line of names with units: force_kn, displacement_mm, and standard_uncertainty_mm if it is known";

type Result<T> = std::result::Result<T, InputError>;

/// A measured curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceCurve {
    /// The file as the study names it.
    pub file: String,
    /// BLAKE3 hash of its content.
    pub blake3: String,
    /// Where its displacements are counted from.
    pub zero: ZeroKey,
    /// Its points, of ascending force.
    pub points: Vec<MeasuredForce>,
}

/// A point of a measured curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeasuredForce {
    /// Line of the file, counted from one.
    pub line: u64,
    /// Force, N.
    pub force: f64,
    /// Displacement, m.
    pub displacement: f64,
    /// Its standard uncertainty, m; none where neither the file nor the study has it.
    pub standard_uncertainty: Option<f64>,
}

/// What a column has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    Force,
    Displacement,
    Uncertainty,
}

/// Quantity and unit (SI) of a column by its name; none of another column.
fn quantity(name: &str) -> Option<(Quantity, Option<f64>)> {
    let name = name.to_lowercase().replace('\u{3bc}', "\u{b5}");
    let words: Vec<&str> =
        name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let has = |any: &[&str]| words.iter().any(|word| any.contains(word));
    let unit = |all: &[(&str, f64)]| {
        let last = words.last()?;
        all.iter().find(|(name, _)| name == last).map(|(_, unit)| *unit)
    };
    const LENGTHS: [(&str, f64); 4] =
        [("mm", MILLIMETRE), ("m", 1.0), ("um", 1e-3 * MILLIMETRE), ("\u{b5}m", 1e-3 * MILLIMETRE)];
    const FORCES: [(&str, f64); 2] = [("kn", KILONEWTON), ("n", 1.0)];
    if has(&["uncertainty", "deviation"]) {
        Some((Quantity::Uncertainty, unit(&LENGTHS)))
    } else if has(&["force", "load"]) {
        Some((Quantity::Force, unit(&FORCES)))
    } else if has(&["displacement", "deflection", "approach"]) {
        Some((Quantity::Displacement, unit(&LENGTHS)))
    } else {
        None
    }
}

impl ForceCurve {
    /// Reads a curve; `folder` is that of the study, `standard_uncertainty` (m) is that of points without their own, and `loads` (N) are the ends of the law.
    ///
    /// # Errors
    /// [`InputError`] of the key `validation.measured` with the line of the file: names without units, cells that are no numbers, forces or displacements that fall
    /// back, forces beyond the loads, too few lines.
    pub fn read(
        (folder, file): (&Path, &str),
        zero: ZeroKey,
        standard_uncertainty: Option<f64>,
        loads: [f64; 2],
    ) -> Result<Self> {
        let path = folder.join(file);
        let text = input::read_text(&path, LARGEST).map_err(|cause| {
            let expected = format!("a readable file; {}: {cause}", path.display());
            InputError::new(KEY, format!("{file:?}"), expected, "give its path relative to the study")
        })?;
        let points = points(file, text.trim_start_matches('\u{feff}'), standard_uncertainty, loads)?;
        Ok(Self { file: file.into(), blake3: hash(text.as_bytes()), zero, points })
    }
}

/// What is wrong on a line of a file.
fn wrong(
    file: &str,
    line: u64,
    value: impl std::fmt::Display,
    expected: impl Into<String>,
    remedy: &str,
) -> InputError {
    InputError::new(KEY, format!("{file}:{line}: {value}"), expected, remedy)
}

fn points(
    file: &str,
    text: &str,
    standard_uncertainty: Option<f64>,
    [least, most]: [f64; 2],
) -> Result<Vec<MeasuredForce>> {
    let mut lines = (1..).zip(text.lines());
    let (line, heading): (u64, &str) =
        lines.find(|(_, line)| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or((1, ""));
    let (mut reader, delimiter) = super::tables::reader(heading, text);
    let broken = |cause: csv::Error| {
        let line = cause.position().map_or(1, csv::Position::line);
        wrong(file, line, cause, "as many cells on each line as there are names", "correct the line")
    };
    let names = reader.headers().map_err(broken)?.clone();
    let [force, displacement, uncertainty] = columns(file, line, &names)?;
    let needed = |column: Option<(usize, f64)>, name: &str| {
        column.ok_or_else(|| {
            let found = names.iter().collect::<Vec<_>>().join(", ");
            wrong(
                file,
                line,
                format!("{found} (without {name})"),
                HEADING,
                "name the columns so on the first line",
            )
        })
    };
    let (force, displacement) = (needed(force, "a force")?, needed(displacement, "a displacement")?);
    let mut points: Vec<MeasuredForce> = Vec::new();
    // where the wheel is lifted, the displacement is that of touching
    let mut touching = 0.0;
    for record in reader.records() {
        let record = record.map_err(broken)?;
        let line = record.position().map_or(0, csv::Position::line);
        let number = |(column, unit): (usize, f64)| -> Result<f64> {
            let text = record.get(column).unwrap_or_default();
            let plain = if delimiter == b';' { text.replace(',', ".") } else { text.to_owned() };
            let value = plain.parse::<f64>().ok().filter(|value| value.is_finite());
            value.map(|value| value * unit).ok_or_else(|| {
                wrong(
                    file,
                    line,
                    format!("{text:?}"),
                    format!("a number for {}", &names[column]),
                    "correct the cell, or remove the line",
                )
            })
        };
        let mut point = MeasuredForce {
            line,
            force: number(force)?,
            displacement: number(displacement)? - touching,
            standard_uncertainty: uncertainty.map(number).transpose()?.or(standard_uncertainty),
        };
        if point.standard_uncertainty.is_some_and(|value| value < 0.0) {
            return Err(wrong(file, line, "a negative uncertainty", "0 or more", "give its size"));
        }
        if points.is_empty() && point.force == 0.0 {
            touching += point.displacement;
            continue;
        }
        if let Some(before) = points.last() {
            let falls = |what: &str, from: f64, to: f64, unit: &str| {
                wrong(
                    file,
                    line,
                    format!("{what} {to} {unit} after {from} {unit}"),
                    "a curve of one loading, which does not fall back",
                    "keep the lines of one loading, in the order of the force",
                )
            };
            if point.force <= before.force {
                return Err(falls("force", before.force / KILONEWTON, point.force / KILONEWTON, "kN"));
            }
            if point.displacement < before.displacement {
                let in_mm = |point: &MeasuredForce| (point.displacement + touching) / MILLIMETRE;
                return Err(falls("displacement", in_mm(before), in_mm(&point), "mm"));
            }
        }
        // kN of a file and of the study may round apart
        const ROUNDOFF: f64 = 1e-9;
        if !(least * (1.0 - ROUNDOFF)..=most * (1.0 + ROUNDOFF)).contains(&point.force) {
            return Err(wrong(
                file,
                line,
                format!("{} kN", point.force / KILONEWTON),
                format!(
                    "a force within the loads of the law, {} to {} kN",
                    least / KILONEWTON,
                    most / KILONEWTON
                ),
                "leave the line out, or extend calibration.load_min_kn and calibration.load_max_kn",
            ));
        }
        point.force = point.force.clamp(least, most);
        points.push(point);
    }
    if points.len() < FEWEST {
        let last = text.lines().count().max(1) as u64;
        return Err(wrong(
            file,
            last,
            format!("{} lines with a force", points.len()),
            format!("at least {FEWEST}"),
            "give more of the curve",
        ));
    }
    Ok(points)
}

/// The columns of force, displacement and uncertainty with their units.
fn columns(file: &str, line: u64, names: &StringRecord) -> Result<[Option<(usize, f64)>; 3]> {
    let mut found: [Option<(usize, f64)>; 3] = [None; 3];
    for (column, name) in names.iter().enumerate() {
        let Some((of, unit)) = quantity(name) else { continue };
        let unit = unit.ok_or_else(|| {
            wrong(
                file,
                line,
                format!("{name:?}"),
                HEADING,
                "put the unit behind the name: N or kN, \u{b5}m, mm or m",
            )
        })?;
        if let Some((other, _)) = found[of as usize].replace((column, unit)) {
            let both = format!("{:?} and {name:?}", &names[other]);
            return Err(wrong(
                file,
                line,
                both,
                "one column of each quantity",
                "remove or rename one of the two",
            ));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<MeasuredForce>> {
        points("c.csv", text, Some(1e-6), [1e3, 150e3])
    }

    /// Source: tables as programs of test rigs write them. Goal: the same curve, N and m, from commas, semicolons with decimal commas and tabs, in other units,
    /// with comments, a byte order mark that the reader takes off, other columns, and a first line without force, from where its displacement counts. Accuracy: exact but for rounding.
    #[test]
    fn curves_are_read_in_their_units() {
        let expected = [(10e3, 0.02e-3), (20e3, 0.035e-3), (40e3, 0.06e-3)];
        let texts = [
            "force_kn,displacement_mm\n10,0.02\n20,0.035\n40,0.06\n",
            "# rig 3\nLoad [N];temperature;Displacement (\u{b5}m)\n10000;21;20\n20000;21;35,0\n40000;21;60\n",
            "displacement in um\tforce in kN\n5\t0\n25\t10\n40\t20\n65\t40\n",
        ];
        for text in texts {
            let found = read(text).unwrap();
            assert_eq!(found.len(), expected.len(), "{text}");
            for (point, (force, displacement)) in found.iter().zip(expected) {
                assert!((point.force - force).abs() < 1e-9, "{point:?}");
                assert!((point.displacement - displacement).abs() < 1e-15, "{point:?}");
                assert_eq!(point.standard_uncertainty, Some(1e-6));
            }
        }
        let own =
            read("force_kn,displacement_mm,standard_uncertainty_um\n2,0.01,3\n3,0.02,4\n4,0.03,4\n").unwrap();
        assert!((own[0].standard_uncertainty.unwrap() - 3e-6).abs() < 1e-15, "{own:?}");
    }

    /// Goal: a curve without units, with two columns of a kind, that is no table, falls back or leaves the loads is refused with its line.
    #[test]
    fn what_is_no_curve_is_refused_with_its_line() {
        for (text, at, said) in [
            ("# rig\n\nforce,displacement\n10,0.02\n", "c.csv:3: \"force\"", "force_kn"),
            (
                "force_kn,displacement_mm,approach_mm\n",
                "c.csv:1: \"displacement_mm\" and \"approach_mm\"",
                "one column",
            ),
            (
                "force_kn,time_s\n10,1\n",
                "c.csv:1: force_kn, time_s (without a displacement)",
                "displacement_mm",
            ),
            ("", "c.csv:1: ", "force_kn"),
            ("force_kn,displacement_mm\n10,0.02\n20,x\n", "c.csv:3: \"x\"", "a number for displacement_mm"),
            ("force_kn,displacement_mm\n10,0.02\n20,nan\n", "c.csv:3: \"nan\"", "a number"),
            ("force_kn,displacement_mm\n10,0.02\n20\n", "c.csv:3: ", "as many cells"),
            (
                "force_kn,displacement_mm\n10,0.02\n20,0.03\n15,0.04\n",
                "c.csv:4: force 15 kN after 20 kN",
                "fall back",
            ),
            (
                "force_kn,displacement_mm\n10,0.02\n20,0.01\n",
                "c.csv:3: displacement 0.01 mm after 0.02 mm",
                "fall back",
            ),
            ("force_kn,displacement_mm\n10,0.02\n200,0.3\n", "c.csv:3: 200 kN", "1 to 150 kN"),
            ("force_kn,displacement_mm\n0,0\n10,0.02\n20,0.03\n", "c.csv:4: 2 lines", "at least 3"),
            ("force_kn,displacement_mm,uncertainty_mm\n10,0.02,-1\n", "c.csv:2: a negative", "0 or more"),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.key, KEY);
            assert!(error.value.starts_with(at), "{text}: {error}");
            assert!(error.expected.contains(said), "{text}: {error}");
        }
    }
}
