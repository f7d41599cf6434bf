//! What a stage is, and how its result is had: taken from the store, or made and kept there.

use std::sync::Arc;

use railspring_calibrate::mesh::MeshOptions;
use railspring_profiles::error::{Error, Result};

use super::{MEASURED, Pipeline};
use crate::estimate::{self, Work};
use crate::measure::Stopwatch;
use crate::records::Reach;
use crate::results::NewFile;
use crate::stages::{self, FINER, Geometry, Meshes};
use crate::store::{Address, Artefact};

/// Part of an artefact: how far the contact zones reached in the end.
pub(super) const REACH: &str = "reach.json";

/// A stage: what its result is made from, how it is made, and the files that it becomes.
pub(super) trait Stage {
    /// What the stage hands on.
    type Value;

    /// What the terminal and the measures call it.
    fn name(&self) -> String;

    /// Its address: all that it is made from, the program included. The store keeps it there, and the output folder lists its files by it.
    fn address(&self, at: &mut Pipeline<'_>) -> Result<Address>;

    /// Whether the store keeps it; not what is made sooner than it is read.
    fn is_kept(&self) -> bool {
        true
    }

    /// What was made of it beside other stages.
    fn begun(&self, _: &Pipeline<'_>) -> Option<Result<Made>> {
        None
    }

    /// Makes it.
    fn make(&self, at: &mut Pipeline<'_>) -> Result<Made>;

    /// What the artefact of an address with this key holds; the same whether it was taken or made.
    fn value(&self, artefact: &Artefact, key: &str, at: &mut Pipeline<'_>) -> Result<Self::Value>;

    /// The files that it becomes in the output folder, listed by the key.
    fn files(&self, artefact: &Artefact, value: &Self::Value, key: &str, at: &Pipeline<'_>) -> Vec<NewFile>;

    /// Files that are made from these, and go when one of these changes.
    fn outdates(&self) -> &'static [&'static str];

    /// Whether later stages go on with the contact zones that it has ended with.
    fn ends_with_reach(&self) -> bool {
        false
    }

    /// Whether it takes so long that time, memory and where it came from are said.
    fn is_measured(&self) -> bool {
        true
    }
}

/// What a stage has made.
pub(super) struct Made {
    pub artefact: Artefact,
    /// Whether it is the whole result, which follows from its inputs alone.
    pub complete: bool,
    /// Why the command ends here all the same.
    pub failure: Option<Error>,
    /// The time that it took beside other stages, of which it is measured and kept already.
    pub elsewhere: Option<Stopwatch>,
}

impl Made {
    /// A complete result.
    pub fn whole(artefact: Artefact) -> Self {
        Self { artefact, complete: true, failure: None, elsewhere: None }
    }
}

/// Mesh options that are as fine and reach as far as `reach` says.
fn reaching(mut options: MeshOptions, reach: &Reach) -> MeshOptions {
    for _ in 0..reach.refinements {
        options = options.refined(FINER);
    }
    reach.extend(options)
}

impl Pipeline<'_> {
    /// The result of a stage, and its files in the output folder.
    ///
    /// # Errors
    /// Those of making it and of writing its files.
    pub(super) fn get<S: Stage>(&mut self, stage: &S) -> Result<S::Value> {
        self.watch = Some(Stopwatch::start());
        let address = stage.address(self)?;
        let key = address.key();
        let begun = stage.begun(self).transpose()?;
        let takes = stage.is_kept() && !self.fresh && begun.is_none();
        let taken = if takes { self.take(stage, &address) } else { None };
        let is_taken = taken.is_some();
        let (artefact, value, failure) = match taken {
            Some((artefact, value)) => (artefact, value, None),
            None => {
                let made = begun.map_or_else(|| stage.make(self), Ok)?;
                let Made { artefact, complete, failure, elsewhere } = made;
                if stage.is_kept() && complete && elsewhere.is_none() {
                    self.keep(&address, &stage.name(), &artefact);
                }
                self.watch = elsewhere.or(self.watch.take());
                let value = stage.value(&artefact, key, self)?;
                (artefact, value, failure)
            }
        };
        let reach = self.reach.filter(|_| stage.ends_with_reach());
        let files = stage.files(&artefact, &value, key, self).into_iter();
        self.results.write(files.map(|file| NewFile { reach, ..file }).collect(), stage.outdates())?;
        if stage.is_measured() {
            self.note(&stage.name(), key, is_taken)?;
            let whence = if is_taken { "taken from the store" } else { "made" };
            self.resources.monitor.notice(&format!("{}: {whence}", stage.name()));
        }
        failure.map_or(Ok(value), Err)
    }

    /// What the store has for a stage; an entry that cannot be used is said and removed.
    fn take<S: Stage>(&mut self, stage: &S, address: &Address) -> Option<(Artefact, S::Value)> {
        let (store, monitor, name) = (self.store?, self.resources.monitor, stage.name());
        let read =
            |artefact: Artefact| stage.value(&artefact, address.key(), self).map(|value| (artefact, value));
        store.take_as(address, read, &|text| monitor.notice(&format!("{name}: {text}")))
    }

    /// Keeps an artefact. A store that cannot be written takes nothing from the result.
    fn keep(&self, address: &Address, name: &str, artefact: &Artefact) {
        let Some(store) = self.store else { return };
        let say = |text| self.resources.monitor.notice(&format!("{name}: {text}"));
        store.keep(address, name, &self.study.name, artefact, &say);
    }

    /// Adds a measure, and drops those of results that the folder has no longer.
    fn note(&mut self, stage: &str, key: &str, taken: bool) -> Result<()> {
        let watch = self.watch.take().unwrap_or_else(Stopwatch::start);
        self.measured.note(watch.stop(stage, key, taken));
        let results = &self.results;
        self.measured.stages.retain(|stage| results.has(&stage.key));
        self.folder.write_json(MEASURED, &self.measured)
    }

    /// Sections and first touch.
    pub(super) fn geometry(&mut self) -> Result<Arc<Geometry>> {
        if let Some(geometry) = &self.geometry {
            return Ok(geometry.clone());
        }
        let geometry = Arc::new(stages::geometry(self.study)?);
        Ok(self.geometry.insert(geometry).clone())
    }

    /// How far the contact zones reach now.
    pub(super) fn reach(&mut self) -> Result<Reach> {
        if let Some(reach) = self.reach {
            return Ok(reach);
        }
        let geometry = self.geometry()?;
        Ok(*self.reach.insert(Reach::of(&stages::mesh_options(self.study, &geometry), 0)))
    }

    /// Goes on with the zones that an artefact has ended with.
    pub(super) fn go_on_with_reach(&mut self, artefact: &Artefact) -> Result<()> {
        self.go_on_from(super::part_json(artefact, REACH)?);
        Ok(())
    }

    /// Goes on with zones that reach so far.
    pub(super) fn go_on_from(&mut self, reach: Reach) {
        if self.reach != Some(reach) {
            self.reach = Some(reach);
            self.meshes = None;
        }
    }

    /// The meshes with zones that reach as far as they have to by now; made for `work`, which must be within the budget.
    /// They are the caller's until [`Pipeline::go_on_with`].
    pub(super) fn meshes(&mut self, work: impl FnOnce(&mut Self) -> Result<Work>) -> Result<Meshes> {
        if let Some(meshes) = self.meshes.take() {
            return Ok(meshes);
        }
        let watch = Stopwatch::start();
        let (study, geometry, reach) = (self.study, self.geometry()?, self.reach()?);
        let work = work(self)?;
        let options = reaching(stages::mesh_options(study, &geometry), &reach);
        let (meshes, room) = estimate::meshes(study, &geometry, options, &work, &self.resources)?;
        self.room = room;
        // Kept until there is a result: a study that is refused later leaves no file behind.
        let of_calibration = stages::calibration_address(study);
        self.measured.note(watch.stop("meshes", of_calibration.key(), false));
        // The stage that needs them is measured without them.
        self.watch = Some(Stopwatch::start());
        Ok(meshes)
    }

    /// Hands back the meshes that a run has ended with.
    pub(super) fn go_on_with(&mut self, meshes: Meshes) -> Reach {
        let reach = Reach::of(meshes.options(), meshes.refinements(self.study));
        self.meshes = Some(meshes);
        *self.reach.insert(reach)
    }
}
