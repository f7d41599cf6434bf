//! The command `railspring`.

use std::process::ExitCode;

fn main() -> ExitCode {
    railspring::cli::main()
}
