//! `railspring table`: the springs of many pairs at many places.

use std::path::PathBuf;

use clap::Args;
use railspring_calibrate::error::Error;

use super::output::{remark, say};
use super::progress::Progress;
use super::{Failure, positive, take_threads};
use crate::estimate::{Budget, Resources};
use crate::output::OutputFolder;
use crate::store::{self, Store};
use crate::table::rows::{Rows, Status};
use crate::table::{Places, Table, changes, page, record};

/// Files of a table.
const ROWS: &str = "table.csv";
const RECORD: &str = "table.json";
const PAGE: &str = "table.html";
const CHANGES: &str = "table_changes.csv";

/// The table and where its results go.
#[derive(Debug, Args)]
pub(super) struct TableArgs {
    /// The table, a TOML file
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    /// Output folder; left out, out/<name of the table>
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Say what is different from an earlier table.csv, by how much and because of which input, and write table_changes.csv
    #[arg(long, value_name = "FILE")]
    diff: Option<PathBuf>,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
    /// Number of threads; left out, one for each core. The results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Python with meshio, for mesh files; left out, a virtual environment in the cache folder
    #[arg(long, value_name = "PATH")]
    python: Option<PathBuf>,
    /// Refuse what is expected to need more memory, GiB; left out, what the machine has available
    #[arg(long, value_name = "GIB", value_parser = positive)]
    memory_limit: Option<f64>,
    /// Print what is to be done, and stop
    #[arg(long)]
    dry_run: bool,
    /// Folder of the store, in which bodies and places are kept and found again; left out, one in the user's cache folder
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Make again the places that would be taken from the store, and replace them there
    #[arg(long)]
    fresh: bool,
}

/// Makes a table; whether every place has a law.
pub(super) fn run(args: &TableArgs) -> Result<bool, Failure> {
    let table = Table::read(&args.table)?;
    made(args, &table).map_err(Failure::Plain)
}

fn made(args: &TableArgs, table: &Table) -> Result<bool, Error> {
    take_threads(args.threads)?;
    let progress = Progress::new(args.quiet);
    let resources = Resources {
        budget: Budget::new(args.memory_limit),
        interpreter: args.python.as_deref(),
        monitor: &progress,
    };
    let store = Store::open(&args.cache.clone().unwrap_or_else(store::default_folder))?;
    let places = Places::of(table, &store, args.fresh, resources);
    let plan = places.plan()?;
    if args.dry_run {
        progress.finish();
        return say(&plan.text()).map(|()| true);
    }
    let path = args.output.clone().unwrap_or_else(|| PathBuf::from("out").join(&table.document.name));
    let folder = OutputFolder::create(&path)?;
    let _claim = folder.claim()?;
    if !args.quiet {
        remark(&plan.text());
    }
    let made = places.make()?;
    progress.finish();
    let rows = Rows::of(table, &made);
    // the earlier one may be the very file that is written next
    let changes = args.diff.as_ref().map(|earlier| changes::since(earlier, &rows)).transpose()?;
    folder.write(ROWS, &rows.csv())?;
    folder.write_json(RECORD, &record(table, &made))?;
    folder.write(PAGE, page(&table.document.name, &table.document.description, &rows).as_bytes())?;
    let with = |status: Status| made.iter().filter(|(_, record)| Status::of(record) == status).count();
    let [complete, early, failed] = [Status::Complete, Status::EndsEarly, Status::Failed].map(with);
    if let Some(changes) = &changes {
        folder.write(CHANGES, &changes.csv())?;
    }
    if !args.quiet {
        say(&format!(
            "{} places: {complete} complete, {early} with a law that ends early, {failed} without a law",
            made.len()
        ))?;
        for line in changes.iter().flat_map(changes::Changes::lines) {
            say(&line)?;
        }
        say(&folder.file(PAGE).display().to_string())?;
    }
    Ok(failed == 0)
}
