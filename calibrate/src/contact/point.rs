//! A contact point: its place, its gap, and the weights with which the nodes of both bodies take part in it.

use nalgebra::{Point2, Vector2, Vector3};

/// The direction along the track, in which mirror images along it have opposite values.
pub(super) const ALONG: usize = 2;

/// Which of the two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The rail (or lower block).
    Base,
    /// The wheel (or upper block).
    Opposing,
}

/// Weight of one grid node in the mean over a contact point's patch.
#[derive(Debug, Clone, Copy)]
pub struct NodeWeight {
    /// Index in the body's contact grid.
    pub node: usize,
    /// Weight times the unit normal (y, z).
    pub normal: Vector2<f64>,
    /// Weight.
    pub scalar: f64,
}

/// A candidate for contact: a node of the base surface that is near the other one. Contact forces, gaps and slips of
/// a list of points stand in rows `direction·points + point`, the directions being those of [`Self::direction`].
#[derive(Debug, Clone)]
pub struct ContactPoint {
    /// Grid indices on the base surface: along the profile, along the track.
    pub index: (usize, usize),
    /// Arc length along the base profile and x, m.
    pub position: Point2<f64>,
    /// Mean position on the opposing curve (its own frame y, z), m.
    pub opposing_position: Point2<f64>,
    /// Widths of the point's share of the surface along the profile and x, m.
    pub widths: Vector2<f64>,
    /// Mean gap of the undeformed surfaces, m.
    pub gap: f64,
    /// Area that carries a unit nodal pressure, m².
    pub area: f64,
    /// Mean normal of the base surface, out of the base, world (y, z).
    pub normal: Vector2<f64>,
    /// Whether the patch is cut by the edge of either grid.
    pub at_edge: bool,
    /// Weights of the base nodes.
    pub base: Vec<NodeWeight>,
    /// Weights of the opposing nodes.
    pub opposing: Vec<NodeWeight>,
}

impl ContactPoint {
    /// Weights of the nodes of one body.
    pub fn weights(&self, side: Side) -> &[NodeWeight] {
        match side {
            Side::Base => &self.base,
            Side::Opposing => &self.opposing,
        }
    }

    /// Displacement weights of one body in direction 0 (normal), 1 (lateral tangent), 2 (along the track):
    /// `(3·node + axis, weight)` of the axes that the direction has.
    pub fn row(&self, side: Side, direction: usize) -> impl Iterator<Item = (usize, f64)> {
        let axes = if direction < 2 { 2 } else { 1 };
        self.weights(side).iter().flat_map(move |w| {
            let of_axes = match direction {
                0 => [(1, w.normal.x), (2, w.normal.y)],
                1 => [(1, -w.normal.y), (2, w.normal.x)],
                _ => [(0, w.scalar), (0, 0.0)],
            };
            of_axes.into_iter().take(axes).map(move |(axis, weight)| (3 * w.node + axis, weight))
        })
    }

    /// Mean of nodal displacements (`3·node + axis`, m) of one body over the patch, in a direction as of [`Self::row`].
    pub fn displacement(&self, side: Side, direction: usize, nodal: &[f64]) -> f64 {
        let weights = self.weights(side).iter();
        let across = |w: &NodeWeight| Vector2::new(nodal[3 * w.node + 1], nodal[3 * w.node + 2]);
        match direction {
            0 => weights.map(|w| w.normal.dot(&across(w))).sum(),
            1 => weights.map(|w| w.normal.perp(&across(w))).sum(),
            _ => weights.map(|w| w.scalar * nodal[3 * w.node]).sum(),
        }
    }

    /// Displacement in a direction of the opposing surface against the base, m, by those of the contact nodes of both (`3·node + axis`, m).
    pub fn opening(&self, direction: usize, [base, opposing]: [&[f64]; 2]) -> f64 {
        self.displacement(Side::Opposing, direction, opposing)
            - self.displacement(Side::Base, direction, base)
    }

    /// World direction: 0 normal (out of the base), 1 lateral tangent, 2 along the track.
    pub fn direction(&self, direction: usize) -> Vector3<f64> {
        let n = self.normal;
        match direction {
            0 => Vector3::new(0.0, n.x, n.y),
            1 => Vector3::new(0.0, -n.y, n.x),
            _ => Vector3::new(1.0, 0.0, 0.0),
        }
    }
}

/// Gaps of the undeformed surfaces, m.
pub fn gaps(points: &[ContactPoint]) -> Vec<f64> {
    points.iter().map(|point| point.gap).collect()
}

/// Forces on the grid nodes of one body (`3·node + axis`, as many as `equations`) from contact forces by direction and
/// point, N.
pub fn nodal_forces(points: &[ContactPoint], side: Side, forces: &[f64], equations: usize) -> Vec<f64> {
    let sign = match side {
        Side::Base => -1.0,
        Side::Opposing => 1.0,
    };
    let mut nodal = vec![0.0; equations];
    for (f, force) in forces.iter().enumerate().filter(|(_, v)| **v != 0.0) {
        for (dof, w) in points[f % points.len()].row(side, f / points.len()) {
            nodal[dof] += sign * w * force;
        }
    }
    nodal
}

/// Resultant of contact forces by direction and point: force on the opposing body in world axes, N.
pub fn resultant(points: &[ContactPoint], forces: &[f64]) -> Vector3<f64> {
    forces
        .iter()
        .enumerate()
        .map(|(f, force)| points[f % points.len()].direction(f / points.len()) * *force)
        .sum()
}

/// Points of a flat rectangular grid with spacing `h` (m) and the given gap function of (s, x): for analytic
/// compliances that know no mesh.
pub fn flat_grid(count: (usize, usize), h: f64, gap: impl Fn(f64, f64) -> f64) -> Vec<ContactPoint> {
    let mut points = Vec::with_capacity(count.0 * count.1);
    for i in 0..count.0 {
        for k in 0..count.1 {
            let centre = |n: usize, of: usize| (n as f64 - 0.5 * (of as f64 - 1.0)) * h;
            let (s, x) = (centre(i, count.0), centre(k, count.1));
            points.push(ContactPoint {
                index: (i, k),
                position: Point2::new(s, x),
                opposing_position: Point2::new(s, 0.0),
                widths: Vector2::new(h, h),
                gap: gap(s, x),
                area: h * h,
                normal: Vector2::new(0.0, -1.0),
                at_edge: i == 0 || k == 0 || i + 1 == count.0 || k + 1 == count.1,
                base: Vec::new(),
                opposing: Vec::new(),
            });
        }
    }
    points
}
