//! `table.json`: the places with all that is known of them, and the studies that they are of.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::cases::Table;
use super::document::{SideKey, TableDocument};
use super::making::PlaceRecord;
use super::places::Place;
use super::rows::Status;
use crate::study::ResolvedKey;

/// The table with its provenance; borrowed where it is written, owned where it is read.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TableRecord<'a> {
    /// The keys of its file.
    pub table: Cow<'a, TableDocument>,
    /// The cases.
    pub cases: Vec<CaseRecord<'a>>,
    /// Version of the program that made this.
    pub version: Cow<'a, str>,
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
    /// All keys of its study.
    pub keys: Cow<'a, [ResolvedKey]>,
    /// Hashes of the wheel's inputs, the rail's, and all others.
    pub inputs: Cow<'a, [String; 3]>,
    /// Its places.
    pub places: Vec<PlaceEntry<'a>>,
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

/// The record of a table whose places are in the order of its cases.
pub fn record<'a>(table: &'a Table, places: &'a [(Place, PlaceRecord)]) -> TableRecord<'a> {
    let entry = |(place, record): &'a (Place, PlaceRecord)| PlaceEntry {
        side: place.side,
        shift_mm: place.shift_mm,
        status: Status::of(record),
        record: Cow::Borrowed(record),
    };
    let mut rest = places;
    let mut cases = Vec::new();
    for (number, case) in table.cases.iter().enumerate() {
        let (own, after) = rest.split_at(rest.iter().take_while(|(place, _)| place.case == number).count());
        rest = after;
        let measured = [&case.study.wheel.measured, &case.study.rail.measured];
        let file = |measured: &crate::study::MeasuredSurface| FileRecord {
            file: measured.file.clone(),
            hash: blake3::hash(&measured.content).to_hex().to_string(),
        };
        cases.push(CaseRecord {
            wheel: (&*case.wheel).into(),
            rail: (&*case.rail).into(),
            varied: Cow::Borrowed(&case.varied),
            files: measured.into_iter().flatten().map(file).collect(),
            keys: (&*case.study.resolved).into(),
            inputs: Cow::Borrowed(&case.parts),
            places: own.iter().map(entry).collect(),
        });
    }
    TableRecord { table: Cow::Borrowed(&table.document), cases, version: env!("CARGO_PKG_VERSION").into() }
}
