//! The section `uncertainty` in SI units.

use railspring_profiles::units::MILLIMETRE;

use crate::study::analysis::UncertaintySettings;
use crate::study::document::UncertaintyKeys;

/// The uncertainties in SI units; `measured` are the profiles, of rail and wheel.
pub(super) fn uncertainty(keys: &UncertaintyKeys, measured: [bool; 2]) -> UncertaintySettings {
    /// Turn of a measured profile, degrees, and its form, µm.
    const OF_MEASURED: [f64; 2] = [0.1, 7.5];
    const MICROMETRE: f64 = 1e-3 * MILLIMETRE;
    let of = |given: [Option<f64>; 2], of_measured: f64| {
        [0, 1].map(|body| given[body].unwrap_or(if measured[body] { of_measured } else { 0.0 }))
    };
    let [roll, form] = OF_MEASURED;
    UncertaintySettings {
        samples: keys.samples,
        lateral: keys.lateral_mm * MILLIMETRE,
        gauge: keys.gauge_mm * MILLIMETRE,
        flange_back: keys.flange_back_mm * MILLIMETRE,
        inclination: keys.inclination_deg.to_radians(),
        roll: of([keys.rail_roll_deg, keys.wheel_roll_deg], roll).map(f64::to_radians),
        form: of([keys.rail_form_um, keys.wheel_form_um], form).map(|um| um * MICROMETRE),
        form_wavelength: keys.form_wavelength_mm * MILLIMETRE,
        tape_diameter: keys.tape_diameter_mm * MILLIMETRE,
        friction: keys.friction,
        young: 1e-2 * keys.young_percent,
        poisson: keys.poisson,
    }
}
