//! `measured.json`: time and memory of the stages.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What differs from run to run: time, memory, host. Nothing else in the results does.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Measured {
    /// When the run began, UTC.
    pub begun_utc: String,
    /// Name of the machine.
    pub host: String,
    /// What it has.
    #[serde(default)]
    pub machine: MachineRecord,
    /// Number of threads.
    pub threads: usize,
    /// The stages, in the order in which they ended.
    pub stages: Vec<StageMeasure>,
}

/// The machine that something was measured on.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct MachineRecord {
    /// Model of its processor; none where the system does not say.
    pub processor: Option<String>,
    /// Cores that the program may use.
    pub cores: usize,
    /// Its memory, GiB; none where the system does not say.
    pub memory_gib: Option<f64>,
}

impl Measured {
    /// The measure of a stage.
    pub fn stage(&self, name: &str) -> Option<&StageMeasure> {
        self.stages.iter().find(|stage| stage.stage == name)
    }

    /// Adds a stage, or replaces its earlier measure.
    pub fn note(&mut self, measure: StageMeasure) {
        self.stages.retain(|stage| stage.stage != measure.stage);
        self.stages.push(measure);
    }
}

/// Seconds and memory of one stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StageMeasure {
    /// Name of the stage, for instance `solid model, sine`.
    pub stage: String,
    /// Hash of what the result of the stage was made from.
    pub key: String,
    /// Wall clock, s.
    pub seconds: f64,
    /// Largest resident memory of the process during the stage, MiB; `None` where the system does not say.
    pub peak_memory_mib: Option<f64>,
    /// Whether the result was taken from the store and not made.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub taken: bool,
}
