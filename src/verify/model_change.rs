//! What a run is worth: how far it changes with another discretisation of its model.

use railspring_calibrate::history::History;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::change::{Change, least_contact};
use super::contact::ContactDifference;
use super::limits::Limits;
use super::line::milliseconds;
use super::rows_before;

/// How far a run changes with another grid of its contact, other meshes, or other elements of its beam.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelChange {
    /// What the other run has, for instance `contact grid of half the spacing`.
    pub with: String,
    /// Time up to which the runs are compared, s.
    pub until_s: f64,
    /// The change.
    #[serde(flatten)]
    pub change: Change,
    /// That of separations and contact modes.
    #[serde(default)]
    pub contact: ContactDifference,
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
        let (until_s, change, contact) = over_time([run, other], determined_until)?;
        Ok(Self { with: with.into(), until_s, change, contact })
    }
}

/// Up to when two runs are compared (s), and what changes from the first to the second until then.
pub(super) fn over_time(
    [run, other]: [&History; 2],
    determined_until: Option<f64>,
) -> Result<(f64, Change, ContactDifference), String> {
    if let Some(ended) = [run, other].into_iter().find(|run| run.rows.len() < 2) {
        return Err(format!("one of the two runs has no time step: {}", ended.ending));
    }
    let common = run.rows.len().min(other.rows.len());
    let compared = determined_until.map_or(common, |time| common.min(rows_before(run, time)));
    let least = least_contact(run);
    let contact = ContactDifference::between([other, run], compared, least, &Limits::default());
    Ok((run.rows[compared.max(1) - 1].time, Change::between(run, other, 0..compared)?, contact))
}

impl std::fmt::Display for ModelChange {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { with, change, until_s, .. } = self;
        write!(f, "with {with} {change} up to {}", milliseconds(*until_s))
    }
}
