//! Where the rows of a table meet: halves unfolded, gaps, the order of the outline.

use nalgebra::Point2;

use super::rows::{LARGEST_ARC, LARGEST_GAP, Piece};
use crate::error::{Result, on_line};
use crate::profile::kind::ProfileKind;
use crate::profile::segment::{Segment, polyline};
use crate::profile::sketch::{OF_THE_PROFILE, Sketch};
use crate::units::MILLIMETRE;

/// Largest step of the samples of the curve, m.
pub(super) const STEP: f64 = 0.1 * MILLIMETRE;

/// Where two segments of a table meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Lines of the file of the two segments.
    pub lines: (usize, usize),
    /// Where they meet, m.
    pub point: Point2<f64>,
    /// Distance of their ends, m; both were moved half of it.
    pub gap: f64,
    /// Angle between their directions, rad, positive from y towards z.
    pub turn: f64,
}

/// The whole from the half y >= 0: what meets the axis at right angles becomes one piece with its mirror image.
pub(super) fn unfold(name: &str, half: &[Piece]) -> Result<Vec<Piece>> {
    let (first, last) = (&half[0], &half[half.len() - 1]);
    if first.start.x.abs() > LARGEST_GAP {
        let value = format!("y = {:.4} mm", first.start.x / MILLIMETRE);
        let remedy = "begin on the axis, or leave `# symmetric: yes` out";
        return Err(on_line(
            name,
            first.line,
            value,
            "the half of a symmetric profile to begin at y = 0",
            remedy,
        ));
    }
    // Whether a piece goes on as its own mirror image at the axis; a merged arc must not be too long to tell its way.
    let level = |piece: &Piece, off_axis: Point2<f64>, on_axis: Point2<f64>| match piece.arc {
        None => (off_axis.y - on_axis.y).abs() < LARGEST_GAP,
        Some((centre, radius)) => {
            centre.x.abs() < LARGEST_GAP && off_axis.x.abs() < radius * (0.5 * LARGEST_ARC).to_radians().sin()
        }
    };
    let on_axis = |p: Point2<f64>| Point2::new(0.0, p.y);
    let (mut right, mut crown) = (half.to_vec(), None);
    if level(first, first.end, first.start) {
        crown = Some(Piece { start: Point2::new(-first.end.x, first.end.y), ..*first });
        right.remove(0);
    } else {
        right[0].start = on_axis(first.start);
    }
    let mut bottom = None;
    if last.end.x.abs() < LARGEST_GAP && half.len() > 1 {
        let at_end = right.len() - 1;
        if level(last, last.start, last.end) {
            bottom = Some(Piece { end: Point2::new(-last.start.x, last.start.y), ..*last });
            right.remove(at_end);
        } else {
            right[at_end].end = on_axis(last.end);
        }
    }
    let left = right.iter().rev().map(|piece| piece.mirrored().reversed());
    // A closed outline begins anywhere: the left half stands before the crown in both cases.
    let mut whole: Vec<Piece> = bottom.into_iter().chain(left).chain(crown).collect();
    whole.extend(right);
    Ok(whole)
}

pub(super) fn is_closed(pieces: &[Piece]) -> bool {
    let (first, last) = (&pieces[0], &pieces[pieces.len() - 1]);
    pieces.len() > 2 && (last.end - first.start).norm() <= LARGEST_GAP
}

/// Refuses ends that do not meet; the parts of the line and all such steps are put into `drawn`.
pub(super) fn check_joints(name: &str, pieces: &[Piece], drawn: &mut Sketch) -> Result<()> {
    let gap = |pair: &[Piece]| (pair[1].start - pair[0].end).norm();
    let parts = pieces.chunk_by(|before, after| (after.start - before.end).norm() <= LARGEST_GAP);
    let stroke = |part: &[Piece]| {
        let segments: Vec<Segment> = part.iter().map(|piece| piece.between(piece.start, piece.end)).collect();
        polyline(&segments, STEP)
    };
    drawn.draw(parts.map(stroke).collect(), OF_THE_PROFILE);
    for pair in pieces.windows(2).filter(|pair| gap(pair) > LARGEST_GAP) {
        let size = gap(pair) / MILLIMETRE;
        let fault = format!("a step of {size:.3} mm from line {} to line {}", pair[0].line, pair[1].line);
        drawn.mark(nalgebra::center(&pair[0].end, &pair[1].start), fault);
    }
    for pair in pieces.windows(2) {
        let gap = gap(pair);
        if gap > LARGEST_GAP {
            let place = |p: Point2<f64>| format!("({:.4}, {:.4})", p.x / MILLIMETRE, p.y / MILLIMETRE);
            let value = format!(
                "a gap of {:.4} mm: line {} ends at {}, line {} begins at {} mm (y to the field side, z down)",
                gap / MILLIMETRE,
                pair[0].line,
                place(pair[0].end),
                pair[1].line,
                place(pair[1].start)
            );
            let remedy =
                "put the rows in the order of the outline, each beginning where the one before it ends";
            return Err(on_line(name, pair[1].line, value, "ends that meet within 0.01 mm", remedy));
        }
    }
    Ok(())
}

/// Turns the order round where it runs from the field side; a closed outline runs along its running surface to the field side.
pub(super) fn put_in_order(pieces: &mut Vec<Piece>, kind: ProfileKind, closed: bool) {
    let forward = if closed {
        // The body lies below a rail's running surface and above a wheel's.
        let turns = pieces.iter().map(|p| p.start.coords.perp(&p.end.coords)).sum::<f64>();
        (turns > 0.0) == (kind == ProfileKind::Rail)
    } else {
        pieces[0].start.x < pieces[pieces.len() - 1].end.x
    };
    if !forward {
        *pieces = pieces.iter().rev().map(Piece::reversed).collect();
    }
}

/// The segments with their ends moved together, and what there was at the joints.
pub(super) fn join(pieces: &[Piece], closed: bool) -> (Vec<Segment>, Vec<Joint>) {
    let n = pieces.len();
    let met = |before: &Piece, after: &Piece| nalgebra::center(&before.end, &after.start);
    let end_of = |i: usize| match i + 1 {
        next if next < n => met(&pieces[i], &pieces[next]),
        _ if closed => met(&pieces[i], &pieces[0]),
        _ => pieces[i].end,
    };
    let start_of = |i: usize| match i {
        0 if closed => end_of(n - 1),
        0 => pieces[0].start,
        _ => end_of(i - 1),
    };
    let segments: Vec<Segment> = (0..n).map(|i| pieces[i].between(start_of(i), end_of(i))).collect();
    let joints = (0..if closed { n } else { n - 1 })
        .map(|i| {
            let (before, after) = (i, (i + 1) % n);
            let (into, out) = (segments[before].tangent(1.0), segments[after].tangent(0.0));
            Joint {
                lines: (pieces[before].line, pieces[after].line),
                point: end_of(i),
                gap: (pieces[after].start - pieces[before].end).norm(),
                turn: into.perp(&out).atan2(into.dot(&out)),
            }
        })
        .collect();
    (segments, joints)
}
