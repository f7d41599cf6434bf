//! `verification.json`: the verdict.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::RunRecord;
use crate::verify::{Compared, Line, NotApplicable};

/// `verification.json`: the verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VerificationRecord {
    /// Name of the study.
    pub study: String,
    /// Whether every line holds.
    pub holds: bool,
    /// Lines on the springs themselves.
    pub calibration: Vec<Line>,
    /// The load cases.
    pub scenarios: Vec<ScenarioVerdict>,
    /// The files that were compared, each with the BLAKE3 hash of its content.
    pub inputs: BTreeMap<String, String>,
    /// Hash of the inputs and the limits.
    pub input_hash: String,
    /// Version of the program that made this.
    pub version: String,
}

/// The verdict on one load case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScenarioVerdict {
    /// Name of the scenario.
    pub scenario: String,
    /// The run of the simple model.
    pub simple: RunRecord,
    /// The run of the solid model, if it ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<RunRecord>,
    /// The lines.
    pub lines: Vec<Line>,
    /// What could not be compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_applicable: Vec<NotApplicable>,
    /// The quantities that were compared, if both models ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compared: Option<Compared>,
}

impl VerificationRecord {
    /// All lines with their subjects: `springs`, then the scenarios.
    pub fn lines(&self) -> impl Iterator<Item = (&str, &Line)> {
        let calibration = self.calibration.iter().map(|line| ("springs", line));
        let scenarios =
            self.scenarios.iter().flat_map(|s| s.lines.iter().map(|line| (s.scenario.as_str(), line)));
        calibration.chain(scenarios)
    }

    /// What could not be compared, with the scenarios.
    pub fn not_applicable(&self) -> impl Iterator<Item = (&str, &NotApplicable)> {
        self.scenarios.iter().flat_map(|s| s.not_applicable.iter().map(|item| (s.scenario.as_str(), item)))
    }

    /// What has to be known about the runs, with the scenarios.
    pub fn notes(&self) -> impl Iterator<Item = (&str, &str)> {
        self.scenarios.iter().flat_map(|s| {
            let springs = s.simple.springs.iter().flat_map(|springs| &springs.notes);
            let solid = s.solid.iter().flat_map(|run| &run.notes);
            springs.chain(&s.simple.notes).chain(solid).map(|note| (s.scenario.as_str(), note.as_str()))
        })
    }

    /// The verdict in a sentence: how many lines fail, and by which line most.
    pub fn summary(&self) -> String {
        let total = self.lines().count();
        let failing: Vec<_> = self.lines().filter(|(_, line)| !line.holds).collect();
        let compared = self.scenarios.iter().filter(|s| s.compared.is_some()).count();
        let scope = match compared {
            0 => "; no load case was compared with the solid model".into(),
            1 => String::new(),
            n => format!("; {n} load cases compared with the solid model"),
        };
        // The first of equals, so that the sentence is the same every time.
        let worst = failing.iter().rev().max_by(|a, b| a.1.excess().total_cmp(&b.1.excess()));
        match worst {
            None => format!("all {total} lines hold{scope}"),
            Some((subject, line)) => format!(
                "{} of {total} lines {}; worst: {subject}: {} {} (limit {}{}){scope}",
                failing.len(),
                if failing.len() == 1 { "fails" } else { "fail" },
                line.meaning,
                with_unit(line.value, &line.unit),
                with_unit(Some(line.limit), &line.unit),
                line.solid_worth.filter(|worth| *worth > line.limit).map_or_else(String::new, |worth| {
                    format!(", the solid model itself {}", with_unit(Some(worth), &line.unit))
                })
            ),
        }
    }
}

/// A value of a line as plain text.
pub fn with_unit(value: Option<f64>, unit: &str) -> String {
    let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
    match value {
        None => "without a value".into(),
        // As many decimals as six digits need; limits are often short.
        Some(value) => format!("{}{unit}", (value * 1e4).round() / 1e4),
    }
}
