//! The places of a table when all of them are there. The records of thousands of wheels would fill the memory: beyond some number they stay in the store,
//! and are read from it one by one where they are wanted.

use std::borrow::Cow;
use std::sync::Arc;

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;
use serde::ser::Error as _;
use serde::{Deserialize, Serialize, Serializer};

use super::document::SideKey;
use super::making::PlaceRecord;
use super::surfaces::MeasuredRecord;
use crate::engine::store::{Address, Store};

/// Places of a table whose records stay in the memory, 10 kB each; those of a larger table are read from the store.
pub(super) const IN_MEMORY: usize = 5000;

/// A pair at one shift of the wheelset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Number of the case.
    pub case: usize,
    /// The side of the wheelset.
    pub side: SideKey,
    /// Shift of the wheelset, mm.
    pub shift_mm: f64,
}

/// What a place has come to, in a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// A law of all loads.
    Complete,
    /// A law that ends before the largest load.
    EndsEarly,
    /// No law.
    Failed,
}

impl Status {
    /// The status of a place.
    pub fn of(record: &PlaceRecord) -> Self {
        match (record.at.laws.is_empty(), &record.at.reason) {
            (true, _) => Self::Failed,
            (false, Some(_)) => Self::EndsEarly,
            (false, None) => Self::Complete,
        }
    }

    /// Its name in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::EndsEarly => "ends early",
            Self::Failed => "failed",
        }
    }
}

/// The record of a place, or where it is.
#[derive(Debug, Clone)]
pub(super) enum Held {
    /// The record.
    Here(Box<PlaceRecord>),
    /// In the store.
    Kept(Box<Kept>),
}

/// A place whose record is in the store, and what is wanted of all places at once.
#[derive(Debug, Clone)]
pub(super) struct Kept {
    address: Address,
    status: Status,
    has_findings: bool,
    measured: Option<Arc<MeasuredRecord>>,
}

impl Held {
    /// A record that stays in the memory.
    pub fn here(record: PlaceRecord) -> Self {
        Self::Here(Box::new(record))
    }

    /// That of a record that the store has at an address.
    pub fn kept(record: PlaceRecord, address: Address) -> Self {
        let (status, has_findings) = (Status::of(&record), !record.findings_left.is_empty());
        Self::Kept(Box::new(Kept { address, status, has_findings, measured: record.measured }))
    }

    fn measured(&mut self) -> Option<&mut Arc<MeasuredRecord>> {
        match self {
            Self::Here(record) => record.measured.as_mut(),
            Self::Kept(kept) => kept.measured.as_mut(),
        }
    }
}

/// Gives the places of a case one record of its measured surfaces: with many shifts that is a tenth of the memory.
pub(super) fn share_measured(places: &mut [Option<Held>]) {
    let mut last: Option<Arc<MeasuredRecord>> = None;
    for measured in places.iter_mut().flatten().filter_map(Held::measured) {
        match &last {
            Some(known) if known == measured => *measured = Arc::clone(known),
            _ => last = Some(Arc::clone(measured)),
        }
    }
}

/// The places of a table, all of them there.
pub struct Made<'a> {
    store: &'a Store,
    monitor: &'a dyn Monitor,
    places: Vec<(Place, Held)>,
}

/// One of them.
#[derive(Clone, Copy)]
pub struct MadePlace<'a> {
    /// Where it is.
    pub place: &'a Place,
    held: &'a Held,
    of: &'a Made<'a>,
}

impl<'a> Made<'a> {
    /// Places in the order of the table; those in the `store` are read from there.
    pub(super) fn new(store: &'a Store, monitor: &'a dyn Monitor, places: Vec<(Place, Held)>) -> Self {
        Self { store, monitor, places }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// The places in the order of the table.
    pub fn places(&self) -> impl Iterator<Item = MadePlace<'_>> {
        self.places.iter().map(|(place, held)| MadePlace { place, held, of: self })
    }
}

impl<'a> MadePlace<'a> {
    /// What it has come to, in a word.
    pub fn status(&self) -> Status {
        match self.held {
            Held::Here(record) => Status::of(record),
            Held::Kept(kept) => kept.status,
        }
    }

    /// Whether something is left to look at in its profiles.
    pub fn has_findings(&self) -> bool {
        match self.held {
            Held::Here(record) => !record.findings_left.is_empty(),
            Held::Kept(kept) => kept.has_findings,
        }
    }

    /// What its measured surfaces are; none where neither was measured.
    pub fn measured(&self) -> Option<&'a MeasuredRecord> {
        match self.held {
            Held::Here(record) => record.measured.as_deref(),
            Held::Kept(kept) => kept.measured.as_deref(),
        }
    }

    /// All of it.
    ///
    /// # Errors
    /// [`InputError`] for one that the store has no more.
    pub fn record(&self) -> Result<Cow<'a, PlaceRecord>> {
        let kept = match self.held {
            Held::Here(record) => return Ok(Cow::Borrowed(record)),
            Held::Kept(kept) => kept,
        };
        let Made { store, monitor, .. } = self.of;
        PlaceRecord::taken(store, &kept.address, *monitor).map(Cow::Owned).ok_or_else(|| {
            let entry = store.path().join(kept.address.file()).display().to_string();
            let expected = "the place that was there when the table was made";
            let remedy =
                "run the command again: it makes what is missing. Leave the store as it is meanwhile";
            InputError::new(entry, "no such entry of the store any more", expected, remedy).into()
        })
    }
}

impl Serialize for MadePlace<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        self.record().map_err(S::Error::custom)?.serialize(serializer)
    }
}
