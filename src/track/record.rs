//! `track.json`: what a run was made from, how it ended, and its largest values.

use serde::Serialize;
use serde_json::Value;

use super::columns::{TrackColumn, of_wheels};
use super::outcome::{DerailmentRecord, Outcome};
use super::resolve::{FittedLaw, TrackStudy};
use crate::study::tables::FileRecord;
use crate::version;

/// The record of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrackRecord {
    /// Version of the program.
    pub version: &'static str,
    /// Its commit.
    pub commit: &'static str,
    /// Name of the study.
    pub study: String,
    /// Its description.
    pub description: String,
    /// BLAKE3 hash of its file, without the options beside it.
    pub study_blake3: String,
    /// All its keys, with the defaults.
    pub keys: Value,
    /// The files that it reads.
    pub files: Vec<FileRecord>,
    /// Unknowns of the model.
    pub unknowns: usize,
    /// Rows of the history.
    pub rows: usize,
    /// How it ended: `completed`, `rail-end`, `derailed` or `rail-profile-end`.
    pub ending: &'static str,
    /// When it ended early, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ended_at_s: Option<f64>,
    /// How a wheelset derailed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub derailment: Option<DerailmentRecord>,
    /// What was verified.
    pub verification: Verification,
    /// Smallest and largest value of each column.
    pub figures: Vec<Figures>,
    /// What has to be said.
    pub notes: Vec<String>,
}

/// What was verified of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verification {
    /// Nothing.
    pub verified: bool,
    /// Why.
    pub reason: &'static str,
}

/// Smallest and largest value of a column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// The column.
    pub column: String,
    /// What it means.
    pub text: String,
    /// Its smallest value.
    pub smallest: Extreme,
    /// Its largest value.
    pub largest: Extreme,
}

/// A value with the time and the place of the wheel at which it stands first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extreme {
    /// The value, in the unit of its column.
    pub value: f64,
    /// Time, s.
    pub time_s: f64,
    /// Place of the wheel, m.
    pub x_m: f64,
}

/// The record of a study's run.
pub(super) fn record(study: &TrackStudy, outcome: &Outcome) -> TrackRecord {
    let columns = &outcome.columns;
    TrackRecord {
        version: env!("CARGO_PKG_VERSION"),
        commit: version::COMMIT,
        study: study.document.name.clone(),
        description: study.document.description.clone(),
        study_blake3: study.source.hash().into(),
        keys: study.keys(),
        files: study.files.clone(),
        unknowns: outcome.unknowns,
        rows: outcome.rows(),
        ending: outcome.ending,
        ended_at_s: outcome.ended_at,
        derailment: outcome.derailment.clone(),
        verification: Verification { verified: false, reason: outcome.unverified },
        figures: columns[2..].iter().filter_map(|column| figures(column, columns)).collect(),
        notes: study
            .law
            .iter()
            .map(|law| range(law, columns))
            .chain(study.notes.iter().cloned())
            .chain(outcome.notes.iter().cloned())
            .collect(),
    }
}

/// Where a law was fitted, and how far the vertical forces leave that.
fn range(law: &FittedLaw, columns: &[TrackColumn]) -> String {
    let FittedLaw { file, range_kn: [least, most] } = law;
    let forces = of_wheels(columns, "p_kn").into_iter();
    // a wheel in the air has no force
    let loaded = forces.flat_map(|column| column.values.iter().copied()).filter(|force| *force > 0.0);
    let [low, high] =
        loaded.fold([f64::INFINITY, 0.0], |[low, high], force| [force.min(low), force.max(high)]);
    if low < *least || high > *most {
        return format!(
            "P from {low:.3} to {high:.3} kN leaves the range of the law of {file}, {least} to {most} kN: beyond, it is extrapolated"
        );
    }
    format!("the law of {file} was fitted from {least} to {most} kN, which P does not leave")
}

/// The extremes of a column; none of one without values.
fn figures(column: &TrackColumn, columns: &[TrackColumn]) -> Option<Figures> {
    let all = || column.values.iter().copied().enumerate().filter(|(_, value)| value.is_finite());
    let of = |better: fn(f64, f64) -> bool| {
        let found = all().reduce(|best, next| if better(next.1, best.1) { next } else { best });
        let at = |row: usize| (columns[0].values[row], columns[1].values[row]);
        found.map(|(row, value)| Extreme { value, time_s: at(row).0, x_m: at(row).1 })
    };
    Some(Figures {
        column: column.name.clone(),
        text: column.text.clone(),
        smallest: of(|a, b| a < b)?,
        largest: of(|a, b| a > b)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: forces beyond those that a law was fitted to are reported, and a wheel in the air has none. Unit: kN.
    #[test]
    fn forces_beyond_the_law_are_said() {
        let law = FittedLaw { file: "a.json".into(), range_kn: [1.0, 150.0] };
        let said = |name: &str, values: &[f64]| {
            let column = TrackColumn { name: name.into(), text: String::new(), values: values.to_vec() };
            range(&law, &[column])
        };
        assert!(said("p_kn", &[0.0, 2.0, 150.0]).contains("which P does not leave"));
        assert!(
            said("left_p_kn", &[0.0, 2.0, 211.6]).contains("P from 2.000 to 211.600 kN leaves the range")
        );
        assert!(said("right_p_kn", &[0.5]).contains("leaves"));
        assert!(said("p_mm", &[500.0]).contains("does not leave"));
    }
}
