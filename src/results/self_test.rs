//! The program's own test as a stage: once for a program on a machine.

use railspring_profiles::error::Result;

use crate::engine::list::NewFile;
use crate::engine::output::to_json;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact, Kind};
use crate::self_test::{Check, checks};

/// Part of the artefact.
const CHECKS: &str = "checks.json";

/// The checks of `railspring self-test`, made by this program on this machine.
pub(crate) struct SelfTest;

impl Stage for SelfTest {
    type Value = Vec<Check>;

    fn name(&self) -> String {
        "self-test".into()
    }

    fn address(&mut self, engine: &Engine<'_>) -> Result<Address> {
        Ok(Address::of(Kind::SelfTest, &engine.measured.machine.processor))
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput> {
        Ok(StageOutput::whole(Artefact::default().with(CHECKS, to_json(&checks(engine.monitor)?))))
    }

    fn value(&mut self, artefact: &Artefact, _: &str) -> Result<Vec<Check>> {
        artefact.json(CHECKS)
    }

    fn files(&self, _: &Artefact, _: &Vec<Check>, _: &str) -> Vec<NewFile> {
        Vec::new()
    }

    fn outdates(&self) -> &'static [&'static str] {
        &[]
    }

    fn is_measured(&self) -> bool {
        false
    }
}
