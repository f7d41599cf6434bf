//! The command line: commands, messages and exit codes.

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use railspring::cli::Failure;
use railspring::cli::output::complain;

use crate::bench::{self, BenchCommand};
use crate::half_space::{self, HalfSpaceArgs};
use crate::long::{self, LongArgs};
use crate::prose::{self, ProseArgs};
use crate::reference::{self, ReferenceArgs};
use crate::same_bytes::{self, SameBytesArgs};

/// What a developer of railspring needs and a user does not. Exit codes are those of railspring.
#[derive(Debug, Parser)]
#[command(name = "xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Measure how time and memory grow with the size of a model
    #[command(subcommand)]
    Bench(BenchCommand),
    /// Write the reference pages of the documents from the program
    Reference(ReferenceArgs),
    /// Run the tests that are ignored otherwise, one after another, and write a table of them; exit code 1 if one fails
    Long(LongArgs),
    /// Count the words of the sentences of documents and doc comments; exit code 1 where they are too long, or where a page of the book does not
    /// begin with a question and its answer
    Prose(ProseArgs),
    /// Compare contact on half-spaces, stiff and flexible bodies with the tables of a half-space program; exit code 1 if half-spaces or stiff
    /// bodies do not hold a limit. Writes half-space.md, half-space.csv, flange.csv and a figure for each of the bodies
    HalfSpace(HalfSpaceArgs),
    /// Run two builds of railspring on the same studies and compare their files byte for byte; exit code 1 if one differs
    SameBytes(SameBytesArgs),
}

/// The commands of `cargo xtask` with their options and what is said about them.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the command that the arguments of the process name.
pub fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Bench(command) => bench::run(&command).map(|()| true),
        Command::Reference(args) => reference::write(&args).map(|()| true).map_err(Failure::from),
        Command::Long(args) => long::run(&args).map_err(Failure::from),
        Command::Prose(args) => prose::run(&args).map_err(Failure::from),
        Command::HalfSpace(args) => half_space::run(&args).map_err(Failure::from),
        Command::SameBytes(args) => same_bytes::run(&args).map_err(Failure::from),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(failure) => {
            let (messages, code) = failure.messages();
            messages.iter().for_each(|message| complain(message));
            ExitCode::from(code)
        }
    }
}
