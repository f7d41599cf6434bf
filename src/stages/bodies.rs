//! The bodies of a study, condensed, and their insides, which only fields need.

use railspring_calibrate::error::Result;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::pair::{CondensedPair, PairBody, PairSolids, condense_all};
use railspring_calibrate::superelement::{CondensedBody, Interior};

use super::{Geometry, Meshes, formulation};
use crate::study::{ReferenceKey, Study};

/// The condensed bodies of a study, with the insides of those that were condensed just now.
pub struct Bodies<'a> {
    /// The bodies.
    pub condensed: CondensedPair,
    /// Their insides.
    pub interiors: Interiors<'a>,
}

/// The insides of the bodies, factored again where a body was condensed before.
pub struct Interiors<'a> {
    solids: PairSolids<'a>,
    made: [Option<Interior<'a>>; 3],
}

/// The solids of a study on its meshes.
pub fn solids<'a>(study: &Study, geometry: &'a Geometry, meshes: &'a Meshes) -> PairSolids<'a> {
    let (pair, material, element) = (&geometry.pair, study.material, formulation(study));
    PairSolids { pair, rail: &meshes.rail, wheel: &meshes.wheel, material, element }
}

/// The rail whose compliance the study's reference takes.
pub fn rail_in_use(study: &Study) -> PairBody {
    match study.calibration.reference {
        ReferenceKey::Beam => PairBody::RailOnEnds,
        ReferenceKey::Foot | ReferenceKey::Local => PairBody::RailOnFoot,
    }
}

/// The bodies whose fields the calibration writes.
pub fn bodies_of_fields(study: &Study) -> [PairBody; 2] {
    [rail_in_use(study), PairBody::Wheel]
}

impl<'a> Bodies<'a> {
    /// The bodies as `get` has them: condensed before, or just now with their insides.
    ///
    /// # Errors
    /// Those of `get`, and an interruption.
    pub fn new(
        solids: PairSolids<'a>,
        get: impl Fn(PairBody) -> Result<(CondensedBody, Option<Interior<'a>>)> + Sync,
        monitor: &dyn Monitor,
    ) -> Result<Self> {
        let [(wheel, on_hub), (rail_on_foot, on_foot), (rail_on_ends, on_ends)] = condense_all(monitor, get)?;
        let condensed = CondensedPair::new(solids.material, [wheel, rail_on_foot, rail_on_ends])?;
        Ok(Self { condensed, interiors: Interiors { solids, made: [on_hub, on_foot, on_ends] } })
    }
}

impl<'a> Interiors<'a> {
    /// The insides of some bodies; those of the others are let go.
    ///
    /// # Errors
    /// None that bodies which were condensed can cause.
    pub fn of<const N: usize>(self, wanted: [PairBody; N]) -> Result<[Interior<'a>; N]> {
        let Self { solids, made } = self;
        let mut made = PairBody::ALL.into_iter().zip(made).collect::<Vec<_>>();
        made.retain(|(body, _)| wanted.contains(body));
        let mut found = Vec::with_capacity(N);
        for body in wanted {
            let interior =
                made.iter_mut().find(|(other, _)| *other == body).and_then(|(_, made)| made.take());
            found.push(interior.map_or_else(|| solids.interior(body), Ok)?);
        }
        Ok(found.try_into().unwrap_or_else(|_| unreachable!("one for each")))
    }
}
