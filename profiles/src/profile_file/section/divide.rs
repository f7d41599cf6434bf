//! Outlines divided into their running surface and the rest.

use nalgebra::Point2;

use super::frame::Frame;
use super::outline::STEP;
use super::ring::runs_to_the_field_side;
use crate::error::Result;
use crate::profile::{Piece, ProfileCurve, ProfileKind, Segment};
use crate::profile_file::check::median_step;
use crate::profile_file::finding::Finding;
use crate::profile_file::kinks::find_kinks;
use crate::profile_file::measured::MeasuredPoint;
use crate::units::MILLIMETRE;

/// A chord this many times as long as a typical one on the running surface, and at least `LEAST_LONG`, is a straight side.
const LONG: f64 = 5.0;
/// m.
const LEAST_LONG: f64 = 1.0 * MILLIMETRE;

/// The lines and arcs of a drawing in the frame of their profile, run through to the field side; `ring` has the points of the drawing, and
/// has them in that frame afterwards.
pub(super) fn upright(
    kind: ProfileKind,
    drawn: &[(Segment, usize)],
    frame: &Frame,
    ring: &mut Vec<MeasuredPoint>,
) -> Vec<Segment> {
    *ring = frame.ring(ring);
    let segments = drawn.iter().map(|(segment, _)| frame.segment(segment));
    if runs_to_the_field_side(kind, ring) {
        segments.collect()
    } else {
        segments.rev().map(|segment| segment.reversed()).collect()
    }
}

/// The running surface through points around an outline, and straight lines along the rest; the points are run through to the field side.
/// `ends` finds the first and the last vertex of the running surface, counted from `n` points after the one where the body ends that has it: the top
/// of a rail, the tip of a wheel's flange.
pub(super) fn divided(
    kind: ProfileKind,
    ring: &mut [MeasuredPoint],
    ends: impl Fn(usize, &dyn Fn(usize) -> MeasuredPoint) -> Result<(usize, usize)>,
    findings: &mut Vec<Finding>,
) -> Result<(ProfileCurve, Vec<Segment>)> {
    if !runs_to_the_field_side(kind, ring) {
        ring.reverse();
    }
    let n = ring.len() - 1;
    let height = |a: &usize, b: &usize| ring[*a].point.y.total_cmp(&ring[*b].point.y);
    let from = match kind {
        ProfileKind::Rail => (0..n).min_by(height),
        ProfileKind::Wheel => (0..n).max_by(height),
    };
    let at = |i: usize| ring[(from.unwrap_or(0) + i) % n];
    let (first, last) = ends(n, &at)?;
    let surface: Vec<MeasuredPoint> = (first..=last).map(at).collect();
    let around: Vec<Point2<f64>> = (last..=first + n).map(|i| at(i).point).collect();
    let rest = around.windows(2).map(|pair| Segment::line(pair[0], pair[1])).collect();
    Ok((through(&surface, findings), rest))
}

/// The curve through the points of a running surface: splines, with straight lines where the points are far apart, and corners.
fn through(points: &[MeasuredPoint], findings: &mut Vec<Finding>) -> ProfileCurve {
    let chord = |i: usize| (points[i + 1].point - points[i].point).norm();
    let chords = points.len() - 1;
    let long = LEAST_LONG.max(LONG * median_step(points));
    let kinks = find_kinks(points, findings);
    let mut pieces = Vec::new();
    let mut from = 0;
    for i in 1..=chords {
        // A straight side is a separate piece.
        let ends = i == chords || kinks.contains(&i) || chord(i) > long || chord(i - 1) > long;
        if !ends {
            continue;
        }
        if i - from < 3 {
            let pairs = points[from..=i].windows(2);
            pieces.extend(pairs.map(|pair| Segment::line(pair[0].point, pair[1].point).piece(STEP)));
        } else {
            let points = points[from..=i].iter().map(|p| p.point).collect();
            pieces.push(Piece { points, end_tangents: None });
        }
        from = i;
    }
    ProfileCurve::from_pieces(pieces)
}
