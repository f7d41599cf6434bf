//! Whether the mesh can carry the loads, checked before anything is meshed.

use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::field::InputField;
use railspring_calibrate::units::{KILONEWTON, MILLIMETRE};

use super::Geometry;
use crate::study::Study;

/// Checks that the Hertz patch of the largest load stays within the fine zone of the mesh.
///
/// Where the bodies conform there is no Hertz patch; the contact solver then finds out.
///
/// # Errors
/// [`InputError`] with the field of the loads, if the patch is longer than the zone.
pub fn check_loads(study: &Study, geometry: &Geometry) -> Result<()> {
    let [along, across] = geometry.relative_radii();
    let settings = &study.calibration;
    let largest = |loads: &[f64]| loads.iter().copied().fold(0.0, f64::max);
    for (field, load) in [
        (InputField::Loads, largest(&settings.loads)),
        (InputField::HorizontalPreloads, largest(&settings.horizontal_preloads)),
    ] {
        let Ok(patch) = point_contact(load, along, across, study.material.contact_modulus()) else {
            continue;
        };
        if patch.semi_axis_x > study.mesh.window_half_length {
            return Err(InputError::new(
                field,
                format!("{:.1} kN", load / KILONEWTON),
                format!(
                    "loads whose contact patch fits the fine zone of \u{b1}{} mm along the track; this one is about \u{b1}{:.1} mm long",
                    study.mesh.window_half_length / MILLIMETRE,
                    patch.semi_axis_x / MILLIMETRE
                ),
                "lower the load, or enlarge `window_half_length`",
            )
            .into());
        }
    }
    Ok(())
}
