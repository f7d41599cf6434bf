//! The contact patches under some loads of the calibration.

pub mod record;
pub mod make;
pub mod figure;
pub mod section_figure;
