//! Places where the line of a profile crosses itself.

use nalgebra::{Point2, Vector2};

use super::finding::{Action, Finding, FindingKind, Findings};
use super::measured::MeasuredPoint;
use super::text::error_on;
use crate::error::Result;
use crate::units::MILLIMETRE;

/// Longest loop that is cut off, m; a longer one is no noise.
const LONGEST_LOOP: f64 = 5.0 * MILLIMETRE;
/// Cells along the length of the profile.
const CELLS: f64 = 4000.0;
/// Most pairs of chords that are compared.
const MOST_PAIRS: usize = 20_000_000;

/// Cuts off short loops.
///
/// # Errors
/// A long loop, or a line too tangled to be searched.
pub(super) fn cut_loops(
    name: &str,
    points: &mut Vec<MeasuredPoint>,
    findings: &mut Vec<Finding>,
) -> Result<()> {
    const MOST_LOOPS: usize = 200;
    let mut loops = Findings::new(findings, FindingKind::Loop);
    for _ in 0..MOST_LOOPS {
        let Some((i, j, crossing)) = first_crossing(name, points)? else {
            return Ok(());
        };
        let length: f64 = points[i + 1..=j].windows(2).map(|w| (w[1].point - w[0].point).norm()).sum::<f64>()
            + (points[i + 1].point - crossing).norm()
            + (points[j].point - crossing).norm();
        let lines = (points[i + 1].line, points[j].line);
        if length > LONGEST_LOOP {
            let value =
                format!("a loop of {:.2} mm back to line {}", length / MILLIMETRE, points[i + 1].line);
            return Err(error_on(
                name,
                points[j].line,
                &value,
                "a line that does not cross itself",
                "remove the loop, or sort the points along the profile",
            ));
        }
        loops.add(
            lines,
            (length / MILLIMETRE, "mm"),
            Action::Repaired,
            "the line crosses itself: the loop cut off",
        );
        let at = MeasuredPoint { point: crossing, ..points[i + 1] };
        points.splice(i + 1..=j, [at]);
    }
    Err(error_on(
        name,
        points[0].line,
        "many loops",
        "a line that does not cross itself",
        "sort the points along the profile, or smooth the measurement",
    ))
}

/// The crossing of two chords i < j whose second chord comes first, with the point.
///
/// # Errors
/// A line too tangled to be searched.
pub(super) fn first_crossing(
    name: &str,
    points: &[MeasuredPoint],
) -> Result<Option<(usize, usize, Point2<f64>)>> {
    // The first and the last chord of a closed line meet.
    let last = points.len() - 2;
    let closed = points[0].point == points[last + 1].point;
    let total: f64 = points.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum();
    let cell = total / CELLS;
    let index = |v: f64| (v / cell).floor() as i64;
    let mut entries: Vec<((i64, i64), usize)> = Vec::new();
    for (i, w) in points.windows(2).enumerate() {
        let chord = w[1].point - w[0].point;
        // Cells about points along the chord half a cell apart cover it.
        let parts = (2.0 * chord.norm() / cell).ceil().max(1.0) as usize;
        let first = entries.len();
        for k in 0..=parts {
            let p = w[0].point + chord * (k as f64 / parts as f64);
            for (dy, dz) in [(-0.25, -0.25), (-0.25, 0.25), (0.25, -0.25), (0.25, 0.25)] {
                entries.push(((index(p.x + dy * cell), index(p.y + dz * cell)), i));
            }
        }
        entries[first..].sort_unstable();
        let mut end = first;
        for k in first..entries.len() {
            if end == first || entries[k] != entries[end - 1] {
                entries[end] = entries[k];
                end += 1;
            }
        }
        entries.truncate(end);
    }
    entries.sort_unstable();
    let mut best: Option<(usize, usize, Point2<f64>)> = None;
    let mut pairs = 0;
    for group in entries.chunk_by(|a, b| a.0 == b.0) {
        pairs += group.len() * group.len() / 2;
        if pairs > MOST_PAIRS {
            return Err(error_on(
                name,
                points[0].line,
                "a tangle",
                "a line that can be followed",
                "the points lie too close and in no order: smooth or sort the measurement",
            ));
        }
        for (k, &(_, i)) in group.iter().enumerate() {
            for &(_, j) in &group[k + 1..] {
                if j < i + 2 || (closed && i == 0 && j == last) || best.is_some_and(|b| (b.1, b.0) <= (j, i))
                {
                    continue;
                }
                if let Some(p) =
                    crossing([points[i].point, points[i + 1].point], [points[j].point, points[j + 1].point])
                {
                    best = Some((i, j, p));
                }
            }
        }
    }
    Ok(best)
}

fn crossing(a: [Point2<f64>; 2], b: [Point2<f64>; 2]) -> Option<Point2<f64>> {
    let (u, v): (Vector2<f64>, Vector2<f64>) = (a[1] - a[0], b[1] - b[0]);
    let across = u.perp(&v);
    if across == 0.0 {
        return None;
    }
    let offset = b[0] - a[0];
    let (s, t) = (offset.perp(&v) / across, offset.perp(&u) / across);
    ((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)).then(|| a[0] + s * u)
}
