//! The run of a track study as files of an output folder.

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;
use serde::Deserialize;

use super::columns::csv;
use super::page::page;
use super::record::{TrackRecord, record};
use super::resolve::TrackStudy;
use crate::engine::list::not_a_users;
use crate::engine::output::{OutputFolder, to_json};
use crate::results::names::{REPORT, STIFFNESS, VERIFICATION};

/// The history.
pub const HISTORY: &str = "history.csv";
/// The record.
pub const RECORD: &str = "track.json";
/// All files.
const OUTPUTS: [&str; 3] = [RECORD, HISTORY, REPORT];

/// What the record of an earlier run has.
#[derive(Deserialize)]
struct Earlier {
    #[serde(rename = "study_blake3")]
    _study: String,
}

/// What a run has become.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackOutput {
    /// Its record.
    pub record: TrackRecord,
    /// Whether all its steps were done.
    pub completed: bool,
}

/// Runs a study and writes history, record and page.
///
/// # Errors
/// Those of the run; an output folder with the results of a study of two profiles, or with a user's files, which this one would replace.
pub fn made(study: &TrackStudy, folder: &OutputFolder, monitor: &dyn Monitor) -> Result<TrackOutput> {
    if let Some(other) = [STIFFNESS, VERIFICATION].iter().find(|name| folder.file(name).exists()) {
        return InputError::refuse(
            "output folder",
            folder.file(other).display(),
            "a folder without the results of a study of two profiles",
            "choose another one with -o",
        );
    }
    folder.inputs().check_folder(folder.path(), |name| OUTPUTS.contains(&name))?;
    if folder.read_json::<Earlier>(RECORD, "run").is_err() {
        OUTPUTS.iter().try_for_each(|name| not_a_users(&folder.file(name)))?;
    }
    let outcome = study.case.run(monitor)?;
    let record = record(study, &outcome);
    let page = page(&record, &outcome.columns);
    folder.write_together(&[
        // first: a run that is stopped between two files knows that they are its own
        (RECORD, to_json(&record).into()),
        (HISTORY, csv(&outcome.columns).into()),
        (REPORT, page.into_bytes().into()),
    ])?;
    let completed = record.ending == "completed";
    Ok(TrackOutput { record, completed })
}
