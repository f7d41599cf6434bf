//! The bodies of a study.

use std::sync::Arc;

use railspring_calibrate::pair::{CondensedPair, PairBody, PairSolids};
use railspring_calibrate::superelement::CondensedBody;

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::Meshes;
use crate::study::{ReferenceKey, Statics};

/// The solids of a study on its meshes.
pub fn solids<'a>(statics: Statics<'a>, geometry: &'a Geometry, meshes: &'a Meshes) -> PairSolids<'a> {
    let (pair, element) = (&geometry.pair, statics.element.formulation());
    let materials = [&statics.rail.materials, &statics.wheel.materials];
    let Meshes { rail, wheel, orders, .. } = meshes;
    PairSolids { pair, rail, wheel, materials, element, orders }
}

/// The rail whose compliance the study's reference takes.
pub fn rail_in_use(statics: Statics<'_>) -> PairBody {
    match statics.calibration.reference {
        ReferenceKey::Beam | ReferenceKey::Local => PairBody::RailOnEnds,
        ReferenceKey::Foot => PairBody::RailOnFoot,
    }
}

/// The rail between its ends and the wheel, with modes.
pub enum MovingBodies {
    /// Those of a calibration.
    OfCalibration(Arc<CondensedPair>),
    /// By themselves.
    Own(Box<[CondensedBody; 2]>),
}

impl MovingBodies {
    /// Rail and wheel.
    pub fn both(&self) -> [&CondensedBody; 2] {
        match self {
            Self::OfCalibration(pair) => [&pair.rail_on_ends, &pair.wheel],
            Self::Own(bodies) => bodies.each_ref(),
        }
    }
}
