//! The stiffness of a strip, and where it is from.

use crate::relief::Influence;

/// Penetration at which a strip has half of its hardening, m: about that of a contact under a usual load.
const HARDENING_DEPTH: f64 = 40e-6;

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

    /// Normal force per length (N/m) at a penetration (m), and its derivative by that (Pa); in proportion where the bodies are apart.
    pub(super) fn force(&self, depth: f64) -> (f64, f64) {
        // c·p·(1 + h·p/(p + d))
        let share = depth.max(0.0) / (depth.max(0.0) + HARDENING_DEPTH);
        let grown = self.normal * (1.0 + self.hardening * share);
        (grown * depth, grown + self.normal * self.hardening * share * (1.0 - share))
    }

    /// Potential per length at a penetration, N.
    pub(super) fn energy(&self, depth: f64) -> f64 {
        const D: f64 = HARDENING_DEPTH;
        let half = 0.5 * depth * depth;
        let depth = depth.max(0.0);
        self.normal * (half + self.hardening * (0.5 * depth * depth - D * (depth - D * (depth / D).ln_1p())))
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
