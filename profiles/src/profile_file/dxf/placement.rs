//! Maps of the plane: where a block is put, and a drawing seen from below.

use nalgebra::{Matrix2, Point2, Vector2};

/// A linear map of the plane and a shift after it, in units of the drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    pub linear: Matrix2<f64>,
    pub shift: Vector2<f64>,
}

impl Placement {
    /// Everything stays where it is.
    pub fn identity() -> Self {
        Self { linear: Matrix2::identity(), shift: Vector2::zeros() }
    }

    /// x is turned over.
    pub fn mirror() -> Self {
        Self { linear: Matrix2::new(-1.0, 0.0, 0.0, 1.0), shift: Vector2::zeros() }
    }

    /// Where a point goes.
    pub fn of(&self, p: Point2<f64>) -> Point2<f64> {
        Point2::from(self.linear * p.coords + self.shift)
    }

    /// The map `first` and then this one.
    pub fn after(&self, first: &Self) -> Self {
        Self { linear: self.linear * first.linear, shift: self.linear * first.shift + self.shift }
    }

    /// The factor of a map that keeps circles, negative for one that turns them over; none for one that makes ellipses of
    /// them.
    pub fn similarity(&self) -> Option<f64> {
        /// A smaller difference of the scales, and a smaller cosine between the axes, are rounding.
        const ROUNDING: f64 = 1e-9;
        let [a, b] = [self.linear.column(0), self.linear.column(1)];
        let size = a.norm().max(b.norm());
        let same =
            (a.norm() - b.norm()).abs() <= ROUNDING * size && a.dot(&b).abs() <= ROUNDING * size * size;
        same.then(|| size.copysign(self.linear.determinant()))
    }
}
