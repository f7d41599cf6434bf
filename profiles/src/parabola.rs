//! Parabolas through points by least squares.

use nalgebra::{Cholesky, Const, Matrix3, Matrix3x2, Vector2, Vector3};

/// A parabola `c₀ + c₁·t + c₂·t²` in the plane.
pub struct Parabola {
    /// c₀, c₁ and c₂ as rows.
    pub coefficients: Matrix3x2<f64>,
    factor: Cholesky<f64, Const<3>>,
}

fn row(t: f64) -> Vector3<f64> {
    Vector3::new(1.0, t, t * t)
}

impl Parabola {
    /// The parabola through values at places `t` with weights; `None` where the places do not determine it. The places are of the order of one.
    pub fn through(samples: impl IntoIterator<Item = (f64, f64, Vector2<f64>)>) -> Option<Self> {
        let (mut normal, mut right) = (Matrix3::zeros(), Matrix3x2::zeros());
        for (t, weight, value) in samples {
            normal += weight * row(t) * row(t).transpose();
            right += weight * row(t) * value.transpose();
        }
        let factor = normal.cholesky()?;
        Some(Self { coefficients: factor.solve(&right), factor })
    }

    /// The value at a place.
    pub fn at(&self, t: f64) -> Vector2<f64> {
        self.coefficients.transpose() * row(t)
    }

    /// Standard deviation of the slope c₁ for values of unit variance.
    pub fn slope_deviation(&self) -> f64 {
        self.factor.inverse()[(1, 1)].sqrt()
    }
}
