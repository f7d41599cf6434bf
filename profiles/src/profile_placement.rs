//! Where a measured profile lies: its origin, rotation, side and size found against its standard.
//!
//! [`place`] lays the measurement onto what wear leaves as it is. Of a wheel this is the back of the flange up to its tip, the field
//! end of the tread, chamfer and field face. Of a rail it is the side of the head that is not worn, its corners, the underside,
//! web and foot. The fit is robust: points on worn surface lose their weight. [`Placed`] says where the profile lies and how sure that is, which
//! parts were kept, and how far every point lies from the standard. [`nearest`] names the standards that fit best, and
//! [`rail_wear`] and [`wheel_wear`] read off what is worn. A profile of which no standard is known lies as its own shape says
//! ([`rail_in_own_frame`], [`wheel_in_own_frame`]).

mod reference;
mod fit;
mod starts;
mod side;
mod placed;
mod own_frame;
mod nearest;
mod file;
mod wear;

pub use file::{find_place, moved_there, place_profile};
pub use fit::missing;
pub use nearest::{Misfit, in_words, nearest, resembled, say_nearest, with_nearest_to};
pub use own_frame::{
    OwnFrame, TURNED, UNSURE_ROLL, UNSURE_SHIFT, Unsure, WIDTH_DEPTH, rail_in_own_frame, sides_of_head,
    wheel_in_own_frame,
};
pub use placed::{Motion, PlaceOptions, Placed, PlacedPoint, Size, Spread, place};
pub use reference::Reference;
pub use side::Side;
pub use wear::{RailWear, WheelWear, deepest_wear, rail_wear, wheel_wear};
