//! The far field of two condensed bodies: what they are beyond their half-spaces.

use crate::contact::{
    BeyondHalfSpace, ContactPoint, HalfSpace, NodalCompliance, Side, Surface, at_points, locate, pair_nodes,
};
use crate::superelement::times;
use faer::Mat;
use nalgebra::{Point2, UnitComplex, Vector2};
use std::sync::Arc;

/// Two condensed bodies in place.
pub struct Solids<'a> {
    /// Rail and wheel; none where they are their half-spaces.
    pub bodies: Option<[SolidBody<'a>; 2]>,
    /// The rail's surface in its place.
    pub rail_surface: Surface<'a>,
    /// The wheel's surface in its place.
    pub wheel_surface: Surface<'a>,
    /// Half-spaces of the materials of rail and wheel.
    pub half_spaces: [HalfSpace; 2],
    /// Whether both compliances are their own mirror images along the track: then half of their values are enough.
    pub mirrored: bool,
}

/// A condensed body.
#[derive(Clone, Copy)]
pub struct SolidBody<'a> {
    /// Compliance of its contact nodes.
    pub compliance: &'a dyn NodalCompliance,
    /// The far field of the matrix of that compliance. The factor of the matrix multiplies its half-space, too.
    pub beyond: &'a BeyondHalfSpace,
}

impl SolidBody<'_> {
    /// What it is beyond its half-space at `points`, whose mirror images are `twins` if it is its own one.
    fn at(
        &self,
        points: &[ContactPoint],
        side: Side,
        directions: usize,
        twins: Option<&[usize]>,
    ) -> Mat<f64> {
        let mut nodes: Vec<usize> =
            points.iter().flat_map(|point| point.weights(side)).map(|weight| weight.node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let between = self.beyond.between(&self.compliance.terms(), &nodes);
        at_points((&between, &nodes), points, side, directions, twins)
    }
}

/// The far fields of both bodies, interpolated from the nodes of their contact grids to nodes of the rail's. It is
/// smooth, and is interpolated between these.
///
/// The wheel's mesh slides by some tenths of a millimetre past the rail's as the load grows; a smooth field hardly
/// changes by that, so one far field serves a sequence of loads ([`FAR_SLIDE`]).
pub(super) struct FarField {
    /// The coarse points: nodes of the rail's grid, each with the nodes of both bodies that its forces reach.
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
        let mut points = pair_nodes(&solids.rail_surface, &solids.wheel_surface, &nodes);
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
        let of = |body: &SolidBody, side| body.at(&points, side, directions, all.as_deref());
        let (rail_part, wheel_part) =
            rayon::join(|| of(&of_rail, Side::Base), || of(&of_wheel, Side::Opposing));
        for point in &mut points {
            point.base = of_rail.beyond.spread(&point.base);
            point.opposing = of_wheel.beyond.spread(&point.opposing);
        }
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
