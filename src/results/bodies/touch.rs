//! Where wheel and rail first touch, and Hertz there.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where wheel and rail first touch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TouchRecord {
    /// Touching point on the rail, rail profile frame, mm.
    pub rail_y_mm: f64,
    /// See `rail_y_mm`.
    pub rail_z_mm: f64,
    /// Touching point on the wheel, wheel profile frame, mm.
    pub wheel_y_mm: f64,
    /// See `wheel_y_mm`.
    pub wheel_z_mm: f64,
    /// Contact angle, degrees.
    pub angle_deg: f64,
    /// Hertz tangent stiffness at 1 kN for the curvatures there, kN/m; it grows with the cube root of the load.
    #[serde(deserialize_with = "null_as_infinite")]
    pub hertz_kn_per_m: f64,
    /// Hertz's patch at 1 kN for the same curvatures; none where they have none, as in a hollow that is as round as what lies in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hertz: Option<HertzRecord>,
    /// Radius of the rail across, mm (negative: hollow; `null`: straight).
    #[serde(deserialize_with = "null_as_infinite")]
    pub rail_radius_mm: f64,
    /// Radius of the wheel profile across, mm (negative: hollow; `null`: straight).
    #[serde(deserialize_with = "null_as_infinite")]
    pub wheel_radius_mm: f64,
    /// Rolling radius of the wheel, mm.
    pub rolling_radius_mm: f64,
}

/// Hertz's patch at 1 kN; all of it grows with the cube root of the load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HertzRecord {
    /// Semi-axis along the track, mm.
    pub semi_axis_along_mm: f64,
    /// Semi-axis across, mm.
    pub semi_axis_across_mm: f64,
    /// Largest pressure, MPa.
    pub max_pressure_mpa: f64,
}

impl HertzRecord {
    /// The patch under another load, kN.
    pub fn at(self, force_kn: f64) -> Self {
        let grown = force_kn.cbrt();
        Self {
            semi_axis_along_mm: self.semi_axis_along_mm * grown,
            semi_axis_across_mm: self.semi_axis_across_mm * grown,
            max_pressure_mpa: self.max_pressure_mpa * grown,
        }
    }
}

/// JSON has no infinity and writes `null` in its place.
fn null_as_infinite<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}
