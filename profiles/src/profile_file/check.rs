//! Order along the profile: duplicates, scattered points, steps back, spikes.

use nalgebra::{Point2, Vector2};

use super::finding::{Action, Finding, FindingKind, Findings};
use super::measured::MeasuredPoint;
use super::text::error_on;
use crate::error::Result;
use crate::units::MILLIMETRE;

/// Points closer than this are one point, m.
const SAME_POINT: f64 = 1e-4 * MILLIMETRE;
/// Turn from which a line steps back, degrees.
const STEP_BACK: f64 = 150.0;
/// Longest overlap of stitched scans, m.
const LONGEST_OVERLAP: f64 = 0.02;
/// Turn into and out of a spike, degrees.
const SPIKE_TURN: f64 = 30.0;
/// Most points of a spike.
const SPIKE_POINTS: usize = 3;
/// A smaller departure is no spike, m.
const SMALLEST_SPIKE: f64 = 0.02 * MILLIMETRE;
/// A spike departs by this many times the usual departure from the neighbours' chord.
const SPIKE_TO_SCATTER: f64 = 8.0;

/// Removes points on top of their predecessor.
pub(super) fn remove_duplicates(points: &mut Vec<MeasuredPoint>, findings: &mut Vec<Finding>) {
    let mut duplicates = Findings::new(findings, FindingKind::Duplicate);
    let mut last: Option<MeasuredPoint> = None;
    points.retain(|p| {
        if let Some(before) = last {
            let distance = (p.point - before.point).norm();
            if distance < SAME_POINT {
                let value = (distance / MILLIMETRE, "mm");
                duplicates.add(
                    (before.line, p.line),
                    value,
                    Action::Repaired,
                    "on top of each other: the later dropped",
                );
                return false;
            }
        }
        last = Some(*p);
        true
    });
}

/// Points of an evenly thinned profile by which the order is checked.
const ORDER_SAMPLE: usize = 2000;
/// Ratio of the length of the line to its extent above which the points lie in no order: a rail head has 2.
const SCATTERED: f64 = 4.0;
/// Most points that are put in order.
const MOST_ORDERED: usize = 5000;

fn scattered(points: &[MeasuredPoint]) -> bool {
    let step = points.len().div_ceil(ORDER_SAMPLE);
    let sample: Vec<Point2<f64>> = points.iter().step_by(step).map(|p| p.point).collect();
    length(&sample) > SCATTERED * extent(&sample)
}

fn length_of(points: &[MeasuredPoint]) -> f64 {
    points.windows(2).map(|pair| (pair[1].point - pair[0].point).norm()).sum()
}

fn length(points: &[Point2<f64>]) -> f64 {
    points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

fn extent(points: &[Point2<f64>]) -> f64 {
    let (low, high) = points.iter().fold((points[0], points[0]), |(low, high), p| (low.inf(p), high.sup(p)));
    (high - low).norm()
}

/// Puts scattered points in the order of nearest neighbours.
///
/// # Errors
/// Points that have no such order, or too many of them.
pub(super) fn restore_order(
    name: &str,
    points: &mut Vec<MeasuredPoint>,
    findings: &mut Vec<Finding>,
) -> Result<()> {
    if !scattered(points) {
        return Ok(());
    }
    let longest = (1..points.len())
        .max_by(|&i, &j| step(points, i).total_cmp(&step(points, j)))
        .map_or(1, |i| points[i].line);
    let refuse = |remedy: &str| {
        error_on(name, longest, "a long step", "points in their order along one profile", remedy)
    };
    if points.len() > MOST_ORDERED {
        return Err(refuse("the points lie in no order and are too many to be put in one: sort them"));
    }
    // From anywhere the chain ends at an end of the profile; from there it runs along the whole.
    let there = chain(points, 0);
    let mut order = chain(points, there[there.len() - 1]);
    if points[order[0]].point.x > points[order[order.len() - 1]].point.x {
        order.reverse();
    }
    let moved = order.iter().enumerate().filter(|(at, from)| at != *from).count();
    *points = order.iter().map(|&i| points[i]).collect();
    if scattered(points) {
        return Err(refuse("the points lie in no order: sort them along the profile"));
    }
    let (first, last) = points.iter().fold((usize::MAX, 0), |(a, b), p| (a.min(p.line), b.max(p.line)));
    findings.push(
        Finding::new(
            FindingKind::OutOfOrder,
            Action::Repaired,
            "points in no order: put in that of nearest neighbours",
        )
        .on_lines(first, last)
        .with_value(moved as f64, "points"),
    );
    Ok(())
}

fn step(points: &[MeasuredPoint], i: usize) -> f64 {
    (points[i].point - points[i - 1].point).norm()
}

/// Indices of the points, each followed by its nearest one not yet taken.
fn chain(points: &[MeasuredPoint], start: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut at = start;
    let mut order = Vec::with_capacity(points.len());
    loop {
        order.push(at);
        left.retain(|&i| i != at);
        let here = points[at].point;
        let distance = |i: usize| (points[i].point - here).norm_squared();
        match left.iter().copied().min_by(|&i, &j| distance(i).total_cmp(&distance(j)).then(i.cmp(&j))) {
            Some(next) => at = next,
            None => return order,
        }
    }
}

/// Signed turn of the line at a point, degrees.
pub(super) fn turn(before: Vector2<f64>, after: Vector2<f64>) -> f64 {
    before.perp(&after).atan2(before.dot(&after)).to_degrees()
}

fn turn_at(points: &[MeasuredPoint], i: usize) -> f64 {
    turn(points[i].point - points[i - 1].point, points[i + 1].point - points[i].point)
}

/// Repairs steps back: a short one, where two points have changed places, by the mean of the two; a long one, where
/// scans overlap, by dropping the later scan up to the end of the earlier.
pub(super) fn repair_steps_back(points: &mut Vec<MeasuredPoint>, findings: &mut Vec<Finding>) {
    const MOST_PASSES: usize = 50;
    let mut zigzags = Findings::new(findings, FindingKind::ZigZag);
    let short = 3.0 * median_step(points);
    for _ in 0..MOST_PASSES {
        let mut repaired: Vec<MeasuredPoint> = Vec::with_capacity(points.len());
        let mut changed = false;
        let mut i = 0;
        while i < points.len() {
            let back = i >= 1 && i + 2 < points.len() && turn_at(points, i).abs() > STEP_BACK;
            if !back {
                repaired.push(points[i]);
                i += 1;
                continue;
            }
            let (before, last, next) = (points[i - 1], points[i], points[i + 1]);
            let distance = (next.point - last.point).norm();
            let returns = turn_at(points, i + 1).abs() > STEP_BACK;
            let forward = last.point - before.point;
            if distance <= short && returns {
                let value = (distance / MILLIMETRE, "mm");
                let text = "two points in the wrong order: replaced by their mean";
                zigzags.add((last.line, next.line), value, Action::Repaired, text);
                repaired.push(MeasuredPoint { point: nalgebra::center(&last.point, &next.point), ..last });
                i += 2;
                changed = true;
                continue;
            }
            // The first point of the later scan that lies beyond the end of the earlier one.
            let mut travelled = 0.0;
            let mut beyond = i + 1;
            while beyond < points.len() && travelled < 2.0 * LONGEST_OVERLAP {
                if (points[beyond].point - last.point).dot(&forward) > 0.0 {
                    break;
                }
                travelled += step(points, beyond);
                beyond += 1;
            }
            repaired.push(last);
            if distance <= LONGEST_OVERLAP && beyond < points.len() && travelled < 2.0 * LONGEST_OVERLAP {
                let value = (distance / MILLIMETRE, "mm");
                let text = "a step back, as from overlapping scans: the later points dropped up to where it was left";
                zigzags.add((next.line, points[beyond - 1].line), value, Action::Repaired, text);
                i = beyond;
                changed = true;
            } else {
                i += 1;
            }
        }
        *points = repaired;
        if !changed {
            break;
        }
    }
    for i in 1..points.len().saturating_sub(1) {
        if turn_at(points, i).abs() > STEP_BACK {
            let value = (turn_at(points, i).abs(), "degrees");
            let text = "the line turns back on itself: could not be repaired";
            zigzags.add((points[i].line, points[i + 1].line), value, Action::Left, text);
        }
    }
}

pub(super) fn median_step(points: &[MeasuredPoint]) -> f64 {
    median((1..points.len()).map(|i| step(points, i)).collect())
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Distance of `p` from the straight line between `a` and `b`.
pub(super) fn departure(a: Point2<f64>, p: Point2<f64>, b: Point2<f64>) -> f64 {
    let chord = b - a;
    let t = ((p - a).dot(&chord) / chord.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (p - (a + t * chord)).norm()
}

/// Removes up to three neighbouring points that jut out of a line which runs on straight without them.
pub(super) fn remove_spikes(points: &mut Vec<MeasuredPoint>, findings: &mut Vec<Finding>) {
    /// How straight the line runs on without the spike, degrees.
    const STRAIGHT_ON: f64 = 20.0;
    /// What scatter may add to that: so many times its ratio to the step, and at most this, degrees.
    const SCATTER_TO_TURN: f64 = 5.0;
    const MOST_BY_SCATTER: f64 = 40.0;
    /// Ratio of the way over the points to that without them from which they lead astray: no arc that runs on
    /// as straight has more than 1.1.
    const DETOUR: f64 = 1.6;
    /// How far such points lie off the line at least, in steps of it.
    const ASTRAY: f64 = 0.3;
    if points.len() < 6 {
        return;
    }
    let scatter = median(points.windows(3).map(|w| departure(w[0].point, w[1].point, w[2].point)).collect());
    let least = SMALLEST_SPIKE.max(SPIKE_TO_SCATTER * scatter);
    let mut spikes = Findings::new(findings, FindingKind::Spike);
    for _ in 0..2 {
        trim_start(points, &mut spikes);
        points.reverse();
    }
    let mut kept: Vec<MeasuredPoint> = points[..2].to_vec();
    let mut i = 2;
    while i < points.len() {
        let [before, a] = [kept[kept.len() - 2].point, kept[kept.len() - 1].point];
        let run = (1..=SPIKE_POINTS).find(|&m| {
            let Some(([first, last], [b, after])) = points
                .get(i..i + m + 2)
                .map(|w| ([w[0].point, w[m - 1].point], [w[m].point, w[m + 1].point]))
            else {
                return false;
            };
            let (into, out) = (turn(a - before, first - a), turn(b - last, after - b));
            let height = points[i..i + m].iter().map(|p| departure(a, p.point, b)).fold(0.0, f64::max);
            let shortest = (a - before).norm().min((after - b).norm());
            let by_scatter = (SCATTER_TO_TURN * scatter / shortest).to_degrees().min(MOST_BY_SCATTER);
            let straight = turn(a - before, b - a).abs() < STRAIGHT_ON + by_scatter
                && turn(b - a, after - b).abs() < STRAIGHT_ON + by_scatter;
            let juts = into.abs() > SPIKE_TURN && out.abs() > SPIKE_TURN && into * out > 0.0;
            let way = (first - a).norm() + length_of(&points[i..i + m]) + (b - last).norm();
            let chord = (b - a).norm();
            // Two points that have changed places lie on the line, if not between the same neighbours.
            let sides = [(before, a), (a, b), (b, after)];
            let off = |p| sides.iter().map(|(q, r)| departure(*q, p, *r)).fold(f64::INFINITY, f64::min);
            let nearest = off(first).min(off(last));
            let astray = way > DETOUR * chord && nearest > least.max(ASTRAY * chord / (m + 1) as f64);
            (juts || astray) && straight && height > least
        });
        match run {
            Some(m) => {
                let height = points[i..i + m]
                    .iter()
                    .map(|p| departure(a, p.point, points[i + m].point))
                    .fold(0.0, f64::max);
                let lines = (points[i].line, points[i + m - 1].line);
                spikes.add(
                    lines,
                    (height / MILLIMETRE, "mm"),
                    Action::Repaired,
                    "off the line of its neighbours: dropped",
                );
                i += m;
            }
            None => {
                kept.push(points[i]);
                i += 1;
            }
        }
    }
    drop(spikes);
    *points = kept;
}

/// Drops up to two first points from which the line goes on by a long step or back: no neighbour shows that they are spikes.
fn trim_start(points: &mut Vec<MeasuredPoint>, spikes: &mut Findings<'_>) {
    /// A step so many times the usual one is long.
    const LONG: f64 = 3.0;
    /// Turn after a long step, and after any, degrees.
    const AFTER_LONG: f64 = 30.0;
    const AFTER_ANY: f64 = 60.0;
    const MOST: usize = 2;
    let usual = median_step(points);
    let astray = |i: usize| {
        let step = (points[i + 1].point - points[i].point).norm();
        // The direction over two steps: a single one scatters.
        let turn =
            turn(points[i + 1].point - points[i].point, points[i + 3].point - points[i + 1].point).abs();
        turn > AFTER_ANY || (turn > AFTER_LONG && step > LONG * usual)
    };
    if points.len() < MOST + 8 {
        return;
    }
    let Some(last) = (0..MOST).rev().find(|&i| astray(i)) else { return };
    let ahead = |from: usize, to: usize| points[to].point - points[from].point;
    // Of the two, the second one alone may be the one that is off. Along a steep side steps are longer than usual.
    let long = LONG * usual.max(ahead(2, 3).norm());
    if ahead(1, 2).norm() > long
        && ahead(0, 2).norm() < long
        && turn(ahead(0, 2), ahead(2, 4)).abs() < AFTER_LONG
    {
        let off = points.remove(1);
        let step = (off.point - points[0].point).norm() / MILLIMETRE;
        spikes.add((off.line, off.line), (step, "mm"), Action::Repaired, "off the line at its end: dropped");
        return;
    }
    for p in &points[..=last] {
        let step = (p.point - points[last + 1].point).norm() / MILLIMETRE;
        spikes.add((p.line, p.line), (step, "mm"), Action::Repaired, "an end off the line: dropped");
    }
    points.drain(..=last);
}

/// Replaces runs of neighbouring points by their means where there are more points than any curve needs.
pub(super) fn thin_by_means(points: &mut Vec<MeasuredPoint>, findings: &mut Vec<Finding>) {
    /// Most points that are kept.
    const MOST_POINTS: usize = 20_000;
    let run = points.len().div_ceil(MOST_POINTS);
    if run < 2 {
        return;
    }
    let before = points.len();
    let inner = &points[1..before - 1];
    let means = inner.chunks(run).map(|part| {
        let sum = part.iter().fold(Vector2::zeros(), |sum, p| sum + p.point.coords);
        MeasuredPoint { point: Point2::from(sum / part.len() as f64), ..part[part.len() / 2] }
    });
    let thinned: Vec<MeasuredPoint> =
        std::iter::once(points[0]).chain(means).chain(std::iter::once(points[before - 1])).collect();
    *points = thinned;
    let text = format!("each {run} neighbouring points replaced by their mean");
    findings.push(
        Finding::new(FindingKind::Thinned, Action::Repaired, text)
            .with_value((before - points.len()) as f64, "points fewer"),
    );
}
