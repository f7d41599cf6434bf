//! The forces of all contacts at a pose: along the normal by the strips, across it by their friction.

use nalgebra::Vector3;

use railspring_calibrate::element::{
    Contact, Deflections, Friction, Pose, Profiles, Relief, Relieved, StripStiffness,
};

/// A relief that is off by more than this, m, is settled first, before a pose goes after its forces, in so many rounds at most.
const FAR_OFF: f64 = 5e-6;
const SETTLINGS: usize = 12;

/// All contacts at a pose.
#[derive(Debug, Clone, Default)]
pub(super) struct Contacts {
    pub list: Vec<Contact>,
    /// What the strips' friction has taken up.
    pub deflections: Deflections,
    /// Their forces on the wheel with the moment about its reference point.
    pub all: Relieved,
    /// The relief that these make.
    pub relief: Relief,
}

impl Contacts {
    /// None, on a rail.
    pub fn none(profiles: &Profiles) -> Self {
        Self { deflections: Deflections::none(profiles.rail_length()), ..Self::default() }
    }

    /// The contacts at `pose`. What friction takes up there is not kept.
    pub fn find(
        &mut self,
        profiles: &mut Profiles,
        strips: &StripStiffness,
        pose: &Pose,
        friction: Option<&Friction>,
    ) {
        let Self { list, relief, .. } = self;
        self.all = profiles.settle(pose, strips, relief, friction, (SETTLINGS, FAR_OFF), list);
    }

    /// Takes the forces along with a motion of the wheel against the rail, to first order: a contact has its own stiffness, and of what all lose by the relief the share of its force.
    pub fn move_by(&mut self, moved: &Vector3<f64>) {
        let (list, all) = (&mut self.list, &mut self.all);
        let sum = |value: fn(&Contact) -> f64| list.iter().map(value).sum::<f64>();
        let carried = sum(|contact| contact.normal_force);
        let own: Vector3<f64> =
            list.iter().map(|contact| (contact.stiffness + contact.friction_stiffness) * moved).sum();
        let change = all.stiffness * moved;
        let relieved = (own - change) / carried;
        for contact in list.iter_mut() {
            contact.energy -= contact.force.dot(moved);
            if contact.sticks {
                contact.stored -= contact.friction.dot(moved);
            }
            contact.force += relieved * contact.normal_force - contact.stiffness * moved;
            contact.friction -= contact.friction_stiffness * moved;
            contact.normal_force = contact.force.xy().norm();
        }
        all.force -= change;
    }

    /// Keeps what the friction with which these contacts have just been found takes up.
    pub fn keep(&mut self, profiles: &mut Profiles, strips: &StripStiffness, friction: &Friction) {
        profiles.taken_up(strips, &self.relief, friction, &mut self.deflections);
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
