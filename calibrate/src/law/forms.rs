//! Laws of all forms fitted to the same solid, and how far each is off at each load.

use super::normal::NormalLaw;
use super::points::{Solid, check_solid};
use super::power::StiffnessLaw;
use super::series_fit::fit_series;
use super::steps_fit::{LEAST_LOADS_OF_STEPS, fit_steps};
use super::table::TableLaw;
use railspring_profiles::error::Result;

/// How far a law is from the solid at a load, each over the value of the solid there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawError {
    /// Load, N.
    pub force: f64,
    /// Of the tangent. A table has the tangents of the solid: it is the deviation of the table of the other loads, which tells what lies between
    /// them; none at the first and the last load.
    pub tangent: Option<f64>,
    /// Of the displacement, integrated from no load.
    pub displacement: f64,
}

/// A law of one form, and its errors.
#[derive(Debug, Clone, PartialEq)]
pub struct FormFit {
    /// The law.
    pub law: NormalLaw,
    /// By load, ascending.
    pub errors: Vec<LawError>,
}

/// Laws of all forms for the same solid: `power` is its law of the published form, fitted to the tangents as published; the others are
/// fitted to tangents and displacements. Without `steps` where there are fewer than eight loads.
///
/// # Errors
/// Those of the fits.
pub fn fit_forms(solid: &[Solid], power: StiffnessLaw) -> Result<Vec<FormFit>> {
    check_solid(solid)?;
    let mut laws: Vec<NormalLaw> = vec![power.into(), fit_series(solid)?.into()];
    if solid.len() >= LEAST_LOADS_OF_STEPS {
        laws.push(fit_steps(solid)?.into());
    }
    laws.push(TableLaw::of_solid(solid)?.into());
    Ok(laws.into_iter().map(|law| FormFit { errors: errors(&law, solid), law }).collect())
}

/// Errors of `law` at each load of the solid.
fn errors(law: &NormalLaw, solid: &[Solid]) -> Vec<LawError> {
    let left_out = match law {
        NormalLaw::Table(table) => Some(table.left_out()),
        _ => None,
    };
    let tangent = |i: usize, at: &Solid| match &left_out {
        Some(left_out) => left_out.get(i.checked_sub(1)?).copied(),
        None => Some(law.tangent(at.force) / at.tangent - 1.0),
    };
    let at = |(i, at): (usize, &Solid)| LawError {
        force: at.force,
        tangent: tangent(i, at),
        displacement: law.displacement(at.force) / at.displacement - 1.0,
    };
    solid.iter().enumerate().map(at).collect()
}

#[cfg(test)]
mod tests;
