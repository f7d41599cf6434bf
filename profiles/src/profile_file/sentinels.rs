//! Rows that a scanner writes where it had no return: one value far off, repeated.

use std::collections::BTreeMap;

use super::check::{departure, median_step};
use super::finding::{Action, Finding, FindingKind, Findings};
use super::measured::MeasuredPoint;

/// Distance from the line of the neighbours from which a repeated value is none of the profile, as a part of the
/// extent and in median steps.
const FAR: f64 = 0.15;
const FAR_TO_STEP: f64 = 8.0;
/// Part of the values at either end that the extent leaves out.
const TRIMMED: f64 = 0.1;
/// Largest share of the rows that are dropped.
const MOST: f64 = 0.5;

/// Drops rows that repeat one value of y or of z exactly and lie far off the line of the rows about them.
pub(super) fn drop_sentinels(points: &mut Vec<MeasuredPoint>, findings: &mut Vec<Finding>) {
    let far = (FAR * trimmed_extent(points)).max(FAR_TO_STEP * median_step(points));
    let mut dropped = vec![false; points.len()];
    for axis in 0..2 {
        let mut groups: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for (i, p) in points.iter().enumerate() {
            groups.entry((p.point[axis] + 0.0).to_bits()).or_default().push(i);
        }
        for group in groups.values().filter(|group| group.len() > 1) {
            let off = far_runs(points, group, far);
            if off.len() > 1 {
                off.into_iter().for_each(|i| dropped[i] = true);
            }
        }
    }
    let count = dropped.iter().filter(|dropped| **dropped).count();
    if count == 0 || count as f64 > MOST * points.len() as f64 {
        return;
    }
    let lost: Vec<usize> = (0..points.len()).filter(|i| dropped[*i]).collect();
    let mut spikes = Findings::new(findings, FindingKind::Spike);
    for run in lost.chunk_by(|a, b| b - a == 1) {
        let [first, last] = [points[run[0]], points[run[run.len() - 1]]];
        let text = format!(
            "({}, {}), a value that several rows repeat, far off their neighbours, as where a scanner had no return: dropped",
            first.point.x, first.point.y
        );
        let rows = if run.len() == 1 { "row" } else { "rows" };
        spikes.add((first.line, last.line), (run.len() as f64, rows), Action::Repaired, &text);
    }
    drop(spikes);
    let mut dropped = dropped.into_iter();
    points.retain(|_| !dropped.next().unwrap_or(false));
}

/// The points of a group that are in runs far from the line between the points before and after the run.
fn far_runs(points: &[MeasuredPoint], group: &[usize], far: f64) -> Vec<usize> {
    let runs = group.chunk_by(|a, b| b - a == 1);
    let off = |i: usize, before: Option<usize>, after: Option<usize>| {
        let at = |i: usize| points[i].point;
        match (before, after) {
            (Some(a), Some(b)) => departure(at(a), at(i), at(b)) > far,
            (Some(a), None) | (None, Some(a)) => (at(i) - at(a)).norm() > far,
            (None, None) => false,
        }
    };
    runs.filter(|run| {
        let before = run[0].checked_sub(1);
        let after = Some(run[run.len() - 1] + 1).filter(|next| *next < points.len());
        // A flat part of the profile goes on from where the line before it ended.
        [run[0], run[run.len() - 1]].into_iter().all(|i| off(i, before, after))
    })
    .flatten()
    .copied()
    .collect()
}

fn trimmed_extent(points: &[MeasuredPoint]) -> f64 {
    let spread = |axis: usize| {
        let mut values: Vec<f64> = points.iter().map(|p| p.point[axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        let cut = (TRIMMED * values.len() as f64) as usize;
        values[values.len() - 1 - cut] - values[cut]
    };
    spread(0).hypot(spread(1))
}
