//! What the condensed contact element of a moving wheel knows of a pair of solids, and how that is found.

mod sections;
mod held_end;
mod wheel;
mod hertz;
mod places;
mod fit;
mod lumped;
mod bodies;

pub use bodies::ElementBodies;
pub use fit::{Sections, StripForm, fit_strips};
pub use held_end::held_end;
pub use hertz::Flatness;
pub use lumped::{Bushing, Hub, LumpedElement, LumpedSet, Oscillator};
pub use places::{PlaceApproaches, PlaceLoad, StickingHub};
pub use sections::{RunningSurface, SectionFlexibility};
