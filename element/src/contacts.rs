//! The forces of all contacts at a pose: along the normal by the strips, across it by their friction.

use nalgebra::Vector3;

use crate::law::StripStiffness;
use crate::overlap::Pose;
use crate::strips::{Contact, ContactStrips, Relieved};

/// A relief that is off by more than this, m, is not settled: it is taken into account to first order, so that forces are off by its square.
const RELIEF: f64 = 1e-8;

/// Distance of contacts from the wheel's reference point, m.
const LEVER: f64 = 0.1;

/// Share of the way to another contact that a pose may be away from where the contacts were looked at.
const OF_GAP: f64 = 0.5;

/// All contacts at a pose.
#[derive(Debug, Clone, Default)]
pub struct Contacts {
    /// In the order of the rail's profile.
    pub list: Vec<Contact>,
    /// Their forces on the wheel with the moment about its reference point.
    pub all: Relieved,
    /// Motion of the wheel against the rail since they were looked at.
    since: Vector3<f64>,
}

impl Contacts {
    /// Takes over others.
    pub fn copy_from(&mut self, other: &Self) {
        self.list.clone_from(&other.list);
        (self.all, self.since) = (other.all, other.since);
    }

    /// The contacts at `pose`.
    pub fn look(&mut self, strips: &mut ContactStrips, law: &StripStiffness, pose: &Pose, friction: f64) {
        self.all = strips.look(pose, law, friction, &mut self.list);
        self.since = Vector3::zeros();
    }

    /// Whether forces that are taken along to first order with a motion of the wheel against the rail are off by less than `tolerance`, N, where the contacts were looked at after
    /// a motion of `looked` (m) in the same step, if they were.
    ///
    /// The error of linear balance is `k²u²/6F` for Hertz's contact of a force `F` and a stiffness `k` after an approach `u`. For Mindlin's of a tangential stiffness `k` that begins to slide it is `k²u²/6µF`. Both are off by `F` times the square of the share of its width that it has moved, too. Strips
    /// that slide stick when the wheel turns back; where it goes on as it went, those between the places where it was looked at and where it is do.
    pub fn hold(&self, moved: &Vector3<f64>, looked: Option<f64>, friction: f64, tolerance: f64) -> bool {
        let moved = self.since + moved;
        let way = size(&moved);
        if !(way < OF_GAP * self.all.gap && self.all.off < RELIEF) {
            return false;
        }
        let back = looked.map_or(1.0, |looked| way / looked.max(way));
        let off = |contact: &Contact| {
            // the approach times the force is the work
            let pressed = contact.normal_stiffness * contact.force.dot(&moved) / contact.normal_force;
            let share = way / (contact.extent[1] - contact.extent[0]);
            let across = contact.tangential_stiffness * way;
            let slipped = match friction > 0.0 {
                true => across * across / (6.0 * friction * contact.normal_force) * back,
                false => 0.0,
            };
            pressed * pressed / (6.0 * contact.normal_force)
                + slipped
                + contact.normal_force * share * share
                + contact.sliding_stiffness * way * back
        };
        self.list.iter().map(off).sum::<f64>() < tolerance
    }

    /// Takes the forces along with a motion of the wheel against the rail, to first order: a contact has its own stiffness, and of what all lose by the relief the share of its force.
    pub fn move_by(&mut self, moved: &Vector3<f64>) {
        self.since += moved;
        let (list, all) = (&mut self.list, &mut self.all);
        let sum = |value: fn(&Contact) -> f64| list.iter().map(value).sum::<f64>();
        let carried = sum(|contact| contact.normal_force);
        if carried == 0.0 {
            return;
        }
        let own: Vector3<f64> =
            list.iter().map(|contact| (contact.stiffness + contact.friction_stiffness) * moved).sum();
        let change = all.stiffness * moved;
        let relieved = (own - change) / carried;
        for contact in list.iter_mut() {
            let [normal, across] = [
                relieved * contact.normal_force - contact.stiffness * moved,
                -contact.friction_stiffness * moved,
            ];
            contact.energy -= (contact.force + normal * 0.5).dot(moved);
            if contact.sticks {
                contact.stored -= (contact.friction + across * 0.5).dot(moved);
            }
            contact.force += normal;
            contact.friction += across;
            contact.normal_force = contact.force.xy().norm();
        }
        all.force -= change;
    }

    /// Friction forces on the wheel with their moment about its reference point.
    pub fn friction(&self) -> Vector3<f64> {
        self.list.iter().map(|contact| contact.friction).sum()
    }

    /// Elastic energy of the contacts, J: of the normal forces and of friction.
    pub fn elastic(&self) -> [f64; 2] {
        let sum = |value: fn(&Contact) -> f64| self.list.iter().map(value).sum::<f64>();
        [self.all.energy + sum(|contact| contact.energy), sum(|contact| contact.stored)]
    }
}

/// The largest displacement of a motion, m; not a number where one of its parts is none.
pub fn size(motion: &Vector3<f64>) -> f64 {
    let [x, y, turned] = [motion.x.abs(), motion.y.abs(), LEVER * motion.z.abs()];
    let largest = x.max(y).max(turned);
    if (x + y + turned).is_finite() { largest } else { f64::NAN }
}
