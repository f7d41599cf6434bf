//! Cross-sections of the two bodies: running surface, the rest of the outline, section properties.

mod join;
mod properties;
mod rail;
mod wheel_body;
mod wheel;
mod made;

pub use made::{rail_section_for_head, wheel_section_for_profile};
pub use properties::AreaProperties;
pub use rail::{RailSection, rail_section, rail_section_of, rail_section_on, rail_section_with_head};
pub use wheel::{
    RevolvedBody, WheelSection, body_of_revolution, body_of_revolution_mass, wheel_section, wheel_section_of,
    wheel_section_on, wheel_section_with_profile,
};
pub use wheel_body::{WebShape, WheelBody};

use nalgebra::Point2;

use crate::units::MILLIMETRE;

/// Largest distance of the vertices on the arcs of a body outline, m.
const FILLET_STEP: f64 = 2.0 * MILLIMETRE;

/// Shortest edge of a body's outline, m.
const SHORTEST_EDGE: f64 = 1.0 * MILLIMETRE;

/// Vertices without those that are nearer than the shortest edge to the one before them, or to the last one.
fn thinned(vertices: Vec<Point2<f64>>) -> Vec<Point2<f64>> {
    let Some(end) = vertices.last().copied() else { return vertices };
    let mut kept: Vec<Point2<f64>> = Vec::with_capacity(vertices.len());
    for p in &vertices[..vertices.len() - 1] {
        if kept.last().is_none_or(|last| (p - last).norm() >= SHORTEST_EDGE) {
            kept.push(*p);
        }
    }
    while kept.len() > 1 && kept.last().is_some_and(|last| (end - last).norm() < SHORTEST_EDGE) {
        kept.pop();
    }
    kept.push(end);
    kept
}
