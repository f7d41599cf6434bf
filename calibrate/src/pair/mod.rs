//! From two profiles to their springs: a wheel and a rail in a track, meshed, condensed, pressed and fitted.
//!
//! * [`Pair`]: the two sections in place, and where they first touch; it meshes them;
//! * [`PairSolids`]: the bodies of a pair as solids, each condensed by itself;
//! * [`CondensedPair`]: the bodies reduced to their contact nodes, which are pressed together;
//! * [`PressedPair`]: the states under the loads, to which the laws are fitted;
//! * [`SeriesBeam`]: the rail beam that stands in series with the law.

mod geometry;
mod solids;
mod bodies;
mod series_beam;

pub use bodies::{CondensedPair, ContactConditions, PressedPair, condense_all};
pub use geometry::{Pair, PairMeshes};
pub use series_beam::SeriesBeam;
pub use solids::{PairBody, PairSolids};
