//! What both models of a moving wheel share: load cases, integration in time with its steps, linear parts, energy and histories.

pub mod newmark;
pub mod steps;
pub mod function;
pub mod scenario;
pub mod linear_part;
pub mod energy;
pub mod suspension;
pub mod history;
