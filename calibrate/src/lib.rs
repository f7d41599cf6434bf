//! Wheel and rail profiles in, contact stiffness law out.
//!
//! The modules stand in the order of the pipeline: a module uses only those
//! above it.

pub mod error;
pub mod history;
pub mod law;
pub mod monitor;
pub mod placement;
pub mod profile;
pub mod scenario;
pub mod section;
pub mod units;
