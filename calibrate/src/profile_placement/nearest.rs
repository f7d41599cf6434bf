//! Which standards a measurement resembles.

use nalgebra::Point2;
use rayon::prelude::*;

use super::placed::{PlaceOptions, Placed, place};
use super::reference::Reference;
use crate::error::Result;
use crate::profile::rails::RAIL_NAMES;
use crate::profile::wheels::WHEEL_NAMES;
use crate::profile_file::ProfileKind;
use crate::units::MILLIMETRE;

/// Scale on which the misfit is measured, m.
const SCALE: f64 = 0.1 * MILLIMETRE;

/// How a standard fits a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Name of the standard.
    pub name: &'static str,
    /// Rail or wheel.
    pub kind: ProfileKind,
    /// Share of the profile, 0 to 1, that does not lie on the standard: worn or not explained at all.
    pub share: f64,
    /// The measurement placed on it.
    pub placed: Placed,
}

/// The standards by their misfit, the nearest first; of one kind if `kind` is given.
///
/// # Errors
/// As [`place`].
pub fn nearest(
    points: &[Point2<f64>],
    kind: Option<ProfileKind>,
    options: PlaceOptions,
) -> Result<Vec<Misfit>> {
    let rails = RAIL_NAMES.iter().map(|&name| (name, ProfileKind::Rail));
    let wheels = WHEEL_NAMES.iter().map(|&name| (name, ProfileKind::Wheel));
    let standards: Vec<_> = rails.chain(wheels).filter(|(_, k)| kind.is_none_or(|kind| kind == *k)).collect();
    let mut found = standards
        .into_par_iter()
        .map(|(name, kind)| {
            let reference = Reference::standard(name)?;
            let placed = place(points, &reference, options)?;
            Ok(placed.map(|placed| {
                let share = misfit(&reference, &placed);
                Misfit { name, kind, share, placed }
            }))
        })
        .collect::<Result<Vec<Option<_>>>>()?
        .into_iter()
        .flatten()
        .collect::<Vec<_>>();
    found.sort_by(|a, b| a.share.total_cmp(&b.share));
    Ok(found)
}

/// Share of the points off the standard; a little off counts a little, material beyond the standard four times.
fn misfit(reference: &Reference, placed: &Placed) -> f64 {
    let off = |missing: f64, runs: bool| {
        let factor = if runs && missing < 0.0 { 4.0 } else { 1.0 };
        let square = factor * (missing / SCALE).powi(2);
        square / (1.0 + square)
    };
    let sum: f64 = placed.points.iter().map(|p| off(p.missing, reference.runs(p.s))).sum();
    sum / placed.points.len() as f64
}
