//! Rail and wheel in the track: inclination, gauge, and the wheel lowered until it just touches.
//!
//! World frame: y from the track centre to the field side of the right rail, z down from the highest point of
//! the placed rail.

mod track;
mod placed_rail;
mod departure;
mod touch;

pub use departure::{Departure, departure, lateral_extent};
pub use placed_rail::{PlacedRail, place_rail};
pub use touch::{Touch, TouchSearch, touch};
pub use track::TrackGeometry;
