//! From two profiles to their springs: a wheel and a rail in a track, meshed, condensed, pressed and fitted.
//!
//! * [`Pair`]: the two sections in place, and where they first touch; it meshes them;
//! * [`Pair::fit`]: all steps in one call, with [`FitOptions`] where those of a study do not serve;
//! * [`PairSolids`]: the bodies of a pair as solids, each condensed by itself;
//! * [`CondensedPair`]: the bodies reduced to their contact nodes, which are pressed together;
//! * [`ByReference`]: the laws against the section, of the approach alone and, where the rail was condensed on its foot, against that;
//! * [`PressedPair`]: the states under the loads, to which the laws are fitted;
//! * [`Pair::carry`]: measured surfaces on the bodies of others, [`wheel_between`]: a wheel of a diameter between those of two;
//! * [`law_by_shift`]: the same bodies with the wheel in other places across the track, pressed along the contact normal: the law
//!   by contact angle ([`AngleLaw`]);
//! * [`ErrorBand`]: how far the laws change with the grid and with the meshes, and
//!   [`horizontal_changes`] how far the horizontal stiffness does;
//! * [`SeriesBeam`]: the rail beam that stands in series with the law.

mod geometry;
mod references;
mod solids;
mod bodies;
mod springs;
mod belonging;
mod shared;
mod by_shift;
mod error_band;
mod horizontal_band;
mod series_beam;

pub use bodies::{
    CondensedPair, ContactBody, ContactConditions, Laws, PairStates, PressedPair, condense_all,
};
pub use by_shift::{
    AngleLaw, AngleSettings, FixedLoad, PressDirection, ShiftLaw, TouchPoint, law_by_shift, loads_in_turn,
};
pub use error_band::{
    BandPoint, COARSER, Change, Changed, Changes, ErrorBand, FIXED_LOADS_CHANGED, LOADS_COARSER,
    LOADS_HALVED, Solid, SolidPoints, changed_by_shift, error_bands, spread,
};
pub use geometry::{OffBodies, Pair, PairMeshes};
pub use horizontal_band::horizontal_changes;
pub use references::ByReference;
pub use series_beam::SeriesBeam;
pub use shared::{FARTHEST_SURFACE, wheel_between};
pub use solids::{Orders, PairBody, PairSolids};
pub use springs::{FitOptions, PairSprings};
