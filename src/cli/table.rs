//! `railspring table`: the springs of many pairs at many places.

use std::path::PathBuf;

use clap::Args;
use railspring_calibrate::error::Error;

use super::output::{remark, say};
use super::progress::Progress;
use super::{Failure, WorkArgs, take_threads};
use crate::output::OutputFolder;
use crate::store::Store;
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
    #[command(flatten)]
    work: WorkArgs,
    /// Print what is to be done, and stop
    #[arg(long)]
    dry_run: bool,
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
    take_threads(args.work.threads)?;
    let progress = Progress::new(args.work.quiet);
    let resources = args.work.resources(&progress);
    let store = Store::open(&args.work.store())?;
    let places = Places::of(table, &store, args.fresh, resources);
    let plan = places.plan()?;
    if args.dry_run {
        progress.finish();
        return say(&plan.text()).map(|()| true);
    }
    let path = args.output.clone().unwrap_or_else(|| PathBuf::from("out").join(&table.document.name));
    let folder = OutputFolder::create(&path)?;
    let _claim = folder.claim()?;
    if !args.work.quiet {
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
    if !args.work.quiet {
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
