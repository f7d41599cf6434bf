//! The places of a table: each a pair at one shift, taken from the store or made and kept there by itself, so that whatever ends a table
//! takes nothing from it but the place that is under way.
//!
//! Neither body of a pair depends on the shift, and neither wheel nor rail on the other one: of W wheels and R rails W + R bodies are
//! condensed, which the store keeps, and the rest is dense algebra.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering};

use railspring_profiles::error::{Error, Result, unless_interrupted};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::carried::is_checked;
use super::cases::{Case, Table};
use super::document::BodiesKey;
use super::made::{Held, IN_MEMORY, Made, Place, share_measured};
use super::making::{CaseWork, PlaceRecord, Ready, Settings};
use super::shared::{Common, nominals, shares, wanted_on_standards};
use super::turns::{Pairs, in_turn};
use crate::engine::store::Store;
use crate::results::bodies::estimate::{self, Beside, GIB, Resources, Room, Work};
use crate::results::bodies::geometry;
use crate::results::bodies::input::SolidsInput;
use crate::study::parts as parts_of;

/// Cases of which the places are looked at to foretell the time of a table, at most.
const CASES_LOOKED_AT: usize = 30;

/// Time of a place on the wider grid of shared bodies, over that on the usual grid.
const ON_WIDER_GRID: f64 = 0.56;

/// Bytes of a case in the memory: its study, and where its places are in the store. Measured with 10,000 cases of five places.
const CASE: f64 = 11e3;

/// What a table is going to do.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Pairs with what else is varied.
    pub cases: usize,
    /// Their places.
    pub places: usize,
    /// Those that the store has.
    pub kept: usize,
    /// Those of files that cannot be read.
    pub refused: usize,
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
        let Self { cases, places, kept, refused, cases_made, bodies, needs } = self;
        let mut whole = format!("{cases} pairs at {places} places, {kept} of them in the store");
        if *refused > 0 {
            whole += &format!(", {refused} of files that cannot be read");
        }
        if kept + refused == *places {
            return whole;
        }
        let needs = needs.map_or_else(String::new, |(seconds, bytes)| {
            format!(": about {} and {:.1} GiB on this machine", duration(seconds), bytes / GIB)
        });
        format!(
            "{whole}; {} to be made on {cases_made} pairs of {bodies} bodies{needs}",
            places - kept - refused
        )
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
    nominals: Common<Ready>,
    places: Vec<Place>,
    records: Vec<Option<Held>>,
    /// Whether what the store has is made again.
    fresh: bool,
    /// Whether all records stay in the memory.
    in_memory: bool,
}

/// What is to be made of a case.
type Missing = BTreeMap<usize, Wanted>;
/// Shifts towards the rail (mm), each with the numbers of its places.
type Wanted = Vec<(f64, Vec<usize>)>;

impl<'a> Places<'a> {
    /// All places of a table, cases first; those that are in the store are taken from it unless all are made `fresh`.
    pub fn of(table: &'a Table, store: &'a Store, fresh: bool, resources: Resources<'a>) -> Self {
        Self::holding(IN_MEMORY, table, store, fresh, resources)
    }

    /// The same, with the records of at most so many places in the memory.
    pub(super) fn holding(
        most: usize,
        table: &'a Table,
        store: &'a Store,
        fresh: bool,
        resources: Resources<'a>,
    ) -> Self {
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
        let in_memory = places.len() <= most;
        let take = |place: &Place| {
            let (Case { study, refused, .. }, towards) =
                (&table.cases[place.case], place.side.towards(place.shift_mm));
            if let Some(reason) = refused {
                return Some(Held::here(PlaceRecord::failed(towards, &reason.clone().into())));
            }
            if fresh {
                return None;
            }
            let address = Settings::of(document).address(study, towards);
            let found = PlaceRecord::taken(store, &address, resources.monitor)?;
            Some(if in_memory { Held::here(found) } else { Held::kept(found, address) })
        };
        let of_case = (document.sides.len() * document.shifts_mm.len()).max(1);
        let records = places.par_chunks(of_case).flat_map_iter(|places| {
            let mut held: Vec<Option<Held>> = places.iter().map(take).collect();
            share_measured(&mut held);
            held
        });
        let records = records.collect();
        Self { table, store, resources, nominals: Common::default(), places, records, fresh, in_memory }
    }

    /// What is going to be done; with what it takes where that is to be `estimated`, for which one pair is meshed.
    ///
    /// # Errors
    /// An interruption.
    pub fn plan(&self, estimated: bool) -> Result<Plan> {
        let missing = self.missing();
        // beside a measured profile the contact zones go deeper, so that a body may be needed twice
        let bodies = |part: usize| {
            let of = |case: &usize| {
                let Case { study, parts, .. } = &self.table.cases[*case];
                let whose = self.table.document.bodies();
                match shares(study, whose) {
                    true => nominals(study, whose)
                        .iter()
                        .map(|nominal| (parts_of(&nominal.statics())[part].clone(), true))
                        .collect(),
                    false => {
                        let measured = study.rail.measured.is_some() || study.wheel.measured.is_some();
                        vec![(parts[part].clone(), measured)]
                    }
                }
            };
            missing.keys().flat_map(of).collect::<BTreeSet<_>>().len()
        };
        let [wheels, rails] = [bodies(0), bodies(1)];
        let refused = |place: &&Place| self.table.cases[place.case].refused.is_some();
        let refused = self.places.iter().filter(refused).count();
        let bodies = wheels + rails;
        let needs = if estimated { self.needs(&missing, bodies)? } else { None };
        Ok(Plan {
            cases: self.table.cases.len(),
            places: self.places.len(),
            kept: self.records.iter().flatten().count() - refused,
            refused,
            cases_made: missing.len(),
            bodies,
            needs,
        })
    }

    /// Time and memory of `bodies` and of what is `missing`: bodies as those of the first case, and places by where the wheels of some cases stand, evenly among all.
    fn needs(&self, missing: &Missing, bodies: usize) -> Result<Option<(f64, f64)>> {
        let Some((first, shifts)) = missing.first_key_value() else { return Ok(None) };
        let towards = |shifts: &[(f64, Vec<usize>)]| -> Vec<f64> {
            shifts.iter().map(|(shift, _)| shift * MILLIMETRE).collect()
        };
        let silent = Beneath::silent(self.resources.monitor);
        let resources = Resources { monitor: &silent, ..self.resources };
        let work = Work { calibrate: true, in_table: true, ..Work::default() };
        let mut study = self.table.cases[*first].study.clone();
        study.shifts = Some(towards(shifts));
        study.calibration.fixed_loads =
            self.table.document.stiffness_at_kn.iter().map(|load| load * KILONEWTON).collect();
        let estimate = match estimate::dry_run(&SolidsInput::of(&study), &work, &resources) {
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            // said of the case itself when it is made
            Err(_) => return Ok(None),
            Ok(estimate) => estimate,
        };
        let step = missing.len().div_ceil(CASES_LOOKED_AT);
        let some: Vec<_> = missing.iter().step_by(step).collect();
        let looked_at: Vec<f64> = some
            .par_iter()
            .map(|(case, shifts)| {
                let statics = self.table.cases[**case].study.statics();
                // a case that cannot be pressed takes no time
                geometry::geometry(statics)
                    .map_or(0.0, |geometry| estimate::as_on_tread(statics, &geometry, &towards(shifts)))
            })
            .collect();
        let mean = looked_at.iter().sum::<f64>() / looked_at.len() as f64;
        // the threads share the places of all cases
        let threads = rayon::current_num_threads() as f64;
        let on_own = self.on_own_as_well(missing);
        let a_case = if self.table.document.bodies() == BodiesKey::Own { 1.0 } else { ON_WIDER_GRID };
        let cases = a_case * missing.len() as f64 + on_own.len() as f64;
        let pressed = mean * cases * estimate.place_seconds / threads;
        let condensed = bodies + on_own.iter().sum::<usize>();
        let room = Room::of(estimate.beside, self.resources.budget);
        // the places of a pair are pressed beside the making of the next bodies
        let has_others = on_own.len() < missing.len();
        let is_beside = bodies > 2
            || !on_own.is_empty() && has_others && self.has_room_for(estimate.beside) && threads > 1.0;
        let beside = estimate.stages.get(1).filter(|_| is_beside).map_or(0.0, |stage| stage.memory);
        let together = if room.condensing { estimate.beside.condensing } else { 0.0 };
        let memory = estimate.memory().max(together) + beside + self.of_cases();
        Ok(Some((0.5 * condensed as f64 * estimate.condensing_seconds + pressed, memory)))
    }

    /// Whether there is room for the making of bodies beside the places of other pairs, and for all cases.
    fn has_room_for(&self, beside: Beside) -> bool {
        self.resources.budget.holds(beside.together() + self.of_cases())
    }

    /// Bytes of all cases.
    fn of_cases(&self) -> f64 {
        CASE * self.table.cases.len() as f64
    }

    /// Whether a case is pressed on its own bodies as well.
    fn is_checked(&self, case: usize) -> bool {
        is_checked(&self.table.cases[case].study, self.table.document.bodies())
    }

    /// How many bodies are condensed for each of these cases.
    fn on_own_as_well(&self, missing: &Missing) -> Vec<usize> {
        let whose = self.table.document.bodies();
        let checked = missing.keys().filter(|case| self.is_checked(**case));
        let study = |case: &usize| &self.table.cases[*case].study;
        checked.map(|case| wanted_on_standards(study(case), whose).map(usize::from).iter().sum()).collect()
    }

    /// The cases with places that are to be made, in order, each with its shifts towards the rail (mm).
    pub fn wanted(&self) -> Vec<(usize, Vec<f64>)> {
        let shifts = |places: Vec<(f64, Vec<usize>)>| places.into_iter().map(|(shift, _)| shift).collect();
        self.missing().into_iter().map(|(case, places)| (case, shifts(places))).collect()
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
        // a wheel near its flange takes ten times as long as on its tread: it comes first, so that none of the others waits for it in the end
        missing.values_mut().for_each(|shifts| shifts.sort_by(|a, b| b.0.total_cmp(&a.0)));
        missing
    }

    /// Makes the places that are missing; all of them, in the order of the table.
    ///
    /// # Errors
    /// An interruption, after which the store has what was made.
    pub fn make(mut self) -> Result<Made<'a>> {
        let monitor = self.resources.monitor;
        let (checked, others): (Missing, Missing) =
            self.missing().into_iter().partition(|(case, _)| self.is_checked(*case));
        let [checked, others] = [checked, others].map(Wants::of);
        // those that are checked are pressed twice
        let total = others.places() + 2 * checked.places();
        let done = AtomicUsize::new(0);
        let beneath = Beneath { monitor, count: Some((&done, total)) };
        if total > 0 {
            beneath.progress("", 0, 0)?;
        }
        let making = |wants| Making { places: &self, monitor: &beneath, done: &done, wants };
        let (checking, making_others) = (making(&checked), making(&others));
        // a thread for itself leaves those idle that have nothing else
        let alone = if others.cases.is_empty() { None } else { checking.alone()? };
        let made_others = match alone {
            Some(thread) => {
                let (made, checks) =
                    rayon::join(|| in_turn(&making_others), || thread.install(|| checking.check()));
                checks?;
                made?
            }
            None => {
                checking.check()?;
                in_turn(&making_others)?
            }
        };
        let made = [in_turn(&checking)?, made_others];
        for (Wants { shifts, .. }, made) in [checked, others].into_iter().zip(made) {
            for ((_, indices), record) in shifts.into_iter().flatten().zip(made.into_iter().flatten()) {
                indices.into_iter().for_each(|index| self.records[index] = Some(record.clone()));
            }
        }
        let records = self.records.into_iter().map(|record| record.expect("every place was taken or made"));
        Ok(Made::new(self.store, self.resources.monitor, self.places.into_iter().zip(records).collect()))
    }
}

/// Cases with places that are to be made.
struct Wants {
    cases: Vec<usize>,
    /// Their places.
    shifts: Vec<Wanted>,
    /// How many these are.
    counts: Vec<usize>,
}

impl Wants {
    fn of(missing: Missing) -> Self {
        let (cases, shifts): (Vec<usize>, Vec<Wanted>) = missing.into_iter().unzip();
        let counts = shifts.iter().map(Vec::len).collect();
        Self { cases, shifts, counts }
    }

    fn places(&self) -> usize {
        self.counts.iter().sum()
    }
}

/// The making of the places of cases.
struct Making<'a, 'b> {
    places: &'b Places<'a>,
    monitor: &'b Beneath<'b>,
    /// Places that are done.
    done: &'b AtomicUsize,
    /// What is made.
    wants: &'b Wants,
}

impl Making<'_, '_> {
    fn are_done(&self, places: usize) -> Result<()> {
        self.done.fetch_add(places, Ordering::Relaxed);
        self.monitor.progress("", 0, 0)
    }

    /// A thread on which the pairs are pressed on their own bodies beside the places of others: bodies one after the other leave threads idle, but they take much
    /// memory. None where there is no room for them, or one thread.
    ///
    /// # Errors
    /// An interruption.
    fn alone(&self) -> Result<Option<ThreadPool>> {
        if self.wants.cases.is_empty() || rayon::current_num_threads() < 2 {
            return Ok(None);
        }
        let memory = unless_interrupted(self.case(0).with_bodies(|case| case.memory()))?;
        if !memory.is_ok_and(|of_bodies| of_bodies.iter().all(|beside| self.places.has_room_for(*beside))) {
            return Ok(None);
        }
        // the bodies that all have in common, before another one is made; what is wrong with the case is reported with its places
        unless_interrupted(self.case(0).ready())?.ok();
        Ok(ThreadPoolBuilder::new().num_threads(1).build().ok())
    }

    /// Has the pairs pressed on their own bodies as well, one after the other.
    fn check(&self) -> Result<()> {
        for (pair, shifts) in self.wants.shifts.iter().enumerate() {
            let shifts: Vec<f64> = shifts.iter().map(|(shift, _)| *shift).collect();
            self.case(pair).check(&shifts, self.places.fresh)?;
            self.are_done(shifts.len())?;
        }
        Ok(())
    }

    fn case(&self, pair: usize) -> CaseWork<'_> {
        let Places { table, store, resources, nominals, .. } = self.places;
        let case = &table.cases[self.wants.cases[pair]];
        CaseWork {
            study: &case.study,
            settings: Settings::of(&table.document),
            store,
            nominals,
            beside: None,
            lets_go: [false; 2],
            resources: Resources { monitor: self.monitor, ..*resources },
            said: resources.monitor,
        }
    }
}

impl Pairs for Making<'_, '_> {
    /// A case up to its condensed bodies, or why it has none.
    type Ready = std::result::Result<Ready, Error>;
    type Place = Held;

    fn places(&self) -> &[usize] {
        &self.wants.counts
    }

    fn ready(&self, pair: usize) -> Result<Self::Ready> {
        unless_interrupted(self.case(pair).ready())
    }

    fn at_once(&self, ready: &Self::Ready) -> usize {
        // a pair that is no use takes no memory
        let room = 1 + ready.as_ref().map_or(1, |ready| ready.room().more_pairs);
        // each thread that is more than two has a place of another pair
        room.min(rayon::current_num_threads().max(2))
    }

    fn place(&self, pair: usize, ready: &Self::Ready, place: usize) -> Result<Held> {
        let (shift, _) = self.wants.shifts[pair][place];
        let held = match ready {
            Ok(ready) => {
                let (case, Places { in_memory, store, .. }) = (self.case(pair), self.places);
                let record = case.place(ready, shift)?;
                let address = (!in_memory).then(|| case.settings.address(case.study, shift));
                match address.filter(|address| store.has(address)) {
                    Some(address) => Held::kept(record, address),
                    None => Held::here(record),
                }
            }
            // not kept: memory, a disk or a Python may be another's the next time
            Err(error) => Held::here(PlaceRecord::failed(shift, error)),
        };
        self.are_done(1).map(|()| held)
    }
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
