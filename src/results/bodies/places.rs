//! Places across the track and loads of the laws by contact angle.

use railspring_calibrate::pair::{Pair, loads_in_turn, spread};
use railspring_profiles::units::MILLIMETRE;

use crate::study::Statics;

/// Loads of the calibration that are put on beside the fixed ones, at most: with all 24 of them laws, displacements and tangents are the same but
/// for a small part of their error bands (docs/laws.md).
const LOADS_BESIDE: usize = 6;

/// Loads of the laws of a study, N, ascending: some of its calibration, and the fixed ones within their range.
pub fn loads_by_angle(statics: Statics<'_>) -> Vec<f64> {
    let of_calibration = &statics.calibration.loads;
    let some = spread(of_calibration.len(), LOADS_BESIDE).into_iter().map(|load| of_calibration[load]);
    loads_in_turn(&some.collect::<Vec<f64>>(), &statics.calibration.fixed_loads)
}

/// World position of the tape circle at a shift of the wheelset, m.
pub fn tape_y(statics: Statics<'_>, pair: &Pair, shift: f64) -> f64 {
    pair.tape_y + (shift - statics.track.lateral_shift)
}

/// The shifts of the laws by contact angle, m, ascending: those that are `given`, or else that of its track and places on tread, gauge corner and flange. The tread is
/// where the contact angle stays below 10°; the flange where it reaches 95 % of its largest, and the corner lies between. Where the contact jumps from
/// one to the other, a place shortly before that is among them.
pub fn shifts(statics: Statics<'_>, given: Option<&[f64]>, pair: &Pair) -> Vec<f64> {
    if let Some(shifts) = given {
        return shifts.to_vec();
    }
    const TREAD: f64 = 10.0;
    const FLANGE: f64 = 0.95;
    // tread by 2 mm; corner and flange by half a millimetre, at most so many places
    const ON_CORNER: usize = 4;
    const ON_FLANGE: usize = 2;
    let angle = |shift: f64| {
        let touch = pair.with_wheel_at(tape_y(statics, pair, shift)).ok()?.touch;
        Some((shift, touch.contact_angle.to_degrees()))
    };
    let tread = (-2..=4).map(|n| f64::from(n) * 2.0 * MILLIMETRE).filter_map(angle);
    let mut chosen: Vec<f64> =
        tread.filter(|(_, angle)| angle.abs() < TREAD).map(|(shift, _)| shift).collect();
    let beyond: Vec<(f64, f64)> =
        (1..=40).map(|n| f64::from(n) * 0.5 * MILLIMETRE).filter_map(angle).collect();
    let steepest = beyond.iter().map(|(_, angle)| *angle).fold(0.0, f64::max);
    if steepest >= TREAD {
        let first = beyond.iter().position(|(_, angle)| *angle >= FLANGE * steepest).unwrap_or(beyond.len());
        let corner: Vec<f64> =
            beyond[..first].iter().filter(|(_, angle)| *angle >= TREAD).map(|(shift, _)| *shift).collect();
        let every = corner.len().div_ceil(ON_CORNER).max(1);
        chosen.extend(corner.into_iter().step_by(every));
        chosen.extend(beyond[first..].iter().take(ON_FLANGE).map(|(shift, _)| *shift));
        chosen.extend(before_jump(angle, beyond[..first].last(), beyond.get(first)));
    }
    chosen.push(statics.track.lateral_shift);
    chosen.sort_by(f64::total_cmp);
    chosen.dedup_by(|a, b| (*a - *b).abs() < 1e-3 * MILLIMETRE);
    chosen
}

/// A shift (m) between the last place on the corner and the first on the flange (m and degrees), from which the contact has not yet jumped.
fn before_jump(
    angle: impl Fn(f64) -> Option<(f64, f64)>,
    corner: Option<&(f64, f64)>,
    flange: Option<&(f64, f64)>,
) -> Option<f64> {
    const JUMP: f64 = 15.0;
    // four fifths of the way, in whole parts of a metre
    const PARTS: f64 = 1e5;
    let (first, mut low, mut high) = (*corner?, *corner?, *flange?);
    for _ in 0..10 {
        let middle = angle(0.5 * (low.0 + high.0))?;
        if middle.1 < 0.5 * (low.1 + high.1) { low = middle } else { high = middle }
    }
    let shift = ((first.0 + 0.8 * (low.0 - first.0)) * PARTS).floor() / PARTS;
    (high.1 - low.1 > JUMP && shift * PARTS > first.0 * PARTS + 0.5).then_some(shift)
}
