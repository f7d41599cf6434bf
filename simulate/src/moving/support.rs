//! What carries the rail nodes: a beam in modal coordinates, or rigid ground.

use nalgebra::{DMatrix, DVector, Matrix3, Point2, Vector3};

use railspring_calibrate::error::{NumericsError, Result, StopReason};
use railspring_calibrate::newmark::{Motion, Newmark};

use railspring_calibrate::beam::{RailBeam, RailModes};

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

/// The rail at the wheel over one step, in directions 1, 2 and rotation 3: motion without contact, and stiffness against it.
pub(super) struct RailStep {
    pub free: Vector3<f64>,
    pub stiffness: Matrix3<f64>,
    /// Modal rows of the section at the wheel, and displacements without contact.
    rows: DMatrix<f64>,
    modal_free: DVector<f64>,
    modal_stiffness: DVector<f64>,
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

    /// The rail at rest, with its acceleration under a `torsion` (N·m about x) at the middle and a contact
    /// force (directions 1, 2 and moment 3) at `x`.
    pub fn start(&self, torsion: f64, x: f64, contact: Vector3<f64>) -> RailState {
        let load = &self.middle * torsion + self.rows(x) * contact;
        RailState { motions: load.iter().map(|&a| Motion { u: 0.0, v: 0.0, a }).collect() }
    }

    /// Sets up one step that ends with the wheel at `x` and the given torsion at the middle.
    pub fn step(&self, scheme: &Newmark, state: &RailState, x: f64, torsion: f64) -> Result<RailStep> {
        let size = state.motions.len();
        let modal_stiffness = DVector::from_fn(size, |i, _| {
            scheme.acceleration + scheme.velocity * self.damping[i] + self.modes.squares[i]
        });
        let modal_free = DVector::from_fn(size, |i, _| {
            let m = &state.motions[i];
            let load = self.middle[i] * torsion;
            (load + scheme.inertia(m) + self.damping[i] * scheme.damping(m)) / modal_stiffness[i]
        });
        let rows = self.rows(x);
        let mut flexibility = Matrix3::zeros();
        for i in 0..size {
            let row: Vector3<f64> = rows.fixed_view::<1, 3>(i, 0).transpose();
            flexibility += row * row.transpose() / modal_stiffness[i];
        }
        // A wheel over a held end finds no flexibility there.
        let scale = 1e-30 + 1e-12 * flexibility.trace();
        let stiffness = (flexibility + Matrix3::identity() * scale).try_inverse().ok_or(NumericsError {
            stage: "moving solver, rail".into(),
            step: None,
            iteration: 0,
            residual: f64::NAN,
            active: 0,
            reason: StopReason::Singular,
        })?;
        let free = rows.tr_mul(&modal_free).fixed_rows::<3>(0).into_owned();
        Ok(RailStep { free, stiffness, rows, modal_free, modal_stiffness })
    }
}

impl RailStep {
    /// State at the end of the step under the contact's force on the rail (directions 1, 2 and moment 3).
    pub fn finish(&self, scheme: &Newmark, state: &RailState, contact: Vector3<f64>) -> RailState {
        let motions = state.motions.iter().enumerate().map(|(i, m)| {
            let load: f64 = (0..3).map(|j| self.rows[(i, j)] * contact[j]).sum();
            scheme.advance(m, self.modal_free[i] + load / self.modal_stiffness[i])
        });
        RailState { motions: motions.collect() }
    }
}
