//! Linear parts of a model that nonlinear elements push on: bodies, beams, wheels, later sleepers, bridges and vehicles.
//!
//! In one step of an implicit scheme, such as [`crate::time::newmark`], the displacement of a linear part at its interface is an
//! affine function of the forces there, both at the end of the step: `u = free + flexibility·forces`. A solver of
//! contacts needs nothing else of a part, so that its unknowns are the contacts alone. A step goes in three:
//!
//! 1. [`LinearPart::predict`]: the motion that the part has without forces at its interface;
//! 2. the solver finds the forces from [`LinearStep::free`] and [`LinearStep::flexibility`] of all parts;
//! 3. [`LinearStep::finish`]: the part takes these forces back and completes its state at the end.
//!
//! What can fail, a factor above all, fails when the part is prepared; a step cannot. A step only looks at the state from
//! which it starts. It can be dropped and tried again, with a shorter one for instance. It writes into the state that follows from the beginning
//! on, so that a part needs no other memory for it, and a run that keeps two states and takes them in turn needs no more.

mod part;
pub use part::{LinearPart, LinearStep};

#[cfg(test)]
pub mod conformance;
