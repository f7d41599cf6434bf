//! The cross-check as a stage: reference solvers repeat what the tool computed.

use railspring_profiles::error::Result;

use crate::engine::list::NewFile;
use crate::engine::output::{OutputFolder, to_json};
use crate::engine::seal::Sealed;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact};
use crate::results::bodies::estimate::Resources;
use crate::results::crosscheck::exchange::Case;
use crate::results::crosscheck::input::CrosscheckInput;
use crate::results::crosscheck::make::crosscheck;
use crate::results::crosscheck::record::CrosscheckRecord;
use crate::results::crosscheck::solvers::Solvers;
use crate::results::names::{CROSSCHECK, DIFFERENCES};

/// Folder of the questions and answers inside the output folder.
pub(super) const EXCHANGE_FOLDER: &str = "crosscheck";

/// Questions to reference solvers, and the comparison.
pub(crate) struct Crosscheck<'a> {
    pub(crate) input: CrosscheckInput<'a>,
    pub(crate) resources: Resources<'a>,
    pub(crate) cases: &'a [Case],
    pub(crate) solvers: &'a Solvers,
}

impl Stage for Crosscheck<'_> {
    type Value = CrosscheckRecord;

    fn name(&self) -> String {
        "cross-check".into()
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        let cases: Vec<&str> = self.cases.iter().map(|case| case.name()).collect();
        Ok(self.input.address(&cases, self.solvers.versions()))
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput> {
        let folder = OutputFolder::create(&engine.folder.file(EXCHANGE_FOLDER), engine.folder.inputs())?;
        let (record, differences) =
            crosscheck(&self.input, &folder, self.cases, self.solvers, &self.resources)?;
        let artefact = Artefact::default().with(CROSSCHECK, to_json(&record));
        Ok(StageOutput::whole(artefact.with(DIFFERENCES, to_json(&differences.sealed()))))
    }

    fn value(&mut self, artefact: &Artefact, _: &str) -> Result<CrosscheckRecord> {
        let record: CrosscheckRecord = artefact.json(CROSSCHECK)?;
        Ok(CrosscheckRecord { study: self.input.name().into(), ..record }.sealed())
    }

    fn files(&self, artefact: &Artefact, value: &CrosscheckRecord, key: &str) -> Vec<NewFile> {
        let differences = artefact.part(DIFFERENCES).unwrap_or_default().to_vec();
        // seconds, date and host are in them
        let file = |(name, content)| NewFile { reproducible: false, ..NewFile::new(name, content, key) };
        [(CROSSCHECK, to_json(value)), (DIFFERENCES, differences)].map(file).into()
    }

    fn outdates(&self) -> &'static [&'static str] {
        &[]
    }
}
