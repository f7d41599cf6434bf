//! One step: the poses of rim and head at its end.

use nalgebra::{Matrix3, Vector2, Vector3};

use railspring_calibrate::element::{Pose, Profiles, StripStiffness};
use railspring_calibrate::error::{NumericsError, Result, StopReason};

use super::contact::Contacts;

/// Newton iterations of a step.
const ITERATIONS: usize = 40;
/// From so many on they are shortened where they do not come nearer.
const FULL: usize = 8;

/// What a pose may miss, m: with 10⁹ N/m a hundredth of a newton.
const TOLERANCE: f64 = 1e-11;

/// Lever that turns a rotation into a displacement, m.
const LEVER: f64 = 0.1;

/// A side of the contact over one step: at its end the section has moved by `free + flexibility·force` under the contact's force there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    /// Motion without contact force at the end of the step.
    pub free: Vector3<f64>,
    /// Motion per contact force at the end.
    pub flexibility: Matrix3<f64>,
}

/// Where the sections are, and the contact between them.
#[derive(Debug, Clone, Default)]
pub(super) struct Meeting {
    pub pose: Pose,
    pub contacts: Contacts,
}

/// What a step is done with.
pub(super) struct Step<'a> {
    pub wheel: Side,
    pub rail: Side,
    pub strips: &'a StripStiffness,
    pub friction: f64,
    /// World positions of the reference points of wheel and rail at rest, m.
    pub references: [Vector2<f64>; 2],
}

/// From the rail's reference point to the wheel's at a pose, m.
pub(super) fn arm(references: &[Vector2<f64>; 2], pose: &Pose) -> Vector2<f64> {
    references[0] + pose.wheel.xy() - references[1] - pose.rail.xy()
}

/// Motion of the rail's section at the wheel's reference point, `arm` from its own.
pub(super) fn transport(arm: &Vector2<f64>) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, -arm.y, 0.0, 1.0, arm.x, 0.0, 0.0, 1.0)
}

fn size(motion: &Vector3<f64>) -> f64 {
    motion.x.abs().max(motion.y.abs()).max(LEVER * motion.z.abs())
}

impl Step<'_> {
    /// Iterates from `guess` to balance, and writes it to `next`; how many iterations it took.
    ///
    /// The profiles turn and slide against each other within a step so little that the stiffness of the strips is its tangent
    /// but for a hundredth.
    ///
    /// # Errors
    /// [`NumericsError`] if the iteration does not settle.
    pub fn solve(
        &self,
        profiles: &mut Profiles,
        start: &Meeting,
        guess: Pose,
        next: &mut Meeting,
    ) -> Result<usize> {
        next.pose = guess;
        let (mut last, mut length) = (f64::INFINITY, 1.0_f64);
        for iteration in 1..=ITERATIONS {
            let pose = &mut next.pose;
            let to_wheel = transport(&arm(&self.references, pose));
            let moved = pose.wheel - start.pose.wheel - to_wheel * (pose.rail - start.pose.rail);
            let reference = self.references[0] + pose.wheel.xy();
            let contacts = &mut next.contacts;
            contacts.find(profiles, (self.strips, self.friction), pose, reference, &start.contacts, &moved);
            let (Side { free: rim, flexibility: wheel }, Side { free: head, flexibility: rail }) =
                (self.wheel, self.rail);
            let off_wheel = pose.wheel - rim - wheel * contacts.force;
            let off_rail = pose.rail - head + rail * to_wheel.tr_mul(&contacts.force);
            let off = size(&off_wheel).max(size(&off_rail));
            if !off.is_finite() {
                return Err(failure(iteration, off, contacts, StopReason::NotFinite));
            }
            if off < TOLERANCE {
                return Ok(iteration);
            }
            // an iteration that goes round in a circle, between sticking and sliding for instance
            if off > 0.5 * last && iteration > FULL {
                length = (0.7 * length).max(0.1);
            }
            last = off;
            let both = wheel + to_wheel * rail * to_wheel.transpose();
            let system = Matrix3::identity() + both * contacts.stiffness;
            let Some(relative) = system.lu().solve(&(to_wheel * off_rail - off_wheel)) else {
                return Err(failure(iteration, off, contacts, StopReason::Singular));
            };
            let force = contacts.stiffness * relative;
            pose.wheel -= (off_wheel + wheel * force) * length;
            pose.rail -= (off_rail - rail * to_wheel.tr_mul(&force)) * length;
        }
        Err(failure(ITERATIONS, last, &next.contacts, StopReason::IterationLimit))
    }
}

fn failure(
    iteration: usize,
    residual: f64,
    contacts: &Contacts,
    reason: StopReason,
) -> railspring_calibrate::error::Error {
    let active = contacts.patches.len();
    NumericsError { stage: "condensed element".into(), step: None, iteration, residual, active, reason }
        .into()
}
