#![doc = include_str!("../README.md")]

pub mod cases;
pub mod moving;
pub mod condensed;
