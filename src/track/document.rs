//! A track study as it is in its TOML file.

mod excitation;
mod rail;
mod wheel;
mod probe;
mod lateral;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::document::TableKeys;

pub use excitation::{
    ForceKeys, GroundKeys, HarmonicAccelerationKeys, IrregularityKey, IrregularityKeys, MomentKeys, SideKey,
    UnevenKey,
};
pub use lateral::{LateralFoundationKeys, LateralKeys, LateralSleeperKeys, RailTorsionKeys};
pub use probe::{OnKey, ProbeKeys, ProbeSideKey};
pub use rail::{
    BridgeKeys, EndKey, FoundationKeys, RailKeys, SectionKeys, SleeperKeys, SupportKey, SupportKeys,
};
pub use wheel::{RunningKey, SuspensionKeys, WheelKeys};

/// A load case on a track, in the vertical plane or, with `[lateral]`, across the track as well.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackDocument {
    /// `"track"`: a rail of beams, and wheels with a given law; without profiles and solids.
    pub kind: KindKey,
    /// Short name of the study; names the output folder. Letters, digits, `-`, `_` and `.`.
    #[schemars(length(min = 1, max = 80))]
    pub name: String,
    /// What the study is about, in a sentence or two; shown on its page.
    #[serde(default)]
    pub description: String,
    /// The rail and what carries it.
    pub rail: RailKeys,
    /// A bridge under the rail, with the pads of `[rail.sleepers]` between.
    #[serde(default)]
    pub bridge: Option<BridgeKeys>,
    /// What runs on the rail.
    pub wheel: WheelKeys,
    /// Profiles and what else a wheelset across the track has; left out, all motion is in the vertical plane.
    #[serde(default)]
    pub lateral: Option<LateralKeys>,
    /// The law between wheel and rail.
    #[serde(default)]
    pub contact: ContactKeys,
    /// Forces, ground motion and irregularities.
    #[serde(default)]
    pub excitation: ExcitationKeys,
    /// Steps, speed and start.
    pub run: RunKeys,
    /// Places with columns in the history.
    #[serde(default)]
    #[schemars(length(max = 100))]
    pub probe: Vec<ProbeKeys>,
}

/// What a study is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum KindKey {
    /// A load case on a track.
    Track,
}

/// The law between hub and rail.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ContactKeys {
    /// Form of the law.
    pub law: LawKey,
    /// Stiffness of a `linear` law, kN/m.
    #[schemars(range(min = 1e-3, max = 1e12))]
    pub stiffness_kn_per_m: Option<f64>,
    /// Constant C of Hertz's law F = C·δ^1.5, GN/m^1.5.
    #[schemars(range(min = 1e-3, max = 1e6))]
    pub hertz_gn_per_m15: Option<f64>,
    /// Constant part a of a `power` law k = a + b·(f/1 kN)^c, kN/m.
    #[schemars(range(min = 0.0, max = 1e12))]
    pub a_kn_per_m: Option<f64>,
    /// Factor b of a `power` law, kN/m.
    #[schemars(range(min = 0.0, max = 1e12))]
    pub b_kn_per_m: Option<f64>,
    /// Exponent c of a `power` law.
    #[schemars(range(min = 0.0, max = 0.999))]
    pub c: Option<f64>,
    /// The `stiffness.json` of a calibration, relative to the study; its law in the form `k = a + b·(f/f0)^c` is taken.
    #[schemars(length(min = 1))]
    pub law_file: Option<String>,
    /// Damper beside the law while the wheel touches, kN·s/m.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub damping_kn_s_per_m: f64,
}

/// Form of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LawKey {
    /// A linear spring.
    Linear,
    /// Hertz's law with a constant.
    Hertz,
    /// Constants of `k = a + b·(f/1 kN)^c`.
    Power,
    /// The published constants (30000 kN/m, 294000 kN/m, 0.241104).
    #[default]
    Published,
    /// That of a calibration.
    File,
}

/// Forces, ground motion and irregularities.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ExcitationKeys {
    /// Force on the suspended mass, on the wheel without one; positive down.
    pub vertical_force: Option<ForceKeys>,
    /// Moment about the track on the same, of a wheelset; positive presses on the right wheel.
    pub roll_moment: Option<MomentKeys>,
    /// Acceleration of the ground with all supports, positive down.
    pub ground_acceleration: Option<GroundKeys>,
    /// With `[lateral]`: force on the suspended mass, on the wheelset without one; positive to the right.
    pub lateral_force: Option<ForceKeys>,
    /// With `[lateral]`: acceleration of the ground with all supports, positive to the right.
    pub lateral_ground_acceleration: Option<GroundKeys>,
    /// With `[lateral]`: moments about the axes of the rails, positive where they tilt the head to the field side.
    #[schemars(length(max = 100))]
    pub rail_torsion: Vec<RailTorsionKeys>,
    /// Heights of the rail along x, and flats of the wheel.
    #[schemars(length(max = 100))]
    pub irregularity: Vec<IrregularityKeys>,
}

/// Steps, speed and start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunKeys {
    /// Number of rows of the history after the first.
    #[schemars(range(min = 1, max = 1000000))]
    pub steps: usize,
    /// Time between rows, s.
    #[schemars(range(min = 1e-8, max = 1.0))]
    pub time_step_s: f64,
    /// Steps of the integration in each row.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 10000))]
    pub inner_steps: usize,
    /// Gravity on what runs, m/s²; the rail's own weight counts as carried already.
    #[serde(default = "gravity")]
    #[schemars(range(min = 0.0, max = 20.0))]
    pub gravity_m_per_s2: f64,
    /// Place of the wheel at t = 0, m from the rail's first end; a wheelset's wheels are beside each other.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub start_x_m: f64,
    /// Speed at t = 0, m/s.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 300.0))]
    pub speed_m_per_s: f64,
    /// Acceleration along the rail, m/s².
    #[serde(default)]
    #[schemars(range(min = -100.0, max = 100.0))]
    pub acceleration_m_per_s2: f64,
    /// Speed over time in the place of the two keys above: times in s, speeds in m/s.
    #[serde(default)]
    pub speed_table: Option<TableKeys>,
    /// How it begins.
    #[serde(default)]
    pub start: StartKey,
    /// Height above the rail of a start `above`, mm; 0 just touches.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e4))]
    pub height_mm: Option<f64>,
    /// Velocity downwards of a start `above`, m/s.
    #[serde(default)]
    #[schemars(range(min = -100.0, max = 100.0))]
    pub velocity_m_per_s: Option<f64>,
    /// Velocity to the right of a start `above`, m/s; with `[lateral]`.
    #[serde(default)]
    #[schemars(range(min = -100.0, max = 100.0))]
    pub lateral_velocity_m_per_s: Option<f64>,
}

fn one() -> usize {
    1
}

fn gravity() -> f64 {
    9.81
}

/// How a run begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StartKey {
    /// At rest, weights and forces in balance with rail and contact.
    #[default]
    Equilibrium,
    /// The wheel above a rail that carries nothing.
    Above,
}
