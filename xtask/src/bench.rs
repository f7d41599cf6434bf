//! `cargo xtask bench`: how time and memory grow with the size of a model or of a fleet.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use railspring::cli::output::say;
use railspring::cli::progress::Progress;
use railspring::cli::set_args::SetArgs;
use railspring::cli::{Failure, positive, take_threads};
use railspring::engine::inputs::Inputs;
use railspring::engine::output::OutputFolder;
use railspring::results::bodies::estimate::{Budget, Resources};
use railspring::results::run::input::SpringsInput;
use railspring::results::run::springs;
use railspring::study::Study;
use railspring_profiles::error::Error;

use crate::fleet::{Fleet, WHEELS_MOST};
use crate::scaling::{self, ScalingRecord, Sweep, sweep};
use crate::step_times::{self, Peers, StepTimesRecord, prepared, step_times};

/// The study that is measured if none is named.
const DEFAULT: &str = include_str!("../../data/studies/uic60-s1002.toml");
/// Most sizes of a sweep.
const MOST_SIZES: i64 = 100;

/// Files of a sweep.
const RECORD: &str = "scaling.json";
const TABLE: &str = "scaling.csv";
const FIGURE: &str = "scaling.svg";

/// Files of the steps' times.
const TIMES_RECORD: &str = "moving.json";
const TIMES_TABLE: &str = "moving.csv";
const TIMES_FIGURE: &str = "moving.svg";
/// Folder of the other programs.
const PEERS: &str = "peers";

#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// Sweep the solid model over its degrees of freedom: time and memory of mesh, ordering, assembly, factorisation, condensation, modes,
    /// a load and a step in time. Writes scaling.csv, scaling.json and scaling.svg after every size
    Solid(SolidArgs),
    /// Time a step of the moving solver: the published load case 4.1, a bridge of 25 m, and rails of 20 to 10000 beam elements; with --peers beside
    /// other programs. Writes moving.csv, moving.json and moving.svg
    Moving(MovingArgs),
    /// Make a table of synthetic measured wheels with a build of railspring, and again with new ones: time, memory, store, and what own
    /// bodies change. Writes the wheels, their table and fleet.json. 10000 wheels take most of an hour on two cores
    Fleet(FleetArgs),
}

/// The wheels and where they go.
#[derive(Debug, Args)]
pub struct FleetArgs {
    /// Wheels of the first run
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=WHEELS_MOST))]
    wheels: u32,
    /// New wheels of the second run; 0 leaves it out
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(0..=WHEELS_MOST))]
    new: u32,
    /// The build of railspring; left out, that of cargo build --release
    #[arg(long, value_name = "PATH")]
    program: Option<PathBuf>,
    /// Output folder
    #[arg(short, long, value_name = "DIR", default_value = "out/bench-fleet")]
    output: PathBuf,
    /// Further arguments of railspring table, behind --
    #[arg(last = true, value_name = "ARGUMENT")]
    arguments: Vec<String>,
}

/// The runs and where the results go.
#[derive(Debug, Args)]
pub struct MovingArgs {
    /// Most beam elements of a bridge or a rail
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(20..=10_000))]
    to: u32,
    /// Runs of each case, of which the shortest counts
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    /// A stiffness_by_angle.json of the default study's pair, whose condensed contact element is timed beside the published one
    #[arg(long, value_name = "FILE")]
    element: Option<PathBuf>,
    /// Time OpenSees' WheelRail on the bridge, and the contact element in hosts in Rust, C, FMPy and Exudyn, in turns with the others. Makes the
    /// element and installs these programs below the output folder, which takes some minutes
    #[arg(long, conflicts_with = "element")]
    peers: bool,
    /// Output folder
    #[arg(short, long, value_name = "DIR", default_value = "out/bench-moving")]
    output: PathBuf,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// The sizes, the study and where the results go.
#[derive(Debug, Args)]
pub struct SolidArgs {
    /// Degrees of freedom of the largest size; 1000000 takes six minutes and 8 GiB of memory
    #[arg(long, value_name = "DOF", default_value_t = 400_000, value_parser = degrees_of_freedom)]
    to: usize,
    /// Degrees of freedom of the smallest size; left out, 50000, or what the contact zone of the study takes at least
    #[arg(long, value_name = "DOF", value_parser = degrees_of_freedom)]
    from: Option<usize>,
    /// How many sizes, in equal ratios
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(2..=MOST_SIZES))]
    sizes: u16,
    /// A study, of which the bodies are refined; left out, the default study
    #[arg(long, value_name = "STUDY")]
    study: Option<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
    /// Output folder
    #[arg(short, long, value_name = "DIR", default_value = "out/bench-solid")]
    output: PathBuf,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
    /// Number of threads; left out, one for each core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Leave out sizes that are expected to need more memory, GiB; left out, what the machine has available
    #[arg(long, value_name = "GIB", value_parser = positive)]
    memory_limit: Option<f64>,
}

/// A number of degrees of freedom.
fn degrees_of_freedom(text: &str) -> Result<usize, String> {
    const MOST: f64 = 1e9;
    match text.parse::<f64>() {
        Ok(value) if (1.0..=MOST).contains(&value) => Ok(value.round() as usize),
        _ => Err("expected a number of degrees of freedom, for instance 400000 or 4e5".into()),
    }
}

/// Runs a command.
pub fn run(command: &BenchCommand) -> Result<(), Failure> {
    let study = match command {
        BenchCommand::Solid(SolidArgs { study: Some(path), set, .. }) => {
            Study::read_with(path, set.settings())?
        }
        BenchCommand::Solid(SolidArgs { set, .. }) => {
            Study::parse_with(Path::new("uic60-s1002.toml"), DEFAULT, set.settings())?
        }
        BenchCommand::Moving(_) | BenchCommand::Fleet(_) => {
            Study::parse(Path::new("uic60-s1002.toml"), DEFAULT)?
        }
    };
    let done = match command {
        BenchCommand::Solid(args) => solid(args, &study),
        BenchCommand::Moving(args) => moving(args, &study),
        BenchCommand::Fleet(args) => fleet(args),
    };
    done.map_err(|error| Failure::of_stage(&study, error))
}

/// Times a table of synthetic measured wheels.
fn fleet(args: &FleetArgs) -> Result<(), Error> {
    let folder = OutputFolder::create(&args.output, &Inputs::none())?;
    let _claim = folder.claim()?;
    let wheels = [args.wheels as usize, args.new as usize];
    let FleetArgs { program, arguments, output, .. } = args;
    Fleet { wheels, program: program.as_deref(), arguments, folder: &folder }.measured()?;
    say(&output.display().to_string())
}

/// Times steps of the moving solver on the profiles of a study.
fn moving(args: &MovingArgs, study: &Study) -> Result<(), Error> {
    let read = |file: &PathBuf| springs::element_of(&SpringsInput::of(study), file);
    let given = args.element.as_ref().map(read).transpose()?;
    let folder = OutputFolder::create(&args.output, &Inputs::none())?;
    let _claim = folder.claim()?;
    let progress = Progress::new(args.quiet);
    let (element, others) = match args.peers {
        true => {
            let Peers { element, list } = prepared(&folder.path().join(PEERS), &progress)?;
            (Some(read(&element)?), list)
        }
        false => (given, Vec::new()),
    };
    let (most, repeats) = (args.to as usize, args.repeats.into());
    let record = step_times(study, element.as_ref(), &others, most, repeats, &progress)?;
    progress.finish();
    folder.write_json(TIMES_RECORD, &record)?;
    folder.write(TIMES_TABLE, &record.csv())?;
    folder.write(TIMES_FIGURE, step_times::figure::figure(&record).as_bytes())?;
    if !args.quiet {
        for line in table(&record) {
            say(&line)?;
        }
        say(&args.output.display().to_string())?;
    }
    Ok(())
}

/// A line for each case, and under it one for each time of another program.
fn table(record: &StepTimesRecord) -> Vec<String> {
    let mut lines = vec![format!(
        "{:<18}{:>9}  {:<48}{:>16}  {}",
        "case", "elements", "program", "\u{b5}s a step", "times as long"
    )];
    for time in &record.times {
        let (case, elements) = (time.case.as_str(), time.elements);
        let (steps, iterations) = (time.inner_steps, time.iterations);
        let own = format!("{} element, {steps:.1} steps of {iterations:.1} iterations", time.element);
        lines.push(format!("{case:<18}{elements:>9}  {own:<48}{:>16.1}", time.microseconds));
        for peer in record.peers_of(case, elements) {
            let ratio = peer.microseconds / time.microseconds;
            lines.push(format!("{:<27}  {:<48}{:>16.1}  {ratio:.1}", "", peer.program, peer.microseconds));
        }
    }
    lines.push(format!("{}, shortest of {} runs, all in turns.", record.clock, record.repeats));
    lines
}

/// Sweeps the solid model of a study.
fn solid(args: &SolidArgs, study: &Study) -> Result<(), Error> {
    let folder = OutputFolder::create(&args.output, &Inputs::none())?;
    take_threads(args.threads)?;
    let _claim = folder.claim()?;
    let progress = Progress::new(args.quiet);
    let resources =
        Resources { budget: Budget::new(args.memory_limit), interpreter: None, monitor: &progress };
    let sizes = Sweep { from: args.from, to: args.to, sizes: args.sizes.into() };
    let record = sweep(study, &sizes, &resources, &mut |record| write(&folder, record))?;
    progress.finish();
    if !args.quiet {
        for found in &record.exponents {
            let unit = if found.unit.is_empty() { String::new() } else { format!(" {}", found.unit) };
            let at = format!("{:.3e}{unit} at 100000", found.at_100k);
            say(&format!(
                "{}, {}: exponent {}, {at}",
                found.quantity,
                found.of,
                scaling::figure::exponent(found)
            ))?;
        }
        say(&args.output.display().to_string())?;
    }
    Ok(())
}

/// Writes what is finished. The record comes first: table and figure follow from it.
fn write(folder: &OutputFolder, record: &ScalingRecord) -> Result<(), Error> {
    folder.write_json(RECORD, record)?;
    folder.write(TABLE, &record.csv())?;
    folder.write(FIGURE, scaling::figure::figure(record).as_bytes())
}
