//! How the head of the rail moves where the wheel is.
//!
//! The head moves with the section of the beam under it and, beyond that, at once with the force on it. In the middle of a long rail it has all of the section's motion and
//! the flexibility of the condensed head. Near a held end a beam without warping is too flexible: there the head has a share of its motion only.

use nalgebra::{Matrix3, Vector3};

use crate::curve::Curve;
use crate::wheel::positive;

/// Values of a [`HeadAt`] along the rail: its share (y, y with z, z, rotation), its flexibility, and its twist.
pub const VALUES: usize = 13;

/// The head at a place of the rail; motions y, z (m) and rotation about x (rad), forces (N) and torque (N·m), about the node line, in world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadAt {
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

    /// Of its values along the rail.
    pub fn of_values(values: [f64; VALUES]) -> Self {
        let [of_y, of_both, of_z, of_turn, yy, yz, yr, zz, zr, rr, y, z, turned] = values;
        Self {
            share: Matrix3::new(of_y, of_both, 0.0, of_both, of_z, 0.0, 0.0, 0.0, of_turn),
            flexibility: storing(symmetric([yy, yz, yr, zz, zr, rr])),
            twist: Vector3::new(y, z, turned),
        }
    }

    /// Its values along the rail, as [`VALUES`].
    pub fn values(&self) -> [f64; VALUES] {
        let Self { share, flexibility, twist } = self;
        let [yy, yz, yr, zz, zr, rr] = entries(flexibility);
        let [of_y, of_both, of_z, of_turn] = [(0, 0), (0, 1), (1, 1), (2, 2)].map(|at| share[at]);
        [of_y, of_both, of_z, of_turn, yy, yz, yr, zz, zr, rr, twist.x, twist.y, twist.z]
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
#[derive(Debug, Clone, PartialEq)]
pub enum Head {
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

    /// The head of a rail of a `length` (m) with held ends, by ascending distance (m) from the nearer one; two places at least.
    pub fn by_distance(length: f64, places: &[(f64, HeadAt)]) -> Self {
        Self::ByDistance(length, Curve::new(places.iter().map(|(at, head)| (*at, head.values())).collect()))
    }

    /// Length of a rail with held ends, m.
    pub fn length(&self) -> Option<f64> {
        match self {
            Self::Same(_) => None,
            Self::ByDistance(length, _) => Some(*length),
        }
    }

    /// The head at a place, m from the first end.
    pub fn at(&self, x: f64) -> HeadAt {
        match self {
            Self::Same(head) => *head,
            Self::ByDistance(length, curve) => HeadAt::of_values(curve.at(x.min(length - x))),
        }
    }
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

/// The parts of a symmetric matrix, by rows.
pub fn entries(m: &Matrix3<f64>) -> [f64; 6] {
    [m[(0, 0)], m[(0, 1)], m[(0, 2)], m[(1, 1)], m[(1, 2)], m[(2, 2)]]
}

/// The symmetric matrix of parts by rows.
pub fn symmetric([yy, yz, yr, zz, zr, rr]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(yy, yz, yr, yz, zz, zr, yr, zr, rr)
}
