//! The study as it is in its TOML file: keys with units in their names,
//! defaults, and the ranges that the file is checked against.
//!
//! The JSON schema is derived from these structures, and the file is checked
//! against that schema, so that a key, its range and its description are said
//! once. `x-field` names the field of the libraries that a key sets. [`super::Study`] holds the same values in SI
//! units.

mod assessment;
mod material;
mod bodies;
mod function;
mod output;
mod scenario;
mod solid;
mod uncertainty;

use std::collections::BTreeMap;

use railspring_calibrate::calibration::Reference;
use railspring_calibrate::law::Form;
use railspring_profiles::field::InputField;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::verify::Limits;

pub use assessment::{IntendedUseKeys, ReviewKeys, ValidationKeys, ZeroKey};
pub use bodies::{
    Inclination, MeshFileKeys, RailBodyKey, RailDimensionKeys, RailKeys, SurfaceKeys, UnitKey, WebKey,
    WheelKeys,
};
pub use function::{HarmonicForceKeys, HarmonicMomentKeys, Interpolation, TableKeys, sine};
pub use material::{BodyMaterialKeys, GroupMaterialKeys, MaterialKeys};
pub use output::{OutputKeys, SolidLoadsKey, VerticalKey};
pub use scenario::{ForceKeys, ScenarioKeys, SuspensionKeys, TorsionKeys};
pub use solid::{SolidKeys, TransientKey};
pub use uncertainty::UncertaintyKeys;

/// Sections of the study file, in their order.
pub const SECTIONS: [&str; 16] = [
    "intended_use",
    "rail",
    "wheel",
    "track",
    "material",
    "mesh",
    "contact",
    "calibration",
    "uncertainty",
    "simulation",
    "solid",
    "scenario",
    "verification",
    "validation",
    "review",
    "output",
];

/// A study: a rail and a wheel, how to calibrate the contact springs between them, and the load cases to verify the springs with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyDocument {
    /// Short name of the study; names the output folder. Letters, digits, `-`, `_` and `.`.
    #[schemars(length(min = 1, max = 80))]
    pub name: String,
    /// What the study is about, in a sentence or two; shown in the report.
    #[serde(default)]
    pub description: String,
    /// What the springs are for, and how accurate they have to be.
    #[serde(default)]
    pub intended_use: IntendedUseKeys,
    /// The rail.
    pub rail: RailKeys,
    /// The wheel.
    pub wheel: WheelKeys,
    /// Where the wheel is on the track.
    #[serde(default)]
    pub track: TrackKeys,
    /// The material of both bodies; `[rail.material]` and `[wheel.material]` give one of them another.
    #[serde(default)]
    pub material: MaterialKeys,
    /// The solid meshes.
    #[serde(default)]
    pub mesh: MeshKeys,
    /// Contact and friction between the solids.
    #[serde(default)]
    pub contact: ContactKeys,
    /// The load range and the reference of the stiffness law.
    #[serde(default)]
    pub calibration: CalibrationKeys,
    /// By how much the inputs of the springs may be off.
    #[serde(default)]
    pub uncertainty: UncertaintyKeys,
    /// The simple moving-contact model.
    #[serde(default)]
    pub simulation: SimulationKeys,
    /// The solid model in time.
    #[serde(default)]
    pub solid: SolidKeys,
    /// Load cases by name.
    #[serde(default)]
    pub scenario: BTreeMap<String, ScenarioKeys>,
    /// Limits of the verdict.
    #[serde(default)]
    pub verification: Limits,
    /// A measurement that the springs are compared with.
    #[serde(default)]
    pub validation: ValidationKeys,
    /// Who made and who reviewed the study.
    #[serde(default)]
    pub review: ReviewKeys,
    /// Files for other programs.
    #[serde(default)]
    pub output: OutputKeys,
}

/// Where the wheel is on the track.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TrackKeys {
    /// Track gauge, mm.
    #[schemars(range(min = 500.0, max = 2000.0), extend("x-field" = InputField::Gauge.name()))]
    pub gauge_mm: f64,
    /// Depth below the top of the rail at which the gauge is measured, mm.
    #[schemars(range(min = 1.0, max = 30.0), extend("x-field" = InputField::GaugeHeight.name()))]
    pub gauge_height_mm: f64,
    /// Distance between the flange backs of the wheelset, mm.
    #[schemars(range(min = 400.0, max = 2000.0), extend("x-field" = InputField::FlangeBack.name()))]
    pub flange_back_mm: f64,
    /// Lateral shift of the wheelset from the track centre, mm, positive towards the modelled rail.
    #[schemars(range(min = -100.0, max = 100.0), extend("x-field" = InputField::LateralShift.name()))]
    pub lateral_shift_mm: f64,
}

impl Default for TrackKeys {
    fn default() -> Self {
        Self { gauge_mm: 1435.0, gauge_height_mm: 14.0, flange_back_mm: 1360.0, lateral_shift_mm: 0.0 }
    }
}

/// The hexahedral meshes of both bodies, graded towards the contact zone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MeshKeys {
    /// Edge of the elements in the contact zone across the track, mm.
    #[schemars(range(min = 0.2, max = 10.0), extend("x-field" = InputField::ContactElement.name()))]
    pub contact_element_mm: f64,
    /// Edge of the elements in the contact zone along the track, mm.
    #[schemars(range(min = 0.2, max = 10.0), extend("x-field" = InputField::ContactElementAlong.name()))]
    pub contact_element_along_mm: f64,
    /// Half length of the contact zone along the track, mm. Left out, the zone is made longer where the contact patch
    /// requires it, and a contact on the fine grid may go on beyond it, on larger elements.
    #[schemars(range(min = 4.0, max = 60.0), extend("x-field" = InputField::WindowHalfLength.name()))]
    pub window_half_length_mm: f64,
    /// Ratio of the lengths of neighbouring elements along the track, outside the contact zone.
    #[schemars(range(min = 1.05, max = 3.0), extend("x-field" = InputField::Growth.name()))]
    pub growth: f64,
    /// Largest element of the rail's section, mm; those over its web and on its fillets are smaller in proportion.
    #[schemars(range(min = 2.0, max = 100.0), extend("x-field" = InputField::RailSectionElement.name()))]
    pub rail_section_element_mm: f64,
    /// Largest element of the wheel's section, mm; those over its disc and on its fillets are smaller in proportion.
    #[schemars(range(min = 2.0, max = 100.0), extend("x-field" = InputField::WheelSectionElement.name()))]
    pub wheel_section_element_mm: f64,
    /// Longest element along the rail, mm.
    #[schemars(range(min = 2.0, max = 500.0), extend("x-field" = InputField::RailLengthElement.name()))]
    pub rail_length_element_mm: f64,
    /// Longest element around the wheel, as arc at the tape circle, mm.
    #[schemars(range(min = 2.0, max = 500.0), extend("x-field" = InputField::WheelArcElement.name()))]
    pub wheel_arc_element_mm: f64,
    /// Number of layers of elements under the contact zone, even; left out, as many as it takes down to 4 mm.
    #[schemars(range(min = 2, max = 40), extend("x-field" = InputField::Layers.name()))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<usize>,
    /// Thickness of the first layer under the contact zone, mm, each further one 1.25 times as thick; left out,
    /// `contact_element_mm`, but 2 mm at most.
    #[schemars(range(min = 0.1, max = 20.0), extend("x-field" = InputField::FirstLayer.name()))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_layer_mm: Option<f64>,
    /// Wanted error band of the law in use, relative, for displacement and tangent: the meshes are refined until it is reached, as far
    /// as the memory lets them; left out, they stay as they are.
    #[schemars(range(min = 1e-4, max = 0.5))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target_error: Option<f64>,
    /// Formulation of the eight-node brick.
    pub element: ElementKey,
}

impl Default for MeshKeys {
    fn default() -> Self {
        Self {
            contact_element_mm: 2.0,
            contact_element_along_mm: 1.5,
            window_half_length_mm: 12.0,
            growth: 1.6,
            rail_section_element_mm: 12.0,
            wheel_section_element_mm: 10.0,
            rail_length_element_mm: 20.0,
            wheel_arc_element_mm: 60.0,
            layers: None,
            first_layer_mm: None,
            target_error: None,
            element: ElementKey::IncompatibleModes,
        }
    }
}

/// Formulation of the eight-node brick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ElementKey {
    /// Incompatible modes: does not lock in bending.
    IncompatibleModes,
    /// Plain full integration: stiff in bending, for comparison.
    FullIntegration,
}

/// Contact and friction between the solids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ContactKeys {
    /// Where the contact of the solid model lives, and what is elastic in it, in the calibration and in the runs.
    pub field: FieldKey,
    /// How the surfaces are kept from passing through each other.
    #[schemars(extend("x-field" = InputField::Enforcement.name()))]
    pub enforcement: EnforcementKey,
    /// Penalty stiffness of a contact point, kN/m; the published value is 1e6.
    #[schemars(range(min = 1e3, max = 1e12))]
    pub penalty_kn_per_m: f64,
    /// Coulomb friction coefficient between wheel and rail. A calibration needs one above 0, for its horizontal stiffness is that of a sticking contact; a load case may have its own, 0 too.
    #[schemars(range(min = 0.0, max = 2.0), extend("x-field" = InputField::Friction.name()))]
    pub friction: f64,
}

impl Default for ContactKeys {
    fn default() -> Self {
        Self {
            field: FieldKey::Hybrid,
            enforcement: EnforcementKey::Exact,
            penalty_kn_per_m: 1e6,
            friction: 0.5,
        }
    }
}

/// Where the contact lives, and what is elastic in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FieldKey {
    /// On a fine grid that follows the patch: half-spaces there, the bodies beyond them from the meshes.
    Hybrid,
    /// On the nodes of the meshes, the elements alone; what the reference solvers are compared with.
    Elements,
}

impl FieldKey {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hybrid => "hybrid",
            Self::Elements => "elements",
        }
    }
}

/// How the surfaces are kept from passing through each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EnforcementKey {
    /// No penetration at all.
    Exact,
    /// A stiff spring on every contact point, as published.
    Penalty,
}

/// The load range and the reference of the stiffness law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CalibrationKeys {
    /// Smallest load, kN.
    #[schemars(range(min = 0.01, max = 1000.0))]
    pub load_min_kn: f64,
    /// Largest load, kN.
    #[schemars(range(min = 0.1, max = 1000.0), extend("x-field" = InputField::Loads.name()))]
    pub load_max_kn: f64,
    /// Number of loads between the smallest and the largest.
    #[schemars(range(min = 4, max = 500))]
    pub load_count: usize,
    /// How the loads are spaced.
    pub load_spacing: SpacingKey,
    /// The loads one by one, kN, ascending; replaces `load_min_kn`, `load_max_kn` and `load_count`.
    #[schemars(inner(range(min = 0.01, max = 1000.0)), length(min = 4), extend("x-field" = InputField::Loads.name()))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loads_kn: Option<Vec<f64>>,
    /// What the displacement of the law in use is measured against.
    pub reference: ReferenceKey,
    /// Whether the laws against the rail's held foot are made beside the others, as for a comparison with laws that were published so. It takes
    /// another body and as many loads again; with the reference `foot` they are made anyway.
    pub foot_held: bool,
    /// Whether the calibration and the laws by contact angle get error bands: their change with half the spacing of the
    /// contact's grid and with coarser meshes. For the calibration it takes about as long as the laws.
    pub error_band: bool,
    /// Vertical preloads at which the horizontal stiffness is measured, kN, ascending.
    #[schemars(inner(range(min = 0.1, max = 1000.0)), length(min = 1), extend("x-field" = InputField::HorizontalPreloads.name()))]
    pub horizontal_preloads_kn: Vec<f64>,
    /// Loads along the contact normal at which the laws by contact angle give displacement and tangent of the solid, kN, ascending; those within the
    /// range of the loads.
    #[schemars(inner(range(min = 0.1, max = 1000.0)), length(min = 1, max = 50))]
    pub stiffness_at_kn: Vec<f64>,
    /// Lateral shifts of the wheelset at which the law by contact angle is made, mm, ascending, as `track.lateral_shift_mm`; an empty list
    /// makes none. Left out, they lie on tread, gauge corner and flange of the pair.
    #[schemars(inner(range(min = -100.0, max = 100.0)), length(max = 200))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shifts_mm: Option<Vec<f64>>,
    /// Whether the condensed and the lumped contact element are made of the laws by contact angle, for a run with them or for another program. Left out, where the study has a load case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elements: Option<bool>,
}

impl Default for CalibrationKeys {
    fn default() -> Self {
        Self {
            load_min_kn: 1.0,
            load_max_kn: 150.0,
            load_count: 24,
            load_spacing: SpacingKey::Approach,
            loads_kn: None,
            reference: ReferenceKey::Beam,
            foot_held: false,
            error_band: true,
            horizontal_preloads_kn: vec![20.0, 50.0, 85.0, 120.0],
            stiffness_at_kn: vec![20.0, 40.0, 60.0, 80.0, 100.0, 120.0],
            shifts_mm: None,
            elements: None,
        }
    }
}

/// How the calibration loads are spaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpacingKey {
    /// The difference of neighbouring Hertz approaches (load to the power 2/3) is constant.
    Approach,
    /// The ratio of neighbouring loads is constant.
    Geometric,
    /// The difference of neighbouring loads is constant.
    Linear,
}

/// What the displacement of a law is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceKey {
    /// Wheel hub against the held rail foot; nothing is subtracted.
    Foot,
    /// Wheel hub against the beam model of the rail: beam and law together are the solid.
    Beam,
    /// The approach of the two surfaces alone.
    Local,
}

impl ReferenceKey {
    /// Name in files and figures.
    pub fn name(self) -> &'static str {
        Reference::from(self).name()
    }
}

impl From<ReferenceKey> for Reference {
    fn from(key: ReferenceKey) -> Self {
        match key {
            ReferenceKey::Foot => Self::Foot,
            ReferenceKey::Beam => Self::Beam,
            ReferenceKey::Local => Self::Local,
        }
    }
}

/// The simple moving-contact model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SimulationKeys {
    /// Which contact element the simple model has; left out, the condensed one, but the published one where the study makes no laws by contact angle or gives springs that only that one has (`law`, `horizontal_kn_per_m`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub element: Option<ContactElementKey>,
    /// Which normal law drives the published element.
    pub law: LawKey,
    /// Horizontal stiffness, kN/m; left out, the calibrated one is used.
    #[schemars(range(min = 1e3, max = 1e9), extend("x-field" = InputField::HorizontalStiffness.name()))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub horizontal_kn_per_m: Option<f64>,
    /// Number of beam elements of the rail.
    #[schemars(range(min = 2, max = 10000), extend("x-field" = InputField::BeamElements.name()))]
    pub rail_elements: usize,
    /// Penalty stiffness between the wheel's spline and the rail's nodes, kN/m.
    #[schemars(range(min = 1e4, max = 1e12), extend("x-field" = InputField::Penalty.name()))]
    pub contact_penalty_kn_per_m: f64,
    /// Distance between the nodes on the rail's surface that can touch the wheel, mm.
    #[schemars(range(min = 0.01, max = 5.0), extend("x-field" = InputField::NodeSpacing.name()))]
    pub rail_node_spacing_mm: f64,
    /// Matrix of a sliding contact.
    pub sliding_matrix: SlidingMatrixKey,
    /// Number of steps of the integration within each time step of a scenario, all of the same length; 1 is the published element with the published step. Left out, the published element has 16, and the condensed one as many as the contact force and the vibrations of the bodies ask for, up to 64. What half as many change, or twice one, is stated with the run.
    #[schemars(range(min = 1, max = 1000), extend("x-field" = InputField::InnerSteps.name()))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inner_steps: Option<usize>,
    /// In which respects the law may be another's and is used all the same; the terminal and the report say so. Without this, a law of another pair is refused, and one that was not measured against the beam model of the rail.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub law_accepted: Vec<LawAcceptedKey>,
    /// The scenario whose histories are `history.csv` and `solid_history.csv`; left out, the first by name that the solid model can run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<String>,
}

impl Default for SimulationKeys {
    fn default() -> Self {
        Self {
            element: None,
            law: LawKey::Calibrated,
            horizontal_kn_per_m: None,
            rail_elements: 20,
            contact_penalty_kn_per_m: 2e9,
            rail_node_spacing_mm: 0.25,
            sliding_matrix: SlidingMatrixKey::Unsymmetric,
            inner_steps: None,
            law_accepted: Vec::new(),
            scenario: None,
        }
    }
}

/// Which normal law drives the simple model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LawKey {
    /// The law that the study calibrates in the published form, `a + b·(f/f0)^c`, with the reference of `calibration.reference`.
    Calibrated,
    /// The same calibration as a power and a linear spring in series.
    Series,
    /// The same as two powers with a step of the stiffness between, for a contact that begins to bear in a wider or in a second region.
    Steps,
    /// The same as a monotone table of its tangents, which follows a contact that no formula does.
    Table,
    /// The published constants (30000 kN/m, 294000 kN/m, 0.241104).
    Published,
}

impl LawKey {
    /// The form of the calibrated law that it takes; none of the published constants.
    pub fn form(self) -> Option<Form> {
        match self {
            Self::Calibrated => Some(Form::Power),
            Self::Series => Some(Form::Series),
            Self::Steps => Some(Form::Steps),
            Self::Table => Some(Form::Table),
            Self::Published => None,
        }
    }
}

/// In which respect a law may be another's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LawAcceptedKey {
    /// Calibrated for another pair of rail and wheel.
    AnotherPair,
    /// Measured against another reference than the beam model of the rail.
    AnotherReference,
}

/// Contact element of the simple model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ContactElementKey {
    /// The condensed solids: the law at each contact along its normal, an elastic wheel, the flexibility of the rail's head.
    Condensed,
    /// The same as bodies and bushings that other programs can have: a hub with some oscillators, a bushing between head and rail, and a contact of independent strips.
    Lumped,
    /// The published one: springs of the law and of the horizontal stiffness at the wheel centre.
    #[default]
    Published,
}

impl ContactElementKey {
    /// All of them, in the order of files and figures.
    pub const ALL: [Self; 3] = [Self::Condensed, Self::Lumped, Self::Published];

    /// Its name in files and figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Condensed => "condensed",
            Self::Lumped => "lumped",
            Self::Published => "published",
        }
    }

    /// Those that this one is not.
    pub fn others(self) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |other| *other != self)
    }
}

/// Matrix of a sliding contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SlidingMatrixKey {
    /// Equation (3): consistent, not symmetric.
    Unsymmetric,
    /// Equation (4): approximate, symmetric, with the same forces. It converges only while a step slides by less than the
    /// penetration, and steps that it does not end are done with equation (3).
    Symmetric,
}
