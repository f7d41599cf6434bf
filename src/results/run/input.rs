//! What the simple model runs with: its springs, and a load case.

use std::collections::BTreeMap;

use railspring_simulate::time::scenario::Scenario;
use serde::Serialize;

use crate::engine::store::{Address, Kind};
use crate::results::bodies::input::calibration_address;
use crate::results::run::record::{SpringsRecord, SpringsSource};
use crate::results::springs::record::StiffnessRecord;
use crate::results::springs::uncertainty_record::InputUncertaintyRecord;
use crate::study::tables::FileRecord;
use crate::study::{
    ContactElementKey, OutputKeys, Rail, SimulationSettings, Statics, Study, StudyScenario, Track,
    UncertaintySettings, Wheel,
};
use crate::verify::Limits;

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
    /// The files with tables of its forces.
    #[serde(skip_serializing_if = "<[FileRecord]>::is_empty")]
    pub tables: &'a [FileRecord],
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
            tables: &case.tables,
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

/// What the samples of uncertain inputs of such a load case are made from.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct UncertainInput<'a> {
    /// The load case.
    pub run: SimpleRunInput<'a>,
    /// Its springs.
    pub springs: &'a SpringsRecord,
    /// What the inputs change of these springs; none of springs that are not the study's own.
    pub of_springs: Option<&'a InputUncertaintyRecord>,
    /// Standard uncertainties of the inputs.
    pub uncertainty: &'a UncertaintySettings,
    /// Friction of the calibration, which that of the load case departs with.
    pub friction: f64,
    /// Time over which Q and P are averaged, s.
    pub window: f64,
    /// How far an averaged Q/P may be off.
    pub ratio_max: f64,
    /// Shortest separation that counts, s.
    pub shortest: f64,
    /// The statics of the pair, of which the inputs are.
    #[serde(skip)]
    pub statics: Statics<'a>,
}

impl<'a> UncertainInput<'a> {
    /// That of a load case of a study whose runs are judged by `limits`, with some springs; `stiffness` is what it has calibrated.
    pub fn of(
        run: SimpleRunInput<'a>,
        springs: &'a SpringsRecord,
        stiffness: Option<&'a StiffnessRecord>,
        (statics, limits): (Statics<'a>, &Limits),
    ) -> Self {
        let own = stiffness.filter(|_| springs.source == SpringsSource::Calibrated);
        Self {
            run,
            springs,
            of_springs: own.and_then(|stiffness| stiffness.input_uncertainty.as_ref()),
            uncertainty: statics.uncertainty,
            friction: statics.contact.friction,
            window: limits.ratio_window_s,
            ratio_max: limits.ratio_max,
            shortest: limits.separation_shortest_s,
            statics,
        }
    }

    /// Address of the samples.
    pub fn address(&self) -> Address {
        Address::of(Kind::UncertainRun, self)
    }
}
