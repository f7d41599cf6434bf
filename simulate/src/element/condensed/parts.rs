//! What the condensed contact element of a moving wheel knows of a pair of solids.

mod sections;
mod held_end;
mod wheel;
mod relief;
mod modulus;
mod overlap;
mod strips;
mod law;
mod hertz;
mod places;
mod fit;
mod pair_element;
mod lumped;
mod bodies;

pub use bodies::ElementBodies;
pub use fit::{Sections, StripForm, fit_strips};
pub use held_end::{EndPlace, HeldEnd, in_world};
pub use hertz::Flatness;
pub use law::{StripPlace, StripStiffness};
pub use lumped::{Bushing, Hub, LumpedElement, LumpedSet, Oscillator};
pub use modulus::{StripLaw, StripModulus};
pub use overlap::{Pose, Profiles};
pub use pair_element::{HeadOfElement, PairElement};
pub use places::{PlaceApproaches, PlaceLoad, StickingHub};
pub use relief::Influence;
pub use sections::{RunningSurface, SectionFlexibility};
pub use strips::{Contact, ContactStrips, Relieved};
pub use wheel::{ElasticWheel, RimMode, positive};
