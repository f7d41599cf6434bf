//! `contact_patches.json`: the pressed surface of the rail under some loads of the calibration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `contact_patches.json`: contact patches on the rail with the reference in use.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PatchesRecord {
    /// Name of the study.
    pub study: String,
    /// What the rail is held against: `foot`, `beam` or `local`.
    pub reference: String,
    /// Where the contact lives: `hybrid` or `elements`.
    pub field: String,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// The patches: those of the smallest, a middle and the largest load.
    pub patches: Vec<PatchRecord>,
    /// Hash of what the calibration depends on, the program included.
    pub input_hash: String,
    /// Version of the program that made this.
    pub version: String,
}

/// The patch under one load: a grid of points on the rail, one line beyond those that carry load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PatchRecord {
    /// Load, kN.
    pub force_kn: f64,
    /// Place of every line of points across: arc length on the rail's profile from the first touch, mm, positive to the field side;
    /// ascending.
    pub across_mm: Vec<f64>,
    /// The same place in the rail's profile frame, y, mm.
    pub rail_y_mm: Vec<f64>,
    /// See `rail_y_mm`, z, mm.
    pub rail_z_mm: Vec<f64>,
    /// Place of every line of points along the track, mm from the middle of the contact window; ascending.
    pub along_mm: Vec<f64>,
    /// Pressure, MPa, by line across and line along.
    pub pressure_mpa: Vec<Vec<f64>>,
    /// State, by line across and line along.
    pub state: Vec<Vec<PointState>>,
    /// Largest pressure, MPa; on the fine grid that of finer cells for each region, larger or smaller than that of a point here.
    pub max_pressure_mpa: f64,
    /// Stresses below the patch; none for a contact between elements, which do not resolve them.
    pub below: Option<BelowRecord>,
}

/// Stresses of a half-space under the pressure of a patch, below the place with the largest von Mises stress.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BelowRecord {
    /// The place, as `across_mm` of the patch.
    pub across_mm: f64,
    /// The place, as `along_mm` of the patch.
    pub along_mm: f64,
    /// Depths below it, mm, ascending.
    pub depth_mm: Vec<f64>,
    /// Von Mises stress at the depths, MPa.
    pub von_mises_mpa: Vec<f64>,
    /// Largest shear stress at the depths, MPa.
    pub shear_mpa: Vec<f64>,
}

/// State of a contact point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PointState {
    /// The surfaces are apart, or not paired there.
    Open,
    /// No slip since the load before.
    Stick,
    /// Friction at its limit.
    Slip,
}

impl PatchRecord {
    /// Largest pressure of the points, MPa.
    pub fn largest(&self) -> f64 {
        self.pressure_mpa.iter().flatten().copied().fold(0.0, f64::max)
    }
}
