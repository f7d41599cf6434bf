//! The command line: arguments, messages and exit codes.

mod findings;
pub mod output;
pub mod progress;
mod failure;
mod work_args;
mod shapes;
mod file_args;
pub mod set_args;
mod pair_args;
mod contact;
mod place;
mod profile;
mod cache;
mod export;
mod results;
mod pdf_args;
mod compare;
mod element_files;
mod track;
mod staged;
mod element;
mod fit;
mod table;
mod work;
mod shell;
mod self_test;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use cache::CacheCommand;
use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use compare::CompareArgs;
use element::ElementArgs;
use export::ExportArgs;
use failure::exit_code;
use fit::{FitArgs, NewArgs};
use output::{complain, say};
use profile::ProfileCommand;
use railspring_profiles::error::Error;
use results::Results;
use self_test::SelfTestArgs;
use shell::ManArgs;
use staged::StudyCommand;
use table::TableArgs;

use crate::study::{explain, schema};
use crate::version;

pub use failure::Failure;
pub use work_args::{positive, take_threads};

/// Exit codes, the same for all commands.
pub const EXIT_CODES: &str = "Exit codes:
  0    done, and every limit holds
  1    done, but a limit does not hold or the wheel has left the rail
  2    the input or the command line cannot be used, or the output cannot be written
  3    the numerics did not converge
  130  stopped with Ctrl-C";

/// Fits the contact springs between a railway wheel and a rail, and verifies them against a solid model.
#[derive(Debug, Parser)]
#[command(name = "railspring", version = version::FULL, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Fit the springs of a wheel on a rail, standards or measured profiles, without a study: law, horizontal stiffness, error band and report
    ///
    /// The keys of a study that the pair leaves open have their defaults, and --set gives others. The study is left in the output folder.
    Fit(FitArgs),
    /// Write the commented study of a pair, with a load case
    New(NewArgs),
    #[command(flatten)]
    OfStudy(StudyCommand),
    /// Put two results side by side: springs and whether they differ beyond their error bands, laws, verdicts, inputs
    Compare(CompareArgs),
    /// Write the springs for another program: columns, OpenSees, STEM, ROSE, GENSYS, CONTACT, CalculiX, Abaqus, MATLAB, Modelica, JSON
    Export(ExportArgs),
    /// Write the contact element of a study as a file that other programs compute with: a library in C, Python, FMI
    Element(ElementArgs),
    /// Make the springs of many pairs at many places: wheels on rails, shifts, diameters, and what else is varied. Run again, it makes only
    /// what is missing
    Table(TableArgs),
    /// Do one step of a table for another machine; `table --executor dask` has it run
    #[command(hide = true)]
    Work(work::StepArgs),
    /// Explain a key of the study file: meaning, unit, range and default; of a section its keys
    Explain {
        /// The key, such as contact.friction, or a section; left out, the sections are listed
        #[arg(value_name = "KEY")]
        key: Option<String>,
    },
    /// Print the JSON schema of the study file
    Schema,
    /// List, show, check and convert profiles and their files
    #[command(subcommand)]
    Profile(ProfileCommand),
    /// Look at the store of what was made before, and make room
    #[command(subcommand)]
    Cache(CacheCommand),
    /// Test this program on this machine against closed solutions and a half-space program; exit code 1 if a check fails
    SelfTest(SelfTestArgs),
    /// Print what a shell completes commands and options with
    Completions {
        /// The shell
        #[arg(value_name = "SHELL")]
        shell: Shell,
    },
    /// Print the manual page, or write a page for each command
    Man(ManArgs),
}

impl Command {
    /// The name of a command that prints its results as JSON.
    fn prints_json(&self) -> Option<&'static str> {
        let (name, work) = match self {
            Self::OfStudy(command) => {
                let (name, study) = command.parts();
                (name, study.work())
            }
            Self::Fit(args) => ("fit", args.work()),
            Self::Element(args) => ("element", args.work()),
            Self::Table(args) => ("table", args.work()),
            Self::Compare(args) => return args.json.then_some("compare"),
            _ => return None,
        };
        work.json.then_some(name)
    }
}

/// The program's commands with their options and help texts.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    ExitCode::from(run(std::env::args_os()))
}

/// Runs the program with arguments, of which the first is its name, and gives its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let code = match Cli::try_parse_from(arguments) {
        Ok(cli) => commanded(&cli),
        Err(answer) => answered(&answer),
    };
    // inside of another program nothing else does; what standard output does not take was said before
    let _ = std::io::stdout().flush();
    code
}

/// Runs the command.
fn commanded(cli: &Cli) -> u8 {
    match dispatch(&cli.command) {
        Ok(true) => 0,
        Ok(false) => 1,
        Err(failure) => {
            let (messages, code) = failure.messages();
            messages.iter().for_each(|message| complain(message));
            if let Some(name) = cli.command.prints_json() {
                // what standard output does not take cannot be said there
                let _ = Results::of(name).failed(messages, code).print(true, true);
            }
            code
        }
    }
}

/// Help, the version, or what is wrong with the arguments.
fn answered(answer: &clap::Error) -> u8 {
    let written = match answer.print() {
        Err(cause) if !answer.use_stderr() => output::written(Err(cause)),
        _ => Ok(()),
    };
    match written {
        Err(error) => {
            complain(&error.to_string());
            exit_code(&error)
        }
        Ok(()) => u8::try_from(answer.exit_code()).unwrap_or(2),
    }
}

/// Runs a command; whether all limits hold.
fn dispatch(command: &Command) -> Result<bool, Failure> {
    let done = |result: Result<(), Error>| result.map(|()| true).map_err(Failure::Plain);
    match command {
        Command::Fit(args) => fit::fit(args),
        Command::New(args) => fit::new(args).map(|()| true),
        Command::OfStudy(command) => staged::run(command),
        Command::Compare(args) => compare::run(args).map(|()| true),
        Command::Export(args) => export::export(args),
        Command::Element(args) => element::run(args),
        Command::Table(args) => table::run(args),
        Command::Explain { key } => {
            let lines = explain(key.as_deref())?;
            done(lines.iter().try_for_each(|line| say(line)))
        }
        Command::Schema => {
            let text = serde_json::to_string_pretty(&schema()).expect("a schema is plain JSON");
            done(say(&text))
        }
        Command::Work(args) => done(work::run(args)),
        Command::Profile(command) => profile::run(command),
        Command::SelfTest(args) => self_test::run(args).map_err(Failure::Plain),
        Command::Cache(command) => done(cache::run(command)),
        Command::Completions { shell } => done(shell::completions(&mut Cli::command(), *shell)),
        Command::Man(args) => done(shell::man(Cli::command(), args)),
    }
}
