//! What result files say of a study.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One key of a resolved study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ResolvedKey {
    /// Section, for instance `track`; empty for the top level.
    pub section: String,
    /// Key with its unit, for instance `gauge_mm`.
    pub key: String,
    /// The value as text.
    pub value: String,
    /// Whether the file says so itself, or the default applies.
    pub given: bool,
}

/// The pair that a law was calibrated for. The rail's length is no part of it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PairRecord {
    /// The pair in words.
    pub name: String,
    /// Hash of profiles, bodies, their places in the track and the material.
    pub hash: String,
}
