//! The section `output`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Fields of the calibration for ParaView, meshio and other programs; no number of the results depends on these keys.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OutputKeys {
    /// Where the z axis of the fields points. The meshes of `railspring mesh` have it down in any case, as mesh files must.
    pub vertical: VerticalKey,
    /// Loads of the calibration under which the fields of rail and wheel are written, some 10 MB each; those of the contact are written
    /// under every load.
    pub solid_loads: SolidLoadsKey,
}

impl Default for OutputKeys {
    fn default() -> Self {
        Self { vertical: VerticalKey::Down, solid_loads: SolidLoadsKey::Three }
    }
}

/// Where the z axis points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VerticalKey {
    /// Down, y to the field side: the axes of the program.
    Down,
    /// Up, y to the track centre: the same turned by half a turn about the track.
    Up,
}

/// Loads with fields of rail and wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SolidLoadsKey {
    /// The largest.
    Largest,
    /// The smallest, a middle and the largest, as in `contact_patches.json`.
    Three,
    /// All.
    All,
}
