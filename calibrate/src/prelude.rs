//! What a program needs to fit the springs of a pair: `use railspring_calibrate::prelude::*`.

pub use crate::calibration::{ContactField, Enforcement, Reference};
pub use crate::law::StiffnessLaw;
pub use crate::mesh::MeshOptions;
pub use crate::pair::{
    AngleSettings, CondensedPair, ContactConditions, FitOptions, Pair, PairBody, PairSprings, PressDirection,
    law_by_shift,
};
pub use crate::solid::{Formulation, Material};
pub use railspring_profiles::error::Error;
pub use railspring_profiles::monitor::{Monitor, Silent};
pub use railspring_profiles::placement::TrackGeometry;
pub use railspring_profiles::section::{rail_section, wheel_section};
