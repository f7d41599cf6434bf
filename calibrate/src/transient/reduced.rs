//! A body reduced to its modes, its hub's motions and the compliance of its contact nodes.
//!
//! Its coordinates are the free motions of the hub, with the mass of the whole body, and the modes of the body held there. The contact
//! nodes have no mass: beyond hub and modes they follow the contact forces by the residual of the static compliance, damped as
//! the material is.

#[cfg(test)]
mod tests;

use super::body::{BodyLoad, ElasticBody, Flexible, Interface};
use crate::contact::{NodalCompliance, Terms};
use crate::energy::PartEnergy;
use crate::error::{InputError, NumericsError, Result, StopReason};
use crate::linear_part::{LinearPart, LinearStep};
use crate::newmark::{Motion, Newmark};
use crate::superelement::{CondensedBody, Modes, add_times, times};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector2};
use std::ops::Range;
use std::sync::OnceLock;

/// Motions of a hub: translations y and z.
const TRANSLATIONS: [usize; 2] = [1, 2];

/// A condensed body, prepared for time steps of one length.
pub(super) struct ReducedBody<'a> {
    body: &'a CondensedBody,
    /// Free motions of the hub (0 to 5: translations, rotations).
    hub: Vec<usize>,
    /// Motions of the interface under unit coordinates; the hub's first, then the modes.
    shapes: Mat<f64>,
    /// Mass between the coordinates.
    mass: DMatrix<f64>,
    /// Stiffness between the modes.
    stiffness: DMatrix<f64>,
    /// Forces on the coordinates under a unit acceleration of the whole body downwards.
    weight: DVector<f64>,
    /// Inverse of the effective matrix of a step.
    effective_inverse: DMatrix<f64>,
    /// Inverse of the modes' stiffness.
    static_inverse: DMatrix<f64>,
    /// From the modes to forces in the norm of energy, N: [`ElasticBody::elastic`].
    elastic: DMatrix<f64>,
    /// What hub and modes add to the flexibility of the interface in a step beyond the static compliance is this times the shapes.
    half: Mat<f64>,
    /// Flexibility of the interface in a step, m/N, if it was wanted for every step.
    flexibility: OnceLock<Mat<f64>>,
    /// Damping proportional to stiffness, s.
    damping: f64,
    scheme: Newmark,
}

/// State of a reduced body at the end of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct ReducedState {
    /// Motions of the hub, then those of the modes.
    coordinates: Vec<Motion>,
    /// Motions of the contact nodes beyond hub and modes.
    residual: Vec<Motion>,
    /// Displacements of the contact nodes, m.
    contact: Vec<f64>,
    /// What they moved by in the last step, m, and its length, s.
    contact_step: Vec<f64>,
    step: f64,
    /// Contact forces on them, N.
    forces: Vec<f64>,
}

/// A step of a reduced body.
pub(super) struct ReducedStep<'s, 'a> {
    body: &'s ReducedBody<'a>,
    state: &'s ReducedState,
    next: &'s mut ReducedState,
    /// Right-hand side of the coordinates without contact forces.
    right: DVector<f64>,
    /// What the damping of the residual carries over, m.
    carried: Vec<f64>,
    /// Displacements of the interface without contact forces, m.
    free: Vec<f64>,
}

impl<'a> ReducedBody<'a> {
    /// A body with its first `count` modes, or all it has, damped by `damping` times its stiffness (s). `hub` are the free motions of its hub, none of a body that is held;
    /// `hub_stiffness` is added to the hub's vertical motion.
    ///
    /// # Errors
    /// [`InputError`] for a body without modes, [`NumericsError`] for modes whose matrices are not positive definite.
    pub(super) fn new(
        body: &'a CondensedBody,
        count: usize,
        damping: f64,
        scheme: &Newmark,
        hub: &[usize],
        hub_stiffness: f64,
    ) -> Result<Self> {
        let modes = body.modes.as_ref().ok_or_else(|| {
            InputError::new(
                "condensed body",
                "no modes",
                "a body condensed with modes for runs in time",
                "condense it again with `PairSolids::condense_in_time`",
            )
        })?;
        let count = count.min(modes.count());
        let (held, size) = (hub.len(), hub.len() + count);
        let stiffening = 1.0 + damping * scheme.velocity;
        let mass = DMatrix::from_fn(size, size, |i, j| match (hub.get(i), hub.get(j)) {
            (Some(&a), Some(&b)) => modes.rigid_mass(a, b),
            (Some(&motion), None) => modes.coupling(motion, j - held),
            (None, Some(&motion)) => modes.coupling(motion, i - held),
            (None, None) => f64::from(u8::from(i == j)),
        });
        let weight = DVector::from_fn(size, |i, _| match hub.get(i) {
            Some(&motion) => modes.rigid_mass(motion, 2),
            None => modes.coupling(2, i - held),
        });
        let stiffness = modes.stiffness(count);
        let mut effective = &mass * scheme.acceleration;
        effective.view_mut((held, held), (count, count)).zip_apply(&stiffness, |e, k| *e += stiffening * k);
        if let Some(vertical) = hub.iter().position(|&motion| motion == 2) {
            effective[(vertical, vertical)] += hub_stiffness;
        }
        let effective_inverse = inverse(effective)?;
        let static_inverse = inverse(stiffness.clone())?;
        let shapes = shapes(body, modes, hub, count);
        let elastic = energy_norm(&stiffness, &static_inverse, &shapes, body.nodes.len() / 2, held)?;
        let mut between = effective_inverse.clone();
        between
            .view_mut((held, held), (count, count))
            .zip_apply(&static_inverse, |e, k| *e -= k / stiffening);
        let between = Mat::from_fn(size, size, |i, j| between[(i, j)]);
        let mut half = Mat::zeros(shapes.nrows(), size);
        matmul(half.as_mut(), Accum::Replace, shapes.as_ref(), between.as_ref(), 1.0, Par::Seq);
        Ok(Self {
            body,
            hub: hub.to_vec(),
            shapes,
            mass,
            stiffness,
            weight,
            effective_inverse,
            static_inverse,
            elastic,
            half,
            flexibility: OnceLock::new(),
            damping,
            scheme: *scheme,
        })
    }

    /// How many modes it has.
    pub(super) fn modes(&self) -> usize {
        self.stiffness.nrows()
    }

    fn contact_rows(&self) -> usize {
        3 * self.body.nodes.len()
    }

    fn stiffening(&self) -> f64 {
        1.0 + self.damping * self.scheme.velocity
    }

    /// Displacements of the interface under `coordinates`.
    fn at_interface(&self, coordinates: &DVector<f64>) -> Vec<f64> {
        times(&self.shapes, coordinates.as_slice())
    }

    /// Forces on the coordinates of forces at the interface.
    fn on_coordinates(&self, loads: &[Load]) -> DVector<f64> {
        let mut sum = DVector::zeros(self.shapes.ncols());
        for Load { rows, forces } in loads {
            let shapes = self.shapes.subrows(rows.start, rows.len());
            add_product(shapes.transpose(), forces, 1.0, sum.as_mut_slice());
        }
        sum
    }
}

/// Forces on neighbouring rows of the interface, N.
struct Load {
    rows: Range<usize>,
    forces: Vec<f64>,
}

/// The nodes with forces lie in lines along the track, so that the rows come in runs: their part of a product is that of a matrix. Forces
/// are (row, N), ascending.
fn in_runs(forces: impl IntoIterator<Item = (usize, f64)>) -> Vec<Load> {
    let mut runs: Vec<Load> = Vec::new();
    for (row, force) in forces {
        match runs.last_mut() {
            Some(run) if row >= run.rows.end && row <= run.rows.end + GAP => {
                run.forces.resize(row - run.rows.start, 0.0);
                run.forces.push(force);
                run.rows.end = row + 1;
            }
            _ => runs.push(Load { rows: row..row + 1, forces: vec![force] }),
        }
    }
    runs
}

/// Rows without forces that a run may have between others: those of a node.
const GAP: usize = 3;

/// Adds `factor` times matrix times vector to a `sum`; on one thread, so that their number changes nothing.
fn add_product(matrix: MatRef<'_, f64>, vector: &[f64], factor: f64, sum: &mut [f64]) {
    let (rows, columns) = (matrix.nrows(), matrix.ncols());
    let vector = MatRef::from_column_major_slice(vector, columns, 1);
    let sum = MatMut::from_column_major_slice_mut(sum, rows, 1);
    matmul(sum, Accum::Add, matrix, vector, factor, Par::Seq);
}

/// Motions of the interface under unit motions of the hub and unit modes.
fn shapes(body: &CondensedBody, modes: &Modes, hub: &[usize], count: usize) -> Mat<f64> {
    let contact = 3 * body.nodes.len();
    let held = hub.len();
    Mat::from_fn(contact + held, held + count, |row, column| match hub.get(column) {
        Some(&motion) if row < contact => modes.rigid_motion(&body.nodes[row / 3], motion)[row % 3],
        Some(_) => f64::from(u8::from(row - contact == column)),
        None if row < contact => modes.contact(column - held)[row],
        None => 0.0,
    })
}

/// From modes to the square roots of their energy, over that of a unit force down on a contact node.
fn energy_norm(
    stiffness: &DMatrix<f64>,
    static_inverse: &DMatrix<f64>,
    shapes: &Mat<f64>,
    node: usize,
    held: usize,
) -> Result<DMatrix<f64>> {
    let count = stiffness.nrows();
    let down = DVector::from_fn(count, |mode, _| shapes[(3 * node + 2, held + mode)]);
    let compliance = down.dot(&(static_inverse * &down));
    let root = cholesky(stiffness.clone())?.l().transpose();
    // modes that a force there does not move say nothing of it
    Ok(if compliance > 0.0 { root / compliance.sqrt() } else { DMatrix::zeros(count, count) })
}

/// Inverse of a matrix that is positive definite.
fn inverse(matrix: DMatrix<f64>) -> Result<DMatrix<f64>> {
    let inverse = cholesky(matrix)?.inverse();
    Ok((&inverse + inverse.transpose()) * 0.5)
}

fn cholesky(matrix: DMatrix<f64>) -> Result<Cholesky<f64, Dyn>> {
    let symmetric = (&matrix + matrix.transpose()) * 0.5;
    let size = symmetric.nrows();
    let factor = Cholesky::new(symmetric).ok_or(NumericsError {
        stage: "matrices of the reduced body".into(),
        step: None,
        iteration: 0,
        residual: f64::NAN,
        active: size,
        reason: StopReason::Singular,
    })?;
    Ok(factor)
}

fn part(motions: &[Motion], of: impl Fn(&Motion) -> f64) -> DVector<f64> {
    DVector::from_iterator(motions.len(), motions.iter().map(of))
}

impl NodalCompliance for ReducedBody<'_> {
    fn coordinates(&self) -> usize {
        self.shapes.nrows()
    }

    fn terms(&self) -> Terms<'_> {
        let (matrix, factor) = (&self.body.compliance, 1.0 / self.stiffening());
        Terms { matrix, factor, product: Some([&self.half, &self.shapes]) }
    }
}

impl Flexible for ReducedBody<'_> {
    fn kept(&self) -> &Mat<f64> {
        self.flexibility.get_or_init(|| {
            let (contact, stiffening) = (self.contact_rows(), self.stiffening());
            let size = self.coordinates();
            let mut all = Mat::from_fn(size, size, |row, column| {
                if row < contact && column < contact {
                    self.body.compliance[(row, column)] / stiffening
                } else {
                    0.0
                }
            });
            let (half, shapes) = (self.half.as_ref(), self.shapes.transpose());
            matmul(all.as_mut(), Accum::Add, half, shapes, 1.0, Par::Seq);
            all
        })
    }

    fn under(&self, rows: &[usize], forces: &[(usize, f64)]) -> Vec<f64> {
        let (contact, stiffening) = (self.contact_rows(), self.stiffening());
        let loads = in_runs(forces.iter().copied());
        let on_coordinates = self.on_coordinates(&loads);
        let on_nodes = in_runs(forces.iter().copied().filter(|(row, _)| *row < contact));
        let mut moved = Vec::with_capacity(rows.len());
        // rows of neighbouring nodes at once, with those between them
        for run in in_runs(rows.iter().map(|&row| (row, 0.0))) {
            let Range { start, end } = run.rows;
            let mut all = run.forces;
            add_product(self.half.subrows(start, end - start), on_coordinates.as_slice(), 1.0, &mut all);
            let of_nodes = start..end.min(contact);
            for Load { rows, forces } in on_nodes.iter().filter(|_| !of_nodes.is_empty()) {
                let part = self.body.compliance.submatrix(start, rows.start, of_nodes.len(), rows.len());
                add_product(part, forces, 1.0 / stiffening, &mut all[..of_nodes.len()]);
            }
            let wanted = rows[moved.len()..].iter().take_while(|row| run.rows.contains(row));
            let wanted: Vec<f64> = wanted.map(|row| all[row - start]).collect();
            moved.extend(wanted);
        }
        moved
    }
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
        let mut free = self.at_interface(&(&self.effective_inverse * &right));
        let keeps = self.damping / self.stiffening();
        let carried: Vec<f64> = state.residual.iter().map(|m| keeps * scheme.damping(m)).collect();
        free.iter_mut().zip(&carried).for_each(|(u, c)| *u += c);
        ReducedStep { body: self, state, next, right, carried, free }
    }
}

impl LinearStep for ReducedStep<'_, '_> {
    fn free(&self) -> &[f64] {
        &self.free
    }

    fn flexibility(&self) -> MatRef<'_, f64> {
        self.body.kept().as_ref()
    }

    fn finish(self, forces: &[f64]) {
        let Self { body, state, next, mut right, carried, .. } = self;
        let (scheme, contact) = (&body.scheme, body.contact_rows());
        // most nodes carry none
        let loaded = forces.iter().copied().enumerate().filter(|(_, force)| *force != 0.0);
        let on_coordinates = body.on_coordinates(&in_runs(loaded));
        let mut statics = vec![0.0; contact];
        let compliance = body.body.compliance.submatrix(0, 0, contact, contact);
        add_times(compliance, &forces[..contact], &mut statics);
        let (held, stiffening) = (body.hub.len(), body.stiffening());
        right += &on_coordinates;
        let ends = &body.effective_inverse * right;
        let advanced = ends.iter().zip(&state.coordinates);
        let coordinates: Vec<Motion> = advanced.map(|(u, m)| scheme.advance(m, *u)).collect();
        // displacements and velocities of the interface with hub and modes, and what of the statics is that of the modes
        let of_modes = &body.static_inverse * on_coordinates.rows(held, body.modes());
        let shares = Mat::from_fn(ends.len(), 3, |k, of| match of {
            0 => ends[k],
            1 => coordinates[k].v,
            _ if k < held => 0.0,
            _ => of_modes[k - held],
        });
        let mut motions = Mat::zeros(contact, 3);
        let shapes = body.shapes.subrows(0, contact);
        matmul(motions.as_mut(), Accum::Replace, shapes, shares.as_ref(), 1.0, Par::Seq);
        let [with, theirs, of_modes] = [0, 1, 2].map(|of| motions.col_as_slice(of));
        let beyond_modes = statics.iter().zip(of_modes).map(|(all, modes)| all - modes);
        let residual: Vec<f64> =
            beyond_modes.zip(&carried).map(|(u, carried)| u / stiffening + carried).collect();
        let moved: Vec<f64> = with.iter().zip(&residual).map(|(u, r)| u + r).collect();
        let contact_step: Vec<f64> =
            moved.iter().zip(&state.contact).map(|(now, before)| now - before).collect();
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
        *next = ReducedState {
            coordinates,
            residual,
            contact: moved,
            contact_step,
            step,
            forces: forces[..contact].to_vec(),
        };
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
        let contact = self.contact_rows();
        let dt = self.scheme.step();
        let before = velocity * dt - acceleration * (0.5 * dt * dt);
        let uniform = self.hub.iter().map(|&motion| of(&before, motion)).chain(vec![0.0; self.modes()]);
        let mut contact_step = self.at_interface(&DVector::from_iterator(self.shapes.ncols(), uniform));
        contact_step.truncate(contact);
        ReducedState {
            coordinates: hub.chain((0..self.modes()).map(|_| Motion::default())).collect(),
            residual: vec![Motion::default(); contact],
            contact: vec![0.0; contact],
            contact_step,
            step: dt,
            forces: vec![0.0; contact],
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
            flexibility: body,
            before: &step.state.contact,
            hub: TRANSLATIONS.map(row),
        }
    }

    fn equations(&self) -> usize {
        self.body.equations + self.hub.len()
    }

    fn factor_values(&self) -> usize {
        0
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
        Some(PartEnergy {
            kinetic: 0.5 * velocity.dot(&(&self.mass * &velocity)),
            elastic: 0.5 * modes.dot(&(&self.stiffness * &modes)) + residual,
            work: gravity * self.weight.dot(&moved),
            damped: damped + done - gained,
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
                * (velocity.dot(&(&self.mass * &velocity)) + modes.dot(&(&self.stiffness * modes)) + work),
        }
    }
}
