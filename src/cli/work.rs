//! `railspring work`: one step of a table for another machine, read from standard input.

use std::io::Read;

use clap::Args;
use railspring_profiles::error::{Error, InputError};

use super::output::say;
use super::progress::Progress;
use super::work_args::{WorkArgs, take_threads};
use crate::engine::store::program;
use crate::table::Work;

/// Largest step that is read, bytes.
const LARGEST: u64 = 1 << 30;

/// What the step is done with.
#[derive(Debug, Args)]
pub(super) struct StepArgs {
    /// Say which program this is, and stop
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    work: WorkArgs,
}

/// Does the step and writes the answer to standard output, a line of JSON.
///
/// # Errors
/// Those of [`Work::done`]; [`InputError`] for a step that cannot be read.
pub(super) fn run(args: &StepArgs) -> Result<(), Error> {
    let unusable = |value: String| {
        let expected = "a step of a table in JSON";
        InputError::new(
            "standard input",
            value,
            expected,
            "run `railspring table --executor dask`, which has steps run",
        )
    };
    if args.check {
        let program = program().ok_or_else(|| unusable("the program's own file cannot be read".into()))?;
        let version = env!("CARGO_PKG_VERSION");
        return say(&serde_json::json!({ "program": program, "version": version }).to_string());
    }
    take_threads(args.work.threads)?;
    let mut text = String::new();
    std::io::stdin().take(LARGEST).read_to_string(&mut text).map_err(|cause| unusable(cause.to_string()))?;
    let work: Work = serde_json::from_str(&text).map_err(|cause| unusable(cause.to_string()))?;
    let progress = Progress::new(true);
    let store = args.work.store()?;
    let answer = work.done(&store, args.work.resources(&progress))?;
    say(&serde_json::to_string(&answer).expect("an answer is plain data"))
}
