//! Fits the contact springs between a railway wheel and a rail, and verifies them against a solid model.
//!
//! [`railspring_calibrate`] turns two profiles into a stiffness law, and [`railspring_simulate`] runs a wheel with that law on
//! a rail of beams. This crate is the program around them: it reads a study ([`study`]), runs its stages ([`pipeline`]),
//! compares the simple model with the solid one ([`verify`]), and writes result files and a report ([`records`],
//! [`mod@report`]). Whoever needs a law or a simulation in a program uses the two libraries; this one belongs to the command
//! `railspring` and may change with every version.
//!
//! The modules stand in the order of the pipeline: a module uses only those
//! above it.
//!
//! # A verdict from code
//! ```
#![doc = include_str!("../examples/verdict.rs")]
//! ```

pub mod version;
pub mod rounding;
mod child;
pub mod output;
pub mod pdf;
pub mod verify;
pub mod records;
pub mod results;
pub mod report;
pub mod study;
pub mod template;
pub mod python;
pub mod store;
pub mod stages;
pub mod springs;
pub mod estimate;
pub mod measure;
pub mod crosscheck;
pub mod pipeline;
pub mod compare;
pub mod table;
pub mod export;
pub mod cluster;
pub mod cli;
