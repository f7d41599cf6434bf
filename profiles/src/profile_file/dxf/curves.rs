//! Lines, arcs and splines, and paths of them.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};

use super::placement::Placement;

/// Greatest turn between neighbouring points of a curve, rad: a cubic through points on an arc of 13 mm radius that are
/// as far apart is off it by R·φ⁴/384 = 0.2 nm.
const STEP_TURN: f64 = 0.05;

/// A piece of a path.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Piece {
    /// A straight line between two points.
    Line(Point2<f64>, Point2<f64>),
    /// An arc from the angle `start` over `sweep`, rad, positive from x to y.
    Arc { centre: Point2<f64>, radius: f64, start: f64, sweep: f64 },
    /// A spline.
    Spline(Nurbs),
}

impl Piece {
    /// A line, or the arc whose bulge is the tangent of a quarter of its sweep.
    pub fn with_bulge(a: Point2<f64>, b: Point2<f64>, bulge: f64) -> Self {
        /// A smaller bulge is a line to rounding.
        const FLAT: f64 = 1e-9;
        if bulge.abs() < FLAT {
            return Self::Line(a, b);
        }
        let chord: Vector2<f64> = b - a;
        // The centre lies left of the chord of an arc that turns left by less than half a turn.
        let to_centre = (1.0 / bulge - bulge) / 4.0;
        let centre = nalgebra::center(&a, &b) + to_centre * Vector2::new(-chord.y, chord.x);
        let from = a - centre;
        Self::Arc { centre, radius: from.norm(), start: from.y.atan2(from.x), sweep: 4.0 * bulge.atan() }
    }

    /// The point at a part from 0 to 1 of the piece.
    pub fn point(&self, t: f64) -> Point2<f64> {
        match self {
            Self::Line(a, b) => a + t * (b - a),
            Self::Arc { centre, radius, start, sweep } => {
                let (sin, cos) = (start + t * sweep).sin_cos();
                centre + *radius * Vector2::new(cos, sin)
            }
            Self::Spline(curve) => curve.point(t),
        }
    }

    pub fn ends(&self) -> [Point2<f64>; 2] {
        match self {
            Self::Line(a, b) => [*a, *b],
            _ => [self.point(0.0), self.point(1.0)],
        }
    }

    fn length(&self) -> f64 {
        /// Chords that the length of a spline is measured with, for each of its control points.
        const CHORDS: usize = 8;
        match self {
            Self::Line(a, b) => (b - a).norm(),
            Self::Arc { radius, sweep, .. } => (radius * sweep).abs(),
            Self::Spline(curve) => {
                let n = CHORDS * curve.points.len();
                let points: Vec<_> = (0..=n).map(|i| self.point(i as f64 / n as f64)).collect();
                points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
            }
        }
    }

    /// In how many equal parts the piece is divided, none longer than `step`.
    pub fn parts(&self, step: f64) -> usize {
        let by_length = (self.length() / step).ceil();
        let by_turn = match self {
            Self::Line(..) => 1.0,
            Self::Arc { sweep, .. } => (sweep.abs() / STEP_TURN).ceil(),
            // A spline turns where its control points do: each span is divided as a quarter of a turn.
            Self::Spline(curve) => (curve.spans() as f64 * 0.25 * TAU / STEP_TURN).ceil(),
        };
        by_length.max(by_turn).clamp(1.0, 1e9) as usize
    }

    /// The piece under a map of the plane; an arc that becomes part of an ellipse is a spline afterwards.
    fn placed(&self, placement: &Placement) -> Self {
        match self {
            Self::Line(a, b) => Self::Line(placement.of(*a), placement.of(*b)),
            Self::Arc { centre, radius, start, sweep } => match placement.similarity() {
                Some(scale) => {
                    let (sin, cos) = start.sin_cos();
                    let from = placement.linear * Vector2::new(cos, sin);
                    Self::Arc {
                        centre: placement.of(*centre),
                        radius: radius * scale.abs(),
                        start: from.y.atan2(from.x),
                        sweep: sweep * scale.signum(),
                    }
                }
                None => Self::Spline(Nurbs::arc(*centre, *radius, *start, *sweep).placed(placement)),
            },
            Self::Spline(curve) => Self::Spline(curve.placed(placement)),
        }
    }

    fn reverse(&mut self) {
        match self {
            Self::Line(a, b) => std::mem::swap(a, b),
            Self::Arc { start, sweep, .. } => (*start, *sweep) = (*start + *sweep, -*sweep),
            Self::Spline(curve) => curve.reverse(),
        }
    }
}

/// Pieces one after the other, each with the line of the file that it comes from.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Path {
    pub pieces: Vec<(Piece, usize)>,
    /// Layer of the drawing.
    pub layer: String,
}

impl Path {
    pub fn of(piece: Piece, line: usize) -> Self {
        Self { pieces: vec![(piece, line)], layer: String::new() }
    }

    pub fn add(&mut self, piece: Piece, line: usize) {
        self.pieces.push((piece, line));
    }

    pub fn ends(&self) -> Option<[Point2<f64>; 2]> {
        Some([self.pieces.first()?.0.ends()[0], self.pieces.last()?.0.ends()[1]])
    }

    /// The path under a map of the plane.
    pub fn placed(&self, placement: &Placement) -> Self {
        let pieces = self.pieces.iter().map(|(piece, line)| (piece.placed(placement), *line)).collect();
        Self { pieces, layer: self.layer.clone() }
    }

    /// Runs through the path from its end.
    pub fn reverse(&mut self) {
        self.pieces.reverse();
        self.pieces.iter_mut().for_each(|(piece, _)| piece.reverse());
    }

    /// Length of the path.
    pub fn length(&self) -> f64 {
        self.pieces.iter().map(|(piece, _)| piece.length()).sum()
    }
}

/// A rational B-spline.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Nurbs {
    pub degree: usize,
    pub knots: Vec<f64>,
    pub points: Vec<Point2<f64>>,
    pub weights: Vec<f64>,
}

impl Nurbs {
    /// Whether degree, knots, points and weights belong together.
    pub fn is_sound(&self) -> bool {
        /// Highest degree; programs draw with 3.
        const HIGHEST: usize = 15;
        let n = self.points.len();
        (1..=HIGHEST).contains(&self.degree)
            && n > self.degree
            && self.knots.len() == n + self.degree + 1
            && self.knots.windows(2).all(|pair| pair[0] <= pair[1])
            && self.knots[self.degree] < self.knots[n]
            && self.weights.len() == n
            && self.weights.iter().all(|weight| *weight > 0.0)
    }

    /// An arc as rational pieces of degree 2, none longer than a quarter of a turn.
    fn arc(centre: Point2<f64>, radius: f64, start: f64, sweep: f64) -> Self {
        let pieces = (sweep.abs() / (0.25 * TAU)).ceil().max(1.0) as usize;
        let half = 0.5 * sweep / pieces as f64;
        let control = |i: usize| {
            let out = if i.is_multiple_of(2) { radius } else { radius / half.cos() };
            let (sin, cos) = (start + i as f64 * half).sin_cos();
            centre + out * Vector2::new(cos, sin)
        };
        let knots =
            (0..=pieces).flat_map(|i| vec![i as f64; if i.is_multiple_of(pieces) { 3 } else { 2 }]).collect();
        let weight = |i: usize| if i.is_multiple_of(2) { 1.0 } else { half.cos() };
        Self {
            degree: 2,
            knots,
            points: (0..=2 * pieces).map(control).collect(),
            weights: (0..=2 * pieces).map(weight).collect(),
        }
    }

    fn placed(&self, placement: &Placement) -> Self {
        Self { points: self.points.iter().map(|p| placement.of(*p)).collect(), ..self.clone() }
    }

    /// Number of polynomial pieces at most.
    fn spans(&self) -> usize {
        self.points.len() - self.degree
    }

    /// The point at a part from 0 to 1 of the range of knots, by de Boor's recursion in homogeneous coordinates.
    fn point(&self, t: f64) -> Point2<f64> {
        let (p, n) = (self.degree, self.points.len());
        let (low, high) = (self.knots[p], self.knots[n]);
        let u = (low + t * (high - low)).clamp(low, high);
        let after = self.knots[p..n].partition_point(|knot| *knot <= u) + p;
        let k = after.clamp(p + 1, n) - 1;
        let mut d: Vec<[f64; 3]> = (k - p..=k)
            .map(|i| {
                [self.points[i].x * self.weights[i], self.points[i].y * self.weights[i], self.weights[i]]
            })
            .collect();
        for r in 1..=p {
            for j in (r..=p).rev() {
                let (a, b) = (self.knots[j + k - p], self.knots[j + 1 + k - r]);
                let part = if b > a { (u - a) / (b - a) } else { 0.0 };
                d[j] = std::array::from_fn(|c| (1.0 - part) * d[j - 1][c] + part * d[j][c]);
            }
        }
        Point2::new(d[p][0] / d[p][2], d[p][1] / d[p][2])
    }

    fn reverse(&mut self) {
        self.points.reverse();
        self.weights.reverse();
        self.knots.reverse();
        self.knots.iter_mut().for_each(|knot| *knot = -*knot);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// ROUNDOFF: a few operations on numbers of the size of one.
    const ROUNDOFF: f64 = 1e-15;

    #[test]
    fn a_bulge_is_the_tangent_of_a_quarter_of_the_sweep() {
        let (a, b) = (Point2::new(1.0, 0.0), Point2::new(0.0, 1.0));
        // A quarter to the left about the origin, and the one to the right about (1, 1).
        for (bulge, middle) in [((PI / 8.0).tan(), 0.5f64.sqrt()), (-(PI / 8.0).tan(), 1.0 - 0.5f64.sqrt())] {
            let arc = Piece::with_bulge(a, b, bulge);
            let [start, end] = arc.ends();
            assert!((start - a).norm() < ROUNDOFF && (end - b).norm() < ROUNDOFF, "{arc:?}");
            assert!((arc.point(0.5) - Point2::new(middle, middle)).norm() < ROUNDOFF, "{arc:?}");
            assert!((arc.length() - PI / 2.0).abs() < ROUNDOFF);
        }
        // Half a circle, three quarters.
        let half = Piece::with_bulge(a, -a, 1.0);
        assert!((half.point(0.5) - Point2::new(0.0, 1.0)).norm() < ROUNDOFF);
        let most = Piece::with_bulge(a, Point2::new(0.0, -1.0), (3.0 * PI / 8.0).tan());
        assert!((most.point(1.0 / 3.0) - Point2::new(0.0, 1.0)).norm() < ROUNDOFF, "{most:?}");
    }

    #[test]
    fn a_rational_spline_is_a_circle() {
        let w = 0.5f64.sqrt();
        let mut quarter = Nurbs {
            degree: 2,
            knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            points: vec![Point2::new(1.0, 0.0), Point2::new(1.0, 1.0), Point2::new(0.0, 1.0)],
            weights: vec![1.0, w, 1.0],
        };
        assert!(quarter.is_sound());
        let forth: Vec<_> = (0..=10).map(|i| quarter.point(f64::from(i) / 10.0)).collect();
        assert!(forth.iter().all(|p| (p.coords.norm() - 1.0).abs() < ROUNDOFF), "{forth:?}");
        assert_eq!((forth[0], forth[10]), (quarter.points[0], quarter.points[2]));
        quarter.reverse();
        assert!(quarter.is_sound());
        let back: Vec<_> = (0..=10).rev().map(|i| quarter.point(f64::from(i) / 10.0)).collect();
        assert!(forth.iter().zip(&back).all(|(p, q)| (p - q).norm() < ROUNDOFF));
    }

    /// An arc of 200° is three pieces; under an uneven scale it is that part of the ellipse.
    #[test]
    fn an_arc_under_an_uneven_scale_is_part_of_an_ellipse() {
        let arc = Piece::Arc { centre: Point2::new(0.5, -1.0), radius: 2.0, start: 0.3, sweep: -3.5 };
        let wide = Placement {
            linear: nalgebra::Matrix2::new(0.5, 0.0, 0.0, -0.25),
            shift: Vector2::new(0.125, 1.0),
        };
        let ellipse = arc.placed(&wide);
        let Piece::Spline(curve) = &ellipse else { panic!("{ellipse:?}") };
        assert!(curve.is_sound() && curve.points.len() == 7, "{curve:?}");
        for (end, angle) in ellipse.ends().into_iter().zip([0.3f64, -3.2]) {
            let expected = Point2::new(0.375 + angle.cos(), 1.25 - 0.5 * angle.sin());
            assert!((end - expected).norm() < 4.0 * ROUNDOFF, "{end} {expected}");
        }
        for i in 0..=20 {
            let p = ellipse.point(f64::from(i) / 20.0);
            assert!(((p.x - 0.375).hypot((p.y - 1.25) / 0.5) - 1.0).abs() < 4.0 * ROUNDOFF, "{p}");
        }
    }

    /// A cubic with inner knots: its pieces are those of the polynomial t³ that it is made of.
    #[test]
    fn a_spline_with_inner_knots_reproduces_a_cubic() {
        let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 4.0, 4.0, 4.0, 4.0];
        // The blossom of t³ at three neighbouring knots, and of t at their mean.
        let points = (0..6)
            .map(|i| {
                Point2::new(
                    (knots[i + 1] + knots[i + 2] + knots[i + 3]) / 3.0,
                    knots[i + 1] * knots[i + 2] * knots[i + 3],
                )
            })
            .collect();
        let curve = Nurbs { degree: 3, knots, points, weights: vec![1.0; 6] };
        for i in 0..=16 {
            let u = 0.25 * f64::from(i);
            let p = curve.point(u / 4.0);
            assert!(
                (p.x - u).abs() < 64.0 * ROUNDOFF && (p.y - u.powi(3)).abs() < 64.0 * ROUNDOFF,
                "{u}: {p}"
            );
        }
    }
}
