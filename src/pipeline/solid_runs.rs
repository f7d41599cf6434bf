//! The load cases on the solids in time: as stages, and one after the other beside other stages.

use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use railspring_calibrate::pair::{CondensedPair, PairBody};
use railspring_profiles::error::{Error, Result};
use railspring_profiles::monitor::Monitor;
use railspring_simulate::solid::TransientRun;

use super::bodies::BodySource;
use super::calibration::FoundOn;
use super::runs::{Run, SOLID, artefact, files, run};
use super::stage::{Made, REACH, Stage};
use super::{Moving, OF_THE_RUNS, Pipeline, history_file};
use crate::estimate::{Budget, Work};
use crate::measure::Stopwatch;
use crate::output::to_json;
use crate::records::{Reach, RunRecord};
use crate::results::NewFile;
use crate::stages::{self, Geometry, Meshes, MovingBodies, Reached, Tried, Within};
use crate::store::{Address, Artefact, Kind, Store};
use crate::study::{Study, StudyScenario};

/// A load case on the solid model.
pub(super) struct SimulateSolid<'a> {
    pub name: &'a str,
    pub scenario: &'a StudyScenario,
}

impl Stage for SimulateSolid<'_> {
    type Value = Run;

    fn name(&self) -> String {
        format!("solid model, {}", self.name)
    }

    fn address(&self, at: &mut Pipeline<'_>) -> Result<Address> {
        let reach = at.reach()?;
        Ok(self.with_reach(at.study, reach))
    }

    fn begun(&self, at: &Pipeline<'_>) -> Option<Result<Made>> {
        at.begun.take(self.name)
    }

    fn make(&self, at: &mut Pipeline<'_>) -> Result<Made> {
        let mut runs = at.solid_runs(Pipeline::solid_work)?;
        let made = runs.run(self.name, self.scenario, at.resources.monitor)?;
        at.moving = runs.moving;
        at.go_on_with(runs.meshes);
        Ok(made)
    }

    fn value(&self, artefact: &Artefact, _: &str, at: &mut Pipeline<'_>) -> Result<Run> {
        let run = run(artefact)?;
        at.go_on_with_reach(artefact)?;
        Ok(run)
    }

    fn files(&self, artefact: &Artefact, value: &Run, key: &str, at: &Pipeline<'_>) -> Vec<NewFile> {
        files(SOLID.map(|stem| history_file(at.study, self.name, stem)), artefact, value, key)
    }

    fn outdates(&self) -> &'static [&'static str] {
        &OF_THE_RUNS
    }

    fn ends_with_reach(&self) -> bool {
        true
    }
}

/// Runs on the solids, one load case after the other: each goes on with the meshes and the bodies of the one before.
pub(super) struct SolidRuns<'a> {
    study: &'a Study,
    geometry: Arc<Geometry>,
    source: BodySource<'a>,
    budget: Budget,
    meshes: Meshes,
    moving: Option<Moving>,
}

impl<'a> SolidRuns<'a> {
    /// A load case.
    ///
    /// # Errors
    /// Those of the bodies and of the run, with the name of the load case.
    fn run(&mut self, name: &str, scenario: &StudyScenario, monitor: &dyn Monitor) -> Result<Made> {
        let Self { study, geometry, budget, source, meshes, moving: bodies } = self;
        let source = source.said_to(monitor);
        let accept = |larger: &Meshes| {
            budget.check(study, geometry, larger, &Work::of(study, false, true)).map(|_| ())
        };
        let moving = RefCell::new(bodies.take());
        let run = |meshes: &Meshes| {
            let solids = stages::solids(study, geometry, meshes);
            let bodies = |modes| {
                let wanted = [PairBody::RailOnEnds, PairBody::Wheel].map(|body| solids.key(body));
                let known = moving.take().filter(|(with, bodies): &Moving| {
                    *with == modes && bodies.both().iter().zip(&wanted).all(|(body, key)| body.key == *key)
                });
                let bodies = match known {
                    Some((_, bodies)) => bodies,
                    None => Arc::new(source.moving(&solids, "", modes)?),
                };
                moving.replace(Some((modes, bodies.clone())));
                Ok(bodies)
            };
            let coarser = |modes| {
                stages::coarser_contact(study, geometry, meshes, |coarser| {
                    source.moving(
                        &stages::solids(study, geometry, coarser),
                        " of coarser contact elements",
                        modes,
                    )
                })
            };
            stages::simulate_solid(study, geometry, meshes, &bodies, &coarser, scenario, monitor)
        };
        let reached = |(run, _): &(TransientRun, Tried)| Reached::in_time(run.history.ending);
        let Within { result: (run, tried), refused } =
            stages::within_zones(study, geometry, meshes, monitor, accept, run, reached)
                .map_err(|error| study.in_scenario(name, error))?;
        *bodies = moving.into_inner();
        let record = RunRecord {
            wheel_mass_kg: Some(run.wheel_mass),
            ..RunRecord::of_solid(&run.history, run.reduction.as_ref(), tried.worth)
        };
        let artefact =
            artefact(&run.history, &record, tried.disturbed.as_ref()).with(REACH, to_json(&self.reach()));
        Ok(Made { complete: !refused, ..Made::whole(artefact) })
    }

    fn reach(&self) -> Reach {
        Reach::of(self.meshes.options(), self.meshes.refinements(self.study))
    }

    /// Where its bodies are kept, and its results.
    pub fn store(&self) -> Option<&'a Store> {
        self.source.store
    }

    /// All load cases of the study up to one that the store has, which the stage takes from there.
    pub fn all(mut self, store: Option<&Store>, begun: &Begun<'a>) {
        let study = self.study;
        for (name, scenario) in study.scenarios.iter().filter(|(_, case)| case.solid) {
            let stage = SimulateSolid { name, scenario };
            let watch = Stopwatch::start();
            let address = store.map(|store| (store, stage.with_reach(study, self.reach())));
            if address.as_ref().is_some_and(|(store, address)| begun.takes && store.has(address)) {
                return;
            }
            let made = self.run(name, scenario, begun);
            let failed = made.is_err();
            let made = made.map(|made| {
                if let Some((store, address)) = address.filter(|_| made.complete) {
                    let say = |text| begun.monitor.notice(&format!("{}: {text}", stage.name()));
                    store.keep(&address, &stage.name(), &study.name, &made.artefact, &say);
                }
                Made { elsewhere: Some(watch.held()), ..made }
            });
            begun.add(name, made);
            if failed {
                return;
            }
        }
    }
}

/// What was made of the runs on the solids beside other stages, by load case, until their stages ask for it.
pub(super) struct Begun<'a> {
    made: Mutex<Vec<(String, Result<Made>)>>,
    /// Whether the other stages have failed, so that nobody will ask.
    stopped: AtomicBool,
    /// Whether the store is asked first.
    takes: bool,
    monitor: &'a dyn Monitor,
}

impl<'a> Begun<'a> {
    /// Nothing yet.
    pub fn new(takes: bool, monitor: &'a dyn Monitor) -> Self {
        Self { made: Mutex::default(), stopped: AtomicBool::new(false), takes, monitor }
    }

    fn add(&self, name: &str, made: Result<Made>) {
        self.made.lock().unwrap_or_else(PoisonError::into_inner).push((name.into(), made));
    }

    fn take(&self, name: &str) -> Option<Result<Made>> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let place = made.iter().position(|(other, _)| other == name)?;
        Some(made.swap_remove(place).1)
    }

    /// Ends what is not done.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}

impl Monitor for Begun<'_> {
    fn progress(&self, stage: &str, done: usize, total: usize) -> Result<()> {
        if self.stopped.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        self.monitor.progress(stage, done, total)
    }

    fn notice(&self, text: &str) {
        self.monitor.notice(text);
    }
}

impl SimulateSolid<'_> {
    /// Its address where it begins with zones that reach so far.
    fn with_reach(&self, study: &Study, reach: Reach) -> Address {
        Address::of(Kind::SolidRun, &(study.keys.solid(self.name), reach))
    }
}

impl<'a> Pipeline<'a> {
    /// The runs on the solids from here on, on meshes made for `work`, with the bodies of the calibration if they are there.
    pub(super) fn solid_runs(
        &mut self,
        work: impl FnOnce(&mut Self) -> Result<Work>,
    ) -> Result<SolidRuns<'a>> {
        let meshes = self.meshes(work)?;
        let of_calibration = self.condensed.take().map(|pair| self.moving_of(pair));
        let moving = of_calibration.or(self.moving.take());
        self.solid_runs_with(meshes, moving)
    }

    /// The runs on the solids beside what is left of a calibration that has its springs.
    pub(super) fn solid_runs_on(&mut self, springs: &FoundOn) -> Result<SolidRuns<'a>> {
        let (meshes, bodies) = springs.bodies();
        let moving = self.moving_of(bodies.clone());
        self.solid_runs_with(meshes.clone(), Some(moving))
    }

    fn moving_of(&self, pair: Arc<CondensedPair>) -> Moving {
        (self.study.modes(), Arc::new(MovingBodies::OfCalibration(pair)))
    }

    fn solid_runs_with(&mut self, meshes: Meshes, moving: Option<Moving>) -> Result<SolidRuns<'a>> {
        let (study, geometry, source) = (self.study, self.geometry()?, self.body_source());
        Ok(SolidRuns { study, geometry, source, budget: self.resources.budget, meshes, moving })
    }

    /// The runs on the solids that the store does not have, as far as that can be said now.
    pub(super) fn solid_work(&mut self) -> Result<Work> {
        let mut work = Work::of(self.study, false, true);
        if let (Some(store), false) = (self.store, self.fresh) {
            let study = self.study;
            for (name, scenario) in study.scenarios.iter().filter(|(_, case)| case.solid) {
                let address = SimulateSolid { name, scenario }.address(self)?;
                if store.has(&address) {
                    work.solids.retain(|(other, _)| other != name);
                }
            }
        }
        Ok(work)
    }

    /// The same with the calibration.
    pub(super) fn calibration_work(&mut self) -> Result<Work> {
        Ok(Work { calibrate: true, ..self.solid_work()? })
    }
}
