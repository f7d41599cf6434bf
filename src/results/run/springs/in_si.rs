//! The springs of a record in SI units, as the simple model takes them.

use railspring_calibrate::law::{StiffnessLaw, TableLaw};
use railspring_profiles::error::Result;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE};
use railspring_simulate::element::condensed::parts::PairElement;

use crate::results::run::make::Springs;
use crate::results::run::record::SpringsRecord;

/// The springs in SI units.
///
/// # Errors
/// [`InputError`](railspring_profiles::error::InputError) with key `law` for constants that are no law.
pub fn springs(record: &SpringsRecord) -> Result<Springs> {
    let table = &record.table_kn_and_kn_per_m;
    let normal = if table.is_empty() {
        StiffnessLaw::try_from(record.law)?.into()
    } else {
        let (forces, tangents): (Vec<f64>, Vec<f64>) =
            table.iter().map(|[force, k]| (force * KILONEWTON, k * KILONEWTON_PER_METRE)).unzip();
        TableLaw::new(&forces, &tangents)?.into()
    };
    Ok(Springs {
        normal,
        horizontal: record.horizontal_kn_per_m * KILONEWTON_PER_METRE,
        wheel_mass: record.wheel_mass_kg,
        beam: record.beam.into(),
        element: record.element.as_deref().map(PairElement::from),
    })
}
