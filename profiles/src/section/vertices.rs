//! Vertices of the outline of a body: how near to each other they are, and where they meet the running surface.

use nalgebra::Point2;

use crate::profile::ProfileCurve;
use crate::units::MILLIMETRE;

/// Largest distance of the vertices on the arcs of a body outline, m.
pub(super) const FILLET_STEP: f64 = 2.0 * MILLIMETRE;

/// Shortest edge of a body's outline, m.
const SHORTEST_EDGE: f64 = 1.0 * MILLIMETRE;

/// Vertices without those that are nearer than the shortest edge to the one before them, or to the last one.
pub(super) fn thinned(vertices: Vec<Point2<f64>>) -> Vec<Point2<f64>> {
    let Some(end) = vertices.last().copied() else { return vertices };
    let mut kept: Vec<Point2<f64>> = Vec::with_capacity(vertices.len());
    for p in &vertices[..vertices.len() - 1] {
        if kept.last().is_none_or(|last| (p - last).norm() >= SHORTEST_EDGE) {
            kept.push(*p);
        }
    }
    while kept.len() > 1 && kept.last().is_some_and(|last| (end - last).norm() < SHORTEST_EDGE) {
        kept.pop();
    }
    kept.push(end);
    kept
}

/// Puts the ends of a body's `vertices` on those of its `running` surface, bit for bit.
pub(super) fn close(vertices: &mut [Point2<f64>], running: &ProfileCurve) {
    if let [first, .., last] = vertices {
        *first = running.point(running.length());
        *last = running.point(0.0);
    }
}
