#![doc = include_str!("../README.md")]

pub mod units;
pub mod field;
pub mod input;
pub mod error;
pub mod monitor;
pub mod root;
pub mod quadrature;
pub mod parabola;
pub mod profile;
pub mod profile_file;
pub mod section;
pub mod profile_placement;
pub mod placement;
pub mod rigid_contact;
