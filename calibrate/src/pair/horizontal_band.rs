//! Error band of the horizontal stiffness of a pair: how far it changes with the meshes of the bodies. The grid of the contact hardly
//! concerns it: with half its spacing the horizontal stiffness of S1002 on 60E1 changes by 0.03 to 0.04 % on tread and gauge corner and by less on the
//! flange, with coarser meshes by 5 to 6 %.

use super::bodies::{CondensedPair, ContactConditions};
use super::geometry::Pair;
use crate::calibration::{HorizontalPoint, Reference, calibrate_horizontal};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;

/// Relative changes of the horizontal stiffness to `coarser` meshes at the `points` of a pair, which were found with their preloads in turn,
/// against a `reference`.
///
/// # Errors
/// Those of [`calibrate_horizontal`], and a contact that reaches the end of the coarser meshes' contact zone.
pub fn horizontal_changes(
    pair: &Pair,
    coarser: &CondensedPair,
    contact: ContactConditions,
    reference: Reference,
    points: &[HorizontalPoint],
    monitor: &dyn Monitor,
) -> Result<Vec<f64>> {
    let preloads: Vec<f64> = points.iter().map(|point| point.preload).collect();
    let placed = coarser.wheel_on_rail(pair, reference, contact)?;
    let found = calibrate_horizontal(&placed, &preloads, &[], monitor)?;
    match found.ended {
        Some(reason) => Err(reason),
        None => Ok(found
            .points
            .iter()
            .zip(points)
            .map(|(to, from)| to.stiffness / from.stiffness - 1.0)
            .collect()),
    }
}
