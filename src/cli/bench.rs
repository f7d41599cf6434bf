//! `railspring bench`: how time and memory grow with the size of a model.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use railspring_calibrate::error::Error;

use super::output::say;
use super::progress::Progress;
use super::{Failure, positive, take_threads};
use crate::estimate::{Budget, Resources};
use crate::output::OutputFolder;
use crate::records::ScalingRecord;
use crate::report::scaling;
use crate::scaling::{Sweep, sweep};
use crate::study::Study;

/// The study that is measured if none is named.
const DEFAULT: &str = include_str!("../../data/studies/uic60-s1002.toml");
/// Most sizes of a sweep.
const MOST_SIZES: i64 = 100;

/// Files of a sweep.
const RECORD: &str = "scaling.json";
const TABLE: &str = "scaling.csv";
const FIGURE: &str = "scaling.svg";

#[derive(Debug, Subcommand)]
pub(super) enum BenchCommand {
    /// Sweep the solid model over its degrees of freedom: time and memory of mesh, ordering, assembly, factorisation, condensation, modes,
    /// a load and a step in time. Writes scaling.csv, scaling.json and scaling.svg after every size
    Solid(SolidArgs),
}

/// The sizes, the study and where the results go.
#[derive(Debug, Args)]
pub(super) struct SolidArgs {
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
pub(super) fn run(BenchCommand::Solid(args): &BenchCommand) -> Result<(), Failure> {
    let study = match &args.study {
        Some(path) => Study::read(path)?,
        None => Study::parse(Path::new("uic60-s1002.toml"), DEFAULT)?,
    };
    solid(args, &study).map_err(|error| Failure::of_stage(&study, error))
}

/// Sweeps the solid model of a study.
fn solid(args: &SolidArgs, study: &Study) -> Result<(), Error> {
    let folder = OutputFolder::create(&args.output)?;
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
            say(&format!("{}, {}: exponent {}, {at}", found.quantity, found.of, scaling::exponent(found)))?;
        }
        say(&args.output.display().to_string())?;
    }
    Ok(())
}

/// Writes what is finished. The record comes first: table and figure follow from it.
fn write(folder: &OutputFolder, record: &ScalingRecord) -> Result<(), Error> {
    folder.write_json(RECORD, record)?;
    folder.write(TABLE, &record.csv())?;
    folder.write(FIGURE, scaling::figure(record).as_bytes())
}
