//! The contact element of a study as a file that other programs compute with.

use std::collections::BTreeMap;

use railspring_element::element::{About, Element};
use railspring_element::pair_element::PairElement;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::KILONEWTON;
use railspring_simulate::element::condensed::CondensedModel;
use railspring_simulate::element::condensed::parts::LumpedElement;

use super::lumped::HIGHEST;
use super::surfaces::Surfaces;
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::springs::record::StiffnessRecord;
use crate::study::{ContactElementKey, Study};
use crate::version;

/// Friction of a study without a load case: a dry rail.
const DRY: f64 = 0.5;

/// The condensed or the lumped element of a study's springs; `place` is that of the first load case, or the middle of the rail.
///
/// # Errors
/// [`InputError`] where the laws by contact angle have no such element, and for the published one, which has no file.
pub fn element(
    study: &Study,
    stiffness: &StiffnessRecord,
    laws: &StiffnessByAngleRecord,
    kind: ContactElementKey,
) -> Result<Element> {
    let missing = || {
        let reason = laws.element_missing.as_deref().unwrap_or("the laws by contact angle have none");
        InputError::new(
            "calibration.shifts_mm",
            "laws without an element",
            format!("a {} element: {reason}", kind.name()),
            "leave shifts_mm out, or give places with one contact each",
        )
    };
    let (pair, strips_error, hub) = match kind {
        ContactElementKey::Published => {
            let remedy =
                "take condensed or lumped; the published one is in stiffness.json, for `railspring export`";
            return InputError::refuse("--element", kind.name(), "an element of the solids", remedy);
        }
        ContactElementKey::Condensed => {
            let record = laws.element.as_ref().ok_or_else(missing)?;
            let hub = record.displacement.as_ref().map(|hub| hub.max_rel_error);
            (PairElement::from(record), record.strips_max_rel_error, hub)
        }
        ContactElementKey::Lumped => {
            let record = laws.lumped.as_ref().ok_or_else(missing)?;
            let hub = record.displacement.as_ref().map(|hub| hub.max_rel_error);
            (PairElement::from(&LumpedElement::from(record)), record.strips_max_rel_error, hub)
        }
    };
    let Surfaces { geometry, .. } = Surfaces::of(Some(study), "the element needs its pair")?;
    let damped = [&study.rail.material, &study.wheel.material].map(|own| own.damped(study.damping));
    let beam = geometry.pair.beam(&study.rail.material, study.rail.length, study.simulation.rail_elements)?;
    let beam = beam.corrected(&stiffness.beam.factors.into())?;
    let case = study.scenarios.values().next().map(|case| &case.scenario);
    let place = case.and_then(|case| case.start_x).unwrap_or(0.5 * beam.length());
    let model = CondensedModel::of_pair(&geometry.pair, beam, damped.each_ref(), pair);
    let loads = laws.shifts.iter().flat_map(|shift| &shift.laws);
    let about = About {
        study: study.name.clone(),
        pair: stiffness.pair.name.clone(),
        element: kind.name().into(),
        program: format!("railspring {}", version::FULL),
        inputs: BTreeMap::from([
            ("stiffness.json".into(), stiffness.input_hash.clone()),
            ("stiffness_by_angle.json".into(), laws.input_hash.clone()),
        ]),
        largest_force_n: loads.map(|law| law.law.range_kn[1] * KILONEWTON).fold(0.0, f64::max),
        strips_max_rel_error: strips_error,
        hub_max_rel_error: hub,
    };
    model.alone(about, case.map_or(DRY, |case| case.friction), place, HIGHEST)
}
