#![doc = include_str!("../README.md")]

pub mod law;
pub mod analytic;
pub mod mesh;
pub mod section_analysis;
pub mod solid;
pub mod superelement;
pub mod beam;
pub mod contact;
pub mod calibration;
pub mod pair;
pub mod uncertainty;
pub mod prelude;
