//! `table.json`: the places with all that is known of them, and the studies that they are of.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::cases::Table;
use super::document::{SideKey, TableDocument};
use super::making::PlaceRecord;
use super::metadata::Metadata;
use super::places::Place;
use super::rows::Status;
use crate::engine::seal::Sealed;
use crate::study::{ResolvedKey, ResolvedKeys};

/// The table with its provenance; borrowed where it is written, owned where it is read.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TableRecord<'a> {
    /// The keys of its file.
    pub table: Cow<'a, TableDocument>,
    /// Keys that all of its studies have with the same values.
    #[serde(default)]
    pub keys: Vec<ResolvedKey>,
    /// The cases.
    pub cases: Vec<CaseRecord<'a>>,
    /// Version of the program that made this.
    pub version: Cow<'a, str>,
    /// Hashes (BLAKE3) of the files that were written with it, by their names.
    #[serde(default)]
    pub written: BTreeMap<String, String>,
    /// Hash of all that stands above.
    #[serde(default)]
    pub content_blake3: String,
}

impl Sealed for TableRecord<'_> {
    fn seal(&mut self) -> &mut String {
        &mut self.content_blake3
    }
}

/// A pair with its places.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CaseRecord<'a> {
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
    pub places: Vec<PlaceEntry<'a>>,
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
pub struct PlaceEntry<'a> {
    /// The side of the wheelset.
    pub side: SideKey,
    /// Shift of the wheelset, mm.
    pub shift_mm: f64,
    /// What it has come to, in a word.
    pub status: Status,
    /// What it has come to.
    #[serde(flatten)]
    pub record: Cow<'a, PlaceRecord>,
}

/// The record of a table whose places are in the order of its cases; `written` are the hashes of the files beside it.
pub fn record<'a>(
    table: &'a Table,
    places: &'a [(Place, PlaceRecord)],
    written: BTreeMap<String, String>,
) -> TableRecord<'a> {
    let entry = |(place, record): &'a (Place, PlaceRecord)| PlaceEntry {
        side: place.side,
        shift_mm: place.shift_mm,
        status: Status::of(record),
        record: Cow::Borrowed(record),
    };
    let common = ResolvedKeys::common(table.cases.iter().map(|case| &case.study.resolved));
    let is_common: HashSet<&ResolvedKey> = common.iter().copied().collect();
    let mut rest = places;
    let mut cases = Vec::new();
    for (number, case) in table.cases.iter().enumerate() {
        let (own, after) = rest.split_at(rest.iter().take_while(|(place, _)| place.case == number).count());
        rest = after;
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
            places: own.iter().map(entry).collect(),
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
    record.sealed()
}
