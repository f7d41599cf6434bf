//! Points around an outline: where it lies, how wide it is, and what is wrong with it.

use nalgebra::{Point2, Vector2};

use super::expected::outline_of;
use crate::error::{Result, on_line};
use crate::profile::{ProfileKind, Sketch};
use crate::profile_file::loops::first_crossing;
use crate::profile_file::measured::MeasuredPoint;
use crate::units::MILLIMETRE;

/// Points nearer to each other are one, m.
pub(super) const SAME_POINT: f64 = 1e-3 * MILLIMETRE;
/// A turn from here on goes back, degrees.
const CUSP: f64 = 150.0;

/// A ring without points on top of the one before them; it ends where it begins, to the last bit.
pub(super) fn without_duplicates(mut ring: Vec<MeasuredPoint>) -> Vec<MeasuredPoint> {
    ring.dedup_by(|later, first| (later.point - first.point).norm() < SAME_POINT);
    while ring.len() > 1 && (ring[ring.len() - 1].point - ring[0].point).norm() < SAME_POINT {
        ring.pop();
    }
    ring.push(ring[0]);
    ring
}

/// Refuses a ring that steps back or crosses itself; what is drawn, in the `axes` in words, and the place are put into `sketch`.
pub(super) fn check_ring(
    name: &str,
    kind: ProfileKind,
    ring: &[MeasuredPoint],
    axes: &'static str,
    sketch: &mut Sketch,
) -> Result<()> {
    sketch.draw(vec![ring.iter().map(|p| p.point).collect()], axes);
    let n = ring.len() - 1;
    let place = |p: &Point2<f64>| format!("({:.3}, {:.3}) mm", p.x / MILLIMETRE, p.y / MILLIMETRE);
    for i in 0..n {
        let (before, here, after) = (&ring[(i + n - 1) % n], &ring[i], &ring[(i + 1) % n]);
        let turn = (here.point - before.point).angle(&(after.point - here.point)).to_degrees();
        if turn > CUSP {
            let value = format!("a cusp at {} {axes}, a turn of {turn:.0}°", place(&here.point));
            let remedy = "remove the point, or what is drawn twice there";
            sketch.mark(here.point, "a cusp");
            return Err(on_line(name, here.line, &value, outline_of(kind), remedy));
        }
    }
    if let Some((i, j, at)) = first_crossing(name, ring)? {
        let value = format!(
            "an outline that crosses itself at {} {axes}, lines {} and {}",
            place(&at),
            ring[i].line,
            ring[j].line
        );
        let remedy = "put the points in the order of the outline, or remove the loop";
        sketch.mark(at, "a crossing");
        return Err(on_line(name, ring[j].line, &value, outline_of(kind), remedy));
    }
    Ok(())
}

pub(super) fn bounds(points: &[MeasuredPoint]) -> (Point2<f64>, Point2<f64>) {
    let first = points[0].point;
    points.iter().fold((first, first), |(low, high), p| (low.inf(&p.point), high.sup(&p.point)))
}

pub(super) fn extent(points: &[MeasuredPoint]) -> Vector2<f64> {
    let (low, high) = bounds(points);
    high - low
}

/// Least and greatest y among the chords of a ring that pass through a range of z.
pub(super) fn width(ring: &[MeasuredPoint], z: std::ops::RangeInclusive<f64>) -> (f64, f64) {
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    let mut take = |y: f64| range = (range.0.min(y), range.1.max(y));
    for pair in ring.windows(2) {
        let [a, b] = [pair[0].point, pair[1].point];
        for p in [a, b].iter().filter(|p| z.contains(&p.y)) {
            take(p.x);
        }
        for level in [*z.start(), *z.end()] {
            if (a.y - level) * (b.y - level) < 0.0 {
                take(a.x + (b.x - a.x) * (level - a.y) / (b.y - a.y));
            }
        }
    }
    range
}

/// Whether a ring runs along its running surface to the field side; a rail's body lies below that, a wheel's above.
pub(super) fn runs_to_the_field_side(kind: ProfileKind, ring: &[MeasuredPoint]) -> bool {
    let turns: f64 = ring.windows(2).map(|pair| pair[0].point.coords.perp(&pair[1].point.coords)).sum();
    (turns > 0.0) == (kind == ProfileKind::Rail)
}

/// Direction of a ring of `n` points at the point `i`, taken over a length (m) after it or before it.
pub(super) fn direction(
    n: usize,
    at: &dyn Fn(usize) -> MeasuredPoint,
    i: usize,
    forward: bool,
    over: f64,
) -> Vector2<f64> {
    let here = at(i).point;
    let other = |k: usize| at(if forward { i + k } else { i + n - k }).point;
    let far = (1..n).map(other).find(|p| (p - here).norm() >= over).unwrap_or(here);
    (if forward { far - here } else { here - far }).try_normalize(0.0).unwrap_or_default()
}
