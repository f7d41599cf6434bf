//! The command that writes the contact element of a study for programs that compute with it.

use std::path::PathBuf;

use clap::Args;
use railspring_profiles::error::InputError;

use super::element_files::ElementFiles;
use super::failure::Failure;
use super::results::Results;
use super::set_args::SetArgs;
use super::staged::{Action, HowArgs, done};
use super::work_args::WorkArgs;
use crate::study::Study;

/// The study, and the files of its element.
#[derive(Debug, Args)]
pub(super) struct ElementArgs {
    /// The study, a TOML file
    #[arg(value_name = "STUDY")]
    study: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    files: ElementFiles,
    /// Folder of the springs that the element is of; left out, out/<name of the study>
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
    #[command(flatten)]
    how: HowArgs,
}

impl ElementArgs {
    /// What all commands that solve need to know.
    pub fn work(&self) -> &WorkArgs {
        &self.how.work
    }
}

/// Makes the element; whether all loads of the springs are there.
///
/// # Errors
/// Those of the study and of its stages.
pub(super) fn run(args: &ElementArgs) -> Result<bool, Failure> {
    let mut study = Study::read_with(&args.study, args.set.settings())?;
    if study.elements == Some(false) {
        let remedy = "leave it out: this command makes the elements, with a load case or without";
        let error = InputError::new("calibration.elements", "false", "true, or nothing", remedy);
        return Err(Failure::of_stage(&study, error.into()));
    }
    if study.scenarios.is_empty() {
        study.elements = Some(true);
    }
    let results = Results::of("element").of_study(&study.name);
    let how = (args.results.as_deref(), &args.how);
    done(Action::Element(&args.files), results, how, &study, &[])
        .map_err(|error| Failure::of_stage(&study, error))
}
