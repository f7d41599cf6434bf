//! Two heads with a groove between them: crossings, grooved rails, rails with a check rail.

use super::MeasuredPoint;
use crate::units::MILLIMETRE;

/// Least depth and least width at half of it of a groove, m.
const DEPTH: f64 = 10.0 * MILLIMETRE;
const WIDTH: f64 = 20.0 * MILLIMETRE;
/// A head is at least this wide within `TOP` of its highest point, m.
const HEAD: f64 = 8.0 * MILLIMETRE;
const TOP: f64 = 2.0 * MILLIMETRE;

/// Width at half its depth and depth (m) of a groove between two heads, whichever way z counts.
pub(super) fn groove(points: &[MeasuredPoint]) -> Option<(f64, f64)> {
    let mut places: Vec<(f64, f64)> = points.iter().map(|p| (p.point.x, p.point.y)).collect();
    places.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    [1.0, -1.0].into_iter().find_map(|up| {
        let heights: Vec<(f64, f64)> = places.iter().map(|(y, z)| (*y, up * z)).collect();
        between(&heights)
    })
}

fn between(heights: &[(f64, f64)]) -> Option<(f64, f64)> {
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
    (depth >= DEPTH && width >= WIDTH && is_head(left[deepest]) && is_head(right[deepest]))
        .then_some((width, depth))
}
