//! Cross-sections of the two bodies: running surface, the rest of the outline, section properties.

mod vertices;
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
    RevolvedBody, WheelSection, body_of_revolution, wheel_section, wheel_section_of, wheel_section_on,
    wheel_section_with_profile,
};
pub use wheel_body::{WebShape, WheelBody};
