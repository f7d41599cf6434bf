//! Profiles of rails and wheels: smooth curves, and the standard ones from their definitions.
//!
//! Frames (right rail, seen along the track): y to the field side, z down. A rail's origin is the top of the
//! rail on its axis; a wheel's is the tape circle, 70 mm from the flange back unless its standard has it elsewhere. Both curves run in the
//! direction of increasing y. Sources, units and axes: `data/profiles/README.md`.

mod kind;
mod spline;
mod curve_parts;
mod curve;
mod followed;
mod segment;
mod sketch;
mod split;
mod flange;
mod table;
mod rail_drawings;
pub mod rails;
pub mod rail_catalogue;
pub mod lines_and_arcs;
pub mod wheels;
mod offset;

pub use curve::ProfileCurve;
pub use curve_parts::CurveParts;
pub(crate) use followed::Followed;
pub use kind::ProfileKind;
pub(crate) use segment::{EndlessLine, fillet};
pub use segment::{Segment, polyline};
pub use sketch::Sketch;
pub(crate) use sketch::{OF_THE_FILE, OF_THE_PROFILE};
pub(crate) use spline::Piece;
pub(crate) use split::{TAPE_CIRCLE_FROM_FLANGE_BACK, Tape, of_ring, split_rail, split_wheel};
