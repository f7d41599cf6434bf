//! How the head of the rail moves where the wheel is.
//!
//! The head moves with the section of the beam under it and, beyond that, at once with the force on it. In the middle of a long rail it has all of the section's motion and
//! the flexibility of the condensed head. Near a held end a beam without warping is too flexible: there the head has a share of its motion only, such that the beam has no more than a rail whose ends hinder it from
//! warping ([`HeldRail`]); what such a rail has beyond the beam's share, and the head's flexibility at that distance, follow the force. So the head on its rail is as flexible as the
//! solid's everywhere, it stores no negative energy, and forces and motions belong to each other.

use nalgebra::{Matrix3, Vector3};

use crate::element::condensed::parts::{EndPlace, HeldEnd, in_world, positive};
use railspring_calibrate::beam::{HeldRail, RailBeam};

/// Distance of the first places from the end and from each other, m, and what it grows by.
const SPACING: f64 = 2.5e-3;
const GROWTH: f64 = 0.06;

/// Values of a [`HeadAt`] along the rail: its share (y, y with z, z, rotation), its flexibility, and its twist.
const VALUES: usize = 13;

/// The head at a place of the rail; motions y, z (m) and rotation about x (rad), forces (N) and torque (N·m), about the node line, in world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HeadAt {
    /// What it has of the motion of the beam's section.
    pub share: Matrix3<f64>,
    /// Its motion under forces on it beyond that.
    pub flexibility: Matrix3<f64>,
    /// Its motion under a torque of 1 N·m at the middle of the rail beyond that.
    pub twist: Vector3<f64>,
}

impl HeadAt {
    /// The head that moves with its section and by a flexibility beyond it.
    pub fn on_section(flexibility: Matrix3<f64>) -> Self {
        Self { share: Matrix3::identity(), flexibility, twist: Vector3::zeros() }
    }

    /// Motion of the head beyond its section's under a force on it and a `torsion` at the middle of the rail.
    pub fn moved(&self, force: &Vector3<f64>, torsion: f64) -> Vector3<f64> {
        self.flexibility * force + self.twist * torsion
    }

    /// Elastic energy beyond the beam's under a force and a torsion, J, but for what the torsion alone stores.
    pub fn stored(&self, force: &Vector3<f64>, torsion: f64) -> f64 {
        0.5 * force.dot(&(self.flexibility * force)) + torsion * self.twist.dot(force)
    }

    /// Rotation of the middle of the rail beyond the beam's under a force on the head, rad.
    pub fn turned(&self, force: &Vector3<f64>) -> f64 {
        self.twist.dot(force)
    }

    /// Work of what moves the wheel to another place of the rail, J, where it is `there`: what the head stores more, less what the force on the head and the torsion of the rail do, which change in proportion
    /// on the way.
    pub fn driven(&self, there: &Self, forces: [&Vector3<f64>; 2], torsions: [f64; 2]) -> f64 {
        let [before, after] = forces;
        let of_force = before.dot(&((there.flexibility - self.flexibility) * after));
        let of_torsion = (there.twist - self.twist).dot(&(before * torsions[1] + after * torsions[0]));
        -0.5 * (of_force + of_torsion)
    }
}

/// The head along a rail.
#[derive(Debug, Clone)]
pub(super) enum Head {
    /// Everywhere as in the middle.
    Same(HeadAt),
    /// By the distance from the nearer end of a rail of a length, m.
    ByDistance(f64, Curve<VALUES>),
}

impl Head {
    /// The head of the middle everywhere.
    pub fn same(flexibility: Matrix3<f64>) -> Self {
        Self::Same(HeadAt::on_section(flexibility))
    }

    /// The head on a `beam` whose ends are those of a `rail`.
    pub fn between_held_ends(beam: &RailBeam, rail: &HeldRail, end: &HeldEnd) -> Self {
        let of_end = of_end(end);
        let (half, angle, torsion) = (0.5 * beam.length(), beam.angle(), beam.section().torsion);
        let mut distances = vec![0.0];
        let mut distance: f64 = SPACING;
        while distance < half - 0.5 * SPACING {
            distances.push(distance);
            distance += SPACING.max(GROWTH * distance);
        }
        distances.push(half);
        let at = |distance: f64| {
            // in the limit at the end
            let (held, bent) = (rail.flexibility(distance), beam.at_place(distance));
            let near = distance.max(distances[1]);
            let (held_near, bent_near) = (rail.flexibility(near), beam.at_place(near));
            let share = [0, 1, 2].map(|i| (held_near[i] / bent_near[i]).clamp(0.0, 1.0).sqrt());
            let beyond = [0, 1, 2].map(|i| (held[i] - share[i] * share[i] * bent[i]).max(0.0));
            let [yy, yz, yr, zz, zr, rr, y, z, turned] = of_end.at(distance);
            let flexibility = positive(in_world(angle, beyond) + symmetric([yy, yz, yr, zz, zr, rr]));
            // a torque at the middle turns a beam in proportion to the distance from its end
            let turned = turned + rail.twist(half, distance) - share[2] * distance / (2.0 * torsion);
            let share = in_world(angle, share);
            let [yy, yz, yr, zz, zr, rr] = entries(&flexibility);
            let [of_y, of_both, of_z] = [(0, 0), (0, 1), (1, 1)].map(|at| share[at]);
            [of_y, of_both, of_z, share[(2, 2)], yy, yz, yr, zz, zr, rr, y, z, turned]
        };
        let places = distances.iter().map(|&distance| (distance, at(distance))).collect();
        Self::ByDistance(beam.length(), Curve::new(places))
    }

    /// The head at a place, m from the first end.
    pub fn at(&self, x: f64) -> HeadAt {
        match self {
            Self::Same(head) => *head,
            Self::ByDistance(length, curve) => {
                let [of_y, of_both, of_z, of_turn, yy, yz, yr, zz, zr, rr, y, z, turned] =
                    curve.at(x.min(length - x));
                let share = Matrix3::new(of_y, of_both, 0.0, of_both, of_z, 0.0, 0.0, 0.0, of_turn);
                HeadAt {
                    share,
                    flexibility: storing(symmetric([yy, yz, yr, zz, zr, rr])),
                    twist: Vector3::new(y, z, turned),
                }
            }
        }
    }
}

/// The head against a held rail by its distance from the end, where it does not move.
fn of_end(end: &HeldEnd) -> Curve<9> {
    let values = |EndPlace { distance, flexibility, twist }: &EndPlace| {
        let [yy, yz, yr, zz, zr, rr] = entries(flexibility);
        (*distance, [yy, yz, yr, zz, zr, rr, twist.x, twist.y, twist.z])
    };
    Curve::new(std::iter::once((0.0, [0.0; 9])).chain(end.places.iter().map(values)).collect())
}

/// A flexibility that stores no negative energy: the nearest one of one that would, by the misfit of what it is made from or between two places.
fn storing(flexibility: Matrix3<f64>) -> Matrix3<f64> {
    let f = &flexibility;
    let pair = |i: usize, k: usize| f[(i, i)] * f[(k, k)] - f[(i, k)] * f[(k, i)];
    let alone = (0..3).all(|i| f[(i, i)] >= 0.0);
    let stores =
        alone && pair(0, 1) >= 0.0 && pair(0, 2) >= 0.0 && pair(1, 2) >= 0.0 && f.determinant() >= 0.0;
    if stores { flexibility } else { positive(flexibility) }
}

fn entries(m: &Matrix3<f64>) -> [f64; 6] {
    [m[(0, 0)], m[(0, 1)], m[(0, 2)], m[(1, 1)], m[(1, 2)], m[(2, 2)]]
}

fn symmetric([yy, yz, yr, zz, zr, rr]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(yy, yz, yr, yz, zz, zr, yr, zr, rr)
}

/// Values at places, between them by cubic polynomials that meet with one slope; constant beyond the last, where they have none.
#[derive(Debug, Clone)]
pub(super) struct Curve<const N: usize> {
    places: Vec<(f64, [f64; N])>,
    slopes: Vec<[f64; N]>,
}

impl<const N: usize> Curve<N> {
    /// From two places at least, ascending.
    fn new(places: Vec<(f64, [f64; N])>) -> Self {
        let last = places.len() - 1;
        let chord = |n: usize, i: usize| {
            let [(a, from), (b, to)] = [&places[n], &places[n + 1]];
            ((to[i] - from[i]) / (b - a), b - a)
        };
        // of the parabola through a place and its neighbours
        let slope = |n: usize, i: usize| {
            if n == last {
                return 0.0;
            }
            let (after, next) = chord(n, i);
            match n.checked_sub(1) {
                None => after,
                Some(n) => {
                    let (before, previous) = chord(n, i);
                    (before * next + after * previous) / (next + previous)
                }
            }
        };
        let slopes = (0..=last).map(|n| std::array::from_fn(|i| slope(n, i))).collect();
        Self { places, slopes }
    }

    fn at(&self, x: f64) -> [f64; N] {
        let (first, last) = (&self.places[0], &self.places[self.places.len() - 1]);
        if x <= first.0 || x >= last.0 {
            return if x <= first.0 { first.1 } else { last.1 };
        }
        let upper = self.places.partition_point(|(place, _)| *place <= x);
        let [(a, from), (b, to)] = [&self.places[upper - 1], &self.places[upper]];
        let [out, into] = [&self.slopes[upper - 1], &self.slopes[upper]];
        let (length, t) = (b - a, (x - a) / (b - a));
        let step = t * t * (3.0 - 2.0 * t);
        let [leaving, arriving] = [t * (1.0 - t) * (1.0 - t) * length, t * t * (t - 1.0) * length];
        std::array::from_fn(|i| from[i] + step * (to[i] - from[i]) + leaving * out[i] + arriving * into[i])
    }
}
