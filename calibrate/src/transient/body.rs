//! One elastic body in time: prediction without contact, correction with it.

use crate::error::Result;
use crate::newmark::{Motion, Newmark};
use crate::solid::{NodalMass, Numbering, System};
use crate::superelement::{Superelement, times};
use faer::Mat;
use faer::sparse::SparseColMat;
use nalgebra::{Vector2, Vector3};

/// A body with its state at the last finished step; states by equation.
pub(super) struct Body<'a> {
    pub(super) element: Superelement<'a>,
    pub(super) mass: NodalMass,
    /// Damping matrix, upper triangle; none if the material is undamped.
    damping: Option<SparseColMat<usize, f64>>,
    pub(super) displacement: Vec<f64>,
    pub(super) velocity: Vec<f64>,
    acceleration: Vec<f64>,
    /// What the contact nodes moved by in the last step.
    contact_step: Vec<f64>,
    /// Right-hand side of the step: interior eliminated, retained condensed.
    work: Vec<f64>,
}

impl<'a> Body<'a> {
    /// Factors the effective matrix `K·(1 + 2β/Δt) + 4/Δt²·M` of a material with the damping β;
    /// `hub_stiffness` is added to the hub's vertical motion.
    pub(super) fn new(system: System<'a>, scheme: &Newmark, hub_stiffness: Option<f64>) -> Result<Self> {
        let mass = system.nodal_mass();
        let diagonal: Vec<(usize, f64)> =
            hub_stiffness.and_then(|k| Some((system.numbering.master_equation(2)?, k))).into_iter().collect();
        let zeros = vec![0.0; system.numbering.equations];
        let contact = system.numbering.contact;
        let beta = system.material.damping;
        let damping = (beta > 0.0).then(|| system.matrix(beta, 0.0, &[])).transpose()?;
        let element =
            Superelement::effective(system, 1.0 + beta * scheme.velocity, scheme.acceleration, &diagonal)?;
        Ok(Self {
            element,
            mass,
            damping,
            displacement: zeros.clone(),
            velocity: zeros.clone(),
            acceleration: zeros.clone(),
            contact_step: vec![0.0; contact],
            work: zeros,
        })
    }

    /// Gives the whole body the same initial velocity and acceleration (y, z).
    pub(super) fn start(&mut self, dt: f64, velocity: &Vector2<f64>, acceleration: &Vector2<f64>) {
        let uniform =
            |v: &Vector2<f64>| self.element.system.numbering.translation(&Vector3::new(0.0, v.x, v.y));
        (self.velocity, self.acceleration) = (uniform(velocity), uniform(acceleration));
        let Numbering { interior, contact, .. } = self.element.system.numbering;
        let before = uniform(&(velocity * dt - acceleration * (0.5 * dt * dt)));
        self.contact_step = before[interior..interior + contact].to_vec();
    }

    /// Motion of an equation at the last finished step.
    fn motion(&self, equation: usize) -> Motion {
        let (u, v) = (self.displacement[equation], self.velocity[equation]);
        Motion { u, v, a: self.acceleration[equation] }
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
    pub(super) fn predict(&mut self, scheme: &Newmark, hub_force: &[f64; 2], gravity: f64) -> Vec<f64> {
        let carried_over = |of: fn(&Newmark, &Motion) -> f64| -> Vec<f64> {
            (0..self.displacement.len()).map(|i| of(scheme, &self.motion(i))).collect()
        };
        let System { mesh, numbering, .. } = &self.element.system;
        let mut inertia = numbering.expand(mesh, &carried_over(Newmark::inertia));
        inertia.iter_mut().skip(2).step_by(3).for_each(|h| *h += gravity);
        let damped = self.damping.is_some().then(|| carried_over(Newmark::damping));
        self.work = numbering.gather(mesh, &self.mass.times(&inertia));
        if let (Some(damping), Some(velocity)) = (&self.damping, damped) {
            add_symmetric_product(damping, &velocity, &mut self.work);
        }
        for (motion, force) in [1, 2].into_iter().zip(hub_force) {
            if let Some(e) = numbering.master_equation(motion) {
                self.work[e] += force;
            }
        }
        self.element.factor.forward_interior(&mut self.work);
        times(&self.element.compliance, &self.work[numbering.interior..])
    }

    /// Finishes the step under contact forces on the retained equations.
    pub(super) fn correct(&mut self, scheme: &Newmark, contact_forces: &[f64]) {
        let Numbering { interior, contact, .. } = self.element.system.numbering;
        let mut end = std::mem::take(&mut self.work);
        end[interior..].iter_mut().zip(contact_forces).for_each(|(r, f)| *r += f);
        let retained = times(&self.element.compliance, &end[interior..]);
        end[interior..].copy_from_slice(&retained);
        self.element.factor.backward_interior(&mut end);
        for (i, u) in end.iter().enumerate() {
            let Motion { v, a, .. } = scheme.advance(&self.motion(i), *u);
            (self.velocity[i], self.acceleration[i]) = (v, a);
        }
        // nothing carries the velocity of a node without mass on: it is that of its last two steps, of second order
        let steps: Vec<f64> = (interior..interior + contact).map(|i| end[i] - self.displacement[i]).collect();
        for ((v, now), before) in self.velocity[interior..].iter_mut().zip(&steps).zip(&self.contact_step) {
            *v = (1.5 * now - 0.5 * before) / scheme.step();
        }
        self.contact_step = steps;
        self.displacement = end;
    }

    /// Displacements of the contact nodes at the last finished step, `3·node + axis` in the order of the contact grid.
    pub(super) fn contact_displacement(&self) -> &[f64] {
        let numbering = &self.element.system.numbering;
        &self.displacement[numbering.interior..numbering.interior + numbering.contact]
    }

    /// Hub displacement (y, z) at the last finished step.
    pub(super) fn hub(&self) -> Vector2<f64> {
        Vector2::from_fn(|i, _| {
            self.element.system.numbering.master_equation(i + 1).map_or(0.0, |e| self.displacement[e])
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

/// Adds a symmetric matrix, given by its upper triangle, times a vector.
pub(super) fn add_symmetric_product(upper: &SparseColMat<usize, f64>, vector: &[f64], sum: &mut [f64]) {
    for column in 0..upper.ncols() {
        let range = upper.col_ptr()[column]..upper.col_ptr()[column + 1];
        let mut own = 0.0;
        for (&row, value) in upper.row_idx()[range.clone()].iter().zip(&upper.val()[range]) {
            own += value * vector[row];
            if row != column {
                sum[row] += value * vector[column];
            }
        }
        sum[column] += own;
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
    /// energy, 24 elements and 120 steps per period carry the corners of the wave. Units SI.
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
        let scheme = Newmark::new(dt, 0.0);
        let mut body = Body::new(system, &scheme, None).unwrap();
        let force = 1e3;
        // four corner nodes share the end face
        let mut forces = vec![0.0; body.compliance().nrows()];
        forces.iter_mut().skip(2).step_by(3).for_each(|f| *f = force / 4.0);
        let static_displacement = force * length / (material.young * width * width);
        let mut track = Vec::new();
        for _ in 0..360 {
            body.predict(&scheme, &[0.0; 2], 0.0);
            body.correct(&scheme, &forces);
            track.push(body.contact_displacement()[2] / static_displacement);
        }
        let largest = track.iter().copied().fold(0.0, f64::max);
        assert!((largest / 2.0 - 1.0).abs() < DISCRETISATION[0], "largest {largest}");
        // crossings of the static displacement come twice per period
        let crossings: Vec<f64> = track
            .windows(2)
            .enumerate()
            .filter(|(_, w)| (w[0] - 1.0) * (w[1] - 1.0) < 0.0)
            .map(|(i, w)| (i as f64 + 1.0 + (1.0 - w[0]) / (w[1] - w[0])) * dt)
            .collect();
        let measured = 2.0 * (crossings[4] - crossings[0]) / 4.0;
        assert!((measured / period - 1.0).abs() < DISCRETISATION[1], "{measured} {period}");
    }

    /// Source: the logarithmic decrement of a mode with the damping ratio ζ = β·ω/2 (Graff, section 2.5).
    /// Goal: the first mode of a bar, set swinging by a release from rest, decays by exp(-2π·ζ) a period. The
    /// higher modes, damped by the square of their frequency, are gone after the first periods. Within 3 %.
    #[test]
    fn a_damped_bar_decays_by_its_logarithmic_decrement() {
        const DISCRETISATION: f64 = 0.03;
        let (length, width, ratio) = (0.24, 0.01, 0.05);
        let mesh = mesh_block(&BlockOptions::uniform([width, width, length], [1, 1, 24])).unwrap();
        let period = 4.0 * length / (Material::STEEL.young / Material::STEEL.density).sqrt();
        let damping = ratio * period / std::f64::consts::PI;
        let material = Material { poisson: 0.0, damping, ..Material::STEEL };
        let supports = Supports { held: mesh.foot.clone(), ..Default::default() };
        let system = System::new(&mesh, material, Formulation::IncompatibleModes, &supports).unwrap();
        let dt = period / 120.0;
        let scheme = Newmark::new(dt, 0.0);
        let mut body = Body::new(system, &scheme, None).unwrap();
        let mut forces = vec![0.0; body.compliance().nrows()];
        forces.iter_mut().skip(2).step_by(3).for_each(|f| *f = 250.0);
        let swing: Vec<f64> = (0..480)
            .map(|_| {
                body.predict(&scheme, &[0.0; 2], 0.0);
                body.correct(&scheme, &forces);
                body.contact_displacement()[2]
            })
            .collect();
        let rest = 1e3 * length / (material.young * width * width);
        let peak = |from: usize| swing[from..from + 120].iter().map(|u| (u - rest).abs()).fold(0.0, f64::max);
        let decrement = (peak(200) / peak(320)).ln();
        let exact = std::f64::consts::TAU * ratio / (1.0 - ratio * ratio).sqrt();
        assert!((decrement / exact - 1.0).abs() < DISCRETISATION, "{decrement} {exact}");
    }
}
