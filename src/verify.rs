//! The verdict: how far the simple model is from the solid model.
//!
//! Both models ran the same load case with the same time steps. Forces are
//! compared step by step over the peak of the solid; the derailment
//! coefficient Q/P is compared as averages over a window of time
//! (publication, equation 16); times without contact are paired by overlap.
//!
//! Beside every difference stands the numerical uncertainty of each model: how far its
//! run changes with steps of another length, and with an input that is 0.1 % larger.
//! Where the latter changes the solid's motion out of proportion, the motion
//! is not determined, and statistics of both runs are compared (`docs/verdict.md`).
//!
//! A line holds only if it has a value. A comparison that cannot be made, as
//! that of the times of separations where there are none, is no line: it is
//! listed with its reason.

mod series;
mod line;
mod limits;
mod signals;
mod change;
mod contact;
mod statistics;
mod en14363;
mod model_change;
mod step_change;
mod spread;
mod model_run;
mod band;
mod pointwise;
mod sampled;

use line::{Check, rounded};
use pointwise::{PartOfRun, Scope};
use railspring_profiles::error::{InputError, Result};
use railspring_simulate::time::energy::EnergyBalance;
use railspring_simulate::time::history::{Ending, History, HistoryRow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use series::peak;
pub(crate) use statistics::quantile;

pub use band::Band;
pub use change::{Change, least_contact};
pub use contact::ContactDifference;
pub use en14363::{Percentiles, RatioAlong, RunningStatistics, WINDOW, accepted, low_passed};
pub use limits::{ChangedLimit, Limits};
pub use line::{Criterion, HeldBy, Kind, Line, NotApplicable};
pub use model_change::{Afterwards, ModelChange, RunChange};
pub use model_run::{ModelRun, NumericalUncertainty};
pub use signals::{
    Both, Carrying, FLANGE_SIDE, ModeFractions, Separation, averaged_ratio, mode_fractions, separations,
    touches_with_flange,
};
pub use spread::{Spread, disturbed};
pub use step_change::StepChange;

/// How far apart the two models are.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The lines.
    pub lines: Vec<Line>,
    /// What could not be compared.
    pub not_applicable: Vec<NotApplicable>,
    /// What was compared.
    pub compared: Compared,
}

/// The quantities that the lines were made from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Compared {
    /// The solid's largest vertical and lateral force, kN, which the differences are divided by.
    pub solid_peak_p_kn: f64,
    /// See `solid_peak_p_kn`.
    pub solid_peak_q_kn: f64,
    /// From when on the motion of the solid is not determined and statistics are compared, s; none where all is compared step by step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pointwise_until_s: Option<f64>,
    /// Times without contact.
    pub separations: Both<Vec<Separation>>,
    /// Fractions of time in each contact mode.
    pub mode_fractions: Both<ModeFractions>,
}

/// How many of the runs do not reach their last step. There is no key for it: the limit is none.
const RUNS_TO_END: Criterion = Criterion {
    quantity: "runs_to_end",
    meaning: "Models whose run ends before the last step",
    kind: Kind::Verification,
    unit: "1",
    limit: 0.0,
};

/// How many loads and preloads of the calibration the springs do not have.
pub const LOADS_LEFT_OUT: Criterion = Criterion {
    quantity: "loads_left_out",
    meaning: "Loads and preloads of the calibration that the springs do not have",
    kind: Kind::Consistency,
    unit: "1",
    limit: 0.0,
};

/// How many things were found in measured profiles and could not be repaired.
pub const PROFILE_FINDINGS: Criterion = Criterion {
    quantity: "profile_findings",
    meaning: "Unresolved findings in measured profiles",
    kind: Kind::Consistency,
    unit: "1",
    limit: 0.0,
};

/// In how many of the runs nothing touches.
const TOUCHES: Criterion = Criterion {
    quantity: "touches",
    meaning: "Models in which the wheel never touches the rail",
    kind: Kind::Verification,
    unit: "1",
    limit: 0.0,
};

/// Lines on the runs of a load case themselves: each reaches its last step, and the wheel touches the rail in each.
/// Without them a load case that compares nothing would pass.
pub fn run_lines(simple: &History, solid: Option<&History>) -> Vec<Line> {
    let runs = [("simple model", Some(simple)), ("solid model", solid)];
    let count = |criterion: Criterion, reason: fn(&History) -> Option<String>| {
        let of = |&(name, run): &(&str, Option<&History>)| Some(format!("{name}: {}", reason(run?)?));
        let reasons: Vec<String> = runs.iter().filter_map(of).collect();
        let line = criterion.line(Some(reasons.len() as f64));
        if reasons.is_empty() { line } else { line.noted(reasons.join("; ")) }
    };
    vec![
        count(RUNS_TO_END, |run| (run.ending != Ending::Completed).then(|| run.ending.to_string())),
        count(TOUCHES, |run| (!touches(run)).then(|| "no contact at any step".into())),
    ]
}

/// Whether any step after the initial state has contact.
fn touches(history: &History) -> bool {
    history.rows.iter().skip(1).any(|row| !row.contacts.is_empty())
}

/// Compares the simple with the solid run: step by step as long as the motion of the solid is determined, and as samples from then on.
/// Where one of them ended early, the steps before that are compared, and the line `runs_to_end` fails.
///
/// # Errors
/// [`InputError`] with key `history` if the two have different time steps.
pub fn compare(simple: &ModelRun<'_>, solid: &ModelRun<'_>, limits: &Limits) -> Result<Comparison> {
    let runs = Both { simple: simple.history, solid: solid.history };
    check_times(runs.simple, runs.solid)?;
    // what is left may be too short for statistics; it then is compared step by step, too
    let undetermined = sampled::begin(simple.history, solid, limits);
    let end = undetermined.map(|row| solid.history.rows[row].time);

    let mut checks: Vec<Check> = run_lines(runs.simple, Some(runs.solid)).into_iter().map(Ok).collect();
    let scope = Scope::new(runs.solid, limits, end);
    checks.extend(scope.checks(simple, solid));
    if let Some(first) = undetermined {
        // averages over a window follow one another longer than the forces do
        let rows = first..runs.simple.rows.len().min(runs.solid.rows.len());
        checks.extend(scope.ratio_lines(simple, solid, rows, PartOfRun::Undetermined).into_iter().map(Ok));
        checks.extend(sampled::lines(simple, solid, limits, first).into_iter().map(Ok));
    }
    checks.push(energy_check(&runs, limits));
    let (mut lines, mut not_applicable) = (Vec::new(), Vec::new());
    for check in checks {
        match check {
            Ok(line) => lines.push(line),
            Err(reason) => not_applicable.push(reason),
        }
    }
    let least = least_contact(runs.solid);
    let [peak_p, peak_q] = change::peaks(runs.solid);
    let compared = Compared {
        solid_peak_p_kn: rounded(peak_p * 1e-3),
        solid_peak_q_kn: rounded(peak_q * 1e-3),
        pointwise_until_s: end.map(rounded),
        separations: runs.map(|run| separations(run, limits.separation_shortest_s, least)),
        mode_fractions: runs.map(|run| mode_fractions(run, least)),
    };
    Ok(Comparison { lines, not_applicable, compared })
}

/// The drift of the energy balance, of the models that have one.
fn energy_check(runs: &Both<&History>, limits: &Limits) -> Check {
    let criterion = limits.energy_drift();
    // the steps that both have
    let rows = runs.simple.rows.len().min(runs.solid.rows.len());
    let drift = |history: &&History| {
        let balances: Option<Vec<EnergyBalance>> =
            history.rows[..rows].iter().map(|row| row.energy).collect();
        let balances = balances.filter(|_| rows > 1)?;
        let most = peak(&balances.iter().map(EnergyBalance::stored).collect::<Vec<_>>());
        let drift = peak(&balances.iter().map(|balance| balance.drift).collect::<Vec<_>>());
        Some(if drift == 0.0 { 0.0 } else { drift / most })
    };
    let drifts = runs.map(drift);
    let both = [drifts.simple, drifts.solid];
    let largest = both.into_iter().flatten().fold(None, |most: Option<f64>, drift| {
        Some(most.map_or(drift, |most| if drift > most || drift.is_nan() { drift } else { most }))
    });
    let Some(largest) = largest else {
        return Err(criterion.not_applicable("neither run has energies"));
    };
    let percent = |drift: Option<f64>| drift.map_or("none".into(), |drift| format!("{:.2} %", 1e2 * drift));
    let note = format!("simple model {}, solid model {}", percent(drifts.simple), percent(drifts.solid));
    Ok(criterion.line(Some(largest)).noted(note))
}

/// A time further from that of the other model than this share of a step belongs to another run.
const OTHER_STEP: f64 = 1e-3;

fn check_times(simple: &History, solid: &History) -> Result<()> {
    let both_complete = simple.ending == Ending::Completed && solid.ending == Ending::Completed;
    let step = simple.rows.iter().zip(simple.rows.iter().skip(1)).map(|(a, b)| b.time - a.time).next();
    let near = |a: &HistoryRow, b: &HistoryRow| (a.time - b.time).abs() <= OTHER_STEP * step.unwrap_or(1.0);
    let same = (simple.rows.len() == solid.rows.len() || !both_complete)
        && !simple.rows.is_empty()
        && !solid.rows.is_empty()
        && simple.rows.iter().zip(&solid.rows).all(|(a, b)| near(a, b));
    if same {
        return Ok(());
    }
    Err(InputError::new(
        "history",
        format!("{} rows of the simple and {} of the solid model", simple.rows.len(), solid.rows.len()),
        "two runs over the same times",
        "run both models again with the same study",
    )
    .into())
}

#[cfg(test)]
mod tests;
