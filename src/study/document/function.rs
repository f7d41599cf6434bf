//! Values over time: sines, and columns of CSV files.

use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::function::HarmonicForce;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Columns of a CSV file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableKeys {
    /// The file, relative to the study: names of the columns on the first line; lines that begin with `#` are left out.
    #[schemars(length(min = 1))]
    pub file: String,
    /// Name of the column with times (s) or places (m), ascending; left out, the first.
    #[serde(default)]
    pub over_column: Option<String>,
    /// Name of the column with the values.
    #[schemars(length(min = 1))]
    pub column: String,
    /// What a value of the column is multiplied by to give one of the key's unit.
    #[serde(default = "unit")]
    #[schemars(range(min = -1e12, max = 1e12))]
    pub factor: f64,
    /// What lies between the rows.
    #[serde(default)]
    pub between: Interpolation,
}

fn unit() -> f64 {
    1.0
}

/// What lies between the rows of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Samples of something smooth, without gaps. Over time it is taken as linear between them, along the rail as a cubic spline.
    #[default]
    Samples,
    /// Straight lines with corners in the rows, as far apart as they are.
    Corners,
}

/// A sine about a mean value in N or N·m, rad, of kN or kN·m, Hz and degrees.
pub fn sine(mean: f64, amplitude: f64, frequency: f64, phase: f64) -> HarmonicForce {
    HarmonicForce {
        constant: mean * KILONEWTON,
        amplitude: amplitude * KILONEWTON,
        frequency,
        phase: phase.to_radians(),
    }
}

/// A sine of a force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HarmonicForceKeys {
    /// Amplitude, kN.
    #[schemars(range(min = -1e5, max = 1e5))]
    pub amplitude_kn: f64,
    /// Frequency, Hz.
    #[schemars(range(min = 0.0, max = 1e5))]
    pub frequency_hz: f64,
    /// Phase, degrees.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub phase_deg: f64,
}

impl HarmonicForceKeys {
    /// The sine in N or N·m, rad.
    pub fn sine(&self) -> HarmonicForce {
        sine(0.0, self.amplitude_kn, self.frequency_hz, self.phase_deg)
    }
}

/// A sine of a moment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HarmonicMomentKeys {
    /// Amplitude, kN·m.
    #[schemars(range(min = -1e5, max = 1e5))]
    pub amplitude_kn_m: f64,
    /// Frequency, Hz.
    #[schemars(range(min = 0.0, max = 1e5))]
    pub frequency_hz: f64,
    /// Phase, degrees.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub phase_deg: f64,
}

impl HarmonicMomentKeys {
    /// The sine in N or N·m, rad.
    pub fn sine(&self) -> HarmonicForce {
        sine(0.0, self.amplitude_kn_m, self.frequency_hz, self.phase_deg)
    }
}
