//! The sections `[rail]` and `[bridge]` of a track study.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The rail and what carries it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RailKeys {
    /// Whether the rail does not move at all; the other keys are then left out.
    #[serde(default)]
    pub rigid: bool,
    /// Length, m.
    #[serde(default)]
    #[schemars(range(min = 1e-3, max = 1e6))]
    pub length_m: Option<f64>,
    /// Number of elements, all as long; rigid supports, and the ends of a bridge, lie at their nodes.
    #[serde(default)]
    #[schemars(range(min = 1, max = 10000))]
    pub elements: Option<usize>,
    /// Section and material; left out for a rail with a `profile`.
    #[serde(default)]
    pub section: Option<SectionKeys>,
    /// A standard rail in the place of `section`, such as 60E1, of steel; its section is analysed, shear included.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub profile: Option<String>,
    /// Damping proportional to stiffness, s.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub stiffness_damping_s: f64,
    /// Damping proportional to mass, 1/s.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e5))]
    pub mass_damping_per_s: f64,
    /// How its first and its last end are held.
    #[serde(default = "free")]
    pub ends: [EndKey; 2],
    /// Supports at places.
    #[serde(default)]
    #[schemars(length(max = 10000))]
    pub support: Vec<SupportKeys>,
    /// Sleepers, or plain pads, at equal distances.
    #[serde(default)]
    pub sleepers: Option<SleeperKeys>,
    /// A Winkler foundation under the whole rail.
    #[serde(default)]
    pub foundation: Option<FoundationKeys>,
}

fn free() -> [EndKey; 2] {
    [EndKey::Free; 2]
}

/// How an end is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EndKey {
    /// Nothing is held.
    Free,
    /// The deflection is held. A roller is the same in the vertical plane.
    Pinned,
    /// Deflection and rotation are held.
    Fixed,
}

/// Section and material of a beam in the vertical plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionKeys {
    /// Modulus of elasticity, GPa.
    #[schemars(range(min = 1e-3, max = 1e4))]
    pub young_gpa: f64,
    /// Second moment of area, m⁴.
    #[schemars(range(min = 1e-12, max = 1e6))]
    pub inertia_m4: f64,
    /// Mass a metre, kg/m.
    #[schemars(range(min = 1e-3, max = 1e8))]
    pub mass_kg_per_m: f64,
    /// Area that bears shear κ·A, m²; left out, the beam has no shear flexibility.
    #[serde(default)]
    #[schemars(range(min = 1e-8, max = 1e5))]
    pub shear_area_m2: Option<f64>,
    /// Poisson's ratio, for the shear modulus.
    #[serde(default = "poisson")]
    #[schemars(range(min = 0.0, max = 0.499))]
    pub poisson: f64,
    /// Rotary inertia ρ·I a metre, kg·m; left out, none.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e8))]
    pub rotary_kg_m: f64,
}

fn poisson() -> f64 {
    0.3
}

/// A support at a place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportKeys {
    /// Place, m from the rail's first end.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub x_m: f64,
    /// What it holds.
    pub kind: SupportKey,
    /// Stiffness of a `spring`, kN/m.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub stiffness_kn_per_m: Option<f64>,
    /// Damping of a `spring`, kN·s/m.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub damping_kn_s_per_m: Option<f64>,
    /// Stiffness of a `spring` against rotation, kN·m/rad.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub rotation_kn_m_per_rad: Option<f64>,
}

/// What a support holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SupportKey {
    /// Deflection and rotation.
    Fixed,
    /// The deflection.
    Pinned,
    /// The deflection; in the vertical plane as `pinned`.
    Roller,
    /// Nothing rigidly: a spring and a damper.
    Spring,
}

/// Sleepers at equal distances, each with a pad, and a mass on ballast; on a bridge they stand on it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SleeperKeys {
    /// Place of the first, m from the rail's first end.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub first_m: f64,
    /// Distance, m.
    #[schemars(range(min = 0.01, max = 1e4))]
    pub spacing_m: f64,
    /// No sleeper lies beyond this place, m; left out, the rail's last end.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub last_m: Option<f64>,
    /// Stiffness of the pad, kN/m.
    #[schemars(range(min = 1e-3, max = 1e12))]
    pub pad_stiffness_kn_per_m: f64,
    /// Damping of the pad, kN·s/m.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub pad_damping_kn_s_per_m: f64,
    /// Mass of the sleeper under one rail, kg; left out, the pad stands on the ground or the bridge.
    #[serde(default)]
    #[schemars(range(min = 1e-3, max = 1e6))]
    pub mass_kg: Option<f64>,
    /// Stiffness of the ballast, kN/m; with a mass alone.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub ballast_stiffness_kn_per_m: Option<f64>,
    /// Damping of the ballast, kN·s/m.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub ballast_damping_kn_s_per_m: Option<f64>,
}

/// A Winkler foundation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FoundationKeys {
    /// Stiffness a metre of rail, kN/m².
    #[schemars(range(min = 1e-3, max = 1e12))]
    pub stiffness_kn_per_m2: f64,
    /// Damping a metre of rail, kN·s/m².
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub damping_kn_s_per_m2: f64,
}

/// A bridge under the rail; half of it under each rail of a wheelset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BridgeKeys {
    /// Its first end, m from the rail's first end.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub from_m: f64,
    /// Its last end, m from the rail's first end.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub to_m: f64,
    /// Section and material.
    pub section: SectionKeys,
    /// Damping proportional to stiffness, s.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub stiffness_damping_s: f64,
    /// Damping proportional to mass, 1/s.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e5))]
    pub mass_damping_per_s: f64,
    /// How its first and its last end are held.
    #[serde(default = "pinned")]
    pub ends: [EndKey; 2],
    /// Further supports; their places count from the rail's first end.
    #[serde(default)]
    #[schemars(length(max = 1000))]
    pub support: Vec<SupportKeys>,
}

fn pinned() -> [EndKey; 2] {
    [EndKey::Pinned; 2]
}
