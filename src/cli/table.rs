//! `railspring table`: the springs of many pairs at many places.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use railspring_profiles::error::{Error, InputError};
use serde_json::json;

use super::failure::Failure;
use super::output::remark;
use super::progress::Progress;
use super::results::Results;
use super::work_args::{WorkArgs, take_threads};
use crate::cluster::Cluster;
use crate::engine::inputs::Inputs;
use crate::engine::output::{Content, OutputFolder};
use crate::engine::store::Store;
use crate::hash::hash;
use crate::results::bodies::estimate::Resources;
use crate::table::earlier::{Earlier, EarlierFiles, RECORD};
use crate::table::rows::Rows;
use crate::table::{Places, Status, Table, about, changes, fleet, page, record, shapes};

/// Files of a table.
const ROWS: &str = "table.csv";
const PAGE: &str = "table.html";
/// Places of a table whose record is indented for a reader; that of more is in one line.
const INDENTED: usize = 1000;
const CHANGES: &str = "table_changes.csv";
const COLUMNS: &str = "table.parquet";
const FLEET: &str = "table_fleet.html";
const TYPICAL: &str = "table_typical.toml";
/// All of them.
const OUTPUTS: [&str; 7] = [ROWS, RECORD, PAGE, CHANGES, COLUMNS, FLEET, TYPICAL];

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
    #[command(flatten)]
    cluster: ClusterArgs,
}

/// Where the places are made.
#[derive(Debug, Args)]
struct ClusterArgs {
    /// What makes the places
    #[arg(long, value_enum, default_value_t = Executor::Local, requires_if("dask", "scheduler"))]
    executor: Executor,
    /// Scheduler of a running Dask cluster, for instance tcp://node1:8786; --threads is then for each step, 1 unless given
    #[arg(long, value_name = "ADDRESS")]
    scheduler: Option<String>,
    /// Folder of the store on the workers, relative to the folder of each; left out, that of this machine where a worker sees it, else one
    /// in the folder of the worker
    #[arg(long, value_name = "DIR", requires = "scheduler")]
    worker_cache: Option<PathBuf>,
    /// This program on the workers; left out, under the same path as here or on the search path
    #[arg(long, value_name = "PATH", requires = "scheduler")]
    worker_program: Option<PathBuf>,
    /// Seconds after which a worker that says nothing counts as lost, so that others do its steps; on large clusters ten of its heartbeats at least
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, value_parser = seconds)]
    worker_silence: f64,
}

/// A time of some seconds at least.
fn seconds(text: &str) -> Result<f64, String> {
    let given: Option<f64> = text.parse().ok();
    given
        .filter(|seconds| (1.0..=1e6).contains(seconds))
        .ok_or_else(|| "expected seconds from 1 to 1e6; give a number".into())
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Executor {
    /// The threads of this machine
    Local,
    /// The workers of a Dask cluster
    Dask,
}

impl ClusterArgs {
    /// The cluster, if it is to make the places.
    ///
    /// # Errors
    /// [`InputError`] for a scheduler of another executor.
    fn cluster<'a>(&'a self, work: &WorkArgs, fresh: bool) -> Result<Option<Cluster<'a>>, InputError> {
        match (self.executor, &self.scheduler) {
            (Executor::Dask, Some(_)) if work.cache_key.is_some() => Err(InputError::new(
                "--cache-key",
                "given",
                "no key with --executor dask: workers do not sign what they make",
                "leave it out, or make the table on this machine",
            )),
            (Executor::Dask, Some(scheduler)) => Ok(Some(Cluster {
                scheduler,
                cache: self.worker_cache.as_deref(),
                program: self.worker_program.as_deref(),
                threads: work.threads.unwrap_or(1),
                memory_limit_gib: work.memory_limit,
                fresh,
                silence: self.worker_silence,
            })),
            (Executor::Local, Some(scheduler)) => {
                let expected = "no scheduler for --executor local";
                Err(InputError::new(
                    "--scheduler",
                    scheduler,
                    expected,
                    "give --executor dask, or leave it out",
                ))
            }
            (_, None) => Ok(None),
        }
    }
}

impl TableArgs {
    /// What all commands that solve need to know.
    pub fn work(&self) -> &WorkArgs {
        &self.work
    }
}

/// Makes a table; whether every place has a law, and nothing is left to look at in the profiles.
pub(super) fn run(args: &TableArgs) -> Result<bool, Failure> {
    let table = Table::read(&args.table)?;
    made(args, &table).map_err(Failure::Plain)
}

fn made(args: &TableArgs, table: &Table) -> Result<bool, Error> {
    let cluster = args.cluster.cluster(&args.work, args.fresh)?;
    // those of a step on a cluster are not those of this machine
    take_threads(args.work.threads.filter(|_| cluster.is_none()))?;
    let (results, json) = (Results::of("table").of_study(&table.document.name), args.work.json);
    let progress = Progress::new(args.work.quiet);
    let resources = args.work.resources(&progress);
    let store = args.work.store()?;
    table.notices.iter().for_each(|notice| resources.monitor.notice(notice));
    let places = Places::of(table, &store, args.fresh, resources);
    let plan = places.plan(args.dry_run)?;
    if args.dry_run {
        progress.finish();
        let text = plan.text();
        let more = json!({ "plan": text });
        return results.with_more(vec![text], more).print(json, args.work.quiet).map(|()| true);
    }
    let path = args.output.clone().unwrap_or_else(|| PathBuf::from("out").join(&table.document.name));
    let inputs = Inputs::of(&table.files);
    inputs.check_folder(&path, |name| OUTPUTS.contains(&name))?;
    // before anything is made; it may be the very file that is written next
    let earlier = args.diff.as_deref().map(Earlier::read).transpose()?;
    let folder = OutputFolder::create(&path, &inputs)?;
    let there = EarlierFiles::of(&path)?;
    // whether there is a page of a fleet is known later
    there.check([ROWS, PAGE, COLUMNS].into_iter().chain(earlier.as_ref().map(|_| CHANGES)))?;
    let _claim = folder.claim()?;
    if !args.work.quiet {
        remark(&plan.text());
    }
    let places = match &cluster {
        Some(cluster) => on_cluster(cluster, table, &store, places, resources)?,
        None => places,
    };
    let made = places.make()?;
    progress.finish();
    let rows = Rows::of(table, &made)?;
    let changes = earlier.as_ref().map(|earlier| changes::since(earlier, &rows)).transpose()?;
    let earlier = earlier.as_ref().map(fleet::earlier).transpose()?;
    let about = about(table, &args.table, &path, earlier.as_ref());
    let fleet = fleet::page(&rows, &shapes(&made), &about);
    let page = page(&table.document.name, &table.document.description, &rows, fleet.as_ref().map(|_| FLEET));
    let mut files: Vec<(&str, Vec<u8>)> =
        vec![(ROWS, rows.csv()), (COLUMNS, fleet::parquet(&rows)), (PAGE, page.into_bytes())];
    files.extend(changes.iter().map(|changes| (CHANGES, changes.csv())));
    let (html, typical) = fleet.map_or((None, None), |pages| (Some(pages.html), pages.typical));
    let of_fleet = [(FLEET, html), (TYPICAL, typical)];
    files.extend(of_fleet.iter().filter_map(|(name, text)| Some((*name, text.clone()?.into_bytes()))));
    // those of an earlier table of this name say nothing of this one; what a user has put there stays
    let outdated: Vec<&str> = of_fleet
        .iter()
        .filter(|(name, text)| text.is_none() && there.is_as_written(name))
        .map(|(name, _)| *name)
        .collect();
    there.check(files.iter().map(|(name, _)| *name))?;
    let written = files.iter().map(|(name, content)| ((*name).to_owned(), hash(content))).collect();
    let record = record(table, &made, written)?;
    // the record first: a table that is stopped between two files knows that they are its own
    let record = (RECORD, Content::json(&record, made.count() <= INDENTED));
    let files = files.into_iter().map(|(name, content)| (name, content.into()));
    folder.write_together(&[record].into_iter().chain(files).collect::<Vec<_>>())?;
    outdated.iter().try_for_each(|name| folder.remove(name))?;
    let with = |status: Status| made.places().filter(|at| at.status() == status).count();
    let [complete, early, failed] = [Status::Complete, Status::EndsEarly, Status::Failed].map(with);
    let count = format!(
        "{} places: {complete} complete, {early} with a law that ends early, {failed} without a law",
        made.count()
    );
    let with_findings = made.places().filter(|at| at.has_findings()).count();
    let unsure = (with_findings > 0).then(|| {
        format!(
            "places with unresolved findings in their profiles: {with_findings}; see the column findings_left of {}",
            folder.file(ROWS).display()
        )
    });
    let changed: Vec<String> = changes.iter().flat_map(changes::Changes::lines).collect();
    let is_fleet = of_fleet.iter().any(|(_, text)| text.is_some());
    let fleet = is_fleet
        .then(|| format!("the measured profiles beside each other: {}", folder.file(FLEET).display()));
    let more = json!({
        "places": made.count(), "complete": complete, "ends_early": early, "failed": failed,
        "with_findings_left": with_findings, "changes": changed
    });
    let holds = failed == 0 && with_findings == 0;
    results
        .with_more([count].into_iter().chain(unsure).chain(fleet).chain(changed).collect(), more)
        .at(&folder.file(PAGE))
        .holding(holds)
        .print(json, args.work.quiet)?;
    Ok(holds)
}

/// The places after a cluster has made those that are missing; what is left is for this machine.
fn on_cluster<'a>(
    cluster: &Cluster<'_>,
    table: &'a Table,
    store: &'a Store,
    places: Places<'a>,
    resources: Resources<'a>,
) -> Result<Places<'a>, Error> {
    let summary = cluster.make(table, &places, store, &resources)?;
    resources.monitor.notice(&summary.text());
    let after = Places::of(table, store, false, resources);
    let left: usize = after.wanted().iter().map(|(_, shifts)| shifts.len()).sum();
    if left > 0 {
        resources.monitor.notice(&format!("{left} places are made on this machine"));
    }
    Ok(after)
}
