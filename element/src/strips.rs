//! The contact of two profiles as strips across the track.
//!
//! A strip at a place of the rail carries a normal force per length that grows with the penetration there, along the normal of the wheel; the force of a
//! contact is the sum over its width. So a contact is as wide as the profiles make it, two contacts that
//! grow together become one, and nothing jumps: the normal forces have a potential. J. Piotrowski, H. Chollet, "Wheel–rail contact
//! models for vehicle system dynamics including multi-point contact", Vehicle Syst. Dyn. 43 (2005), call such a method one of virtual
//! penetration; here its stiffness is that of the solids.
//!
//! What the loads move beside their strips stands in [`crate::relief`].
//!
//! Friction acts on every strip: a tangential spring that Coulomb's law limits by the normal force there (`friction`). The strips at the edges of a contact
//! slide first. With strips whose forces are spread as a parabola the tangential force is C. Cattaneo's and R.D. Mindlin's,
//! `1 - (1 - u/u₁)^(3/2)` of the limit at a displacement `u`, where everything slides from `u₁` on, and its loops when the force turns are theirs as well.
//!
//! Where the strips are is found at one pose; at poses near it they are the same strips, pressed otherwise (`near`).

mod contact;
mod strip;
mod taken_up;
mod contact_strips;
mod friction;
mod near;

use crate::modulus::StripLaw;
use crate::overlap::Pose;
use crate::relief::Relief;

pub use self::contact::{Contact, Relieved};
pub use self::contact_strips::ContactStrips;

/// Times that contacts are relieved of what their own loads make, and by how much the last time at most, m.
const MOST_SETTLINGS: usize = 30;
const RELIEVED: f64 = 1e-12;

/// A relief that is off by more than this, m, is settled first, before a pose goes after its forces, in so many rounds at most.
const FAR_OFF: f64 = 5e-6;
const SETTLINGS: usize = 12;

impl ContactStrips {
    /// The contacts at a pose, in the order of the rail's profile, with a coefficient of friction.
    pub fn look(
        &mut self,
        pose: &Pose,
        law: &impl StripLaw,
        coefficient: f64,
        contacts: &mut Vec<Contact>,
    ) -> Relieved {
        match self.near(pose, coefficient, contacts) {
            Some(relieved) => relieved,
            None => {
                self.keep(coefficient);
                self.settle(pose, law, coefficient, (SETTLINGS, FAR_OFF), contacts)
            }
        }
    }

    /// The contacts at a pose without friction, relieved of what their own loads make.
    pub fn settled(&mut self, pose: &Pose, law: &impl StripLaw, contacts: &mut Vec<Contact>) -> Relieved {
        self.made = Relief::default();
        self.settle(pose, law, 0.0, (MOST_SETTLINGS, RELIEVED), contacts)
    }

    /// The contacts at a pose under the relief that their own loads make, from the last one on: so often, or until it changes by less (m).
    fn settle(
        &mut self,
        pose: &Pose,
        law: &impl StripLaw,
        coefficient: f64,
        (times, least): (usize, f64),
        contacts: &mut Vec<Contact>,
    ) -> Relieved {
        let mut time = 1;
        loop {
            self.find(pose, law, coefficient);
            let relieved = self.relieve(coefficient, contacts);
            // under more than their loads would make there may be none where there are some
            let lost = contacts.is_empty() && relieved.off > 0.0;
            if relieved.off < least && !lost || time >= times {
                return relieved;
            }
            time += 1;
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
