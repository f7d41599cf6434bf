//! The springs of a record in SI units, as the simple model takes them.

use railspring_calibrate::law::NormalLaw;
use railspring_profiles::error::Result;
use railspring_profiles::units::KILONEWTON_PER_METRE;

use crate::results::run::make::Springs;
use crate::results::run::record::SpringsRecord;

/// The springs in SI units.
///
/// # Errors
/// [`InputError`](railspring_profiles::error::InputError) with key `law` for constants that are no law.
pub fn springs(record: &SpringsRecord) -> Result<Springs> {
    Ok(Springs {
        normal: NormalLaw::try_from(&record.law)?,
        horizontal: record.horizontal_kn_per_m * KILONEWTON_PER_METRE,
        wheel_mass: record.wheel_mass_kg,
        beam: record.beam.into(),
        element: record.element.as_deref().map(|element| (element.key(), element.into())),
    })
}
