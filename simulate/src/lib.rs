#![doc = include_str!("../README.md")]

pub mod time;
pub mod solid;
pub mod element;
pub mod cases;
