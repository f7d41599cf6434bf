//! The load cases on the solids in time: as stages, and one after the other beside other stages.

use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use railspring_calibrate::pair::{CondensedPair, PairBody};
use railspring_profiles::error::{Error, Result};
use railspring_profiles::monitor::Monitor;
use railspring_simulate::solid::TransientRun;
use serde_json::Value;

use crate::engine::list::NewFile;
use crate::engine::measure::Stopwatch;
use crate::engine::output::to_json;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact, Store};
use crate::results::bodies::estimate::{Budget, Work};
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::in_work::{Moving, REACH, Solids};
use crate::results::bodies::input::SolidsInput;
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::other_solids;
use crate::results::bodies::reach::Reach;
use crate::results::bodies::solids::{self, MovingBodies};
use crate::results::bodies::source::BodySource;
use crate::results::bodies::zones::{self, ZoneLimit, ZonedResult};
use crate::results::names::OF_THE_RUNS;
use crate::results::run::make::{self, RunWithErrors};
use crate::results::run::record::RunRecord;
use crate::results::run::stage::{Run, SOLID, artefact, files, history_files, run};
use crate::results::springs::stage::CalibratedPair;
use crate::study::StudyScenario;

/// A load case on the solid model.
pub(crate) struct SimulateSolid<'s, 'a> {
    pub solids: &'s mut Solids<'a>,
    /// Runs that were made beside other stages, if any.
    pub background: Option<&'s BackgroundRuns<'a>>,
    pub name: &'s str,
    pub scenario: &'s StudyScenario,
}

impl Stage for SimulateSolid<'_, '_> {
    type Value = Run;

    fn name(&self) -> String {
        stage_name(self.name)
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        let reach = self.solids.reach()?;
        Ok(self.solids.input.run(self.scenario).address(reach))
    }

    fn background(&self) -> Option<Result<StageOutput>> {
        self.background?.take(self.name)
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput> {
        let at = &mut *self.solids;
        let mut runs = SolidRuns::after(at, engine)?;
        let made = runs.run(self.name, self.scenario, at.resources.monitor)?;
        at.moving = runs.moving;
        at.set_meshes(runs.meshes);
        Ok(made)
    }

    fn value(&mut self, artefact: &Artefact, _: &str) -> Result<Run> {
        let run = run(artefact)?;
        self.solids.go_on_with_reach(artefact)?;
        Ok(run)
    }

    fn files(&self, artefact: &Artefact, value: &Run, key: &str) -> Vec<NewFile> {
        files(history_files(self.solids.input.main_case, self.name, SOLID), artefact, value, key)
    }

    fn outdates(&self) -> &'static [&'static str] {
        &OF_THE_RUNS
    }

    fn note(&self) -> Option<(&'static str, Value)> {
        self.solids.reach_note()
    }
}

fn stage_name(case: &str) -> String {
    format!("solid model, {case}")
}

fn moving_of(modes: usize, pair: Arc<CondensedPair>) -> Moving {
    (modes, Arc::new(MovingBodies::OfCalibration(pair)))
}

/// Runs on the solids, one load case after the other: each goes on with the meshes and the bodies of the one before.
pub(crate) struct SolidRuns<'a> {
    input: SolidsInput<'a>,
    geometry: Arc<Geometry>,
    source: BodySource<'a>,
    budget: Budget,
    meshes: Meshes,
    moving: Option<Moving>,
}

impl<'a> SolidRuns<'a> {
    /// The runs from here on, on meshes made for them, with the bodies of the calibration if they are there.
    fn after(at: &mut Solids<'a>, engine: &mut Engine<'_>) -> Result<Self> {
        let meshes = at.meshes(engine, Solids::solid_work)?;
        let of_calibration = at.condensed.take().map(|pair| moving_of(at.input.modes, pair));
        let moving = of_calibration.or(at.moving.take());
        Self::with(at, meshes, moving)
    }

    /// The runs beside what is left of a calibration that has its springs.
    ///
    /// # Errors
    /// Those of the geometry.
    pub fn beside(at: &mut Solids<'a>, springs: &CalibratedPair) -> Result<Self> {
        let (meshes, bodies) = springs.bodies();
        let moving = moving_of(at.input.modes, bodies.clone());
        Self::with(at, meshes.clone(), Some(moving))
    }

    fn with(at: &mut Solids<'a>, meshes: Meshes, moving: Option<Moving>) -> Result<Self> {
        let (input, geometry, source) = (at.input, at.geometry()?, at.body_source());
        Ok(Self { input, geometry, source, budget: at.resources.budget, meshes, moving })
    }

    /// A load case.
    ///
    /// # Errors
    /// Those of the bodies and of the run, with the name of the load case.
    fn run(&mut self, name: &str, scenario: &StudyScenario, monitor: &dyn Monitor) -> Result<StageOutput> {
        let Self { input, geometry, budget, source, meshes, moving: bodies } = self;
        let statics = input.statics;
        let source = source.said_to(monitor);
        let accept = |larger: &Meshes| {
            budget.check(input, geometry, larger, &Work::of(input, false, true)).map(|_| ())
        };
        let moving = RefCell::new(bodies.take());
        let run = |meshes: &Meshes| {
            let solids = solids::solids(statics, geometry, meshes);
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
                other_solids::coarser_contact(statics, geometry, meshes, |coarser| {
                    source.moving(
                        &solids::solids(statics, geometry, coarser),
                        " of coarser contact elements",
                        modes,
                    )
                })
            };
            make::simulate_solid(&input.run(scenario), geometry, meshes, &bodies, &coarser, monitor)
        };
        let reached = |(run, _): &(TransientRun, RunWithErrors)| ZoneLimit::in_time(run.history.ending);
        let ZonedResult { result: (run, tried), refused } =
            zones::within_zones(statics, geometry, meshes, monitor, accept, run, reached)
                .map_err(|error| input.source.in_scenario(name, error))?;
        *bodies = moving.into_inner();
        let record = RunRecord {
            wheel_mass_kg: Some(run.wheel_mass),
            tables: scenario.tables.clone(),
            ..RunRecord::of_solid(&run.history, run.reduction.as_ref(), tried.uncertainty)
        };
        let artefact =
            artefact(&run.history, &record, tried.disturbed.as_ref()).with(REACH, to_json(&self.reach()));
        Ok(StageOutput { complete: !refused, ..StageOutput::whole(artefact) })
    }

    fn reach(&self) -> Reach {
        Reach::of(self.meshes.options(), self.meshes.refinements(self.input.statics.mesh))
    }

    /// Where its bodies are kept, and its results.
    pub fn store(&self) -> Option<&'a Store> {
        self.source.store
    }

    /// All load cases of the study up to one that the store has, which the stage takes from there.
    pub fn all(mut self, store: Option<&Store>, background: &BackgroundRuns<'a>) {
        let input = self.input;
        for (name, scenario) in input.cases.iter().filter(|(_, case)| case.solid) {
            let stage = stage_name(name);
            let watch = Stopwatch::start();
            let address = store.map(|store| (store, input.run(scenario).address(self.reach())));
            if address.as_ref().is_some_and(|(store, address)| background.takes && store.has(address)) {
                return;
            }
            let made = self.run(name, scenario, background);
            let failed = made.is_err();
            let made = made.map(|made| {
                if let Some((store, address)) = address.filter(|_| made.complete) {
                    let say = |text| background.monitor.notice(&format!("{stage}: {text}"));
                    store.keep(&address, &stage, input.name, &made.artefact, &say);
                }
                StageOutput { elsewhere: Some(watch.held()), ..made }
            });
            background.add(name, made);
            if failed {
                return;
            }
        }
    }
}

/// What was made of the runs on the solids beside other stages, by load case, until their stages ask for it.
pub(crate) struct BackgroundRuns<'a> {
    made: Mutex<Vec<(String, Result<StageOutput>)>>,
    /// Whether the other stages have failed, so that nobody will ask.
    stopped: AtomicBool,
    /// Whether the store is asked first.
    takes: bool,
    monitor: &'a dyn Monitor,
}

impl<'a> BackgroundRuns<'a> {
    /// Nothing yet.
    pub fn new(takes: bool, monitor: &'a dyn Monitor) -> Self {
        Self { made: Mutex::default(), stopped: AtomicBool::new(false), takes, monitor }
    }

    fn add(&self, name: &str, made: Result<StageOutput>) {
        self.made.lock().unwrap_or_else(PoisonError::into_inner).push((name.into(), made));
    }

    fn take(&self, name: &str) -> Option<Result<StageOutput>> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let place = made.iter().position(|(other, _)| other == name)?;
        Some(made.swap_remove(place).1)
    }

    /// Ends what is not done.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}

impl Monitor for BackgroundRuns<'_> {
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
