//! Real corners in the scatter of a measurement, which turn less from point to point than the scatter does.
//!
//! On either side of a point a parabola is laid through its neighbours over the length of the waves that smoothing halves; it
//! follows arcs. A corner is where the two meet within a step of the point, turned by more than six standard deviations
//! of their directions, and neither is farther from its points than the scatter explains. A joint of two arcs within that
//! length turns its parabola by less than a tenth of the length times the change of curvature: by 0.02 rad a millimetre between
//! 300 or 80 mm and 13 mm, which a corner has to exceed. Among points 0.25 mm apart that scatter by 2 µm corners from 4° on are found, by
//! 10 µm from 5° on.

use nalgebra::{Point2, Vector2};

use super::finding::{Action, Finding, FindingKind, Findings};
use super::measured::MeasuredPoint;
use super::scatter::Scatter;
use crate::parabola::Parabola;
use crate::units::MILLIMETRE;

/// Fewest points of a parabola.
const FEWEST: usize = 6;
/// Longest parabola, m: the shortest arcs of running surfaces turn by 15° on it.
const LONGEST: f64 = 4.0 * MILLIMETRE;
/// Turn of a corner, in standard deviations of the turn.
const SURE: f64 = 6.0;
/// Turn that a joint of arcs may seem to have, rad per metre of the parabola.
const BY_JOINT: f64 = 20.0;
/// Distance of the corner from its point, in steps.
const NEAR: f64 = 1.0;

/// A parabola on one side of a point: height (m) and slope there, the slope's standard deviation for points that
/// scatter by one metre, and the root mean square of what it leaves, m.
struct Side {
    height: f64,
    slope: f64,
    unsure: f64,
    left: f64,
}

/// A corner: the index of its point, its turn in standard deviations, and the turn itself, rad.
struct Corner {
    at: usize,
    sure: f64,
    turn: f64,
}

/// Adds to `kinks` the corners in a `scatter` of which waves of the length `wavelength` (m) are to be halved.
pub(super) fn add_corners(
    points: &[MeasuredPoint],
    kinks: &mut Vec<usize>,
    scatter: &Scatter,
    wavelength: f64,
    findings: &mut Vec<Finding>,
) {
    let n = FEWEST.max((wavelength.min(LONGEST) / scatter.step).ceil() as usize);
    let mut candidates: Vec<Corner> = Vec::new();
    for i in n..points.len().saturating_sub(n) {
        if let Some(corner) = corner(&points[i - n..=i + n], n, scatter) {
            candidates.push(Corner { at: i + corner.at - n, ..corner });
        }
    }
    candidates.sort_by(|a, b| b.sure.total_cmp(&a.sure).then(a.at.cmp(&b.at)));
    let mut found: Vec<(usize, f64)> = Vec::new();
    for Corner { at: i, turn, .. } in candidates {
        let apart = |j: usize| j.abs_diff(i) > n;
        if found.iter().all(|f| apart(f.0)) && kinks.iter().all(|&j| apart(j)) {
            found.push((i, turn));
        }
    }
    found.sort_unstable_by_key(|f| f.0);
    let mut said = Findings::new(findings, FindingKind::Kink);
    for &(i, turn) in &found {
        let line = points[i].line;
        said.add(
            (line, line),
            (turn.to_degrees(), "degrees"),
            Action::Noted,
            "a real corner in the scatter: kept as one",
        );
    }
    kinks.extend(found.iter().map(|f| f.0));
    kinks.sort_unstable();
}

/// The corner about the middle one of `2n + 1` points, if there is one.
fn corner(points: &[MeasuredPoint], n: usize, scatter: &Scatter) -> Option<Corner> {
    let here = points[n].point;
    let chord = points[2 * n].point - points[0].point;
    let length = chord.norm();
    let place = |p: &MeasuredPoint| {
        let d = p.point - here;
        Point2::new(d.dot(&chord) / length, chord.perp(&d) / length)
    };
    let side = |points: &[MeasuredPoint]| parabola(&points.iter().map(place).collect::<Vec<_>>());
    let (before, after) = (side(&points[..n])?, side(&points[n + 1..])?);
    let turn = after.slope.atan() - before.slope.atan();
    let deviation = scatter.deviation * before.unsure.hypot(after.unsure);
    // The spread of a root mean square of n - 3 values, twice.
    let explained = scatter.deviation * (1.0 + 2.0 / ((n - 3) as f64).sqrt());
    let meet = (before.height - after.height) / (after.slope - before.slope);
    let is_one = turn.abs() > (SURE * deviation).max(BY_JOINT * n as f64 * scatter.step)
        && before.left.max(after.left) < explained
        && meet.abs() < NEAR * scatter.step;
    // The parabolas meet nearer to another one of the points, as may be.
    let distance = |i: &usize| (place(&points[*i]).x - meet).abs();
    let at = (n - 1..=n + 1).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    is_one.then(|| Corner { at, sure: turn.abs() / deviation, turn })
}

/// The parabola through points by least squares; `None` for points on top of each other.
fn parabola(points: &[Point2<f64>]) -> Option<Side> {
    let extent = points.iter().map(|p| p.x.abs()).fold(0.0, f64::max);
    let samples = points.iter().map(|p| (p.x / extent, 1.0, Vector2::new(p.y, 0.0)));
    let found = Parabola::through(samples)?;
    let squares: f64 = points.iter().map(|p| (p.y - found.at(p.x / extent).x).powi(2)).sum();
    let left = (squares / (points.len() - 3) as f64).sqrt();
    let [height, slope] = [0, 1].map(|i| found.coefficients[(i, 0)]);
    let side = Side { height, slope: slope / extent, unsure: found.slope_deviation() / extent, left };
    (side.slope.is_finite() && side.unsure.is_finite() && left.is_finite()).then_some(side)
}
