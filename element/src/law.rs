//! The stiffness of a contact's strips along the rail.

use crate::modulus::{StripLaw, StripModulus};
use crate::relief::Influence;

/// What is known of the contact at one place of the rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripPlace {
    /// Arc length on the rail, m.
    pub rail_s: f64,
    /// A strip there.
    pub modulus: StripModulus,
}

/// Stiffness of strips by their place: in proportion between places that are equally far apart, constant beyond them.
#[derive(Debug, Clone, PartialEq)]
pub struct StripStiffness {
    places: Vec<StripPlace>,
    /// Places per metre.
    density: f64,
    /// What their loads take off the penetrations.
    pub influence: Influence,
    /// Largest deviation of a force from that of the solids at the same approach, relative, over all places and loads.
    pub misfit: f64,
}

impl StripStiffness {
    /// From places by ascending arc length, one at least.
    pub fn new(places: Vec<StripPlace>, influence: Influence, misfit: f64) -> Self {
        let apart = match (places.first(), places.last()) {
            (Some(first), Some(last)) => last.rail_s - first.rail_s,
            _ => 0.0,
        };
        let density = if apart > 0.0 { (places.len() - 1) as f64 / apart } else { 0.0 };
        Self { places, density, influence, misfit }
    }

    /// The places, by ascending arc length.
    pub fn places(&self) -> &[StripPlace] {
        &self.places
    }
}

impl StripLaw for StripStiffness {
    fn modulus(&self, rail_s: f64) -> StripModulus {
        let at = ((rail_s - self.places[0].rail_s) * self.density).max(0.0);
        let i = at as usize;
        match (self.places.get(i), self.places.get(i + 1)) {
            (Some(a), Some(b)) => a.modulus.towards(&b.modulus, at - i as f64),
            _ => self.places[self.places.len() - 1].modulus,
        }
    }

    fn influence(&self) -> Influence {
        self.influence
    }
}
