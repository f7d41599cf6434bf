#![doc = include_str!("../README.md")]

pub mod time;
mod axle;
pub mod solid;
pub mod element;
pub mod track;
pub mod cases;
pub mod prelude;
