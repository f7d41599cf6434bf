//! `railspring self-test`: whether this program computes on this machine what others have computed.

use clap::Args;
use railspring_profiles::error::Error;

use super::output::say;
use super::progress::Progress;
use crate::self_test::checks;
use crate::version;

/// Options of the command.
#[derive(Debug, Args)]
pub(super) struct SelfTestArgs {
    /// Print the last line and errors only
    #[arg(short, long)]
    quiet: bool,
}

/// Prints a line for each check and one for all; whether all hold.
///
/// # Errors
/// Those of [`checks`].
pub(super) fn run(args: &SelfTestArgs) -> Result<bool, Error> {
    let progress = Progress::new(args.quiet);
    let all = checks(&progress)?;
    progress.finish();
    if !args.quiet {
        for check in &all {
            let word = if check.holds() { "holds" } else { "FAILS" };
            say(&format!(
                "{word:<6} {:<46} {:>12.5e}, {:<15} {:>12.5e}: {:+.1e} of {:.1e}",
                check.name,
                check.found,
                check.source,
                check.expected,
                check.relative_error(),
                check.tolerance
            ))?;
        }
    }
    let failed = all.iter().filter(|check| !check.holds()).count();
    say(&format!("railspring {}: {} checks hold, {failed} fail", version::FULL, all.len() - failed))?;
    Ok(failed == 0)
}
