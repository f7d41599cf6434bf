//! Strips at poses near the one at which they were found.
//!
//! There the penetration of a strip is known to the second order of the motion: the wheel's surface slides over the place of the rail and turns with its
//! curvature. Forces and friction are those of the strips' laws. A contact grows or shrinks at its ends. Where the penetration there becomes `ε` and
//! its slope is `g`, the strips beyond have `c·ε²/(2g)`. A share `ε/6δ` of that is taken off, as the penetration, `δ` at its deepest, is a parabola. Where `ε` is
//! negative, the strips inside have too little by the same force. The relief goes along with the loads by Newton's method, with the derivatives of where the strips were
//! found.

use super::contact::{Contact, Relieved};
use super::contact_strips::ContactStrips;
use super::strip::{End, Pressed, Strip};
use crate::overlap::Pose;
use crate::relief::StripLoad;
use nalgebra::{Matrix3, Rotation2, Vector2, Vector3};

/// Strips serve until the wheel has slid over them by this, m: a fiftieth of a narrow contact.
const REACH: f64 = 5e-6;

/// They serve until a contact has changed at an end by this share of its depth, and its strips there may be off by so much, N.
const GROWN: f64 = 0.1;
const OFF_BY: f64 = 3.0;

/// A motion takes so much of the way that is left before there may be another contact: what the loads take off the penetrations changes as well.
const OF_GAP: f64 = 0.5;

/// Distance of contacts from the wheel's reference point, m.
const LEVER: f64 = 0.1;

impl ContactStrips {
    /// Lets the strips be found anew at the next look, wherever it is.
    pub fn find_anew(&mut self) {
        self.anew = true;
    }

    /// The contacts at a pose from the strips that were found last; none if it is too far from there.
    pub(super) fn near(
        &mut self,
        pose: &Pose,
        coefficient: f64,
        contacts: &mut Vec<Contact>,
    ) -> Option<Relieved> {
        if std::mem::take(&mut self.anew) {
            return None;
        }
        self.found.as_ref()?;
        let motion = self.motion_to(pose);
        let way = motion.xy().norm() + LEVER * motion.z.abs();
        if !(way < OF_GAP * self.profiles.gap) {
            return None;
        }
        self.loading.guess(&self.made, self.profiles.relief(), &(motion - self.motion));
        let serves = |end: &End, depth: f64| end.serves(depth, &motion, self.loading.shift(&end.strip.bells));
        for patch in &self.patches {
            let slid = self.strips[patch.deepest].slide.dot(&motion);
            let ends = &self.ends[patch.ends.clone()];
            if slid.abs() > REACH || !ends.iter().all(|end| serves(end, patch.depth)) {
                return None;
            }
        }
        (self.looked, self.motion) = (*pose, motion);
        self.sum(coefficient, false, contacts);
        let mut all = Relieved { gap: self.profiles.gap - way, ..Relieved::default() };
        if let Some(places) = &self.profiles.places {
            all.energy = self.loading.again(places, &mut self.made);
        }
        self.total(contacts, &mut all);
        Some(all)
    }

    /// The contacts where the strips have just been found, with the relief that their own loads make to first order: by Newton's method, so that a pose and its relief settle
    /// together.
    pub(super) fn relieve(&mut self, coefficient: f64, contacts: &mut Vec<Contact>) -> Relieved {
        self.loading.clear(self.profiles.places.as_ref());
        self.sum(coefficient, true, contacts);
        let mut all = Relieved { gap: self.profiles.gap, ..Relieved::default() };
        if let Some(places) = &self.profiles.places {
            all.energy = self.loading.relieve(places, self.profiles.relief(), &mut self.made);
            self.loading.soften();
        }
        self.total(contacts, &mut all);
        all
    }

    /// Sums the strips of all contacts, in the wheel's frame; where they have just been found, with the derivatives of their loads.
    fn sum(&mut self, coefficient: f64, found: bool, contacts: &mut Vec<Contact>) {
        let slid = if coefficient > 0.0 {
            self.motion - self.motion_to(self.taken_up.committed())
        } else {
            Vector3::zeros()
        };
        let Self { strips, ends, patches, loading, motion, .. } = self;
        contacts.clear();
        for patch in patches {
            let mut contact = Contact { extent: patch.extent, ..Contact::default() };
            let (mut sum, mut middle) = (0.0, Vector2::zeros());
            if found {
                loading.next_contact();
            }
            for strip in &mut strips[patch.strips.clone()] {
                let pressed = strip.pressed(motion, loading.shift(&strip.bells));
                let limit = strip.limit(coefficient, pressed.normal.abs());
                let wanted = strip.before + strip.aside.dot(&slid);
                let held = wanted.clamp(-limit, limit);
                (strip.now, strip.slides) = (held, held.abs() >= limit);
                if pressed.normal < 0.0 {
                    // what a strip has too little along the normal, it has across it as well
                    contact.friction += strip.aside * (strip.modulus.tangential * strip.width * held);
                    (strip.now, strip.slides) = (0.0, true);
                }
                let following = contact.add(strip, &pressed, coefficient > 0.0);
                let q = pressed.normal * strip.width;
                if found {
                    let stiffness = pressed.stiffness * strip.width * strip.weight;
                    let load = StripLoad {
                        load: q * strip.weight,
                        stiffness: stiffness * strip.weight,
                        normal: pressed.deeper * stiffness,
                        friction: following * strip.weight,
                    };
                    loading.add(&strip.bells, &load);
                } else {
                    loading.add_load(&strip.bells, q * strip.weight);
                }
                sum += q;
                contact.sliding_share += if strip.slides { q.max(0.0) } else { 0.0 };
                contact.rail_s += q * strip.rail_s;
                contact.wheel_s += q * strip.wheel_s;
                middle += strip.point * q;
            }
            if found {
                patch.gradients = loading.of_contact();
            } else {
                for end in &ends[patch.ends.clone()] {
                    let pressed = end.strip.pressed(motion, loading.shift(&end.strip.bells));
                    let force = contact.add_end(end, &pressed, patch.depth);
                    loading.add_load(&end.strip.bells, force * end.strip.weight);
                    // those beyond have moved as that beside them
                    let beside = &strips[end.nearest];
                    let wanted = beside.before + beside.aside.dot(&slid);
                    contact.friction -= end.strip.aside * end.friction(&pressed, force, wanted, coefficient);
                }
            }
            let over = if sum > 0.0 { 1.0 / sum } else { 0.0 };
            contact.sliding_share *= over;
            contact.rail_s *= over;
            contact.wheel_s *= over;
            contact.point = (middle * over).into();
            contacts.push(contact);
        }
    }

    /// Stiffness of all contacts where they were looked at last against motions of the wheel, world, with everything sticking on surfaces that do not turn.
    pub fn sticking(&self) -> Matrix3<f64> {
        let of = |strip: &Strip| {
            let Pressed { deeper, stiffness, .. } =
                strip.pressed(&self.motion, self.loading.shift(&strip.bells));
            let across = strip.aside * strip.modulus.tangential * strip.aside.transpose();
            (deeper * stiffness * deeper.transpose() + across) * strip.width
        };
        let mut sum: Matrix3<f64> = self.strips.iter().map(of).sum();
        if self.profiles.places.is_some() {
            sum -= self.loading.softness()[0];
        }
        let (_, whole) = self.to_world();
        whole * sum * whole.transpose()
    }

    /// From the wheel's frame, where the contacts were looked at last, into the world: of places, and of motions or forces.
    fn to_world(&self) -> (Rotation2<f64>, Matrix3<f64>) {
        let turn = Rotation2::new(self.looked.wheel.z);
        (turn, turn.matrix().fixed_resize::<3, 3>(0.0) + Matrix3::from_diagonal(&Vector3::z()))
    }

    /// Takes forces along with the last change of the relief, adds up all contacts and turns them into the world.
    fn total(&self, contacts: &mut [Contact], all: &mut Relieved) {
        for (patch, contact) in self.patches.iter().zip(contacts.iter_mut()) {
            for (gradient, more) in self.loading.changes(patch.gradients) {
                contact.force += gradient.normal * more;
                contact.friction += gradient.friction * more;
            }
        }
        let (turn, whole) = self.to_world();
        let turned = |matrix: &Matrix3<f64>| whole * matrix * whole.transpose();
        if self.profiles.places.is_some() {
            let [normal, friction] = self.loading.softness();
            all.off = self.loading.largest_change();
            all.stiffness -= turned(&(normal + friction));
        }
        for contact in contacts {
            for force in [&mut contact.force, &mut contact.friction] {
                *force = whole * *force;
            }
            for stiffness in [&mut contact.stiffness, &mut contact.friction_stiffness] {
                *stiffness = turned(stiffness);
            }
            contact.normal_force = contact.force.xy().norm();
            let along = contact.normal();
            let along = Vector3::new(along.x, along.y, 0.0);
            contact.normal_stiffness = along.dot(&(contact.stiffness * along));
            contact.point =
                self.profiles.wheel_origin() + self.looked.wheel.xy() + turn * contact.point.coords;
            all.force += contact.force + contact.friction;
            all.stiffness += contact.stiffness + contact.friction_stiffness;
        }
    }
}

impl End {
    /// Whether the contact ends after a motion as a parabola has it, where the relief has changed by `changed`, m.
    fn serves(&self, depth: f64, motion: &Vector3<f64>, changed: f64) -> bool {
        let grown = self.strip.pressed(motion, changed).depth.abs();
        let off = self.strip.modulus.normal * grown.powi(3) / (12.0 * self.slope * depth);
        grown < GROWN * depth && off < OFF_BY
    }

    /// Friction of the strips beyond that carry a normal `force` (N), N, under a tangential displacement, m.
    fn friction(&self, pressed: &Pressed, force: f64, wanted: f64, coefficient: f64) -> f64 {
        let width = pressed.depth.abs() / self.slope;
        let limit = coefficient * force / self.strip.cosine;
        (self.strip.modulus.tangential * width * wanted).clamp(-limit, limit)
    }
}

impl Contact {
    /// Adds a strip, in the wheel's frame; what friction there changes by with the penetration, N/m.
    fn add(&mut self, strip: &Strip, pressed: &Pressed, rubs: bool) -> Vector3<f64> {
        let (q, k) = (pressed.normal * strip.width, pressed.stiffness * strip.width);
        self.force -= pressed.deeper * q;
        let deeper = pressed.deeper * k;
        self.stiffness += deeper * pressed.deeper.transpose() + strip.turn * q * strip.slide.transpose();
        self.energy += strip.energy(pressed) * strip.width;
        let spring = strip.modulus.tangential * strip.width;
        let aside = strip.aside * spring;
        self.tangential_stiffness += spring;
        if !rubs {
            return Vector3::zeros();
        }
        self.friction -= aside * strip.now;
        self.stored += 0.5 * spring * strip.now * strip.now;
        if !strip.slides {
            self.friction_stiffness += aside * strip.aside.transpose();
            self.sticks = true;
            return Vector3::zeros();
        }
        self.sliding_stiffness += spring;
        if pressed.normal <= 0.0 {
            return Vector3::zeros();
        }
        // the limit goes with the normal force
        let follows = strip.aside * (strip.now / pressed.normal * strip.modulus.tangential);
        self.friction_stiffness += follows * deeper.transpose();
        follows * k
    }

    /// Adds what the strips beyond an end carry, or what those inside have too much, for a contact that is `depth` deep: the normal force, N.
    fn add_end(&mut self, End { strip, slope, .. }: &End, pressed: &Pressed, depth: f64) -> f64 {
        let (grown, share) = (pressed.depth, pressed.depth / (6.0 * depth));
        let width = grown / slope;
        let force = 0.5 * strip.modulus.normal * grown * width * (1.0 - share);
        self.force -= pressed.deeper * force;
        self.energy += force * grown / 3.0;
        let stiffness = strip.modulus.normal * width * (1.0 - 1.5 * share);
        self.stiffness += pressed.deeper * stiffness * pressed.deeper.transpose();
        force
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Uniform, at_origin, found, profile};
    use super::*;
    use nalgebra::Vector3;

    const COEFFICIENT: f64 = 0.3;

    /// Source: Coulomb's law, under which the force of a contact that moves across goes at most with its tangential stiffness. Goal: a contact of a crowned wheel that has become
    /// narrower or wider at its ends since its strips were found, moved across from where nothing is taken up until most of it slides, has a friction (N) that never changes by
    /// more than that. Accuracy: ROUNDOFF of the friction; the strips beyond an end of a contact that has become wider by a fiftieth of its depth have a hundredth of its stiffness
    /// in addition.
    #[test]
    fn friction_near_by_does_not_jump() {
        const ROUNDOFF: f64 = 1e-9;
        const STEPS: i32 = 400;
        let (rail, wheel) = (profile(|_| 0.0), profile(|y| -y * y / 0.6));
        let law = Uniform(4e10);
        let depth = 40e-6;
        for deeper in [-0.02, 0.02] {
            let mut bodies = at_origin(&rail, &wheel, &law);
            let pose = |u: f64, share: f64| Pose {
                wheel: Vector3::new(u, depth * (1.0 + share), 0.0),
                ..Pose::default()
            };
            let mut contacts = found(&mut bodies, &pose(0.0, 0.0), &law);
            let (normal, stiffness) = (contacts[0].normal_force, contacts[0].tangential_stiffness);
            bodies.look(&pose(0.0, 0.0), &law, COEFFICIENT, &mut contacts);
            bodies.commit(COEFFICIENT);
            let most = 1.2 * COEFFICIENT * normal / stiffness;
            let at = |i: i32| most * f64::from(i) / f64::from(STEPS);
            let mut last: Option<f64> = None;
            let mut near = 0;
            for i in -STEPS..=STEPS {
                // strips serve until the wheel has slid over them by a little
                if at(i).abs() > 0.9 * REACH {
                    continue;
                }
                assert!(bodies.near(&pose(at(i), deeper), COEFFICIENT, &mut contacts).is_some());
                let force = contacts[0].friction.x;
                if let Some(last) = last {
                    let step = (force - last).abs();
                    let bound = 1.01 * stiffness * most / f64::from(STEPS);
                    assert!(
                        step < bound + ROUNDOFF * normal,
                        "{deeper} {i}: {last} {force}, {step} of {bound}"
                    );
                }
                (last, near) = (Some(force), near + 1);
            }
            assert!(near > STEPS / 10, "{near}");
        }
    }
}
