//! Values at equally distant places, between them by cubic splines.

use nalgebra::{DMatrix, DVector};

/// Many values at places, a column for each place: cubic polynomials between them that meet with one slope and one curvature. The slopes at both ends are those of the cubic
/// polynomial through the four nearest places.
pub(super) struct Along {
    first: f64,
    pitch: f64,
    values: DMatrix<f64>,
    slopes: DMatrix<f64>,
}

impl Along {
    /// Fewest places.
    pub const LEAST: usize = 4;

    /// Values at places from `first` on, a `pitch` apart; four places at least.
    pub fn new(first: f64, pitch: f64, values: DMatrix<f64>) -> Self {
        let last = values.ncols() - 1;
        let end = |at: [usize; 4], sign: f64| {
            let [a, b, c, d] = at.map(|place| values.column(place));
            (a * -11.0 + b * 18.0 - c * 9.0 + d * 2.0) * (sign / (6.0 * pitch))
        };
        let mut slopes = DMatrix::zeros(values.nrows(), values.ncols());
        slopes.set_column(0, &end([0, 1, 2, 3], 1.0));
        slopes.set_column(last, &end([last, last - 1, last - 2, last - 3], -1.0));
        // one curvature at each inner place: s₋ + 4·s + s₊ = 3·(y₊ - y₋)/h, eliminated from the first on
        let mut pivots = vec![1.0; values.ncols()];
        for place in 1..last {
            let right = (values.column(place + 1) - values.column(place - 1)) * (3.0 / pitch);
            let share = 1.0 / pivots[place - 1];
            pivots[place] = if place == 1 { 4.0 } else { 4.0 - share };
            let reduced = right - slopes.column(place - 1) * share;
            slopes.set_column(place, &reduced);
        }
        for place in (1..last).rev() {
            let own = (slopes.column(place) - slopes.column(place + 1)) / pivots[place];
            slopes.set_column(place, &own);
        }
        Self { first, pitch, values, slopes }
    }

    /// The values at `x`; beyond the places the nearest polynomials go on.
    pub fn at(&self, x: f64) -> DVector<f64> {
        let places = (x - self.first) / self.pitch;
        let below = places.floor().clamp(0.0, (self.values.ncols() - 2) as f64);
        let (t, here) = (places - below, below as usize);
        let step = t * t * (3.0 - 2.0 * t);
        let mut values = self.values.column(here) * (1.0 - step);
        values.axpy(step, &self.values.column(here + 1), 1.0);
        values.axpy(t * (1.0 - t) * (1.0 - t) * self.pitch, &self.slopes.column(here), 1.0);
        values.axpy(t * t * (t - 1.0) * self.pitch, &self.slopes.column(here + 1), 1.0);
        values
    }

    /// Weights of so many equally distant places in the values at others, a row for each of these.
    pub fn weights(first: f64, pitch: f64, places: usize, at: &[f64]) -> DMatrix<f64> {
        let along = Self::new(first, pitch, DMatrix::identity(places, places));
        let columns: Vec<DVector<f64>> = at.iter().map(|x| along.at(*x)).collect();
        DMatrix::from_columns(&columns).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the polynomial itself, which the spline and its ends are exact for. Goal: values of a cubic polynomial between its places and at them, and the weights with which they come of those. Accuracy: ROUNDOFF.
    #[test]
    fn a_cubic_polynomial_is_its_own_spline() {
        const ROUNDOFF: f64 = 1e-13;
        let cubic = |x: f64| 2.0 - x + 0.5 * x * x - 0.25 * x * x * x;
        let (first, pitch) = (-0.7, 0.3);
        let values = DMatrix::from_fn(2, 7, |row, place| {
            let x = first + pitch * place as f64;
            if row == 0 { x } else { cubic(x) }
        });
        let along = Along::new(first, pitch, values.clone());
        for x in [-0.7, -0.65, -0.4, 0.01, 0.33, 0.9, 1.1] {
            let found = along.at(x);
            assert!((found[0] - x).abs() < ROUNDOFF && (found[1] - cubic(x)).abs() < ROUNDOFF, "{x} {found}");
            let weights = Along::weights(first, pitch, 7, &[x]);
            assert!(((weights * values.row(1).transpose())[0] - cubic(x)).abs() < ROUNDOFF, "{x}");
        }
    }
}
