//! Wheel and rail profiles in, contact stiffness law out.
//!
//! The modules stand in the order of the pipeline: a module uses only those
//! above it.

pub mod units;
pub mod field;
pub mod input;
pub mod error;
pub mod monitor;
pub mod law;
pub mod analytic;
pub mod scenario;
pub mod history;
pub mod profile;
pub mod profile_file;
pub mod section;
pub mod placement;
pub mod rigid_contact;
pub mod mesh;
pub mod section_analysis;
pub mod solid;
pub mod superelement;
pub mod beam;
pub mod contact;
pub mod calibration;
pub mod transient;
