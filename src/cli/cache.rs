//! `railspring cache`: what the store holds, and making room.

use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use clap::{Args, Subcommand};
use railspring_profiles::error::Result;

use super::output::say;
use super::work_args::positive;
use crate::engine::store::{Listed, Prune, Store, default_folder};

/// Entries that were not used for so many days go, if nothing else is said.
const UNUSED_DAYS: f64 = 30.0;
const DAY: f64 = 24.0 * 3600.0;
const MIB: f64 = 1024.0 * 1024.0;
/// Digits of a key that a list shows.
const SHOWN: usize = 12;

#[derive(Debug, Subcommand)]
pub(super) enum CacheCommand {
    /// List what the store holds: what it is, its key, size, last use and study
    List(Folder),
    /// Remove entries: without options those that were not used for 30 days. Entries that cannot be read go always
    Prune {
        #[command(flatten)]
        folder: Folder,
        /// Remove entries that were not used for so many days
        #[arg(long, value_name = "DAYS", value_parser = positive)]
        older_than: Option<f64>,
        /// While the store is larger than so many MiB, remove the entry that was not used for longest
        #[arg(long, value_name = "MIB", value_parser = positive)]
        larger_than: Option<f64>,
        /// Remove all entries
        #[arg(long, conflicts_with_all = ["older_than", "larger_than"])]
        all: bool,
    },
}

/// Where the store is.
#[derive(Debug, Args)]
pub(super) struct Folder {
    /// Folder of the store; left out, the one in the user's cache folder
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
}

impl Folder {
    fn path(&self) -> Result<PathBuf> {
        self.cache.clone().map_or_else(default_folder, Ok)
    }
}

/// Runs a command on the store.
///
/// # Errors
/// A folder that cannot be used, and entries that cannot be removed.
pub(super) fn run(command: &CacheCommand) -> Result<()> {
    let (CacheCommand::List(folder) | CacheCommand::Prune { folder, .. }) = command;
    let path = folder.path()?;
    if !path.is_dir() {
        // Nothing was kept yet, and nothing is made for looking at it.
        return say(&format!("no entries: {} does not exist", path.display()));
    }
    let store = Store::open(&path)?;
    match command {
        CacheCommand::List(_) => {
            let entries = store.list();
            let now = SystemTime::now();
            entries.iter().try_for_each(|entry| say(&line(entry, now)))?;
            say(&format!("{} in {}", total(&entries), path.display()))
        }
        CacheCommand::Prune { older_than, larger_than, all, .. } => {
            let nothing_said = !all && older_than.is_none() && larger_than.is_none();
            let days = older_than.or(nothing_said.then_some(UNUSED_DAYS));
            let gone = store.prune(Prune {
                all: *all,
                // More days than fit a duration are more than any entry has.
                older_than: days.and_then(|days| Duration::try_from_secs_f64(days * DAY).ok()),
                larger_than: larger_than.map(|mib| (mib * MIB) as u64),
            })?;
            say(&format!("removed {}; left {} in {}", total(&gone), total(&store.list()), path.display()))
        }
    }
}

/// One entry: what, key, size, last use, study and name.
fn line(entry: &Listed, now: SystemTime) -> String {
    let idle = now.duration_since(entry.used).unwrap_or_default().as_secs();
    let (name, study) = match &entry.made {
        Some((name, study)) => (name.as_str(), study.as_str()),
        None => ("cannot be read; `railspring cache prune` removes it", "?"),
    };
    format!(
        "{:<12}  {}  {:>10}  used {:>6} ago  {study}: {name}",
        entry.kind.name(),
        &entry.key[..SHOWN],
        size(entry.bytes),
        age(idle)
    )
}

fn total(entries: &[Listed]) -> String {
    let plural = if entries.len() == 1 { "entry" } else { "entries" };
    format!("{} {plural}, {}", entries.len(), size(entries.iter().map(|entry| entry.bytes).sum()))
}

fn size(bytes: u64) -> String {
    format!("{:.2} MiB", bytes as f64 / MIB)
}

fn age(seconds: u64) -> String {
    match seconds {
        0..120 => format!("{seconds} s"),
        120..7200 => format!("{} min", seconds / 60),
        7200..172_800 => format!("{} h", seconds / 3600),
        _ => format!("{} d", seconds / 86_400),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_and_sizes_read_well() {
        assert_eq!([0, 119, 120, 7200, 172_800].map(age), ["0 s", "119 s", "2 min", "2 h", "2 d"]);
        assert_eq!(size(1 << 20), "1.00 MiB");
    }
}
