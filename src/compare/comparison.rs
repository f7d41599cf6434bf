//! The comparison of two results, against a reference that both have.

use railspring_profiles::error::{InputError, Result};
use serde::Serialize;

use super::rows::{self, Group, InputChange, LineChange};
use super::side::{About, Side};

/// Two results side by side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The first.
    pub a: About,
    /// The second.
    pub b: About,
    /// What displacements and tangents are measured against in both.
    pub reference: String,
    /// The most important, a sentence each.
    pub summary: Vec<String>,
    /// What could not be compared, a sentence each.
    pub not_compared: Vec<String>,
    /// Numbers in groups.
    pub groups: Vec<Group>,
    /// Lines of the verdicts, those of either.
    pub lines: Vec<LineChange>,
    /// Inputs that are not the same.
    pub inputs: Vec<InputChange>,
}

/// Compares two results.
///
/// # Errors
/// [`InputError`] where the two have no reference of the displacement in common.
pub fn compare(a: &Side, b: &Side) -> Result<Comparison> {
    let reference = common_reference(a, b)?;
    let groups = rows::groups(a, b, &reference);
    let (lines, inputs) = (rows::lines(a, b), rows::inputs(a, b));
    let not_compared = rows::not_compared(a, b, &reference);
    let summary = rows::summary(&groups, &lines, &inputs);
    Ok(Comparison { a: a.about(), b: b.about(), reference, summary, not_compared, groups, lines, inputs })
}

/// The reference in use of A where B has it, else one that both have.
fn common_reference(a: &Side, b: &Side) -> Result<String> {
    let own = |side: &Side| -> Vec<String> {
        side.stiffness.references.iter().map(|found| found.reference.clone()).collect()
    };
    let (first, second) = (own(a), own(b));
    let all = [a.stiffness.reference.clone(), b.stiffness.reference.clone()].into_iter().chain(first.clone());
    all.into_iter().find(|name| first.contains(name) && second.contains(name)).ok_or_else(|| {
        InputError::new(
            b.path.clone(),
            second.join(", "),
            format!("one of the references of {}: {}", a.path, first.join(", ")),
            "calibrate both against the same reference (`calibration.reference`)",
        )
        .into()
    })
}
