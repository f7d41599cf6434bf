//! What has become of a load case: columns over its rows, how it ended, and what has to be said.

use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;
use railspring_simulate::element::published::Derailment;
use railspring_simulate::track::{AcrossCase, AcrossEnding, AcrossRun, TrackCase, TrackEnding, TrackRun};
use serde::Serialize;

use super::columns::{TrackColumn, columns_of};
use super::lateral_columns::lateral_columns;

/// A derailment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DerailmentRecord {
    /// Which wheel: `right` or `left`.
    pub wheel: &'static str,
    /// How it came off: `climbed`, `lifted` `dropped` or `overturned`.
    pub how: &'static str,
    /// Place of the wheelset, m.
    pub x_m: f64,
}

/// A load case.
#[derive(Debug, Clone)]
pub enum LoadCase {
    /// In the vertical plane.
    InPlane(Box<TrackCase>),
    /// A wheelset across the track.
    Across(Box<AcrossCase>),
}

/// What a run gives.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcome {
    /// Time and place, then all others.
    pub columns: Vec<TrackColumn>,
    pub ending: &'static str,
    /// s.
    pub ended_at: Option<f64>,
    pub derailment: Option<DerailmentRecord>,
    pub unknowns: usize,
    pub notes: Vec<String>,
    /// Why nothing is verified.
    pub unverified: &'static str,
}

/// Why nothing is verified.
const NO_PROFILES: &str =
    "nothing was verified: a load case on a track has no profiles and no solids that could follow it";
const NO_SOLIDS: &str =
    "nothing was verified: a wheelset across the track has no solids that could follow it";

impl Outcome {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns[0].values.len()
    }
}

impl LoadCase {
    /// Runs it.
    pub(super) fn run(&self, monitor: &dyn Monitor) -> Result<Outcome> {
        Ok(match self {
            Self::InPlane(case) => in_plane(case, &case.run(monitor)?),
            Self::Across(case) => across(case, &case.run(monitor)?),
        })
    }
}

/// What a note says of a wheel that is in the air.
fn off_the_rail(which: &str, rows: usize, of: usize) -> Option<String> {
    (rows > 0).then(|| format!("{which} is off the rail in {rows} of {of} rows"))
}

fn at_the_end(time: f64, rows: usize) -> String {
    format!("the wheel came to the end of the rail at {time} s: the history has {} steps", rows - 1)
}

fn in_plane(case: &TrackCase, run: &TrackRun) -> Outcome {
    let (ending, ended_at) = match run.ending {
        TrackEnding::Completed => ("completed", None),
        TrackEnding::RailEnd { time } => ("rail-end", Some(time)),
    };
    let count = run.rows.len();
    let mut notes: Vec<String> = ended_at.map(|time| at_the_end(time, count)).into_iter().collect();
    let wheels = run.rows.first().map_or(0, |row| row.wheels.len());
    for wheel in 0..wheels {
        let flying = run.rows.iter().filter(|row| row.wheels[wheel].approach < 0.0).count();
        let which = match (wheels, wheel) {
            (1, _) => "the wheel",
            (_, 0) => "the right wheel",
            _ => "the left wheel",
        };
        notes.extend(off_the_rail(which, flying, count));
    }
    let columns = columns_of(case, run);
    Outcome {
        columns,
        ending,
        ended_at,
        derailment: None,
        unknowns: run.unknowns,
        notes,
        unverified: NO_PROFILES,
    }
}

const SIDES: [&str; 2] = ["right", "left"];

fn across(case: &AcrossCase, run: &AcrossRun) -> Outcome {
    let count = run.rows.len();
    let mut notes = Vec::new();
    let mut derailment = None;
    let (ending, ended_at) = match run.ending {
        AcrossEnding::Completed => ("completed", None),
        AcrossEnding::RailEnd { time } => {
            notes.push(at_the_end(time, count));
            ("rail-end", Some(time))
        }
        AcrossEnding::Derailed { time, wheel, how } => {
            let x_m = case.way.x(time);
            let (how, what) = match how {
                Derailment::Climbed => ("climbed", "its flange climbed over the rail"),
                Derailment::Lifted => ("lifted", "lifted, its flange went over the rail in the air"),
                Derailment::Overturned => {
                    ("overturned", "raised until the wheelset turned over on the other rail")
                }
                Derailment::Dropped => ("dropped", "its tread slid off the rail into the track"),
            };
            let wheel = SIDES[wheel];
            notes.push(format!(
                "the wheelset derailed at {time:.6} s, x = {x_m:.3} m: the {wheel} wheel, {what}; the history has {} steps",
                count - 1
            ));
            derailment = Some(DerailmentRecord { wheel, how, x_m });
            ("derailed", Some(time))
        }
        AcrossEnding::EndOfProfile { time, wheel } => {
            notes.push(format!(
                "the contact of the {} wheel came to the end of the rail's profile at {time:.6} s, with the wheel still on the rail; the history has {} steps",
                SIDES[wheel],
                count - 1
            ));
            ("rail-profile-end", Some(time))
        }
    };
    for (wheel, side) in SIDES.into_iter().enumerate() {
        let flying = run.rows.iter().filter(|row| row.wheels[wheel].contact.contacts.is_empty()).count();
        notes.extend(off_the_rail(&format!("the {side} wheel"), flying, count));
    }
    if run.work.with_last_limits > 0 {
        notes.push(format!(
            "{} of {} steps of the integration were short ones with the friction limits of the step before",
            run.work.with_last_limits, run.work.steps
        ));
    }
    Outcome {
        columns: lateral_columns(case, run),
        ending,
        ended_at,
        derailment,
        unknowns: run.unknowns,
        notes,
        unverified: NO_SOLIDS,
    }
}
