//! Two heads with a groove between them: crossings, grooved rails, rails with a check rail.
//!
//! Beside a running head lies the narrow keeper of a grooved rail, or the narrow head of a check rail, always on the gauge side. The groove and what
//! is beyond it is set aside. Two heads of like width are those of a crossing, of which none is the running head.

use std::collections::BTreeMap;

use super::measured::MeasuredPoint;
use crate::units::MILLIMETRE;

/// Least depth and least width at half of it of a groove, m.
const DEPTH: f64 = 10.0 * MILLIMETRE;
const WIDTH: f64 = 20.0 * MILLIMETRE;
/// Greatest width of a groove whose other side is set aside, m: flangeways have 36 to 45 mm, and the heads of grooved rails 55 mm.
const WIDEST: f64 = 52.0 * MILLIMETRE;
/// A head is at least this wide within `TOP` of its highest point, m; so is the floor of a groove above its lowest.
const HEAD: f64 = 8.0 * MILLIMETRE;
const TOP: f64 = 2.0 * MILLIMETRE;
/// Greatest width of a keeper, m (those of grooved rails have 13 to 21 mm), and as a part of that of the running head.
const KEEPER: f64 = 30.0 * MILLIMETRE;
const NARROWER: f64 = 0.6;
/// Cells in which the highest point counts, m.
const CELL: f64 = 0.5 * MILLIMETRE;
/// Part of the depth of a groove to which its side is the gauge face; below that it rounds into the floor.
const FACE: f64 = 0.7;
/// Greatest depth of a groove that is wide or ends at its floor, m: the foot of a rail lies deeper.
const DEEPEST: f64 = 80.0 * MILLIMETRE;

/// A groove between two heads, or beside one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Groove {
    /// At half its depth, m; none where its other side was not measured.
    pub width: Option<f64>,
    /// m.
    pub depth: f64,
    /// What lies in it and beyond it: points from this one on, or up to this one, in their order. None where neither head is the running one.
    beyond: Option<Beyond>,
}

/// One end of the points.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Beyond {
    /// The last point of the gauge face.
    last: usize,
    /// Whether the groove comes before it.
    before: bool,
    at_large_y: bool,
}

/// What was set aside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SetAside {
    /// First and last line of the file.
    pub lines: (usize, usize),
    /// Number of points.
    pub count: usize,
    /// Whether it lay at the end of large y.
    pub at_large_y: bool,
}

impl Groove {
    /// Leaves the running head alone; none, and nothing is done, where neither head is that.
    pub fn set_aside(&self, points: &mut Vec<MeasuredPoint>) -> Option<SetAside> {
        let Beyond { last, before, at_large_y } = self.beyond?;
        let dropped: Vec<MeasuredPoint> =
            if before { points.drain(..last).collect() } else { points.drain(last + 1..).collect() };
        let lines = dropped.iter().map(|p| p.line);
        let lines = (lines.clone().min()?, lines.max()?);
        Some(SetAside { lines, count: dropped.len(), at_large_y })
    }
}

/// A groove between two heads, whichever way z counts.
pub(super) fn groove(points: &[MeasuredPoint]) -> Option<Groove> {
    let found = [1.0, -1.0].map(|up| between(points, up));
    match found {
        [Some(one), Some(other)] => Some(if other.beyond.is_some() { other } else { one }),
        [one, other] => one.or(other),
    }
}

/// A groove beside the head of a rail that was not measured beyond its floor; `up` is 1 where z counts upwards, and -1.
pub(super) fn open_groove(points: &[MeasuredPoint], up: f64) -> Option<Groove> {
    let top = highest(points, up, |_| true)?;
    let height = |p: &MeasuredPoint| up * p.point.y;
    let at_end = |before: bool| {
        let outer = if before { &points[..top] } else { &points[top + 1..] };
        let floor = outer.iter().map(height).fold(f64::INFINITY, f64::min);
        let depth = height(&points[top]) - floor;
        if !(DEPTH..=DEEPEST).contains(&depth) {
            return None;
        }
        let face = |p: &MeasuredPoint| height(p) > height(&points[top]) - FACE * depth;
        let last = if before { points.iter().position(face)? } else { points.iter().rposition(face)? };
        let tail = if before { &points[..last] } else { &points[last + 1..] };
        let flat = tail.iter().filter(|p| height(p) < floor + TOP).map(|p| p.point.x);
        let (low, high) = flat.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
        let (top, face) = (points[top].point.x, points[last].point.x);
        let at_large_y = face > top;
        // The underside of a head runs back under it.
        let outwards = if at_large_y { low >= face } else { high <= face };
        let beyond = Some(Beyond { last, before, at_large_y });
        (outwards && high - low >= HEAD).then_some(Groove { width: None, depth, beyond })
    };
    // At both ends it is the foot of a low rail.
    match [true, false].map(at_end) {
        [one, None] => one,
        [None, other] => other,
        _ => None,
    }
}

/// The highest of some points.
fn highest(points: &[MeasuredPoint], up: f64, of: impl Fn(&MeasuredPoint) -> bool) -> Option<usize> {
    let height = |i: &usize| up * points[*i].point.y;
    (0..points.len()).filter(|i| of(&points[*i])).max_by(|a, b| height(a).total_cmp(&height(b)))
}

fn between(points: &[MeasuredPoint], up: f64) -> Option<Groove> {
    // What is seen from above: the points of a steep side lie beside each other in no order.
    let mut seen: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
    for (y, height) in points.iter().map(|p| (p.point.x, up * p.point.y)) {
        let highest = seen.entry((y / CELL).floor() as i64).or_insert((y, height));
        if height > highest.1 {
            *highest = (y, height);
        }
    }
    let heights: Vec<(f64, f64)> = seen.into_values().collect();
    let n = heights.len();
    let higher = |a: usize, b: usize| if heights[b].1 > heights[a].1 { b } else { a };
    let mut left = vec![0; n];
    let mut right = vec![n - 1; n];
    for i in 1..n {
        left[i] = higher(left[i - 1], i);
        right[n - 1 - i] = higher(right[n - i], n - 1 - i);
    }
    let depth = |i: usize| heights[left[i]].1.min(heights[right[i]].1) - heights[i].1;
    let deepest = (0..n).max_by(|&a, &b| depth(a).total_cmp(&depth(b)))?;
    let depth = depth(deepest);
    // A part of the profile that is off alone is as narrow as its points.
    let level = heights[deepest].1 + 0.5 * depth;
    let start = (0..deepest).rev().find(|&i| heights[i].1 > level)?;
    let end = (deepest..n).find(|&i| heights[i].1 > level)?;
    let width = heights[end].0 - heights[start].0;
    let is_head = |top: usize| {
        let range = heights.iter().filter(|p| p.1 > heights[top].1 - TOP).map(|p| p.0);
        // The other head may be as high.
        let own = range.filter(|y| (*y < heights[deepest].0) == (heights[top].0 < heights[deepest].0));
        let (low, high) = own.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
        high - low >= HEAD
    };
    // Deep and wide it is a head turned over, between the two sides of its foot.
    let foot = depth > DEEPEST && width > WIDEST;
    if foot || depth < DEPTH || width < WIDTH || !is_head(left[deepest]) || !is_head(right[deepest]) {
        return None;
    }
    let middle = heights[deepest].0;
    let outer = |from: usize, to: usize| heights[to].0 - heights[from].0;
    let above = |i: &usize| heights[*i].1 > level;
    let widths = [outer((0..n).find(above)?, start), outer(end, (0..n).rev().find(above)?)];
    let at_large_y = widths[0] > widths[1];
    let narrow = widths[0].min(widths[1]);
    let alone = width <= WIDEST && narrow <= KEEPER && narrow <= NARROWER * widths[0].max(widths[1]);
    let beyond = alone.then(|| beyond(points, up, middle, heights[deepest].1, at_large_y)).flatten();
    Some(Groove { width: Some(width), depth, beyond })
}

/// Where the running head ends, which lies on the other side of the groove's middle than the keeper; none if the points do not run through head, groove
/// and keeper one after the other.
fn beyond(points: &[MeasuredPoint], up: f64, middle: f64, floor: f64, at_large_y: bool) -> Option<Beyond> {
    let running = |p: &MeasuredPoint| (p.point.x < middle) == at_large_y;
    let top = up * points[highest(points, up, running)?].point.y;
    let face = |p: &MeasuredPoint| running(p) && up * p.point.y > top - FACE * (top - floor);
    let ends = [points.iter().position(face)?, points.iter().rposition(face)?];
    // Beyond one of its ends there is the other side of the groove.
    let other = |part: &[MeasuredPoint]| part.iter().any(|p| !running(p));
    let [before, after] = [other(&points[..ends[0]]), other(&points[ends[1] + 1..])];
    if before == after || other(&points[ends[0]..=ends[1]]) {
        return None;
    }
    Some(Beyond { last: if before { ends[0] } else { ends[1] }, before, at_large_y })
}

#[cfg(test)]
mod tests;
