//! The section `[lateral]` of a track study: a wheelset with profiles that moves across the track.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::probe::ProbeSideKey;
use super::wheel::SuspensionKeys;
use crate::study::document::{HarmonicMomentKeys, TableKeys};

/// What a wheelset across the track needs besides: profiles, friction, and what holds the rails across.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LateralKeys {
    /// Profile of the wheels: a standard such as S1002, or the file of a measured one, relative to the study.
    #[schemars(length(min = 1))]
    pub wheel_profile: String,
    /// That of the left wheel; left out, the same.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub left_wheel_profile: Option<String>,
    /// Running surface of the rails: a standard rail, or the file of a measured one; left out, `rail.profile`.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub rail_profile: Option<String>,
    /// That of the left rail; left out, the same.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub left_rail_profile: Option<String>,
    /// Diameter of the wheels at the tape circle, m.
    #[serde(default = "diameter")]
    #[schemars(range(min = 0.1, max = 3.0))]
    pub wheel_diameter_m: f64,
    /// Distance of the gauge faces, mm, measured 14 mm below the top of the rails.
    #[serde(default = "gauge")]
    #[schemars(range(min = 300.0, max = 3000.0))]
    pub gauge_mm: f64,
    /// Distance of the flange backs, mm.
    #[serde(default = "flange_back")]
    #[schemars(range(min = 250.0, max = 3000.0))]
    pub flange_back_mm: f64,
    /// Slope by which the rails lean towards the track centre.
    #[serde(default = "inclination")]
    #[schemars(range(min = -0.2, max = 0.2))]
    pub inclination: f64,
    /// Where the wheelset begins, mm to the right of the middle of the track.
    #[serde(default)]
    #[schemars(range(min = -100.0, max = 100.0))]
    pub lateral_shift_mm: f64,
    /// Coulomb's coefficient of wheel on rail.
    #[serde(default = "friction")]
    #[schemars(range(min = 0.0, max = 2.0))]
    pub friction: f64,
    /// Lateral stiffness between each wheel and its contact, kN/m.
    #[serde(default = "horizontal")]
    #[schemars(range(min = 1e2, max = 1e9))]
    pub horizontal_stiffness_kn_per_m: f64,
    /// Lateral spring and damper of each side under the suspended mass.
    #[serde(default)]
    pub suspension: Option<SuspensionKeys>,
    /// How far the centre of the suspended mass is above the axle, m.
    #[serde(default)]
    #[schemars(range(min = -10.0, max = 10.0))]
    pub suspended_height_m: f64,
    /// What the sleepers of `[rail.sleepers]` hold across the track.
    #[serde(default)]
    pub sleepers: Option<LateralSleeperKeys>,
    /// What the Winkler foundation of `[rail.foundation]` holds across the track.
    #[serde(default)]
    pub foundation: Option<LateralFoundationKeys>,
}

fn diameter() -> f64 {
    0.92
}

fn gauge() -> f64 {
    1435.0
}

fn flange_back() -> f64 {
    1360.0
}

fn inclination() -> f64 {
    0.025
}

fn friction() -> f64 {
    0.3
}

fn horizontal() -> f64 {
    80e3
}

/// What a sleeper holds across the track under one rail; the pad is at the rail's foot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LateralSleeperKeys {
    /// Lateral stiffness of the pad, kN/m.
    #[schemars(range(min = 1e-3, max = 1e12))]
    pub pad_stiffness_kn_per_m: f64,
    /// Lateral damping of the pad, kN·s/m.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub pad_damping_kn_s_per_m: f64,
    /// Stiffness of the pad against rotation about the rail's axis, kN·m/rad.
    #[schemars(range(min = 1e-3, max = 1e12))]
    pub twist_kn_m_per_rad: f64,
    /// Damping of the same, kN·m·s/rad.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub twist_damping_kn_m_s_per_rad: f64,
    /// Lateral stiffness of the ballast, kN/m; with the mass of `[rail.sleepers]` alone.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub ballast_stiffness_kn_per_m: Option<f64>,
    /// Lateral damping of the ballast, kN·s/m.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub ballast_damping_kn_s_per_m: Option<f64>,
}

/// What a Winkler foundation holds across the track, at the rail's foot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LateralFoundationKeys {
    /// Lateral stiffness a metre of rail, kN/m².
    #[schemars(range(min = 1e-3, max = 1e12))]
    pub stiffness_kn_per_m2: f64,
    /// Lateral damping a metre of rail, kN·s/m².
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub damping_kn_s_per_m2: f64,
    /// Stiffness against rotation about the rail's axis, kN·m/rad a metre.
    #[schemars(range(min = 1e-3, max = 1e12))]
    pub twist_kn_m_per_rad_m: f64,
}

/// A moment about the axis of a rail at a place: a mean, sines and a table together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RailTorsionKeys {
    /// Place, m from the rail's first end.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub at_m: f64,
    /// Rail.
    #[serde(default)]
    pub side: ProbeSideKey,
    /// Mean value, kN·m.
    #[serde(default)]
    #[schemars(range(min = -1e5, max = 1e5))]
    pub mean_kn_m: f64,
    /// Sines.
    #[serde(default)]
    #[schemars(length(max = 1000))]
    pub harmonics: Vec<HarmonicMomentKeys>,
    /// A table over time, kN·m.
    #[serde(default)]
    pub table: Option<TableKeys>,
}
