//! What springs have on steel wheels, so that a file in other units is noticed.

use railspring_calibrate::law::NormalLaw;
use railspring_profiles::error::Result;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE};

use crate::results::run::record::SpringsRecord;
use crate::results::springs::record::{StiffnessRecord, SubsurfaceRecord};
use crate::rounding::significant;

/// Load at which the tangent is looked at where no range is known, kN: a common wheel load.
const COMMON_KN: f64 = 60.0;
/// Tangent stiffness of steel wheels on rails, kN/m: 0.7e6 against the beam and 1.1e6 of the surfaces alone at 81 kN for common pairs, less under a tenth of the load or
/// on soft webs, more on conformal profiles.
const TANGENT: [f64; 2] = [2e5, 3e6];
/// Horizontal stiffness of sticking wheels, kN/m: 0.6e5 to 0.8e5 for common wheels, with half and double for soft and stiff webs.
const HORIZONTAL: [f64; 2] = [1e4, 1e6];
/// Mass of a wheel, kg: 300 to 400 for common ones.
const MASS: [f64; 2] = [100.0, 1500.0];

/// Largest pressure at a common wheel load, MPa: 900 to 1500 on treads, less on conformal profiles, several times as much on narrow edges.
const PRESSURE: [f64; 2] = [200.0, 6000.0];
/// Largest pressure over the largest shear stress below a patch: Hertz, between a line (3.33) and a circle (3.22).
const PRESSURE_OVER_SHEAR: f64 = 3.3;

/// What of springs is outside of what steel wheels have, a sentence each; `name` is the file, and `calibration` what they are from, if it is known.
///
/// # Errors
/// Those of constants that are no law.
pub(super) fn implausible(
    name: &str,
    record: &SpringsRecord,
    calibration: Option<&StiffnessRecord>,
) -> Result<Vec<String>> {
    let law = NormalLaw::try_from(&record.law)?;
    let [low, high] = record.range_kn.unwrap_or([0.0, f64::INFINITY]);
    let load = COMMON_KN.clamp(low, high);
    let tangent = law.tangent(load * KILONEWTON) / KILONEWTON_PER_METRE;
    let of = |what: String, value: f64, [least, most]: [f64; 2], unit: &str, check: &str| {
        (!(least..=most).contains(&value)).then(|| {
            format!(
                "{name}: {what} is {} {unit}; steel wheels have {least} to {most} {unit}: check {check}",
                significant(value, 3)
            )
        })
    };
    let tangent_of = format!("the tangent stiffness at {load} kN");
    let found = [
        of(tangent_of, tangent, TANGENT, "kN/m", "that the constants are in kN/m and the forces in kN"),
        of(
            "the horizontal stiffness".into(),
            record.horizontal_kn_per_m,
            HORIZONTAL,
            "kN/m",
            "that it is in kN/m",
        ),
        of("the mass of the wheel".into(), record.wheel_mass_kg, MASS, "kg", "that it is in kg"),
    ];
    let from_common = |at: &&SubsurfaceRecord| (at.force_kn / COMMON_KN).ln().abs();
    let stress = calibration
        .and_then(|of| of.subsurface.iter().min_by(|a, b| from_common(a).total_cmp(&from_common(b))));
    let pressure = stress.and_then(|at| {
        let what = format!("the largest pressure at {} kN, by the shear stress below it,", at.force_kn);
        of(what, PRESSURE_OVER_SHEAR * at.max_shear_mpa, PRESSURE, "MPa", "the profiles and the material")
    });
    Ok(found.into_iter().flatten().chain(pressure).collect())
}
