//! Whether the mesh can carry the loads, checked before anything is meshed.

use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::field::InputField;
use railspring_calibrate::mesh::{SectionOutline, rail_outline, wheel_outline};
use railspring_calibrate::profile::ProfileCurve;
use railspring_calibrate::units::{KILONEWTON, MILLIMETRE};

use super::{Geometry, mesh_options};
use crate::study::Study;

/// Checks that the wheel touches within the fine zone of the tool's own meshes, and that the Hertz patch of the
/// largest load stays within it.
///
/// Where the bodies conform there is no Hertz patch; the contact solver then finds out.
///
/// # Errors
/// [`InputError`] with the field of the shift, if the first touch lies elsewhere; with the field of the loads, if the
/// patch is longer than the zone.
pub fn check_loads(study: &Study, geometry: &Geometry) -> Result<()> {
    check_touch(study, geometry)?;
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

/// Checks that the first touch lies within the fine zones: elsewhere no contact is looked for.
fn check_touch(study: &Study, geometry: &Geometry) -> Result<()> {
    let options = mesh_options(study);
    let outside = |outline: &SectionOutline, running: &ProfileCurve, s: f64, body: &str| {
        let (first, last) = (outline.fine.first()?.s, outline.fine.last()?.s);
        if first < s && s < last {
            return None;
        }
        let y = |s: f64| running.point(s).x / MILLIMETRE;
        Some(InputError::new(
            InputField::LateralShift,
            format!(
                "{} mm, at which the {body} is touched at y = {:.1} mm of its profile",
                study.track.lateral_shift / MILLIMETRE,
                y(s)
            ),
            format!(
                "a touch between y = {:.1} and {:.1} mm, in the fine zone of the mesh",
                y(first),
                y(last)
            ),
            "bring `lateral_shift` nearer to zero, or check `gauge` and `flange_back`",
        ))
    };
    let touch = &geometry.touch;
    let (rail, wheel) = (&geometry.rail, &geometry.wheel);
    if study.rail.mesh.is_none()
        && let Some(error) = outside(&rail_outline(rail, &options)?, &rail.running, touch.rail_s, "rail")
    {
        return Err(error.into());
    }
    if study.wheel.mesh.is_none()
        && let Some(error) = outside(&wheel_outline(wheel, &options)?, &wheel.running, touch.wheel_s, "wheel")
    {
        return Err(error.into());
    }
    Ok(())
}
