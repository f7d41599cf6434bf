//! The cross-check as a stage: reference solvers repeat what the tool computed.

use std::path::Path;

use railspring_profiles::error::{Error, InputError, Result};

use super::stage::{Engine, Made, Stage};
use super::names::{CROSSCHECK, DIFFERENCES};
use super::{Pipeline};
use crate::crosscheck::exchange::Case;
use crate::crosscheck::{self, Solvers};
use crate::estimate::Resources;
use crate::output::{OutputFolder, to_json};
use crate::records::crosscheck::CrosscheckRecord;
use crate::results::NewFile;
use crate::store::{Address, Artefact, Kind};
use crate::study::Study;

/// Folder of the questions and answers inside the output folder.
const EXCHANGE_FOLDER: &str = "crosscheck";

/// Questions to reference solvers, and the comparison.
struct Crosscheck<'a> {
    study: &'a Study,
    resources: Resources<'a>,
    cases: &'a [Case],
    solvers: &'a Solvers,
}

impl Stage for Crosscheck<'_> {
    type Value = CrosscheckRecord;

    fn name(&self) -> String {
        "cross-check".into()
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        let cases: Vec<&str> = self.cases.iter().map(|case| case.name()).collect();
        Ok(Address::of(Kind::Crosscheck, &(&self.study.keys.crosscheck, cases, self.solvers.versions())))
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<Made> {
        let folder = OutputFolder::create(&engine.folder.file(EXCHANGE_FOLDER))?;
        let (record, differences) =
            crosscheck::crosscheck(self.study, &folder, self.cases, self.solvers, &self.resources)?;
        let artefact = Artefact::default().with(CROSSCHECK, to_json(&record));
        Ok(Made::whole(artefact.with(DIFFERENCES, to_json(&differences))))
    }

    fn value(&mut self, artefact: &Artefact, _: &str) -> Result<CrosscheckRecord> {
        artefact.json(CROSSCHECK)
    }

    fn files(&self, artefact: &Artefact, _: &CrosscheckRecord, key: &str) -> Vec<NewFile> {
        let part = |name: &str| {
            let content = artefact.part(name).unwrap_or_default().to_vec();
            // seconds, date and host are in it
            NewFile { reproducible: false, ..NewFile::new(name, content, key) }
        };
        vec![part(CROSSCHECK), part(DIFFERENCES)]
    }

    fn outdates(&self) -> &'static [&'static str] {
        &[]
    }
}

impl Pipeline<'_> {
    /// The cross-check with its page, and the report again if the folder has the study's other results; the record says
    /// whether all limits hold. `keep` is a file that gets a copy of it.
    ///
    /// # Errors
    /// A program that is missing, a copy that cannot be written, and those of the stages.
    pub fn crosscheck(
        mut self,
        cases: &[Case],
        calculix: bool,
        keep: Option<&Path>,
    ) -> Result<CrosscheckRecord> {
        // first, so that whatever is missing is reported before anything is computed
        let keep = keep.map(kept_in).transpose()?;
        let solvers = Solvers::find(cases, calculix, &self.solids.resources)?;
        let (study, resources) = (self.study, self.solids.resources);
        let record = self.engine.get(&mut Crosscheck { study, resources, cases, solvers: &solvers })?;
        if let Some((kept, name)) = keep {
            kept.write_json(&name, &record)?;
        }
        self.crosscheck_pages()?;
        Ok(record)
    }
}

/// Folder and name of the copy.
fn kept_in(path: &Path) -> Result<(OutputFolder, String)> {
    let refused = |value: String| {
        InputError::new("--keep", value, "a file in a folder that can be written", "choose another one")
    };
    let name = path.file_name().filter(|_| !path.is_dir());
    let name = name.ok_or_else(|| refused(path.display().to_string()))?.to_string_lossy().into_owned();
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = OutputFolder::create(parent).map_err(|error| match error {
        Error::Input(cause) => refused(cause.value).into(),
        other => other,
    })?;
    Ok((folder, name))
}
