//! Uncertainty of springs by their inputs, as `stiffness.json` has it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::rounding::significant;

/// How the uncertainty of the inputs comes out in the springs (JCGM 100 and 101). All changes are relative.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InputUncertaintyRecord {
    /// The inputs, in the order of all lists of inputs below.
    pub inputs: Vec<UncertainInputRecord>,
    /// Quasi-random samples with an answer.
    pub samples: usize,
    /// Samples without one; with more than a twentieth of all there is no sampled band.
    pub failed: usize,
    /// The law's displacement and tangent, and the patch, at some loads.
    pub points: Vec<UncertainPointRecord>,
    /// The horizontal stiffness, to first order; none where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub horizontal: Option<UncertainRecord>,
    /// The constants of the law in use; none without a sampled band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<UncertainLawRecord>,
    /// Why there are none, if so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

/// An input that is not known exactly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UncertainInputRecord {
    /// What it is.
    pub name: String,
    /// The key of the study that gives its uncertainty; none for what the program finds by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// Standard uncertainty, in `unit`; none for what is known by its effect alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub standard: Option<f64>,
    /// Unit of the standard uncertainty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// `normal` or `rectangular`.
    pub distribution: String,
}

/// The springs at a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UncertainPointRecord {
    /// Load, kN.
    pub force_kn: f64,
    /// Displacement by the reference in use.
    pub displacement: UncertainRecord,
    /// Tangent stiffness by the reference in use.
    pub tangent: UncertainRecord,
    /// Area of the patch, to first order.
    pub area: UncertainRecord,
    /// Largest pressure, to first order.
    pub pressure: UncertainRecord,
}

/// The uncertainty of a value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UncertainRecord {
    /// Change over one standard uncertainty of each input, with its sign.
    pub changes: Vec<f64>,
    /// Share of each input in the variance: its first-order index.
    pub shares: Vec<f64>,
    /// Standard uncertainty by the inputs, to first order.
    pub linear: f64,
    /// The same from the samples; none without enough of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampled: Option<f64>,
    /// Changes at 2.5 and 97.5 % of the samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub percentiles: Option<[f64; 2]>,
    /// Half width of the band of 95 % by the inputs: half the way between the percentiles; without samples, between
    /// those to first order.
    pub input: f64,
    /// Half width of the numerical band: grid and meshes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub numerical: Option<f64>,
    /// Both together, √(numerical² + input²); none without the numerical one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub combined: Option<f64>,
}

/// The constants of the law in use over the samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UncertainLawRecord {
    /// Standard deviation of a, kN/m.
    pub a_kn_per_m: f64,
    /// Standard deviation of b, kN/m.
    pub b_kn_per_m: f64,
    /// Standard deviation of c.
    pub c: f64,
    /// Covariance of a, b and c, with a and b in kN/m.
    pub covariance: [[f64; 3]; 3],
}

/// The interval of ascending `loads` that holds a `load`, and the part of the way to its end, over the logarithm of the load: 0 to 1, at the ends beyond them.
pub(crate) fn between_loads(loads: &[f64], load: f64) -> (usize, f64) {
    let below = loads.partition_point(|at| *at < load).clamp(1, loads.len() - 1) - 1;
    let part = (load / loads[below]).ln() / (loads[below + 1] / loads[below]).ln();
    (below, part.clamp(0.0, 1.0))
}

impl UncertainRecord {
    /// Numbers of the inputs, the one that changes the value most first; those that change it by less than a hundredth of the whole are left out.
    pub fn ranked(&self) -> Vec<usize> {
        const LEAST: f64 = 0.01;
        let mut all: Vec<usize> =
            (0..self.changes.len()).filter(|&i| self.changes[i].abs() > LEAST * self.linear).collect();
        all.sort_by(|&a, &b| self.changes[b].abs().total_cmp(&self.changes[a].abs()));
        all
    }

    /// The band of 95 % in words: numbers in per cent.
    pub fn sentence(&self) -> String {
        let percent = |value: f64| significant(1e2 * value, 2);
        match (self.combined, self.numerical) {
            (Some(combined), Some(numerical)) => format!(
                "\u{b1}{} % ({} % of inputs, {} % numerical)",
                percent(combined),
                percent(self.input),
                percent(numerical)
            ),
            _ => format!("\u{b1}{} % of inputs", percent(self.input)),
        }
    }
}

impl InputUncertaintyRecord {
    /// The load in the middle, at which figure and sentences rank the inputs.
    pub fn middle(&self) -> Option<&UncertainPointRecord> {
        self.points.get(self.points.len() / 2)
    }

    /// The uncertainty of the springs, a sentence each.
    pub fn sentences(&self) -> Vec<String> {
        if let Some(reason) = &self.missing {
            return vec![format!("uncertainty of the inputs: not known, {reason}")];
        }
        let Some(point) = self.middle() else { return Vec::new() };
        let leading = |of: &UncertainRecord, count: usize| {
            let named = of.ranked().into_iter().take(count).map(|i| self.inputs[i].name.as_str());
            named.collect::<Vec<_>>().join(", ")
        };
        let mut all = vec![format!(
            "uncertainty (95 %) at {} kN: displacement {}, tangent {}, mostly from {}",
            significant(point.force_kn, 3),
            point.displacement.sentence(),
            point.tangent.sentence(),
            leading(&point.tangent, 3)
        )];
        all.extend(self.horizontal.as_ref().map(|horizontal| {
            let most = leading(horizontal, 1);
            format!("uncertainty (95 %) of k_h: {}, mostly from {most}", horizontal.sentence())
        }));
        all
    }
}
