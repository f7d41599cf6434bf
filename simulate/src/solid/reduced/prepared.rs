//! A condensed body, prepared for time steps of one length: mass, stiffness and inverses between its coordinates.

use crate::solid::at_place::AtPlace;
use crate::solid::load_case::HubSprings;
use crate::solid::path::RailPath;
use crate::time::newmark::Newmark;
use faer::Mat;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use railspring_calibrate::superelement::{CondensedBody, Modes};
use railspring_profiles::error::{InputError, NumericsError, Result, StopReason};
use std::sync::Arc;

/// A condensed body, prepared for time steps of one length.
pub(in super::super) struct ReducedBody<'a> {
    pub(super) body: &'a CondensedBody,
    /// Free motions of the hub (0 to 5: translations, rotations).
    pub(super) hub: Vec<usize>,
    /// Stiffness of the axle against rotations of the hub, N·m/rad.
    pub(super) axle: f64,
    /// The rail's places, of one along which the wheel moves.
    pub(super) path: Option<&'a RailPath>,
    /// Its interface at its only place, or in the middle.
    pub(super) at: Arc<AtPlace>,
    /// Mass between the coordinates.
    pub(super) mass: DMatrix<f64>,
    /// Stiffness between the modes.
    pub(super) stiffness: DMatrix<f64>,
    /// Forces on the coordinates under a unit acceleration of the whole body downwards.
    pub(super) weight: DVector<f64>,
    /// Inverse of the effective matrix of a step.
    pub(super) effective_inverse: DMatrix<f64>,
    /// Inverse of the modes' stiffness.
    pub(super) static_inverse: DMatrix<f64>,
    /// From the modes to forces in the norm of energy, N: [`ElasticBody::elastic`].
    pub(super) elastic: DMatrix<f64>,
    /// What hub and modes add to the flexibility in a step beyond the statics, between them.
    pub(super) between: DMatrix<f64>,
    /// Damping proportional to stiffness, s.
    pub(super) damping: f64,
    pub(super) scheme: Newmark,
}

impl<'a> ReducedBody<'a> {
    /// A body with its first `count` modes, or all it has, damped by `damping` times its stiffness (s), on a hub with its free motions and what holds these. A rail along a `path` has the modes of that.
    ///
    /// # Errors
    /// [`InputError`] for a body without modes, [`NumericsError`] for modes whose matrices are not positive definite.
    pub(in super::super) fn new(
        body: &'a CondensedBody,
        count: usize,
        damping: f64,
        scheme: &Newmark,
        springs: HubSprings<'_>,
        path: Option<&'a RailPath>,
    ) -> Result<Self> {
        let modes = path.map(RailPath::modes).or(body.modes.as_ref()).ok_or_else(|| {
            InputError::new(
                "condensed body",
                "no modes",
                "a body condensed with modes for runs in time",
                "condense it again with `PairSolids::condense_in_time`",
            )
        })?;
        let (hub, count) = (springs.free, count.min(modes.count()));
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
        hub.iter().enumerate().for_each(|(i, &motion)| effective[(i, i)] += springs.against(motion));
        let effective_inverse = inverse(effective)?;
        let static_inverse = inverse(stiffness.clone())?;
        let in_middle = path.map(|path| path.at(0.0, count));
        let shapes = match &in_middle {
            Some(at) => at.shapes.clone(),
            None => shapes(body, modes, hub, count),
        };
        let elastic = energy_norm(&stiffness, &static_inverse, &shapes, body.nodes.len() / 2, held)?;
        let mut between = effective_inverse.clone();
        between
            .view_mut((held, held), (count, count))
            .zip_apply(&static_inverse, |e, k| *e -= k / stiffening);
        let at = match in_middle {
            Some(at) => AtPlace::along(0.0, at, path, &between, stiffening),
            None => AtPlace::only(shapes, &between),
        };
        Ok(Self {
            body,
            hub: hub.to_vec(),
            axle: springs.axle,
            path,
            at: Arc::new(at),
            mass,
            stiffness,
            weight,
            effective_inverse,
            static_inverse,
            elastic,
            between,
            damping,
            scheme: *scheme,
        })
    }

    /// Its interface where the wheel is at `x` along the rail, m from the middle.
    pub(super) fn at(&self, x: f64) -> Arc<AtPlace> {
        match self.path {
            Some(path) if x != self.at.x => {
                let at = path.at(x, self.modes());
                Arc::new(AtPlace::along(x, at, Some(path), &self.between, self.stiffening()))
            }
            _ => self.at.clone(),
        }
    }

    /// How many modes it has.
    pub(in super::super) fn modes(&self) -> usize {
        self.stiffness.nrows()
    }

    pub(super) fn contact_rows(&self) -> usize {
        3 * self.body.nodes.len()
    }

    pub(super) fn stiffening(&self) -> f64 {
        1.0 + self.damping * self.scheme.velocity
    }

    /// What the modes have of a torsion at the middle of the rail, as forces on the coordinates.
    pub(super) fn of_torsion(&self, torsion: f64) -> DVector<f64> {
        let held = self.hub.len();
        DVector::from_fn(held + self.modes(), |i, _| match (self.path, i.checked_sub(held)) {
            (Some(path), Some(mode)) => path.twist[mode] * torsion,
            _ => 0.0,
        })
    }
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
    let factor = Cholesky::new(symmetric).ok_or(NumericsError::new(
        "matrices of the reduced body",
        StopReason::Singular,
        f64::NAN,
        size,
    ))?;
    Ok(factor)
}
