//! The statics of a rail between ends that hinder it from warping.
//!
//! A section that is held does not warp. Torsion then decays into the rail as Vlasov has it, over the root of `E·Iw/(G·J)`, a sixth of a metre. What a
//! shear force does to a section fades faster: the first centimetres at a held end are as if they had no shear flexibility. A beam of two rotations and a twist a node, as
//! [`RailBeam`](super::RailBeam) is, has neither.

use crate::analytic::beam::restrained_twist;
use crate::section_analysis::SectionProperties;
use crate::solid::Material;
use nalgebra::{Matrix2, Vector2};

/// A straight rail whose ends hold their sections. Places are metres from its first end; displacements y and z and the rotation about x those of the line of shear centres,
/// in the axes of the section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldRail {
    length: f64,
    /// Against deflection along y and z, N·m² and N.
    bending: [f64; 2],
    shear: [f64; 2],
    /// N·m² and N·m⁴.
    torsion: f64,
    warping: f64,
    /// Length at either end without shear flexibility, m.
    inset: f64,
}

impl HeldRail {
    /// A rail of a `length` (m) that has no shear flexibility over an `inset` (m) at either end.
    pub fn new(properties: &SectionProperties, material: &Material, length: f64, inset: f64) -> Self {
        let (young, shear) = (material.young, material.shear_modulus());
        let p = properties;
        Self {
            length,
            bending: [young * p.iyy, young * p.ixx],
            shear: [p.shear_coefficient_lateral, p.shear_coefficient_vertical].map(|k| k * shear * p.area),
            torsion: shear * p.torsion_constant,
            warping: young * p.warping_constant,
            inset: inset.min(0.5 * length),
        }
    }

    /// Flexibility at a place: displacements along y and z (m/N) and rotation (rad/(N·m)) under unit loads there.
    pub fn flexibility(&self, x: f64) -> [f64; 3] {
        let x = x.clamp(0.0, self.length);
        [self.deflection(0, x), self.deflection(1, x), self.twist(x, x)]
    }

    /// Rotation at a place under a unit torque at another, rad/(N·m).
    pub fn twist(&self, load: f64, at: f64) -> f64 {
        let within = |x: f64| x > 0.0 && x < self.length;
        match within(load) && within(at) {
            true => restrained_twist(self.length, self.torsion, self.warping, load, at),
            false => 0.0,
        }
    }

    /// Deflection under a unit force at `x`: that of a cantilever whose tip forces and moments bring back.
    fn deflection(&self, axis: usize, x: f64) -> f64 {
        let (bending, length) = (self.bending[axis], self.length);
        let sheared = |x: f64| (x - self.inset).clamp(0.0, length - 2.0 * self.inset) / self.shear[axis];
        let of_tip = Matrix2::new(
            length.powi(3) / (3.0 * bending) + sheared(length),
            length.powi(2) / (2.0 * bending),
            length.powi(2) / (2.0 * bending),
            length / bending,
        );
        let tip =
            Vector2::new(x * x * (3.0 * length - x) / (6.0 * bending) + sheared(x), x * x / (2.0 * bending));
        let own = x.powi(3) / (3.0 * bending) + sheared(x);
        // a length, and a stiffness against bending: two independent motions of the tip
        let held = of_tip.cholesky().map_or(f64::NAN, |c| tip.dot(&c.solve(&tip)));
        own - held
    }
}

#[cfg(test)]
mod tests {
    use super::super::rail::tests::properties;
    use super::*;
    use crate::beam::{RailBeam, Torsion};

    /// Condition of the cantilever's tip, length to the fourth power over that of a millimetre.
    const ROUNDOFF: f64 = 1e-8;

    /// Source: the rail beam, whose nodes have the exact statics of Timoshenko's beam, and its torsion at midspan, which is Vlasov's there. Goal: without an inset the flexibilities of 60E1 of half a metre,
    /// in m/N and rad/(N·m), at all its nodes. The torsion of both differs elsewhere, and the beam's is the larger.
    #[test]
    fn without_an_inset_it_is_the_beam() {
        let length = 0.5;
        let held = HeldRail::new(&properties(), &Material::STEEL, length, 0.0);
        let beam =
            RailBeam::rail(&properties(), &Material::STEEL, length, 20, 0.0, Torsion::RestrainedWarping)
                .unwrap();
        for node in 0..=20 {
            let x = 0.025 * f64::from(node);
            let (found, exact) = (held.flexibility(x), beam.at_place(x));
            for axis in 0..2 {
                let off = (found[axis] - exact[axis]).abs();
                assert!(off < ROUNDOFF * beam.at_place(0.25)[axis], "{x} {found:?} {exact:?}");
            }
            let twisted = found[2] / beam.at_place(0.25)[2];
            let of_beam = exact[2] / beam.at_place(0.25)[2];
            match node {
                0 | 20 => assert!(twisted == 0.0 && of_beam == 0.0),
                10 => assert!((twisted - 1.0).abs() < ROUNDOFF, "{twisted}"),
                _ => assert!(0.0 < twisted && twisted < of_beam, "{x}: {twisted} {of_beam}"),
            }
        }
    }

    /// Source: a force at midspan is carried by equal forces at both ends. Goal: an inset takes its length off the shear flexibility there, `e/(2κGA)` (m/N); at a place inside of
    /// it nothing is sheared; both halves are each other's mirror image.
    #[test]
    fn an_inset_has_no_shear_flexibility() {
        let (length, inset) = (0.5, 0.03);
        let [without, with] =
            [0.0, inset].map(|inset| HeldRail::new(&properties(), &Material::STEEL, length, inset));
        for axis in 0..2 {
            let taken = without.flexibility(0.25)[axis] - with.flexibility(0.25)[axis];
            assert!((taken / (0.5 * inset / with.shear[axis]) - 1.0).abs() < ROUNDOFF, "{taken}");
            // a fixed beam at 20 mm hardly bends: less than a cantilever of that length
            let near = with.flexibility(0.02)[axis];
            assert!(0.0 < near && near < 0.02_f64.powi(3) / (3.0 * with.bending[axis]), "{near}");
            let mirror = (with.flexibility(0.1)[axis] / with.flexibility(0.4)[axis] - 1.0).abs();
            assert!(mirror < ROUNDOFF, "{mirror}");
        }
        assert_eq!(with.flexibility(0.1)[2], without.flexibility(0.1)[2]);
    }
}
