//! The run of a track study as files of an output folder.

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;

use super::columns::{columns_of, csv};
use super::page::page;
use super::record::{TrackRecord, record};
use super::resolve::TrackStudy;
use crate::engine::output::{OutputFolder, to_json};
use crate::results::names::{REPORT, STIFFNESS, VERIFICATION};

/// The history.
pub const HISTORY: &str = "history.csv";
/// The record.
pub const RECORD: &str = "track.json";

/// What a run has become.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// Its record.
    pub record: TrackRecord,
    /// Whether all its steps were done.
    pub completed: bool,
}

/// Runs a study and writes history, record and page.
///
/// # Errors
/// Those of the run; an output folder with the results of a study of two profiles, whose files this one would replace.
pub fn made(study: &TrackStudy, folder: &OutputFolder, monitor: &dyn Monitor) -> Result<Made> {
    if let Some(other) = [STIFFNESS, VERIFICATION].iter().find(|name| folder.file(name).exists()) {
        return InputError::refuse(
            "output folder",
            folder.file(other).display(),
            "a folder without the results of a study of two profiles",
            "choose another one with -o",
        );
    }
    [HISTORY, RECORD, REPORT].iter().try_for_each(|name| folder.inputs().check(&folder.file(name)))?;
    let run = study.case.run(monitor)?;
    let columns = columns_of(&study.case);
    let record = record(study, &run, &columns);
    let page = page(&record, &run, &columns);
    folder.write_together(&[
        (HISTORY, csv(&columns, &run).into()),
        (RECORD, to_json(&record).into()),
        (REPORT, page.into_bytes().into()),
    ])?;
    let completed = record.ending == "completed";
    Ok(Made { record, completed })
}
