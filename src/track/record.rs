//! `track.json`: what a run was made from, how it ended, and its largest values.

use railspring_simulate::track::{TrackEnding, TrackRun};
use serde::Serialize;
use serde_json::Value;

use super::columns::TrackColumn;
use super::resolve::TrackStudy;
use super::tables::FileRecord;
use crate::version;

/// The record of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrackRecord {
    /// Version of the program.
    pub version: &'static str,
    /// Its commit.
    pub commit: &'static str,
    /// Name of the study.
    pub study: String,
    /// Its description.
    pub description: String,
    /// BLAKE3 hash of its file, without the options beside it.
    pub study_blake3: String,
    /// All its keys, with the defaults.
    pub keys: Value,
    /// The files that it reads.
    pub files: Vec<FileRecord>,
    /// Unknowns of the model.
    pub unknowns: usize,
    /// Rows of the history.
    pub rows: usize,
    /// How it ended: `completed` or `rail-end`.
    pub ending: &'static str,
    /// When it ended early, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ended_at_s: Option<f64>,
    /// What was verified.
    pub verification: Verification,
    /// Smallest and largest value of each column.
    pub figures: Vec<Figures>,
    /// What has to be said.
    pub notes: Vec<String>,
}

/// What was verified of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verification {
    /// Nothing.
    pub verified: bool,
    /// Why.
    pub reason: &'static str,
}

/// Why nothing is verified.
pub(super) const UNVERIFIED: &str =
    "nothing was verified: a load case on a track has no profiles and no solids that could follow it";

/// Smallest and largest value of a column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// The column.
    pub column: String,
    /// What it means.
    pub text: String,
    /// Its smallest value.
    pub smallest: Extreme,
    /// Its largest value.
    pub largest: Extreme,
}

/// A value with the time and the place of the wheel at which it stands first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extreme {
    /// The value, in the unit of its column.
    pub value: f64,
    /// Time, s.
    pub time_s: f64,
    /// Place of the wheel, m.
    pub x_m: f64,
}

/// The record of a study's run.
pub(super) fn record(study: &TrackStudy, run: &TrackRun, columns: &[TrackColumn]) -> TrackRecord {
    let (ending, ended_at_s) = match run.ending {
        TrackEnding::Completed => ("completed", None),
        TrackEnding::RailEnd { time } => ("rail-end", Some(time)),
    };
    TrackRecord {
        version: env!("CARGO_PKG_VERSION"),
        commit: version::COMMIT,
        study: study.document.name.clone(),
        description: study.document.description.clone(),
        study_blake3: study.source.hash().into(),
        keys: study.keys(),
        files: study.files.clone(),
        unknowns: run.unknowns,
        rows: run.rows.len(),
        ending,
        ended_at_s,
        verification: Verification { verified: false, reason: UNVERIFIED },
        figures: columns[2..].iter().filter_map(|column| figures(column, run)).collect(),
        notes: notes(study, run),
    }
}

/// The extremes of a column; none of one without values.
fn figures(column: &TrackColumn, run: &TrackRun) -> Option<Figures> {
    let all = || run.rows.iter().map(|row| (column.of(row), row)).filter(|(value, _)| value.is_finite());
    let of = |better: fn(f64, f64) -> bool| {
        let found = all().reduce(|best, next| if better(next.0, best.0) { next } else { best });
        found.map(|(value, row)| Extreme { value, time_s: row.time, x_m: row.x })
    };
    Some(Figures {
        column: column.name.clone(),
        text: column.text.clone(),
        smallest: of(|a, b| a < b)?,
        largest: of(|a, b| a > b)?,
    })
}

/// What has to be said of a run.
fn notes(study: &TrackStudy, run: &TrackRun) -> Vec<String> {
    let mut notes = study.notes.clone();
    if let TrackEnding::RailEnd { time } = run.ending {
        let rows = run.rows.len() - 1;
        notes
            .push(format!("the wheel came to the end of the rail at {time} s: the history has {rows} steps"));
    }
    let flying = |wheel: usize| run.rows.iter().filter(|row| row.wheels[wheel].approach < 0.0).count();
    let wheels = run.rows.first().map_or(0, |row| row.wheels.len());
    for wheel in 0..wheels {
        let rows = flying(wheel);
        if rows > 0 {
            let which = match (wheels, wheel) {
                (1, _) => "the wheel",
                (_, 0) => "the right wheel",
                _ => "the left wheel",
            };
            notes.push(format!("{which} is off the rail in {rows} of {} rows", run.rows.len()));
        }
    }
    notes
}
