//! The wheel's modes under a motion of the hub that somebody else has, over steps whose forces change in proportion to time.
//!
//! With the hub's motion `u`, a mode of mass 1 kg with the hub held has `q̈ + βω²q̇ + ω²q = r·F - c·ü` (`r` its rim, `c` its coupling, `F` the force on the rim). In `p = q + c·u` no acceleration of
//! the hub is left:
//!
//! ```text
//! p̈ + βω²ṗ + ω²p = r·F + g,    g = ω²·c·u + βω²·c·u̇ + c·weight
//! ```
//!
//! and the hub, less the mass `Σ c·cᵀ` that moves in the modes, feels `Aᵀ·F + Σ c·(ω²(p - c·u) + βω²(ṗ - c·u̇))` with `A` the motion of the rim under the hub where the `p` stand.
//! A step is exact for a right-hand side that is linear in time: N.C. Nigam, P.C. Jennings, "Calculation of response spectra from strong-motion earthquake records", Bull. Seism. Soc. Am. 59 (1969).

use crate::wheel::{ElasticWheel, RimMode};
use std::ops::{AddAssign, SubAssign};

use nalgebra::{DMatrix, Matrix3, Matrix4, Matrix6, Vector3};

/// The modes of a wheel, for steps.
#[derive(Debug, Clone)]
pub(crate) struct Modes {
    modes: Vec<RimMode>,
    damping: f64,
    /// Acceleration of weight, m/s² along z.
    gravity: f64,
    /// Motion of the rim under unit motions of the hub with the modes' `p` held.
    pub of_hub: Matrix3<f64>,
}

/// Motion of the hub, or of a rail's section: y, z (m) and rotation about x (rad), with velocities (m/s, rad/s).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Motion {
    /// Displacements and rotation.
    pub displacement: Vector3<f64>,
    /// Velocities.
    pub velocity: Vector3<f64>,
}

/// A mode over a step of one length: its `p` and `ṗ` at the end under those at the start and the right-hand side at start and end.
#[derive(Debug, Clone, Copy)]
struct OverStep {
    displacement: [f64; 4],
    velocity: [f64; 4],
}

/// A step length, prepared.
#[derive(Debug, Clone)]
pub(crate) struct PreparedModes {
    modes: Vec<OverStep>,
    /// Motion of the rim per force on it at the end.
    pub flexibility: Matrix3<f64>,
}

impl Modes {
    pub fn new(wheel: &ElasticWheel, damping: f64, gravity: f64) -> Self {
        let held = |sum: Matrix3<f64>, mode: &RimMode| sum - mode.rim * mode.coupling.transpose();
        let of_hub = wheel.modes.iter().fold(wheel.carried_by_hub(), held);
        Self { modes: wheel.modes.clone(), damping, gravity, of_hub }
    }

    pub fn count(&self) -> usize {
        self.modes.len()
    }

    /// `p` and `ṗ` of modes that do not swing in a wheel that moves with its hub.
    pub fn at_rest(&self, hub: &Motion, state: &mut Vec<[f64; 2]>) {
        state.clear();
        state.extend(
            self.modes
                .iter()
                .map(|mode| [mode.coupling.dot(&hub.displacement), mode.coupling.dot(&hub.velocity)]),
        );
    }

    /// The same bent by weight and a force on the rim.
    pub fn bent(&self, hub: &Motion, force: &Vector3<f64>, state: &mut Vec<[f64; 2]>) {
        self.at_rest(hub, state);
        for (mode, at) in self.modes.iter().zip(state) {
            at[0] += (mode.rim.dot(force) + mode.coupling.y * self.gravity) / mode.square;
        }
    }

    /// Motion of the rim that modes bent by weight alone add to the hub's.
    pub fn sag(&self) -> Vector3<f64> {
        self.modes.iter().map(|mode| mode.rim * (mode.coupling.y * self.gravity / mode.square)).sum()
    }

    /// The right-hand side of a mode but for the force on the rim.
    fn driven(&self, mode: &RimMode, hub: &Motion) -> f64 {
        let damping = self.damping * mode.square;
        mode.square * mode.coupling.dot(&hub.displacement)
            + damping * mode.coupling.dot(&hub.velocity)
            + mode.coupling.y * self.gravity
    }

    /// Motion of the rim.
    pub fn rim(&self, hub: &Motion, state: &[[f64; 2]]) -> Vector3<f64> {
        let of_modes: Vector3<f64> = self.modes.iter().zip(state).map(|(mode, [p, _])| mode.rim * *p).sum();
        self.of_hub * hub.displacement + of_modes
    }

    /// Accelerations of the modes under a force on the rim.
    pub fn accelerations(&self, hub: &Motion, state: &[[f64; 2]], force: &Vector3<f64>, into: &mut [f64]) {
        for ((mode, [p, v]), a) in self.modes.iter().zip(state).zip(into) {
            let damping = self.damping * mode.square;
            *a = mode.rim.dot(force) + self.driven(mode, hub) - mode.square * p - damping * v;
        }
    }

    /// Force of the wheel on its hub under a force on the rim.
    pub fn on_hub(&self, hub: &Motion, state: &[[f64; 2]], force: &Vector3<f64>) -> Vector3<f64> {
        let of_modes: Vector3<f64> = self
            .modes
            .iter()
            .zip(state)
            .map(|(mode, [p, v])| {
                let (square, damping) = (mode.square, self.damping * mode.square);
                let off = square * (p - mode.coupling.dot(&hub.displacement))
                    + damping * (v - mode.coupling.dot(&hub.velocity));
                mode.coupling * off
            })
            .sum();
        self.of_hub.tr_mul(force) + of_modes
    }

    /// Derivatives of the forces on hub and section and of the modes' accelerations (rows) by the hub's displacements and velocities, the section's displacements, and the modes' displacements and
    /// velocities (columns), with the `tangent` of the contact by motions of rim and section.
    pub fn jacobian(&self, tangent: &Matrix6<f64>) -> DMatrix<f64> {
        let count = self.modes.len();
        // motions of rim and section under all columns
        let mut carried = DMatrix::zeros(6, 9 + 2 * count);
        carried.view_mut((0, 0), (3, 3)).copy_from(&self.of_hub);
        carried.view_mut((3, 6), (3, 3)).copy_from(&Matrix3::identity());
        for (i, mode) in self.modes.iter().enumerate() {
            carried.view_mut((0, 9 + i), (3, 1)).copy_from(&mode.rim);
        }
        let forces = tangent * carried;
        let mut jacobian = DMatrix::zeros(6 + count, 9 + 2 * count);
        jacobian.rows_mut(0, 3).copy_from(&(self.of_hub.transpose() * forces.rows(0, 3)));
        jacobian.rows_mut(3, 3).copy_from(&forces.rows(3, 3));
        for (i, mode) in self.modes.iter().enumerate() {
            jacobian.row_mut(6 + i).copy_from(&(mode.rim.transpose() * forces.rows(0, 3)));
            let damping = self.damping * mode.square;
            for (factor, of_hub, of_mode) in [(mode.square, 0, 9 + i), (damping, 3, 9 + count + i)] {
                jacobian[(6 + i, of_mode)] -= factor;
                for k in 0..3 {
                    jacobian[(6 + i, of_hub + k)] += factor * mode.coupling[k];
                    jacobian[(k, of_mode)] += factor * mode.coupling[k];
                    for l in 0..3 {
                        jacobian[(k, of_hub + l)] -= factor * mode.coupling[k] * mode.coupling[l];
                    }
                }
            }
        }
        jacobian
    }

    /// Prepares steps of one length, s.
    pub fn prepare(&self, step: f64) -> PreparedModes {
        let over = |mode: &RimMode| {
            // displacement, velocity, right-hand side and its rate
            let damping = self.damping * mode.square;
            let system = Matrix4::new(
                0.0,
                1.0,
                0.0,
                0.0,
                -mode.square,
                -damping,
                1.0,
                0.0,
                0.0,
                0.0,
                0.0,
                1.0,
                0.0,
                0.0,
                0.0,
                0.0,
            );
            let end = (system * step).exp();
            let row = |i: usize| {
                let of_end = end[(i, 3)] / step;
                [end[(i, 0)], end[(i, 1)], end[(i, 2)] - of_end, of_end]
            };
            OverStep { displacement: row(0), velocity: row(1) }
        };
        let modes: Vec<OverStep> = self.modes.iter().map(over).collect();
        let both = self.modes.iter().zip(&modes);
        let flexibility =
            both.map(|(mode, over)| mode.rim * mode.rim.transpose() * over.displacement[3]).sum();
        PreparedModes { modes, flexibility }
    }

    /// Derivatives of the forces on hub and section by displacements of both at the end of a step, with the `tangent` of a contact whose rim gives way as over the step.
    pub fn tangent(&self, prepared: &PreparedModes, tangent: &Matrix6<f64>) -> Matrix6<f64> {
        // motion of the modes, and with them of the rim, under that of the hub
        let of_hub = |mode: &RimMode, over: &OverStep| mode.coupling * (over.displacement[3] * mode.square);
        let both = || self.modes.iter().zip(&prepared.modes);
        let moved =
            both().fold(self.of_hub, |sum, (mode, over)| sum + mode.rim * of_hub(mode, over).transpose());
        let mut carried = Matrix6::identity();
        carried.fixed_view_mut::<3, 3>(0, 0).copy_from(&moved);
        let forces = tangent * carried;
        let on_rim = forces.fixed_rows::<3>(0).into_owned();
        let mut all = forces;
        let mut on_hub = self.of_hub.transpose() * on_rim;
        for (mode, over) in both() {
            let damping = self.damping * mode.square;
            let [of_p, of_v] = [over.displacement[3], over.velocity[3]];
            // of what drives the mode
            let mut driven = on_rim.tr_mul(&mode.rim);
            driven.fixed_rows_mut::<3>(0).add_assign(&(mode.coupling * mode.square));
            let mut off = driven * (mode.square * of_p + damping * of_v);
            off.fixed_rows_mut::<3>(0).sub_assign(&(mode.coupling * mode.square));
            on_hub += mode.coupling * off.transpose();
        }
        all.fixed_view_mut::<3, 6>(0, 0).copy_from(&on_hub);
        all
    }

    /// Motion of the rim at the end of a step without a force on it there; `hubs` at start and end, `force` at the start.
    pub fn free(
        &self,
        prepared: &PreparedModes,
        state: &[[f64; 2]],
        hubs: [&Motion; 2],
        force: &Vector3<f64>,
    ) -> Vector3<f64> {
        let mut rim = self.of_hub * hubs[1].displacement;
        for ((mode, over), [p, v]) in self.modes.iter().zip(&prepared.modes).zip(state) {
            let [start, end] = hubs.map(|hub| self.driven(mode, hub));
            let start = start + mode.rim.dot(force);
            let [of_p, of_v, of_start, of_end] = over.displacement;
            rim += mode.rim * (of_p * p + of_v * v + of_start * start + of_end * end);
        }
        rim
    }

    /// The state at the end of that step under `forces` on the rim at start and end.
    pub fn finish(
        &self,
        prepared: &PreparedModes,
        state: &mut [[f64; 2]],
        hubs: [&Motion; 2],
        forces: [&Vector3<f64>; 2],
    ) {
        for ((mode, over), at) in self.modes.iter().zip(&prepared.modes).zip(state) {
            let [start, end] = [0, 1].map(|i| self.driven(mode, hubs[i]) + mode.rim.dot(forces[i]));
            let of = |row: &[f64; 4]| row[0] * at[0] + row[1] * at[1] + row[2] * start + row[3] * end;
            *at = [of(&over.displacement), of(&over.velocity)];
        }
    }
}

impl Motion {
    /// The motion `length` s later with the same velocity.
    pub fn after(&self, length: f64) -> Self {
        Self { displacement: self.displacement + self.velocity * length, velocity: self.velocity }
    }

    /// The motion at a share of the way to another one `length` s later: a cubic with the displacements and velocities of both.
    pub fn towards(&self, end: &Self, length: f64, share: f64) -> Self {
        let (t, rest) = (share, 1.0 - share);
        let moved = end.displacement - self.displacement;
        let [leaving, arriving] = [self.velocity * length, end.velocity * length];
        let displacement =
            self.displacement + moved * (t * t * (3.0 - 2.0 * t)) + leaving * (t * rest * rest)
                - arriving * (t * t * rest);
        let slope =
            moved * (6.0 * t * rest) + leaving * (rest * (1.0 - 3.0 * t)) + arriving * (t * (3.0 * t - 2.0));
        Self { displacement, velocity: slope / length }
    }
}
