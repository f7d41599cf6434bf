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
mod fit;

pub use fit::{PlaceApproaches, PlaceLoad, Sections, fit_strips};
pub use held_end::{EndPlace, HeldEnd, in_world};
pub use law::{StripPlace, StripStiffness};
pub use modulus::{StripLaw, StripModulus};
pub use overlap::{Pose, Profiles};
pub use relief::Influence;
pub use sections::{RunningSurface, SectionFlexibility};
pub use strips::{Contact, ContactStrips, Relieved};
pub use wheel::{ElasticWheel, RimMode, positive};

use crate::contact::{HalfSpace, Side};
use crate::error::{InputError, Result};
use crate::pair::{CondensedPair, Pair};
use nalgebra::{Matrix3, Point2};

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

impl PairElement {
    /// Frequency up to which the wheel moves in modes, Hz.
    pub const HIGHEST: f64 = 2000.0;

    /// The element of a condensed pair, whose wheel has modes, with its laws by contact angle, for a rail of a `length` (m).
    ///
    /// # Errors
    /// [`InputError`] for a wheel without modes, and for laws without a place.
    pub fn new(
        pair: &Pair,
        bodies: &CondensedPair,
        laws: &[PlaceApproaches],
        highest: f64,
        length: f64,
    ) -> Result<Self> {
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
            half_space: HalfSpace::new(&bodies.material, Side::Opposing),
        };
        let rail = &bodies.rail_on_ends;
        let on_rail = RunningSurface {
            compliance: bodies.against_section(),
            grid: &rail.grid,
            nodes: &rail.nodes,
            half_space: HalfSpace::new(&bodies.material, Side::Base),
        };
        let origin = Point2::new(0.0, pair.wheel.radius);
        on_wheel.check("wheel")?;
        on_rail.check("rail")?;
        let (rim, head) = (on_wheel.section(origin), on_rail.section(pair.node_line()));
        let strips = fit_strips(pair, &bodies.material, laws, &Sections { rim: &rim, head: &head })?;
        Ok(Self {
            wheel: ElasticWheel::new(&on_wheel, modes, &rim, origin, highest)?,
            held_end: Some(HeldEnd::new(pair, bodies, &head, length)?),
            head: head.flexibility,
            strips,
            misfit: [rim.misfit, head.misfit],
        })
    }
}
