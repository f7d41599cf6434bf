//! Closed solutions to hold the numerics against. Nothing in the pipeline uses them.

pub mod beam;
pub mod drop;
pub mod friction;
pub mod hertz;
