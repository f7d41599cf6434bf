//! Error bands of a law, as `stiffness.json` has it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How far the laws of a calibration change with the grid of the contact and with the meshes of the bodies, and how far the scatter of measured profiles makes
/// them unsure. All changes and bands are relative.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ErrorBandRecord {
    /// Edge of the contact elements of the meshes of the laws, mm.
    pub contact_element_mm: f64,
    /// The same of the coarser meshes; none where there are none.
    pub coarser_element_mm: Option<f64>,
    /// The parts of the band that could not be had, and why. Without a part there is no band.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<String>,
    /// What `mesh.target_error` has come to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetRecord>,
    /// The bands by reference.
    pub references: Vec<ReferenceBandRecord>,
}

impl ErrorBandRecord {
    /// The band of the law with a reference.
    pub fn of(&self, reference: &str) -> Option<&ReferenceBandRecord> {
        self.references.iter().find(|band| band.reference == reference)
    }
}

/// Error band of the horizontal stiffness: its relative changes with coarser meshes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HorizontalBandRecord {
    /// At every preload; empty where there is no answer.
    pub meshes: Vec<f64>,
    /// Half the width of the band: the size of the largest of them.
    pub band: Option<f64>,
    /// Why there is none, if so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

impl HorizontalBandRecord {
    /// The band in words.
    pub fn sentence(&self) -> String {
        let band = self.band.map_or_else(
            || format!("none, {}", self.missing.as_deref().unwrap_or_default()),
            |band| format!("\u{b1}{:.2} %", 1e2 * band),
        );
        format!("error band of the horizontal stiffness: {band}")
    }
}

/// A wanted band, and what it has come to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TargetRecord {
    /// The wanted band.
    pub wanted: f64,
    /// Times that the meshes were refined for it.
    pub refinements: u32,
    /// Why it was not reached, if it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_reached: Option<String>,
}

/// The band of the law with one reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReferenceBandRecord {
    /// `foot`, `beam` or `local`.
    pub reference: String,
    /// The largest band of the displacement over the loads of the law; none where a part is missing.
    pub displacement: Option<f64>,
    /// The same of the tangent.
    pub tangent: Option<f64>,
    /// The band, load by load.
    pub points: Vec<BandPointRecord>,
}

impl ReferenceBandRecord {
    /// The larger of the two, displacement and tangent.
    pub fn largest(&self) -> Option<f64> {
        Some(self.displacement?.max(self.tangent?))
    }
}

/// The band at one load: the sizes of the changes that there are, together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BandPointRecord {
    /// Load, kN.
    pub force_kn: f64,
    /// Change of the displacement with the grid of the contact halved; none for a contact between elements.
    pub grid_displacement: Option<f64>,
    /// The same of the tangent.
    pub grid_tangent: Option<f64>,
    /// Change of the displacement with coarser meshes.
    pub mesh_displacement: Option<f64>,
    /// The same of the tangent.
    pub mesh_tangent: Option<f64>,
    /// Twice the standard uncertainty of the displacement by the scatter of measured profiles; none without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scatter_displacement: Option<f64>,
    /// The same of the tangent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scatter_tangent: Option<f64>,
    /// Band of the displacement; none where a part is missing.
    pub displacement: Option<f64>,
    /// Band of the tangent.
    pub tangent: Option<f64>,
}

impl BandPointRecord {
    /// The numerical parts alone, grid and meshes, of the displacement and of the tangent.
    pub fn numerical(&self) -> [f64; 2] {
        let size = |change: Option<f64>| change.map_or(0.0, f64::abs);
        [
            size(self.grid_displacement) + size(self.mesh_displacement),
            size(self.grid_tangent) + size(self.mesh_tangent),
        ]
    }
}
