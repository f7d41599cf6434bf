//! The rail as a straight beam: 3D Timoshenko elements, their statics and
//! their vibration modes.

mod section;
mod element;
mod rail;
mod correction;

pub use element::{BeamElement, deflection_functions};
pub use rail::{End, RailBeam, RailModes};
pub use section::{BeamCorrection, BeamSection, Torsion};
