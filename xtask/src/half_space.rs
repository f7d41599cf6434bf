//! `cargo xtask half-space`: contact against the tables of a half-space program, on half-spaces, on stiff bodies and on the real ones.
//!
//! The tables are no part of the project ([`facts`]). All bodies are pressed without friction, as there. On half-spaces the quantities are
//! those of the tables; solids add what their bodies do, and each difference is taken apart ([`record::Compared::parts`]).

mod facts;
mod bodies;
mod record;
mod press;
mod table;
mod figure;

use std::path::{Path, PathBuf};

use clap::Args;
use railspring::cli::output::say;
use railspring::cli::progress::Progress;
use railspring::engine::inputs::Inputs;
use railspring::engine::output::OutputFolder;
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;

use bodies::{PressedOn, both_pairs};
use record::Comparison;

/// Files of the comparison.
const TABLE: &str = "half-space.md";
const ROWS: &str = "half-space.csv";
const FLANGE: &str = "flange.csv";

/// Where the tables are and where the results go.
#[derive(Debug, Args)]
pub struct HalfSpaceArgs {
    /// Folder with the tables of the half-space program; left out, RAILSPRING_FACTS, or ../shared/facts beside the project
    #[arg(long, value_name = "DIR")]
    facts: Option<PathBuf>,
    /// Least load that is judged, kN; smaller ones are in the files
    #[arg(long, value_name = "KN", default_value_t = 20.0, value_parser = railspring::cli::positive)]
    from: f64,
    /// Output folder
    #[arg(short, long, value_name = "DIR", default_value = "out/half-space")]
    output: PathBuf,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// Compares and writes; whether half-spaces and stiff bodies hold every limit. Flexible bodies roll, which a half-space program does not know: they
/// are counted, not judged.
///
/// # Errors
/// Tables that are missing or wrong, a pair that cannot be pressed, an interruption.
pub fn run(args: &HalfSpaceArgs) -> Result<bool> {
    let cases = facts::read(&folder(args.facts.as_deref()))?;
    let output = OutputFolder::create(&args.output, &Inputs::none())?;
    let _claim = output.claim()?;
    let progress = Progress::new(args.quiet);
    let mut comparison = Comparison::new(args.from);
    let names = facts::pairs(&cases);
    for (n, (rail, wheel)) in names.iter().enumerate() {
        progress.progress("pairs", n, names.len())?;
        let pairs = both_pairs(rail, wheel, &progress)?;
        let of_pair: Vec<_> = cases.iter().filter(|case| case.is_of(rail, wheel)).collect();
        comparison.rows.extend(press::against_tables(&pairs, &of_pair, &progress)?);
        comparison.flange.extend(press::on_the_flange(&pairs, &progress)?);
    }
    progress.finish();
    let mut files = vec![
        (TABLE.to_owned(), table::markdown(&comparison).into_bytes()),
        (ROWS.to_owned(), comparison.csv()),
        (FLANGE.to_owned(), comparison.flange_csv()),
    ];
    for on in PressedOn::ALL {
        files.push((format!("{}.svg", on.file()), figure::figure(&comparison, on).into_bytes()));
    }
    for (name, content) in &files {
        output.write(name, content)?;
    }
    if !args.quiet {
        for on in PressedOn::ALL {
            say(&table::counts(&comparison, on))?;
        }
        say(&args.output.display().to_string())?;
    }
    Ok(comparison.holds())
}

/// The folder of the tables.
fn folder(given: Option<&Path>) -> PathBuf {
    given
        .map(Path::to_path_buf)
        .or_else(|| std::env::var_os("RAILSPRING_FACTS").map(PathBuf::from))
        .unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/facts"))
}
