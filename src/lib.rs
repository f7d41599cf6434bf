//! Fits the contact springs between a railway wheel and a rail, and verifies them against a solid model.
//!
//! [`railspring_calibrate`] turns two profiles into a stiffness law, and [`railspring_simulate`] runs a wheel with that law on
//! a rail of beams. This crate is the program around them: it reads a study ([`study`]), makes its results ([`results`]) or takes
//! them from store and folder ([`engine`]), and compares the simple model with the solid one ([`verify`]). Whoever needs a law or a simulation in a program uses the two libraries; this one belongs to the command
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
pub mod program;
pub mod rounding;
pub mod hash;
mod child;
mod plain_file;
pub mod verify;
pub mod study;
pub mod template;
pub mod python;
pub mod engine;
pub mod pdf;
pub mod report;
pub mod self_test;
pub mod results;
pub mod compare;
pub mod table;
pub mod track;
pub mod export;
pub mod cluster;
pub mod cli;
