//! What carries the rail nodes: a beam in modal coordinates, or rigid ground.

use faer::Mat;
use nalgebra::{DMatrix, DVector, Matrix3, Point2, Vector3};

use railspring_calibrate::beam::{RailBeam, RailModes};
use railspring_calibrate::energy::PartEnergy;
use railspring_calibrate::error::Result;
use railspring_calibrate::linear_part::{LinearPart, LinearStep};
use railspring_calibrate::newmark::{Motion, Newmark};

/// What carries the rail.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "a model has one")]
pub enum RailSupport {
    /// The rail does not move.
    Rigid,
    /// The rail is a beam, whose node line passes the world point (y, z).
    Beam {
        /// The beam.
        beam: RailBeam,
        /// Where its node line (the shear centres) passes the plane of the profile, m.
        node_line: Point2<f64>,
        /// Damping proportional to stiffness, s, as [`railspring_calibrate::solid::Material::damping`].
        damping: f64,
    },
}

/// Motion of the rail in modal coordinates.
#[derive(Debug, Clone)]
pub(super) struct RailState {
    motions: Vec<Motion>,
}

impl RailState {
    /// Motions of the modes.
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }
}

/// The rail prepared for a run.
pub(super) struct RailDynamics<'a> {
    beam: &'a RailBeam,
    modes: RailModes,
    damping: Vec<f64>,
    /// Modal rows of the rotation about x at the middle, where a torsion acts.
    middle: DVector<f64>,
}

/// What acts on the rail besides the contact, and where the contact is.
#[derive(Debug, Clone, Copy)]
pub(super) struct RailLoad {
    /// Position of the wheel, m from the first end.
    pub x: f64,
    /// Torsion about x at the middle, N·m.
    pub torsion: f64,
}

/// The rail over steps of one length. Its interface is the section at the wheel in directions 1, 2 and rotation 3.
pub(super) struct Rail<'a> {
    dynamics: &'a RailDynamics<'a>,
    scheme: Newmark,
    /// Effective stiffness of the modes.
    stiffness: DVector<f64>,
}

/// A step of the rail.
pub(super) struct RailStep<'s> {
    rail: &'s Rail<'s>,
    state: &'s RailState,
    free: Vector3<f64>,
    flexibility: Mat<f64>,
    /// Modal rows of the section at the wheel, and displacements without contact.
    rows: DMatrix<f64>,
    modal_free: DVector<f64>,
}

impl<'a> RailDynamics<'a> {
    pub fn new(beam: &'a RailBeam, damping: f64) -> Result<Self> {
        let modes = beam.modes()?;
        let damping = modes.squares.iter().map(|square| damping * square).collect();
        let middle = modes.project(&beam.section_motion(0.5 * beam.length())[2]);
        Ok(Self { beam, modes, damping, middle })
    }

    /// Modal rows of the motion in directions 1, 2 and rotation 3 at `x`: y, −z and −(rotation about x).
    fn rows(&self, x: f64) -> DMatrix<f64> {
        let [y, z, rx] = self.beam.section_motion(x).map(|row| self.modes.project(&row));
        DMatrix::from_columns(&[y, -z, -rx])
    }

    /// The rail at rest, with its acceleration under `load` and a contact force (directions 1, 2 and moment 3).
    pub fn start(&self, load: &RailLoad, contact: Vector3<f64>) -> RailState {
        let load = &self.middle * load.torsion + self.rows(load.x) * contact;
        RailState { motions: load.iter().map(|&a| Motion { u: 0.0, v: 0.0, a }).collect() }
    }

    /// Energies after a step of `step` s from `before` to `after` with the mean `torsion` (N·m) over it, J; with the work of the torsion.
    pub fn energy(&self, before: &RailState, after: &RailState, torsion: f64, step: f64) -> PartEnergy {
        let mut energy = PartEnergy::default();
        for (i, (before, after)) in before.motions.iter().zip(&after.motions).enumerate() {
            let moved = after.u - before.u;
            energy.kinetic += 0.5 * after.v * after.v;
            energy.elastic += 0.5 * self.modes.squares[i] * after.u * after.u;
            energy.work += torsion * self.middle[i] * moved;
            energy.damped += if step > 0.0 { self.damping[i] * moved * moved / step } else { 0.0 };
        }
        energy
    }

    /// The rail over steps of `scheme`.
    pub fn over(&self, scheme: &Newmark) -> Rail<'_> {
        let stiffness = DVector::from_fn(self.damping.len(), |i, _| {
            scheme.acceleration + scheme.velocity * self.damping[i] + self.modes.squares[i]
        });
        Rail { dynamics: self, scheme: *scheme, stiffness }
    }
}

impl LinearPart for Rail<'_> {
    type State = RailState;
    type Load = RailLoad;
    type Step<'s>
        = RailStep<'s>
    where
        Self: 's;

    fn predict<'s>(&'s self, state: &'s RailState, load: &RailLoad) -> RailStep<'s> {
        let (dynamics, scheme) = (self.dynamics, &self.scheme);
        let modal_free = DVector::from_fn(state.motions.len(), |i, _| {
            let m = &state.motions[i];
            let load = dynamics.middle[i] * load.torsion;
            (load + scheme.inertia(m) + dynamics.damping[i] * scheme.damping(m)) / self.stiffness[i]
        });
        let rows = dynamics.rows(load.x);
        let mut sum = Matrix3::zeros();
        for (i, stiffness) in self.stiffness.iter().enumerate() {
            let row: Vector3<f64> = rows.fixed_view::<1, 3>(i, 0).transpose();
            sum += row * row.transpose() / *stiffness;
        }
        let free = rows.tr_mul(&modal_free).fixed_rows::<3>(0).into_owned();
        let flexibility = Mat::from_fn(3, 3, |i, j| sum[(i, j)]);
        RailStep { rail: self, state, free, flexibility, rows, modal_free }
    }
}

impl LinearStep for RailStep<'_> {
    type State = RailState;

    fn free(&self) -> &[f64] {
        self.free.as_slice()
    }

    fn flexibility(&self) -> &Mat<f64> {
        &self.flexibility
    }

    fn finish(self, forces: &[f64]) -> RailState {
        let Rail { scheme, stiffness, .. } = self.rail;
        let motions = self.state.motions.iter().enumerate().map(|(i, m)| {
            let load: f64 = (0..3).map(|j| self.rows[(i, j)] * forces[j]).sum();
            scheme.advance(m, self.modal_free[i] + load / stiffness[i])
        });
        RailState { motions: motions.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use railspring_calibrate::beam::{BeamSection, End};
    use railspring_calibrate::linear_part::conformance::Trial;

    /// A rail of 0.6 m, turned, its centroid beside the node line, so that all three coordinates are coupled.
    fn beam() -> RailBeam {
        let section = BeamSection {
            axial: 1.6e9,
            bending_y: 6e6,
            bending_z: 1e6,
            shear_y: 2e8,
            shear_z: 3e8,
            torsion: 4e5,
            mass: 60.0,
            rotary_y: 0.23,
            rotary_z: 0.04,
            polar: 0.3,
            centroid: [0.01, 0.04],
        };
        RailBeam::new(section, 0.6, 8, 0.025, [End::Fixed, End::Pinned]).unwrap()
    }

    fn displacement(dynamics: &RailDynamics, x: f64, state: &RailState) -> Vec<f64> {
        let rows = dynamics.rows(x);
        (0..3).map(|j| state.motions.iter().enumerate().map(|(i, m)| rows[(i, j)] * m.u).sum()).collect()
    }

    fn numbers(state: &RailState) -> Vec<Vec<f64>> {
        let each = |of: fn(&Motion) -> f64| state.motions.iter().map(of).collect();
        vec![each(|m| m.u), each(|m| m.v), each(|m| m.a)]
    }

    /// Goal: the rail obeys the rules of a linear part, with and without damping and dissipation, inside an element, at a node and over
    /// its held ends, where nothing moves. Without both its energy (J) is the work of the forces. Accuracy: ROUNDOFF of
    /// sums over 44 modes in 40 steps, 44·40·1e-16, relative.
    #[test]
    fn the_rail_is_a_linear_part() {
        const ROUNDOFF: f64 = 1e-12;
        let beam = beam();
        for (damping, dissipation) in [(0.0, 0.0), (6e-6, 0.0), (0.0, 0.05), (6e-6, 0.05)] {
            let dynamics = RailDynamics::new(&beam, damping).unwrap();
            let part = dynamics.over(&Newmark::new(1e-4, dissipation));
            for x in [0.0, 0.2, 0.225, 0.6] {
                let load = |torsion| RailLoad { x, torsion };
                let trial = Trial {
                    part: &part,
                    rest: RailState { motions: vec![Motion::default(); beam.unknowns()] },
                    loads: [load(800.0), load(-300.0), load(500.0)],
                    force: 5e3,
                    displacement: &|state| displacement(&dynamics, x, state),
                    numbers: &numbers,
                };
                let found = trial.deviations();
                assert!(found.largest() < ROUNDOFF, "{damping} {dissipation} {x}: {found:?}");
                let held = part.predict(&trial.rest, &load(0.0)).flexibility().norm_max() == 0.0;
                assert_eq!(held, x == 0.0 || x == 0.6);
                if damping == 0.0 && dissipation == 0.0 && !held {
                    let energy = |state: &RailState| {
                        let modes = state.motions.iter().zip(&dynamics.modes.squares);
                        modes.map(|(m, square)| 0.5 * (m.v * m.v + square * m.u * m.u)).sum()
                    };
                    let defect = trial.energy_defect(&load(0.0), &energy);
                    assert!(defect < ROUNDOFF, "{x}: {defect:e}");
                }
            }
        }
    }
}
