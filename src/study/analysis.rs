//! What a study computes of its pair, in SI units: contact, laws, the simple model and the load cases.

use railspring_simulate::element::condensed::CondensedModel;
use railspring_simulate::element::published::MovingModel;
use railspring_simulate::time::scenario::Scenario;
use railspring_simulate::time::steps::InnerSteps;
use serde::Serialize;

use super::document::{
    ContactElementKey, EnforcementKey, FieldKey, LawAcceptedKey, LawKey, ReferenceKey, SlidingMatrixKey,
};
use super::tables::FileRecord;

/// Contact between the solids.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ContactSettings {
    /// Where the contact lives.
    pub field: FieldKey,
    /// Exact or penalty.
    pub enforcement: EnforcementKey,
    /// Penalty stiffness, N/m.
    pub penalty: f64,
    /// Coulomb friction coefficient.
    pub friction: f64,
}

/// Loads and reference of the law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationSettings {
    /// The loads, N, ascending.
    pub loads: Vec<f64>,
    /// What the displacement of the law in use is measured against.
    pub reference: ReferenceKey,
    /// Whether there are laws against the held foot as well: the study wants them, or its reference is that.
    pub foot_held: bool,
    /// Whether the laws, those by contact angle too, get their error bands.
    pub error_band: bool,
    /// Preloads of the horizontal stiffness, N, ascending.
    pub horizontal_preloads: Vec<f64>,
    /// Loads along the contact normal at which the laws by contact angle give displacement and tangent, N, ascending.
    pub fixed_loads: Vec<f64>,
}

/// Standard uncertainties of the inputs of the springs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UncertaintySettings {
    /// Quasi-random samples.
    pub samples: usize,
    /// Place of the wheel across the track, m.
    pub lateral: f64,
    /// Track gauge, m.
    pub gauge: f64,
    /// Distance of the flange backs, m.
    pub flange_back: f64,
    /// Inclination of the rail, rad.
    pub inclination: f64,
    /// Turn of the profiles of rail and wheel, rad.
    pub roll: [f64; 2],
    /// Form of the profiles of rail and wheel, m.
    pub form: [f64; 2],
    /// Length of the waves of the form, m.
    pub form_wavelength: f64,
    /// Diameter of the wheel at its tape circle, m.
    pub tape_diameter: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// Young's modulus of each body, relative.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl UncertaintySettings {
    /// Inputs that are known exactly.
    pub const NONE: Self = Self {
        samples: 0,
        lateral: 0.0,
        gauge: 0.0,
        flange_back: 0.0,
        inclination: 0.0,
        roll: [0.0; 2],
        form: [0.0; 2],
        form_wavelength: 1.0,
        tape_diameter: 0.0,
        friction: 0.0,
        young: 0.0,
        poisson: 0.0,
    };
}

/// The simple model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SimulationSettings {
    /// Which contact element it has, if the study says so: [`Study::element`](super::Study::element).
    pub element: Option<ContactElementKey>,
    /// Which normal law drives the published element.
    pub law: LawKey,
    /// Horizontal stiffness, N/m; `None` takes the calibrated one.
    pub horizontal: Option<f64>,
    /// Number of beam elements of the rail.
    pub rail_elements: usize,
    /// Penalty stiffness between spline and nodes, N/m.
    pub contact_penalty: f64,
    /// Distance between the rail's surface nodes, m.
    pub rail_node_spacing: f64,
    /// Matrix of a sliding contact.
    pub sliding_matrix: SlidingMatrixKey,
    /// Steps of the integration within each time step of a scenario, where their number is given: [`SimulationSettings::steps`].
    pub inner_steps: Option<usize>,
    /// In which respects a law may be another's.
    pub law_accepted: Vec<LawAcceptedKey>,
}

impl SimulationSettings {
    /// Steps of the integration with a contact element.
    pub fn steps(&self, element: ContactElementKey) -> InnerSteps {
        match (self.inner_steps, element) {
            (Some(count), _) => InnerSteps::Equal(count),
            (None, ContactElementKey::Published) => MovingModel::STEPS,
            (None, ContactElementKey::Condensed | ContactElementKey::Lumped) => CondensedModel::STEPS,
        }
    }
}

/// One load case of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyScenario {
    /// What happens.
    pub description: String,
    /// The load case itself.
    pub scenario: Scenario,
    /// Whether the solid model runs too.
    pub solid: bool,
    /// Largest size of Q/P over 2 m of track that is accepted.
    pub ratio_limit: Option<f64>,
    /// Times at which the report draws the contact positions, s.
    pub snapshots: Vec<f64>,
    /// The tables of its forces.
    pub tables: Vec<FileRecord>,
    /// What has to be known before it runs: values of the publication that it takes, the end of the rail, loads beyond the calibration.
    pub notes: Vec<String>,
}
