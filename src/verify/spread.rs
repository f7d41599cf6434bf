//! How far a run is determined by its inputs: the same load case with one of them 0.1 % larger.

use railspring_simulate::time::history::{Ending, History, HistoryRow};
use railspring_simulate::time::scenario::Scenario;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::change::{Change, scales};
use super::line::milliseconds;

/// By what share the input of the disturbed run is larger.
pub const DISTURBANCE: f64 = 1e-3;
/// The motion is determined as long as no force changes by more than so many times the disturbance, as a share of its peak. The springs of the
/// simple model may be off by `law_displacement` = 0.03 of the solid, and two models may differ by `vertical_max` = 0.75 at
/// an instant: beyond 0.75/0.03 a model that is as good as its springs cannot be within that limit.
pub const AMPLIFICATION: f64 = 25.0;

/// How far a run changes when an input is 0.1 % larger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Spread {
    /// What the disturbed run has more of.
    pub more_of: String,
    /// By what share.
    pub share: f64,
    /// Time up to which the runs are compared, s.
    pub until_s: f64,
    /// From when on the motion is not determined, s: a force then differs by more than 25 times the share, of its peak; none where it
    /// is determined up to `until_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub determined_until_s: Option<f64>,
    /// The change as long as the motion is determined.
    pub change: Change,
    /// The change from then on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub afterwards: Option<Change>,
}

/// The load case with 0.1 % more lateral force, and what that is more of; without a lateral force, with more of what there is: vertical force, torsion
/// of the rail or gravity; none without any load.
pub fn disturbed(scenario: &Scenario) -> Option<(Scenario, &'static str)> {
    let more = 1.0 + DISTURBANCE;
    let mut other = scenario.clone();
    let what = if scenario.lateral_force.acts() {
        other.lateral_force = other.lateral_force.scaled(more);
        "lateral force"
    } else if scenario.vertical_force.acts() {
        other.vertical_force = other.vertical_force.scaled(more);
        "vertical force"
    } else if let Some(torsion) = scenario.rail_torsion.as_ref().filter(|torsion| torsion.acts()) {
        other.rail_torsion = Some(torsion.clone().scaled(more));
        "torsion of the rail"
    } else if scenario.gravity != 0.0 {
        other.gravity *= more;
        "gravity"
    } else {
        return None;
    };
    Some((other, what))
}

impl Spread {
    /// From a run to the disturbed one, which has 0.1 % more of an input.
    ///
    /// # Errors
    /// How a run ended that has no time step.
    pub fn between(run: &History, other: &History, more_of: &str) -> Result<Self, String> {
        if let Some(ended) = [run, other].into_iter().find(|run| run.rows.len() < 2) {
            return Err(format!("one of the two runs has no time step: {}", ended.ending));
        }
        let common = run.rows.len().min(other.rows.len());
        let end = undetermined_from(run, other);
        let determined = end.unwrap_or(common).min(common);
        let longer = if run.rows.len() < other.rows.len() { other } else { run };
        Ok(Self {
            more_of: more_of.into(),
            share: DISTURBANCE,
            until_s: run.rows[common - 1].time,
            determined_until_s: end.map(|end| longer.rows[end].time),
            change: Change::between(run, other, 0..determined)?,
            afterwards: (determined < common)
                .then(|| Change::between(run, other, determined..common))
                .transpose()?,
        })
    }
}

/// The first row at which a force differs by more than the amplified disturbance. A wheel that has left the rail in one of the runs alone is not
/// determined; of a contact at the end of the surfaces nothing more is known.
fn undetermined_from(run: &History, other: &History) -> Option<usize> {
    let most = scales(run).map(|scale| AMPLIFICATION * DISTURBANCE * scale);
    let beyond = |(a, b): (&HistoryRow, &HistoryRow)| {
        let changes = [b.vertical_force - a.vertical_force, b.lateral_force - a.lateral_force];
        // a change that is no number is beyond
        !changes.iter().zip(&most).all(|(change, most)| change.abs() <= *most)
    };
    let shorter = if run.rows.len() < other.rows.len() { run } else { other };
    let left = run.rows.len() != other.rows.len() && matches!(shorter.ending, Ending::Departed { .. });
    // the initial state is that of both
    let first = run.rows.iter().zip(&other.rows).skip(1).position(beyond).map(|row| row + 1);
    first.or(left.then_some(shorter.rows.len()))
}

impl std::fmt::Display for Spread {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { more_of, share, change, .. } = self;
        write!(f, "with {} % more {more_of} ", 1e2 * share)?;
        match (self.determined_until_s, &self.afterwards) {
            (None, _) => write!(f, "{change} up to {}", milliseconds(self.until_s)),
            (Some(time), afterwards) => {
                let time = milliseconds(time);
                write!(f, "{change} up to {time}; from then on the motion is not determined")?;
                afterwards.as_ref().map_or(Ok(()), |change| write!(f, ", and {change}"))
            }
        }
    }
}
