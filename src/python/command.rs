//! Commands of an interpreter that runs isolated, and what becomes of those that the user waits for.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;

use super::package::Package;
use crate::child::{self, Ended, Limits, Stop};

/// Limits of a command that answers at once.
pub(super) const PROBE_LIMITS: Limits =
    Limits { time: Duration::from_secs(120), output: 1 << 20, memory: None };

/// An interpreter that sees neither the working folder nor variables of the user's own Python.
pub(super) fn isolated(interpreter: &Path, place: &Path) -> Command {
    let mut command = Command::new(interpreter);
    for (name, _) in std::env::vars_os() {
        if name.to_string_lossy().to_uppercase().starts_with("PYTHON") {
            command.env_remove(name);
        }
    }
    // -I: no variables, no folder of the script or of the user on the path of modules; -B: no files beside modules;
    // UTF-8 on every system
    command.args(["-I", "-B", "-X", "utf8"]).current_dir(place);
    command
}

/// Runs a command that the user waits for.
pub(super) fn answer(
    of: &Package,
    command: &mut Command,
    limits: &Limits,
    monitor: &dyn Monitor,
    stage: &str,
) -> Result<Ended> {
    let program = PathBuf::from(command.get_program());
    child::run(command, limits, &|| monitor.progress(stage, 0, 1)).map_err(|stop| match stop {
        Stop::Asked(stop) => stop,
        Stop::Failed(cause) => of.missing(&program, &cause.to_string()).into(),
        Stop::Time => of.missing(&program, &format!("no result within {} s", limits.time.as_secs())).into(),
        Stop::Output => of.missing(&program, "it writes without end").into(),
        Stop::Memory => of.missing(&program, "it takes more memory than allowed").into(),
    })
}
