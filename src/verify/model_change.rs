//! Numerical uncertainty of a run: how far it changes with another discretisation of its model.

use railspring_simulate::time::history::History;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::change::{Change, least_contact};
use super::contact::ContactDifference;
use super::limits::Limits;
use super::line::milliseconds;
use super::series::rows_before;
use super::statistics::{NUMBERS, differences};

/// How far a run changes with another grid of its contact, other meshes, or other elements of its beam.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelChange {
    /// What the other run has, for instance `contact grid of half the spacing`.
    pub with: String,
    /// What changes.
    #[serde(flatten)]
    pub of: RunChange,
}

impl ModelChange {
    /// From a run to that of another model, over the times of both and before the time from which the motion is not determined (s).
    ///
    /// # Errors
    /// How a run ended that has no time step.
    pub fn between(
        [run, other]: [&History; 2],
        with: &str,
        determined_until: Option<f64>,
    ) -> Result<Self, String> {
        Ok(Self { with: with.into(), of: RunChange::between([run, other], determined_until)? })
    }
}

/// How far a run changes with other steps, or another model, where its motion is not determined.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Afterwards {
    /// RMS change of the averaged Q/P; none where it is not defined.
    pub ratio_rms: Option<f64>,
    /// Its largest change.
    pub ratio_max: Option<f64>,
    /// Changes of the statistics, as the verdict compares them: mean, RMS and three quantiles of P, then of Q (N), separations a second, and
    /// the fractions of three contact modes.
    pub statistics: [f64; NUMBERS],
}

impl Afterwards {
    /// From a run to another one, from a row on.
    fn between([run, other]: [&History; 2], first: usize) -> Result<Self, String> {
        let common = run.rows.len().min(other.rows.len());
        let change = Change::between(run, other, first..common)?;
        let statistics = differences([run, other], first..common, &Limits::default());
        Ok(Self { ratio_rms: change.ratio_rms, ratio_max: change.ratio_max, statistics })
    }
}

/// What changes from a run to another one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunChange {
    /// Time up to which the runs are compared step by step, s.
    pub until_s: f64,
    /// The change until then.
    #[serde(flatten)]
    pub change: Change,
    /// That of separations and contact modes.
    #[serde(default)]
    pub contact: ContactDifference,
    /// What changes from the time on from which the motion is not determined, if both runs go on so long.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub afterwards: Option<Afterwards>,
}

impl RunChange {
    /// Over the times of both runs, where the motion is determined until a time (s).
    ///
    /// # Errors
    /// How a run ended that has no time step.
    pub fn between([run, other]: [&History; 2], determined_until: Option<f64>) -> Result<Self, String> {
        if let Some(ended) = [run, other].into_iter().find(|run| run.rows.len() < 2) {
            return Err(format!("one of the two runs has no time step: {}", ended.ending));
        }
        let common = run.rows.len().min(other.rows.len());
        let first = determined_until.map(|time| rows_before(run, time)).filter(|first| *first < common);
        let compared = first.unwrap_or(common);
        let least = least_contact(run);
        let contact = ContactDifference::between([other, run], compared, least, &Limits::default());
        Ok(Self {
            until_s: run.rows[compared.max(1) - 1].time,
            change: Change::between(run, other, 0..compared)?,
            contact,
            afterwards: first.map(|first| Afterwards::between([run, other], first)).transpose()?,
        })
    }
}

impl std::fmt::Display for RunChange {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} up to {}", self.change, milliseconds(self.until_s))
    }
}

impl std::fmt::Display for ModelChange {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "with {} {}", self.with, self.of)
    }
}
