//! The solids of a study as far as they have been made: what calibration, laws by contact angle and runs on the solids have in common.

use std::sync::Arc;

use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::CondensedPair;
use railspring_profiles::error::Result;
use serde_json::Value;

use crate::engine::measure::Stopwatch;
use crate::engine::stage::Engine;
use crate::engine::store::{Artefact, Store};
use crate::results::bodies::coarser::CoarserBodies;
use crate::results::bodies::estimate::{self, Resources, Room, Work};
use crate::results::bodies::geometry::{self, Geometry};
use crate::results::bodies::input::SolidsInput;
use crate::results::bodies::meshes::{FINER, Meshes};
use crate::results::bodies::reach::Reach;
use crate::results::bodies::solids::MovingBodies;
use crate::results::bodies::source::BodySource;
use crate::results::bodies::zones;

/// Part of an artefact: how far the contact zones reached in the end.
pub(crate) const REACH: &str = "reach.json";
/// The same as a note beside files of an output folder.
pub(crate) const REACH_NOTE: &str = "reach";

/// Bodies of a run on the solids, and the modes that were asked for.
pub(crate) type Moving = (usize, Arc<MovingBodies>);

/// The solids of a study.
pub(crate) struct Solids<'a> {
    pub input: SolidsInput<'a>,
    pub resources: Resources<'a>,
    pub store: Option<&'a Store>,
    /// Whether all is made anew.
    pub fresh: bool,
    /// What there is room for at the same time.
    pub room: Room,
    geometry: Option<Arc<Geometry>>,
    meshes: Option<Meshes>,
    reach: Option<Reach>,
    /// The bodies of the calibration, for the laws by contact angle and for the runs on the solids.
    pub condensed: Option<Arc<CondensedPair>>,
    /// The bodies of the last run on the solids.
    pub moving: Option<Moving>,
}

/// Mesh options that are as fine and reach as far as `reach` says.
fn reaching(mut options: MeshOptions, reach: &Reach) -> MeshOptions {
    for _ in 0..reach.refinements {
        options = options.refined(FINER);
    }
    reach.extend(options)
}

impl<'a> Solids<'a> {
    /// Nothing is made yet.
    pub fn new(input: SolidsInput<'a>, resources: Resources<'a>) -> Self {
        Self {
            input,
            resources,
            store: None,
            fresh: false,
            room: Room::default(),
            geometry: None,
            meshes: None,
            reach: None,
            condensed: None,
            moving: None,
        }
    }

    /// Where the condensed bodies of the study come from; those of refined meshes one after the other.
    pub fn body_source(&self) -> BodySource<'a> {
        let statics = self.input.statics;
        BodySource {
            beside: None,
            store: self.store,
            keeps: [true; 2],
            fresh: self.fresh,
            foot_held: statics.calibration.foot_held,
            together: self.room.condensing && statics.target_error.is_none(),
            study: self.input.name,
            monitor: self.resources.monitor,
            trouble: None,
        }
    }

    /// The bodies of coarser meshes, the wheel with modes if contact elements are made.
    ///
    /// # Errors
    /// Those of condensing them.
    pub fn coarser(&self, geometry: &Geometry, meshes: &Meshes) -> Result<CoarserBodies> {
        let modes = if self.input.wants_elements { self.input.modes } else { 0 };
        self.body_source().coarser(self.input.statics, geometry, meshes, modes)
    }

    /// The runs on the solids that the store does not have, as far as that can be said now.
    pub fn solid_work(&mut self) -> Result<Work> {
        let mut work = Work::of(&self.input, false, true);
        if let (Some(store), false) = (self.store, self.fresh) {
            let reach = self.reach()?;
            let has = |name: &str| store.has(&self.input.run(&self.input.cases[name]).address(reach));
            work.solids.retain(|(name, _)| !has(name));
        }
        Ok(work)
    }

    /// The same with the calibration.
    pub fn calibration_work(&mut self) -> Result<Work> {
        Ok(Work { calibrate: true, ..self.solid_work()? })
    }

    /// Sections and first touch.
    pub fn geometry(&mut self) -> Result<Arc<Geometry>> {
        if let Some(geometry) = &self.geometry {
            return Ok(geometry.clone());
        }
        let geometry = Arc::new(geometry::geometry(self.input.statics)?);
        Ok(self.geometry.insert(geometry).clone())
    }

    /// How far the contact zones reach now.
    pub fn reach(&mut self) -> Result<Reach> {
        if let Some(reach) = self.reach {
            return Ok(reach);
        }
        let geometry = self.geometry()?;
        Ok(*self.reach.insert(Reach::of(&zones::mesh_options(self.input.statics, &geometry), 0)))
    }

    /// Goes on with the zones that an artefact has ended with.
    pub fn go_on_with_reach(&mut self, artefact: &Artefact) -> Result<()> {
        self.go_on_from(artefact.json(REACH)?);
        Ok(())
    }

    /// Goes on with zones that reach so far.
    pub fn go_on_from(&mut self, reach: Reach) {
        if self.reach != Some(reach) {
            self.reach = Some(reach);
            self.meshes = None;
        }
    }

    /// The meshes with zones that reach as far as they have to by now; made for `work`, which must be within the budget.
    /// They are the caller's until [`Solids::set_meshes`].
    pub fn meshes(
        &mut self,
        engine: &mut Engine<'_>,
        work: impl FnOnce(&mut Self) -> Result<Work>,
    ) -> Result<Meshes> {
        if let Some(meshes) = self.meshes.take() {
            return Ok(meshes);
        }
        let watch = Stopwatch::start();
        let (input, geometry, reach) = (self.input, self.geometry()?, self.reach()?);
        let work = work(self)?;
        let options = reaching(zones::mesh_options(input.statics, &geometry), &reach);
        let (meshes, beside) = estimate::meshes(&input, &geometry, options, &work, &self.resources)?;
        let room = Room::of(beside, self.resources.budget);
        self.room = room;
        // Kept until there is a result: a study that is refused later leaves no file behind.
        engine.measured.note(watch.stop("meshes", input.calibration().key(), false));
        // The stage that needs them is measured without them.
        engine.watch = Some(Stopwatch::start());
        Ok(meshes)
    }

    /// How far they reach, if that is known, as a note beside files.
    pub fn reach_note(&self) -> Option<(&'static str, Value)> {
        let reach = serde_json::to_value(self.reach?).expect("a record is plain data");
        Some((REACH_NOTE, reach))
    }

    /// Hands back the meshes that a run has ended with.
    pub fn set_meshes(&mut self, meshes: Meshes) -> Reach {
        let reach = Reach::of(meshes.options(), meshes.refinements(self.input.statics.mesh));
        self.meshes = Some(meshes);
        *self.reach.insert(reach)
    }
}
