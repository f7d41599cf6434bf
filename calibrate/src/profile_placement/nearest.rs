//! Which standards a measurement resembles.

use std::fmt;

use nalgebra::Point2;
use rayon::prelude::*;

use super::placed::{PlaceOptions, Placed, PlacedPoint, place};
use super::reference::Reference;
use crate::error::Result;
use crate::profile::rails::RAIL_NAMES;
use crate::profile::wheels::WHEEL_NAMES;
use crate::profile_file::{MeasuredProfile, ProfileKind, repaired};
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
    /// Root mean square of the distances from the standard over what wear leaves alone, m: the sides and corners of a rail's head without those of the side
    /// that is farther off, underside, web and foot; a wheel's flange back up to its tip, field end of the tread, chamfer and field face. `None` where nothing
    /// of that was measured.
    pub rms: Option<f64>,
    /// The measurement placed on it.
    pub placed: Placed,
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let off = |rms: f64| format!("{:.3} mm off what wear leaves alone", rms / MILLIMETRE);
        let off = self.rms.map_or_else(|| "nothing measured that wear leaves alone".into(), off);
        let size = self.placed.size;
        let size = if size.is_one() { String::new() } else { format!(", {:.3} times as large", size.factor) };
        write!(f, "{} ({off}{size})", self.name)
    }
}

/// The standards that a measured profile resembles, worn or not, the nearest first with their misfits; empty where it resembles none, or
/// cannot be repaired.
pub fn resembled(profile: &MeasuredProfile, kind: Option<ProfileKind>, options: PlaceOptions) -> Vec<Misfit> {
    /// Standards that a message names.
    const NAMED: usize = 3;
    let Ok(repaired) = repaired(profile, &mut Vec::new()) else { return Vec::new() };
    let points: Vec<Point2<f64>> = repaired.iter().map(|p| p.point).collect();
    let found = nearest(&points, kind, options).unwrap_or_default();
    found.into_iter().filter(|misfit| misfit.placed.fits()).take(NAMED).collect()
}

/// The same in words for messages: names with misfits, joined by commas.
pub fn in_words(misfits: &[Misfit]) -> String {
    misfits.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
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
                let rms = off_unworn(&reference, &placed);
                Misfit { name, kind, share, rms, placed }
            }))
        })
        .collect::<Result<Vec<Option<_>>>>()?
        .into_iter()
        .flatten()
        .collect::<Vec<_>>();
    found.sort_by(|a, b| a.share.total_cmp(&b.share));
    Ok(found)
}

/// Root mean square of the distances over what wear leaves alone, m.
fn off_unworn(reference: &Reference, placed: &Placed) -> Option<f64> {
    let of = |belongs: &dyn Fn(&PlacedPoint) -> bool| {
        let squares = placed.points.iter().filter(|p| reference.keeps(p.s) && belongs(p));
        squares.fold((0.0, 0), |(sum, count), p| (sum + p.missing.powi(2), count + 1))
    };
    let side = |p: &PlacedPoint| reference.kind == ProfileKind::Rail && reference.runs(p.s);
    let mean = |(sum, count): (f64, usize)| if count > 0 { sum / count as f64 } else { f64::INFINITY };
    let (body, gauge, field) =
        (of(&|p| !side(p)), of(&|p| side(p) && p.point.x < 0.0), of(&|p| side(p) && p.point.x >= 0.0));
    let better = if mean(gauge) < mean(field) { gauge } else { field };
    let (sum, count) = (body.0 + better.0, body.1 + better.1);
    (count > 0).then(|| mean((sum, count)).sqrt())
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
