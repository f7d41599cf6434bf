//! Records of benchmarks.

pub mod scaling;
pub mod step_times;
