//! The places of a table on a Dask cluster, through the Python package of `cluster/`.
//!
//! The package gets the cases that are missing, some in a line, as it asks for them; it sends their steps to the workers, where
//! `railspring work` does them, and puts the entries that come back into the store. What stands in the store is then taken from it, so that a table comes to
//! the same bytes wherever its places were made.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::Path;
use std::process::{ChildStdin, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;
use serde::Deserialize;
use serde_json::json;

use crate::engine::output::TEMPORARY;
use crate::engine::store::Store;
use crate::python::{Python, cache_folder};
use crate::results::bodies::estimate::Resources;
use crate::table::{Package, Places, Table};

/// Pause between two looks at whether the user wants to stop.
const PAUSE: Duration = Duration::from_millis(100);

/// A running Dask cluster, and what its workers work with.
#[derive(Debug, Clone, Copy)]
pub struct Cluster<'a> {
    /// Address of the scheduler.
    pub scheduler: &'a str,
    /// Folder of the store on the workers.
    pub cache: Option<&'a Path>,
    /// The program on the workers.
    pub program: Option<&'a Path>,
    /// Threads of a step.
    pub threads: u16,
    /// Memory of a step, GiB.
    pub memory_limit_gib: Option<f64>,
    /// Whether places that the store has are made again.
    pub fresh: bool,
    /// After how long a worker that says nothing is lost, s.
    pub silence: f64,
}

/// What the client of the cluster says.
#[derive(Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
enum Event {
    /// Places that are done, and all of them.
    Progress { done: usize, total: usize },
    /// Something that the user should know.
    Notice { text: String },
    /// A case that cannot be made on any worker.
    Refused { case: usize, reason: String },
    /// The end.
    Ended(Summary),
}

/// What has come of the places on the cluster.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Summary {
    /// Places that were made.
    pub places: usize,
    /// Steps that were begun again after a failure.
    pub again: usize,
    /// Steps that were begun a second time because they took long.
    pub beside: usize,
    /// Workers that have left.
    pub workers_lost: usize,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Why places are missing.
    failed: Option<String>,
}

impl Summary {
    /// The summary in a sentence.
    pub fn text(&self) -> String {
        let Self { places, again, beside, workers_lost, seconds, .. } = self;
        let rate = *places as f64 / seconds.max(1e-3);
        format!(
            "{places} places by the cluster in {seconds:.0} s ({rate:.1} a second); {again} steps restarted, {beside} started twice, \
             {workers_lost} workers lost"
        )
    }
}

impl Cluster<'_> {
    /// Has the missing places made, until each is in the store or its case is refused; cases that cannot be sent stay missing.
    ///
    /// # Errors
    /// [`InputError`] with key `--scheduler` where the cluster cannot be reached, has no worker with this program, or has not made all places
    /// after several attempts; with `--python` without the package `distributed`; an interruption. The store has what was made.
    pub fn make(
        &self,
        table: &Table,
        places: &Places<'_>,
        store: &Store,
        resources: &Resources<'_>,
    ) -> Result<Summary> {
        let monitor = resources.monitor;
        let mut sent = Vec::new();
        let mut stays: Option<(usize, &'static str)> = None;
        for (case, shifts) in places.wanted() {
            match Package::obstacle(&table.cases[case]) {
                None => sent.push((case, shifts)),
                Some(reason) => stays = Some((stays.map_or(1, |(count, _)| count + 1), reason)),
            }
        }
        if let Some((count, reason)) = stays {
            monitor.notice(&format!("{count} cases are not sent: {reason}"));
        }
        let total: usize = sent.iter().map(|(_, shifts)| shifts.len()).sum();
        if total == 0 {
            let none =
                Summary { places: 0, again: 0, beside: 0, workers_lost: 0, seconds: 0.0, failed: None };
            return Ok(none);
        }
        let python = Python::for_cluster(resources.interpreter, &cache_folder()?, monitor)?;
        let folder = std::path::absolute(store.path()).unwrap_or_else(|_| store.path().into());
        // workers that see this file share the store
        let token = tempfile::Builder::new()
            .prefix(&format!("{TEMPORARY}shared-"))
            .tempfile_in(&folder)
            .map_err(|cause| {
                let expected = "a store that can be written";
                InputError::new(
                    "--cache",
                    format!("{} ({cause})", folder.display()),
                    expected,
                    "make room there",
                )
            })?;
        let settings = self.settings(&table.document.name, store, &folder, token.path(), total);
        let mut child = python
            .module("__main__")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|cause| python.missing(&cause.to_string()))?;
        let messages = crate::python::messages_of(&mut child);
        let (input, output) =
            (child.stdin.take().expect("stdin is piped"), child.stdout.take().expect("stdout is piped"));
        let said = std::thread::scope(|scope| {
            // the client reads a case when it has use for it; one that has ended reads none
            scope.spawn(|| send(input, &settings, table, &sent));
            let (events, received) = channel();
            scope.spawn(move || {
                let lines = BufReader::new(output).lines().map_while(std::result::Result::ok);
                lines
                    .map(|line| serde_json::from_str::<Event>(&line))
                    .try_for_each(|event| events.send(event))
            });
            let said = listen(&received, table, monitor);
            if said.is_err() {
                let _ = child.kill();
            }
            said
        });
        let status = child.wait();
        let failed = |reason: String| {
            let expected = "a Dask cluster that makes all places";
            let remedy = "what was made is in the store: correct the cluster, and run again for the rest";
            InputError::new("--scheduler", format!("{} ({reason})", self.scheduler), expected, remedy)
        };
        match said? {
            Some(Summary { failed: Some(reason), .. }) => Err(failed(reason).into()),
            Some(summary) => Ok(summary),
            None => {
                let said = messages.recv().unwrap_or_default();
                let last = said.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no message");
                let status = status.map_or_else(|cause| cause.to_string(), |status| status.to_string());
                Err(failed(format!("its client has ended, {status}: {last}")).into())
            }
        }
    }

    /// The first line for the client.
    fn settings(
        &self,
        table: &str,
        store: &Store,
        folder: &Path,
        token: &Path,
        places: usize,
    ) -> serde_json::Value {
        let programs = match self.program {
            Some(program) => vec![program.display().to_string()],
            None => {
                let here = crate::program::command().map(|path| path.display().to_string());
                here.into_iter().chain(["railspring".to_owned()]).collect()
            }
        };
        json!({
            "scheduler": self.scheduler,
            "places": places,
            "table": table,
            "program": store.program(),
            "version": env!("CARGO_PKG_VERSION"),
            "programs": programs,
            "store": folder.display().to_string(),
            "token": token.file_name().map(|name| name.to_string_lossy()),
            "cache": self.cache.map(|path| path.display().to_string()),
            "threads": self.threads,
            "memory_limit_gib": self.memory_limit_gib,
            "fresh": self.fresh,
            "silence": self.silence,
        })
    }
}

/// Writes settings and packages of cases, a line each, as far as the client reads them.
fn send(input: ChildStdin, settings: &serde_json::Value, table: &Table, cases: &[(usize, Vec<f64>)]) {
    let mut input = BufWriter::new(input);
    let mut send = || -> std::io::Result<()> {
        writeln!(input, "{settings}")?;
        let shifts: BTreeMap<usize, &Vec<f64>> =
            cases.iter().map(|(number, shifts)| (*number, shifts)).collect();
        let numbers: Vec<usize> = shifts.keys().copied().collect();
        for numbers in Package::groups(table, &numbers) {
            let first = &table.cases[numbers[0]];
            let name = match numbers.len() {
                1 => format!("{} on {}", first.wheel, first.rail),
                more => format!("{} on {} and {} others", first.wheel, first.rail, more - 1),
            };
            let shifts: Vec<&Vec<f64>> = numbers.iter().map(|number| shifts[number]).collect();
            let package = Package::of(table, &numbers);
            let line = json!({ "cases": numbers, "name": name, "shifts_mm": shifts, "package": package });
            writeln!(input, "{line}")?;
        }
        input.flush()
    };
    // a client that has ended says why itself
    let _ = send();
}

/// Hands on what the client says, until its end.
///
/// # Errors
/// An interruption.
fn listen(
    received: &std::sync::mpsc::Receiver<serde_json::Result<Event>>,
    table: &Table,
    monitor: &dyn Monitor,
) -> Result<Option<Summary>> {
    let (mut done, mut total) = (0, 1);
    let mut refused = std::collections::BTreeSet::new();
    loop {
        monitor.progress("places", done, total)?;
        match received.recv_timeout(PAUSE) {
            Ok(Ok(Event::Progress { done: now, total: all })) => (done, total) = (now, all),
            Ok(Ok(Event::Notice { text })) => monitor.notice(&text),
            Ok(Ok(Event::Refused { case, reason })) => {
                if let (true, Some(case)) = (refused.insert(case), table.cases.get(case)) {
                    monitor.notice(&format!("{} on {}: no worker makes it: {reason}", case.wheel, case.rail));
                }
            }
            Ok(Ok(Event::Ended(summary))) => return Ok(Some(summary)),
            // a library of the client that prints
            Ok(Err(_)) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
        }
    }
}
