//! The law by contact angle as a stage.

use railspring_calibrate::error::{NumericsError, Result};

use super::stage::{Made, Stage};
use super::{BY_ANGLE, BY_ANGLE_ROWS, OF_THE_VERDICT, Pipeline, part_json};
use crate::estimate::Work;
use crate::output::to_json;
use crate::records::{StiffnessByAngleRecord, to_csv};
use crate::results::NewFile;
use crate::stages::{self, Meshes};
use crate::store::{Address, Artefact, Kind};

/// The laws of the study's shifts, on the bodies of its calibration.
pub(super) struct ByAngle;

impl Stage for ByAngle {
    type Value = StiffnessByAngleRecord;

    fn name(&self) -> String {
        "law by contact angle".into()
    }

    fn key(&self, at: &Pipeline<'_>) -> String {
        at.study.keys.by_angle.clone()
    }

    fn address(&self, at: &mut Pipeline<'_>) -> Result<Option<Address>> {
        let reach = at.reach()?;
        // a window that the study gives is not made longer, though it be as long as the usual one
        let given = at.study.source.gives("mesh.window_half_length_mm");
        let inputs = (&at.study.keys.springs, &at.study.calibration.shifts, reach, given);
        Ok(at.store.map(|store| store.address(Kind::ByAngle, &inputs)))
    }

    fn make(&self, at: &mut Pipeline<'_>) -> Result<Made> {
        let geometry = at.geometry()?;
        let (study, monitor) = (at.study, at.resources.monitor);
        let bodies = match at.condensed.take() {
            Some(bodies) => bodies,
            None => {
                let meshes = at.meshes(Pipeline::calibration_work)?;
                let bodies =
                    at.body_source().bodies(stages::solids(study, &geometry, &meshes), "")?.condensed;
                at.go_on_with(meshes);
                bodies
            }
        };
        let mut meshes: Option<Meshes> = None;
        let budget = at.resources.budget;
        let longer = |cause: &NumericsError| {
            let next = match &meshes {
                Some(meshes) => stages::enlarged(study, &geometry, meshes, cause, monitor),
                None => {
                    let own = at.meshes(Pipeline::calibration_work)?;
                    let next = stages::enlarged(study, &geometry, &own, cause, monitor);
                    // the runs on the solids go on with the zones of the calibration
                    at.go_on_with(own);
                    next
                }
            };
            let Some(next) = next else { return Ok(None) };
            // a law that ends early is a result; without the memory for a longer one it stays that
            if budget.check(study, &geometry, &next, &Work::of(study, true, false)).is_err() {
                return Ok(None);
            }
            let bodies = at
                .body_source()
                .bodies(stages::solids(study, &geometry, &next), " of a longer window")?
                .condensed;
            meshes = Some(next);
            Ok(Some(bodies))
        };
        let laws = stages::by_angle(study, &geometry, &bodies, longer, monitor)?;
        let rows = to_csv(&laws.rows());
        Ok(Made::whole(Artefact::default().with(BY_ANGLE, to_json(&laws)).with(BY_ANGLE_ROWS, rows)))
    }

    fn value(&self, artefact: &Artefact, at: &mut Pipeline<'_>) -> Result<StiffnessByAngleRecord> {
        let mut laws: StiffnessByAngleRecord = part_json(artefact, BY_ANGLE)?;
        laws.study.clone_from(&at.study.name);
        laws.input_hash = self.key(at);
        laws.pair = at.study.pair();
        Ok(laws)
    }

    fn files(&self, artefact: &Artefact, value: &StiffnessByAngleRecord, at: &Pipeline<'_>) -> Vec<NewFile> {
        let rows = artefact.part(BY_ANGLE_ROWS).unwrap_or_default().to_vec();
        let files = [(BY_ANGLE, to_json(value)), (BY_ANGLE_ROWS, rows)];
        files.map(|(name, content)| NewFile::new(name, content, &self.key(at))).into()
    }

    fn outdates(&self) -> &'static [&'static str] {
        &OF_THE_VERDICT
    }
}
