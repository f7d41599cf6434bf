//! The beam by its natural modes, as one of its sections sees them.

use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen, Vector3};
use railspring_profiles::error::{Error, Result};
use std::f64::consts::TAU;

use super::factor::NODE;
use super::rail::RailBeam;

/// A mode that has less than this share of the section's flexibility in each direction does not move it.
const LEAST_MOVED: f64 = 1e-6;

/// A natural mode with a mass of 1 kg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionMode {
    /// Square of the angular frequency, 1/s².
    pub square: f64,
    /// Motion of the section in the mode: y and z of the node line (m/m) and the rotation about x (rad/m), world axes.
    pub section: Vector3<f64>,
}

/// What of a beam moves one of its sections.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionModes {
    /// Modes by ascending frequency.
    pub modes: Vec<SectionMode>,
    /// Flexibility of the section beyond these modes: y, z (m) and rotation (rad) under forces (N) and a torque (N·m), world axes.
    pub rest: Matrix3<f64>,
}

impl SectionMode {
    /// Flexibility of the section in the mode.
    pub fn flexibility(&self) -> Matrix3<f64> {
        self.section * self.section.transpose() / self.square
    }
}

impl RailBeam {
    /// The modes up to a frequency (Hz) that move the section at `x` (m from the first end), and what follows forces at once beyond them.
    ///
    /// # Errors
    /// [`railspring_profiles::error::NumericsError`] for a section without mass.
    pub fn modes_at(&self, x: f64, highest: f64) -> Result<SectionModes> {
        let element = self.of_length();
        let free = self.free();
        let assembled = |matrix: &nalgebra::SMatrix<f64, 12, 12>| {
            let mut whole = DMatrix::<f64>::zeros(free.len(), free.len());
            let place: Vec<Option<usize>> = {
                let mut place = vec![None; NODE * (self.elements() + 1)];
                free.iter().enumerate().for_each(|(row, &dof)| place[dof] = Some(row));
                place
            };
            for first in (0..self.elements()).map(|element| NODE * element) {
                for (i, k) in (0..2 * NODE).flat_map(|i| (0..2 * NODE).map(move |k| (i, k))) {
                    if let (Some(row), Some(column)) = (place[first + i], place[first + k]) {
                        // the beam does not move along its axis
                        let of = |i: usize| 6 * (i / NODE) + 1 + i % NODE;
                        whole[(row, column)] += matrix[(of(i), of(k))];
                    }
                }
            }
            whole
        };
        let singular = || Error::from(self.singular());
        let factor = assembled(&element.mass()).cholesky().ok_or_else(singular)?.unpack();
        let of_mass = |mut matrix: DMatrix<f64>| {
            factor.solve_lower_triangular_mut(&mut matrix);
            matrix
        };
        let scaled = of_mass(of_mass(assembled(&element.stiffness())).transpose());
        let natural = SymmetricEigen::new((&scaled + scaled.transpose()) * 0.5);
        let rows = self.section_rows(x);
        let section: Vec<DVector<f64>> = (rows.rows.iter())
            .map(|of_nodes| {
                let value = |&dof: &usize| {
                    let (node, i) = ((dof / NODE).wrapping_sub(rows.element), dof % NODE);
                    of_nodes.get(node).map_or(0.0, |of_node| of_node[i])
                };
                of_mass(DMatrix::from_iterator(free.len(), 1, free.iter().map(value))).column(0).into()
            })
            .collect();
        let all = self.section_flexibility(x);
        let mut modes: Vec<SectionMode> = (natural.eigenvalues.iter().enumerate())
            .map(|(n, &square)| SectionMode {
                square,
                section: Vector3::from_fn(|i, _| section[i].dot(&natural.eigenvectors.column(n))),
            })
            .filter(|mode| mode.square <= (TAU * highest).powi(2))
            .filter(|mode| {
                let own = mode.flexibility();
                (0..3).any(|i| own[(i, i)] > LEAST_MOVED * all[(i, i)])
            })
            .collect();
        modes.sort_by(|a, b| a.square.total_cmp(&b.square));
        let rest = modes.iter().fold(all, |rest, mode| rest - mode.flexibility());
        Ok(SectionModes { modes, rest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{BeamSection, End};

    /// A thin square beam of steel, 20 mm wide, whose shear and rotary inertia hardly count.
    fn thin(ends: [End; 2], angle: f64) -> RailBeam {
        let (side, density) = (0.02_f64, 7850.0);
        let (area, inertia) = (side * side, side.powi(4) / 12.0);
        let section = BeamSection {
            axial: 210e9 * area,
            bending_y: 210e9 * inertia,
            bending_z: 2.0 * 210e9 * inertia,
            shear_y: 1e12,
            shear_z: 1e12,
            torsion: 80e9 * 2.0 * inertia,
            mass: density * area,
            rotary_y: 1e-9,
            rotary_z: 1e-9,
            polar: density * 2.0 * inertia,
            centroid: [0.0; 2],
        };
        RailBeam::new(section, 2.0, 24, angle, ends).unwrap()
    }

    /// Source: frequencies of a clamped Euler beam, (4.730041, 10.995608)²/(2π·L²)·√(EI/m) in its two first symmetric modes (W. Weaver, S. Timoshenko, D. Young, Vibration Problems in Engineering, 5th edition, section 5.11),
    /// and of a rod in torsion, c/(2L)·(1, 3). Goal: at midspan the beam has just these modes (Hz) in each direction, in the axes of a section that is turned as well. Accuracy: ELEMENTS, 24 consistent elements to a beam,
    /// the third torsional mode with linear functions: (3π/24)²/24.
    #[test]
    fn a_clamped_beam_has_its_natural_frequencies() {
        const BENDING: f64 = 2e-4;
        const TORSION: f64 = 7e-3;
        for angle in [0.0, 0.3] {
            let beam = thin([End::Fixed; 2], angle);
            let found = beam.modes_at(1.0, 2500.0).unwrap();
            let section = beam.section();
            let bending =
                |stiffness: f64, root: f64| root * root / (TAU * 4.0) * (stiffness / section.mass).sqrt();
            let torsion = |n: f64| n / 4.0 * (section.torsion / section.polar).sqrt();
            let (sin, cos) = f64::sin_cos(angle);
            for (direction, exact, accuracy) in [
                (
                    Vector3::new(cos, sin, 0.0),
                    [4.730041, 10.995608].map(|r| bending(section.bending_y, r)),
                    BENDING,
                ),
                (
                    Vector3::new(-sin, cos, 0.0),
                    [4.730041, 10.995608].map(|r| bending(section.bending_z, r)),
                    BENDING,
                ),
                (Vector3::z(), [1.0, 3.0].map(torsion), TORSION),
            ] {
                let moved = found.modes.iter().filter(|mode| mode.section.dot(&direction).abs() > 1e-6);
                let frequencies: Vec<f64> = moved.map(|mode| mode.square.sqrt() / TAU).collect();
                assert!(frequencies.len() >= 2, "{direction:?} {frequencies:?} {exact:?}");
                for (found, exact) in frequencies.iter().zip(exact) {
                    assert!((found / exact - 1.0).abs() < accuracy, "{found} {exact}");
                }
            }
        }
    }

    /// Source: the beam's own statics. Goal: modes and what lies beyond them have the flexibility of the
    /// section (m/N, rad/(N·m)) wherever it is, between nodes as well. With all modes nothing is left but the
    /// element's own flexibility between its nodes. No mode moves a section at a held end. Accuracy: ROUNDOFF
    /// of numbers whose squares are 10⁸ apart.
    #[test]
    fn modes_and_the_rest_are_the_flexibility() {
        const ROUNDOFF: f64 = 1e-7;
        let beam = thin([End::Fixed, End::Pinned], 0.1);
        for x in [0.5, 1.0, 1.3] {
            let whole = beam.section_flexibility(x);
            let of = |highest: f64| beam.modes_at(x, highest).unwrap();
            let some = of(3000.0);
            let sum = some.modes.iter().fold(some.rest, |sum, mode| sum + mode.flexibility());
            assert!((sum - whole).amax() < ROUNDOFF * whole.amax());
            let all = of(1e9).rest;
            let at_node = x != 1.3;
            for i in 0..3 {
                let left = all[(i, i)].abs() / whole[(i, i)];
                assert!(!at_node || left < 10.0 * LEAST_MOVED, "{x} {i} {left}");
                assert!(some.rest[(i, i)] > 0.0);
            }
        }
        assert!(beam.modes_at(0.0, 1e5).unwrap().modes.is_empty());
    }
}
