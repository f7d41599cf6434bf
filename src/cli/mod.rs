//! The command line: arguments, messages and exit codes.

mod findings;
mod output;
mod progress;
mod shapes;
mod file_args;
mod contact;
mod place;
mod profile;
mod cache;
mod export;
mod bench;
mod table;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};
use railspring_calibrate::error::{Error, InputError};
use railspring_calibrate::history::Ending;
use railspring_calibrate::monitor::Monitor;

use crate::crosscheck::deck::Format;
use crate::crosscheck::exchange::Case;
use crate::crosscheck::write_deck;
use crate::estimate::{self, Budget, Resources, Work};
use crate::output::OutputFolder;
use crate::pipeline::{Pipeline, REPORT};
use crate::python::Purpose;
use crate::records::crosscheck::CrosscheckRecord;
use crate::records::{RunRecord, VerificationRecord, with_unit};
use crate::store::{self, Store};
use crate::study::{LocatedError, Mistakes, Study, schema};
use crate::verify::HeldBy;

use bench::BenchCommand;
use cache::CacheCommand;
use export::ExportArgs;
use output::{remark, say};
use profile::ProfileCommand;
use progress::Progress;

/// Exit codes, the same for all commands.
const EXIT_CODES: &str = "Exit codes:
  0    done, and every limit holds
  1    done, but a limit does not hold or the wheel has left the rail
  2    the input or the command line cannot be used, or the output cannot be written
  3    the numerics did not converge
  130  stopped with Ctrl-C";

/// Fits the contact springs between a railway wheel and a rail, and verifies them against a solid model.
#[derive(Debug, Parser)]
#[command(name = "railspring", version, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the whole study: calibrate, simulate, verify, report
    Run(StudyArgs),
    /// Calibrate: the load curve, the normal law and the horizontal stiffness
    Calibrate(StudyArgs),
    /// Simulate the load cases with the simple model
    Simulate {
        #[command(flatten)]
        study: StudyArgs,
        /// Springs to simulate with, a stiffness.json or a law written by hand; left out, those of the output folder
        #[arg(long, value_name = "FILE")]
        law: Option<PathBuf>,
    },
    /// Run the solid model where its histories are missing, and compare the simple model with it
    Verify(StudyArgs),
    /// Write the meshes of wheel and rail
    Mesh(StudyArgs),
    /// Write the report again from the files of the output folder
    Report(StudyArgs),
    /// Compare the solid model with reference solvers: scikit-fem, and CalculiX on request
    Crosscheck {
        #[command(flatten)]
        study: StudyArgs,
        /// Compare with elements of second order, too: some minutes, and 12 GB of memory with the default mesh
        #[arg(long)]
        second_order: bool,
        /// Compare with another program, too, if it is installed
        #[arg(long = "with", value_name = "PROGRAM")]
        with: Option<OtherProgram>,
        /// Write a copy of the record to this file, to be kept with the study
        #[arg(long, value_name = "FILE")]
        keep: Option<PathBuf>,
    },
    /// Write the springs for another program: columns, OpenSees, STEM, ROSE, GENSYS, CONTACT, CalculiX, Abaqus, MATLAB, JSON
    Export(ExportArgs),
    /// Write the solid problem as a deck for another program
    Deck {
        #[command(flatten)]
        study: StudyArgs,
        /// The program
        #[arg(long, value_name = "FORMAT")]
        format: Format,
    },
    /// Make the springs of many pairs at many places: wheels on rails, shifts, diameters, and what else is varied. Run again, it makes only
    /// what is missing
    Table(table::TableArgs),
    /// Print the JSON schema of the study file
    Schema,
    /// List, show, check and convert profiles and their files
    #[command(subcommand)]
    Profile(ProfileCommand),
    /// Look at the store of what was made before, and make room
    #[command(subcommand)]
    Cache(CacheCommand),
    /// Measure how time and memory grow with the size of a model
    #[command(subcommand)]
    Bench(BenchCommand),
}

/// What every stage needs to know.
#[derive(Debug, Args)]
struct StudyArgs {
    /// The study, a TOML file
    #[arg(value_name = "STUDY")]
    study: PathBuf,
    /// Output folder; left out, out/<name of the study>
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    work: WorkArgs,
    /// Print what `run`, `calibrate`, `verify`, `deck` or `crosscheck` would need, and stop
    #[arg(long)]
    dry_run: bool,
    /// Make again what `run`, `calibrate`, `simulate` or `verify` would take from the store, and replace it there
    #[arg(long)]
    fresh: bool,
}

/// What every command needs to know that solves.
#[derive(Debug, Args)]
struct WorkArgs {
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
    /// Number of threads; left out, one for each core. The results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Python with scikit-fem, meshio and scipy, for mesh files and the cross-check; left out, a virtual environment in
    /// the cache folder
    #[arg(long, value_name = "PATH")]
    python: Option<PathBuf>,
    /// Refuse what is expected to need more memory, GiB; left out, what the machine has available
    #[arg(long, value_name = "GIB", value_parser = positive)]
    memory_limit: Option<f64>,
    /// Folder of the store, in which results are kept and found again; left out, one in the user's cache folder
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
}

impl WorkArgs {
    fn resources<'a>(&'a self, progress: &'a Progress) -> Resources<'a> {
        let budget = Budget::new(self.memory_limit);
        Resources { budget, interpreter: self.python.as_deref(), monitor: progress }
    }

    fn store(&self) -> PathBuf {
        self.cache.clone().unwrap_or_else(store::default_folder)
    }
}

/// A positive number.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("expected a positive number".into()),
    }
}

/// A program that repeats the contact besides the Python reference.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum OtherProgram {
    /// CalculiX, run on the exported deck
    Calculix,
}

/// A failure with the place where it stands.
enum Failure {
    Study(Mistakes),
    Located(LocatedError),
    Plain(Error),
}

impl Failure {
    /// What is said about it, and the exit code.
    fn said(&self) -> (Vec<String>, u8) {
        match self {
            Self::Study(mistakes) => (mistakes.messages(), 2),
            Self::Located(error) => (vec![error.to_string()], 2),
            Self::Plain(error) => (vec![error.to_string()], exit_code(error)),
        }
    }

    /// An error of a stage, with the keys and the place of the study if it concerns one of them.
    fn of_stage(study: &Study, error: Error) -> Self {
        match error {
            Error::Input(input) => match study.with_keys(input) {
                input if study.owns(&input.key) => Self::Located(study.source.locate(input)),
                input => Self::Plain(input.into()),
            },
            other => Self::Plain(other),
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Plain(error)
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self::Plain(error.into())
    }
}

impl From<Mistakes> for Failure {
    fn from(mistakes: Mistakes) -> Self {
        Self::Study(mistakes)
    }
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(answer) => return answered(&answer),
    };
    match dispatch(&cli.command) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(failure) => {
            let (messages, code) = failure.said();
            for message in messages {
                remark(&format!("error: {message}"));
            }
            ExitCode::from(code)
        }
    }
}

/// Help, the version, or what is wrong with the arguments.
fn answered(answer: &clap::Error) -> ExitCode {
    let written = match answer.print() {
        Err(cause) if !answer.use_stderr() => output::written(Err(cause)),
        _ => Ok(()),
    };
    match written {
        Err(error) => {
            remark(&format!("error: {error}"));
            ExitCode::from(exit_code(&error))
        }
        Ok(()) => ExitCode::from(u8::try_from(answer.exit_code()).unwrap_or(2)),
    }
}

fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Input(_) => 2,
        Error::Numerics(_) => 3,
        Error::Interrupted => 130,
        // The error type may grow; an error of an unknown kind is no usable input.
        _ => 2,
    }
}

/// Runs a command; whether all limits hold.
fn dispatch(command: &Command) -> Result<bool, Failure> {
    let (args, law) = match command {
        Command::Schema => {
            let text = serde_json::to_string_pretty(&schema()).expect("a schema is plain JSON");
            return say(&text).map(|()| true).map_err(Failure::Plain);
        }
        Command::Profile(command) => return profile::run(command),
        Command::Cache(command) => return cache::run(command).map(|()| true).map_err(Failure::Plain),
        Command::Export(args) => return export::export(args).map(|()| true),
        Command::Bench(command) => return bench::run(command).map(|()| true),
        Command::Table(args) => return table::run(args),
        Command::Simulate { study, law } => (study, law.as_deref()),
        Command::Crosscheck { study, .. } | Command::Deck { study, .. } => (study, None),
        Command::Run(study)
        | Command::Calibrate(study)
        | Command::Verify(study)
        | Command::Mesh(study)
        | Command::Report(study) => (study, None),
    };
    let study = Study::read(&args.study)?;
    staged(command, args, &study, law).map_err(|error| Failure::of_stage(&study, error))
}

fn staged(
    command: &Command,
    args: &StudyArgs,
    study: &Study,
    law: Option<&std::path::Path>,
) -> Result<bool, Error> {
    if args.dry_run {
        return dry_run(command, args, study).map(|()| true);
    }
    let keeps = matches!(
        command,
        Command::Run(_)
            | Command::Calibrate(_)
            | Command::Simulate { .. }
            | Command::Verify(_)
            | Command::Crosscheck { .. }
    );
    if args.fresh && !keeps {
        let expected = "one of the commands `run`, `calibrate`, `simulate`, `verify` and `crosscheck`";
        return Err(InputError::new("--fresh", "given", expected, "leave it out").into());
    }
    let path = args.output.clone().unwrap_or_else(|| PathBuf::from("out").join(&study.name));
    let makes_its_own = matches!(
        command,
        Command::Run(_)
            | Command::Calibrate(_)
            | Command::Mesh(_)
            | Command::Crosscheck { .. }
            | Command::Deck { .. }
    );
    let folder = if makes_its_own || law.is_some() {
        OutputFolder::create(&path)?
    } else {
        OutputFolder::open(&path)?
    };
    take_threads(args.work.threads)?;
    let _claim = folder.claim()?;
    let progress = Progress::new(args.work.quiet);
    let resources = args.work.resources(&progress);
    let store = if keeps { open_store(&args.work, &progress)? } else { None };
    let pipeline = Pipeline::new(study, &folder, resources).keeping(store.as_ref(), args.fresh);
    let mut verdict = None;
    let holds = match command {
        Command::Run(_) => verdict.insert(pipeline.run()?).holds,
        Command::Calibrate(_) => pipeline.calibrate()?,
        Command::Simulate { .. } => {
            let runs = pipeline.simulate(law)?;
            progress.finish();
            if !args.work.quiet {
                print_runs(&runs)?;
            }
            runs.iter().all(|(_, run)| run.ending() == Some(Ending::Completed))
        }
        Command::Verify(_) => verdict.insert(pipeline.verify()?).holds,
        Command::Mesh(_) => pipeline.mesh().map(|()| true)?,
        Command::Report(_) => pipeline.report().map(|()| true)?,
        Command::Deck { format, .. } => write_deck(study, *format, &folder, &resources).map(|_| true)?,
        Command::Crosscheck { second_order, with, keep, .. } => {
            const CASES: [Case; 4] =
                [Case::SameMesh, Case::SameMeshFriction, Case::OtherSurface, Case::SecondOrder];
            let cases = if *second_order { &CASES[..] } else { &CASES[..3] };
            let record = pipeline.crosscheck(cases, with.is_some(), keep.as_deref())?;
            progress.finish();
            if !args.work.quiet {
                print_crosscheck(&record)?;
            }
            record.holds
        }
        Command::Schema
        | Command::Profile(_)
        | Command::Cache(_)
        | Command::Export(_)
        | Command::Table(_)
        | Command::Bench(_) => {
            unreachable!("done without a study")
        }
    };
    progress.finish();
    if !args.work.quiet {
        if let Some(verdict) = &verdict {
            print_lines(verdict)?;
        }
        let last =
            if matches!(command, Command::Run(_) | Command::Report(_)) { folder.file(REPORT) } else { path };
        say(&last.display().to_string())?;
        if let Some(verdict) = &verdict {
            say(&format!("verdict: {}", verdict.summary()))?;
        }
    }
    Ok(holds)
}

/// Takes as many threads as are wanted, those of the machine by default.
fn take_threads(threads: Option<u16>) -> Result<(), Error> {
    let Some(threads) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global().map_err(|cause| {
        InputError::new("--threads", cause, "a number of threads that the system grants", "take fewer").into()
    })
}

/// The store. One that was named must be there; without the default one everything is made, which is said.
fn open_store(args: &WorkArgs, progress: &Progress) -> Result<Option<Store>, Error> {
    match (Store::open(&args.store()), &args.cache) {
        (Ok(store), _) => Ok(Some(store)),
        (Err(error), Some(_)) => Err(error),
        (Err(error), None) => {
            progress.notice(&format!("nothing is taken from the store or kept there: {error}"));
            Ok(None)
        }
    }
}

/// Says what a command would need.
fn dry_run(command: &Command, args: &StudyArgs, study: &Study) -> Result<(), Error> {
    let work = match command {
        Command::Run(_) => Work::of(study, true, true),
        Command::Calibrate(_) => Work::of(study, true, false),
        Command::Verify(_) => Work::of(study, false, true),
        Command::Deck { .. } => Work::of(study, true, false),
        Command::Crosscheck { second_order, .. } => {
            let purpose = if *second_order { Purpose::SecondOrder } else { Purpose::FirstOrder };
            Work::of_crosscheck(purpose)
        }
        _ => {
            let expected = "a command that solves: `run`, `calibrate`, `verify`, `deck` or `crosscheck`";
            return Err(InputError::new("--dry-run", "given", expected, "leave it out").into());
        }
    };
    let progress = Progress::new(args.work.quiet);
    let estimate = estimate::dry_run(study, &work, &args.work.resources(&progress))?;
    progress.finish();
    if !args.work.quiet {
        say(&estimate.text())?;
    }
    Ok(())
}

/// The lines of the verdict, what could not be compared and what has to be known.
fn print_lines(verdict: &VerificationRecord) -> Result<(), Error> {
    for (subject, line) in verdict.lines() {
        let word = if line.holds { "holds" } else { "FAILS" };
        let (value, limit) = (with_unit(line.value, &line.unit), with_unit(Some(line.limit), &line.unit));
        let worth = [("solid", line.solid_worth), ("simple", line.simple_worth)].into_iter().filter_map(
            |(model, worth)| {
                Some(format!(", the {model} model itself {}", with_unit(Some(worth?), &line.unit)))
            },
        );
        let worth: String = worth.collect();
        let by = if line.held_by == Some(HeldBy::SolidWorth) {
            "; holds by what the solid model is worth"
        } else {
            ""
        };
        let over = line.over().map_or_else(String::new, |over| format!("; {over}"));
        let note = line.note.as_ref().map_or_else(String::new, |note| format!("; {note}"));
        say(&format!("{word}  {subject}: {} {value} (limit {limit}{worth}){by}{over}{note}", line.meaning))?;
    }
    for (subject, item) in verdict.not_applicable() {
        say(&format!("n/a    {subject}: {}: {}", item.meaning, item.reason))?;
    }
    for (subject, note) in verdict.notes() {
        say(&format!("note   {subject}: {note}"))?;
    }
    Ok(())
}

/// How each run of the simple model ended, and what has to be known about it.
fn print_runs(runs: &[(String, RunRecord)]) -> Result<(), Error> {
    for (name, run) in runs {
        let ending = run.ending().map_or_else(|| run.ending.clone(), |ending| ending.to_string());
        say(&format!("{name}: {ending}"))?;
        for note in run.springs.iter().flat_map(|springs| &springs.notes).chain(&run.notes) {
            say(&format!("note   {name}: {note}"))?;
        }
    }
    Ok(())
}

/// The largest differences of the cross-check, and every limit that does not hold.
fn print_crosscheck(record: &CrosscheckRecord) -> Result<(), Error> {
    for (check, holds) in record.worst() {
        let word = if holds { "holds" } else { "FAILS" };
        let load = check.load_kn.map_or_else(String::new, |load| format!(" at {load} kN"));
        say(&format!(
            "{word}  {}: {}: {:.2e}{load} (limit {:.0e})",
            check.problem, check.quantity, check.difference, check.limit
        ))?;
    }
    Ok(())
}
