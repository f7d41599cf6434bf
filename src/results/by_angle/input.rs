//! What the laws by contact angle are made from.

use serde::Serialize;

use crate::engine::store::{Address, Kind};
use crate::results::bodies::reach::Reach;
use crate::study::{Statics, Study};

/// The statics of the pair, and at which shifts of the wheelset.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ByAngleInput<'a> {
    /// The statics of the pair.
    pub statics: Statics<'a>,
    /// Lateral shifts, m, ascending; `None` leaves them to the program.
    pub shifts: Option<&'a [f64]>,
    /// Modes of the condensed element; none where there is none.
    pub modes: Option<usize>,
}

impl<'a> ByAngleInput<'a> {
    /// That of a study.
    pub fn of(study: &'a Study) -> Self {
        let modes = study.wants_condensed().then(|| study.modes());
        Self { statics: study.statics().exact(), shifts: study.shifts.as_deref(), modes }
    }

    /// Address of the laws on bodies whose contact zones reach so far, as those of the calibration do in the end.
    pub fn address(&self, reach: Reach) -> Address {
        Address::of(Kind::ByAngle, &(self, reach))
    }
}
