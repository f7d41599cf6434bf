//! The places of a table: each a pair at one shift, taken from the store or made and kept there by itself, so that whatever ends a table
//! takes nothing from it but the place that is under way.
//!
//! Neither body of a pair depends on the shift, and neither wheel nor rail on the other one: of W wheels and R rails W + R bodies are
//! condensed, which the store keeps, and the rest is dense algebra.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering};

use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::error::{Error, Result};
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cases::{Case, Table};
use super::document::{SideKey, TableDocument};
use crate::estimate::{self, GIB, Resources, Room, Work};
use crate::output::to_json;
use crate::pipeline::BodySource;
use crate::records::ShiftRecord;
use crate::stages::{self, Geometry, PlaceSettings};
use crate::store::{Address, Artefact, Kind, Store};
use crate::study::Study;

/// Part of an artefact: the place.
const PLACE: &str = "place.json";

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

/// What a place has come to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaceRecord {
    /// The law; the shift is that towards the rail of the side.
    pub at: ShiftRecord,
    /// Radius on which the wheel rolls at the first touch, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling_radius_mm: Option<f64>,
    /// Tangent stiffness of Hertz's contact at the first touch, under normal forces as large as the loads of the columns, kN/m; empty where
    /// the bodies conform.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hertz_kn_per_m: Vec<f64>,
}

impl PlaceRecord {
    /// One without a law.
    fn failed(shift_mm: f64, reason: &Error) -> Self {
        Self {
            at: ShiftRecord {
                shift_mm,
                touch: None,
                laws: Vec::new(),
                loads: Vec::new(),
                published_secant_ratio: None,
                error_band: None,
                reason: Some(reason.to_string()),
            },
            rolling_radius_mm: None,
            hertz_kn_per_m: Vec::new(),
        }
    }
}

/// What a table is going to do.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Pairs with what else is varied.
    pub cases: usize,
    /// Their places.
    pub places: usize,
    /// Those that the store has.
    pub kept: usize,
    /// Cases with a place that is to be made.
    pub cases_made: usize,
    /// Bodies of these cases, which are condensed unless the store has them.
    pub bodies: usize,
    /// What the making is expected to take: time (s) and memory (bytes); none where nothing is made, or that is not known.
    pub needs: Option<(f64, f64)>,
}

impl Plan {
    /// The plan in a sentence.
    pub fn text(&self) -> String {
        let Self { cases, places, kept, cases_made, bodies, needs } = self;
        let whole = format!("{cases} pairs at {places} places, {kept} of them in the store");
        if kept == places {
            return whole;
        }
        let needs = needs.map_or_else(String::new, |(seconds, bytes)| {
            format!(": about {} and {:.1} GiB on this machine", duration(seconds), bytes / GIB)
        });
        format!("{whole}; {} to be made on {cases_made} pairs of {bodies} bodies{needs}", places - kept)
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        short if short < 90.0 => format!("{short:.0} s"),
        long if long < 5400.0 => format!("{:.0} min", long / 60.0),
        longer => format!("{:.1} h", longer / 3600.0),
    }
}

/// The places of a table, with what the store has of them.
pub struct Places<'a> {
    table: &'a Table,
    store: &'a Store,
    resources: Resources<'a>,
    places: Vec<Place>,
    records: Vec<Option<PlaceRecord>>,
}

/// What is to be made of a case: shifts towards the rail (mm), each with the numbers of its places.
type Missing = BTreeMap<usize, Vec<(f64, Vec<usize>)>>;

impl<'a> Places<'a> {
    /// All places of a table, cases first; those that are in the store are taken from it unless all are made `fresh`.
    pub fn of(table: &'a Table, store: &'a Store, fresh: bool, resources: Resources<'a>) -> Self {
        let document = &table.document;
        let mut places = Vec::new();
        for case in 0..table.cases.len() {
            for side in &document.sides {
                places.extend(document.shifts_mm.iter().map(|shift_mm| Place {
                    case,
                    side: *side,
                    shift_mm: *shift_mm,
                }));
            }
        }
        let take = |place: &Place| {
            let address = address(store, table, place);
            let read = |artefact: Artefact| read(&artefact);
            store.take_as(&address, read, &|text| resources.monitor.notice(&text))
        };
        let records = places.par_iter().map(|place| (!fresh).then(|| take(place)).flatten()).collect();
        Self { table, store, resources, places, records }
    }

    /// What is going to be done.
    ///
    /// # Errors
    /// An interruption.
    pub fn plan(&self) -> Result<Plan> {
        let missing = self.missing();
        // beside a measured profile the contact zones go deeper, so that a body may be needed twice
        let bodies = |part: usize| {
            let of = |case: &usize| {
                let Case { study, .. } = &self.table.cases[*case];
                let measured = study.rail.measured.is_some() || study.wheel.measured.is_some();
                (&study.keys.parts[part], measured)
            };
            missing.keys().map(of).collect::<BTreeSet<_>>().len()
        };
        let [wheels, rails] = [bodies(0), bodies(1)];
        let needs = match missing.first_key_value() {
            None => None,
            Some((first, shifts)) => self.needs(*first, shifts.len(), wheels + rails, missing.len())?,
        };
        Ok(Plan {
            cases: self.table.cases.len(),
            places: self.places.len(),
            kept: self.records.iter().flatten().count(),
            cases_made: missing.len(),
            bodies: wheels + rails,
            needs,
        })
    }

    /// Time and memory of `bodies` and `cases` by the estimate of one of them at so many `places`, which the others resemble.
    fn needs(&self, case: usize, places: usize, bodies: usize, cases: usize) -> Result<Option<(f64, f64)>> {
        let mut study = self.table.cases[case].study.clone();
        study.calibration.shifts = Some((0..places).map(|n| n as f64 * MILLIMETRE).collect());
        let silent = Beneath::silent(self.resources.monitor);
        let resources = Resources { monitor: &silent, ..self.resources };
        let work = Work { calibrate: true, ..Work::default() };
        match estimate::dry_run(&study, &work, &resources) {
            Err(Error::Interrupted) => Err(Error::Interrupted),
            // said of the case itself when it is made
            Err(_) => Ok(None),
            Ok(estimate) => {
                let seconds = |stage: usize| estimate.stages.get(stage).map_or(0.0, |stage| stage.seconds);
                let pairs = 0.5 * bodies as f64;
                Ok(Some((pairs * seconds(0) + cases as f64 * seconds(1), estimate.memory())))
            }
        }
    }

    /// What is to be made, each once: a left wheel shifted one way stands as a right one shifted the other way.
    fn missing(&self) -> Missing {
        let mut missing = Missing::new();
        for (index, place) in
            self.places.iter().enumerate().filter(|(index, _)| self.records[*index].is_none())
        {
            let towards = place.side.towards(place.shift_mm);
            let shifts = missing.entry(place.case).or_default();
            match shifts.iter_mut().find(|(shift, _)| *shift == towards) {
                Some((_, places)) => places.push(index),
                None => shifts.push((towards, vec![index])),
            }
        }
        // a wheel near its flange takes ten times as long as on its tread: it comes first, so that no thread waits for it in the end
        missing.values_mut().for_each(|shifts| shifts.sort_by(|a, b| b.0.total_cmp(&a.0)));
        missing
    }

    /// Makes the places that are missing; all of them, in the order of the table.
    ///
    /// # Errors
    /// An interruption, after which the store has what was made.
    pub fn make(mut self) -> Result<Vec<(Place, PlaceRecord)>> {
        let missing = self.missing();
        let monitor = self.resources.monitor;
        let (done, total) = (AtomicUsize::new(0), missing.values().map(Vec::len).sum());
        let beneath = Beneath { monitor, count: Some((&done, total)) };
        if total > 0 {
            beneath.progress("", 0, 0)?;
        }
        let work = CaseWork { places: &self, monitor: &beneath, done: &done };
        let mut made: Vec<(Vec<usize>, PlaceRecord)> = Vec::new();
        let mut cases = missing.into_iter().peekable();
        let mut ready = cases.peek().map(|(case, _)| work.bodies(*case)).transpose()?;
        while let (Some((case, wanted)), Some(bodies)) = (cases.next(), ready.take()) {
            let shifts: Vec<f64> = wanted.iter().map(|(shift, _)| *shift).collect();
            let coming = cases.peek().map(|(case, _)| *case);
            let next = || coming.map(|case| work.bodies(case)).transpose();
            let press = || work.places(case, &shifts, &bodies);
            // the next bodies beside the places of these, where memory has room
            let (records, next) = match &bodies {
                Ok(Ready { room, .. }) if !room.stages => (press(), next()),
                _ => rayon::join(press, next),
            };
            ready = next?;
            made.extend(wanted.into_iter().map(|(_, indices)| indices).zip(records?));
        }
        for (indices, record) in made {
            indices.into_iter().for_each(|index| self.records[index] = Some(record.clone()));
        }
        let records = self.records.into_iter().map(|record| record.expect("every place was taken or made"));
        Ok(self.places.into_iter().zip(records).collect())
    }
}

/// The making of the places of cases.
struct CaseWork<'a, 'b> {
    places: &'b Places<'a>,
    monitor: &'b Beneath<'b>,
    /// Places that are done.
    done: &'b AtomicUsize,
}

impl CaseWork<'_, '_> {
    fn one_done(&self) -> Result<()> {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.monitor.progress("", 0, 0)
    }

    /// The places of a case at `shifts` (mm) on its bodies.
    fn places(
        &self,
        number: usize,
        shifts: &[f64],
        ready: &std::result::Result<Ready, Error>,
    ) -> Result<Vec<PlaceRecord>> {
        let Places { table, store, resources, .. } = self.places;
        let case = &table.cases[number];
        let Ready { geometry, bodies, coarser, .. } = match ready {
            Ok(ready) => ready,
            // not kept: memory, a disk or a Python may be another's the next time
            Err(error) => {
                let failed = |shift: &f64| self.one_done().map(|()| PlaceRecord::failed(*shift, error));
                return shifts.iter().map(failed).collect();
            }
        };
        let document = &table.document;
        let fixed_loads: Vec<f64> = document.stiffness_at_kn.iter().map(|load| load * KILONEWTON).collect();
        let settings = PlaceSettings { direction: document.direction.into(), fixed_loads: &fixed_loads };
        let make = |shift_mm: &f64| {
            let shift = shift_mm * MILLIMETRE;
            let coarser = coarser.as_ref().map(|(element, bodies)| (*element, bodies));
            let at = stages::place(&case.study, geometry, bodies, &settings, shift, coarser, self.monitor)?;
            let record = PlaceRecord {
                rolling_radius_mm: at
                    .touch
                    .map(|touch| geometry.pair.wheel.radius / MILLIMETRE + touch.wheel_z_mm),
                hertz_kn_per_m: hertz(&case.study, geometry, shift, &fixed_loads),
                at,
            };
            let place = Place { case: number, side: SideKey::Right, shift_mm: *shift_mm };
            let artefact = Artefact::default().with(PLACE, to_json(&record));
            let say = |text: String| resources.monitor.notice(&text);
            store.keep(&address(store, table, &place), "place of a table", &document.name, &artefact, &say);
            self.one_done()?;
            Ok(record)
        };
        shifts.par_iter().map(make).collect()
    }

    /// A case up to its condensed bodies, or why it has none.
    ///
    /// # Errors
    /// An interruption.
    fn bodies(&self, case: usize) -> Result<std::result::Result<Ready, Error>> {
        let study = &self.places.table.cases[case].study;
        match self.condensed(study) {
            Err(Error::Interrupted) => Err(Error::Interrupted),
            Err(Error::Input(input)) => Ok(Err(study.with_keys(input).into())),
            ready => Ok(ready),
        }
    }

    fn condensed(&self, study: &Study) -> Result<Ready> {
        let Places { store, resources, .. } = self.places;
        let monitor: &dyn Monitor = self.monitor;
        let geometry = stages::geometry(study)?;
        let resources = Resources { monitor, ..*resources };
        let options = stages::mesh_options(study, &geometry);
        let work = Work::of(study, true, false);
        let (meshes, room) = estimate::meshes(study, &geometry, options, &work, &resources)?;
        let source = BodySource {
            store: Some(store),
            fresh: false,
            foot_held: study.calibration.foot_held,
            together: room.condensing,
            study: &study.name,
            monitor,
        };
        let bodies = source.condensed(&stages::solids(study, &geometry, &meshes), "", 0)?;
        let coarser = study
            .wants_error_band()
            .then(|| {
                let condense = |coarser: &stages::Meshes| {
                    source.condensed(&stages::solids(study, &geometry, coarser), " of coarser elements", 0)
                };
                stages::coarser_bodies(study, &geometry, &meshes, condense)
            })
            .transpose()?;
        let coarser = coarser.map(|coarser| (meshes.contact_element(), coarser));
        Ok(Ready { geometry, bodies, coarser, room })
    }
}

/// A case up to its condensed bodies; those of coarser meshes with the edge of the contact elements of the others, m.
struct Ready {
    geometry: Geometry,
    bodies: railspring_calibrate::pair::CondensedPair,
    coarser: Option<(f64, stages::CoarserBodies)>,
    /// What there is room for at the same time.
    room: Room,
}

/// Where the store has a place.
fn address(store: &Store, table: &Table, place: &Place) -> Address {
    let TableDocument { direction, stiffness_at_kn, .. } = &table.document;
    let springs = &table.cases[place.case].study.keys.springs;
    store.address(Kind::Place, &(springs, direction, stiffness_at_kn, place.side.towards(place.shift_mm)))
}

fn read(artefact: &Artefact) -> Result<PlaceRecord> {
    let content = artefact.part(PLACE).unwrap_or_default();
    let text = std::str::from_utf8(content).unwrap_or_default();
    crate::output::parse_json(std::path::Path::new(PLACE), text, "table")
}

/// Tangent stiffness of Hertz's contact of the profiles at a shift (m), with the radii of curvature at the first touch, under normal forces
/// as large as the loads (N), kN/m.
fn hertz(study: &Study, geometry: &Geometry, shift: f64, loads: &[f64]) -> Vec<f64> {
    let Ok(pair) = geometry.pair.with_wheel_at(stages::tape_y(study, &geometry.pair, shift)) else {
        return Vec::new();
    };
    let [along, across] = pair.relative_radii();
    let modulus = study.material.contact_modulus();
    let tangent = |load: &f64| {
        let contact = point_contact(*load, along, across, modulus)?;
        Ok(contact.tangent_stiffness / KILONEWTON_PER_METRE)
    };
    loads.iter().map(tangent).collect::<Result<_>>().unwrap_or_default()
}

/// Passes on whether to go on, and for all that is done to a place no more than how many there are.
struct Beneath<'a> {
    monitor: &'a dyn Monitor,
    /// Places that are done, and all of them.
    count: Option<(&'a AtomicUsize, usize)>,
}

impl<'a> Beneath<'a> {
    fn silent(monitor: &'a dyn Monitor) -> Self {
        Self { monitor, count: None }
    }
}

impl Monitor for Beneath<'_> {
    fn progress(&self, _: &str, _: usize, _: usize) -> Result<()> {
        match self.count {
            Some((done, total)) => self.monitor.progress("places", done.load(Ordering::Relaxed), total),
            // a count that stays where it is shows nothing
            None => self.monitor.progress("plan", 0, 1),
        }
    }

    fn notice(&self, _: &str) {}
}
