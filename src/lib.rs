//! Simulates with the fitted law, and verifies it against the solid model.

pub mod beam;
pub mod moving;
