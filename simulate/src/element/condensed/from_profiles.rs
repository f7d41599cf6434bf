//! The condensed model of a pair from its profiles in one call.

use railspring_calibrate::pair::{
    AngleSettings, CondensedPair, FitOptions, Pair, PairBody, PressDirection, SeriesBeam, law_by_shift,
};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;

use super::fitted::fitted_element;
use super::model::CondensedModel;
use super::parts::{ElementBodies, PlaceApproaches};
use crate::solid::START_MODES;

/// Where and under which loads the contact element of a pair is fitted, and its rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementFit<'a> {
    /// Lateral shifts of the wheel at which it is pressed, m, positive to the field side. Between them the element
    /// interpolates: they cover what a run touches.
    pub shifts: &'a [f64],
    /// Loads along the contact normal, N, ascending, four or more.
    pub loads: &'a [f64],
    /// Number of elements of the rail's beam.
    pub rail_elements: usize,
}

impl CondensedModel {
    /// The model of a `pair` whose contact element is condensed from its solids.
    ///
    /// # Errors
    /// Meshes that the options do not allow, and those of [`Self::fit_on`].
    pub fn fit(
        pair: &Pair,
        at: &ElementFit<'_>,
        options: &FitOptions,
        monitor: &dyn Monitor,
    ) -> Result<Self> {
        let FitOptions { material, element, .. } = *options;
        let meshes = pair.mesh(options.rail_length, &options.mesh)?;
        let wanted = PairBody::of_pair(false);
        let bodies = meshes.condense_in_time(pair, wanted, material, element, START_MODES, monitor)?;
        Self::fit_on(pair, &bodies, at, options, monitor)
    }

    /// The same on `bodies` that were condensed with modes and the same options. Shifts at which two contacts with
    /// different normals carry the loads are left out of the fit: the element has both contacts from the others.
    ///
    /// # Errors
    /// Those of [`law_by_shift`]; the reason of a shift that has no law; bodies without modes; laws without a place.
    pub fn fit_on(
        pair: &Pair,
        bodies: &CondensedPair,
        at: &ElementFit<'_>,
        options: &FitOptions,
        monitor: &dyn Monitor,
    ) -> Result<Self> {
        let FitOptions { rail_length, material, contact, .. } = *options;
        let fixed_loads = at.loads.get(1..).unwrap_or_default();
        let direction = PressDirection::Normal;
        let settings = AngleSettings { contact, direction, loads: at.loads, fixed_loads, stresses: false };
        let tape_ys: Vec<f64> = at.shifts.iter().map(|shift| pair.tape_y + shift).collect();
        let mut places = Vec::new();
        for law in law_by_shift(pair, bodies, &settings, &tape_ys, monitor)? {
            places.extend(PlaceApproaches::of(&law));
            law.law?;
        }
        let beam = pair.beam(&material, rail_length, at.rail_elements)?;
        let parts = ElementBodies::new(pair, bodies, rail_length)?;
        let element = fitted_element(&parts, (&beam, [&material; 2]), places, contact.friction)?;
        let correction = SeriesBeam::new(pair, bodies, &beam)?.correction;
        Ok(Self::of_pair(pair, beam.corrected(&correction)?, [&material; 2], element))
    }
}
