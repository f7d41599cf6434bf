//! `fleet.json`: time, memory and rows of the runs of a fleet.

use std::collections::BTreeMap;
use std::path::Path;

use railspring::engine::measured::MachineRecord;
use railspring_profiles::error::{InputError, Result};
use serde::{Deserialize, Serialize};

/// Relative difference of a stiffness on shared bodies from that on own ones which every band may be as narrow as.
const WITHIN: f64 = 0.005;
/// What is compared with own bodies.
const QUANTITIES: [&str; 3] = ["displacement", "stiffness", "horizontal"];

/// All runs of a fleet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetRecord {
    /// When the first run began, UTC.
    pub begun_utc: String,
    /// What it ran on.
    pub machine: MachineRecord,
    /// Further arguments of the table.
    pub arguments: Vec<String>,
    /// The runs in their order; the second finds what the first has left in the store.
    pub runs: Vec<FleetRun>,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetRun {
    /// Files in the folder.
    pub wheels: usize,
    /// Wall clock, s.
    pub seconds: f64,
    /// Time of the processors by the program itself, s; none where the system does not tell it.
    pub computing_seconds: Option<f64>,
    /// Its largest resident memory, MiB.
    pub peak_memory_mib: Option<f64>,
    /// Size of the store, MB.
    pub store_mb: f64,
    /// Size of the results, MB.
    pub results_mb: f64,
    /// What the rows say.
    pub rows: Rows,
}

/// Rows of a table, counted.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Rows {
    /// By status.
    pub by_status: BTreeMap<String, usize>,
    /// Rows that were made on own bodies as well.
    pub on_own_bodies: usize,
    /// Of these, rows of which a quantity is farther off than 0.5 % and than its band.
    pub outside: usize,
    /// The largest of these differences by quantity, relative.
    pub largest: BTreeMap<String, f64>,
}

impl Rows {
    /// Counts the rows of a `table.csv`.
    ///
    /// # Errors
    /// A file that is no table.
    pub fn read(path: &Path) -> Result<Self> {
        let wrong = |cause: csv::Error| {
            InputError::new("table.csv", path.display(), "the rows of a table", cause.to_string())
        };
        let mut rows = Self::default();
        let mut reader = csv::Reader::from_path(path).map_err(wrong)?;
        for row in reader.deserialize::<BTreeMap<String, String>>() {
            rows.add(&row.map_err(wrong)?);
        }
        Ok(rows)
    }

    fn add(&mut self, row: &BTreeMap<String, String>) {
        *self.by_status.entry(row.get("status").cloned().unwrap_or_default()).or_default() += 1;
        let value = |name: String| row.get(&name)?.parse::<f64>().ok();
        let mut found = false;
        let mut outside = false;
        for quantity in QUANTITIES {
            let Some(own) = value(format!("{quantity}_rel_own_bodies")) else { continue };
            let band = value(format!("{quantity}_rel_bodies_band")).unwrap_or(0.0);
            found = true;
            outside |= own.abs() > band.max(WITHIN);
            let largest = self.largest.entry(quantity.into()).or_default();
            *largest = largest.max(own.abs());
        }
        self.on_own_bodies += usize::from(found);
        self.outside += usize::from(outside);
    }
}

impl FleetRun {
    /// The run in a sentence.
    pub fn line(&self) -> String {
        let Self { wheels, seconds, store_mb, results_mb, rows, .. } = self;
        let counts: Vec<String> =
            rows.by_status.iter().map(|(status, count)| format!("{count} {status}")).collect();
        let used =
            |value: Option<f64>, unit: &str| value.map_or("-".into(), |value| format!("{value:.0} {unit}"));
        format!(
            "{wheels} wheels: {seconds:.0} s, {} of computing, {}, store {store_mb:.0} MB, results {results_mb:.0} MB; rows: {}; {} rows on own \
             bodies as well, {} outside their bands",
            used(self.computing_seconds, "s"),
            used(self.peak_memory_mib, "MiB"),
            counts.join(", "),
            rows.on_own_bodies,
            rows.outside
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: rows count by their status; a difference is outside where it is beyond its band and 0.5 %.
    #[test]
    fn differences_beyond_their_bands_are_counted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        let text = "status,stiffness_rel_own_bodies,stiffness_rel_bodies_band\ncomplete,0.004,0.001\n\
            complete,-0.009,0.01\ncomplete,-0.011,0.01\nfailed,,\n";
        std::fs::write(&path, text).unwrap();
        let rows = Rows::read(&path).unwrap();
        assert_eq!((rows.by_status["complete"], rows.by_status["failed"]), (3, 1));
        assert_eq!((rows.on_own_bodies, rows.outside), (3, 1));
        assert_eq!(rows.largest["stiffness"], 0.011);
    }
}
