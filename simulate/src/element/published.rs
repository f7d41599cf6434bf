//! The published moving contact element and its solver.
//!
//! A wheel with a cubic-spline profile stands on a rail whose profile is a row of nodes. The rail nodes
//! follow the master C on the rail's beam. The wheel's spline follows the master B. Springs k1, k2 and k3
//! join B to the wheel centre A. Contact and friction act at each rail node that the spline has passed.
//! Several contacts at once need nothing special.
//!
//! **Handing over.** The rail nodes lie so close that a wheel that slides passes many of them. A node that is
//! about to touch knows the place of its foot on the wheel from the last step. Its tangential increment is
//! then that of the whole step. While the wheel slides, a node that begins to carry load is at its friction
//! limit at once, and nothing is lost. While the wheel sticks, load can move between neighbours as the patch
//! grows or rolls. A new node starts without tangential force. The others take over the force, which costs a
//! creep of no more than force/penalty (50 nm for 50 kN), far below the springs' deflection.
//!
//! **Spacing.** Between two nodes the polygon of nodes lies below the
//! profile by h²/8 times the relative curvature, and the contact angle changes in
//! steps of h times it. The default of 0.25 mm leaves 0.6 µm at the gauge
//! corner (radius 13 mm), which is below one per cent of the contact's deflection.

pub mod element;
mod surface;
mod wheel;
mod support;
mod travel;
mod interface;
mod solve;
mod model;
mod departure;
mod run;
mod statics;
mod wheelset;

pub(crate) use departure::at_end;
pub(crate) use interface::Interface;
pub use model::{HubStatics, InitialMotion, MovingModel, MovingRun, RunStatistics, SectionMotion};
pub use support::RailSupport;
pub(crate) use support::{Rail, RailDynamics, RailState};
pub use surface::SlidingMatrix;
pub(crate) use travel::Travel;
pub use wheel::WheelSprings;
pub(crate) use wheelset::{AxleContacts, AxleStep, Friction};
pub use wheelset::{Derailment, WheelContact, WheelsetContact, WheelsetSide};

#[cfg(test)]
pub(crate) use run::tests as run_tests;
#[cfg(test)]
pub(crate) use support::RailLoad;
