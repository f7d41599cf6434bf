//! Rigid contact of a wheelset: every point at which its two wheels touch the rails, at any lateral shift, yaw and roll.
//!
//! From these follow rolling-radius difference, equivalent conicity and the other parameters of EN 15302, with their uncertainty by that of measured
//! profiles.
//!
//! Signs: x along the track, y to the right, z down. The shift is positive to the right, yaw turns x towards y, roll
//! turns y towards z (the right wheel goes down). The left side is described by its mirror image, in which it is a
//! right side again: y runs from the track centre to its field side.

mod clearance;
mod trace;
mod wheelset;
mod conicity;
mod parameters;
mod uncertainty;

pub use conicity::{RunningFunction, RunningPoint};
pub use parameters::{ContactFunctions, FunctionPoint, Parameters};
pub use uncertainty::{ProfileUncertainty, Spread};
pub use wheelset::{
    ContactPoint, Roll, SideContact, WheelOnRail, Wheelset, WheelsetContact, WheelsetPosition,
};
