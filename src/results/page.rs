//! The report: one page with all figures.

pub mod data;
pub mod input;
pub mod first_screen;
pub mod annex;
pub mod build;
pub mod stage;
