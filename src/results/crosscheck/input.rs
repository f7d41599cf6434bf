//! What a cross-check is made from.

use serde::Serialize;

use crate::engine::store::{Address, Kind};
use crate::hash::key;
use crate::results::bodies::input::{PairInput, SolidsInput};
use crate::study::{CalibrationSettings, FieldKey, ReferenceKey, Statics, Study};

/// The statics of a pair with a contact between the elements of its meshes, which is what other programs have; without what they are not asked for.
#[derive(Debug, Clone)]
pub struct CrosscheckInput<'a> {
    solids: SolidsInput<'a>,
    calibration: CalibrationSettings,
}

impl<'a> CrosscheckInput<'a> {
    /// That of a study.
    pub fn of(study: &'a Study) -> Self {
        let calibration =
            CalibrationSettings { error_band: false, foot_held: false, ..study.calibration.clone() };
        Self { solids: SolidsInput::of(study), calibration }
    }

    /// Name of the study.
    pub fn name(&self) -> &'a str {
        self.solids.name
    }

    /// The statics that other programs repeat.
    pub fn statics(&self) -> Statics<'_> {
        let own = self.solids.statics;
        let mut contact = own.contact;
        contact.field = FieldKey::Elements;
        Statics { contact, target_error: None, calibration: &self.calibration, ..own }
    }

    /// The same for what is said of their size.
    pub fn solids(&self) -> SolidsInput<'_> {
        SolidsInput { statics: self.statics(), ..self.solids }
    }

    /// Hash of all that the questions and the tool's answers depend on. What they do not depend on is no part of it, so that kept answers stay valid.
    pub fn key(&self) -> String {
        key(&self.questions())
    }

    fn questions(&self) -> Questions<'_> {
        let statics = self.statics();
        let CalibrationSettings { loads, horizontal_preloads, reference, .. } = statics.calibration;
        Questions { pair: PairInput::of(statics), loads, horizontal_preloads, reference: *reference }
    }

    /// Address of the answers of some programs to some questions.
    pub fn address(&self, cases: &[&str], versions: (String, &str, Option<&str>)) -> Address {
        Address::of(Kind::Crosscheck, &(self.questions(), cases, versions))
    }
}

/// What the questions and the tool's answers depend on.
#[derive(Serialize)]
struct Questions<'a> {
    #[serde(flatten)]
    pair: PairInput<'a>,
    loads: &'a [f64],
    /// Contact zones are as long as the largest of these loads asks for, too.
    horizontal_preloads: &'a [f64],
    reference: ReferenceKey,
}
