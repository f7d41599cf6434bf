//! Points of tangent stiffness against force, from which a law is made.

use railspring_profiles::error::{InputError, Result};

/// Fewer loads are no law: it has three constants, and their errors need one load more.
pub(crate) const LEAST_LOADS: usize = 4;

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
