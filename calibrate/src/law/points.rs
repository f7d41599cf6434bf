//! Points of tangent stiffness against force, from which a law is made.

use railspring_profiles::error::{InputError, Result};

/// Fewer loads are no law: it has three constants, and their errors need one load more.
pub const LEAST_LOADS: usize = 4;

/// Refuses points from which no law can be made.
pub(super) fn check_points(forces: &[f64], stiffness: &[f64]) -> Result<()> {
    if forces.len() != stiffness.len() {
        return InputError::refuse(
            "law.points",
            format!("{} forces, {} stiffnesses", forces.len(), stiffness.len()),
            "one stiffness a force",
            "give lists of equal length",
        );
    }
    if forces.len() < LEAST_LOADS {
        return InputError::refuse(
            "law.points",
            forces.len(),
            "at least 4 points for the three constants and their errors",
            "calibrate at more loads",
        );
    }
    for (name, values) in [("force", forces), ("stiffness", stiffness)] {
        if let Some((i, v)) = values.iter().enumerate().find(|(_, v)| !(v.is_finite() && **v > 0.0)) {
            return InputError::refuse(
                format!("law.points[{i}].{name}"),
                v,
                "a positive, finite value",
                "leave out the point or repair the load step it came from",
            );
        }
    }
    Ok(())
}

/// The solid at one load: what laws of all forms are fitted to and measured by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// Force, N.
    pub force: f64,
    /// Tangent stiffness, N/m.
    pub tangent: f64,
    /// Displacement, m.
    pub displacement: f64,
}

/// Refuses points of the solid from which no law can be made.
pub(super) fn check_solid(solid: &[Solid]) -> Result<()> {
    let column = |value: fn(&Solid) -> f64| solid.iter().map(value).collect::<Vec<_>>();
    let forces = column(|at| at.force);
    check_points(&forces, &column(|at| at.tangent))?;
    ascending(&forces)?;
    if let Some((i, at)) =
        solid.iter().enumerate().find(|(_, at)| !(at.displacement.is_finite() && at.displacement > 0.0))
    {
        return InputError::refuse(
            format!("law.points[{i}].displacement"),
            at.displacement,
            "a positive, finite value",
            "leave out the point or repair the load step it came from",
        );
    }
    Ok(())
}

/// Refuses forces that do not ascend.
pub(super) fn ascending(forces: &[f64]) -> Result<()> {
    let Some(i) = (1..forces.len()).find(|&i| !(forces[i] > forces[i - 1])) else { return Ok(()) };
    InputError::refuse(
        format!("law.points[{i}].force"),
        forces[i],
        format!("a force above the one before, {} N", forces[i - 1]),
        "sort the points and remove doubles",
    )
}
