//! What result files say of meshes and measured profiles.

use railspring_profiles::profile_file::Action;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::rounding::significant;

/// Size and quality of one mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BodyMeshRecord {
    /// `rail` or `wheel`.
    pub body: String,
    /// The mesh file as the study names it; none for the tool's own mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of hexahedra.
    pub elements: usize,
    /// Degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Number of candidate contact nodes.
    pub contact_nodes: usize,
    /// Edge length in the contact zone, mm.
    pub contact_element_mm: f64,
    /// Smallest scaled Jacobian.
    pub min_scaled_jacobian: f64,
    /// Mean scaled Jacobian.
    pub mean_scaled_jacobian: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Young's modulus at the contact surface, GPa, where the groups of a mesh file have their own materials.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface_young_gpa: Option<f64>,
    /// Poisson's ratio there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface_poisson: Option<f64>,
    /// What was found in the mesh file under the names of the study; none for the tool's own mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub named: Option<NamedRecord>,
}

/// Sizes of what a study names in a mesh file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NamedRecord {
    /// Nodes that hold the body.
    pub held_nodes: usize,
    /// Faces of the contact surface within the window.
    pub contact_faces: usize,
    /// Groups that have a material, in the order of their names.
    pub groups: Vec<GroupRecord>,
}

/// A group of hexahedra that has a material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GroupRecord {
    /// Its name in the file.
    pub name: String,
    /// Number of its hexahedra.
    pub elements: usize,
}

/// A measured profile on its way to a section, or a section from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProfileRecord {
    /// `rail` or `wheel`; `rail section` or `wheel section` for the closed section of a file.
    pub body: String,
    /// The file as the study names it.
    pub file: String,
    /// BLAKE3 hash of its content; none in results of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content_hash: Option<String>,
    /// Format of the file.
    pub format: String,
    /// The body that it is joined to: a standard, or the file of a section.
    pub standard: String,
    /// Number of points of the file, or of its lines and arcs.
    pub points: usize,
    /// What was found, and what became of it.
    pub findings: Vec<FindingRecord>,
}

impl ProfileRecord {
    /// What was found and could not be repaired, a sentence each.
    pub fn left(&self) -> impl Iterator<Item = String> {
        let left = self.findings.iter().filter(|finding| finding.action == Action::Left.name());
        left.map(|finding| format!("{} {}: {}", self.body, self.file, finding.sentence()))
    }
}

impl FindingRecord {
    /// Where it is, what it is about, how much of it, and what was done.
    fn sentence(&self) -> String {
        let lines = match (self.first_line, self.last_line) {
            (Some(first), Some(last)) if first != last => format!("lines {first} to {last}: "),
            (Some(line), _) => format!("line {line}: "),
            _ => String::new(),
        };
        let unit = self.unit.as_deref().unwrap_or_default();
        let value = self.value.map_or_else(String::new, |value| format!(" {} {unit}", significant(value, 4)));
        format!("{lines}{}{value}: {}", self.kind, self.text)
    }
}

/// Something found in a profile file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FindingRecord {
    /// What it is about, for instance `spike`.
    pub kind: String,
    /// First line of the file that it concerns.
    pub first_line: Option<usize>,
    /// Last line of the file that it concerns.
    pub last_line: Option<usize>,
    /// The value that gave rise to it.
    pub value: Option<f64>,
    /// Unit of the value.
    pub unit: Option<String>,
    /// `noted`, `repaired` or `left`.
    pub action: String,
    /// What it is and what was done, in words.
    pub text: String,
}
