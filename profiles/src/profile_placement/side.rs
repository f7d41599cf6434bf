//! Which side of a rail's head is worn: that of the gauge.

use super::fit::Foot;
use super::reference::Reference;
use crate::profile::ProfileCurve;
use crate::profile_file::ProfileKind;
use crate::units::MILLIMETRE;

/// What tells left from right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Side {
    /// The outline itself: the flange of a wheel, a rail that is not symmetric.
    Outline,
    /// The head is worn deeper by this much (m, mean over side and corner) at one side, which is that of the gauge.
    Wear(f64),
    /// Neither side is worn more, or only one is measured: the side is as the file or the user has it.
    NotTold {
        /// Mean difference of the wear of the sides, m, where both are measured.
        difference: Option<f64>,
    },
}

/// Least difference of the wear that counts, m: twice the form tolerance of what is left of a rolled head's side.
const LEAST: f64 = 0.1 * MILLIMETRE;
/// Shortest part of a side on which wear is compared, m.
const SHORTEST: f64 = 5.0 * MILLIMETRE;
/// Wear beyond this counts as this, m.
const MOST: f64 = 10.0 * MILLIMETRE;

/// Mean depth of wear of the two sides of a head, gauge (y < 0) first; `None` for a side that is not measured.
pub(super) fn worn_sides(reference: &Reference, feet: &[Foot], lengths: &[f64]) -> [Option<f64>; 2] {
    let mut sums = [[0.0; 2]; 2];
    for (foot, length) in feet.iter().zip(lengths) {
        if reference.runs(foot.s) && reference.keeps(foot.s) {
            let side = usize::from(y(&reference.curve, foot.s) > 0.0);
            sums[side][0] += length;
            sums[side][1] += length * foot.missing.clamp(-MOST, MOST);
        }
    }
    sums.map(|[length, worn]| (length > SHORTEST).then(|| worn / length))
}

fn y(curve: &ProfileCurve, s: f64) -> f64 {
    curve.point(s).x
}

/// What the wear tells about the side, and whether the head has to be turned over for it.
pub(super) fn side_of(reference: &Reference, worn: [Option<f64>; 2], uncertainty: f64) -> (Side, bool) {
    if reference.kind == ProfileKind::Wheel || !reference.symmetric {
        return (Side::Outline, false);
    }
    let [Some(gauge), Some(field)] = worn else {
        return (Side::NotTold { difference: None }, false);
    };
    let difference = gauge - field;
    if difference.abs() > LEAST.max(5.0 * uncertainty) {
        (Side::Wear(difference.abs()), difference < 0.0)
    } else {
        (Side::NotTold { difference: Some(difference.abs()) }, false)
    }
}
