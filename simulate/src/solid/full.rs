//! A body at full order: all equations of its mesh, factored for one length of step.

use super::body::{BodyLoad, ElasticBody, Interface};
use super::load_case::HubSprings;
use crate::time::energy::PartEnergy;
use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::{Motion, Newmark};
use faer::MatRef;
use faer::sparse::SparseColMat;
use nalgebra::{Vector2, Vector3};
use railspring_calibrate::solid::{NodalMass, Numbering, System};
use railspring_calibrate::superelement::{Superelement, times};
use railspring_profiles::error::Result;

/// An elastic body, factored for time steps of one length. Its interface are the retained equations: contact nodes
/// (`3·node + axis` in the order of the contact grid), then the master's free motions.
pub(super) struct FullBody<'a> {
    element: Superelement<'a>,
    mass: NodalMass,
    /// Damping matrix, upper triangle; none if the material is undamped.
    damping: Option<SparseColMat<usize, f64>>,
    scheme: Newmark,
    #[cfg(test)]
    stiffness: std::sync::OnceLock<SparseColMat<usize, f64>>,
}

/// State of a body at the end of a step, by equation.
#[derive(Debug, Clone, Default)]
pub(super) struct FullState {
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    /// What the contact nodes moved by in the last step.
    contact_step: Vec<f64>,
}

/// A step of a body.
pub(super) struct FullStep<'s, 'a> {
    body: &'s FullBody<'a>,
    state: &'s FullState,
    /// Its displacements are the right-hand side of the step: interior eliminated, retained condensed.
    next: &'s mut FullState,
    /// Displacements of the retained equations without contact forces, m.
    free: Vec<f64>,
}

impl<'a> FullBody<'a> {
    /// Factors the effective matrix `K·(1 + 2β/Δt) + 4/Δt²·M` of a material with the damping β;
    /// its hub has what holds its free motions.
    pub(super) fn new(system: System<'a>, scheme: &Newmark, hub: HubSprings<'_>) -> Result<Self> {
        let mass = system.nodal_mass();
        let held = |&motion: &usize| Some((system.numbering.master_equation(motion)?, hub.against(motion)));
        let diagonal: Vec<(usize, f64)> = hub.free.iter().filter_map(held).collect();
        let beta = system.materials.damping();
        let damping = (beta > 0.0).then(|| system.matrix(beta, 0.0, &[])).transpose()?;
        let element =
            Superelement::effective(system, 1.0 + beta * scheme.velocity, scheme.acceleration, &diagonal)?;
        Ok(Self {
            element,
            mass,
            damping,
            scheme: *scheme,
            #[cfg(test)]
            stiffness: std::sync::OnceLock::new(),
        })
    }
}

impl FullState {
    fn motion(&self, equation: usize) -> Motion {
        let (u, v) = (self.displacement[equation], self.velocity[equation]);
        Motion { u, v, a: self.acceleration[equation] }
    }
}

impl<'a> LinearPart for FullBody<'a> {
    type State = FullState;
    type Load = BodyLoad;
    type Step<'s>
        = FullStep<'s, 'a>
    where
        Self: 's;

    /// Eliminates the interior.
    fn predict<'s>(
        &'s self,
        state: &'s FullState,
        load: &BodyLoad,
        next: &'s mut FullState,
    ) -> FullStep<'s, 'a> {
        let scheme = &self.scheme;
        let carried_over = |of: fn(&Newmark, &Motion) -> f64| -> Vec<f64> {
            (0..state.displacement.len()).map(|i| of(scheme, &state.motion(i))).collect()
        };
        let System { mesh, numbering, .. } = &self.element.system;
        let mut inertia = numbering.expand(mesh, &carried_over(Newmark::inertia));
        inertia.iter_mut().skip(2).step_by(3).for_each(|h| *h += load.gravity);
        let damped = self.damping.is_some().then(|| carried_over(Newmark::damping));
        let mut eliminated = numbering.gather(mesh, &self.mass.times(&inertia));
        if let (Some(damping), Some(velocity)) = (&self.damping, damped) {
            add_symmetric_product(damping, &velocity, &mut eliminated);
        }
        for (motion, force) in [1, 2].into_iter().zip(&load.hub) {
            if let Some(e) = numbering.master_equation(motion) {
                eliminated[e] += force;
            }
        }
        self.element.factor.forward_interior(&mut eliminated);
        let free = times(&self.element.compliance, &eliminated[numbering.interior..]);
        next.displacement = eliminated;
        FullStep { body: self, state, next, free }
    }
}

impl ElasticBody for FullBody<'_> {
    fn in_motion(&self, velocity: &Vector2<f64>, acceleration: &Vector2<f64>) -> FullState {
        let Numbering { interior, contact, equations, .. } = self.element.system.numbering;
        let uniform =
            |v: &Vector2<f64>| self.element.system.numbering.translation(&Vector3::new(0.0, v.x, v.y));
        let dt = self.scheme.step();
        let before = uniform(&(velocity * dt - acceleration * (0.5 * dt * dt)));
        FullState {
            displacement: vec![0.0; equations],
            velocity: uniform(velocity),
            acceleration: uniform(acceleration),
            contact_step: before[interior..interior + contact].to_vec(),
        }
    }

    fn predict_both<'s>(
        [rail, wheel]: [&'s Self; 2],
        states: [&'s FullState; 2],
        loads: [&BodyLoad; 2],
        [rail_next, wheel_next]: [&'s mut FullState; 2],
    ) -> [Self::Step<'s>; 2] {
        rayon::join(
            move || rail.predict(states[0], loads[0], rail_next),
            move || wheel.predict(states[1], loads[1], wheel_next),
        )
        .into()
    }

    fn finish_both([rail, wheel]: [Self::Step<'_>; 2], forces: &[Vec<f64>; 2]) {
        rayon::join(|| rail.finish(&forces[0]), || wheel.finish(&forces[1]));
    }

    fn interface<'s>(step: &'s Self::Step<'_>) -> Interface<'s> {
        let system = &step.body.element.system;
        let compliance = &step.body.element.compliance;
        let row = |motion| Some(system.numbering.master_equation(motion)? - system.numbering.interior);
        Interface {
            free: &step.free,
            flexibility: compliance,
            before: step.body.contact_displacement(step.state),
            hub: [row(1), row(2)],
        }
    }

    fn equations(&self) -> usize {
        self.element.system.numbering.equations
    }

    fn mass(&self) -> f64 {
        self.mass.total()
    }

    fn hub(&self, state: &FullState) -> Vector2<f64> {
        Vector2::from_fn(|i, _| {
            self.element.system.numbering.master_equation(i + 1).map_or(0.0, |e| state.displacement[e])
        })
    }

    fn contact_displacement<'s>(&self, state: &'s FullState) -> &'s [f64] {
        let numbering = &self.element.system.numbering;
        &state.displacement[numbering.interior..numbering.interior + numbering.contact]
    }

    fn energy(&self, _: &FullState, _: &FullState, _: f64) -> Option<PartEnergy> {
        None
    }

    fn elastic(&self, _: &FullState) -> Vec<f64> {
        Vec::new()
    }

    #[cfg(test)]
    fn sums(&self, state: &FullState) -> super::body::Sums {
        let system = &self.element.system;
        let expanded = |values: &[f64]| system.numbering.expand(system.mesh, values);
        let velocity = expanded(&state.velocity);
        let impulse = self.mass.times(&velocity);
        let downwards = |nodal: &[f64]| nodal.iter().skip(2).step_by(3).sum();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let stiffness = self.stiffness.get_or_init(|| system.matrix(1.0, 0.0, &[]).unwrap());
        let mut forces = vec![0.0; state.displacement.len()];
        add_symmetric_product(stiffness, &state.displacement, &mut forces);
        super::body::Sums {
            momentum: downwards(&impulse),
            moment: downwards(&self.mass.times(&expanded(&state.displacement))),
            energy: 0.5 * (product(&impulse, &velocity) + product(&forces, &state.displacement)),
        }
    }
}

impl LinearStep for FullStep<'_, '_> {
    fn free(&self) -> &[f64] {
        &self.free
    }

    fn flexibility(&self) -> MatRef<'_, f64> {
        self.body.element.compliance.as_ref()
    }

    /// Substitutes back.
    fn finish(self, forces: &[f64]) {
        let Self { body, state, next, .. } = self;
        let FullState { displacement, velocity, acceleration, contact_step } = next;
        let (scheme, element) = (&body.scheme, &body.element);
        let Numbering { interior, contact, .. } = element.system.numbering;
        displacement[interior..].iter_mut().zip(forces).for_each(|(r, f)| *r += f);
        let retained = times(&element.compliance, &displacement[interior..]);
        displacement[interior..].copy_from_slice(&retained);
        element.factor.backward_interior(displacement);
        let advanced = displacement.iter().enumerate().map(|(i, u)| scheme.advance(&state.motion(i), *u));
        (*velocity, *acceleration) = advanced.map(|m| (m.v, m.a)).unzip();
        // nothing carries the velocity of a node without mass on: it is that of its last two steps, of second order
        let steps = (interior..interior + contact).map(|i| displacement[i] - state.displacement[i]);
        *contact_step = steps.collect();
        for ((v, now), before) in velocity[interior..].iter_mut().zip(&*contact_step).zip(&state.contact_step)
        {
            *v = (1.5 * now - 0.5 * before) / scheme.step();
        }
    }
}

/// Adds a symmetric matrix, given by its upper triangle, times a vector.
fn add_symmetric_product(upper: &SparseColMat<usize, f64>, vector: &[f64], sum: &mut [f64]) {
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
    use crate::time::linear_part::conformance::Trial;
    use nalgebra::Point3;
    use railspring_calibrate::mesh::{BlockOptions, mesh_block};
    use railspring_calibrate::solid::{Formulation, Material, Supports};

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
        let body = FullBody::new(system, &scheme, HubSprings::default()).unwrap();
        let mut state = body.in_motion(&Vector2::zeros(), &Vector2::zeros());
        let force = 1e3;
        // four corner nodes share the end face
        let mut forces = vec![0.0; body.element.compliance.nrows()];
        forces.iter_mut().skip(2).step_by(3).for_each(|f| *f = force / 4.0);
        let static_displacement = force * length / (material.young * width * width);
        let mut track = Vec::new();
        for _ in 0..360 {
            state = body.advance(&state, &BodyLoad::default(), &forces);
            track.push(body.contact_displacement(&state)[2] / static_displacement);
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
        let body = FullBody::new(system, &scheme, HubSprings::default()).unwrap();
        let mut state = body.in_motion(&Vector2::zeros(), &Vector2::zeros());
        let mut forces = vec![0.0; body.element.compliance.nrows()];
        forces.iter_mut().skip(2).step_by(3).for_each(|f| *f = 250.0);
        let swing: Vec<f64> = (0..480)
            .map(|_| {
                state = body.advance(&state, &BodyLoad::default(), &forces);
                body.contact_displacement(&state)[2]
            })
            .collect();
        let rest = 1e3 * length / (material.young * width * width);
        let peak = |from: usize| swing[from..from + 120].iter().map(|u| (u - rest).abs()).fold(0.0, f64::max);
        let decrement = (peak(200) / peak(320)).ln();
        let exact = std::f64::consts::TAU * ratio / (1.0 - ratio * ratio).sqrt();
        assert!((decrement / exact - 1.0).abs() < DISCRETISATION, "{decrement} {exact}");
    }

    /// Goal: a body obeys the rules of a linear part: held at its foot, and following its hub, which is a coordinate of the
    /// interface; with and without damping and dissipation. Without both its energy (J) is the work of the forces.
    /// Accuracy: ROUNDOFF of sums of a hundred terms in 40 steps, 100·40·1e-16, relative.
    #[test]
    fn a_body_is_a_linear_part() {
        const ROUNDOFF: f64 = 1e-12;
        let mesh = mesh_block(&BlockOptions::uniform([0.02, 0.02, 0.04], [2, 2, 4])).unwrap();
        let on_foot = Supports { held: mesh.foot.clone(), ..Default::default() };
        let on_hub = Supports {
            held: Vec::new(),
            followers: mesh.foot.clone(),
            master: Point3::new(0.0, 0.0, 0.05),
            master_free: [false, true, true, true, true, true],
        };
        for (supports, hub_motions) in [(on_foot, 0), (on_hub, 5)] {
            for (damping, dissipation) in [(0.0, 0.0), (1e-6, 0.0), (0.0, 0.05)] {
                let material = Material { damping, ..Material::STEEL };
                let system = System::new(&mesh, material, Formulation::IncompatibleModes, &supports).unwrap();
                let scheme = Newmark::new(2e-6, dissipation);
                let body =
                    FullBody::new(system.with_massless_contact(), &scheme, HubSprings::default()).unwrap();
                let Numbering { interior, contact, equations, .. } = body.element.system.numbering;
                assert_eq!(equations - interior - contact, hub_motions);
                let load = |y, z, gravity| BodyLoad { hub: [y, z], gravity, ..BodyLoad::default() };
                let trial = Trial {
                    part: &body,
                    rest: body.in_motion(&Vector2::zeros(), &Vector2::zeros()),
                    loads: [load(300.0, -700.0, 5e4), load(100.0, 200.0, -9e4), load(400.0, -500.0, -4e4)],
                    force: 1e3,
                    displacement: &|state| state.displacement[interior..].to_vec(),
                    numbers: &|state| {
                        let FullState { displacement, velocity, acceleration, contact_step } = state.clone();
                        vec![displacement, velocity, acceleration, contact_step]
                    },
                };
                let found = trial.deviations();
                assert!(found.largest() < ROUNDOFF, "{hub_motions} {damping} {dissipation}: {found:?}");
                if damping == 0.0 && dissipation == 0.0 {
                    let energy = |state: &FullState| body.sums(state).energy;
                    let defect = trial.energy_defect(&BodyLoad::default(), &energy);
                    assert!(defect < ROUNDOFF, "{hub_motions}: {defect:e}");
                }
            }
        }
    }
}
