//! Powers fitted to measured values.

/// `y = factor·x^exponent`, fitted by least squares in logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// Value at x = 1.
    pub factor: f64,
    /// The exponent.
    pub exponent: f64,
    /// Standard error of the exponent; none for two points.
    pub standard_error: Option<f64>,
    /// Number of points.
    pub points: usize,
}

impl PowerLaw {
    /// The power of some points (x, y); those without logarithms are left out, and there is none for fewer than two different x.
    pub fn fit(points: &[(f64, f64)]) -> Option<Self> {
        let logarithms: Vec<(f64, f64)> = points
            .iter()
            .filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())
            .map(|(x, y)| (x.ln(), y.ln()))
            .collect();
        let count = logarithms.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| logarithms.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
        let spread: f64 = logarithms.iter().map(|p| (p.0 - x).powi(2)).sum();
        if !(spread > 0.0) {
            return None;
        }
        let exponent = logarithms.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
        let left: f64 = logarithms.iter().map(|p| (p.1 - y - exponent * (p.0 - x)).powi(2)).sum();
        let standard_error = (count > 2.0).then(|| (left / (count - 2.0) / spread).sqrt());
        Some(Self { factor: (y - exponent * x).exp(), exponent, standard_error, points: logarithms.len() })
    }

    /// The value at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of some logarithms and sums of order ten.
    const ROUNDOFF: f64 = 1e-12;

    /// Source: a made-up power law y = 3e-6·x^1.4. Goal: factor and exponent, without error; values that have no logarithm are left out.
    #[test]
    fn a_power_law_is_found() {
        let mut points: Vec<(f64, f64)> = [5e4, 1e5, 3e5, 1e6].map(|x: f64| (x, 3e-6 * x.powf(1.4))).to_vec();
        points.extend([(2e5, 0.0), (2e5, f64::NAN), (-1.0, 2.0)]);
        let law = PowerLaw::fit(&points).unwrap();
        assert!((law.exponent - 1.4).abs() < ROUNDOFF && (law.factor / 3e-6 - 1.0).abs() < 1e2 * ROUNDOFF);
        assert!(law.standard_error.unwrap() < 1e2 * ROUNDOFF && law.points == 4);
        assert!((law.at(1e5) / points[1].1 - 1.0).abs() < 1e2 * ROUNDOFF);
    }

    /// Source: least squares by hand. Deviations +d, −d, −d, +d at x = e⁰ … e³ are orthogonal to a line, so that the exponent is exact and its
    /// standard error √(4d²/2)/√5.
    #[test]
    fn the_standard_error_is_that_of_a_line() {
        let d: f64 = 0.01;
        let points: Vec<(f64, f64)> = [d, -d, -d, d]
            .into_iter()
            .enumerate()
            .map(|(n, d)| ((n as f64).exp(), (2.0 + 1.2 * n as f64 + d).exp()))
            .collect();
        let law = PowerLaw::fit(&points).unwrap();
        assert!((law.exponent - 1.2).abs() < ROUNDOFF);
        assert!((law.standard_error.unwrap() - d * (2.0_f64 / 5.0).sqrt()).abs() < ROUNDOFF);
    }

    /// Goal: two points have an exponent without an error, one or none have nothing.
    #[test]
    fn too_few_points_say_nothing() {
        let two = PowerLaw::fit(&[(1.0, 1.0), (2.0, 4.0)]).unwrap();
        assert!((two.exponent - 2.0).abs() < ROUNDOFF && two.standard_error.is_none());
        assert!(PowerLaw::fit(&[(1.0, 1.0), (1.0, 2.0)]).is_none() && PowerLaw::fit(&[]).is_none());
    }
}
