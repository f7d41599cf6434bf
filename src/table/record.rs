//! `table.json`: the places with all that is known of them, and the studies that they are of.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};

use railspring_profiles::error::Result;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::cases::Table;
use super::document::{SideKey, TableDocument};
use super::made::{Made, MadePlace, Status};
use super::making::PlaceRecord;
use super::metadata::Metadata;
use crate::engine::seal::Sealed;
use crate::study::{ResolvedKey, ResolvedKeys};

/// The table with its provenance; borrowed where it is written, owned where it is read. `R` is what has the records of its places.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TableRecord<'a, R = PlaceRecord> {
    /// The keys of its file.
    pub table: Cow<'a, TableDocument>,
    /// Keys that all of its studies have with the same values.
    #[serde(default)]
    pub keys: Vec<ResolvedKey>,
    /// The cases.
    pub cases: Vec<CaseRecord<'a, R>>,
    /// Version of the program that made this.
    pub version: Cow<'a, str>,
    /// Hashes (BLAKE3) of the files that were written with it, by their names.
    #[serde(default)]
    pub written: BTreeMap<String, String>,
    /// Hash of all that stands above.
    #[serde(default)]
    pub content_blake3: String,
}

impl<R: Serialize + Clone> Sealed for TableRecord<'_, R> {
    fn seal(&mut self) -> &mut String {
        &mut self.content_blake3
    }
}

/// A pair with its places.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CaseRecord<'a, R = PlaceRecord> {
    /// Name of the wheel.
    pub wheel: Cow<'a, str>,
    /// Name of the rail.
    pub rail: Cow<'a, str>,
    /// Keys that take several values in the table, and those of this case.
    pub varied: Cow<'a, BTreeMap<String, Value>>,
    /// Files of measured profiles, with the hashes of their content.
    pub files: Vec<FileRecord>,
    /// What is known of the measurement of the wheel.
    #[serde(default, skip_serializing_if = "no_metadata")]
    pub wheel_metadata: Cow<'a, Metadata>,
    /// What is known of the measurement of the rail.
    #[serde(default, skip_serializing_if = "no_metadata")]
    pub rail_metadata: Cow<'a, Metadata>,
    /// The other keys of its study.
    pub keys: Vec<ResolvedKey>,
    /// Hashes of the wheel's inputs, the rail's, and all others.
    pub inputs: Cow<'a, [String; 3]>,
    /// Its places.
    pub places: Vec<PlaceEntry<R>>,
}

fn no_metadata(metadata: &Metadata) -> bool {
    metadata.is_empty()
}

/// A file of a measured profile.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FileRecord {
    /// As the table names it.
    pub file: String,
    /// Hash of its content (BLAKE3).
    pub hash: String,
}

/// A place.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PlaceEntry<R = PlaceRecord> {
    /// The side of the wheelset.
    pub side: SideKey,
    /// Shift of the wheelset, mm.
    pub shift_mm: f64,
    /// What it has come to, in a word.
    pub status: Status,
    /// What it has come to.
    #[serde(flatten)]
    pub record: R,
}

/// The record of a table whose places are in the order of its cases; `written` are the hashes of the files beside it. Places in the store are read
/// when it is written.
///
/// # Errors
/// A place that the store has no more.
pub fn record<'a>(
    table: &'a Table,
    made: &'a Made<'a>,
    written: BTreeMap<String, String>,
) -> Result<TableRecord<'a, MadePlace<'a>>> {
    let entry = |record: MadePlace<'a>| {
        let (side, shift_mm) = (record.place.side, record.place.shift_mm);
        PlaceEntry { side, shift_mm, status: record.status(), record }
    };
    let mut places = made.places().peekable();
    let common = ResolvedKeys::common(table.cases.iter().map(|case| &case.study.resolved));
    let is_common: HashSet<&ResolvedKey> = common.iter().copied().collect();
    let mut cases = Vec::new();
    for (number, case) in table.cases.iter().enumerate() {
        let own = std::iter::from_fn(|| places.next_if(|at| at.place.case == number));
        let measured = [&case.study.wheel.measured, &case.study.rail.measured];
        let file = |measured: &crate::study::MeasuredSurface| FileRecord {
            file: measured.file.clone(),
            hash: measured.content.hash().to_owned(),
        };
        cases.push(CaseRecord {
            wheel: (&*case.wheel).into(),
            rail: (&*case.rail).into(),
            varied: Cow::Borrowed(&case.varied),
            files: measured.into_iter().flatten().map(file).collect(),
            wheel_metadata: Cow::Borrowed(&case.metadata[0]),
            rail_metadata: Cow::Borrowed(&case.metadata[1]),
            keys: case.study.resolved.iter().filter(|key| !is_common.contains(key)).cloned().collect(),
            inputs: Cow::Borrowed(&case.parts),
            places: own.map(entry).collect(),
        });
    }
    let record = TableRecord {
        table: Cow::Borrowed(&table.document),
        keys: common.into_iter().cloned().collect(),
        cases,
        version: env!("CARGO_PKG_VERSION").into(),
        written,
        content_blake3: String::new(),
    };
    record.try_sealed()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::store::{Artefact, Store};
    use crate::results::bodies::estimate::Resources;
    use crate::results::samples;
    use crate::table::making::Settings;
    use crate::table::places::Places;
    use crate::table::rows::Rows;
    use railspring_profiles::error::Error;
    use railspring_profiles::monitor::Silent;

    /// Source: places with made-up laws in a store. Goal: rows and `table.json` are the same whether their records stay in the memory or are read from the store, and a place that
    /// the store has lost meanwhile is refused with its entry.
    #[test]
    fn records_in_the_store_are_those_in_the_memory() {
        let root = tempfile::tempdir().unwrap();
        let text = "name = \"t\"\nshifts_mm = [-2, 0, 2]\nstiffness_at_kn = [20]\n[[wheel]]\nprofile = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n";
        let table = Table::parse(&root.path().join("t.toml"), text).unwrap();
        let store = Store::open(&root.path().join("store")).unwrap();
        let address = |shift| Settings::of(&table.document).address(&table.cases[0].study, shift);
        for (shift, at) in [-2.0, 0.0, 2.0].into_iter().zip(samples::by_angle().shifts) {
            let failed = PlaceRecord::failed(shift, &Error::Interrupted);
            let content = serde_json::to_vec(&PlaceRecord { at, ..failed }).unwrap();
            let artefact = Artefact::default().with("place.json", content);
            store.keep(&address(shift), "place", "t", &artefact, &|said| panic!("{said}"));
        }
        let resources = Resources::of_the_machine(&Silent);
        let made = |most| Places::holding(most, &table, &store, false, resources).make().unwrap();
        let written = |most| {
            let made = made(most);
            let record = record(&table, &made, BTreeMap::new()).unwrap();
            (Rows::of(&table, &made).unwrap(), serde_json::to_string(&record).unwrap())
        };
        let (rows, text) = written(3);
        assert_eq!((rows.rows.len(), text.contains("\"laws\":[{")), (3, true));
        assert_eq!(written(2), (rows, text));

        let (here, kept) = (made(3), made(2));
        let lost = root.path().join("store").join(address(0.0).file());
        std::fs::remove_file(&lost).unwrap();
        assert!(Rows::of(&table, &here).is_ok());
        let refused = Rows::of(&table, &kept).unwrap_err().to_string();
        assert!(
            refused.contains(&*lost.to_string_lossy()) && refused.contains("run the command again"),
            "{refused}"
        );
        let refused = record(&table, &kept, BTreeMap::new()).err().unwrap().to_string();
        assert!(refused.contains(&*lost.to_string_lossy()), "{refused}");
    }
}
