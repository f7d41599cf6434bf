//! How far a measured profile is from its standard.

use super::robust::sorted;
use crate::verify::quantile;

/// Deviation of a measured wheel or rail from its standard along the profile.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shape {
    /// Lateral coordinates in the frame of the profile, mm, ascending; the same for all shapes of a table.
    pub y_mm: Vec<f64>,
    /// Deviation at each of them, µm; positive where material is missing.
    pub off_um: Vec<f64>,
}

impl Shape {
    /// Whether every coordinate has a deviation that is a number, and there are two at least.
    pub fn is_whole(&self) -> bool {
        self.y_mm.len() > 1
            && self.y_mm.len() == self.off_um.len()
            && self.y_mm.iter().chain(&self.off_um).all(|value| value.is_finite())
    }

    /// Root mean square of the difference to another shape on the same coordinates, µm.
    pub fn distance(&self, other: &Self) -> f64 {
        let squares = self.off_um.iter().zip(&other.off_um).map(|(a, b)| (a - b) * (a - b));
        (squares.sum::<f64>() / self.off_um.len().max(1) as f64).sqrt()
    }
}

/// The shapes of some bodies on the coordinates of the first.
pub struct Shapes<'a> {
    /// The coordinates, mm; empty without shapes.
    pub y_mm: &'a [f64],
    /// The shape of each body; none where it has none, one with gaps, or one on other coordinates.
    pub of: Vec<Option<&'a Shape>>,
    /// Bodies whose shape is left out for one of the last two.
    pub left_out: usize,
}

impl<'a> Shapes<'a> {
    /// Of bodies with these shapes.
    pub fn of(given: Vec<Option<&'a Shape>>) -> Self {
        let y_mm = given.iter().flatten().find(|shape| shape.is_whole()).map_or(&[][..], |shape| &shape.y_mm);
        let count = given.iter().flatten().count();
        let of: Vec<Option<&Shape>> = given
            .into_iter()
            .map(|shape| shape.filter(|shape| shape.is_whole() && shape.y_mm == y_mm))
            .collect();
        let left_out = count - of.iter().flatten().count();
        Self { y_mm, of, left_out }
    }

    /// The deviations of 5 and 95 % of the shapes of some bodies at each coordinate, µm.
    pub fn band(&self, bodies: impl Iterator<Item = usize> + Clone) -> Vec<[f64; 2]> {
        let at = |n: usize| {
            let values = sorted(bodies.clone().filter_map(|body| Some(self.of[body]?.off_um[n])));
            [0.05, 0.95].map(|part| quantile(&values, part).unwrap_or(f64::NAN))
        };
        (0..self.y_mm.len()).map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: by hand. Goal: differences of 3 and 4 µm have a mean square of 12.5; gaps and other lengths are no whole shape. Exact.
    #[test]
    fn distances_are_mean_squares() {
        let shape = |off: &[f64]| Shape { y_mm: vec![0.0, 1.0], off_um: off.to_vec() };
        assert_eq!(shape(&[0.0, 0.0]).distance(&shape(&[3.0, -4.0])), 12.5_f64.sqrt());
        assert!(shape(&[0.0, 1.0]).is_whole());
        assert!(!shape(&[0.0, f64::NAN]).is_whole() && !shape(&[0.0]).is_whole());
        assert!(!Shape::default().is_whole());
    }

    /// Goal: a shape on other coordinates or with a gap is left out and counted; the band of 0, 1, ... 100 µm is 5 to 95.
    #[test]
    fn shapes_share_coordinates() {
        let mut shapes: Vec<Shape> =
            (0..=100).map(|n| Shape { y_mm: vec![0.0, 1.0], off_um: vec![f64::from(n), 0.0] }).collect();
        shapes.push(Shape { y_mm: vec![0.0, 2.0], off_um: vec![0.0; 2] });
        shapes.push(Shape { y_mm: vec![0.0, 1.0], off_um: vec![0.0, f64::NAN] });
        let shapes = Shapes::of(shapes.iter().map(Some).chain([None]).collect());
        assert_eq!((shapes.of.len(), shapes.left_out), (104, 2));
        assert_eq!(shapes.band(0..104), [[5.0, 95.0], [0.0, 0.0]]);
        assert!(Shapes::of(vec![None]).band(0..1).is_empty());
    }
}
