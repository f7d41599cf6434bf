//! The rail as a straight beam: 3D Timoshenko elements, their statics and
//! their motion.

mod section;
mod element;
mod factor;
mod motion;
mod rail;
mod correction;
mod held;
mod modes;

pub use element::{BeamElement, deflection_functions, rotation_functions};
pub use factor::{ChainFactor, ElementBlocks, Entry, Meeting, NODE, Node, product};
pub use held::HeldRail;
pub use modes::{SectionMode, SectionModes};
pub use rail::{End, RailBeam, SectionRows};
pub use section::{BeamCorrection, BeamSection, Torsion};
