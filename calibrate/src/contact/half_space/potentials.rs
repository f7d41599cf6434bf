//! Surface potentials of a bilinear hat of pressure, in closed form.
//!
//! A hat is the second difference of ramps in both directions. Its potential with a kernel is the second difference
//! of a function whose mixed derivative ∂⁴/∂s²∂x² is that kernel; terms of lower than second degree in either
//! coordinate vanish.

use nalgebra::Vector2;

/// The kernels of a half-space under forces on its surface, for an offset (s, x) of the length r, or their means over
/// two hats: `1/r`, `s²/r³` and `s·x/r³` in 1/m, `s/r²` and `x/r²` in 1/m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Kernels {
    /// 1/r; even in s and x.
    pub inverse: f64,
    /// s²/r³; even in s and x. That of x is the rest of 1/r.
    pub across: f64,
    /// s·x/r³; odd in s and in x.
    pub shear: f64,
    /// (s, x)/r²; odd in its own coordinate, even in the other.
    pub gradient: Vector2<f64>,
}

impl Kernels {
    /// The kernels at an offset other than zero.
    pub fn at(s: f64, x: f64) -> Self {
        let square = s * s + x * x;
        let inverse = 1.0 / square.sqrt();
        let cubed = inverse / square;
        Self { inverse, across: s * s * cubed, shear: s * x * cubed, gradient: Vector2::new(s, x) / square }
    }

    pub fn add(&mut self, weight: f64, other: &Self) {
        self.inverse += weight * other.inverse;
        self.across += weight * other.across;
        self.shear += weight * other.shear;
        self.gradient += other.gradient * weight;
    }
}

/// ∫∫ p K dA seen from (s, x) for every kernel K, with p the bilinear hat at the origin with the half widths `half`
/// and ∫∫ p dA = 1.
pub(super) fn hat_potentials(s: f64, x: f64, half: &Vector2<f64>) -> Kernels {
    let mut sum = Kernels::default();
    for (i, cs) in [(-1.0, 1.0), (0.0, -2.0), (1.0, 1.0)] {
        for (k, cx) in [(-1.0, 1.0), (0.0, -2.0), (1.0, 1.0)] {
            sum.add(cs * cx, &twice_integrated(s + i * half.x, x + k * half.y));
        }
    }
    let mut mean = Kernels::default();
    mean.add(1.0 / (half.x * half.y).powi(2), &sum);
    mean
}

/// The functions whose derivatives ∂⁴/∂s²∂x² are the kernels.
///
/// With A = asinh(x/|s|) and B = asinh(s/|x|): `s·x/2·(s·B' + x·A')` less r³/6 for 1/r. As x²/r³ is ∂²r/∂s² and s·x/r³ is
/// -∂²r/∂s∂x, theirs are integrals of r itself; s/r² is ∂(ln r)/∂s.
fn twice_integrated(s: f64, x: f64) -> Kernels {
    let r = s.hypot(x);
    if r == 0.0 {
        return Kernels::default();
    }
    // asinh(q/|p|), multiplied by p or more, so that p = 0 gives zero
    let area = |p: f64, q: f64| if p == 0.0 { 0.0 } else { (q / p.abs()).asinh() };
    let (over_s, over_x) = (area(s, x), area(x, s));
    let cube = r * r * r;
    let inverse = 0.5 * s * x * (s * over_s + x * over_x) - cube / 6.0;
    // that of x²/r³: r integrated twice along x
    let along = cube / 6.0 + 0.5 * s * s * (x * over_s - r);
    let shear = -(2.0 * s * x * r + s.powi(3) * over_s + x.powi(3) * over_x) / 6.0;
    let logarithm = r.ln();
    let gradient = |p: f64, q: f64| {
        // the angle of p over q keeps its sign where q changes its own
        let over = if q == 0.0 { 0.0 } else { (p / q).atan() };
        let under = if p == 0.0 { 0.0 } else { (q / p).atan() };
        p / 6.0 * (3.0 * q * q - p * p) * logarithm + q.powi(3) / 6.0 * over + 0.5 * p * p * q * under
    };
    Kernels {
        inverse,
        across: inverse - along,
        shear,
        gradient: Vector2::new(gradient(s, x), gradient(x, s)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the kernels themselves. Goal: the potentials of a hat, inside, beside and far from it, are those of
    /// 600 by 600 point forces with its weights, 1/m. Accuracy: DISCRETISATION, a point is a part of the hat with an error of
    /// second order in its size over the distance; the nearest one, half a part away, is 1/(2·300) of the hat wide.
    #[test]
    fn a_hat_is_many_points() {
        const DISCRETISATION: f64 = 2e-3;
        let half = Vector2::new(2e-3, 1.5e-3);
        let parts = 600;
        for (s, x) in
            [(0.0, 0.0), (1e-3, 0.2e-3), (-0.7e-3, 1.5e-3), (2e-3, 1.5e-3), (7e-3, -3e-3), (-9e-3, 0.0)]
        {
            let mut sum = Kernels::default();
            for i in 0..parts {
                for k in 0..parts {
                    let centre = |n: i32| (2.0 * f64::from(n) + 1.0) / f64::from(parts) - 1.0;
                    let (u, v) = (centre(i), centre(k));
                    let weight = (1.0 - u.abs()) * (1.0 - v.abs()) * 4.0 / f64::from(parts).powi(2);
                    sum.add(weight, &Kernels::at(s - u * half.x, x - v * half.y));
                }
            }
            let closed = hat_potentials(s, x, &half);
            let scale = sum.inverse;
            for (name, a, b) in [
                ("1/r", closed.inverse, sum.inverse),
                ("s²/r³", closed.across, sum.across),
                ("sx/r³", closed.shear, sum.shear),
                ("s/r²", closed.gradient.x, sum.gradient.x),
                ("x/r²", closed.gradient.y, sum.gradient.y),
            ] {
                assert!((a - b).abs() < DISCRETISATION * scale, "{name} at {s} {x}: {a} {b}");
            }
        }
    }
}
