//! The far field of two condensed bodies: what they are beyond their half-spaces.

use super::press::WheelOnRail;
use crate::contact::{BodyCompliance, Compliance, ContactPoint, HalfSpace, Shares, Side, pair_nodes, total};
use crate::superelement::times;
use faer::Mat;
use nalgebra::{Point2, Vector2};
use std::sync::Arc;

/// Both bodies less their half-spaces at the nodes of the rail's contact grid that are in reach of the contact, in the
/// function space of these nodes. It is smooth, and is interpolated between them.
///
/// The wheel's mesh slides by some tenths of a millimetre past the rail's as the load grows; a smooth field hardly
/// changes by that, so one far field serves a sequence of loads.
pub(super) struct FarField {
    /// The coarse points.
    pub points: Vec<ContactPoint>,
    /// The rail's part and the wheel's, `direction·points + point`, m/N.
    pub bodies: [Mat<f64>; 2],
    /// Their sum.
    pub sum: Arc<Mat<f64>>,
    /// Which of the points stands at each node of the rail's grid.
    slot: Vec<Option<usize>>,
}

impl FarField {
    /// The far field between the `nodes` of the rail's grid (by their index), the hub displaced by `hub`.
    pub fn new(bodies: &WheelOnRail, hub: &Vector2<f64>, nodes: &[bool], directions: usize) -> Self {
        let mut wheel = bodies.wheel_surface.clone();
        wheel.origin += hub;
        let columns = bodies.rail_surface.grid.along_track.len();
        let points = pair_nodes(&bodies.rail_surface, &wheel, |(i, k)| nodes[i * columns + k]);
        let mut slot = vec![None; nodes.len()];
        points.iter().enumerate().for_each(|(j, p)| slot[p.index.0 * columns + p.index.1] = Some(j));
        let beyond = |body: &dyn Compliance, half_space: HalfSpace| {
            let mut rest = total(&[body], &points, directions);
            let half_space = total(&[&half_space], &points, directions);
            for c in 0..rest.ncols() {
                let values = rest.col_as_slice_mut(c).iter_mut().zip(half_space.col_as_slice(c));
                values.for_each(|(rest, value)| *rest -= value);
            }
            rest
        };
        let [rail_half, wheel_half] = bodies.half_spaces();
        let (rail, wheel) = rayon::join(
            || beyond(&BodyCompliance { compliance: bodies.rail, side: Side::Base }, rail_half),
            || beyond(&BodyCompliance { compliance: bodies.wheel, side: Side::Opposing }, wheel_half),
        );
        let sum = Mat::from_fn(rail.nrows(), rail.ncols(), |r, c| rail[(r, c)] + wheel[(r, c)]);
        Self { points, bodies: [rail, wheel], sum: Arc::new(sum), slot }
    }

    /// Directions a point.
    pub fn directions(&self) -> usize {
        self.sum.nrows().checked_div(self.points.len()).unwrap_or(0)
    }

    /// Whether there is a point at every one of the `nodes` that faces the wheel.
    pub fn covers(&self, nodes: &[bool], known: &FarField) -> bool {
        nodes.iter().enumerate().all(|(node, wanted)| !wanted || known.slot[node].is_some() || self.slot[node].is_some())
    }

    /// Shares of a place on the rail (arc length, x; m) in the points at the corners of its cell, and whether the patch
    /// of one of these is cut by the end of either mesh; `None` where a corner has no point.
    pub fn shares(&self, bodies: &WheelOnRail, place: &Point2<f64>) -> Option<(Shares, bool)> {
        let grid = bodies.rail_surface.grid;
        let (i, u) = locate(&grid.along_profile, place.x)?;
        let (k, v) = locate(&grid.along_track, place.y)?;
        let corners =
            [(0, 0, (1.0 - u) * (1.0 - v)), (0, 1, (1.0 - u) * v), (1, 0, u * (1.0 - v)), (1, 1, u * v)];
        let mut shares = [(0, 0.0); 4];
        let mut cut = false;
        for (share, (a, b, weight)) in shares.iter_mut().zip(corners) {
            let point = self.slot[(i + a) * grid.along_track.len() + k + b]?;
            cut |= self.points[point].at_edge;
            *share = (point, weight);
        }
        Some((shares, cut))
    }

    /// Part of a body in the compliance under `forces` on the points: fᵀ·D·f, m·N.
    pub fn quadratic(&self, side: Side, forces: &[f64]) -> f64 {
        let body = match side {
            Side::Base => &self.bodies[0],
            Side::Opposing => &self.bodies[1],
        };
        times(body, forces).iter().zip(forces).map(|(u, f)| u * f).sum()
    }
}

/// Cell of an axis that holds `t` and the coordinate in it, 0 to 1; `None` outside.
fn locate(axis: &[f64], t: f64) -> Option<(usize, f64)> {
    let last = axis.len() - 1;
    if !(t >= axis[0] && t <= axis[last]) {
        return None;
    }
    let cell = axis.partition_point(|&a| a <= t).clamp(1, last) - 1;
    Some((cell, (t - axis[cell]) / (axis[cell + 1] - axis[cell])))
}
