//! The section `solid`.

use railspring_profiles::field::InputField;
use railspring_simulate::time::steps::{InnerSteps, StepControl};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The solid model in time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SolidKeys {
    /// How many equations of the bodies are solved in a time step.
    pub transient: TransientKey,
    /// Number of modes of each reduced body; left out, as many as it takes until P and Q change by less than 0.3 % of their peaks.
    #[schemars(range(min = 1, max = 1000))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modes: Option<usize>,
    /// Number of steps of the integration within each time step of a scenario, all of the same length. Left out, bodies at full order have one, and reduced bodies as many as the contact force and the vibrations of the bodies ask for, up to 16. With more than one, what half as many change is stated with the run.
    #[schemars(range(min = 1, max = 1000), extend("x-field" = InputField::InnerSteps.name()))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inner_steps: Option<usize>,
}

impl Default for SolidKeys {
    fn default() -> Self {
        Self { transient: TransientKey::Reduced, modes: None, inner_steps: None }
    }
}

impl SolidKeys {
    /// Steps of the integration within each time step of a scenario.
    pub fn steps(&self) -> InnerSteps {
        match (self.inner_steps, self.transient) {
            (Some(count), _) => InnerSteps::Equal(count),
            (None, TransientKey::Full) => InnerSteps::Equal(1),
            (None, TransientKey::Reduced) => InnerSteps::Adaptive(StepControl::DEFAULT),
        }
    }
}

/// How many equations of the bodies are solved in a time step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TransientKey {
    /// The bodies reduced to the motions of their hub, a few modes, and the static compliance of their contact nodes.
    Reduced,
    /// All of them, factored for the time step; what the reduced bodies are compared with.
    Full,
}
