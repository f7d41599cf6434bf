//! The contact element alone, without the beam and the load case of a run: what other programs get.

use railspring_calibrate::beam::SectionModes;
use railspring_element::element::{About, Element, RailMode, RailModes};
use railspring_element::wheel::positive;
use railspring_profiles::error::Result;

use super::model::CondensedModel;
use crate::element::published::RailSupport;

impl CondensedModel {
    /// The element with a coefficient of `friction`; the rail as a wheel at `place` (m from its first end) feels it has the modes of its beam up to a frequency `highest`, Hz.
    ///
    /// # Errors
    /// [`railspring_profiles::error::NumericsError`] for a beam without mass.
    pub fn alone(&self, about: About, friction: f64, place: f64, highest: f64) -> Result<Element> {
        let rail_at_wheel = match &self.support {
            RailSupport::Rigid => None,
            RailSupport::Beam { beam, damping, .. } => {
                let SectionModes { modes, rest } = beam.modes_at(place, highest)?;
                let modes = modes.iter().map(|mode| RailMode { square: mode.square, section: mode.section });
                Some(RailModes { place, damping: *damping, modes: modes.collect(), rest })
            }
        };
        Ok(Element {
            about,
            rail: self.rail.clone(),
            wheel_profile: self.wheel.clone(),
            tape: self.tape,
            node_line: self.support.reference(&self.rail),
            wheel: self.element.wheel.clone(),
            damping: self.damping,
            head: self.head(),
            head_on_section: positive(self.element.head),
            strips: self.element.strips.clone(),
            friction,
            rail_at_wheel,
        })
    }
}
