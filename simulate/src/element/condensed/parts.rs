//! What the condensed contact element of a moving wheel knows of a pair of solids.

mod sections;
mod held_end;
mod wheel;
mod relief;
mod modulus;
mod overlap;
mod strips;
mod law;
mod hertz;
mod places;
mod fit;
mod lumped;

pub use fit::{Sections, StripForm, fit_strips};
pub use held_end::{EndPlace, HeldEnd, in_world};
pub use law::{StripPlace, StripStiffness};
pub use lumped::{Bushing, Hub, LumpedElement, LumpedSet, Oscillator};
pub use modulus::{StripLaw, StripModulus};
pub use overlap::{Pose, Profiles};
pub use places::{PlaceApproaches, PlaceLoad, StickingHub};
pub use relief::Influence;
pub use sections::{RunningSurface, SectionFlexibility};
pub use strips::{Contact, ContactStrips, Relieved};
pub use wheel::{ElasticWheel, RimMode, positive};

use nalgebra::{Matrix3, Point2};
use railspring_calibrate::contact::{HalfSpace, Side};
use railspring_calibrate::pair::{CondensedPair, Pair};
use railspring_profiles::error::{InputError, Result};

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

/// What the contact element of a pair has of its bodies, from which elements are made with one set of laws after another.
#[derive(Clone)]
pub struct ElementBodies<'a> {
    pair: &'a Pair,
    /// Contact modulus of both running surfaces, Pa.
    modulus: f64,
    wheel: ElasticWheel,
    rim: SectionFlexibility,
    head: SectionFlexibility,
    held_end: HeldEnd,
}

impl<'a> ElementBodies<'a> {
    /// Of a condensed pair, whose wheel has modes, for a rail of a `length` (m).
    ///
    /// # Errors
    /// [`InputError`] for a wheel without modes and for a grid of contact nodes with too few lines.
    pub fn new(pair: &'a Pair, bodies: &CondensedPair, length: f64) -> Result<Self> {
        let wheel = &bodies.wheel;
        let modes = wheel.modes.as_ref().ok_or_else(|| {
            InputError::new(
                "wheel",
                "no modes",
                "a wheel condensed with modes",
                "condense it with `condense_in_time`",
            )
        })?;
        let on_wheel = RunningSurface {
            compliance: &wheel.compliance,
            grid: &wheel.grid,
            nodes: &wheel.nodes,
            half_space: HalfSpace::new(&wheel.surface, Side::Opposing),
        };
        let rail = &bodies.rail_on_ends;
        let on_rail = RunningSurface {
            compliance: bodies.against_section(),
            grid: &rail.grid,
            nodes: &rail.nodes,
            half_space: HalfSpace::new(&rail.surface, Side::Base),
        };
        let origin = Point2::new(0.0, pair.wheel.radius);
        on_wheel.check("wheel")?;
        on_rail.check("rail")?;
        let (rim, head) = (on_wheel.section(origin), on_rail.section(pair.node_line()));
        let wheel = ElasticWheel::new(&on_wheel, modes, &rim, origin)?;
        let held_end = HeldEnd::new(pair, bodies, &head, length)?;
        let modulus = rail.surface.contact_modulus(&bodies.wheel.surface);
        Ok(Self { pair, modulus, wheel, rim, head, held_end })
    }

    /// Changes the flexibility of the head by `more` in the middle of the rail, and near a held end in proportion to how far the head moves there across the track.
    pub(super) fn change_head(&mut self, more: &Matrix3<f64>) {
        let middle = self.held_end.places.last().map_or(1.0, |place| place.flexibility[(0, 0)]);
        self.head.flexibility += more;
        for place in &mut self.held_end.places {
            place.flexibility += more * (place.flexibility[(0, 0)] / middle);
        }
    }

    /// The pair.
    pub fn pair(&self) -> &Pair {
        self.pair
    }

    /// The element with laws by contact angle.
    ///
    /// # Errors
    /// [`InputError`] for laws without a place.
    pub fn element(&self, laws: &[PlaceApproaches]) -> Result<PairElement> {
        let Self { pair, modulus, wheel, rim, head, held_end } = self;
        let strips = fit_strips(pair, *modulus, laws, &Sections { rim, head }, StripForm::Relieved)?;
        Ok(PairElement {
            wheel: wheel.clone(),
            held_end: Some(held_end.clone()),
            head: head.flexibility,
            strips,
            misfit: [rim.misfit, head.misfit],
        })
    }

    /// The lumped element with laws by contact angle.
    ///
    /// # Errors
    /// [`InputError`] for laws without a place.
    pub fn lumped(&self, laws: &[PlaceApproaches]) -> Result<LumpedElement> {
        let Self { pair, modulus, wheel, rim, head, held_end } = self;
        let arm = Point2::from(pair.tape()) - pair.node_line();
        let of_head = HeadOfElement { on_section: head.flexibility, held_end: Some(held_end) };
        let set = LumpedSet::new(wheel, &of_head, arm);
        let misfit = [rim.misfit, head.misfit];
        let of_rim = SectionFlexibility { flexibility: set.wheel().rim_flexibility(), misfit: rim.misfit };
        let of_head = SectionFlexibility { flexibility: set.on_section.flexibility(), misfit: head.misfit };
        let sections = Sections { rim: &of_rim, head: &of_head };
        let strips = fit_strips(pair, *modulus, laws, &sections, StripForm::Winkler)?;
        Ok(LumpedElement { set, strips, misfit })
    }
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
    fn on_rail(&self) -> Matrix3<f64> {
        let of_rail = self.held_end.and_then(|end| end.places.last());
        of_rail.map_or(self.on_section, |place| place.flexibility)
    }
}

impl PairElement {
    /// Flexibility of the head on its rail far from its ends, as [`Self::head`].
    pub fn head_on_rail(&self) -> Matrix3<f64> {
        let of_rail = self.held_end.as_ref().and_then(|end| end.places.last());
        of_rail.map_or(self.head, |place| positive(place.flexibility))
    }
}
