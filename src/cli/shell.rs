//! What a shell and its manual take from the program: completions and manual pages.

use std::path::PathBuf;

use clap::Args;
use clap_complete::{Shell, generate};
use clap_mangen::Man;
use railspring_profiles::error::{Error, InputError};

use super::output::{print, say};
use crate::engine::inputs::Inputs;
use crate::engine::output::OutputFolder;

/// Where the manual pages go.
#[derive(Debug, Args)]
pub(super) struct ManArgs {
    /// Folder to write a page for each command to; left out, the page of the program is printed
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Prints what a shell completes commands and options of the program with.
pub(super) fn completions(program: &mut clap::Command, shell: Shell) -> Result<(), Error> {
    let mut text = Vec::new();
    generate(shell, program, "railspring", &mut text);
    print(&text)
}

/// Prints the manual page of the program, or writes those of all commands.
pub(super) fn man(mut program: clap::Command, args: &ManArgs) -> Result<(), Error> {
    let page = |command: clap::Command| -> Result<(String, Vec<u8>), Error> {
        let man = Man::new(command);
        let mut text = Vec::new();
        man.render(&mut text).map_err(|cause| {
            InputError::new("manual page", cause, "a page that can be made", "report this")
        })?;
        Ok((man.get_filename(), text))
    };
    program.build();
    let Some(path) = &args.output else { return print(&page(program)?.1) };
    let mut open = vec![program];
    let folder = OutputFolder::create(path, &Inputs::none())?;
    while let Some(command) = open.pop() {
        open.extend(command.get_subcommands().filter(|inner| inner.get_name() != "help").cloned());
        let (name, text) = page(command)?;
        folder.write(&name, &text)?;
    }
    say(&path.display().to_string())
}
