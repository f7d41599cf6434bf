//! The condensed contact element of a pair, and its head.

use nalgebra::Matrix3;

use crate::held_end::HeldEnd;
use crate::law::StripStiffness;
use crate::wheel::{ElasticWheel, positive};

/// The condensed contact element of a pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PairElement {
    /// The wheel; its rim's reference point is the origin of its profile.
    pub wheel: ElasticWheel,
    /// Flexibility of the rail's head against its section, about the node line: displacements y and z (m) and rotation about x (rad)
    /// under forces (N) and a torque (N·m).
    pub head: Matrix3<f64>,
    /// What becomes of it near a held end; none of a rail that is known in its middle alone.
    pub held_end: Option<HeldEnd>,
    /// The contact.
    pub strips: StripStiffness,
    /// What of the motions of rim and head a section does not have, relative.
    pub misfit: [f64; 2],
}

/// The head of a condensed element.
#[derive(Debug, Clone, Copy)]
pub struct HeadOfElement<'a> {
    /// Flexibility against its section, as [`PairElement::head`].
    pub on_section: Matrix3<f64>,
    /// What becomes of it near a held end.
    pub held_end: Option<&'a HeldEnd>,
}

impl HeadOfElement<'_> {
    /// Flexibility on its rail far from its ends, as it was found.
    pub fn on_rail(&self) -> Matrix3<f64> {
        let of_rail = self.held_end.and_then(|end| end.places.last());
        of_rail.map_or(self.on_section, |place| place.flexibility)
    }
}

impl PairElement {
    /// Flexibility of the head on its rail far from its ends, as [`Self::head`].
    pub fn head_on_rail(&self) -> Matrix3<f64> {
        positive(HeadOfElement { on_section: self.head, held_end: self.held_end.as_ref() }.on_rail())
    }
}
