//! The subcommands on profiles.

use clap::Subcommand;
use railspring_calibrate::error::Error;

/// What can be done with a profile.
#[derive(Debug, Subcommand)]
pub(super) enum ProfileCommand {
}

/// Runs a subcommand; whether the profile is fit for use.
///
/// # Errors
/// Files that cannot be read, understood or written.
pub(super) fn run(command: &ProfileCommand) -> Result<bool, Error> {
    match *command {}
}
