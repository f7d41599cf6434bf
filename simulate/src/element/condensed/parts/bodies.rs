//! Makes elements of a pair of condensed bodies and laws by contact angle.

use nalgebra::{Matrix3, Point2};
use railspring_calibrate::contact::{HalfSpace, Side};
use railspring_calibrate::pair::{CondensedPair, Pair};
use railspring_profiles::error::{InputError, Result};

use super::fit::{Sections, StripForm, fit_strips};
use super::held_end::held_end;
use super::lumped::{LumpedElement, LumpedSet};
use super::places::PlaceApproaches;
use super::sections::{RunningSurface, SectionFlexibility};
use super::wheel::elastic_wheel;
use railspring_element::held_end::HeldEnd;
use railspring_element::pair_element::{HeadOfElement, PairElement};
use railspring_element::wheel::ElasticWheel;

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
        let wheel = elastic_wheel(&on_wheel, modes, &rim, origin)?;
        let held_end = held_end(pair, bodies, &head, length)?;
        let modulus = rail.surface.contact_modulus(&bodies.wheel.surface);
        Ok(Self { pair, modulus, wheel, rim, head, held_end })
    }

    /// Changes the flexibility of the head by `more` in the middle of the rail, and near a held end in proportion to how far the head moves there across the track.
    pub(in crate::element::condensed) fn change_head(&mut self, more: &Matrix3<f64>) {
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

    /// Hub, oscillators and bushing of the lumped element.
    pub fn lumped_set(&self) -> LumpedSet {
        let arm = Point2::from(self.pair.tape()) - self.pair.node_line();
        let of_head = HeadOfElement { on_section: self.head.flexibility, held_end: Some(&self.held_end) };
        LumpedSet::new(&self.wheel, &of_head, arm)
    }

    /// The lumped element with laws by contact angle.
    ///
    /// # Errors
    /// [`InputError`] for laws without a place.
    pub fn lumped(&self, laws: &[PlaceApproaches]) -> Result<LumpedElement> {
        let Self { pair, modulus, rim, head, .. } = self;
        let set = self.lumped_set();
        let misfit = [rim.misfit, head.misfit];
        let of_rim = SectionFlexibility { flexibility: set.wheel().rim_flexibility(), misfit: rim.misfit };
        let of_head = SectionFlexibility { flexibility: set.on_section.flexibility(), misfit: head.misfit };
        let sections = Sections { rim: &of_rim, head: &of_head };
        let strips = fit_strips(pair, *modulus, laws, &sections, StripForm::Winkler)?;
        Ok(LumpedElement { set, strips, misfit })
    }
}
