//! The law by contact angle as a stage.

use std::sync::Arc;

use railspring_profiles::error::Result;

use super::columns;
use crate::engine::list::NewFile;
use crate::engine::output::to_json;
use crate::engine::seal::Sealed;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact};
use crate::results::bodies::in_work::Solids;
use crate::results::bodies::solids;
use crate::results::by_angle::input::ByAngleInput;
use crate::results::by_angle::make;
use crate::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use crate::results::names::{BY_ANGLE_ROWS, OF_THE_VERDICT};
use crate::results::springs::record::StiffnessRecord;

/// The laws of the study's shifts, on the bodies of its calibration.
pub(crate) struct ByAngle<'s, 'a> {
    pub solids: &'s mut Solids<'a>,
    pub input: ByAngleInput<'a>,
    /// The springs of that calibration, which follow from the same inputs.
    pub stiffness: &'s StiffnessRecord,
}

impl Stage for ByAngle<'_, '_> {
    type Value = StiffnessByAngleRecord;

    fn name(&self) -> String {
        "law by contact angle".into()
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        Ok(self.input.address(self.solids.reach()?))
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput> {
        let at = &mut *self.solids;
        let geometry = at.geometry()?;
        let (statics, monitor) = (at.input.statics, at.resources.monitor);
        let bodies = match at.condensed.take() {
            Some(bodies) => bodies,
            None => {
                let meshes = at.meshes(engine, Solids::calibration_work)?;
                let solids = solids::solids(statics, &geometry, &meshes);
                let bodies = Arc::new(at.body_source().condensed(&solids, "", at.input.modes)?);
                at.set_meshes(meshes);
                bodies
            }
        };
        // with the zones of the calibration, with which the runs on the solids go on
        let coarser = || {
            let meshes = at.meshes(engine, Solids::calibration_work)?;
            let coarser = at.coarser(&geometry, &meshes)?;
            let element = meshes.contact_element();
            at.set_meshes(meshes);
            Ok((element, coarser))
        };
        let laws = make::by_angle(&self.input, &geometry, &bodies, self.stiffness, coarser, monitor)?;
        // the runs on the solids take them next
        at.condensed = (at.input.modes > 0).then_some(bodies);
        let rows = columns::rows(&laws);
        Ok(StageOutput::whole(Artefact::default().with(BY_ANGLE, to_json(&laws)).with(BY_ANGLE_ROWS, rows)))
    }

    fn value(&mut self, artefact: &Artefact, key: &str) -> Result<StiffnessByAngleRecord> {
        let at = &*self.solids;
        let mut laws: StiffnessByAngleRecord = artefact.json(BY_ANGLE)?;
        laws.study = at.input.name.into();
        laws.input_hash = key.into();
        laws.pair = at.input.statics.pair();
        Ok(laws.sealed())
    }

    fn files(&self, artefact: &Artefact, value: &StiffnessByAngleRecord, key: &str) -> Vec<NewFile> {
        let rows = artefact.part(BY_ANGLE_ROWS).unwrap_or_default().to_vec();
        let files = [(BY_ANGLE, to_json(value)), (BY_ANGLE_ROWS, rows)];
        files.map(|(name, content)| NewFile::new(name, content, key)).into()
    }

    fn outdates(&self) -> &'static [&'static str] {
        &OF_THE_VERDICT
    }
}
