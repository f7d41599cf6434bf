//! A study of a load case on a track, as `run` and `simulate` do it.

use std::path::{Path, PathBuf};

use railspring_profiles::error::{Error, InputError};
use serde_json::json;

use super::failure::Failure;
use super::progress::Progress;
use super::results::Results;
use super::work_args::WorkArgs;
use crate::engine::output::OutputFolder;
use crate::pdf::Printer;
use crate::report::number::number;
use crate::results::names::REPORT;
use crate::study::Setting;
use crate::track::{TrackStudy, made};

/// How it is done.
pub(super) struct How<'a> {
    pub output: Option<&'a Path>,
    pub work: &'a WorkArgs,
    pub dry_run: bool,
    pub printer: Option<Printer>,
}

/// Refuses a command that a load case on a track does not have.
pub(super) fn refused(command: &str, path: &Path) -> Failure {
    InputError::new(
        "kind",
        "\"track\"",
        format!("a study of two profiles for `railspring {command}`"),
        format!("`railspring run {}` runs a load case on a track", path.display()),
    )
    .into()
}

/// Runs a study; whether all its steps were done.
pub(super) fn run(
    command: &'static str,
    path: &Path,
    settings: &[Setting],
    how: &How<'_>,
) -> Result<bool, Failure> {
    let study = TrackStudy::read(path, settings)?;
    let results = Results::of(command).of_study(&study.document.name);
    let run = &study.document.run;
    if how.dry_run {
        let said = format!("expected: {} time steps of {} in each", run.steps, run.inner_steps);
        let results =
            results.with_more(vec![said], json!({ "time_steps": run.steps, "inner_steps": run.inner_steps }));
        return Ok(results.print(how.work.json, how.work.quiet).map(|()| true)?);
    }
    let place = how.output.map_or_else(|| PathBuf::from("out").join(&study.document.name), PathBuf::from);
    let folder = OutputFolder::create(&place, &study.inputs())?;
    let _claim = folder.claim()?;
    let progress = Progress::new(how.work.quiet);
    let made = made(&study, &folder, &progress).map_err(|error: Error| match study.located(error) {
        Ok(located) => Failure::Located(located),
        Err(error) => Failure::Plain(error),
    })?;
    progress.finish();
    if let Some(printer) = &how.printer {
        printer.print(&folder, REPORT)?;
    }
    let record = &made.record;
    let shown = record.figures.iter().filter(|figure| {
        ["p_kn", "q_kn", "q_over_p", "flange_tip_mm", "_deflection_mm", "_moment_kn_m"]
            .iter()
            .any(|end| figure.column.ends_with(end))
    });
    let mut said: Vec<String> = shown
        .map(|f| {
            let [low, high] = [f.smallest, f.largest].map(|at| number(at.value));
            format!("{}: {low} to {high}, the largest at {} s", f.column, number(f.largest.time_s))
        })
        .collect();
    said.extend(record.notes.iter().cloned());
    said.push(record.verification.reason.into());
    let more = json!({
        "rows": record.rows,
        "ending": record.ending,
        "verification": record.verification,
        "figures": record.figures,
        "notes": record.notes,
    });
    let file = folder.file(REPORT);
    results.with_more(said, more).at(&file).holding(made.completed).print(how.work.json, how.work.quiet)?;
    Ok(made.completed)
}
