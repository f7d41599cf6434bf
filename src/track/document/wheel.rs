//! The section `[wheel]` of a track study.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What runs on the rail.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WheelKeys {
    /// `wheel` on one rail; `wheelset` on two, which bounces and rolls; `force`, the vertical force itself without a mass.
    #[serde(default)]
    pub kind: RunningKey,
    /// Whether the mirror image of the load case runs: right and left exchanged in irregularities and probes, the roll moment turned over; of a wheelset. With `[lateral]` all that points to the right points to the left.
    #[serde(default)]
    pub mirrored: bool,
    /// Mass of the wheel, or of the wheelset, t.
    #[serde(default)]
    #[schemars(range(min = 1e-6, max = 1000.0))]
    pub mass_t: Option<f64>,
    /// Moment of inertia of a wheelset about the track, t·m².
    #[serde(default)]
    #[schemars(range(min = 1e-6, max = 1e4))]
    pub roll_inertia_t_m2: Option<f64>,
    /// Mass on the suspension, t; 0 for none.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub suspended_mass_t: f64,
    /// Moment of inertia of that mass about the track, t·m²; for a wheelset.
    #[serde(default)]
    #[schemars(range(min = 1e-6, max = 1e5))]
    pub suspended_roll_inertia_t_m2: Option<f64>,
    /// Spring and damper under the mass; of a wheelset on each side.
    #[serde(default)]
    pub suspension: Option<SuspensionKeys>,
    /// Distance between the contacts of a wheelset, m; with `[lateral]` it comes from the profiles.
    #[serde(default = "contact_distance")]
    #[schemars(range(min = 0.3, max = 3.0))]
    pub contact_distance_m: f64,
    /// Distance between the suspensions of a wheelset, m.
    #[serde(default = "suspension_distance")]
    #[schemars(range(min = 0.1, max = 5.0))]
    pub suspension_distance_m: f64,
}

fn contact_distance() -> f64 {
    1.5
}

fn suspension_distance() -> f64 {
    2.0
}

/// What runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RunningKey {
    /// A wheel on one rail.
    #[default]
    Wheel,
    /// Two wheels on an axle and two rails alike.
    Wheelset,
    /// The vertical force.
    Force,
}

/// Spring and damper in parallel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SuspensionKeys {
    /// Stiffness, kN/m.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub stiffness_kn_per_m: f64,
    /// Damping, kN·s/m.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e9))]
    pub damping_kn_s_per_m: f64,
}
