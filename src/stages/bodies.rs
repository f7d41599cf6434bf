//! The bodies of a study.

use railspring_calibrate::pair::{PairBody, PairSolids};

use super::{Geometry, Meshes, formulation};
use crate::study::{ReferenceKey, Study};

/// The solids of a study on its meshes.
pub fn solids<'a>(study: &Study, geometry: &'a Geometry, meshes: &'a Meshes) -> PairSolids<'a> {
    let (pair, material, element) = (&geometry.pair, study.material, formulation(study));
    let Meshes { rail, wheel, orders, .. } = meshes;
    PairSolids { pair, rail, wheel, material, element, orders }
}

/// The rail whose compliance the study's reference takes.
pub fn rail_in_use(study: &Study) -> PairBody {
    match study.calibration.reference {
        ReferenceKey::Beam | ReferenceKey::Local => PairBody::RailOnEnds,
        ReferenceKey::Foot => PairBody::RailOnFoot,
    }
}
