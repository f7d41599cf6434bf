//! Columns of CSV files over time or along the rail.

use std::path::Path;

use csv::ReaderBuilder;
use railspring_profiles::error::InputError;
use railspring_profiles::input;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::document::{Interpolation, TableKeys};
use crate::hash::hash;

/// Largest file that is read, bytes.
const LARGEST: u64 = 256 << 20;
/// A distance of rows that is so many times the usual one is a gap in samples.
const GAP: f64 = 1.5;

/// A file that a study reads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FileRecord {
    /// The key that names it.
    pub key: String,
    /// The file as the study names it.
    pub file: String,
    /// BLAKE3 hash of its bytes.
    pub blake3: String,
}

/// What stands in the first of two columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Over {
    /// Times, s.
    Time,
    /// Places, m.
    Place,
}

impl Over {
    fn of_them(self) -> &'static str {
        if self == Self::Time { "times" } else { "places" }
    }

    fn unit(self) -> &'static str {
        if self == Self::Time { "s" } else { "m" }
    }
}

/// The steps that have to see a table, and the keys that they follow from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Steps {
    /// How long the run takes, s.
    pub duration: f64,
    /// Length of a step of the integration, s.
    pub step: f64,
    /// The key of their number.
    pub count: String,
    /// What makes them shorter.
    pub shorter: Shorter,
}

/// A key that makes steps shorter.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Shorter {
    /// The number of steps in each row of the history.
    InnerSteps(String),
    /// The length of a time step.
    TimeStep(String),
}

/// Two columns of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Table {
    /// Times or places, ascending, with values in the unit of the key.
    pub rows: Vec<(f64, f64)>,
    /// The file.
    pub file: FileRecord,
    /// The usual distance of two rows.
    pub spacing: f64,
    over: Over,
    key: String,
    keys: TableKeys,
}

/// A reader of columns by the `heading` of their `text`, without lines that begin with `#`; and what lies between them: semicolons, tabs or commas.
pub(super) fn reader<'t>(heading: &str, text: &'t str) -> (csv::Reader<&'t [u8]>, u8) {
    let delimiter =
        [b';', b'\t', b','].into_iter().find(|at| heading.as_bytes().contains(at)).unwrap_or(b',');
    let reader = ReaderBuilder::new()
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    (reader, delimiter)
}

impl Table {
    /// Reads the table of a key; `folder` is that of the study.
    ///
    /// # Errors
    /// [`InputError`] of the key with the line of the file: one that cannot be read, columns that it does not have, cells that are no numbers, times or places that do not ascend,
    /// gaps between samples, less than two rows.
    pub fn read(folder: &Path, key: &str, keys: &TableKeys, over: Over) -> Result<Self, InputError> {
        let path = folder.join(&keys.file);
        let text = input::read_text(&path, LARGEST).map_err(|cause| {
            let expected = format!("a readable file; {}: {cause}", path.display());
            let remedy = "give its path relative to the study";
            InputError::new(format!("{key}.file"), format!("{:?}", keys.file), expected, remedy)
        })?;
        let file = FileRecord { key: key.into(), file: keys.file.clone(), blake3: hash(text.as_bytes()) };
        let mut table =
            Self { rows: Vec::new(), file, spacing: 0.0, over, key: key.into(), keys: keys.clone() };
        table.fill(text.trim_start_matches('\u{feff}'))?;
        Ok(table)
    }

    /// Reads a table over the time of a run, whose `steps` have to see all of it.
    ///
    /// # Errors
    /// The mistakes of [`Table::read`], [`Table::check_covers`] and [`Table::check_steps`].
    pub fn over_time(
        folder: &Path,
        key: &str,
        keys: &TableKeys,
        steps: &Steps,
    ) -> Result<Self, Vec<InputError>> {
        let table = Self::read(folder, key, keys, Over::Time).map_err(|mistake| vec![mistake])?;
        let covers = table.check_covers([0.0, steps.duration], &steps.count);
        let checks = [covers, table.check_steps(steps.step, &steps.shorter)];
        let mistakes: Vec<InputError> = checks.into_iter().filter_map(Result::err).collect();
        if mistakes.is_empty() { Ok(table) } else { Err(mistakes) }
    }

    fn wrong(&self, line: u64, value: &str, expected: String, remedy: &str) -> InputError {
        let value = format!("{}:{line}: {value}", self.keys.file);
        InputError::new(format!("{}.file", self.key), value, expected, remedy)
    }

    fn fill(&mut self, text: &str) -> Result<(), InputError> {
        let heading =
            text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or("");
        let (mut reader, delimiter) = reader(heading, text);
        let broken = |table: &Self, cause: &csv::Error| {
            let line = cause.position().map_or(1, csv::Position::line);
            let expected = "as many cells on each line as there are names";
            table.wrong(line, &cause.to_string().replace('\n', " "), expected.into(), "correct the line")
        };
        let names = reader.headers().map_err(|cause| broken(self, &cause))?.clone();
        let column = |key: &str, wanted: &str| {
            names.iter().position(|name| name == wanted).ok_or_else(|| {
                let known = names.iter().collect::<Vec<_>>().join(", ");
                let expected = format!("a column of {} ({known})", self.keys.file);
                InputError::new(
                    format!("{}.{key}", self.key),
                    format!("{wanted:?}"),
                    expected,
                    "name one of them",
                )
            })
        };
        let over = self.keys.over_column.as_ref().map_or(Ok(0), |name| column("over_column", name))?;
        let value = column("column", &self.keys.column)?;
        for record in reader.records() {
            let record = record.map_err(|cause| broken(self, &cause))?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |column: usize| {
                let text = record.get(column).unwrap_or_default();
                let plain = if delimiter == b';' { text.replace(',', ".") } else { text.to_owned() };
                let number = plain.parse::<f64>().ok().filter(|value| value.is_finite());
                number.ok_or_else(|| {
                    let expected = format!("a number in column {:?}", &names[column]);
                    self.wrong(line, &format!("{text:?}"), expected, "correct the cell, or remove the line")
                })
            };
            let row = (number(over)?, self.keys.factor * number(value)?);
            if let Some((before, _)) = self.rows.last()
                && row.0 <= *before
            {
                let (what, unit) = (self.over.of_them(), self.over.unit());
                let value = format!("{} {unit} after {before} {unit}", row.0);
                let remedy = "sort the lines, and leave out what stands there twice";
                return Err(self.wrong(line, &value, format!("{what} that ascend"), remedy));
            }
            self.rows.push(row);
        }
        if self.rows.len() < 2 {
            let value = format!("{} rows", self.rows.len());
            return Err(self.wrong(1, &value, "two rows or more".into(), "give the table more rows"));
        }
        let mut distances: Vec<f64> = self.rows.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        distances.sort_by(f64::total_cmp);
        self.spacing = distances[distances.len() / 2];
        if self.keys.between == Interpolation::Samples {
            self.check_gaps()?;
        }
        Ok(())
    }

    fn check_gaps(&self) -> Result<(), InputError> {
        let gap = self.rows.windows(2).find(|pair| pair[1].0 - pair[0].0 > GAP * self.spacing);
        let Some([(from, _), (to, _)]) = gap else { return Ok(()) };
        let unit = self.over.unit();
        Err(InputError::new(
            format!("{}.file", self.key),
            format!("{}: nothing between {from} and {to} {unit}", self.keys.file),
            format!("samples without a gap; they are {} {unit} apart elsewhere", self.spacing),
            format!(
                "fill the gap, or set `{}.between = \"corners\"` for straight lines between the rows",
                self.key
            ),
        ))
    }

    /// Whether its rows are samples of something smooth.
    pub fn is_sampled(&self) -> bool {
        self.keys.between == Interpolation::Samples
    }

    /// That it reaches from `from` to `to`; `count` is the key of the number of steps.
    ///
    /// # Errors
    /// [`InputError`] with what it has.
    pub fn check_covers(&self, [from, to]: [f64; 2], count: &str) -> Result<(), InputError> {
        let (first, last) = (self.rows[0].0, self.rows[self.rows.len() - 1].0);
        let rounding = 1e-9 * (to.abs() + from.abs());
        if first <= from + rounding && last >= to - rounding {
            return Ok(());
        }
        let (what, unit) = (self.over.of_them(), self.over.unit());
        Err(InputError::new(
            format!("{}.file", self.key),
            format!("{}: {what} from {first} to {last} {unit}", self.keys.file),
            format!("{what} from {from} to {to} {unit}, as far as the run goes"),
            format!("give the table more rows, or end the run earlier (`{count}`)"),
        ))
    }

    /// That steps which are `step` apart (s, or m) see every sample; `shorter` makes them shorter.
    ///
    /// # Errors
    /// [`InputError`] with the steps that do.
    pub fn check_steps(&self, step: f64, shorter: &Shorter) -> Result<(), InputError> {
        if !self.is_sampled() || step <= self.spacing * (1.0 + 1e-9) {
            return Ok(());
        }
        let unit = self.over.unit();
        let more = match shorter {
            Shorter::InnerSteps(key) => {
                format!("set `{key}` {:.0} times as high", (step / self.spacing).ceil())
            }
            Shorter::TimeStep(key) => format!("lower `{key}` to {:.3e} s or less", self.spacing),
        };
        Err(InputError::new(
            format!("{}.file", self.key),
            format!("{}: samples {} {unit} apart", self.keys.file, self.spacing),
            format!("samples at least as far apart as the steps of the integration ({step} {unit})"),
            format!("{more}, or give fewer samples that were low-pass filtered"),
        ))
    }
}
