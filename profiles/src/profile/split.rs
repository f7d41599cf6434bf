//! Where the running surface of a closed outline begins and ends.

use std::ops::Range;

use nalgebra::Point2;

use super::segment::{Segment, polyline};
use crate::error::{Result, on_line};
use crate::units::MILLIMETRE;

/// Lateral part of the tangent from which the side of a head has turned under it: 30° beyond vertical.
const UNDER_HEAD: f64 = -0.5;
/// Lateral part of the direction of a flange back, at most: 1.7° from vertical.
const BACK: f64 = 0.03;
/// Lateral part of the direction from which a tread has turned into its chamfer or its field face, at most: 20°.
const TREAD: f64 = 0.94;
/// Least distance of a wheel's bore from its tape circle, m: a closed running surface alone has less.
const BODY: f64 = 60.0 * MILLIMETRE;
/// Step on arcs where an outline is looked at by points, m.
const STEP: f64 = 0.5 * MILLIMETRE;

/// Distance of the tape circle from the flange back in Europe, m, where a file or an outline does not say where it is.
pub(crate) const TAPE_CIRCLE_FROM_FLANGE_BACK: f64 = 70.0 * MILLIMETRE;

/// Where the tape circle of a wheel is, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Tape {
    /// At a lateral position.
    At(f64),
    /// At a distance from the flange back.
    FromBack(f64),
}

/// What a range of a ring has, which may go on beyond its last entry with the first.
pub(crate) fn of_ring<T: Copy>(ring: &[T], range: Range<usize>) -> Vec<T> {
    range.map(|i| ring[i % ring.len()]).collect()
}

/// The running surface and the rest of a closed section of a rail, as ranges in the ring of its segments: the head from where its
/// sides have not yet turned under it.
pub(crate) fn split_rail(
    name: &str,
    segments: &[Segment],
    line: usize,
) -> Result<(Range<usize>, Range<usize>)> {
    let n = segments.len();
    let height =
        |s: &Segment| [0.0, 0.5, 1.0].map(|t| s.point(t).y).into_iter().fold(f64::INFINITY, f64::min);
    let top = (0..n).min_by(|&a, &b| height(&segments[a]).total_cmp(&height(&segments[b]))).unwrap_or(0) + n;
    let ring = |i: usize| &segments[i % n];
    let end = (top..top + n).find(|&i| ring(i).tangent(1.0).x < UNDER_HEAD);
    let start = (top + 1 - n..=top).rev().find(|&i| ring(i).tangent(0.0).x < UNDER_HEAD);
    match (start, end) {
        (Some(start), Some(end)) if start < top && top < end && end - start - 1 < n => {
            Ok((start + 1..end, end..start + 1 + n))
        }
        _ => Err(on_line(
            name,
            line,
            "a closed outline without a head",
            "a section whose sides turn under a head above its web",
            "check the order of the rows, or give the head alone",
        )),
    }
}

/// The running surface and the rest of a closed section of a wheel, as ranges in the ring of its segments. These run over the tread to the field
/// side with the flange at the lower end. The running surface begins at the flange back, where the outline leaves the vertical. It goes over flange and
/// tread to where these turn into the chamfer or the field face.
pub(crate) fn split_wheel(
    name: &str,
    segments: &[Segment],
    tape: Tape,
    line: usize,
) -> Result<(Range<usize>, Range<usize>)> {
    let n = segments.len();
    let ring = |i: usize| &segments[i % n];
    let extreme = |s: &Segment, pick: fn(f64, f64) -> f64| {
        let heights = polyline(std::slice::from_ref(s), STEP).into_iter().map(|p: Point2<f64>| p.y);
        heights.reduce(pick).unwrap_or_default()
    };
    let deepest = |i: &usize| extreme(&segments[*i], f64::max);
    let tip = (0..n).max_by(|a, b| deepest(a).total_cmp(&deepest(b))).unwrap_or(0) + n;
    let start = (tip + 1 - n..=tip).rev().take_while(|&i| ring(i).tangent(0.5).x > BACK).last();
    let Some(start) = start else {
        let remedy = "the lower end of the outline is no flange: check that it is a wheel's section, with its axle along y";
        return Err(on_line(
            name,
            line,
            "a closed outline without a flange",
            "a flange that is round at its tip",
            remedy,
        ));
    };
    let tape = match tape {
        Tape::At(y) => y,
        Tape::FromBack(distance) => ring(start).start().x + distance,
    };
    let on_tread = (tip..start + n).find(|&i| ring(i).start().x <= tape && ring(i).end().x > tape);
    let turned = |i: &usize| ring(*i).tangent(0.0).x.min(ring(*i).tangent(1.0).x) < TREAD;
    let end = on_tread.filter(|i| !turned(i)).and_then(|first| (first..start + n).find(turned));
    let Some(end) = end else {
        let value = format!("no tread at y = {:.3} mm", tape / MILLIMETRE);
        let expected = "a running surface that passes the tape circle nearly level";
        return Err(on_line(
            name,
            line,
            &value,
            expected,
            "give the section of the whole wheel, its flange back upright",
        ));
    };
    let bore = (end..start + n).map(|i| extreme(ring(i), f64::min)).fold(f64::INFINITY, f64::min);
    let tread = ring(on_tread.unwrap_or(tip)).end().y;
    if tread - bore < BODY {
        let value = format!("a closed outline {:.2} mm deep below its tread", (tread - bore) / MILLIMETRE);
        let expected = "the body of a wheel below its tread: rim, web, hub and bore; or a running surface that is not closed";
        return Err(on_line(
            name,
            line,
            &value,
            expected,
            "give the whole section, or leave out what closes the running surface",
        ));
    }
    Ok((start..end, end..start + n))
}
