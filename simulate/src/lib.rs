#![doc = include_str!("../README.md")]

pub mod moving;
pub mod condensed;
