//! What the horizontal stiffness of a pair is worth: how far it changes with the grid of the contact and with the meshes of the bodies, as the
//! laws do ([`super::error_band`]).

use super::bodies::{CondensedPair, ContactConditions};
use super::error_band::unless_interrupted;
use super::geometry::Pair;
use crate::calibration::{ContactField, HorizontalPoint, Reference, calibrate_horizontal};
use crate::error::Result;
use crate::monitor::Monitor;

/// Relative changes of a horizontal stiffness; a part that has not come to an answer says why.
#[derive(Debug, Clone)]
pub struct HorizontalChanges {
    /// At the smallest preload, with half the spacing of the grid; none for a contact on the nodes of the meshes. A larger patch has no
    /// fewer cells, and with friction a halved grid takes as long as a dozen loads.
    pub grid: Result<Option<f64>>,
    /// At every preload, with coarser meshes; none without them.
    pub meshes: Result<Option<Vec<f64>>>,
}

impl HorizontalChanges {
    /// Those of the `points` of a pair, which were found with the preloads in turn, against a `reference`.
    ///
    /// # Errors
    /// An interruption.
    pub fn new(
        pair: &Pair,
        bodies: &CondensedPair,
        coarser: Option<&CondensedPair>,
        (contact, reference): (ContactConditions, Reference),
        points: &[HorizontalPoint],
        monitor: &dyn Monitor,
    ) -> Result<Self> {
        let preloads: Vec<f64> = points.iter().map(|point| point.preload).collect();
        let changes = |bodies: &CondensedPair, field, preloads: &[f64]| -> Result<Vec<f64>> {
            let placed = bodies.wheel_on_rail(pair, reference, ContactConditions { field, ..contact })?;
            let found = calibrate_horizontal(&placed, preloads, monitor)?;
            match found.ended {
                Some(reason) => Err(reason),
                None => Ok(found
                    .points
                    .iter()
                    .zip(points)
                    .map(|(to, from)| to.stiffness / from.stiffness - 1.0)
                    .collect()),
            }
        };
        let on_grid = || -> Result<Option<f64>> {
            match contact.field {
                ContactField::Elements => Ok(None),
                _ => Ok(changes(bodies, ContactField::HybridHalved, &preloads[..preloads.len().min(1)])?
                    .first()
                    .copied()),
            }
        };
        let on_meshes = || coarser.map(|coarser| changes(coarser, contact.field, &preloads)).transpose();
        let (meshes, grid) = rayon::join(on_meshes, on_grid);
        Ok(Self { grid: unless_interrupted(grid)?, meshes: unless_interrupted(meshes)? })
    }

    /// Half the width of the band, relative: the sizes of the grid's change and of the largest of the meshes' together; none where a part has
    /// not come to an answer.
    pub fn band(&self) -> Option<f64> {
        let grid = self.grid.as_ref().ok()?.map_or(0.0, f64::abs);
        let meshes = self.meshes.as_ref().ok()?.iter().flatten();
        Some(grid + meshes.fold(0.0, |largest, change| f64::max(largest, change.abs())))
    }
}
