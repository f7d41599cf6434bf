//! How large the elements of a section may be at each point of it.

use nalgebra::{Point2, Vector2};

/// Size of an edge as a function of position: the smallest of all prescribed
/// sizes, each growing linearly with the distance from where it is prescribed.
/// So neighbouring elements never differ by more than the growth allows.
#[derive(Debug, Clone)]
pub(super) struct SizeField {
    sources: Vec<(Point2<f64>, f64)>,
    growth: f64,
    largest: f64,
}

impl SizeField {
    /// An empty field with `growth` per unit of distance and `largest` as upper bound.
    pub(super) fn new(growth: f64, largest: f64) -> Self {
        Self { sources: Vec::new(), growth, largest }
    }

    /// Prescribes the size at a point.
    pub(super) fn add(&mut self, point: Point2<f64>, size: f64) {
        self.sources.push((point, size));
    }

    /// Size at a point.
    pub(super) fn at(&self, point: &Point2<f64>) -> f64 {
        self.sources
            .iter()
            .map(|(q, size)| size + self.growth * (point - q).norm())
            .fold(self.largest, f64::min)
    }
}

/// A polyline with its arc length.
#[derive(Debug, Clone)]
pub(super) struct Polyline {
    points: Vec<Point2<f64>>,
    arc: Vec<f64>,
}

impl Polyline {
    /// Takes the vertices over; repeated vertices are dropped.
    pub(super) fn new(vertices: &[Point2<f64>]) -> Self {
        let mut points: Vec<Point2<f64>> = Vec::with_capacity(vertices.len());
        let mut arc: Vec<f64> = Vec::with_capacity(vertices.len());
        for p in vertices {
            match points.last() {
                None => arc.push(0.0),
                Some(q) => {
                    let step = (p - q).norm();
                    if step <= REPEATED {
                        continue;
                    }
                    arc.push(arc[arc.len() - 1] + step);
                }
            }
            points.push(*p);
        }
        Self { points, arc }
    }

    /// Whole length.
    pub(super) fn length(&self) -> f64 {
        *self.arc.last().unwrap_or(&0.0)
    }

    /// Segment that holds the arc length `t`.
    fn segment(&self, t: f64) -> usize {
        self.arc.partition_point(|&a| a <= t).clamp(1, self.points.len() - 1) - 1
    }

    /// Point at the arc length `t`.
    pub(super) fn point(&self, t: f64) -> Point2<f64> {
        let k = self.segment(t);
        let u = ((t - self.arc[k]) / (self.arc[k + 1] - self.arc[k])).clamp(0.0, 1.0);
        self.points[k] + u * (self.points[k + 1] - self.points[k])
    }

    /// Unit direction at the arc length `t`.
    pub(super) fn direction(&self, t: f64) -> Vector2<f64> {
        let k = self.segment(t);
        (self.points[k + 1] - self.points[k]).normalize()
    }

    /// Divides the piece between two arc lengths into edges of the wanted sizes
    /// and each of them into two; returns the arc lengths of all points, ends included.
    pub(super) fn divide(&self, from: f64, to: f64, size: &SizeField) -> Vec<f64> {
        // Number of edges that fit up to each of many fine steps.
        let steps = ((to - from) / FINE_STEP).ceil().max(8.0) as usize;
        let step = (to - from) / steps as f64;
        let mut count = vec![0.0];
        for k in 0..steps {
            let middle = from + (k as f64 + 0.5) * step;
            count.push(count[k] + step / size.at(&self.point(middle)));
        }
        let points = 2 * (count[steps].round() as usize).max(1);
        let mut positions = Vec::with_capacity(points + 1);
        for e in 0..=points {
            let wanted = count[steps] * e as f64 / points as f64;
            let k = count.partition_point(|&c| c <= wanted).clamp(1, steps) - 1;
            let part = (wanted - count[k]) / (count[k + 1] - count[k]);
            positions.push(from + (k as f64 + part) * step);
        }
        positions
    }

    /// Area between the line and its chord from the arc length `from` to `to`, positive where the line lies to the right
    /// of the chord.
    pub(super) fn area_to_chord(&self, from: f64, to: f64) -> f64 {
        let (start, end) = (self.point(from), self.point(to));
        let inner = self.points.get(self.segment(from) + 1..=self.segment(to)).unwrap_or_default();
        let line = inner.iter().chain([&end]).map(|point| point - start);
        line.scan(Vector2::zeros(), |before, here| {
            let area = 0.5 * before.perp(&here);
            *before = here;
            Some(area)
        })
        .sum()
    }

    /// Sum of the signed turning angles (rad, positive to the left) at the
    /// vertices strictly between the arc lengths `from` and `to`.
    pub(super) fn turning(&self, from: f64, to: f64) -> f64 {
        let first = self.arc.partition_point(|&a| a <= from).max(1);
        let last = self.arc.partition_point(|&a| a < to).min(self.points.len() - 1);
        (first..last).map(|k| self.turn_at(k)).sum()
    }

    fn turn_at(&self, k: usize) -> f64 {
        let a = self.points[k] - self.points[k - 1];
        let b = self.points[k + 1] - self.points[k];
        a.perp(&b).atan2(a.dot(&b))
    }

    /// Arc lengths of the corners: where the line turns by more than
    /// `CORNER_ANGLE` within `window`. A corner is the middle of the turn, so
    /// that a small rounding becomes one corner.
    pub(super) fn corners(&self, window: f64) -> Vec<f64> {
        let mut corners = Vec::new();
        let mut k = 1;
        while k + 1 < self.points.len() {
            // The longest run of vertices from k on within the window.
            let mut total = 0.0;
            let mut end = k;
            while end + 1 < self.points.len() && self.arc[end] - self.arc[k] <= window {
                total += self.turn_at(end);
                end += 1;
            }
            if total.abs() < CORNER_ANGLE {
                k += 1;
                continue;
            }
            // A turn spreads over more vertices: follow it while it turns the same way, up to where the next sharp corner is.
            while end + 1 < self.points.len()
                && (TURN_OF_A_STRAIGHT..SHARP).contains(&(self.turn_at(end) * total.signum()))
                && self.arc[end] - self.arc[k] <= 3.0 * window
            {
                total += self.turn_at(end);
                end += 1;
            }
            let mut half = 0.0;
            let middle = (k..end)
                .find(|&i| {
                    half += self.turn_at(i);
                    half.abs() >= 0.5 * total.abs() - TURN_OF_A_STRAIGHT
                })
                .unwrap_or(k);
            corners.push(self.arc[middle]);
            k = end;
        }
        corners
    }
}

/// Step (m) with which the sizes along a line are added up.
const FINE_STEP: f64 = 2.5e-4;
/// Vertices closer than this (m) are one vertex.
const REPEATED: f64 = 1e-9;
/// Turn (rad) within the window that makes a corner: 40 degrees.
const CORNER_ANGLE: f64 = 0.70;
/// Turn (rad) at a single vertex that is a corner, however near to another one beyond the window: 60 degrees.
const SHARP: f64 = 1.05;
/// Turn (rad) at a vertex below which the line counts as straight there.
const TURN_OF_A_STRAIGHT: f64 = 1e-3;

/// Thickness of the section at a point of its outline: distance along the
/// inward normal to the other side. `closed` is the whole outline.
pub(super) fn thickness(closed: &[Point2<f64>], point: &Point2<f64>, inward: &Vector2<f64>) -> f64 {
    let mut nearest = f64::INFINITY;
    for k in 0..closed.len() {
        let a = closed[k];
        let b = closed[(k + 1) % closed.len()];
        let edge = b - a;
        let denominator = inward.perp(&edge);
        if denominator.abs() < f64::EPSILON * edge.norm() {
            continue;
        }
        let along_ray = (a - point).perp(&edge) / denominator;
        let along_edge = (a - point).perp(inward) / denominator;
        // The start itself lies on the outline: skip what is nearer than any real thickness.
        if along_ray > 1e-4 && (0.0..=1.0).contains(&along_edge) {
            nearest = nearest.min(along_ray);
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of floating-point arithmetic on lengths of order one.
    const ROUNDOFF: f64 = 1e-12;

    #[test]
    fn the_size_grows_linearly_from_its_sources() {
        let mut field = SizeField::new(0.5, 3.0);
        field.add(Point2::new(0.0, 0.0), 1.0);
        field.add(Point2::new(10.0, 0.0), 2.0);
        assert!((field.at(&Point2::new(2.0, 0.0)) - 2.0).abs() < ROUNDOFF);
        assert!((field.at(&Point2::new(9.0, 0.0)) - 2.5).abs() < ROUNDOFF);
        assert!((field.at(&Point2::new(5.0, 0.0)) - 3.0).abs() < ROUNDOFF);
    }

    #[test]
    fn a_small_rounding_is_one_corner_and_a_large_one_none() {
        let arc = |radius: f64, centre: Point2<f64>| -> Vec<Point2<f64>> {
            (0..=20)
                .map(|i| {
                    let a = -std::f64::consts::FRAC_PI_2 * (1.0 - f64::from(i) / 20.0);
                    centre + radius * Vector2::new(a.cos(), a.sin())
                })
                .collect()
        };
        let line = |radius: f64| {
            let mut points = vec![Point2::new(-50.0, -radius)];
            points.extend(arc(radius, Point2::origin()));
            points.push(Point2::new(radius, 50.0));
            Polyline::new(&points)
        };
        let small = line(2.0);
        let corners = small.corners(4.0);
        assert_eq!(corners.len(), 1);
        let middle = 50.0 + 2.0 * std::f64::consts::FRAC_PI_4;
        // Within one vertex of the rounding (DISCRETISATION).
        assert!((corners[0] - middle).abs() < 2.0 * std::f64::consts::FRAC_PI_2 / 20.0);
        assert!(line(20.0).corners(4.0).is_empty());
    }

    #[test]
    fn a_line_is_divided_by_the_wanted_sizes() {
        let mut size = SizeField::new(0.0, 2.5e-3);
        size.add(Point2::origin(), 2.5e-3);
        let line = Polyline::new(&[Point2::origin(), Point2::new(10e-3, 0.0), Point2::new(10e-3, 10e-3)]);
        let positions = line.divide(0.0, line.length(), &size);
        assert_eq!(positions.len(), 17);
        for (k, t) in positions.iter().enumerate() {
            assert!((t - 1.25e-3 * k as f64).abs() < ROUNDOFF);
        }
    }

    #[test]
    fn the_thickness_of_a_plate_is_its_thickness() {
        let plate =
            [Point2::new(0.0, 0.0), Point2::new(10.0, 0.0), Point2::new(10.0, 2.0), Point2::new(0.0, 2.0)];
        let t = thickness(&plate, &Point2::new(4.0, 0.0), &Vector2::new(0.0, 1.0));
        assert!((t - 2.0).abs() < ROUNDOFF);
    }

    /// Goal: two right angles on a sharp edge of 8 mm are two corners, those of a chamfer of 45 degrees and the vertices of a rounding one, which is its
    /// middle. Accuracy: ROUNDOFF; the rounding has a vertex every 0.5 mm.
    #[test]
    fn sharp_corners_near_each_other_are_kept() {
        let line = |points: &[(f64, f64)]| -> Polyline {
            Polyline::new(&points.iter().map(|(y, z)| Point2::new(1e-3 * y, 1e-3 * z)).collect::<Vec<_>>())
        };
        let corners = |line: &Polyline| -> Vec<f64> { line.corners(4e-3).iter().map(|t| 1e3 * t).collect() };
        let near = |found: &[f64], expected: &[f64], within: f64| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < within), "{found:?}");
        };
        let edge = line(&[(0.0, 0.0), (40.0, 0.0), (40.0, 8.0), (0.0, 8.0)]);
        near(&corners(&edge), &[40.0, 48.0], 1e3 * ROUNDOFF);
        let chamfer = line(&[(0.0, 0.0), (40.0, 0.0), (45.0, 5.0), (45.0, 40.0)]);
        assert_eq!(corners(&chamfer).len(), 1);
        let mut round = vec![(0.0, 0.0)];
        round.extend(
            (0..=9)
                .map(|i| (0.5 * std::f64::consts::PI * f64::from(i) / 9.0).sin_cos())
                .map(|(sin, cos)| (40.0 + 3.0 * sin, 3.0 - 3.0 * cos)),
        );
        round.push((43.0, 40.0));
        near(&corners(&line(&round)), &[40.0 + 0.75 * std::f64::consts::PI], 0.5);
    }
}
