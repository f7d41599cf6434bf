//! The load case on a reference solver as a stage.

use railspring_profiles::error::Result;

use super::input::InTimeInput;
use super::make::crosscheck;
use crate::engine::list::NewFile;
use crate::engine::output::{OutputFolder, to_json};
use crate::engine::seal::Sealed;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact};
use crate::python::{self, Python};
use crate::results::bodies::estimate::Resources;
use crate::results::crosscheck::record::CrosscheckRecord;
use crate::results::crosscheck::stage::EXCHANGE_FOLDER;
use crate::results::names::CROSSCHECK;

/// The question to the reference solver, and the comparison.
pub(crate) struct CrosscheckInTime<'a> {
    pub(crate) input: InTimeInput<'a>,
    pub(crate) resources: Resources<'a>,
    pub(crate) python: &'a Python,
}

impl Stage for CrosscheckInTime<'_> {
    type Value = CrosscheckRecord;

    fn name(&self) -> String {
        format!("cross-check in time, {}", self.input.name)
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        Ok(self.input.address((python::package_hash_in_time(), self.python.versions())))
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput> {
        let folder = OutputFolder::create(&engine.folder.file(EXCHANGE_FOLDER), engine.folder.inputs())?;
        let record = crosscheck(&self.input, &folder, self.python, &self.resources)?;
        Ok(StageOutput::whole(Artefact::default().with(CROSSCHECK, to_json(&record))))
    }

    fn value(&mut self, artefact: &Artefact, _: &str) -> Result<CrosscheckRecord> {
        let record: CrosscheckRecord = artefact.json(CROSSCHECK)?;
        Ok(CrosscheckRecord { study: self.input.study().into(), ..record }.sealed())
    }

    fn files(&self, _: &Artefact, value: &CrosscheckRecord, key: &str) -> Vec<NewFile> {
        // seconds, date and host are in it
        vec![NewFile { reproducible: false, ..NewFile::new(CROSSCHECK, to_json(value), key) }]
    }

    fn outdates(&self) -> &'static [&'static str] {
        &[]
    }
}
