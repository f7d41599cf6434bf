//! What excites a track study: the section `[excitation]`.

use railspring_simulate::time::function::HarmonicForce;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::document::{HarmonicForceKeys, HarmonicMomentKeys, TableKeys};

/// A force: a mean, sines and a table together.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ForceKeys {
    /// Mean value, kN.
    #[schemars(range(min = -1e5, max = 1e5))]
    pub mean_kn: f64,
    /// Sines.
    #[schemars(length(max = 1000))]
    pub harmonics: Vec<HarmonicForceKeys>,
    /// A table over time, kN.
    pub table: Option<TableKeys>,
}

/// A moment: a mean, sines and a table together.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MomentKeys {
    /// Mean value, kN·m.
    #[schemars(range(min = -1e5, max = 1e5))]
    pub mean_kn_m: f64,
    /// Sines.
    #[schemars(length(max = 1000))]
    pub harmonics: Vec<HarmonicMomentKeys>,
    /// A table over time, kN·m.
    pub table: Option<TableKeys>,
}

/// Acceleration of the ground: sines and a record together.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GroundKeys {
    /// Sines.
    #[schemars(length(max = 1000))]
    pub harmonics: Vec<HarmonicAccelerationKeys>,
    /// A record over time, m/s².
    pub table: Option<TableKeys>,
}

/// A sine of the ground's acceleration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HarmonicAccelerationKeys {
    /// Amplitude, m/s².
    #[schemars(range(min = -1000.0, max = 1000.0))]
    pub amplitude_m_per_s2: f64,
    /// Frequency, Hz.
    #[schemars(range(min = 0.0, max = 1e5))]
    pub frequency_hz: f64,
    /// Phase, degrees.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub phase_deg: f64,
}

impl HarmonicAccelerationKeys {
    /// The sine in m/s², rad.
    pub fn sine(&self) -> HarmonicForce {
        HarmonicForce {
            constant: 0.0,
            amplitude: self.amplitude_m_per_s2,
            frequency: self.frequency_hz,
            phase: self.phase_deg.to_radians(),
        }
    }
}

/// One irregularity of a rail or a wheel. Which keys it has depends on its `kind`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IrregularityKeys {
    /// What it is.
    pub kind: IrregularityKey,
    /// Under which wheel of a wheelset.
    #[serde(default)]
    pub side: SideKey,
    /// Whether the rail is uneven vertically or across the track; the latter with `[lateral]`, as a `table` or a `spectrum`, positive to the right.
    #[serde(default)]
    pub direction: UnevenKey,
    /// `table`: heights over places, mm and m, positive upwards.
    #[serde(default)]
    pub table: Option<TableKeys>,
    /// `spectrum`: A of the one-sided density A·Ωc²/((Ω² + Ωr²)(Ω² + Ωc²)), m²·rad/m.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub amplitude_m2_rad_per_m: Option<f64>,
    /// `spectrum`: Ωc, rad/m.
    #[serde(default)]
    #[schemars(range(min = 1e-6, max = 1e4))]
    pub cutoff_rad_per_m: Option<f64>,
    /// `spectrum`: Ωr, rad/m; left out, 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e4))]
    pub rolloff_rad_per_m: Option<f64>,
    /// `spectrum`: shortest and longest wave, m.
    #[serde(default)]
    #[schemars(inner(range(min = 1e-3, max = 1e5)))]
    pub waves_m: Option<[f64; 2]>,
    /// `spectrum`: number of cosines; left out, 1000.
    #[serde(default)]
    #[schemars(range(min = 10, max = 100000))]
    pub components: Option<usize>,
    /// `spectrum`: seed of the phases; left out, 0.
    #[serde(default)]
    #[schemars(range(min = 0, max = 9007199254740991u64))]
    pub seed: Option<u64>,
    /// `dipped-joint`: its place, m; `wheel-flat`: a place at which the middle of the flat touches, m.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub at_m: Option<f64>,
    /// `dipped-joint`, `wheel-flat`: depth, mm.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 100.0))]
    pub depth_mm: Option<f64>,
    /// `dipped-joint`: length of the dip on both sides together, mm; `wheel-flat`: length of the flat, mm.
    #[serde(default)]
    #[schemars(range(min = 1e-2, max = 1e5))]
    pub length_mm: Option<f64>,
    /// `wheel-flat`: diameter of the wheel, m.
    #[serde(default)]
    #[schemars(range(min = 0.05, max = 5.0))]
    pub diameter_m: Option<f64>,
}

/// What an irregularity is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum IrregularityKey {
    /// Heights over places from a file.
    Table,
    /// Random heights with a power spectral density.
    Spectrum,
    /// A dipped joint: two parabolas that meet in a corner.
    DippedJoint,
    /// A flat of the wheel whose ends are worn round: a period of a cosine.
    WheelFlat,
}

/// In which direction a rail is uneven.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UnevenKey {
    /// Heights, positive up.
    #[default]
    Vertical,
    /// Places across the track, positive to the right.
    Lateral,
}

/// Under which wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SideKey {
    /// Both.
    #[default]
    Both,
    /// The right one.
    Right,
    /// The left one.
    Left,
}
