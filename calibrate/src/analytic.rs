//! Closed solutions: oracles of the tests, and the torsion of a short span for the beam.

pub mod beam;
pub mod drop;
pub mod friction;
pub mod hertz;
