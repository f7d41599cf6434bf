//! Fits the contact springs between a railway wheel and a rail, and verifies them against a solid model.
//!
//! [`railspring_calibrate`] turns two profiles into a stiffness law, and [`railspring_simulate`] runs a wheel with that law on
//! a rail of beams. This crate is the program around them: it reads a study ([`study`]), makes its results ([`results`]) or takes
//! them from store and folder ([`engine`]), and compares the simple model with the solid one ([`verify`]). A program that
//! needs a law or a simulation uses the two libraries. This one belongs to the command `railspring` and may change with
//! every version.
//!
//! The modules stand in the order of the pipeline: a module uses only those above it.
//!
//! | modules | content |
//! |---|---|
//! | [`version`], [`program`], [`rounding`], [`hash`] | version and commit; the program's file; digits of errors; keys of inputs |
//! | [`verify`] | the verdict's numbers: differences, limits, statistics |
//! | [`study`], [`template`] | the input file: keys, checks, SI values; studies of `railspring new` |
//! | [`python`] | Python environments and packages |
//! | [`engine`] | stages, the store, output folders |
//! | [`pdf`], [`report`] | printed pages; axes, panels and pages from templates |
//! | [`self_test`] | the program's own test on the machine at hand |
//! | [`results`] | each result: its inputs, its files, how it is made |
//! | [`compare`] | two results side by side |
//! | [`table`] | tables of springs |
//! | [`track`] | load cases on a track without profiles |
//! | [`export`] | springs as files for other programs |
//! | [`cluster`] | tables on Dask |
//! | [`cli`] | arguments, progress, exit codes |
//!
//! # A verdict from code
//!
//! The condensed element and the solid model run the same load case.
//!
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
