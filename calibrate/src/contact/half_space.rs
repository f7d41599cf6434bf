//! Half-spaces under normal and tangential forces, in the function space of the condensed bodies.
//!
//! The traction of a contact point is the bilinear hat over its node, and the displacement of a point is the mean
//! over the same hat, as [`super::pair`] forms them on the bodies. A body minus its half-space is then smooth.
//! Uniform pressures on the points' rectangles with the displacement at their centres (Love 1929) have a self-term
//! 1.7 times as large and cannot be compared with the bodies.

mod potentials;
mod means;

pub(super) use means::HatTable;

use super::compliance::Compliance;
use super::point::{ContactPoint, Side};
use crate::solid::Material;
use faer::Mat;
use means::means;
use nalgebra::{Matrix3, Vector2, Vector3};
pub(super) use potentials::Kernels;
use std::cell::RefCell;
use std::collections::HashMap;
use std::f64::consts::PI;

/// One body as an elastic half-space under forces on its surface (J. Boussinesq 1885, V. Cerruti 1882; K.L. Johnson,
/// Contact Mechanics, 1985, sections 3.2 and 3.6): unit forces at the distance r displace the surface by
/// `(1-ν)/(2πG·r)` along the normal, by `((1-ν)/r + ν·s²/r³)/(2πG)` along and `ν·s·x/r³/(2πG)` across a tangential
/// force along s, and by `(1-2ν)/(4πG)·s/r²` along s under a normal force, and back.
///
/// The surface is flat: its coordinates are the arc length of the profile and x. The hats are those of a uniform grid
/// with each point's own widths; on a graded grid, where a hat has two different sides, the mean width takes their place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace {
    /// Shear modulus G, Pa.
    pub shear_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Which body it is: a pressure draws the surface towards it on either side, which for the opposing body is the
    /// other sign of the slip.
    pub side: Side,
}

impl HalfSpace {
    /// A body of `material`.
    pub fn new(material: &Material, side: Side) -> Self {
        Self { shear_modulus: material.shear_modulus(), poisson: material.poisson, side }
    }

    /// Both bodies of one material.
    pub fn both(material: &Material) -> [Self; 2] {
        [Side::Base, Side::Opposing].map(|side| Self::new(material, side))
    }

    /// Factors of the kernels.
    pub(super) fn factors(&self) -> Factors {
        let unit = 1.0 / (2.0 * PI * self.shear_modulus);
        let coupling = 0.5 * (1.0 - 2.0 * self.poisson) * unit;
        Factors {
            inverse: (1.0 - self.poisson) * unit,
            tangential: self.poisson * unit,
            coupling: match self.side {
                Side::Base => coupling,
                Side::Opposing => -coupling,
            },
        }
    }

    /// Means over a hat of displacements (rows: normal, lateral, along the track) under unit forces over another (columns), by the offset from the second to the first and
    /// the widths of both, m; m/N.
    pub(super) fn means(&self, apart: &Vector2<f64>, widths: &[Vector2<f64>; 2]) -> Matrix3<f64> {
        let (means, factors) = (means_at(apart, widths), self.factors());
        Matrix3::from_fn(|to, from| factors.entry(&means, to, from))
    }
}

/// What the kernels of one or several half-spaces are multiplied by, m²/N.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Factors {
    /// Of 1/r, in all directions.
    pub inverse: f64,
    /// Of s²/r³, x²/r³ and s·x/r³, between tangential directions.
    pub tangential: f64,
    /// Of s/r² and x/r², between a tangential direction and the normal; zero for two bodies of one material.
    pub coupling: f64,
}

impl std::ops::AddAssign for Factors {
    fn add_assign(&mut self, other: Self) {
        self.inverse += other.inverse;
        self.tangential += other.tangential;
        self.coupling += other.coupling;
    }
}

impl Factors {
    /// Displacement in the direction `to` (0 normal, 1 lateral, 2 along the track) of a hat under a unit force in the
    /// direction `from` on another, by the means of the kernels for the offset from the second to the first, m/N.
    pub fn entry(&self, means: &Kernels, to: usize, from: usize) -> f64 {
        match (to, from) {
            (0, 0) => self.inverse * means.inverse,
            (1, 1) => self.inverse * means.inverse + self.tangential * means.across,
            (2, 2) => self.inverse * means.inverse + self.tangential * (means.inverse - means.across),
            (1, 2) | (2, 1) => self.tangential * means.shear,
            (to, 0) => self.coupling * means.gradient[to - 1],
            (_, from) => -self.coupling * means.gradient[from - 1],
        }
    }
}

/// The sum of the factors of several half-spaces.
pub(super) fn sum_of_factors(bodies: &[HalfSpace]) -> Factors {
    let mut sum = Factors::default();
    bodies.iter().for_each(|body| sum += body.factors());
    sum
}

/// Displacements (normal, lateral, along the track) at an offset (m) far from a force on the surfaces of `bodies`, m.
pub fn displacement_far_from(
    bodies: &[HalfSpace],
    offset: &Vector2<f64>,
    force: &Vector3<f64>,
) -> Vector3<f64> {
    let (factors, kernels) = (sum_of_factors(bodies), Kernels::at(offset.x, offset.y));
    Vector3::from_fn(|to, _| (0..3).map(|from| factors.entry(&kernels, to, from) * force[from]).sum())
}

impl Compliance for HalfSpace {
    fn add_to(&self, points: &[ContactPoint], matrix: &mut Mat<f64>) {
        let n = points.len();
        let directions = matrix.nrows().checked_div(n).unwrap_or(0);
        let factors = self.factors();
        for j in 0..n {
            for i in 0..=j {
                let apart = points[i].position - points[j].position;
                let means = means_at(&apart, &[points[i].widths, points[j].widths]);
                for to in 0..directions {
                    for from in 0..directions {
                        let value = factors.entry(&means, to, from);
                        matrix[(to * n + i, from * n + j)] += value;
                        if i != j {
                            matrix[(from * n + j, to * n + i)] += value;
                        }
                    }
                }
            }
        }
    }
}

/// Means that a thread has made, at most so many: a table of 2¹⁶ places holds them.
const KEPT: usize = 7 << 13;

/// [`means`] to a picometre of distance and widths. On a mesh few of them are different, and it is the same mesh again and again.
fn known_means(d: &Vector2<f64>, a: &Vector2<f64>, b: &Vector2<f64>) -> Kernels {
    thread_local!(static KNOWN: RefCell<HashMap<[i64; 6], Kernels>> = RefCell::default());
    const UNIT: f64 = 1e-12;
    let key = [d.x, d.y, a.x, a.y, b.x, b.y].map(|v| (v / UNIT).round() as i64);
    KNOWN.with_borrow_mut(|known| {
        if known.len() == KEPT {
            known.clear();
        }
        *known.entry(key).or_insert_with(|| {
            // of the rounded values, so that it does not matter who asked first
            let [dx, dy, ax, ay, bx, by] = key.map(|v| v as f64 * UNIT);
            means(&Vector2::new(dx, dy), &Vector2::new(ax, ay), &Vector2::new(bx, by))
        })
    })
}

/// The known means with the signs of the offset.
fn means_at(apart: &Vector2<f64>, [a, b]: &[Vector2<f64>; 2]) -> Kernels {
    let mut means = known_means(&apart.abs(), a, b);
    let side = Vector2::new(apart.x.signum(), apart.y.signum());
    means.shear *= side.x * side.y;
    means.gradient.component_mul_assign(&side);
    means
}

#[cfg(test)]
mod tests {
    use super::super::point::flat_grid;
    use super::*;

    /// Displacement along s of the middle of a square with the half side `a` under the uniform shear stress 1 along s,
    /// over 2πG: `∫∫ ((1-ν)/r + ν·s²/r³) dA`; both kernels have the same integral over s and x, half of that of 1/r
    /// (Love 1929).
    fn sheared_square(a: f64, poisson: f64) -> f64 {
        let inverse = 8.0 * a * 1.0_f64.asinh();
        (1.0 - poisson) * inverse + 0.5 * poisson * inverse
    }

    /// Source: Love's and Cerruti's integrals over a square. Goal: a plateau of equal nodal forces has, at its middle, the
    /// mean displacement of the uniformly loaded square with the same force, m, along the normal and along both
    /// tangents, and none across. Accuracy: MODEL, the edge of the plateau falls over one width instead of at
    /// once, second order in width over side, (1/20)²; ROUNDOFF for what is zero by symmetry.
    #[test]
    fn a_plateau_of_hats_is_a_loaded_square() {
        const MODEL: f64 = 0.0025;
        const ROUNDOFF: f64 = 1e-12;
        let (n, h) = (21, 1e-3);
        let points = flat_grid((n, n), h, |_, _| 0.0);
        let count = n * n;
        let mut matrix = Mat::zeros(3 * count, 3 * count);
        let body = HalfSpace { shear_modulus: 80e9, poisson: 0.28, side: Side::Base };
        body.add_to(&points, &mut matrix);
        let force = 1e3;
        let displacement = |to: usize, from: usize| -> f64 {
            (0..count).map(|j| matrix[(to * count + count / 2, from * count + j)] * force).sum()
        };
        let unit = force / (h * h) / (2.0 * PI * 80e9);
        let half = 0.5 * n as f64 * h;
        let normal = unit * (1.0 - 0.28) * 8.0 * half * 1.0_f64.asinh();
        let tangential = unit * sheared_square(half, 0.28);
        for (direction, exact) in [(0, normal), (1, tangential), (2, tangential)] {
            let found = displacement(direction, direction);
            assert!((found / exact - 1.0).abs() < MODEL, "{direction}: {found} {exact}");
            for other in (0..3).filter(|other| *other != direction) {
                assert!(displacement(other, direction).abs() < ROUNDOFF * normal);
            }
        }
    }

    /// Source: Maxwell's and Betti's reciprocity; K.L. Johnson, Contact Mechanics, 1985, equation 3.18. Goal: the matrix is
    /// symmetric; a pressure on the base draws the surface around it towards itself, by `(1-2ν)/(4πG·r)` far away, and the
    /// opposing body of the same material the other way, so that both together have no slip. Unit m/N. Accuracy:
    /// ROUNDOFF; MODEL of a hat seen from twenty widths, (1/20)²/6.
    #[test]
    fn a_pressure_draws_the_surface_towards_it() {
        const ROUNDOFF: f64 = 1e-14;
        const MODEL: f64 = 5e-4;
        let h = 1e-3;
        let points = flat_grid((21, 2), h, |_, _| 0.0);
        let n = points.len();
        let of = |body: &HalfSpace| {
            let mut matrix = Mat::<f64>::zeros(3 * n, 3 * n);
            body.add_to(&points, &mut matrix);
            matrix
        };
        let [base, opposing] = HalfSpace::both(&Material::STEEL);
        let (matrix, other) = (of(&base), of(&opposing));
        for i in 0..3 * n {
            for j in 0..3 * n {
                assert!((matrix[(i, j)] - matrix[(j, i)]).abs() < ROUNDOFF * matrix[(0, 0)]);
            }
        }
        // the separation of two points is opposing less base; a force on the base points against the one on the opposing
        // body, so its entries are displacements of the base under forces on the base
        let (first, last) = (0, n - 2);
        let tension_at_first_moves_last = matrix[(n + last, first)];
        let exact = (1.0 - 2.0 * base.poisson) / (4.0 * PI * base.shear_modulus * 20.0 * h);
        assert!(
            (tension_at_first_moves_last / exact - 1.0).abs() < MODEL,
            "{tension_at_first_moves_last} {exact}"
        );
        for i in 0..3 * n {
            for j in 0..3 * n {
                let coupled = (i < n) != (j < n);
                let sum = matrix[(i, j)] + other[(i, j)];
                let expected = if coupled { 0.0 } else { 2.0 * matrix[(i, j)] };
                assert!((sum - expected).abs() < ROUNDOFF * matrix[(0, 0)], "{i} {j}");
            }
        }
    }
}
