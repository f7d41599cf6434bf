//! The sections `scenario.NAME`.

use railspring_profiles::field::InputField;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::function::{HarmonicForceKeys, HarmonicMomentKeys, TableKeys};

/// A load case on one wheel. It begins without load, where the wheel just touches the rail. A force on the suspended mass arrives as its spring is compressed; a lateral force acts at once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioKeys {
    /// What happens, in a sentence; shown in the report.
    #[serde(default)]
    pub description: String,
    /// Number of time steps after the initial state.
    #[serde(default = "default_steps")]
    #[schemars(range(min = 1, max = 1000000), extend("x-field" = InputField::Steps.name()))]
    pub steps: usize,
    /// Time step, s; the wheel on the contact spring oscillates at 100 to 300 Hz, which 0.0005 s resolves and 0.01 s no longer.
    #[serde(default = "default_time_step")]
    #[schemars(range(min = 1e-7, max = 0.01), extend("x-field" = InputField::TimeStep.name()))]
    pub time_step_s: f64,
    /// Gravity on the wheel and the suspended mass, m/s²; 0 leaves it out.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 20.0), extend("x-field" = InputField::Gravity.name()))]
    pub gravity_m_per_s2: f64,
    /// Coulomb friction coefficient; left out, that of `[contact]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 2.0), extend("x-field" = InputField::Friction.name()))]
    pub friction: Option<f64>,
    /// Mass on the vertical spring and damper, t; without one (0) the vertical force acts on the wheel unchanged. Left out, that of the publication, which a notice names.
    #[serde(default = "default_suspended_mass")]
    #[schemars(range(min = 0.0, max = 200.0), extend("x-field" = InputField::SuspendedMass.name()))]
    pub suspended_mass_t: f64,
    /// Mass of the wheel in the simple model, t; left out, that of the solid wheel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 10.0), extend("x-field" = InputField::WheelMass.name()))]
    pub wheel_mass_t: Option<f64>,
    /// Vertical spring and damper between the wheel centre and the suspended mass; left out, those of the publication, 1200 kN/m and 40 kN·s/m.
    #[serde(default = "default_suspension")]
    pub vertical_suspension: SuspensionKeys,
    /// Lateral spring and damper between the wheel centre and the point where the lateral force acts. That point has no
    /// mass, so that the wheel receives the force unchanged; they give the travel of the point, `load_y_mm` in the histories. Left out, those of the publication.
    #[serde(default = "default_suspension")]
    pub lateral_suspension: SuspensionKeys,
    /// Force on the suspended mass, positive down.
    #[schemars(extend("x-field" = InputField::VerticalForce.name()))]
    pub vertical_force: ForceKeys,
    /// Lateral force, positive towards the field side: it pushes the flange towards the rail.
    #[schemars(extend("x-field" = InputField::LateralForce.name()))]
    pub lateral_force: ForceKeys,
    /// Torsion about x at the middle of the rail.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-field" = InputField::RailTorsion.name()))]
    pub rail_torsion: Option<TorsionKeys>,
    /// Position of the wheel at t = 0 from the rail's first end, m; left out, midspan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 20.0), extend("x-field" = InputField::StartX.name()))]
    pub start_x_m: Option<f64>,
    /// Speed of the wheel along the rail, m/s. A run of the simple model ends where the rail does, and a note says so.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 200.0), extend("x-field" = InputField::Speed.name()))]
    pub speed_m_per_s: f64,
    /// Largest size of Q/P that is accepted, by EN 14363:2016: of the forces below 20 Hz, averaged over 2 m of track, the 0.15 and 99.85 % percentiles; left out, nothing is checked. It is not defined for a wheel that stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100.0))]
    pub ratio_limit: Option<f64>,
    /// Whether the rotations of the wheel's master node are held. Where they are not, the axle holds its roll: a beam of the bore's diameter between the two wheels, of which the other one stands.
    #[serde(default = "default_true")]
    pub rotations_held: bool,
    /// Whether the solid model runs too. A wheel that moves must then stay on the part of the rail that the solids know: as far from both ends as the contact grid is long on either side, and an element more.
    #[serde(default = "default_true")]
    #[schemars(extend("x-field" = InputField::SolidModel.name()))]
    pub solid: bool,
    /// Times at which the report draws the contact positions on the two profiles, s.
    #[serde(default = "default_snapshots")]
    #[schemars(inner(range(min = 0.0, max = 1e6)), length(min = 1, max = 6))]
    pub snapshots_s: Vec<f64>,
}

fn default_steps() -> usize {
    550
}

fn default_time_step() -> f64 {
    0.0005
}

fn default_suspended_mass() -> f64 {
    6.25
}

fn default_suspension() -> SuspensionKeys {
    SuspensionKeys { stiffness_kn_per_m: 1200.0, damping_kn_s_per_m: 40.0 }
}

fn default_true() -> bool {
    true
}

fn default_snapshots() -> Vec<f64> {
    vec![0.0, 0.01, 0.2]
}

/// Spring and damper in parallel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SuspensionKeys {
    /// Stiffness, kN/m.
    #[schemars(range(min = 0.0, max = 1e9), extend("x-field" = "{section}.stiffness"))]
    pub stiffness_kn_per_m: f64,
    /// Damping, kN·s/m.
    #[schemars(range(min = 0.0, max = 1e9), extend("x-field" = "{section}.damping"))]
    pub damping_kn_s_per_m: f64,
}

/// A force `mean + amplitude·sin(2π·frequency·t + phase)`, with further sines and a table if they are given; all are added up.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ForceKeys {
    /// Mean value, kN.
    #[schemars(range(min = -1e4, max = 1e4))]
    pub mean_kn: f64,
    /// Amplitude, kN; negative turns the sine over.
    #[schemars(range(min = -1e4, max = 1e4))]
    pub amplitude_kn: f64,
    /// Frequency, Hz.
    #[schemars(range(min = 0.0, max = 1e5))]
    pub frequency_hz: f64,
    /// Phase, degrees.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub phase_deg: f64,
    /// Further sines.
    #[schemars(length(max = 1000))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub harmonics: Vec<HarmonicForceKeys>,
    /// A table over time, kN, such as a record: it reaches over all time steps, which are as short as its samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<TableKeys>,
}

/// A torsion `mean + amplitude·sin(2π·frequency·t + phase)`, with further sines and a table if they are given; all are added up.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TorsionKeys {
    /// Mean value, kN·m.
    #[schemars(range(min = -1e4, max = 1e4))]
    pub mean_kn_m: f64,
    /// Amplitude, kN·m; negative turns the sine over.
    #[schemars(range(min = -1e4, max = 1e4))]
    pub amplitude_kn_m: f64,
    /// Frequency, Hz.
    #[schemars(range(min = 0.0, max = 1e5))]
    pub frequency_hz: f64,
    /// Phase, degrees.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub phase_deg: f64,
    /// Further sines.
    #[schemars(length(max = 1000))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub harmonics: Vec<HarmonicMomentKeys>,
    /// A table over time, kN·m, such as a record: it reaches over all time steps, which are as short as its samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<TableKeys>,
}
