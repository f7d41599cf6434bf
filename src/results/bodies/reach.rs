//! How far contact zones reach, which later stages go on with.

use railspring_calibrate::mesh::MeshOptions;
use serde::{Deserialize, Serialize};

/// How fine the tool's own meshes are, and how far their contact zones reach, m. Runs make them larger where the contact goes on, and what
/// comes later begins with the larger ones, so that this is an input of a run on the solids.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// Times that the study's sizes are refined.
    pub refinements: u32,
    window_half_length: f64,
    contact_half_length: f64,
    rail_face_depth: f64,
    rail_field_y: f64,
    wheel_face_depth: f64,
    wheel_field_y: f64,
}

impl Reach {
    /// That of meshes with these sizes, so many times refined.
    pub fn of(options: &MeshOptions, refinements: u32) -> Self {
        Self {
            refinements,
            window_half_length: options.window_half_length,
            contact_half_length: options.contact_half_length,
            rail_face_depth: options.rail_zone.face_depth,
            rail_field_y: options.rail_zone.field_y,
            wheel_face_depth: options.wheel_zone.face_depth,
            wheel_field_y: options.wheel_zone.field_y,
        }
    }

    /// Sizes whose zones reach so far.
    pub fn extend(&self, mut options: MeshOptions) -> MeshOptions {
        options.window_half_length = self.window_half_length;
        options.contact_half_length = self.contact_half_length;
        options.rail_zone.face_depth = self.rail_face_depth;
        options.rail_zone.field_y = self.rail_field_y;
        options.wheel_zone.face_depth = self.wheel_face_depth;
        options.wheel_zone.field_y = self.wheel_field_y;
        options
    }
}
