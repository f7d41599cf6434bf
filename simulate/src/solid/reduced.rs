//! A body reduced to its modes, its hub's motions and the compliance of its contact nodes.
//!
//! Its coordinates are the free motions of the hub, with the mass of the whole body, and the modes of the body held there. The contact
//! nodes have no mass: beyond hub and modes they follow the contact forces by the residual of the static compliance, damped as
//! the material is.
//!
//! Along a rail the contact nodes go with the wheel ([`super::path::RailPath`]): modes move them as they are where the wheel is at the end of a step, and so is the residual. What moves the wheel does work on the rail besides
//! the contact forces, which its energy counts. A torsion at the middle of the rail acts on the modes, and at once on what these leave.

mod flexibility;
mod prepared;
mod driven;
#[cfg(test)]
mod tests;

use super::at_place::AtPlace;
use super::body::{BodyLoad, ElasticBody, Flexible, Interface};
use super::load_case::HubSprings;
use super::loads::{add_product, in_runs};
use crate::time::energy::PartEnergy;
use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::Motion;
use driven::{Driven, Ends};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use flexibility::StepFlexibility;
use nalgebra::{DVector, Vector2};
use railspring_calibrate::superelement::add_times;
use std::sync::Arc;

pub(super) use prepared::ReducedBody;

/// Motions of a hub: translations y and z.
const TRANSLATIONS: [usize; 2] = [1, 2];

/// State of a reduced body at the end of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct ReducedState {
    /// Motions of the hub, then those of the modes.
    coordinates: Vec<Motion>,
    /// Motions of the contact nodes beyond hub and modes; of a rail with a path, last, the rotation of its middle section.
    residual: Vec<Motion>,
    /// Displacements of the same, m (rad).
    contact: Vec<f64>,
    /// What they moved by in the last step but for what they are elsewhere, m, and its length, s.
    contact_step: Vec<f64>,
    step: f64,
    /// Contact forces on them, N, and the torsion of the rail, N·m.
    forces: Vec<f64>,
    /// Where the contact is.
    at: Option<Arc<AtPlace>>,
    /// Work of what moved the wheel along the rail in the last step.
    driven: Driven,
}

/// A step of a reduced body.
pub(super) struct ReducedStep<'s, 'a> {
    body: &'s ReducedBody<'a>,
    state: &'s ReducedState,
    next: &'s mut ReducedState,
    flexibility: StepFlexibility<'a>,
    /// Torsion at the middle of the rail, N·m.
    torsion: f64,
    /// Right-hand side of the coordinates without contact forces.
    right: DVector<f64>,
    /// What the damping of the residual carries over, m.
    carried: Vec<f64>,
    /// Displacements of the interface without contact forces, m.
    free: Vec<f64>,
}

/// Displacements of the interface under `coordinates`.
fn at_interface(at: &AtPlace, coordinates: &DVector<f64>) -> Vec<f64> {
    let mut moved = vec![0.0; at.shapes.nrows()];
    add_product(at.of_body(), coordinates.as_slice(), 1.0, &mut moved);
    moved
}

fn part(motions: &[Motion], of: impl Fn(&Motion) -> f64) -> DVector<f64> {
    DVector::from_iterator(motions.len(), motions.iter().map(of))
}

impl<'a> LinearPart for ReducedBody<'a> {
    type State = ReducedState;
    type Load = BodyLoad;
    type Step<'s>
        = ReducedStep<'s, 'a>
    where
        Self: 's;

    fn predict<'s>(
        &'s self,
        state: &'s ReducedState,
        load: &BodyLoad,
        next: &'s mut ReducedState,
    ) -> ReducedStep<'s, 'a> {
        let (scheme, held, count) = (&self.scheme, self.hub.len(), self.modes());
        let mut right = &self.mass * part(&state.coordinates, |m| scheme.inertia(m));
        right += &self.weight * load.gravity;
        let velocity = part(&state.coordinates[held..], |m| scheme.damping(m));
        right.rows_mut(held, count).gemv(self.damping, &self.stiffness, &velocity, 1.0);
        for (place, motion) in self.hub.iter().enumerate() {
            let axis = TRANSLATIONS.iter().position(|translation| translation == motion);
            right[place] += axis.map_or(0.0, |axis| load.hub[axis]);
        }
        let of_torsion = self.of_torsion(load.torsion);
        right += &of_torsion;
        let at = self.at(load.place);
        let mut free = at_interface(&at, &(&self.effective_inverse * &right));
        let keeps = self.damping / self.stiffening();
        let carried: Vec<f64> = state.residual.iter().map(|m| keeps * scheme.damping(m)).collect();
        free.iter_mut().zip(&carried).for_each(|(u, c)| *u += c);
        if load.torsion != 0.0 {
            // what the modes leave of it
            let mut of_modes = DVector::zeros(held + count);
            of_modes.rows_mut(held, count).gemv(
                1.0,
                &self.static_inverse,
                &of_torsion.rows(held, count),
                0.0,
            );
            let beyond = at.twist.iter().zip(at_interface(&at, &of_modes));
            let beyond = beyond.map(|(all, modes)| (all * load.torsion - modes) / self.stiffening());
            free.iter_mut().zip(beyond).for_each(|(u, beyond)| *u += beyond);
        }
        let flexibility = StepFlexibility {
            compliance: &self.body.compliance,
            contact: self.contact_rows(),
            stiffening: self.stiffening(),
            at,
        };
        ReducedStep { body: self, state, next, flexibility, torsion: load.torsion, right, carried, free }
    }
}

impl LinearStep for ReducedStep<'_, '_> {
    fn free(&self) -> &[f64] {
        &self.free
    }

    fn flexibility(&self) -> MatRef<'_, f64> {
        self.flexibility.kept().as_ref()
    }

    fn finish(self, forces: &[f64]) {
        let Self { body, state, next, flexibility, torsion, mut right, carried, .. } = self;
        let (scheme, contact, at) = (&body.scheme, body.contact_rows(), flexibility.at);
        // most nodes carry none
        let loaded = forces.iter().copied().enumerate().filter(|(_, force)| *force != 0.0);
        let loads = in_runs(loaded);
        let on_all = at.on_all(&loads);
        let on_coordinates = on_all.rows(0, at.coordinates).into_owned();
        let mut statics = vec![0.0; contact];
        let compliance = body.body.compliance.submatrix(0, 0, contact, contact);
        add_times(compliance, &forces[..contact], &mut statics);
        let mut all_forces = forces[..contact].to_vec();
        if let Some(path) = body.path {
            let differs = &at.difference * on_all.rows(at.coordinates, at.difference.nrows());
            add_product(at.of_window(), differs.as_slice(), 1.0, &mut statics);
            statics.iter_mut().zip(&at.twist).for_each(|(all, twist)| *all += twist * torsion);
            let turned: f64 = loads
                .iter()
                .flat_map(|load| load.rows.clone().zip(&load.forces))
                .map(|(row, force)| at.twist[row] * force)
                .sum();
            statics.push(turned + path.twisted * torsion);
            all_forces.push(torsion);
        }
        let (held, stiffening) = (body.hub.len(), body.stiffening());
        right += &on_coordinates;
        let ends = &body.effective_inverse * right;
        let advanced = ends.iter().zip(&state.coordinates);
        let coordinates: Vec<Motion> = advanced.map(|(u, m)| scheme.advance(m, *u)).collect();
        // displacements and velocities of the interface with hub and modes, what of the statics is that of the modes, and what it has moved to another place
        let loaded = on_coordinates + body.of_torsion(torsion);
        let of_modes = &body.static_inverse * loaded.rows(held, body.modes());
        let mean: Vec<f64> = ends.iter().zip(&state.coordinates).map(|(u, m)| 0.5 * (u + m.u)).collect();
        let shares = Mat::from_fn(ends.len(), 4, |k, of| match of {
            0 => ends[k],
            1 => coordinates[k].v,
            2 if k < held => 0.0,
            2 => of_modes[k - held],
            _ => mean[k],
        });
        let mut motions = Mat::zeros(statics.len(), 4);
        let nodes = at.of_body().subrows(0, contact);
        matmul(motions.subrows_mut(0, contact), Accum::Replace, nodes, shares.as_ref(), 1.0, Par::Seq);
        if let Some(path) = body.path {
            (0..4).for_each(|of| {
                let works = path.twist.iter().zip(shares.col_as_slice(of));
                motions[(contact, of)] = works.map(|(twist, share)| twist * share).sum();
            });
        }
        if let Some(before) = state.at.as_ref().filter(|before| !Arc::ptr_eq(before, &at)) {
            let nodes = before.of_body().subrows(0, contact);
            add_product(nodes, &mean, -1.0, &mut motions.col_as_slice_mut(3)[..contact]);
        } else {
            motions.col_as_slice_mut(3).fill(0.0);
        }
        if body.path.is_some() {
            motions[(contact, 3)] = 0.0;
        }
        let [with, theirs, of_modes, elsewhere] = [0, 1, 2, 3].map(|of| motions.col_as_slice(of));
        let beyond_modes = statics.iter().zip(of_modes).map(|(all, modes)| all - modes);
        let residual: Vec<f64> =
            beyond_modes.zip(&carried).map(|(u, carried)| u / stiffening + carried).collect();
        let moved: Vec<f64> = with.iter().zip(&residual).map(|(u, r)| u + r).collect();
        let ways = moved.iter().zip(&state.contact).zip(elsewhere);
        let contact_step: Vec<f64> =
            ways.map(|((now, before), elsewhere)| now - before - elsewhere).collect();
        // nothing carries the velocity of a node without mass on: it is that of its last two steps, of second order whatever their
        // lengths; what hub and modes have of it is theirs
        let step = scheme.step();
        let beyond = step / (step + state.step);
        let velocity = |i: usize| {
            let mean = contact_step[i] / step;
            mean + beyond * (mean - state.contact_step[i] / state.step) - theirs[i]
        };
        let advanced = residual.iter().zip(&state.residual).enumerate();
        let residual =
            advanced.map(|(i, (u, m))| Motion { v: velocity(i), ..scheme.advance(m, *u) }).collect();
        let driven = match &state.at {
            Some(before) if !Arc::ptr_eq(before, &at) => {
                let coordinates_before = part(&state.coordinates, |m| m.u);
                let forces_before = &state.forces;
                let ends = [
                    Ends { at: before, forces: forces_before, coordinates: &coordinates_before },
                    Ends { at: &at, forces: &all_forces, coordinates: &ends },
                ];
                body.driven(ends)
            }
            _ => Driven::default(),
        };
        *next = ReducedState {
            coordinates,
            residual,
            contact: moved,
            contact_step,
            step,
            forces: all_forces,
            at: Some(at),
            driven,
        };
    }
}

impl ReducedBody<'_> {
    /// Energy of the axle, J.
    fn of_axle(&self, state: &ReducedState) -> f64 {
        let axle = HubSprings { axle: self.axle, ..HubSprings::default() };
        let turned = self.hub.iter().zip(&state.coordinates);
        turned.map(|(&motion, m)| 0.5 * axle.against(motion) * m.u * m.u).sum()
    }
}

impl ElasticBody for ReducedBody<'_> {
    fn in_motion(&self, velocity: &Vector2<f64>, acceleration: &Vector2<f64>) -> ReducedState {
        let of = |values: &Vector2<f64>, motion: usize| {
            let axis = TRANSLATIONS.iter().position(|&translation| translation == motion);
            axis.map_or(0.0, |axis| values[axis])
        };
        let hub = self.hub.iter().map(|&motion| Motion {
            u: 0.0,
            v: of(velocity, motion),
            a: of(acceleration, motion),
        });
        let (contact, with_torsion) =
            (self.contact_rows(), self.contact_rows() + usize::from(self.path.is_some()));
        let dt = self.scheme.step();
        let before = velocity * dt - acceleration * (0.5 * dt * dt);
        let uniform = self.hub.iter().map(|&motion| of(&before, motion)).chain(vec![0.0; self.modes()]);
        let uniform = DVector::from_iterator(self.at.coordinates, uniform);
        let mut contact_step = at_interface(&self.at, &uniform);
        contact_step.truncate(contact);
        contact_step.resize(with_torsion, 0.0);
        ReducedState {
            coordinates: hub.chain((0..self.modes()).map(|_| Motion::default())).collect(),
            residual: vec![Motion::default(); with_torsion],
            contact: vec![0.0; with_torsion],
            contact_step,
            step: dt,
            forces: vec![0.0; with_torsion],
            at: None,
            driven: Driven::default(),
        }
    }

    fn predict_both<'s>(
        [rail, wheel]: [&'s Self; 2],
        states: [&'s ReducedState; 2],
        loads: [&BodyLoad; 2],
        [rail_next, wheel_next]: [&'s mut ReducedState; 2],
    ) -> [Self::Step<'s>; 2] {
        [rail.predict(states[0], loads[0], rail_next), wheel.predict(states[1], loads[1], wheel_next)]
    }

    fn finish_both([rail, wheel]: [Self::Step<'_>; 2], forces: &[Vec<f64>; 2]) {
        rail.finish(&forces[0]);
        wheel.finish(&forces[1]);
    }

    fn interface<'s>(step: &'s Self::Step<'_>) -> Interface<'s> {
        let body = step.body;
        let row = |translation: usize| {
            let place = body.hub.iter().position(|&motion| motion == translation)?;
            Some(body.contact_rows() + place)
        };
        Interface {
            free: &step.free,
            flexibility: &step.flexibility,
            before: &step.state.contact,
            hub: TRANSLATIONS.map(row),
        }
    }

    fn equations(&self) -> usize {
        self.body.equations + self.hub.len()
    }

    fn mass(&self) -> f64 {
        self.body.mass
    }

    fn hub(&self, state: &ReducedState) -> Vector2<f64> {
        let of = |translation: usize| {
            let place = self.hub.iter().position(|&motion| motion == translation);
            place.map_or(0.0, |place| state.coordinates[place].u)
        };
        Vector2::new(of(1), of(2))
    }

    fn contact_displacement<'s>(&self, state: &'s ReducedState) -> &'s [f64] {
        &state.contact
    }

    fn energy(&self, before: &ReducedState, after: &ReducedState, gravity: f64) -> Option<PartEnergy> {
        let held = self.hub.len();
        let velocity = part(&after.coordinates, |m| m.v);
        let moved = part(&after.coordinates, |m| m.u) - part(&before.coordinates, |m| m.u);
        let (modes, of_modes) =
            (part(&after.coordinates[held..], |m| m.u), moved.rows(held, self.modes()).into_owned());
        // of the residual, what its forces did in the step and did not leave as energy; at rest that is what its damping took
        let of_residual = |state: &ReducedState| -> f64 {
            0.5 * state.residual.iter().zip(&state.forces).map(|(m, f)| m.u * f).sum::<f64>()
        };
        let forces = before.forces.iter().zip(&after.forces);
        let ways = before.residual.iter().zip(&after.residual);
        let done: f64 = forces.zip(ways).map(|((f0, f1), (m0, m1))| 0.5 * (f0 + f1) * (m1.u - m0.u)).sum();
        let (residual, gained) = (of_residual(after), of_residual(after) - of_residual(before));
        let damped = self.damping * of_modes.dot(&(&self.stiffness * &of_modes)) / after.step;
        // the torsion is the last of the forces
        let contact = self.contact_rows();
        let turned = |state: &ReducedState| state.contact.get(contact).copied().unwrap_or_default();
        let torsion = |state: &ReducedState| state.forces.get(contact).copied().unwrap_or_default();
        let twisted = 0.5 * (torsion(before) + torsion(after)) * (turned(after) - turned(before));
        let Driven { of_modes: on_modes, of_residual: on_residual } = after.driven;
        Some(PartEnergy {
            kinetic: 0.5 * velocity.dot(&(&self.mass * &velocity)),
            elastic: 0.5 * modes.dot(&(&self.stiffness * &modes)) + self.of_axle(after) + residual,
            work: gravity * self.weight.dot(&moved) + twisted + on_modes + on_residual,
            damped: damped + done + on_residual - gained,
            friction: 0.0,
        })
    }

    fn elastic(&self, state: &ReducedState) -> Vec<f64> {
        let modes = part(&state.coordinates[self.hub.len()..], |m| m.u);
        (&self.elastic * modes).as_slice().to_vec()
    }

    #[cfg(test)]
    fn sums(&self, state: &ReducedState) -> super::body::Sums {
        let (place, velocity) = (part(&state.coordinates, |m| m.u), part(&state.coordinates, |m| m.v));
        let modes = place.rows(self.hub.len(), self.modes());
        let work: f64 = state.residual.iter().zip(&state.forces).map(|(m, f)| m.u * f).sum();
        super::body::Sums {
            momentum: self.weight.dot(&velocity),
            moment: self.weight.dot(&place),
            energy: 0.5
                * (velocity.dot(&(&self.mass * &velocity)) + modes.dot(&(&self.stiffness * modes)) + work)
                + self.of_axle(state),
        }
    }
}
