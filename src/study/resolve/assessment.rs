//! The section `validation` in SI units.

use std::path::Path;

use railspring_profiles::error::InputError;
use railspring_profiles::units::MILLIMETRE;

use crate::study::analysis::CalibrationSettings;
use crate::study::document::ValidationKeys;
use crate::study::force_curve::ForceCurve;
use crate::study::source::Source;

/// The measured curve that a study names; one beside loads that are wrong themselves is left to these.
pub(super) fn measured_curve(
    keys: &ValidationKeys,
    source: &Source,
    calibration: Option<&CalibrationSettings>,
) -> Result<Option<ForceCurve>, InputError> {
    let Some(file) = &keys.measured else {
        let alone = [
            (
                keys.standard_uncertainty_mm.map(|value| value.to_string()),
                "validation.standard_uncertainty_mm",
            ),
            (source.gives("validation.zero").then(|| "(given)".into()), "validation.zero"),
        ];
        let given = alone.into_iter().find_map(|(value, key)| Some((value?, key)));
        return given.map_or(Ok(None), |(value, key)| {
            let remedy = "the key belongs to a measured curve: give its file, or remove the key";
            Err(InputError::new(key, value, "validation.measured beside it", remedy))
        });
    };
    let ends = calibration.and_then(|of| Some([*of.loads.first()?, *of.loads.last()?]));
    let Some(loads) = ends else { return Ok(None) };
    let folder = source.path().parent().unwrap_or(Path::new(""));
    let uncertainty = keys.standard_uncertainty_mm.map(|mm| mm * MILLIMETRE);
    ForceCurve::read((folder, file), keys.zero, uncertainty, loads).map(Some)
}
