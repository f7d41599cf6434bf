//! One elastic body in time: prediction without contact, correction with it.

use crate::error::Result;
use crate::solid::{NodalMass, System};
use crate::superelement::{Superelement, times};
use faer::Mat;
use nalgebra::Vector2;

/// A body with its state at the last finished step. Vectors hold `3·node + direction`.
pub(super) struct Body<'a> {
    element: Superelement<'a>,
    pub(super) mass: NodalMass,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    /// Equations during a step: interior eliminated, retained condensed.
    work: Vec<f64>,
}

impl<'a> Body<'a> {
    /// Factors the effective matrix; `hub_stiffness` is added to the hub's vertical motion.
    pub(super) fn new(system: System<'a>, dt: f64, hub_stiffness: Option<f64>) -> Result<Self> {
        let mass = system.nodal_mass();
        let diagonal: Vec<(usize, f64)> =
            hub_stiffness.and_then(|k| Some((system.numbering.master_equation(2)?, k))).into_iter().collect();
        let zeros = vec![0.0; 3 * system.mesh.nodes.len()];
        let work = vec![0.0; system.numbering.equations];
        let element = Superelement::new(system, 4.0 / (dt * dt), &diagonal)?;
        Ok(Self { element, mass, displacement: zeros.clone(), velocity: zeros.clone(), acceleration: zeros, work })
    }

    /// Gives every node the same initial acceleration (y, z).
    pub(super) fn start(&mut self, acceleration: &Vector2<f64>) {
        for a in self.acceleration.chunks_exact_mut(3) {
            (a[1], a[2]) = (acceleration.x, acceleration.y);
        }
    }

    pub(super) fn equations(&self) -> usize {
        self.element.system.numbering.equations
    }

    pub(super) fn factor_values(&self) -> usize {
        self.element.factor.stored_values()
    }

    /// Effective compliance of the retained equations, m/N.
    pub(super) fn compliance(&self) -> &Mat<f64> {
        &self.element.compliance
    }

    /// Eliminates the interior for the step and returns the retained displacements without contact
    /// forces. `hub_force` (y, z) acts on the master node, `gravity` on the whole body.
    pub(super) fn predict(&mut self, dt: f64, hub_force: &[f64; 2], gravity: f64) -> Vec<f64> {
        let mut inertia: Vec<f64> = self
            .displacement
            .iter()
            .zip(&self.velocity)
            .zip(&self.acceleration)
            .map(|((u, v), a)| 4.0 / (dt * dt) * u + 4.0 / dt * v + a)
            .collect();
        inertia.iter_mut().skip(2).step_by(3).for_each(|h| *h += gravity);
        let System { mesh, numbering, .. } = &self.element.system;
        self.work = numbering.gather(mesh, &self.mass.times(&inertia));
        for (motion, force) in [1, 2].into_iter().zip(hub_force) {
            if let Some(e) = numbering.master_equation(motion) {
                self.work[e] += force;
            }
        }
        self.element.factor.forward_interior(&mut self.work);
        times(&self.element.compliance, &self.work[numbering.interior..])
    }

    /// Finishes the step under contact forces on the retained equations.
    pub(super) fn correct(&mut self, dt: f64, contact_forces: &[f64]) {
        let System { mesh, numbering, .. } = &self.element.system;
        let retained = &mut self.work[numbering.interior..];
        retained.iter_mut().zip(contact_forces).for_each(|(r, f)| *r += f);
        let solution = times(&self.element.compliance, retained);
        retained.copy_from_slice(&solution);
        self.element.factor.backward_interior(&mut self.work);
        let end = numbering.expand(mesh, &self.work);
        for (i, u) in end.iter().enumerate() {
            let moved = u - self.displacement[i];
            let v = self.velocity[i];
            self.velocity[i] = 2.0 / dt * moved - v;
            self.acceleration[i] = 4.0 / (dt * dt) * moved - 4.0 / dt * v - self.acceleration[i];
        }
        self.displacement = end;
    }

    /// Displacements of the contact nodes at the last finished step, in the order of the contact grid.
    pub(super) fn contact_displacement(&self) -> Vec<f64> {
        let grid = &self.element.system.mesh.contact.nodes;
        grid.iter().flat_map(|&n| [0, 1, 2].map(|d| self.displacement[3 * n + d])).collect()
    }

    /// Hub displacement (y, z) at the last finished step.
    pub(super) fn hub(&self) -> Vector2<f64> {
        Vector2::from_fn(|i, _| {
            self.element.system.numbering.master_equation(i + 1).map_or(0.0, |e| self.work[e])
        })
    }

    /// Hub displacement (y, z) from retained displacements without contact forces and those forces.
    pub(super) fn hub_with(&self, free: &[f64], contact_forces: &[f64]) -> Vector2<f64> {
        let numbering = &self.element.system.numbering;
        Vector2::from_fn(|i, _| {
            numbering.master_equation(i + 1).map_or(0.0, |e| {
                let row = e - numbering.interior;
                let column = self.element.compliance.col_as_slice(row);
                free[row] + column.iter().zip(contact_forces).map(|(c, f)| c * f).sum::<f64>()
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BlockOptions, mesh_block};
    use crate::solid::{Formulation, Material, Supports};

    /// Source: the wave equation (K.F. Graff, Wave Motion in Elastic Solids, 1975, section 2.2): the loaded end of a
    /// bar under a sudden constant force moves in a triangular wave between 0 and twice the static displacement, with
    /// the period 4·L/c. Goal: largest displacement within 2 %, period within 1 %; mean acceleration adds no
    /// energy, 24 elements and 120 steps a period carry the corners of the wave. Units SI.
    #[test]
    fn a_bar_under_a_sudden_force_swings_as_the_wave_equation_says() {
        const DISCRETISATION: [f64; 2] = [0.02, 0.01];
        let (length, width) = (0.24, 0.01);
        let mesh = mesh_block(&BlockOptions::uniform([width, width, length], [1, 1, 24])).unwrap();
        let material = Material { poisson: 0.0, ..Material::STEEL };
        let supports = Supports { held: mesh.foot.clone(), ..Default::default() };
        let system = System::new(&mesh, material, Formulation::IncompatibleModes, &supports).unwrap();
        let period = 4.0 * length / (material.young / material.density).sqrt();
        let dt = period / 120.0;
        let mut body = Body::new(system, dt, None).unwrap();
        let force = 1e3;
        // four corner nodes share the end face
        let mut forces = vec![0.0; body.compliance().nrows()];
        forces.iter_mut().skip(2).step_by(3).for_each(|f| *f = force / 4.0);
        let static_displacement = force * length / (material.young * width * width);
        let mut track = Vec::new();
        for _ in 0..360 {
            body.predict(dt, &[0.0; 2], 0.0);
            body.correct(dt, &forces);
            track.push(body.contact_displacement()[2] / static_displacement);
        }
        let largest = track.iter().copied().fold(0.0, f64::max);
        assert!((largest / 2.0 - 1.0).abs() < DISCRETISATION[0], "largest {largest}");
        // crossings of the static displacement come twice a period
        let crossings: Vec<f64> = track
            .windows(2)
            .enumerate()
            .filter(|(_, w)| (w[0] - 1.0) * (w[1] - 1.0) < 0.0)
            .map(|(i, w)| (i as f64 + 1.0 + (1.0 - w[0]) / (w[1] - w[0])) * dt)
            .collect();
        let measured = 2.0 * (crossings[4] - crossings[0]) / 4.0;
        assert!((measured / period - 1.0).abs() < DISCRETISATION[1], "{measured} {period}");
    }
}
