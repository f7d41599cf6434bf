//! An elastic body in time, a linear part with its contact nodes and its hub as interface: what the run and its contact see
//! of it, whatever its order.

use super::at_place::AtPlace;
use crate::time::energy::PartEnergy;
use crate::time::linear_part::LinearPart;
use faer::Mat;
use nalgebra::Vector2;
use railspring_calibrate::contact::NodalCompliance;
use std::sync::Arc;

/// What acts on a body besides its contact forces.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BodyLoad {
    /// Force (y, z) on the master node, N.
    pub(super) hub: [f64; 2],
    /// Acceleration of the whole body downwards, m/s².
    pub(super) gravity: f64,
    /// Where the wheel is along a rail at the end of the step, m from its middle.
    pub(super) place: f64,
    /// Torsion at the middle of a rail, N·m.
    pub(super) torsion: f64,
}

/// Displacements of an interface at the end of a step per unit force, m/N. A contact on a fine grid needs them now and then, one between
/// nodes in every step.
pub(super) trait Flexible: NodalCompliance {
    /// To be used in every step.
    fn kept(&self) -> &Mat<f64>;

    /// Displacements of some coordinates, the `rows`, under forces, (coordinate, N).
    fn under(&self, rows: &[usize], forces: &[(usize, f64)]) -> Vec<f64>;

    /// Where along its rail a body has this flexibility; none of one that has no such places.
    fn place(&self) -> Option<&Arc<AtPlace>> {
        None
    }

    /// What forces (coordinate, N) move all coordinates by here beyond what they do at another place of the same rail, m.
    fn beyond(&self, _other: &Arc<AtPlace>, _forces: &[(usize, f64)]) -> Vec<f64> {
        vec![0.0; self.coordinates()]
    }
}

impl Flexible for Mat<f64> {
    fn kept(&self) -> &Mat<f64> {
        self
    }

    fn under(&self, rows: &[usize], forces: &[(usize, f64)]) -> Vec<f64> {
        let moved = |&row: &usize| forces.iter().map(|&(column, force)| self[(row, column)] * force).sum();
        rows.iter().map(moved).collect()
    }
}

/// The interface of a body in a step. Its coordinates are those of the contact nodes (`3·node + axis` in the order of the
/// contact grid), then the master's free motions.
#[derive(Clone, Copy)]
pub(super) struct Interface<'s> {
    /// Displacements at the end of the step without contact forces, m.
    pub(super) free: &'s [f64],
    /// Displacements at the end of the step per unit force.
    pub(super) flexibility: &'s dyn Flexible,
    /// The contact nodes' displacements at the start of the step, m.
    pub(super) before: &'s [f64],
    /// Coordinates of the hub's motions y and z, if they are free.
    pub(super) hub: [Option<usize>; 2],
}

impl Interface<'_> {
    /// Hub displacement (y, z) at the end of the step under `forces` at the interface, m: (coordinate, N).
    pub(super) fn hub(&self, forces: &[(usize, f64)]) -> Vector2<f64> {
        let free: Vec<usize> = self.hub.into_iter().flatten().collect();
        let mut moved = self.at(&free, forces).into_iter();
        Vector2::from_fn(|i, _| self.hub[i].and_then(|_| moved.next()).unwrap_or(0.0))
    }

    /// Displacements (y, z) of contact nodes at the end of the step under `forces` at the interface, m: (coordinate, N).
    pub(super) fn displacements(&self, nodes: &[usize], forces: &[(usize, f64)]) -> Vec<Vector2<f64>> {
        let rows: Vec<usize> = nodes.iter().flat_map(|node| [3 * node + 1, 3 * node + 2]).collect();
        self.at(&rows, forces).chunks_exact(2).map(Vector2::from_column_slice).collect()
    }

    fn at(&self, rows: &[usize], forces: &[(usize, f64)]) -> Vec<f64> {
        let moved = self.flexibility.under(rows, forces);
        rows.iter().zip(moved).map(|(&row, moved)| self.free[row] + moved).collect()
    }
}

/// A body that a run can step, as one of a pair of its kind.
pub(super) trait ElasticBody: LinearPart<Load = BodyLoad> + Sized {
    /// The undeformed body in uniform motion: velocity and acceleration (y, z) at t = 0.
    fn in_motion(&self, velocity: &Vector2<f64>, acceleration: &Vector2<f64>) -> Self::State;

    /// The steps of rail and wheel; whatever the threads, with the same numbers.
    fn predict_both<'s>(
        bodies: [&'s Self; 2],
        states: [&'s Self::State; 2],
        loads: [&BodyLoad; 2],
        next: [&'s mut Self::State; 2],
    ) -> [Self::Step<'s>; 2];

    /// Completes their states at the end under the forces at their interfaces.
    fn finish_both(steps: [Self::Step<'_>; 2], forces: &[Vec<f64>; 2]);

    /// What the contact sees of a step.
    fn interface<'s>(step: &'s Self::Step<'_>) -> Interface<'s>;

    /// Equations of the mesh.
    fn equations(&self) -> usize;

    /// Mass of the whole body, kg.
    fn mass(&self) -> f64;

    /// Hub displacement (y, z) in a state, m.
    fn hub(&self, state: &Self::State) -> Vector2<f64>;

    /// Displacements of the contact nodes in a state, `3·node + axis` in the order of the contact grid.
    fn contact_displacement<'s>(&self, state: &'s Self::State) -> &'s [f64];

    /// Elastic state in the norm of energy, as forces (N): where a force of this size on a contact node has the same energy. Empty for
    /// bodies whose steps are all of one length.
    fn elastic(&self, state: &Self::State) -> Vec<f64>;

    /// Energies after a step from `before` to `after` with the gravity of `load`, J; the work of its forces on the hub is not in it. None of bodies whose energy
    /// costs as much as a step.
    fn energy(&self, before: &Self::State, after: &Self::State, gravity: f64) -> Option<PartEnergy>;

    /// What a balance of momentum and energy is made of.
    #[cfg(test)]
    fn sums(&self, state: &Self::State) -> Sums;
}

/// Sums over a body in a state.
#[cfg(test)]
#[derive(Debug, Clone, Copy)]
pub(super) struct Sums {
    /// Momentum down, N·s.
    pub(super) momentum: f64,
    /// Mass times displacement down, kg·m.
    pub(super) moment: f64,
    /// Kinetic and strain energy, J; without damping.
    pub(super) energy: f64,
}
