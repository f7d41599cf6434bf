//! Cubic splines through points of the plane, one smooth piece at a time.

use nalgebra::{Point2, Vector2};

use crate::quadrature::GAUSS_5_UNIT;

/// Relative change of the knot distances at which they count as arc lengths.
const ARC_LENGTH_CONVERGED: f64 = 1e-14;
/// Deviation of |dp/ds| from one above which an interval is halved.
const SPEED_TOLERANCE: f64 = 1e-8;
/// Halvings of the knot distance that are tried.
const MAX_REFINEMENTS: usize = 6;

/// One smooth piece of a curve: its points and, where they are known, the unit tangents at its two ends.
pub(crate) struct Piece {
    pub points: Vec<Point2<f64>>,
    pub end_tangents: Option<[Vector2<f64>; 2]>,
}

/// `p(u) = a + b u + c u² + d u³`, u measured from the start of the interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cubic {
    pub a: Point2<f64>,
    pub b: Vector2<f64>,
    pub c: Vector2<f64>,
    pub d: Vector2<f64>,
}

impl Cubic {
    /// From a row of a file: a (y, z), b, c and d.
    pub fn of_row(&[ay, az, by, bz, cy, cz, dy, dz]: &[f64; 8]) -> Self {
        Self {
            a: Point2::new(ay, az),
            b: Vector2::new(by, bz),
            c: Vector2::new(cy, cz),
            d: Vector2::new(dy, dz),
        }
    }

    /// As a row of a file.
    pub fn row(&self) -> [f64; 8] {
        let Self { a, b, c, d } = self;
        [a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y]
    }

    /// The cubic from `p0` to `p1` over the length `h` with the derivatives `m0` and `m1`.
    fn hermite(p0: Point2<f64>, p1: Point2<f64>, m0: Vector2<f64>, m1: Vector2<f64>, h: f64) -> Self {
        let chord = (p1 - p0) / h;
        let c = (3.0 * chord - 2.0 * m0 - m1) / h;
        let d = (m0 + m1 - 2.0 * chord) / (h * h);
        Self { a: p0, b: m0, c, d }
    }

    pub fn point(&self, u: f64) -> Point2<f64> {
        self.a + u * (self.b + u * (self.c + u * self.d))
    }

    pub fn derivative(&self, u: f64) -> Vector2<f64> {
        self.b + u * (2.0 * self.c + 3.0 * u * self.d)
    }

    pub fn second_derivative(&self, u: f64) -> Vector2<f64> {
        2.0 * self.c + 6.0 * u * self.d
    }

    fn arc_length(&self, h: f64) -> f64 {
        GAUSS_5_UNIT.iter().map(|&(x, w)| w * h * self.derivative(x * h).norm()).sum()
    }

    /// Largest | |dp/du| - 1 | seen at nine points of the interval.
    pub fn speed_error(&self, h: f64) -> f64 {
        (0..=8).map(|i| (self.derivative(h * f64::from(i) / 8.0).norm() - 1.0).abs()).fold(0.0, f64::max)
    }
}

/// Knot distances and cubics of a piece, parametrised by arc length.
pub(crate) struct FittedPiece {
    pub lengths: Vec<f64>,
    pub cubics: Vec<Cubic>,
}

/// Interpolates `piece` and makes the parameter the arc length: the knot distances start as chords and are
/// replaced by the lengths of the spline until they stop changing; intervals on which the speed is still off
/// one are halved with points of the spline itself.
pub(crate) fn fit(piece: &Piece) -> FittedPiece {
    let mut points = piece.points.clone();
    let mut lengths: Vec<f64> = points.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
    let mut cubics = interpolate_by_arc_length(&points, piece.end_tangents, &mut lengths);
    for _ in 0..MAX_REFINEMENTS {
        let coarse: Vec<bool> =
            cubics.iter().zip(&lengths).map(|(c, &h)| c.speed_error(h) > SPEED_TOLERANCE).collect();
        if !coarse.contains(&true) {
            break;
        }
        let mut finer_points = vec![points[0]];
        let mut finer_lengths = Vec::new();
        for (i, &halve) in coarse.iter().enumerate() {
            if halve {
                finer_points.push(cubics[i].point(0.5 * lengths[i]));
                finer_lengths.extend([0.5 * lengths[i]; 2]);
            } else {
                finer_lengths.push(lengths[i]);
            }
            finer_points.push(points[i + 1]);
        }
        (points, lengths) = (finer_points, finer_lengths);
        cubics = interpolate_by_arc_length(&points, piece.end_tangents, &mut lengths);
    }
    FittedPiece { lengths, cubics }
}

fn interpolate_by_arc_length(
    points: &[Point2<f64>],
    end_tangents: Option<[Vector2<f64>; 2]>,
    lengths: &mut [f64],
) -> Vec<Cubic> {
    const MAX_SWEEPS: usize = 30;
    let mut cubics = interpolate(points, end_tangents, lengths);
    for _ in 0..MAX_SWEEPS {
        let mut change: f64 = 0.0;
        for (h, cubic) in lengths.iter_mut().zip(&cubics) {
            let length = cubic.arc_length(*h);
            change = change.max((length / *h - 1.0).abs());
            *h = length;
        }
        cubics = interpolate(points, end_tangents, lengths);
        if change < ARC_LENGTH_CONVERGED {
            break;
        }
    }
    cubics
}

/// Twice continuously differentiable cubics through `points` with knot distances `h`; the ends take the given
/// tangents, or else the third derivative runs on through the first and the last inner knot ("not a knot").
fn interpolate(points: &[Point2<f64>], end_tangents: Option<[Vector2<f64>; 2]>, h: &[f64]) -> Vec<Cubic> {
    let n = h.len();
    let chord: Vec<Vector2<f64>> = (0..n).map(|i| (points[i + 1] - points[i]) / h[i]).collect();
    let slopes = match (end_tangents, n) {
        (None, 1) => vec![chord[0]; 2],
        (None, 2) => parabola_slopes(&chord, h),
        _ => spline_slopes(&chord, h, end_tangents),
    };
    (0..n).map(|i| Cubic::hermite(points[i], points[i + 1], slopes[i], slopes[i + 1], h[i])).collect()
}

fn parabola_slopes(chord: &[Vector2<f64>], h: &[f64]) -> Vec<Vector2<f64>> {
    let middle = (chord[0] * h[1] + chord[1] * h[0]) / (h[0] + h[1]);
    vec![2.0 * chord[0] - middle, middle, 2.0 * chord[1] - middle]
}

fn spline_slopes(
    chord: &[Vector2<f64>],
    h: &[f64],
    end_tangents: Option<[Vector2<f64>; 2]>,
) -> Vec<Vector2<f64>> {
    let n = h.len();
    // Rows of the tridiagonal system: below, diagonal, above, right-hand side.
    let mut rows: Vec<(f64, f64, f64, Vector2<f64>)> = Vec::with_capacity(n + 1);
    match end_tangents {
        Some([start, _]) => rows.push((0.0, 1.0, 0.0, start)),
        None => {
            let span = h[0] + h[1];
            let rhs = ((h[0] + 2.0 * span) * h[1] * chord[0] + h[0] * h[0] * chord[1]) / span;
            rows.push((0.0, h[1], span, rhs));
        }
    }
    for i in 1..n {
        let rhs = 3.0 * (h[i] * chord[i - 1] + h[i - 1] * chord[i]);
        rows.push((h[i], 2.0 * (h[i - 1] + h[i]), h[i - 1], rhs));
    }
    match end_tangents {
        Some([_, end]) => rows.push((0.0, 1.0, 0.0, end)),
        None => {
            let span = h[n - 1] + h[n - 2];
            let rhs = (h[n - 1] * h[n - 1] * chord[n - 2]
                + (2.0 * span + h[n - 1]) * h[n - 2] * chord[n - 1])
                / span;
            rows.push((span, h[n - 2], 0.0, rhs));
        }
    }
    solve_tridiagonal(rows)
}

fn solve_tridiagonal(mut rows: Vec<(f64, f64, f64, Vector2<f64>)>) -> Vec<Vector2<f64>> {
    for i in 1..rows.len() {
        let (_, diagonal, above, rhs) = rows[i - 1];
        let factor = rows[i].0 / diagonal;
        rows[i].1 -= factor * above;
        rows[i].3 -= factor * rhs;
    }
    let mut solution = vec![Vector2::zeros(); rows.len()];
    let mut next = Vector2::zeros();
    for i in (0..rows.len()).rev() {
        next = (rows[i].3 - rows[i].2 * next) / rows[i].1;
        solution[i] = next;
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ROUNDOFF: a few hundred operations on numbers of order one.
    const ROUNDOFF: f64 = 1e-12;

    /// Source: a spline with not-a-knot ends reproduces every cubic. Goal: value and derivative between the
    /// knots. Dimensionless.
    #[test]
    fn reproduces_a_cubic_on_uneven_knots() {
        let x = [0.0, 0.3, 1.0, 1.2, 2.0, 2.1];
        let f = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x + 0.25 * x * x * x;
        let df = |x: f64| -2.0 + x + 0.75 * x * x;
        let points: Vec<_> = x.iter().map(|&x| Point2::new(x, f(x))).collect();
        let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
        for ends in [None, Some([Vector2::new(1.0, df(0.0)), Vector2::new(1.0, df(2.1))])] {
            for (i, cubic) in interpolate(&points, ends, &h).iter().enumerate() {
                let u = 0.4 * h[i];
                assert!((cubic.point(u) - Point2::new(x[i] + u, f(x[i] + u))).norm() < ROUNDOFF);
                assert!((cubic.derivative(u) - Vector2::new(1.0, df(x[i] + u))).norm() < ROUNDOFF);
            }
        }
    }

    #[test]
    fn three_points_give_their_parabola() {
        let points = [0.0, 1.0, 3.0].map(|x: f64| Point2::new(x, x * x));
        let cubics = interpolate(&points, None, &[1.0, 2.0]);
        assert!((cubics[1].point(1.0) - Point2::new(2.0, 4.0)).norm() < ROUNDOFF);
        assert!(cubics[0].d.norm() < ROUNDOFF);
    }
}
