//! A study on its way through the stages.

use super::bodies::estimate::Resources;
use super::bodies::in_work::Solids;
use super::bodies::input::SolidsInput;
use crate::engine::output::OutputFolder;
use crate::engine::stage::Engine;
use crate::engine::store::Store;
use crate::study::Study;

/// A study on its way through the stages.
pub struct StudyRun<'a> {
    /// The study.
    pub(crate) study: &'a Study,
    /// Store, output folder and measures.
    pub(crate) engine: Engine<'a>,
    /// Its solids as far as they are made.
    pub(crate) solids: Solids<'a>,
}

impl<'a> StudyRun<'a> {
    /// Begins with the measures that earlier commands have left in the folder.
    pub fn new(study: &'a Study, folder: &'a OutputFolder, resources: Resources<'a>) -> Self {
        let engine = Engine::new(&study.name, folder, resources.monitor);
        Self { study, engine, solids: Solids::new(SolidsInput::of(study), resources) }
    }

    /// Takes from `store` what it has, unless all is to be made `fresh`, and keeps there what is made.
    #[must_use]
    pub fn keeping(mut self, store: Option<&'a Store>, fresh: bool) -> Self {
        (self.engine.store, self.engine.fresh) = (store, fresh);
        (self.solids.store, self.solids.fresh) = (store, fresh);
        self
    }
}
