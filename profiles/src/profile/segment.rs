//! Lines and arcs: what drawings of rails and wheels are made of.

use nalgebra::{Point2, Vector2};

use super::curve::ProfileCurve;
use super::spline::Piece;
use crate::quadrature::GAUSS_5_UNIT;

/// A straight line or a circular arc, with a direction of travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// Straight from `start` to `end`.
    Line {
        /// First point, m.
        start: Point2<f64>,
        /// Last point, m.
        end: Point2<f64>,
    },
    /// Circular arc; the point at the angle φ is centre + radius (cos φ, sin φ) in (y, z).
    Arc {
        /// Centre, m.
        centre: Point2<f64>,
        /// Radius, m.
        radius: f64,
        /// Angle of the first point, rad.
        start_angle: f64,
        /// Angle travelled, rad, positive from y towards z.
        sweep: f64,
    },
}

impl Segment {
    /// The straight line from `start` to `end`.
    pub fn line(start: Point2<f64>, end: Point2<f64>) -> Self {
        Self::Line { start, end }
    }

    /// The arc about `centre` from `start` the shorter way round to the direction of `end`.
    pub fn arc(centre: Point2<f64>, start: Point2<f64>, end: Point2<f64>) -> Self {
        let (from, to) = (start - centre, end - centre);
        let sweep = from.perp(&to).atan2(from.dot(&to));
        Self::Arc { centre, radius: from.norm(), start_angle: from.y.atan2(from.x), sweep }
    }

    /// Length, m.
    pub fn length(&self) -> f64 {
        match *self {
            Self::Line { start, end } => (end - start).norm(),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// Point at the fraction `t` (0 to 1) of the length.
    pub fn point(&self, t: f64) -> Point2<f64> {
        match *self {
            Self::Line { start, end } => start + t * (end - start),
            Self::Arc { centre, radius, start_angle, sweep } => {
                let (sin, cos) = (start_angle + t * sweep).sin_cos();
                centre + radius * Vector2::new(cos, sin)
            }
        }
    }

    /// Unit tangent at the fraction `t`.
    pub fn tangent(&self, t: f64) -> Vector2<f64> {
        match *self {
            Self::Line { start, end } => (end - start).normalize(),
            Self::Arc { start_angle, sweep, .. } => {
                let (sin, cos) = (start_angle + t * sweep).sin_cos();
                sweep.signum() * Vector2::new(-sin, cos)
            }
        }
    }

    /// First point.
    pub fn start(&self) -> Point2<f64> {
        self.point(0.0)
    }

    /// Last point.
    pub fn end(&self) -> Point2<f64> {
        self.point(1.0)
    }

    /// The point of the segment nearest to `p`.
    pub fn closest(&self, p: &Point2<f64>) -> Point2<f64> {
        match *self {
            Self::Line { start, end } => {
                let along = end - start;
                self.point(((p - start).dot(&along) / along.norm_squared()).clamp(0.0, 1.0))
            }
            Self::Arc { centre, start_angle, sweep, .. } => {
                let offset = p - centre;
                // The angle from the middle of the arc, within half a turn.
                let (sin, cos) = (start_angle + 0.5 * sweep).sin_cos();
                let middle = Vector2::new(cos, sin);
                let angle = middle.perp(&offset).atan2(middle.dot(&offset));
                self.point((0.5 + angle / sweep).clamp(0.0, 1.0))
            }
        }
    }

    /// The same segment travelled the other way.
    pub fn reversed(&self) -> Self {
        match *self {
            Self::Line { start, end } => Self::Line { start: end, end: start },
            Self::Arc { centre, radius, start_angle, sweep } => {
                Self::Arc { centre, radius, start_angle: start_angle + sweep, sweep: -sweep }
            }
        }
    }

    /// The mirror image in the z axis, travelled the same way along the mirrored outline.
    pub fn mirrored(&self) -> Self {
        let mirror = |p: Point2<f64>| Point2::new(-p.x, p.y);
        match *self {
            Self::Line { start, end } => Self::Line { start: mirror(start), end: mirror(end) },
            Self::Arc { centre, radius, start_angle, sweep } => Self::Arc {
                centre: mirror(centre),
                radius,
                start_angle: std::f64::consts::PI - start_angle,
                sweep: -sweep,
            },
        }
    }

    /// All lengths times `factor` (for instance from mm to m).
    pub fn scaled(&self, factor: f64) -> Self {
        match *self {
            Self::Line { start, end } => Self::Line { start: start * factor, end: end * factor },
            Self::Arc { centre, radius, start_angle, sweep } => {
                Self::Arc { centre: centre * factor, radius: radius * factor, start_angle, sweep }
            }
        }
    }

    /// Points of the segment, both ends included, with its end tangents; arcs at most `step` and 1/40 of their
    /// radius apart, which keeps a clamped cubic spline within 1e-10 m of an arc of up to 0.3 m.
    pub(crate) fn piece(&self, step: f64) -> Piece {
        let step = match *self {
            Self::Line { .. } => 5.0 * step,
            Self::Arc { radius, .. } => step.min(radius / 40.0),
        };
        let parts = (self.length() / step).ceil().max(1.0) as usize;
        Piece {
            points: (0..=parts).map(|i| self.point(i as f64 / parts as f64)).collect(),
            end_tangents: Some([self.tangent(0.0), self.tangent(1.0)]),
        }
    }

    /// ∫ f(p, dp/ds) ds over the segment, to round-off for polynomials up to the fourth degree.
    pub(crate) fn integrate<const N: usize>(
        &self,
        f: impl Fn(&Point2<f64>, &Vector2<f64>) -> [f64; N],
    ) -> [f64; N] {
        // Five Gauss points leave a relative error below 1e-16 on parts of 15°.
        let parts = match *self {
            Self::Line { .. } => 1,
            Self::Arc { sweep, .. } => (sweep.abs() / 15f64.to_radians()).ceil().max(1.0) as usize,
        };
        let length = self.length() / parts as f64;
        let mut sum = [0.0; N];
        for part in 0..parts {
            for (x, w) in GAUSS_5_UNIT {
                let t = (part as f64 + x) / parts as f64;
                for (total, v) in sum.iter_mut().zip(f(&self.point(t), &self.tangent(t))) {
                    *total += w * length * v;
                }
            }
        }
        sum
    }
}

impl ProfileCurve {
    /// The curve of lines and arcs that follow each other, with their own tangents at every joint; arcs are sampled at
    /// most `step` (m) apart. Each segment starts where the one before it ends, whatever its own start.
    ///
    /// # Panics
    /// Without any segment.
    pub fn from_segments(segments: &[Segment], step: f64) -> Self {
        assert!(!segments.is_empty(), "a curve needs a segment");
        Self::from_pieces(segments.iter().map(|s| s.piece(step)).collect())
    }
}

/// Vertices along `segments`: the ends of every segment, and on arcs points at most `max_step` (m) apart.
pub fn polyline(segments: &[Segment], max_step: f64) -> Vec<Point2<f64>> {
    let mut vertices = Vec::new();
    if let Some(first) = segments.first() {
        vertices.push(first.start());
    }
    for segment in segments {
        let parts = match segment {
            Segment::Line { .. } => 1,
            Segment::Arc { .. } => (segment.length() / max_step).ceil().max(1.0) as usize,
        };
        vertices.extend((1..=parts).map(|i| segment.point(i as f64 / parts as f64)));
    }
    vertices
}

/// An endless straight line: a point and a unit direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EndlessLine {
    pub point: Point2<f64>,
    pub direction: Vector2<f64>,
}

impl EndlessLine {
    pub fn new(point: Point2<f64>, direction: Vector2<f64>) -> Self {
        Self { point, direction: direction.normalize() }
    }

    /// The parallel at the distance `offset` to the side of (-dz, dy), which is downwards for a line to +y.
    pub fn parallel(&self, offset: f64) -> Self {
        let side = Vector2::new(-self.direction.y, self.direction.x);
        Self { point: self.point + offset * side, ..*self }
    }

    pub fn intersection(&self, other: &Self) -> Point2<f64> {
        let t = (other.point - self.point).perp(&other.direction) / self.direction.perp(&other.direction);
        self.point + t * self.direction
    }

    /// Foot of the perpendicular from `p`.
    pub fn foot(&self, p: Point2<f64>) -> Point2<f64> {
        self.point + (p - self.point).dot(&self.direction) * self.direction
    }
}

/// The fillet of radius `radius` between two lines travelled in the order `first`, `second`.
pub(crate) fn fillet(first: &EndlessLine, second: &EndlessLine, radius: f64) -> Segment {
    // The centre lies on the side to which the outline turns.
    let side = first.direction.perp(&second.direction).signum() * radius;
    let centre = first.parallel(side).intersection(&second.parallel(side));
    Segment::arc(centre, first.foot(centre), second.foot(centre))
}
