//! Wheel and head of a study's pair as the lumped element has them, in SI units.

use railspring_profiles::error::{InputError, Result};
use railspring_simulate::element::condensed::parts::LumpedElement;

use crate::export::spring::plain;
use crate::export::surfaces::Surfaces;
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::springs::record::StiffnessRecord;
use crate::study::Study;

/// The lumped element of a pair.
pub(in crate::export) struct LumpedPair<'a> {
    /// The study, and its pair in place.
    pub surfaces: Surfaces<'a>,
    /// The element.
    pub element: LumpedElement,
    /// Damping over stiffness of rail and wheel, s.
    pub damping: [f64; 2],
    heading: String,
}

impl<'a> LumpedPair<'a> {
    /// The element of the laws by contact angle of a `study`; `purpose` says in the message what the study is needed for.
    ///
    /// # Errors
    /// [`InputError`] without the study or the element.
    pub fn of(
        study: Option<&'a Study>,
        purpose: &str,
        record: &StiffnessRecord,
        laws: &StiffnessByAngleRecord,
    ) -> Result<Self> {
        let surfaces = Surfaces::of(study, purpose)?;
        let study = surfaces.study;
        let lumped = laws.lumped.as_ref().ok_or_else(|| {
            let reason = laws.element_missing.as_deref().unwrap_or("the laws by contact angle have none");
            InputError::new(
                "stiffness_by_angle.json: lumped",
                "(missing)",
                format!("a lumped element: {reason}"),
                "calibrate again with a load case in the study, or with --set calibration.elements=true",
            )
        })?;
        Ok(Self {
            element: LumpedElement::from(lumped),
            damping: [&study.rail.material, &study.wheel.material]
                .map(|own| own.damped(study.damping).damping),
            heading: format!(
                "study {}, {}; calibration {} by railspring {}",
                study.name,
                record.pair.name,
                record.input_hash.get(..12).unwrap_or(&record.input_hash),
                record.version
            ),
            surfaces,
        })
    }

    /// Origin of the wheel's profile from the line of the rail's shear centres where the wheel just touches (y, z), m.
    pub fn wheel_origin(&self) -> [f64; 2] {
        let pair = &self.surfaces.geometry.pair;
        (pair.tape() - pair.node_line().coords).into()
    }

    /// What a file for a `program` says first, with what `further` it has to say.
    pub fn heading(&self, program: &str, further: &[&str]) -> Vec<String> {
        let what =
            format!("Lumped wheel on its rail for {program}, by railspring {}", env!("CARGO_PKG_VERSION"));
        [&*what, &*self.heading].iter().chain(further).map(|line| plain(line)).collect()
    }
}
