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
//! Friction acts on every strip: a tangential spring that Coulomb's law limits by the normal force there ([`friction`]). The strips at the edges of a contact
//! slide first. With strips whose forces are spread as a parabola the tangential force is C. Cattaneo's and R.D. Mindlin's,
//! `1 - (1 - u/u₁)^(3/2)` of the limit at a displacement `u`, where everything slides from `u₁` on, and its loops when the force turns are theirs as well.
//!
//! Where the strips are is found at one pose; at poses near it they are the same strips, pressed otherwise ([`near`]).

mod friction;
mod near;

use self::friction::TakenUp;
use super::modulus::{StripLaw, StripModulus};
use super::overlap::{Facing, Pose, Profiles, Turned};
use super::relief::{Bells, Loading, Relief};
use nalgebra::{Matrix3, Point2, Vector2, Vector3};
use std::ops::Range;

/// Times that contacts are relieved of what their own loads make, and by how much the last time at most, m.
const MOST_SETTLINGS: usize = 30;
const RELIEVED: f64 = 1e-12;

/// A relief that is off by more than this, m, is settled first, before a pose goes after its forces, in so many rounds at most.
const FAR_OFF: f64 = 5e-6;
const SETTLINGS: usize = 12;

/// A penetration at the end of a contact that is larger, m, ends with the profile.
const CLOSED: f64 = 1e-8;

/// A contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Contact {
    /// Arc lengths on the rail between which the bodies overlap where the strips were found, m.
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
    /// Stiffness of all strips along their tangents, N/m, and of those that slide.
    pub tangential_stiffness: f64,
    /// See `tangential_stiffness`.
    pub sliding_stiffness: f64,
    /// Elastic energy of friction, J.
    pub stored: f64,
    /// Whether a strip sticks, and the share of the normal force on strips that slide.
    pub sticks: bool,
    /// See `sticks`.
    pub sliding_share: f64,
    /// Where the normal force acts: world (y, z), m.
    pub point: Point2<f64>,
    /// Arc length of that on the rail, m, and on the wheel.
    pub rail_s: f64,
    /// See `rail_s`.
    pub wheel_s: f64,
}

/// All contacts together, with the relief that their forces make.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Relieved {
    /// Forces on the wheel, friction included.
    pub force: Vector3<f64>,
    /// Minus their derivative by the motion of the wheel.
    pub stiffness: Matrix3<f64>,
    /// What that relief differs by from the one with which the forces were summed, m.
    pub off: f64,
    /// Potential of the relief, J.
    pub energy: f64,
    /// So far the wheel can move against the rail, m, before there may be another contact, or one may part.
    pub gap: f64,
}

/// A strip where it was found, in the wheel's frame.
#[derive(Debug, Clone, Copy)]
struct Strip {
    modulus: StripModulus,
    /// Arc length on the rail and on the wheel, and width, m.
    rail_s: f64,
    wheel_s: f64,
    width: f64,
    /// Cosine of the angle between the profiles.
    cosine: f64,
    /// Tangential displacement under a tangential force per length equal to the normal one, over that along the penetration, m²/N.
    give: f64,
    /// Penetration, m, the normal force per length along it there, N/m, its derivative by that, Pa, and the potential per length, N.
    depth: f64,
    normal: f64,
    stiffness: f64,
    energy: f64,
    /// Where it is, m.
    point: Vector2<f64>,
    /// Changes of the penetration, of the arc length on the wheel opposite (with a minus: the way that the wheel slides) and of the tangential displacement with the motion of the wheel.
    deeper: Vector3<f64>,
    slide: Vector3<f64>,
    aside: Vector3<f64>,
    /// Change of `deeper` along the wheel, 1/m.
    turn: Vector3<f64>,
    /// Weight of a relief and of the loads that make it, and where these count.
    weight: f64,
    bells: Bells,
    /// Tangential displacement that friction has taken up: at the last step's end, and where the strip was looked at last, m.
    before: f64,
    now: f64,
    /// Whether it slides there.
    slides: bool,
}

/// The end of a contact.
#[derive(Debug, Clone, Copy)]
struct End {
    strip: Strip,
    /// Size of the slope of the penetration, which is zero there.
    slope: f64,
    /// The strip nearest to it.
    nearest: usize,
}

/// The strips of a contact.
#[derive(Debug, Clone)]
struct Patch {
    extent: [f64; 2],
    strips: Range<usize>,
    ends: Range<usize>,
    /// The numbers of what its forces change by with the relief.
    gradients: [usize; 2],
    /// Its deepest strip, and the penetration there, m.
    deepest: usize,
    depth: f64,
}

/// A strip under a motion of the wheel since it was found.
struct Pressed {
    depth: f64,
    deeper: Vector3<f64>,
    /// Normal force per length along the penetration, N/m, and its derivative by that, Pa.
    normal: f64,
    stiffness: f64,
}

/// Two profiles with the strips between them.
#[derive(Debug, Clone)]
pub struct ContactStrips<'a> {
    profiles: Profiles<'a>,
    loading: Loading,
    /// The relief that the loads made where the contacts were looked at last.
    made: Relief,
    strips: Vec<Strip>,
    ends: Vec<End>,
    patches: Vec<Patch>,
    /// Where they were found, with the rail in the wheel's frame there.
    found: Option<(Pose, Turned)>,
    /// Where they were looked at last, and the motion of the wheel against the rail from the one to the other, in the wheel's frame.
    looked: Pose,
    motion: Vector3<f64>,
    /// Whether the next look finds them anew.
    anew: bool,
    taken_up: TakenUp,
}

impl Strip {
    fn new(profiles: &Profiles, here: &Facing, [s, width]: [f64; 2], law: &impl StripLaw) -> Self {
        let arm = here.point.coords;
        let with = |d: Vector2<f64>| Vector3::new(d.x, d.y, arm.perp(&d));
        let modulus = law.modulus(s);
        let (normal, stiffness) = modulus.force(here.penetration);
        Self {
            modulus,
            rail_s: s,
            wheel_s: here.wheel_s,
            width,
            cosine: here.cosine,
            give: 1.0 / (here.cosine * modulus.tangential),
            depth: here.penetration,
            normal,
            stiffness,
            energy: modulus.energy(here.penetration),
            point: arm,
            deeper: with(here.outward / here.cosine),
            slide: with(-here.along / here.cosine),
            // a quarter of a turn from the normal on the wheel, which is against its outward one
            aside: with(Vector2::new(here.outward.y, -here.outward.x)),
            turn: with(Vector2::new(-here.bend.y, here.bend.x) / here.cosine),
            weight: here.weight,
            bells: profiles.places.as_ref().map_or_else(Bells::default, |places| places.bells(s)),
            before: 0.0,
            now: 0.0,
            slides: false,
        }
    }

    /// After a motion of the wheel, with what the relief has `changed` by there, m.
    fn pressed(&self, motion: &Vector3<f64>, changed: f64) -> Pressed {
        let slides = self.slide.dot(motion);
        let depth =
            self.depth + (self.deeper + self.turn * (0.5 * slides)).dot(motion) - self.weight * changed;
        let (normal, stiffness) = self.modulus.force(depth);
        Pressed { depth, deeper: self.deeper + self.turn * slides, normal, stiffness }
    }

    /// The largest tangential displacement that friction can take up, m, under a normal force per length.
    fn limit(&self, coefficient: f64, normal: f64) -> f64 {
        if coefficient > 0.0 { coefficient * normal * self.give } else { 0.0 }
    }

    /// Potential per length, N: the work from where it was found by the trapezoid of the force, corrected by its derivatives.
    fn energy(&self, pressed: &Pressed) -> f64 {
        let deeper = pressed.depth - self.depth;
        let mean =
            0.5 * (self.normal + pressed.normal) - deeper / 12.0 * (pressed.stiffness - self.stiffness);
        self.energy + deeper * mean
    }
}

impl<'a> ContactStrips<'a> {
    /// Strips of a law between two profiles.
    pub fn new(profiles: Profiles<'a>, law: &impl StripLaw) -> Self {
        let profiles = profiles.relieved(law.influence(), |s| law.modulus(s).relief);
        Self {
            taken_up: TakenUp::nothing(profiles.rail_length()),
            profiles,
            loading: Loading::default(),
            made: Relief::default(),
            strips: Vec::new(),
            ends: Vec::new(),
            patches: Vec::new(),
            found: None,
            looked: Pose::default(),
            motion: Vector3::zeros(),
            anew: false,
        }
    }

    /// Length of the rail's profile, m.
    pub fn rail_length(&self) -> f64 {
        self.profiles.rail_length()
    }

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
    pub(super) fn settled(
        &mut self,
        pose: &Pose,
        law: &impl StripLaw,
        contacts: &mut Vec<Contact>,
    ) -> Relieved {
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

    /// Motion of the wheel against the rail from where the strips were found to a pose, in the wheel's frame.
    fn motion_to(&self, pose: &Pose) -> Vector3<f64> {
        let Some((found, place)) = &self.found else { return Vector3::zeros() };
        let moved = self.profiles.motion_between(found, pose);
        let way = place.wheel.inverse() * moved.xy();
        Vector3::new(way.x, way.y, moved.z)
    }

    /// Finds the strips at a pose.
    fn find(&mut self, pose: &Pose, law: &impl StripLaw, coefficient: f64) {
        let Self { profiles, strips, ends, patches, .. } = self;
        let (place, count) = profiles.at(pose, &self.made);
        strips.clear();
        ends.clear();
        patches.clear();
        for number in 0..count {
            let Some(overlap) = profiles.overlap(&place, number) else { continue };
            let (first, first_end) = (strips.len(), ends.len());
            profiles.integrate(&overlap, |profiles, s, width| {
                let here = profiles.over(&place, &overlap, s).filter(|here| here.penetration > 0.0);
                strips.extend(here.map(|here| Strip::new(profiles, &here, [s, width], law)));
            });
            let all = first..strips.len();
            let Some(deepest) = all.clone().max_by(|a, b| strips[*a].depth.total_cmp(&strips[*b].depth))
            else {
                continue;
            };
            for s in overlap.extent {
                let Some(here) = profiles.over(&place, &overlap, s) else { continue };
                if here.penetration.abs() > CLOSED || here.slope == 0.0 {
                    continue;
                }
                let strip = Strip::new(profiles, &here, [s, 0.0], law);
                let apart = |i: &usize| (strips[*i].rail_s - s).abs();
                let nearest = all.clone().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or(first);
                ends.push(End { strip: Strip { depth: 0.0, ..strip }, slope: here.slope.abs(), nearest });
            }
            let (depth, ends) = (strips[deepest].depth, first_end..ends.len());
            let (extent, gradients) = (overlap.extent, [0; 2]);
            patches.push(Patch { extent, strips: all, ends, gradients, deepest, depth });
        }
        self.found = Some((*pose, place));
        (self.looked, self.motion) = (*pose, Vector3::zeros());
        if coefficient > 0.0 {
            for strip in &mut self.strips {
                strip.before = self.taken_up.at(strip.rail_s);
            }
        }
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
