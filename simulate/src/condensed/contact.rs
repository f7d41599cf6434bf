//! The forces of all contacts at a pose: along the normal by the strips, across it by friction.

use nalgebra::{Matrix3, Rotation2, Vector2, Vector3};

use railspring_calibrate::element::{Contact, Pose, Profiles, StripStiffness};
use railspring_calibrate::history::ContactMode;

/// A contact with its friction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patch {
    pub contact: Contact,
    /// Unit tangent, world (y, z).
    pub tangent: Vector2<f64>,
    /// Force on the wheel along it, N.
    pub tangential: f64,
    /// Its stiffness, N/m.
    pub stiffness: f64,
    pub mode: ContactMode,
}

impl Patch {
    /// Motion of the wheel against the rail along the tangent per motion of the wheel's reference point.
    fn direction(&self, reference: &Vector2<f64>) -> Vector3<f64> {
        let arm = self.contact.point.coords - reference;
        Vector3::new(self.tangent.x, self.tangent.y, arm.perp(&self.tangent))
    }

    /// Elastic energy of the tangential stiffness, J.
    pub fn stored(&self) -> f64 {
        if self.stiffness > 0.0 { 0.5 * self.tangential * self.tangential / self.stiffness } else { 0.0 }
    }
}

/// All contacts at a pose.
#[derive(Debug, Clone, Default)]
pub(super) struct Contacts {
    /// What the profiles have.
    found: Vec<Contact>,
    pub patches: Vec<Patch>,
    /// Forces on the wheel with their moment about its reference point.
    pub force: Vector3<f64>,
    /// Minus their derivative by the motion of the wheel against the rail.
    pub stiffness: Matrix3<f64>,
    /// Potential of the normal forces, J.
    pub energy: f64,
    /// Where the wheel's reference point is, world (y, z), m.
    pub reference: Vector2<f64>,
}

impl Contacts {
    /// The contacts at `pose` under strips and a coefficient of friction, after `last`, since which the wheel has moved by `moved` against the
    /// rail (about the wheel's reference point, at `reference`).
    pub fn find(
        &mut self,
        profiles: &mut Profiles,
        (strips, friction): (&StripStiffness, f64),
        pose: &Pose,
        reference: Vector2<f64>,
        last: &Self,
        moved: &Vector3<f64>,
    ) {
        profiles.contacts(pose, strips, &mut self.found);
        self.found.retain(|contact| contact.normal_force > 0.0);
        self.patches.clear();
        (self.force, self.stiffness, self.energy) = (Vector3::zeros(), Matrix3::zeros(), 0.0);
        self.reference = reference;
        for &contact in &self.found {
            let normal = contact.force.xy() / contact.normal_force;
            let tangent = Rotation2::new(std::f64::consts::FRAC_PI_2) * normal;
            let stiffness = strips.tangential(contact.rail_s) * contact.normal_stiffness;
            let mut patch = Patch { contact, tangent, tangential: 0.0, stiffness, mode: ContactMode::Slip };
            let limit = friction * contact.normal_force;
            if friction > 0.0 {
                let (carried, was) = last.carried(&patch, &self.found);
                // a stiffness that falls lets go of its share; one that grows keeps the force: either way no energy comes of it
                let kept = if was > stiffness { carried * stiffness / was } else { carried };
                let trial = kept - stiffness * patch.direction(&reference).dot(moved);
                patch.mode = if trial.abs() < limit { ContactMode::Stick } else { ContactMode::Slip };
                patch.tangential = trial.clamp(-limit, limit);
            }
            let direction = patch.direction(&reference);
            self.force += contact.force + direction * patch.tangential;
            self.stiffness += contact.stiffness;
            self.stiffness += match patch.mode {
                ContactMode::Stick => direction * direction.transpose() * stiffness,
                _ => {
                    let share = patch.tangential / contact.normal_force;
                    let along = Vector3::new(normal.x, normal.y, 0.0);
                    direction * (along.transpose() * contact.stiffness) * share
                }
            };
            self.energy += contact.energy;
            self.patches.push(patch);
        }
    }

    /// The tangential force (N) that a patch of the contacts `all` has from those before it, along its tangent, and their stiffness. What
    /// a contact had goes to those that are where it was, by their widths there.
    fn carried(&self, patch: &Patch, all: &[Contact]) -> (f64, f64) {
        let mut sum = (0.0, 0.0);
        for before in &self.patches {
            let overlap = |contact: &Contact| {
                let ([a, b], [c, d]) = (contact.extent, before.contact.extent);
                (b.min(d) - a.max(c)).max(0.0)
            };
            let own = overlap(&patch.contact);
            if own > 0.0 {
                let share = own / all.iter().map(overlap).sum::<f64>();
                sum.0 += share * before.tangential * before.tangent.dot(&patch.tangent);
                sum.1 += share * before.stiffness;
            }
        }
        sum
    }

    /// Stiffness with everything sticking.
    pub fn sticking(&self) -> Matrix3<f64> {
        let of = |patch: &Patch| {
            let direction = patch.direction(&self.reference);
            patch.contact.stiffness + direction * direction.transpose() * patch.stiffness
        };
        self.patches.iter().map(of).sum()
    }

    /// Friction forces on the wheel with their moment about its reference point.
    pub fn friction(&self) -> Vector3<f64> {
        self.patches.iter().map(|patch| patch.direction(&self.reference) * patch.tangential).sum()
    }

    /// Elastic energy of friction, J.
    pub fn stored(&self) -> f64 {
        self.patches.iter().map(Patch::stored).sum()
    }
}
