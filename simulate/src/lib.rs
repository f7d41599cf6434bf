//! A wheel on a rail of beams: stiffness law in, history of forces out.
//!
//! The law, the rail beam and the load case come from [`railspring_calibrate`]; the solid model there runs the same load
//! cases, and both leave the same [`railspring_calibrate::history::History`].
//!
//! The modules stand in the order of the pipeline: a module uses only those
//! above it.

pub mod moving;
