//! The far field of two condensed bodies: what they are beyond their half-spaces.

use crate::contact::{
    BodyCompliance, ContactPoint, HalfSpace, NodalCompliance, Side, Surface, locate, pair_nodes,
    subtract_half_spaces, total,
};
use crate::superelement::times;
use faer::Mat;
use nalgebra::{Point2, UnitComplex, Vector2};
use std::sync::Arc;

/// Two condensed bodies in place.
pub struct Solids<'a> {
    /// Compliances of the contact nodes of rail and wheel; none where they are their half-spaces.
    pub bodies: Option<[&'a dyn NodalCompliance; 2]>,
    /// The rail's surface in its place.
    pub rail_surface: Surface<'a>,
    /// The wheel's surface in its place.
    pub wheel_surface: Surface<'a>,
    /// Half-spaces of the materials of rail and wheel.
    pub half_spaces: [HalfSpace; 2],
    /// Whether both compliances are their own mirror images along the track: then half of their values are enough.
    pub mirrored: bool,
}

/// Both bodies less their half-spaces at nodes of the rail's contact grid, in the function space of these nodes. It is
/// smooth, and is interpolated between them.
///
/// The wheel's mesh slides by some tenths of a millimetre past the rail's as the load grows; a smooth field hardly
/// changes by that, so one far field serves a sequence of loads ([`FAR_SLIDE`]).
pub(super) struct FarField {
    /// The coarse points.
    pub points: Vec<ContactPoint>,
    /// The rail's part and the wheel's, `direction·points + point`, m/N.
    bodies: [Mat<f64>; 2],
    /// Their sum.
    pub sum: Arc<Mat<f64>>,
    /// The nodes for which it was made.
    pub nodes: Vec<bool>,
    /// Turn of the rail for which it was made.
    turn: UnitComplex<f64>,
    /// Where the wheel was against the rail, world (y, z), m.
    wheel: Vector2<f64>,
    /// Which of the points stands at each node of the rail's grid.
    slot: Vec<Option<usize>>,
    /// The mirror image of each point along the track, where the whole is its own one but for [`ALIKE`].
    pub twins: Option<Arc<Vec<Option<usize>>>>,
}

/// Part of its largest value by which a far field may differ from its mirror image: the last digits of a condensed body. The difference acts on both sides the opposite
/// way, so that forces and hub have the square of it.
const ALIKE: f64 = 1e-5;

/// The rail turns by as much before a far field without friction is made again, rad: one with normal directions alone does not turn with
/// the points, and the forces on the bodies keep its directions.
const FAR_TURN: f64 = 1e-4;

/// The wheel slides past the rail by as much before a far field is made again, m. Downwards on a flange it slides by some millimetres; the displacement of
/// the hub jumped by 1.3 % where the far field was made anew after that.
const FAR_SLIDE: f64 = 0.5e-3;

impl Solids<'_> {
    /// Where the wheel is against the rail, world (y, z), m.
    fn wheel_from_rail(&self) -> Vector2<f64> {
        self.wheel_surface.origin - self.rail_surface.origin
    }
}

impl FarField {
    /// The far field between the `nodes` of the rail's grid, with `directions` unknowns a point.
    pub fn new(solids: &Solids, nodes: Vec<bool>, directions: usize) -> Self {
        let columns = solids.rail_surface.grid.along_track.len();
        let points = pair_nodes(&solids.rail_surface, &solids.wheel_surface, |(i, k)| nodes[i * columns + k]);
        let mut slot = vec![None; nodes.len()];
        points.iter().enumerate().for_each(|(j, p)| slot[p.index.0 * columns + p.index.1] = Some(j));
        let turn = solids.rail_surface.turn;
        let wheel = solids.wheel_from_rail();
        let Some([of_rail, of_wheel]) = solids.bodies else {
            let size = directions * points.len();
            let bodies = [Mat::zeros(size, size), Mat::zeros(size, size)];
            let sum = Arc::new(bodies[0].clone());
            let twins = Some(Arc::new(twins(&points, &slot, columns)));
            return Self { points, sum, bodies, nodes, turn, wheel, slot, twins };
        };
        let twins = twins(&points, &slot, columns);
        let all: Option<Vec<usize>> = if solids.mirrored { twins.iter().copied().collect() } else { None };
        let stand_ins = StandIns { points: &points, slot: &slot, columns };
        let of = |compliance: &dyn NodalCompliance, side| {
            let body = BodyCompliance { compliance, side };
            let half = all.as_ref().and_then(|twins| body.of_mirrored(&points, twins, directions));
            half.unwrap_or_else(|| total(&[&body], &points, directions))
        };
        let (mut rail_part, mut wheel_part) =
            rayon::join(|| of(of_rail, Side::Base), || of(of_wheel, Side::Opposing));
        let wanted = |a, b| stand_ins.of(a, b).is_none();
        let (half_spaces, parts) = (solids.half_spaces.each_ref(), [&mut rail_part, &mut wheel_part]);
        subtract_half_spaces(half_spaces, &points, all.as_deref(), wanted, parts);
        [&mut rail_part, &mut wheel_part].into_iter().for_each(|body| stand_ins.smooth(body));
        let mut sum = rail_part.clone();
        for c in 0..sum.ncols() {
            let values = sum.col_as_slice_mut(c).iter_mut().zip(wheel_part.col_as_slice(c));
            values.for_each(|(sum, value)| *sum += value);
        }
        let twins = (all.is_some() || is_mirrored(&sum, &twins)).then(|| Arc::new(twins));
        let bodies = [rail_part, wheel_part];
        Self { points, bodies, sum: Arc::new(sum), nodes, turn, wheel, slot, twins }
    }

    /// Whether the wheel has slid past the rail by less than [`FAR_SLIDE`] since it was made.
    pub fn is_near(&self, solids: &Solids) -> bool {
        (solids.wheel_from_rail() - self.wheel).norm() < FAR_SLIDE
    }

    /// Whether it was made for all of the `nodes` and as many `directions`, and serves a `rail` in its place.
    pub fn serves(&self, nodes: &[bool], directions: usize, rail: &Surface) -> bool {
        self.sum.nrows() == directions * self.points.len()
            && (directions > 1 || self.turn.angle_to(&rail.turn).abs() < FAR_TURN)
            && nodes.iter().zip(&self.nodes).all(|(wanted, made)| !wanted || *made)
    }

    /// Shares of a place on the rail (arc length, x; m) in the points at the corners of its cell; `None` where a corner has no
    /// point. A corner whose hat is cut by the end of either mesh gives its share to the one beside it, along the track if
    /// that is whole; with it, whether all corners are cut.
    pub fn shares(&self, rail: &Surface, place: &Point2<f64>) -> Option<([(usize, f64); 4], bool)> {
        let (i, u) = locate(&rail.grid.along_profile, place.x)?;
        let (k, v) = locate(&rail.grid.along_track, place.y)?;
        let columns = rail.grid.along_track.len();
        let corner = |a: usize, b: usize| self.slot[(i + a) * columns + k + b];
        let corners = [corner(0, 0)?, corner(0, 1)?, corner(1, 0)?, corner(1, 1)?];
        let weights = [(1.0 - u) * (1.0 - v), (1.0 - u) * v, u * (1.0 - v), u * v];
        let whole = |n: usize| !self.points[corners[n]].at_edge;
        let shares = std::array::from_fn(|n| {
            // the other end along the track, along the profile, and across
            let taken = [n, n ^ 1, n ^ 2, n ^ 3].into_iter().find(|&other| whole(other)).unwrap_or(n);
            (corners[taken], weights[n])
        });
        Some((shares, !(0..4).any(whole)))
    }

    /// Part of a body in the compliance under `forces` on the points: fᵀ·D·f, m·N.
    pub fn quadratic(&self, side: Side, forces: &[f64]) -> f64 {
        let [rail, wheel] = &self.bodies;
        let body = if side == Side::Base { rail } else { wheel };
        times(body, forces).iter().zip(forces).map(|(u, f)| u * f).sum()
    }
}

/// The mirror images of points along the track, on a grid with so many lines along it; `slot` has the point at each node.
fn twins(points: &[ContactPoint], slot: &[Option<usize>], columns: usize) -> Vec<Option<usize>> {
    let twin = |point: &ContactPoint| {
        let twin = slot[point.index.0 * columns + columns - 1 - point.index.1]?;
        let apart = points[twin].position.y + point.position.y;
        (apart.abs() < 1e-9 * point.widths.y).then_some(twin)
    };
    points.iter().map(twin).collect()
}

/// Whether the values of mirror images along the track are alike. A point at the end of the surfaces may have no mirror image: the
/// points of a contact that have shares in it have none either.
fn is_mirrored(sum: &Mat<f64>, twins: &[Option<usize>]) -> bool {
    let n = twins.len();
    let largest = (0..sum.nrows()).fold(0.0_f64, |m, row| m.max(sum[(row, row)].abs()));
    // rows with their mirror image, and its sign: along the track it has the opposite direction
    let twin_of =
        |row: usize| Some((row, row / n * n + twins[row % n]?, if row / n == 2 { -1.0 } else { 1.0 }));
    let rows: Vec<(usize, usize, f64)> = (0..sum.nrows()).filter_map(twin_of).collect();
    rows.iter().all(|(c, mirrored, sign_of_column)| {
        let (column, mirrored) = (sum.col_as_slice(*c), sum.col_as_slice(*mirrored));
        let odd =
            |(r, twin, sign): &(usize, usize, f64)| column[*r] - sign * sign_of_column * mirrored[*twin];
        rows.iter().all(|row| odd(row).abs() <= ALIKE * largest)
    })
}

/// Lines of the grid, in either direction, over which an element mesh does not resolve a half-space: the difference of
/// both is an error there.
const UNRESOLVED: usize = 2;

/// Pairs of nodes of a grid (with `columns` lines along the track) in the place of those that are so near each other that the
/// elements do not resolve what lies between them: farther apart along the track, with the same middle.
struct StandIns<'a> {
    points: &'a [ContactPoint],
    slot: &'a [Option<usize>],
    columns: usize,
}

/// Two pairs of points, the second with the other sign of the distance along the track, and the part of the odd difference.
struct StandIn {
    pairs: [(usize, usize); 2],
    odd: f64,
}

impl StandIns<'_> {
    /// In the place of two points; `None` if they are far enough apart, or where the grid ends.
    fn of(&self, a: usize, b: usize) -> Option<StandIn> {
        let ((i, k), (m, l)) = (self.points[a].index, self.points[b].index);
        let apart = k.abs_diff(l);
        if i.abs_diff(m) > UNRESOLVED || apart > UNRESOLVED {
            return None;
        }
        // as many lines outwards on both sides
        let outwards = (UNRESOLVED + 2 - apart) / 2;
        let (low, high) = (k.min(l).checked_sub(outwards)?, k.max(l) + outwards);
        if high >= self.columns {
            return None;
        }
        let (one, other) = if k <= l { (low, high) } else { (high, low) };
        let at = |i: usize, k: usize| self.slot[i * self.columns + k];
        let pairs = [(at(i, one)?, at(m, other)?), (at(i, other)?, at(m, one)?)];
        Some(StandIn { pairs, odd: apart as f64 / (high - low) as f64 })
    }

    /// Replaces the values between the points that have a stand-in: the part that is even in the distance as it is, the
    /// odd part in proportion.
    fn smooth(&self, rest: &mut Mat<f64>) {
        let n = self.points.len();
        let directions = rest.nrows().checked_div(n).unwrap_or(0);
        // stand-ins have none themselves
        for a in 0..n {
            for b in 0..n {
                let Some(StandIn { pairs: [(c, d), (e, f)], odd }) = self.of(a, b) else { continue };
                for to in 0..directions {
                    for from in 0..directions {
                        let (same, turned) =
                            (rest[(to * n + c, from * n + d)], rest[(to * n + e, from * n + f)]);
                        rest[(to * n + a, from * n + b)] =
                            0.5 * (same + turned) + 0.5 * odd * (same - turned);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::flat_grid;

    /// Goal: a far field that is smooth, with a part that is odd in the distance along the track, stays what it is; an error
    /// between nodes up to two lines apart goes. Unit m/N. Accuracy: MODEL, what the even part changes by over the four lines
    /// that are bridged, 16·0.001; ROUNDOFF.
    #[test]
    fn errors_between_neighbours_go() {
        const ROUNDOFF: f64 = 1e-12;
        const MODEL: f64 = 0.016;
        let (rows, columns) = (7, 9);
        let points = flat_grid((rows, columns), 1.0, |_, _| 0.0);
        let n = points.len();
        let slot: Vec<Option<usize>> = (0..n).map(Some).collect();
        let exact = |r: usize, c: usize| {
            let ((to, a), (from, b)) = ((r / n, points[r % n].index), (c / n, points[c % n].index));
            let apart = b.1 as f64 - a.1 as f64;
            match (to, from) {
                (2, 0) | (2, 1) => -0.1 * apart,
                (0, 2) | (1, 2) => 0.1 * apart,
                _ => 1.0 + 0.01 * (a.0 + b.0) as f64 + 0.02 * (a.1 + b.1) as f64 - 0.001 * apart * apart,
            }
        };
        let near = |r: usize, c: usize| {
            let (a, b) = (points[r % n].index, points[c % n].index);
            a.0.abs_diff(b.0) <= UNRESOLVED && a.1.abs_diff(b.1) <= UNRESOLVED
        };
        let mut found = Mat::from_fn(3 * n, 3 * n, |r, c| exact(r, c) - if near(r, c) { 0.7 } else { 0.0 });
        StandIns { points: &points, slot: &slot, columns }.smooth(&mut found);
        for r in 0..3 * n {
            for c in 0..3 * n {
                let inside = |j: usize| (2..columns - 2).contains(&points[j % n].index.1);
                if inside(r) && inside(c) {
                    let tolerance = ROUNDOFF + if near(r, c) { MODEL } else { 0.0 };
                    let error = found[(r, c)] - exact(r, c);
                    assert!(error.abs() < tolerance, "{r} {c}: {error}");
                }
                assert!((found[(r, c)] - found[(c, r)]).abs() < ROUNDOFF, "{r} {c}");
            }
        }
    }
}
