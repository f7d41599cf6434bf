//! What the simple model runs with: its springs, and a load case.

use std::collections::BTreeMap;

use railspring_simulate::time::scenario::Scenario;
use serde::Serialize;

use crate::engine::store::{Address, Kind};
use crate::results::bodies::input::calibration_address;
use crate::results::run::record::SpringsRecord;
use crate::study::{
    ContactElementKey, OutputKeys, Rail, SimulationSettings, Statics, Study, StudyScenario, Track, Wheel,
};

/// What decides which springs the simple model has.
#[derive(Debug, Clone, Copy)]
pub struct SpringsInput<'a> {
    /// The statics of the pair that they belong to.
    pub statics: Statics<'a>,
    /// Files for other programs, which are kept with a calibration.
    pub output: &'a OutputKeys,
    /// The simple model.
    pub simulation: &'a SimulationSettings,
    /// Its contact element.
    pub element: ContactElementKey,
    /// The load cases by name.
    pub cases: &'a BTreeMap<String, StudyScenario>,
}

impl<'a> SpringsInput<'a> {
    /// That of a study.
    pub fn of(study: &'a Study) -> Self {
        Self {
            statics: study.statics(),
            output: &study.output,
            simulation: &study.simulation,
            element: study.element(),
            cases: &study.scenarios,
        }
    }

    /// Address of the study's own calibration.
    pub fn calibration(&self) -> Address {
        calibration_address(self.statics, self.output)
    }
}

/// What a load case on the simple model is made from, besides its springs.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SimpleRunInput<'a> {
    /// The rail.
    pub rail: &'a Rail,
    /// The wheel.
    pub wheel: &'a Wheel,
    /// Where the wheel is on the track.
    pub track: Track,
    /// Damping of both bodies, s.
    pub damping: f64,
    /// The simple model.
    pub simulation: &'a SimulationSettings,
    /// The load case.
    pub case: &'a Scenario,
}

impl<'a> SimpleRunInput<'a> {
    /// That of a load case of a study.
    pub fn of(study: &'a Study, case: &'a StudyScenario) -> Self {
        Self {
            rail: &study.rail,
            wheel: &study.wheel,
            track: study.track,
            damping: study.damping,
            simulation: &study.simulation,
            case: &case.scenario,
        }
    }

    /// Address of the run with some springs.
    pub fn address(&self, springs: &SpringsRecord) -> Address {
        Address::of(Kind::SimpleRun, &(self, springs))
    }

    /// The same in a contact element that the study has not chosen: a failure is kept there, too, and that of the chosen element never.
    pub fn other_address(&self, springs: &SpringsRecord) -> Address {
        Address::of(Kind::SimpleRun, &("other element", self, springs))
    }
}
