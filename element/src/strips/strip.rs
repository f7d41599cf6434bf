//! A strip between two profiles, where it was found and under a motion since.

use crate::modulus::{StripLaw, StripModulus};
use crate::overlap::{Facing, Profiles};
use crate::relief::Bells;
use nalgebra::{Vector2, Vector3};

/// A strip where it was found, in the wheel's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strip {
    pub modulus: StripModulus,
    /// Arc length on the rail and on the wheel, and width, m.
    pub rail_s: f64,
    pub wheel_s: f64,
    pub width: f64,
    /// Cosine of the angle between the profiles.
    pub cosine: f64,
    /// Tangential displacement under a tangential force per length equal to the normal one, over that along the penetration, m²/N.
    pub give: f64,
    /// Penetration, m, the normal force per length along it there, N/m, its derivative by that, Pa, and the potential per length, N.
    pub depth: f64,
    pub normal: f64,
    pub stiffness: f64,
    pub energy: f64,
    /// Where it is, m.
    pub point: Vector2<f64>,
    /// Changes of the penetration, of the arc length on the wheel opposite (with a minus: the way that the wheel slides) and of the tangential displacement with the motion of the wheel.
    pub deeper: Vector3<f64>,
    pub slide: Vector3<f64>,
    pub aside: Vector3<f64>,
    /// Change of `deeper` along the wheel, 1/m.
    pub turn: Vector3<f64>,
    /// Weight of a relief and of the loads that make it, and where these count.
    pub weight: f64,
    pub bells: Bells,
    /// Tangential displacement that friction has taken up: at the last step's end, and where the strip was looked at last, m.
    pub before: f64,
    pub now: f64,
    /// Whether it slides there.
    pub slides: bool,
}

/// The end of a contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub strip: Strip,
    /// Size of the slope of the penetration, which is zero there.
    pub slope: f64,
    /// The strip nearest to it.
    pub nearest: usize,
}

/// A strip under a motion of the wheel since it was found.
pub(super) struct Pressed {
    pub depth: f64,
    pub deeper: Vector3<f64>,
    /// Normal force per length along the penetration, N/m, and its derivative by that, Pa.
    pub normal: f64,
    pub stiffness: f64,
}

impl Strip {
    pub fn new(profiles: &Profiles, here: &Facing, [s, width]: [f64; 2], law: &impl StripLaw) -> Self {
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
    pub fn pressed(&self, motion: &Vector3<f64>, changed: f64) -> Pressed {
        let slides = self.slide.dot(motion);
        let depth =
            self.depth + (self.deeper + self.turn * (0.5 * slides)).dot(motion) - self.weight * changed;
        let (normal, stiffness) = self.modulus.force(depth);
        Pressed { depth, deeper: self.deeper + self.turn * slides, normal, stiffness }
    }

    /// The largest tangential displacement that friction can take up, m, under a normal force per length.
    pub fn limit(&self, coefficient: f64, normal: f64) -> f64 {
        if coefficient > 0.0 { coefficient * normal * self.give } else { 0.0 }
    }

    /// Potential per length, N: the work from where it was found by the trapezoid of the force, corrected by its derivatives.
    pub fn energy(&self, pressed: &Pressed) -> f64 {
        let deeper = pressed.depth - self.depth;
        let mean =
            0.5 * (self.normal + pressed.normal) - deeper / 12.0 * (pressed.stiffness - self.stiffness);
        self.energy + deeper * mean
    }
}
