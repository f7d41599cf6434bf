//! Fits the contact springs between a railway wheel and a rail, and proves them.
//!
//! [`railspring_calibrate`] turns two profiles into a stiffness law. This crate
//! simulates with the law, verifies the simulation against the solid model and
//! reports how far the two are apart.
//!
//! The modules stand in the order of the pipeline: a module uses only those
//! above it.

pub mod output;
pub mod verify;
pub mod records;
pub mod results;
pub mod report;
pub mod study;
pub mod python;
pub mod stages;
pub mod springs;
pub mod estimate;
pub mod measure;
pub mod pipeline;
pub mod crosscheck;
pub mod cli;
