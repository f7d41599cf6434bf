//! How figures show the two profiles.

use nalgebra::Point2;
use plotters::style::RGBColor;

/// Inside of the wheel.
pub(crate) const WHEEL_FILL: RGBColor = RGBColor(238, 241, 246);

/// A rectangle that outlines are cut at.
pub(crate) struct Window {
    pub low: Point2<f64>,
    pub high: Point2<f64>,
}

impl Window {
    fn contains(&self, p: &Point2<f64>) -> bool {
        (self.low.x..=self.high.x).contains(&p.x) && (self.low.y..=self.high.y).contains(&p.y)
    }

    /// The parts of a fine polyline inside the window.
    pub fn pieces<'a>(&self, line: &'a [Point2<f64>]) -> Vec<&'a [Point2<f64>]> {
        line.split(|p| !self.contains(p)).filter(|piece| piece.len() > 1).collect()
    }

    /// The part of a closed outline inside the window, cut at one edge after the other.
    pub fn polygon(&self, outline: &[Point2<f64>]) -> Vec<Point2<f64>> {
        type Inside<'w> = Box<dyn Fn(&Point2<f64>) -> f64 + 'w>;
        let edges: [Inside<'_>; 4] = [
            Box::new(|p| p.x - self.low.x),
            Box::new(|p| self.high.x - p.x),
            Box::new(|p| p.y - self.low.y),
            Box::new(|p| self.high.y - p.y),
        ];
        edges.iter().fold(outline.to_vec(), |points, inside| {
            let mut cut = Vec::new();
            for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
                let (da, db) = (inside(a), inside(b));
                if da >= 0.0 {
                    cut.push(*a);
                }
                if (da >= 0.0) != (db >= 0.0) {
                    cut.push(a + (b - a) * (da / (da - db)));
                }
            }
            cut
        })
    }
}

/// A polyline with points so close that it may be cut at any of them.
pub(crate) fn fine(line: impl Iterator<Item = Point2<f64>>) -> Vec<Point2<f64>> {
    /// About a pixel of the picture, m.
    const STEP: f64 = 4e-4;
    let mut points: Vec<Point2<f64>> = Vec::new();
    for point in line {
        if let Some(last) = points.last().copied() {
            let pieces = ((point - last).norm() / STEP).ceil().clamp(1.0, 1e4) as usize;
            points.extend((1..pieces).map(|n| last + (point - last) * (n as f64 / pieces as f64)));
        }
        points.push(point);
    }
    points
}
