//! Load cases on a track in the vertical plane: a wheel or a wheelset with a given law of its contact runs on a rail with supports, sleepers,
//! a bed and a bridge.
//!
//! No profiles and no solids take part, so that nothing here is verified by them. The law is a displacement of the hub against the rail's section, and the wheel touches
//! from above alone: force and displacement are vertical. A wheelset has two rails, which the axle joins.
//!
//! **Equations.** Rail and bridge are chains of Timoshenko elements, sleepers single masses. Newmark's scheme in its accelerations a,
//!
//! ```text
//! (M + (gain of u)·K + (gain of v)·C)·a = f − K·u* − C·v*,   u = u* + (gain of u)·a,   v = v* + (gain of v)·a,
//! ```
//!
//! has a block-tridiagonal matrix once the sleepers are eliminated, each by itself. It is factored once from both ends
//! ([`railspring_calibrate::beam::ChainFactor`]); the flexibility under the wheel follows without a solution, and the contact is one equation
//! a wheel. A step costs as much as the chain is long.
//!
//! **Ground.** All supports move together. Displacements are those against the moving ground, in which every mass m has the force −m·a of the ground's
//! acceleration a; only accelerations are told absolutely.

mod way;
mod irregularity;
mod structure;
mod state;
mod dynamics;
mod steps;
mod plane;
mod rails;
mod running;
mod case;
mod run;
mod swaying;
mod across;
mod across_run;

pub use across::{
    AcrossCase, AcrossEnding, AcrossRow, AcrossRun, AcrossWork, ProbeAcross, RailTorsion, StartAcross,
    UnevenRail, WheelAcross,
};
pub use case::{Probe, Start, TrackCase, Wheels};
pub use dynamics::{TrackDynamics, TrackLoad};
pub use irregularity::{Irregularity, Spectrum, Unevenness};
pub use rails::{Across, LayersAcross, RailSeen, TwoRails};
pub use run::{ProbeRow, TrackEnding, TrackRow, TrackRun, WheelRow};
pub use running::{Running, SprungWheel, Wheelset};
pub use state::TrackState;
pub use structure::{Bridge, Carrier, Direction, Held, Layers, LineBeam, Onto, Track};
pub use swaying::{SuspensionForce, SwayingWheelset};
pub use way::Way;

#[cfg(test)]
mod tests;
