//! What uncertain inputs make of a load case on the simple model: the bands over time in `history_uncertain.csv`, and what is noted beside it.

use railspring_profiles::error::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::engine::columns::{Column, columns, csv, properties, schema};
use crate::engine::store::unreadable;
use crate::results::springs::uncertainty_record::UncertainInputRecord;
use crate::rounding::significant;

/// Name of the file, without the load case.
pub const UNCERTAIN: &str = "history_uncertain";
/// The record beside it, as a note.
pub const UNCERTAIN_NOTE: &str = "uncertainty";
/// The quantiles that the file has: the band of 95 %, that of one standard uncertainty, and the median.
pub const QUANTILES: [f64; 5] = [0.025, 0.16, 0.5, 0.84, 0.975];

/// Values at the [`QUANTILES`]; none where too few samples have one.
pub type Quantiles = Option<[f64; 5]>;

/// The band of 95 % of some quantiles.
pub fn band([low, .., high]: [f64; 5]) -> [f64; 2] {
    [low, high]
}

/// The samples at a time step.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainRow {
    /// Time, s.
    pub time: f64,
    /// How many samples have come so far.
    pub samples: f64,
    /// Vertical force, kN.
    pub p: Quantiles,
    /// Lateral force, kN.
    pub q: Quantiles,
    /// Averaged Q/P.
    pub ratio: Quantiles,
    /// Share of the samples without contact.
    pub separated: f64,
}

/// A load case with inputs that are not known exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainRun {
    /// The bands over time.
    pub rows: Vec<UncertainRow>,
    /// What else is known of the samples.
    pub record: UncertainRunRecord,
}

/// What the samples of a load case have, besides the bands over time. All bands are of 95 %, from 2.5 to 97.5 % of the samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UncertainRunRecord {
    /// Contact element that the samples ran with.
    pub element: String,
    /// Quasi-random samples that were tried.
    pub samples: usize,
    /// Those without a run.
    pub failed: usize,
    /// Those whose run ended before its last step; they count as long as they go.
    pub ended_early: usize,
    /// The inputs, in the order of all lists of shares.
    pub inputs: Vec<UncertainInputRecord>,
    /// Half width of the band of P over time, kN.
    pub p_kn: HalfWidthRecord,
    /// The same of Q, kN.
    pub q_kn: HalfWidthRecord,
    /// The same of the averaged Q/P; none where it has no band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub q_over_p: Option<HalfWidthRecord>,
    /// Largest P of a run, kN.
    pub largest_p_kn: ExtremeRecord,
    /// Largest size of Q of a run, kN.
    pub largest_q_kn: ExtremeRecord,
    /// Largest averaged Q/P of a run; none where too few samples have one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_q_over_p: Option<ExtremeRecord>,
    /// Samples in which the wheel separates from the rail.
    pub separating: usize,
    /// Begin of the first separation, s; none where too few samples have one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_separation_s: Option<ExtremeRecord>,
    /// What the samples leave out, a sentence each.
    pub left_out: Vec<String>,
}

/// Half width of a band over the time of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HalfWidthRecord {
    /// Its RMS.
    pub rms: f64,
    /// Its largest.
    pub largest: f64,
}

/// A value that each run has once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExtremeRecord {
    /// That of the run with the inputs as they are taken to be; none where that has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nominal: Option<f64>,
    /// At 2.5, 50 and 97.5 % of the samples.
    pub quantiles: [f64; 3],
    /// Smallest and largest of all samples.
    pub range: [f64; 2],
    /// Share of each input in the variance: its first-order index, from a polynomial in each input; empty where there are too few samples for it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shares: Vec<f64>,
}

impl UncertainRunRecord {
    /// The inputs that change a value most, with their shares: those that have a twentieth of its variance at least, three at most.
    pub fn leading(&self, of: &ExtremeRecord) -> String {
        const LEAST: f64 = 0.05;
        const NAMED: usize = 3;
        let mut ranked: Vec<(&str, f64)> =
            self.inputs.iter().map(|input| input.name.as_str()).zip(of.shares.iter().copied()).collect();
        ranked.retain(|(_, share)| *share >= LEAST);
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        let named = ranked.iter().take(NAMED);
        named.map(|(name, share)| format!("{name} {:.0} %", 1e2 * share)).collect::<Vec<_>>().join(", ")
    }

    /// How many samples there are, in words.
    pub fn counts(&self) -> String {
        let mut text = format!("{} quasi-random samples with the {} element", self.samples, self.element);
        for (count, what) in
            [(self.failed, "without a run"), (self.ended_early, "ended before the last step")]
        {
            if count > 0 {
                text += &format!(", {count} {what}");
            }
        }
        text
    }

    /// The values that each run has once, as rows of text: what, nominal, band from and to, the inputs that change it most.
    pub fn extremes(&self) -> Vec<[String; 5]> {
        let row = |what: &str, of: Option<&ExtremeRecord>, scale: f64| {
            let of = of?;
            let text = |value: f64| significant(scale * value, 3);
            let nominal = of.nominal.map_or_else(|| "\u{2013}".into(), text);
            let [low, _, high] = of.quantiles.map(text);
            Some([what.into(), nominal, low, high, self.leading(of)])
        };
        [
            row("largest P, kN", Some(&self.largest_p_kn), 1.0),
            row("largest Q, kN", Some(&self.largest_q_kn), 1.0),
            row("largest averaged Q/P", self.largest_q_over_p.as_ref(), 1.0),
            row("begin of the first separation, ms", self.first_separation_s.as_ref(), 1e3),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// The columns of the file.
fn of_row() -> Vec<Column<UncertainRow>> {
    columns! { UncertainRow:
        "time_s", "Time, s", |row| row.time;
        "samples", "Samples whose run reaches this time", |row| row.samples;
        "p_q025_kn", "Vertical force P, kN: 2.5 % of the samples lie below; none where more than a twentieth of all samples has none, as all quantiles", |row| row.p.map(|of| of[0]);
        "p_q160_kn", "The same: 16 %", |row| row.p.map(|of| of[1]);
        "p_q500_kn", "The same: median", |row| row.p.map(|of| of[2]);
        "p_q840_kn", "The same: 84 %", |row| row.p.map(|of| of[3]);
        "p_q975_kn", "The same: 97.5 %", |row| row.p.map(|of| of[4]);
        "q_q025_kn", "Lateral force Q, kN: 2.5 %", |row| row.q.map(|of| of[0]);
        "q_q160_kn", "The same: 16 %", |row| row.q.map(|of| of[1]);
        "q_q500_kn", "The same: median", |row| row.q.map(|of| of[2]);
        "q_q840_kn", "The same: 84 %", |row| row.q.map(|of| of[3]);
        "q_q975_kn", "The same: 97.5 %", |row| row.q.map(|of| of[4]);
        "q_over_p_q025", "Q/P averaged as in the verdict: 2.5 %", |row| row.ratio.map(|of| of[0]);
        "q_over_p_q160", "The same: 16 %", |row| row.ratio.map(|of| of[1]);
        "q_over_p_q500", "The same: median", |row| row.ratio.map(|of| of[2]);
        "q_over_p_q840", "The same: 84 %", |row| row.ratio.map(|of| of[3]);
        "q_over_p_q975", "The same: 97.5 %", |row| row.ratio.map(|of| of[4]);
        "separated_share", "Share of these samples without contact", |row| row.separated;
    }
}

/// The JSON schema of a row.
pub fn row_schema() -> Value {
    let text = "One row of the bands by uncertain inputs: a time step, its quantiles over the samples.";
    schema("UncertainRow", text, &properties(&of_row()))
}

/// The file's bytes.
pub fn write(rows: &[UncertainRow]) -> Vec<u8> {
    csv(&of_row(), rows)
}

/// Reads the file back.
///
/// # Errors
/// [`InputError`](railspring_profiles::error::InputError) with the `name` of the file, if it has another content.
pub fn read(name: &str, text: &str) -> Result<Vec<UncertainRow>> {
    let broken = |line: usize, what: &str| unreadable(&format!("{name}:{line}"), what);
    let mut lines = text.lines();
    let heading: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    if !heading.iter().eq(of_row().iter().map(|column| &column.name)) {
        return Err(broken(1, "other columns"));
    }
    let row = |(number, line): (usize, &str)| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = number + 2;
        if cells.len() != heading.len() {
            return Err(broken(number, "another number of cells"));
        }
        let value = |at: usize| -> Result<Option<f64>> {
            let found = cells[at].parse::<f64>().ok().filter(|value| value.is_finite());
            match found {
                None if !cells[at].is_empty() => Err(broken(number, cells[at])),
                found => Ok(found),
            }
        };
        let known = |at: usize| value(at)?.ok_or_else(|| broken(number, "an empty cell"));
        let quantiles = |from: usize| -> Result<Quantiles> {
            let mut all = [0.0; QUANTILES.len()];
            for (at, place) in all.iter_mut().enumerate() {
                let Some(found) = value(from + at)? else { return Ok(None) };
                *place = found;
            }
            Ok(Some(all))
        };
        Ok(UncertainRow {
            time: known(0)?,
            samples: known(1)?,
            p: quantiles(2)?,
            q: quantiles(7)?,
            ratio: quantiles(12)?,
            separated: known(17)?,
        })
    };
    lines.enumerate().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: rows survive the file to the last bit, empty quantiles too; other columns, cells that are no numbers and missing ones are refused with file and line.
    #[test]
    fn rows_survive_the_file() {
        let row = |n: usize| UncertainRow {
            time: n as f64 * 5e-4,
            samples: 64.0 - n as f64,
            p: Some([1.0, 2.0, 3.0, 4.0, 5.0 / 3.0]),
            q: Some([-1e-7; 5]),
            ratio: (n > 0).then_some([0.1, 0.2, 0.3, 0.4, 0.5]),
            separated: 1.0 / 3.0,
        };
        let rows = [row(0), row(1)];
        let text = String::from_utf8(write(&rows)).unwrap();
        assert_eq!(read("x.csv", &text).unwrap(), rows);
        for (from, to, start) in [
            ("p_q025_kn", "p_kn", "x.csv:1 = other columns"),
            ("0.0005,", "soon,", "x.csv:3 = soon"),
            ("0.0005,63", ",63", "x.csv:3 = an empty cell"),
            ("0.0005,63", "63", "x.csv:3 = another number of cells"),
        ] {
            assert!(text.contains(from), "{text}");
            let error = read("x.csv", &text.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(error.starts_with(start), "{error}");
        }
    }
}
