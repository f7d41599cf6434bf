//! Half-spaces in normal contact, in the function space of the condensed bodies.
//!
//! The pressure of a contact point is the bilinear hat over its node, and the displacement of a point is the mean
//! over the same hat, as [`super::pair`] forms them on the bodies. A body minus half a pair of half-spaces is then
//! smooth. Uniform pressures on the points' rectangles with the displacement at their centres (Love 1929) have
//! a self-term 1.7 times as large and cannot be compared with the bodies.

use super::Compliance;
use super::point::ContactPoint;
use crate::quadrature::GAUSS_5;
use faer::Mat;
use nalgebra::Vector2;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Two elastic half-spaces under normal pressure (J. Boussinesq 1885; A.E.H. Love, "The stress produced in a
/// semi-infinite solid by pressure on part of the boundary", Phil. Trans. A 228 (1929)).
///
/// The hats are those of a uniform grid with each point's own widths; on a graded grid, where a hat has two different
/// sides, the mean width takes their place.
pub struct HalfSpace {
    /// Contact modulus E*, Pa: 1/E* = (1-ν₁²)/E₁ + (1-ν₂²)/E₂.
    pub contact_modulus: f64,
}

impl Compliance for HalfSpace {
    fn add_to(&self, points: &[ContactPoint], matrix: &mut Mat<f64>) {
        let factor = 1.0 / (PI * self.contact_modulus);
        // on a uniform grid few distances are different
        let mut known: HashMap<[i64; 6], f64> = HashMap::new();
        let picometres = |v: f64| (v * 1e12).round() as i64;
        for j in 0..points.len() {
            for i in 0..=j {
                let d = (points[i].position - points[j].position).abs();
                let (a, b) = (points[i].widths, points[j].widths);
                let key = [d.x, d.y, a.x, a.y, b.x, b.y].map(picometres);
                let value = factor * *known.entry(key).or_insert_with(|| mean_inverse_distance(&d, &a, &b));
                matrix[(i, j)] += value;
                if i != j {
                    matrix[(j, i)] += value;
                }
            }
        }
    }
}

/// Mean of 1/r, 1/m, between two bilinear hats of the half widths `a` and `b`, their centres apart by `d`.
fn mean_inverse_distance(d: &Vector2<f64>, a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    let widest = a.sup(b);
    if d.x.max(d.y) > FAR * widest.x.max(widest.y) {
        // Taylor's series to the second moments of the hats, h²/6; the fourth ones are 0.3·(h/r)⁴ = 5e-6
        let r = d.norm();
        let variance = (a.component_mul(a) + b.component_mul(b)) / 6.0;
        let curvature = |along: f64| 3.0 * (along / r).powi(2) - 1.0;
        return 1.0 / r + 0.5 * (variance.x * curvature(d.x) + variance.y * curvature(d.y)) / r.powi(3);
    }
    // Gauss points on the hat of `a`, between its own kinks and those of the potential of the other hat
    let nodes = |half: f64, shift: f64, other: f64| -> Vec<(f64, f64)> {
        let mut cuts = vec![-half, 0.0, half];
        let inside = |cut: &f64| cut.abs() < half && cut.abs() > 1e-6 * half;
        cuts.extend([-other, 0.0, other].map(|kink| kink - shift).iter().filter(|c| inside(c)));
        cuts.sort_by(f64::total_cmp);
        let panel = |ends: &[f64]| {
            let (middle, reach) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            GAUSS_5.map(|(t, w)| {
                let at = middle + t * reach;
                (at, w * reach / half * (1.0 - at.abs() / half))
            })
        };
        cuts.windows(2).flat_map(panel).collect()
    };
    let across = nodes(a.y, d.y, b.y);
    let mut sum = 0.0;
    for (x, wx) in nodes(a.x, d.x, b.x) {
        for &(y, wy) in &across {
            sum += wx * wy * potential_of_hat(d.x + x, d.y + y, b);
        }
    }
    sum
}

/// Distance, in widths, beyond which two hats are seen by their moments.
const FAR: f64 = 16.0;

/// ∫∫ p dA/r seen from (x, y), with p the bilinear hat at the origin with the half widths `half` and ∫∫ p dA = 1.
///
/// A hat is the second difference of ramps, so the integral is the second difference, in both directions, of the
/// function whose mixed derivative ∂⁴/∂x²∂y² is 1/r.
fn potential_of_hat(x: f64, y: f64, half: &Vector2<f64>) -> f64 {
    let mut sum = 0.0;
    for (i, cx) in [(-1.0, 1.0), (0.0, -2.0), (1.0, 1.0)] {
        for (k, cy) in [(-1.0, 1.0), (0.0, -2.0), (1.0, 1.0)] {
            sum += cx * cy * twice_integrated(x + i * half.x, y + k * half.y);
        }
    }
    sum / (half.x * half.y).powi(2)
}

/// `xy/2·(x·asinh(y/|x|) + y·asinh(x/|y|)) - r³/6`, whose derivative ∂⁴/∂x²∂y² is 1/r.
fn twice_integrated(x: f64, y: f64) -> f64 {
    let product = |p: f64, q: f64| if p == 0.0 { 0.0 } else { p * (q / p.abs()).asinh() };
    0.5 * x * y * (product(x, y) + product(y, x)) - x.hypot(y).powi(3) / 6.0
}

#[cfg(test)]
mod tests {
    use super::super::point::flat_grid;
    use super::*;

    /// MODEL: the fourth moments that are left out at 16 widths, 0.3/16⁴, twice.
    const MODEL: f64 = 1e-5;

    /// Uniform pressure on a rectangle seen from (x, y), `∫∫ dA/r` (Love 1929).
    fn rectangle(x: f64, y: f64, half: &Vector2<f64>) -> f64 {
        let product = |p: f64, q: f64| if p == 0.0 { 0.0 } else { p * (q / p.abs()).asinh() };
        let corner = |u: f64, v: f64| product(u, v) + product(v, u);
        let (a, b, c, e) = (x - half.x, x + half.x, y - half.y, y + half.y);
        corner(b, e) - corner(a, e) - corner(b, c) + corner(a, c)
    }

    /// Source: Love's closed solution for a uniformly loaded rectangle. Goal: the potential of a hat, near and far, is
    /// that of 400 by 400 rectangles which carry its pressure, 1/m. Accuracy: DISCRETISATION, second order in the
    /// rectangles' size over the hat's half width, 1/200² with a factor below four at the peak.
    #[test]
    fn a_hat_is_many_rectangles() {
        const DISCRETISATION: f64 = 1e-4;
        let half = Vector2::new(2e-3, 1.5e-3);
        let parts = 400;
        let small = half / f64::from(parts);
        for (x, y) in [(0.0, 0.0), (1e-3, 0.2e-3), (2e-3, 1.5e-3), (7e-3, -3e-3)] {
            let mut sum = 0.0;
            for i in 0..parts {
                for k in 0..parts {
                    let centre = |n: i32| (2.0 * f64::from(n) + 1.0) / f64::from(parts) - 1.0;
                    let (u, v) = (centre(i), centre(k));
                    let pressure = (1.0 - u.abs()) * (1.0 - v.abs()) / (half.x * half.y);
                    sum += pressure * rectangle(x - u * half.x, y - v * half.y, &small);
                }
            }
            let closed = potential_of_hat(x, y, &half);
            assert!((closed / sum - 1.0).abs() < DISCRETISATION, "{x} {y}: {closed} {sum}");
        }
    }

    /// Source: reciprocity (the mean between two hats is the same either way), and the two formulas of near and far
    /// hats where they meet. Unit 1/m. Accuracy: MODEL, and with hats of different widths DISCRETISATION of five Gauss
    /// points a panel, beside kinks like x²·ln x.
    #[test]
    fn the_mean_is_symmetric_and_continuous() {
        const DISCRETISATION: f64 = 1e-4;
        let (a, b) = (Vector2::new(2e-3, 1.5e-3), Vector2::new(1.2e-3, 0.9e-3));
        for d in [Vector2::zeros(), Vector2::new(2e-3, 0.0), Vector2::new(5e-3, 3e-3)] {
            let (one, other) = (mean_inverse_distance(&d, &a, &b), mean_inverse_distance(&d, &b, &a));
            assert!((one / other - 1.0).abs() < DISCRETISATION, "{d}: {one} {other}");
        }
        let at = |x: f64| mean_inverse_distance(&Vector2::new(x, 3e-3), &a, &a) * x.hypot(3e-3);
        let border = FAR * a.x;
        assert!((at(border * (1.0 - 1e-9)) / at(border * (1.0 + 1e-9)) - 1.0).abs() < MODEL);
    }

    /// Source: Love's solution. Goal: a plateau of equal nodal pressures has, at its middle and beyond the edge's
    /// reach, the mean displacement of the uniformly loaded square with the same force, m. Accuracy: MODEL, the
    /// edge of the plateau falls over one width instead of at once, second order in width over side, (1/20)².
    #[test]
    fn a_plateau_of_hats_is_a_loaded_square() {
        const MODEL: f64 = 0.0025;
        let (n, h) = (21, 1e-3);
        let points = flat_grid((n, n), h, |_, _| 0.0);
        let mut matrix = Mat::zeros(n * n, n * n);
        HalfSpace { contact_modulus: 115e9 }.add_to(&points, &mut matrix);
        let middle = n * n / 2;
        let force = 1e3;
        let displacement: f64 = (0..n * n).map(|j| matrix[(middle, j)] * force).sum();
        let half = Vector2::repeat(0.5 * n as f64 * h);
        let love = rectangle(0.0, 0.0, &half) * force / (h * h) / (PI * 115e9);
        assert!((displacement / love - 1.0).abs() < MODEL, "{displacement} {love}");
    }
}
