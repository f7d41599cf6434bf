//! How much the points of a measurement scatter, and how long the waves are in which they do.
//!
//! Five neighbouring points have one combination that no cubic has: their fourth divided difference. Divided by the
//! root of its squared weights it has the standard deviation of a single point. An arc of 13 mm leaves in it 0.01 µm
//! between points 0.5 mm apart, a curvature that jumps from 1/80 to 1/13 mm leaves 1 µm in three of them. The largest
//! quarter of all is left out, and with it joints, corners and spikes; the mean of the squares, unlike a median, does not
//! become zero where the file rounds its numbers to more than the scatter.
//!
//! Neighbours of a measurement that was smoothed before, or taken more closely than the instrument sees, err alike:
//! their differences are small and their waves are not. So means of 2, 4, 8 ... neighbours are looked at in the same
//! way, up to a length below which no wear has its shape. Means over the length l of white scatter σ at the distance h
//! have the deviation σ·√(h/l), hence the same density σ²·h as the points; of correlated scatter they have more. The
//! largest density counts.

use nalgebra::{Point2, Vector2};

use crate::units::MILLIMETRE;

/// Largest length (m) over which the means of neighbours are taken.
const LONGEST_MEAN: f64 = 0.5 * MILLIMETRE;
/// Share of the differences that counts, the smallest ones ...
const COUNTED: f64 = 0.75;
/// ... and the mean square of that share of a normal variable of unit variance: 1 − 2q·φ(q)/0.75 with q = 1.1503.
const MEAN_SQUARE_OF_COUNTED: f64 = 0.368;
/// How much larger the density of means is where their points err alike: the densities of white scatter differ by a tenth and less.
const ALIKE: f64 = 1.5;
/// Points of a difference.
const WINDOW: usize = 5;
/// Fewest differences of means from which their deviation is taken.
const FEWEST: usize = 40;

/// The scatter of a measurement across its profile.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scatter {
    /// Standard deviation of a point, m.
    pub deviation: f64,
    /// Variance times the length over which it is independent, m³: of white scatter σ²·h.
    pub density: f64,
    /// Usual distance of the points, m.
    pub step: f64,
    /// Neighbours that err alike, as far as the means of so many tell.
    pub together: usize,
}

/// Measures the scatter of a profile that consists of `pieces` of points (m, in order along it), between which it has corners.
/// It is zero if no piece has five points.
pub fn scatter(pieces: &[Vec<Point2<f64>>]) -> Scatter {
    let mut steps: Vec<f64> =
        pieces.iter().flat_map(|piece| piece.windows(2)).map(|w| (w[1] - w[0]).norm()).collect();
    if steps.is_empty() {
        return Scatter::default();
    }
    steps.sort_unstable_by(f64::total_cmp);
    let step = steps[steps.len() / 2];
    let (deviation, _) = of_points(pieces);
    let of_point = deviation * deviation * step;
    let mut found = Scatter { deviation, density: of_point, step, together: 1 };
    let mut count = 2;
    while count as f64 * step <= LONGEST_MEAN {
        let means: Vec<Vec<Point2<f64>>> = pieces.iter().map(|piece| means(piece, count)).collect();
        let (deviation, differences) = of_points(&means);
        if differences < FEWEST {
            break;
        }
        found.deviation = found.deviation.max(deviation);
        let density = deviation * deviation * step * count as f64;
        if density > found.density && density > ALIKE * of_point {
            found.together = count;
        }
        found.density = found.density.max(density);
        count *= 2;
    }
    found
}

/// The means of `count` neighbours each.
fn means(points: &[Point2<f64>], count: usize) -> Vec<Point2<f64>> {
    let mean =
        |w: &[Point2<f64>]| Point2::from(w.iter().map(|p| p.coords).sum::<Vector2<f64>>() / count as f64);
    points.chunks_exact(count).map(mean).collect()
}

/// Standard deviation of a point, m, and the number of differences from which it is taken.
fn of_points(pieces: &[Vec<Point2<f64>>]) -> (f64, usize) {
    let mut squares: Vec<f64> =
        pieces.iter().flat_map(|piece| piece.windows(WINDOW)).filter_map(difference).map(|d| d * d).collect();
    squares.sort_unstable_by(f64::total_cmp);
    let counted = (COUNTED * squares.len() as f64).ceil() as usize;
    if counted == 0 {
        return (0.0, 0);
    }
    let mean = squares[..counted].iter().sum::<f64>() / counted as f64;
    ((mean / MEAN_SQUARE_OF_COUNTED).sqrt(), squares.len())
}

/// The fourth divided difference of five points across their chord, in units of a single point, m. `None` where they do
/// not follow each other along it.
fn difference(points: &[Point2<f64>]) -> Option<f64> {
    let chord = points[WINDOW - 1] - points[0];
    let length = chord.norm();
    let along = |p: &Point2<f64>| (p - points[0]).dot(&chord) / (length * length);
    let places: Vec<f64> = points.iter().map(along).collect();
    if !places.windows(2).all(|w| w[0] < w[1]) {
        return None;
    }
    let (mut sum, mut squares) = (0.0, 0.0);
    for (i, p) in points.iter().enumerate() {
        let others = (0..WINDOW).filter(|&j| j != i);
        let weight = 1.0 / others.map(|j| places[i] - places[j]).product::<f64>();
        sum += weight * chord.perp(&(p - points[0])) / length;
        squares += weight * weight;
    }
    let difference = sum / squares.sqrt();
    difference.is_finite().then_some(difference)
}
