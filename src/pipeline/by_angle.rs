//! The law by contact angle as a stage.

use railspring_calibrate::error::{NumericsError, Result};
use railspring_calibrate::pair::CondensedPair;

use super::stage::{Made, Stage};
use super::{BY_ANGLE, BY_ANGLE_ROWS, OF_THE_VERDICT, Pipeline, part_json};
use crate::estimate::Work;
use crate::output::to_json;
use crate::records::{StiffnessByAngleRecord, to_csv};
use crate::results::NewFile;
use crate::stages::{self, BodiesByAngle, CoarserBodies, Geometry, Meshes};
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
        let inputs = (&at.study.keys.springs, &at.study.calibration.shifts, reach);
        Ok(at.store.map(|store| store.address(Kind::ByAngle, &inputs)))
    }

    fn make(&self, at: &mut Pipeline<'_>) -> Result<Made> {
        let geometry = at.geometry()?;
        let (study, monitor) = (at.study, at.resources.monitor);
        let bodies = match at.condensed.take() {
            Some(bodies) => bodies,
            None => {
                let meshes = at.meshes(Pipeline::calibration_work)?;
                let bodies = at
                    .body_source()
                    .bodies(stages::solids(study, &geometry, &meshes), "", study.modes())?
                    .condensed;
                at.go_on_with(meshes);
                bodies
            }
        };
        let mut others = Others { at, geometry: &geometry, longer: None };
        let laws = stages::by_angle(study, &geometry, &bodies, &mut others, monitor)?;
        // the runs on the solids take them next
        at.condensed = (study.modes() > 0).then_some(bodies);
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

/// Bodies beside those of the calibration, from the store or condensed.
struct Others<'p, 'a> {
    at: &'p mut Pipeline<'a>,
    geometry: &'p Geometry,
    /// The meshes with the longest window so far.
    longer: Option<Meshes>,
}

impl Others<'_, '_> {
    /// Does something with the meshes of the last bodies.
    fn with_meshes<T>(&mut self, work: impl FnOnce(&Pipeline<'_>, &Meshes) -> Result<T>) -> Result<T> {
        if let Some(meshes) = &self.longer {
            return work(self.at, meshes);
        }
        let own = self.at.meshes(Pipeline::calibration_work)?;
        let done = work(self.at, &own);
        // the runs on the solids go on with the zones of the calibration
        self.at.go_on_with(own);
        done
    }
}

impl BodiesByAngle for Others<'_, '_> {
    fn longer(&mut self, cause: &NumericsError) -> Result<Option<CondensedPair>> {
        let (geometry, budget) = (self.geometry, self.at.resources.budget);
        let next = self.with_meshes(|at, meshes| {
            Ok(stages::enlarged(at.study, geometry, meshes, cause, at.resources.monitor))
        })?;
        let Some(next) = next else { return Ok(None) };
        let study = self.at.study;
        // a law that ends early is a result; without the memory for a longer one it stays that
        if budget.check(study, geometry, &next, &Work::of(study, true, false)).is_err() {
            return Ok(None);
        }
        let solids = stages::solids(study, geometry, &next);
        let bodies = self.at.body_source().bodies(solids, " of a longer window", 0)?.condensed;
        self.longer = Some(next);
        Ok(Some(bodies))
    }

    fn coarser(&mut self) -> Result<(f64, CoarserBodies)> {
        let (geometry, which) = match &self.longer {
            Some(_) => (self.geometry, " of coarser elements and a longer window"),
            None => (self.geometry, " of coarser elements"),
        };
        self.with_meshes(|at, meshes| {
            let condense = |coarser: &Meshes| {
                let solids = stages::solids(at.study, geometry, coarser);
                at.body_source().bodies(solids, which, 0).map(|bodies| bodies.condensed)
            };
            let coarser = stages::coarser_bodies(at.study, geometry, meshes, condense)?;
            Ok((meshes.contact_element(), coarser))
        })
    }
}
