//! One step: the poses of rim and head at its end.

use nalgebra::{Matrix3, Vector2, Vector3};

use railspring_calibrate::element::{Friction, Pose, Profiles, StripStiffness};
use railspring_calibrate::error::{NumericsError, Result, StopReason};

use super::contact::Contacts;

/// Newton iterations of a step.
const ITERATIONS: usize = 100;
/// From so many on they are shortened where they do not come nearer, down to a share.
const FULL: usize = 8;
const SHORTEST: f64 = 1e-3;
/// Where they do come nearer, the longest grows by this.
const LONGER: f64 = 1.1;

/// What a pose may miss, m: with 10⁹ N/m a tenth of a newton.
const TOLERANCE: f64 = 1e-10;

/// What the relief of the contacts may be off, m: it is taken into account to first order, so that forces are off by its square.
const RELIEF: f64 = 1e-8;

/// A pose that misses less, m, may be settled by its last Newton step, with the forces taken along to first order.
const LAST_STEP: f64 = 1e-8;
/// What such a step may leave of a pose, m, if the steps before and after it get nearer by the same square.
const LEFT: f64 = 0.1 * TOLERANCE;

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

/// The largest displacement of a motion, m; not a number where one of its parts is none.
fn size(motion: &Vector3<f64>) -> f64 {
    let [x, y, turned] = [motion.x.abs(), motion.y.abs(), LEVER * motion.z.abs()];
    let largest = x.max(y).max(turned);
    if (x + y + turned).is_finite() { largest } else { f64::NAN }
}

impl Step<'_> {
    /// Iterates from the start of the step to balance, and writes it to `next`; how many iterations it took.
    ///
    /// The profiles turn and slide against each other within a step so little that the stiffness of the strips is its tangent
    /// but for a hundredth.
    ///
    /// # Errors
    /// [`NumericsError`] if the iteration does not settle.
    pub fn solve(&self, profiles: &mut Profiles, start: &Meeting, next: &mut Meeting) -> Result<usize> {
        // the first step goes from the start, whose contacts are known
        next.pose = start.pose;
        next.contacts.relief.copy_from(&start.contacts.relief);
        let at_start = self.off(start);
        if !self.correct(&mut next.pose, &start.contacts, &at_start, 1.0) {
            next.pose = start.pose;
        }
        let (mut last, mut length, mut longest) = (at_start.size(), 1.0_f64, 1.0_f64);
        for iteration in 1..=ITERATIONS {
            let friction = self.friction(start, &next.pose);
            next.contacts.find(profiles, self.strips, &next.pose, friction.as_ref());
            let off = self.off(next);
            let size = off.size();
            if !size.is_finite() {
                return Err(failure(iteration, size, &next.contacts, StopReason::NotFinite));
            }
            let settled = next.contacts.all.off < RELIEF;
            // Newton's steps square what is left
            let ahead = size * (size / last).powi(2);
            let lasts = settled && size < LAST_STEP && ahead < LEFT && !next.contacts.list.is_empty();
            if size < TOLERANCE && settled || lasts && self.finish(next, &off) {
                // from where the last step has led
                if let Some(friction) = self.friction(start, &next.pose) {
                    next.contacts.keep(profiles, self.strips, &friction);
                }
                return Ok(iteration);
            }
            // An iteration that goes round in a circle, between sticking and sliding or touching and not for instance, is shortened; one that
            // comes nearer as its length has it, is on one side and may be longer, but less so each time that it went round.
            if iteration > FULL {
                if size < (1.0 - 0.5 * length) * last {
                    longest = (LONGER * longest).min(1.0);
                    length = (1.5 * length).min(longest);
                } else {
                    longest = (0.8 * longest).max(SHORTEST);
                    length = (0.5 * length).max(SHORTEST);
                }
            }
            last = size;
            if !self.correct(&mut next.pose, &next.contacts, &off, length) {
                return Err(failure(iteration, size, &next.contacts, StopReason::Singular));
            }
        }
        Err(failure(ITERATIONS, last, &next.contacts, StopReason::IterationLimit))
    }

    /// Takes the last Newton step, and the forces along; whether there is one.
    fn finish(&self, next: &mut Meeting, off: &Off) -> bool {
        let before = next.pose;
        if !self.correct(&mut next.pose, &next.contacts, off, 1.0) {
            return false;
        }
        let moved = next.pose.wheel - before.wheel - off.to_wheel * (next.pose.rail - before.rail);
        next.contacts.move_by(&moved);
        true
    }

    /// Friction after what the strips had taken up at the start; none without a coefficient.
    fn friction<'s>(&self, start: &'s Meeting, pose: &Pose) -> Option<Friction<'s>> {
        let to_wheel = transport(&arm(&self.references, pose));
        let moved = pose.wheel - start.pose.wheel - to_wheel * (pose.rail - start.pose.rail);
        let before = &start.contacts.deflections;
        (self.friction > 0.0).then_some(Friction { coefficient: self.friction, before, moved })
    }

    /// What the sections are off from where the forces of the contacts have them.
    fn off(&self, at: &Meeting) -> Off {
        let (pose, force) = (&at.pose, &at.contacts.all.force);
        let to_wheel = transport(&arm(&self.references, pose));
        Off {
            wheel: pose.wheel - self.wheel.free - self.wheel.flexibility * force,
            rail: pose.rail - self.rail.free + self.rail.flexibility * to_wheel.tr_mul(force),
            to_wheel,
        }
    }

    /// Takes a Newton step, or a share `length` of it, with the stiffness of `contacts`; whether there is one.
    fn correct(&self, pose: &mut Pose, contacts: &Contacts, off: &Off, length: f64) -> bool {
        let (wheel, rail, to_wheel) = (&self.wheel.flexibility, &self.rail.flexibility, &off.to_wheel);
        if contacts.list.is_empty() {
            pose.wheel -= off.wheel * length;
            pose.rail -= off.rail * length;
            return true;
        }
        let both = wheel + to_wheel * rail * to_wheel.transpose();
        let system = Matrix3::identity() + both * contacts.all.stiffness;
        let Some(relative) = system.lu().solve(&(to_wheel * off.rail - off.wheel)) else {
            return false;
        };
        let force = contacts.all.stiffness * relative;
        pose.wheel -= (off.wheel + wheel * force) * length;
        pose.rail -= (off.rail - rail * to_wheel.tr_mul(&force)) * length;
        true
    }
}

/// What both sections are off.
struct Off {
    wheel: Vector3<f64>,
    rail: Vector3<f64>,
    /// From motions of the rail's section to those of the wheel's reference point.
    to_wheel: Matrix3<f64>,
}

impl Off {
    /// The largest, m; not a number where one of them is none.
    fn size(&self) -> f64 {
        let [wheel, rail] = [&self.wheel, &self.rail].map(size);
        if (wheel + rail).is_finite() { wheel.max(rail) } else { f64::NAN }
    }
}

fn failure(
    iteration: usize,
    residual: f64,
    contacts: &Contacts,
    reason: StopReason,
) -> railspring_calibrate::error::Error {
    let active = contacts.list.len();
    NumericsError { stage: "condensed element".into(), step: None, iteration, residual, active, reason }
        .into()
}
