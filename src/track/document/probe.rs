//! The sections `[[probe]]` of a track study.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A place with columns in the history: deflection, moment and acceleration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProbeKeys {
    /// Its name, with which its columns begin: letters, digits and `_`.
    #[schemars(length(min = 1, max = 40))]
    pub name: String,
    /// Place, m from the rail's first end.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub x_m: f64,
    /// Beam.
    #[serde(default)]
    pub on: OnKey,
    /// Rail of a wheelset.
    #[serde(default)]
    pub side: ProbeSideKey,
}

/// Which beam.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OnKey {
    /// The rail.
    #[default]
    Rail,
    /// The bridge.
    Bridge,
}

/// Which rail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ProbeSideKey {
    /// The right one, which a single wheel has.
    #[default]
    Right,
    /// The left one.
    Left,
}
