//! One step: the poses of rim and head at its end.

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::law::StripStiffness;
use crate::overlap::Pose;
use crate::strips::ContactStrips;
use railspring_profiles::error::{NumericsError, Result, StopReason};

use crate::contacts::{Contacts, size};

/// Looks at the contacts of a step.
const ITERATIONS: usize = 100;
/// From so many on the way from one to the next is shortened where they do not come nearer, down to a share.
const FULL: usize = 8;
const SHORTEST: f64 = 1e-3;
/// Where they do come nearer, the longest grows by this.
const LONGER: f64 = 1.02;

/// A side of the contact over one step: at its end the section has moved by `free + flexibility·force` under the contact's force there.
#[derive(Debug, Clone, Copy)]
pub struct Side {
    /// Motion without contact force at the end of the step.
    pub free: Vector3<f64>,
    /// Motion per contact force at the end.
    pub flexibility: Matrix3<f64>,
}

/// Where the sections are, and the contact between them.
#[derive(Debug, Clone, Default)]
pub struct Meeting {
    /// Where they are.
    pub pose: Pose,
    /// The contact there.
    pub contacts: Contacts,
    /// Force on the wheel beside that of the contacts.
    pub beside: Vector3<f64>,
}

impl Meeting {
    /// Force on the wheel with its moment about the wheel's reference point.
    pub fn force(&self) -> Vector3<f64> {
        self.contacts.all.force + self.beside
    }
}

/// What a step is done with.
pub struct Step<'a> {
    /// The rim.
    pub wheel: Side,
    /// The rail's head.
    pub rail: Side,
    /// Stiffness of the strips.
    pub law: &'a StripStiffness,
    /// Coefficient of friction.
    pub friction: f64,
    /// Force on the wheel beside that of the contacts, at the end.
    pub beside: Vector3<f64>,
    /// Largest error of a force at its end, N.
    pub tolerance: f64,
    /// World positions of the reference points of wheel and rail at rest, m.
    pub references: [Vector2<f64>; 2],
}

/// From the rail's reference point to the wheel's at a pose, m.
pub fn arm(references: &[Vector2<f64>; 2], pose: &Pose) -> Vector2<f64> {
    references[0] + pose.wheel.xy() - references[1] - pose.rail.xy()
}

/// Motion of the rail's section at the wheel's reference point, `arm` from its own.
pub fn transport(arm: &Vector2<f64>) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, -arm.y, 0.0, 1.0, arm.x, 0.0, 0.0, 1.0)
}

impl Step<'_> {
    /// Iterates from the start of the step to balance, and writes it to `next`; how often the contacts were looked at.
    ///
    /// Balance is linear in the forces, so that Newton's step leads to where it is for forces that follow the motion to first order; the step is
    /// done where they do so within the tolerance.
    ///
    /// # Errors
    /// [`NumericsError`] if the iteration does not settle, and for forces that are no numbers.
    pub fn solve(&self, strips: &mut ContactStrips, start: &Meeting, next: &mut Meeting) -> Result<usize> {
        (next.pose, next.beside) = (start.pose, self.beside);
        next.contacts.copy_from(&start.contacts);
        let (mut last, mut length, mut longest) = (f64::INFINITY, 1.0_f64, 1.0_f64);
        for looks in 0..=ITERATIONS {
            let residual = self.residual(next);
            let size = residual.size();
            if !size.is_finite() {
                return Err(failure(looks, size, &next.contacts, StopReason::NotFinite));
            }
            // An iteration that goes round in a circle, between sticking and sliding or touching and not for instance, is shortened and has the
            // derivatives of strips found anew; one that
            // comes nearer as its length has it, is on one side and may be longer, but less so each time that it went round.
            if looks > FULL {
                if size < (1.0 - 0.5 * length) * last {
                    longest = (LONGER * longest).min(1.0);
                    length = (1.5 * length).min(longest);
                } else {
                    strips.find_anew();
                    longest = (0.8 * longest).max(SHORTEST);
                    length = (0.5 * length).max(SHORTEST);
                }
            }
            last = size;
            let before = next.pose;
            if !self.correct(&mut next.pose, &next.contacts, &residual, 1.0) {
                return Err(failure(looks, size, &next.contacts, StopReason::Singular));
            }
            let moved = next.pose.wheel - before.wheel - residual.to_wheel * (next.pose.rail - before.rail);
            let looked = (looks > 0).then(|| self.way(start, &before));
            if next.contacts.hold(&moved, looked, self.friction, self.tolerance) {
                next.contacts.move_by(&moved);
                let all = &next.contacts.all;
                return match (all.force.sum() + all.stiffness.sum()).is_finite() {
                    true => Ok(looks),
                    false => Err(failure(looks, size, &next.contacts, StopReason::NotFinite)),
                };
            }
            if length < 1.0 {
                next.pose = before;
                self.correct(&mut next.pose, &next.contacts, &residual, length);
            }
            next.contacts.look(strips, self.law, &next.pose, self.friction);
        }
        Err(failure(ITERATIONS, last, &next.contacts, StopReason::IterationLimit))
    }

    /// How far the wheel has moved against the rail in the step, m.
    fn way(&self, start: &Meeting, pose: &Pose) -> f64 {
        let to_wheel = transport(&arm(&self.references, pose));
        size(&(pose.wheel - start.pose.wheel - to_wheel * (pose.rail - start.pose.rail)))
    }

    /// The distance of the sections from where the forces of the contacts have them.
    fn residual(&self, at: &Meeting) -> Residual {
        let (pose, force) = (&at.pose, &at.force());
        let to_wheel = transport(&arm(&self.references, pose));
        Residual {
            wheel: pose.wheel - self.wheel.free - self.wheel.flexibility * force,
            rail: pose.rail - self.rail.free + self.rail.flexibility * to_wheel.tr_mul(force),
            to_wheel,
        }
    }

    /// Takes a Newton step, or a share `length` of it, with the stiffness of `contacts`; whether there is one.
    fn correct(&self, pose: &mut Pose, contacts: &Contacts, residual: &Residual, length: f64) -> bool {
        let (wheel, rail, to_wheel) = (&self.wheel.flexibility, &self.rail.flexibility, &residual.to_wheel);
        if contacts.list.is_empty() {
            pose.wheel -= residual.wheel * length;
            pose.rail -= residual.rail * length;
            return true;
        }
        let both = wheel + to_wheel * rail * to_wheel.transpose();
        let system = Matrix3::identity() + both * contacts.all.stiffness;
        let Some(inverse) = system.try_inverse() else {
            return false;
        };
        let force = contacts.all.stiffness * (inverse * (to_wheel * residual.rail - residual.wheel));
        pose.wheel -= (residual.wheel + wheel * force) * length;
        pose.rail -= (residual.rail - rail * to_wheel.tr_mul(&force)) * length;
        true
    }
}

/// The residual of both sections.
struct Residual {
    wheel: Vector3<f64>,
    rail: Vector3<f64>,
    /// From motions of the rail's section to those of the wheel's reference point.
    to_wheel: Matrix3<f64>,
}

impl Residual {
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
) -> railspring_profiles::error::Error {
    let active = contacts.list.len();
    NumericsError::new("condensed element", reason, residual, active).after(iteration).into()
}
