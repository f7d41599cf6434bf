//! What a study asks of its solids: statics, laws by contact angle, load cases in time.

use std::collections::BTreeMap;

use railspring_calibrate::mesh::MeshOptions;
use railspring_profiles::monitor::Monitor;
use railspring_simulate::time::scenario::Scenario;
use serde::Serialize;

use crate::engine::store::{Address, Kind};
use crate::results::bodies::reach::Reach;
use crate::study::tables::FileRecord;
use crate::study::{
    ContactSettings, ElementKey, OutputKeys, Rail, SolidKeys, Source, Statics, Study, StudyScenario, Track,
    Wheel,
};

/// All that is asked of the solids of a study.
#[derive(Debug, Clone, Copy)]
pub struct SolidsInput<'a> {
    /// Name of the study, which its records carry.
    pub name: &'a str,
    /// Where its keys stand, for errors.
    pub source: &'a Source,
    /// The statics of the pair.
    pub statics: Statics<'a>,
    /// Files for other programs.
    pub output: &'a OutputKeys,
    /// Lateral shifts of the laws by contact angle, m, ascending; `None` leaves them to the program.
    pub shifts: Option<&'a [f64]>,
    /// Whether there are to be laws by contact angle.
    pub wants_by_angle: bool,
    /// Whether contact elements are made of the solids, whose bands want the modes of coarser bodies, too.
    pub wants_elements: bool,
    /// Modes that the bodies are condensed with.
    pub modes: usize,
    /// The solid model in time.
    pub solid: &'a SolidKeys,
    /// Damping of both bodies, s.
    pub damping: f64,
    /// The load cases by name.
    pub cases: &'a BTreeMap<String, StudyScenario>,
    /// Name of the load case whose histories have the plain file names.
    pub main_case: Option<&'a str>,
}

impl<'a> SolidsInput<'a> {
    /// That of a study.
    pub fn of(study: &'a Study) -> Self {
        Self {
            name: &study.name,
            source: &study.source,
            statics: study.statics(),
            output: &study.output,
            shifts: study.shifts.as_deref(),
            wants_by_angle: study.wants_by_angle(),
            wants_elements: study.wants_condensed(),
            modes: study.modes(),
            solid: &study.solid,
            damping: study.damping,
            cases: &study.scenarios,
            main_case: study.main_scenario.as_deref(),
        }
    }

    /// Says what has to be known of the load cases.
    pub fn say_notes(&self, monitor: &dyn Monitor) {
        for (name, case) in self.cases {
            case.notes.iter().for_each(|note| monitor.notice(&format!("{name}: {note}")));
        }
    }

    /// Address of the calibration, with its fields for other programs.
    pub fn calibration(&self) -> Address {
        calibration_address(self.statics, self.output)
    }

    /// What a load case on the solids is made from.
    pub fn run(&self, case: &'a StudyScenario) -> SolidRunInput<'a> {
        SolidRunInput {
            pair: PairInput::of(self.statics),
            error_band: self.statics.wants_error_band(),
            solid: self.solid,
            damping: self.damping,
            case: &case.scenario,
            tables: &case.tables,
        }
    }
}

/// Address of the calibration of a pair, with its fields for other programs.
pub fn calibration_address(statics: Statics<'_>, output: &OutputKeys) -> Address {
    Address::of(Kind::Calibration, &(statics, output))
}

/// The pair as solids, without what is asked of it.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct PairInput<'a> {
    /// The rail.
    pub rail: &'a Rail,
    /// The wheel.
    pub wheel: &'a Wheel,
    /// Where the wheel is on the track.
    pub track: Track,
    /// The solid meshes.
    pub mesh: &'a MeshOptions,
    /// Whether the study gives the length of the contact window.
    pub window_given: bool,
    /// Formulation of the eight-node brick.
    pub element: ElementKey,
    /// Contact between the solids.
    pub contact: ContactSettings,
}

impl<'a> PairInput<'a> {
    /// That of the statics of a pair.
    pub fn of(statics: Statics<'a>) -> Self {
        let Statics { rail, wheel, track, mesh, window_given, element, contact, .. } = statics;
        Self { rail, wheel, track, mesh, window_given, element, contact }
    }
}

/// What a load case on the solids is made from.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SolidRunInput<'a> {
    /// The pair.
    #[serde(flatten)]
    pub pair: PairInput<'a>,
    /// Whether it is tried on other grids and meshes, which show its error.
    pub error_band: bool,
    /// The solid model in time.
    pub solid: &'a SolidKeys,
    /// Damping of both bodies, s.
    pub damping: f64,
    /// The load case.
    pub case: &'a Scenario,
    /// The files with tables of its forces.
    #[serde(skip_serializing_if = "<[FileRecord]>::is_empty")]
    pub tables: &'a [FileRecord],
}

impl SolidRunInput<'_> {
    /// Address of the run that begins with zones that reach so far.
    pub fn address(&self, reach: Reach) -> Address {
        Address::of(Kind::SolidRun, &(self, reach))
    }
}
