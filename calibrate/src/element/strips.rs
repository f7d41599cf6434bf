//! The contact of two profiles as strips across the track.
//!
//! A strip at a place of the rail carries a normal force per length that grows with the penetration there, along the normal of the wheel; the force of a
//! contact is the sum over its width. So a contact is as wide as the profiles make it, two contacts that
//! grow together become one, and nothing jumps: the normal forces have a potential. J. Piotrowski, H. Chollet, "Wheel–rail contact
//! models for vehicle system dynamics including multi-point contact", Vehicle Syst. Dyn. 43 (2005), call such a method one of virtual
//! penetration; here its stiffness is that of the solids.
//!
//! What the loads move beside their strips stands in [`super::relief`].
//!
//! Friction acts on every strip: a tangential spring that Coulomb's law limits by the normal force there. The strips at the edges of a contact
//! slide first. With strips whose forces are spread as a parabola the tangential force is C. Cattaneo's and R.D. Mindlin's,
//! `1 - (1 - u/u₁)^(3/2)` of the limit at a displacement `u`, where everything slides from `u₁` on, and its loops when the force turns are theirs as well.

use super::overlap::{Facing, Overlap, Pose, Profiles, Turned};
use super::relief::{Influence, Relief, StripLoad};
use nalgebra::{Matrix3, Point2, Vector2, Vector3};

/// Penetration at which a strip has half of its hardening, m: about that of a contact under a usual load.
const HARDENING_DEPTH: f64 = 40e-6;

/// Distance of the places of the rail at which the strips' friction is kept, m.
const KEPT_EVERY: f64 = 0.25e-3;

/// Times that contacts are relieved of what their own loads make, and by how much the last time at most, m.
const MOST_SETTLINGS: usize = 30;
const RELIEVED: f64 = 1e-12;

/// A strip's stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripModulus {
    /// Force per length and penetration, Pa, where the penetration is small.
    pub normal: f64,
    /// Share by which that grows where the penetration is large.
    pub hardening: f64,
    /// Force per length and tangential displacement, Pa.
    pub tangential: f64,
    /// Weight with which what a contact's loads take off the penetrations does so here, and with which the strip's own force counts there.
    pub relief: f64,
}

impl StripModulus {
    /// That which lies a share of the way to another.
    pub(super) fn towards(&self, other: &Self, share: f64) -> Self {
        let between = |a: f64, b: f64| a + share * (b - a);
        Self {
            normal: between(self.normal, other.normal),
            hardening: between(self.hardening, other.hardening),
            tangential: between(self.tangential, other.tangential),
            relief: between(self.relief, other.relief),
        }
    }

    /// Normal force per length (N/m) at a penetration (m), and its derivative by that (Pa).
    fn force(&self, depth: f64) -> (f64, f64) {
        // c·p·(1 + h·p/(p + d))
        let share = depth / (depth + HARDENING_DEPTH);
        let grown = self.normal * (1.0 + self.hardening * share);
        (grown * depth, grown + self.normal * self.hardening * share * (1.0 - share))
    }

    /// Potential per length at a penetration, N.
    fn energy(&self, depth: f64) -> f64 {
        const D: f64 = HARDENING_DEPTH;
        let half = 0.5 * depth * depth;
        self.normal * (half + self.hardening * (half - D * (depth - D * (depth / D).ln_1p())))
    }
}

/// Stiffness of strips by their place on the rail.
pub trait StripLaw {
    /// The strip at an arc length (m) of the rail.
    fn modulus(&self, rail_s: f64) -> StripModulus;

    /// What its loads take off the penetrations; nothing.
    fn influence(&self) -> Influence {
        Influence::default()
    }
}

/// A contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Arc lengths on the rail between which the bodies overlap, m.
    pub extent: [f64; 2],
    /// Normal forces on the wheel (y, z; N) and their moment about the wheel's reference point where that is now, N·m.
    pub force: Vector3<f64>,
    /// Potential of them, J.
    pub energy: f64,
    /// Their stiffness against motions of the wheel, as `force`.
    pub stiffness: Matrix3<f64>,
    /// Normal force, N, and its stiffness against a motion along itself, N/m.
    pub normal_force: f64,
    /// See `normal_force`.
    pub normal_stiffness: f64,
    /// Friction forces on the wheel, as `force`.
    pub friction: Vector3<f64>,
    /// Minus their derivative by the motion of the wheel.
    pub friction_stiffness: Matrix3<f64>,
    /// The same with everything sticking.
    pub sticking: Matrix3<f64>,
    /// Stiffness of all strips along their tangents, N/m.
    pub tangential_stiffness: f64,
    /// Elastic energy of friction, J.
    pub stored: f64,
    /// Whether a strip sticks.
    pub sticks: bool,
    /// Where the normal force acts: world (y, z), m.
    pub point: Point2<f64>,
    /// Arc length of that on the rail, m, and on the wheel.
    pub rail_s: f64,
    /// See `rail_s`.
    pub wheel_s: f64,
    /// Numbers of what its forces change by with the relief.
    gradients: [usize; 2],
}

/// All contacts together, with the relief that their forces make.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Relieved {
    /// Forces on the wheel, friction included.
    pub force: Vector3<f64>,
    /// Minus their derivative by the motion of the wheel.
    pub stiffness: Matrix3<f64>,
    /// The same with everything sticking.
    pub sticking: Matrix3<f64>,
    /// What that relief differs by from the one under which the contacts were found, m.
    pub off: f64,
    /// Potential of the relief, J.
    pub energy: f64,
}

/// Tangential displacements that the strips have taken up, along the rail.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deflections {
    /// At places that are equally far apart, m.
    values: Vec<f64>,
    /// Places per metre.
    density: f64,
    /// Between these places there are any.
    used: [usize; 2],
}

impl Deflections {
    /// None, on a rail profile of a length (m).
    pub fn none(length: f64) -> Self {
        let count = (length / KEPT_EVERY).ceil().max(1.0);
        Self { values: vec![0.0; count as usize + 1], density: count / length, used: [0; 2] }
    }

    /// At an arc length of the rail, m.
    fn at(&self, rail_s: f64) -> f64 {
        let at = (rail_s * self.density).max(0.0);
        let i = at as usize;
        match (self.values.get(i), self.values.get(i + 1)) {
            (Some(a), Some(b)) => a + (at - i as f64) * (b - a),
            _ => 0.0,
        }
    }
}

/// Friction between two poses.
#[derive(Debug, Clone, Copy)]
pub struct Friction<'a> {
    /// Coefficient of Coulomb's law.
    pub coefficient: f64,
    /// What the strips had taken up before.
    pub before: &'a Deflections,
    /// Motion of the wheel against the rail since then, about the wheel's reference point where that is now.
    pub moved: Vector3<f64>,
}

/// A strip under its penetration.
struct Strip {
    modulus: StripModulus,
    /// Penetration, m.
    depth: f64,
    /// Normal force per length along the penetration, N/m, and its derivative by that, Pa.
    normal: f64,
    normal_stiffness: f64,
    /// Changes of the penetration and of the tangential displacement with the motion of the wheel, in the wheel's frame.
    deeper: Vector3<f64>,
    aside: Vector3<f64>,
    /// Tangential displacement taken up, m, and the largest that there can be.
    deflection: f64,
    limit: f64,
}

impl Strip {
    fn new(here: &Facing, s: f64, law: &impl StripLaw, friction: Option<&Friction>, turned: &Turned) -> Self {
        let modulus = law.modulus(s);
        let depth = here.penetration.max(0.0);
        let (normal, normal_stiffness) = modulus.force(depth);
        let arm = here.point.coords;
        let with = |d: Vector2<f64>| Vector3::new(d.x, d.y, arm.perp(&d));
        // a quarter of a turn from the normal on the wheel, which is against its outward one
        let aside = with(Vector2::new(here.outward.y, -here.outward.x));
        let (mut deflection, mut limit) = (0.0, 0.0);
        if let Some(Friction { coefficient, before, moved }) = friction {
            let way = turned.wheel.inverse() * moved.xy();
            limit = coefficient * normal / (here.cosine * modulus.tangential);
            let wanted = before.at(s) + aside.dot(&Vector3::new(way.x, way.y, moved.z));
            deflection = wanted.clamp(-limit, limit);
        }
        let deeper = with(here.outward / here.cosine);
        Self { modulus, depth, normal, normal_stiffness, deeper, aside, deflection, limit }
    }

    fn sticks(&self) -> bool {
        self.deflection.abs() < self.limit
    }
}

impl Profiles<'_> {
    /// With strips whose loads relieve others, if those of `law` do.
    pub fn of_strips(self, law: &impl StripLaw) -> Self {
        self.relieved(law.influence(), |s| law.modulus(s).relief)
    }

    /// The contacts at a pose under a relief, in the order of the rail's profile; without friction if there is none.
    pub fn contacts(
        &mut self,
        pose: &Pose,
        law: &impl StripLaw,
        relief: &Relief,
        friction: Option<&Friction>,
        contacts: &mut Vec<Contact>,
    ) {
        let (place, count) = self.at(pose, relief);
        contacts.clear();
        if let Some(places) = &self.places {
            self.loading.clear(places);
        }
        for number in 0..count {
            if let Some(overlap) = self.overlap(&place, number) {
                contacts.push(self.contact(&place, pose, &overlap, law, friction));
            }
        }
    }

    /// The contacts at a pose without friction, relieved of what their own loads make.
    pub(super) fn settled(
        &mut self,
        pose: &Pose,
        law: &impl StripLaw,
        contacts: &mut Vec<Contact>,
    ) -> Relieved {
        self.settle(pose, law, &mut Relief::default(), None, (MOST_SETTLINGS, RELIEVED), contacts)
    }

    /// The contacts at a pose and the `relief` that their own loads make, from a first one on: so often, or until it changes by less (m).
    pub fn settle(
        &mut self,
        pose: &Pose,
        law: &impl StripLaw,
        relief: &mut Relief,
        friction: Option<&Friction>,
        (times, least): (usize, f64),
        contacts: &mut Vec<Contact>,
    ) -> Relieved {
        let mut time = 1;
        loop {
            self.contacts(pose, law, relief, friction, contacts);
            contacts.retain(|contact| contact.normal_force > 0.0);
            let relieved = self.relieve(contacts, relief);
            // under more than their loads would make there may be none where there are some
            let lost = contacts.is_empty() && relieved.off > 0.0;
            if relieved.off < least && !lost || time >= times {
                return relieved;
            }
            time += 1;
        }
    }

    /// Contacts that have just been found, under the relief that their own forces make to first order: by Newton's method, so that a pose and its relief settle
    /// together.
    fn relieve(&mut self, contacts: &mut [Contact], relief: &mut Relief) -> Relieved {
        let mut all = Relieved::default();
        let Self { places, loading, relief: under, .. } = self;
        if let Some(places) = places {
            all.energy = loading.relieve(places, under, relief);
            all.off = loading.off();
            for contact in contacts.iter_mut() {
                for (gradient, more) in loading.changes(contact.gradients) {
                    contact.force += gradient.normal * more;
                    contact.friction += gradient.friction * more;
                }
                contact.normal_force = contact.force.xy().norm();
            }
            let [normal, friction] = loading.softer();
            all.stiffness -= normal + friction;
            all.sticking -= normal;
        }
        for contact in contacts.iter() {
            all.force += contact.force + contact.friction;
            all.stiffness += contact.stiffness + contact.friction_stiffness;
            all.sticking += contact.stiffness + contact.sticking;
        }
        all
    }

    /// What the strips have taken up where the contacts have been found last, with the friction of [`Profiles::contacts`].
    pub fn taken_up(
        &mut self,
        law: &impl StripLaw,
        relief: &Relief,
        friction: &Friction,
        now: &mut Deflections,
    ) {
        let [first, last] = now.used;
        now.values[first..last].fill(0.0);
        now.used = [0; 2];
        let Some((place, count)) = self.again(relief) else { return };
        for overlap in (0..count).filter_map(|number| self.overlap(&place, number)) {
            let [from, to] = overlap.extent.map(|s| s.max(0.0) * now.density);
            let inside =
                (from.ceil() as usize).min(now.values.len())..(to.ceil() as usize).min(now.values.len());
            if inside.is_empty() {
                continue;
            }
            now.used = if now.used[1] == 0 { [inside.start, inside.end] } else { [now.used[0], inside.end] };
            for i in inside {
                let s = i as f64 / now.density;
                if let Some(here) = self.over(&place, &overlap, s) {
                    now.values[i] = Strip::new(&here, s, law, Some(friction), &place).deflection;
                }
            }
        }
    }

    fn contact(
        &mut self,
        place: &Turned,
        pose: &Pose,
        overlap: &Overlap,
        law: &impl StripLaw,
        friction: Option<&Friction>,
    ) -> Contact {
        let mut contact = Contact {
            extent: overlap.extent,
            force: Vector3::zeros(),
            energy: 0.0,
            stiffness: Matrix3::zeros(),
            normal_force: 0.0,
            normal_stiffness: 0.0,
            friction: Vector3::zeros(),
            friction_stiffness: Matrix3::zeros(),
            sticking: Matrix3::zeros(),
            tangential_stiffness: 0.0,
            stored: 0.0,
            sticks: false,
            point: Point2::origin(),
            rail_s: 0.0,
            wheel_s: 0.0,
            gradients: [0; 2],
        };
        self.loading.next_contact();
        let (mut sum, mut middle) = (0.0, Vector2::zeros());
        self.integrate(overlap, |profiles, s, width| {
            let Some(here) = profiles.over(place, overlap, s) else { return };
            if here.penetration <= 0.0 {
                return;
            }
            let strip = Strip::new(&here, s, law, friction, place);
            let q = strip.normal * width;
            contact.force -= strip.deeper * q;
            let stiffness = strip.deeper * (strip.normal_stiffness * width);
            contact.stiffness += stiffness * strip.deeper.transpose();
            let mut slides = Vector3::zeros();
            contact.energy += strip.modulus.energy(strip.depth) * width;
            let spring = strip.modulus.tangential * width;
            let aside = strip.aside * spring;
            let across = aside * strip.aside.transpose();
            contact.sticking += across;
            contact.tangential_stiffness += spring;
            if friction.is_some() {
                contact.friction -= aside * strip.deflection;
                contact.stored += 0.5 * spring * strip.deflection * strip.deflection;
                if strip.sticks() {
                    contact.friction_stiffness += across;
                    contact.sticks = true;
                } else if strip.normal > 0.0 {
                    // the limit goes with the normal force
                    let share = strip.deflection / strip.normal * strip.modulus.tangential;
                    contact.friction_stiffness += strip.aside * stiffness.transpose() * share;
                    slides = strip.aside * (strip.normal_stiffness * width * share);
                }
            }
            if let Some(places) = &profiles.places {
                let weight = here.weight;
                let load = StripLoad {
                    load: q * weight,
                    stiffness: strip.normal_stiffness * width * weight * weight,
                    normal: stiffness * weight,
                    friction: slides * weight,
                };
                profiles.loading.add(places, s, &load);
            }
            sum += q;
            contact.rail_s += q * s;
            contact.wheel_s += q * here.wheel_s;
            middle += here.point.coords * q;
        });
        let over = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        // from the wheel's frame to the world
        let turn = place.wheel;
        let whole = turn.matrix().fixed_resize::<3, 3>(0.0) + Matrix3::from_diagonal(&Vector3::z());
        for force in [&mut contact.force, &mut contact.friction] {
            *force = whole * *force;
        }
        contact.gradients = self.loading.of_contact();
        for gradient in self.loading.gradients(contact.gradients) {
            for force in [&mut gradient.normal, &mut gradient.friction] {
                *force = whole * *force;
            }
        }
        for stiffness in [&mut contact.stiffness, &mut contact.friction_stiffness, &mut contact.sticking] {
            *stiffness = whole * *stiffness * whole.transpose();
        }
        contact.normal_force = contact.force.xy().norm();
        let along = contact.normal();
        let along = Vector3::new(along.x, along.y, 0.0);
        contact.normal_stiffness = along.dot(&(contact.stiffness * along));
        contact.point = self.wheel_origin() + pose.wheel.xy() + turn * (middle * over);
        contact.rail_s *= over;
        contact.wheel_s *= over;
        contact
    }
}

impl Contact {
    /// Direction of the normal force on the wheel, world (y, z).
    fn normal(&self) -> Vector2<f64> {
        if self.normal_force > 0.0 { self.force.xy() / self.normal_force } else { Vector2::zeros() }
    }

    /// Friction force on the wheel a quarter of a turn from the normal one, N.
    pub fn tangential_force(&self) -> f64 {
        let normal = self.normal();
        self.friction.xy().dot(&Vector2::new(-normal.y, normal.x))
    }
}

#[cfg(test)]
pub(super) mod tests;
