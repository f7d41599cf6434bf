//! The closed outline of a rail or a wheel in a file: lines and arcs, a drawing, or columns of points.
//!
//! Lines and arcs say how they lie; an outline of the other kinds is turned upright and moved into the frame of its profile, and every such step
//! is a finding.

mod closed;
mod expected;
mod ring;
mod frame;
mod outline;
mod divide;
mod rail;
mod wheel;

use self::outline::Outline;
use crate::error::Result;
use crate::profile::{ProfileKind, Sketch};

pub use closed::ClosedSection;

/// Reads the closed section of a rail from the content of a file: top at z = 0, the middle of the foot at y = 0. `name` is used in messages, and its
/// ending tells the format where the content does not.
///
/// # Errors
/// [`crate::error::InputError`] with the line of the file for an outline that is open, crosses itself or steps back, that has no head or
/// not the size of a rail, or of which it is not certain which side is up.
pub fn parse_rail_section(name: &str, bytes: &[u8]) -> Result<ClosedSection> {
    sketch_section(name, bytes, ProfileKind::Rail, None).1
}

/// Reads the closed section of a wheel from the content of a file: tape circle at the origin, the bore at the least z. `name` is used in messages, and
/// its ending tells the format where the content does not. `tape_circle` is the distance of the tape circle from the flange back, m, of drawings and
/// columns; 70 mm if there is none. A table of lines and arcs says itself where its tape circle is.
///
/// # Errors
/// [`crate::error::InputError`] with the line of the file for an outline that is open, crosses itself or steps back, that has no flange, tread or bore
/// or not the size of a wheel, or of which it is not certain which end is the bore.
pub fn parse_wheel_section(name: &str, bytes: &[u8], tape_circle: Option<f64>) -> Result<ClosedSection> {
    sketch_section(name, bytes, ProfileKind::Wheel, tape_circle).1
}

/// The outline of the file of a section as it is drawn, with the section itself or what is wrong with it, as [`parse_rail_section`] and
/// [`parse_wheel_section`] say; `tape_circle` is that of a wheel.
pub fn sketch_section(
    name: &str,
    bytes: &[u8],
    kind: ProfileKind,
    tape_circle: Option<f64>,
) -> (Sketch, Result<ClosedSection>) {
    let mut sketch = Sketch::default();
    let outline = Outline::read(name, bytes, kind, &mut sketch);
    let section = outline.and_then(|outline| match kind {
        ProfileKind::Rail => rail::section(name, outline),
        ProfileKind::Wheel => wheel::section(name, outline, tape_circle),
    });
    (sketch, section)
}

#[cfg(test)]
mod tests;
