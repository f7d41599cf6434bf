//! The verdict: how far the simple model is from the solid model.
//!
//! Both models ran the same load case with the same time steps. Forces are
//! compared step by step over the peak of the solid; the derailment
//! coefficient Q/P is compared as averages over a window of time
//! (publication, equation 16); times without contact are paired by overlap.
//!
//! A line holds only if it has a value. A comparison that cannot be made, as
//! that of the times of separations where there are none, is no line: it is
//! listed with its reason.

mod line;
mod limits;
mod signals;
mod step_change;

use railspring_calibrate::energy::EnergyBalance;
use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::history::{Ending, History, HistoryRow};
use serde::{Deserialize, Serialize};

pub use limits::Limits;
pub use line::{Criterion, Kind, Line, NotApplicable};
pub use signals::{Both, ModeFractions, Separation, averaged_ratio, mode_fractions, separations};
pub use step_change::StepChange;

use line::rounded;
use signals::pair_separations;

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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Compared {
    /// The solid's largest vertical and lateral force, kN, which the differences are divided by.
    pub solid_peak_p_kn: f64,
    /// See `solid_peak_p_kn`.
    pub solid_peak_q_kn: f64,
    /// Times without contact.
    pub separations: Both<Vec<Separation>>,
    /// Fractions of time in each contact mode.
    pub mode_fractions: Both<ModeFractions>,
}

/// A check of the verdict: a line, or why the comparison cannot be made.
type Check = std::result::Result<Line, NotApplicable>;

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

/// Compares the simple with the solid run. Where one of them ended early, the steps before that are compared, and
/// the line `runs_to_end` fails.
///
/// # Errors
/// [`InputError`] with key `history` if the two have different time steps.
pub fn compare(simple: &History, solid: &History, limits: &Limits) -> Result<Comparison> {
    check_times(simple, solid)?;
    let runs = common_steps(simple, solid);
    let vertical = runs.map(|run| column(run, |row| row.vertical_force));
    let lateral = runs.map(|run| column(run, |row| row.lateral_force));
    let (peak_p, peak_q) = (peak(&vertical.solid), peak(&lateral.solid));
    let separations = runs.map(|run| separations(run, limits.separation_shortest_s));
    let modes = runs.map(mode_fractions);

    let mut checks: Vec<Check> = run_lines(simple, Some(solid)).into_iter().map(Ok).collect();
    checks.push(departure_check(simple, solid, limits));
    checks.extend(force_lines(&vertical, [limits.vertical_rms(), limits.vertical_max()]).map(Ok));
    checks.extend(force_lines(&lateral, [limits.lateral_rms(), limits.lateral_max()]).map(Ok));
    checks.extend(ratio_lines(&runs, peak_p, limits).map(Ok));
    checks.push(energy_check(&runs, limits));
    checks.extend(separation_checks(&separations, limits));
    checks.extend(mode_lines(&modes, runs.solid.rows.len(), limits).map(Ok));
    let (mut lines, mut not_applicable) = (Vec::new(), Vec::new());
    for check in checks {
        match check {
            Ok(line) => lines.push(line),
            Err(reason) => not_applicable.push(reason),
        }
    }
    let compared = Compared {
        solid_peak_p_kn: rounded(peak_p * 1e-3),
        solid_peak_q_kn: rounded(peak_q * 1e-3),
        separations,
        mode_fractions: modes,
    };
    Ok(Comparison { lines, not_applicable, compared })
}

/// The steps that both models have.
fn common_steps(simple: &History, solid: &History) -> Both<History> {
    let common = simple.rows.len().min(solid.rows.len());
    Both { simple, solid }.map(|run| History {
        rows: run.rows[..common].to_vec(),
        degrees_of_freedom: run.degrees_of_freedom,
        ending: run.ending,
    })
}

/// The times at which the two wheels leave the profile. Both of them have to, to the same side; a single one has failed
/// in [`run_lines`] already, as both have: the times only say whether the models derail alike.
fn departure_check(simple: &History, solid: &History, limits: &Limits) -> Check {
    let criterion = limits.departure_s();
    match (simple.ending, solid.ending) {
        (Ending::Departed { time: a, departure: to }, Ending::Departed { time: b, departure: other }) => {
            let alike = to == other;
            let line = criterion.line(alike.then_some((a - b).abs()));
            Ok(if alike { line } else { line.noted("to different sides") })
        }
        (Ending::EndOfSurface { .. }, _) | (_, Ending::EndOfSurface { .. }) => {
            Err(criterion.not_applicable("a run ended at the end of its model's surfaces"))
        }
        (Ending::Completed, Ending::Completed) => {
            Err(criterion.not_applicable("neither model leaves the profile"))
        }
        _ => Err(criterion.not_applicable("only one model leaves the profile")),
    }
}

/// A comparison needs a step after the initial state.
fn has_steps(rows: usize) -> bool {
    rows > 1
}

/// RMS and largest difference of a force over the solid's peak.
fn force_lines(force: &Both<Vec<f64>>, [rms_limit, max_limit]: [Criterion; 2]) -> [Line; 2] {
    let peak_of_solid = peak(&force.solid);
    let differences: Vec<f64> = force.simple.iter().zip(&force.solid).map(|(a, b)| a - b).collect();
    // Without any force in the solid the two agree only if the simple model has none either;
    // 0/0 counts as 0, and anything else over 0 is infinite and fails.
    let over = |value: f64| if value == 0.0 { 0.0 } else { value / peak_of_solid };
    let value = |value: f64| has_steps(force.solid.len()).then_some(over(value));
    [rms_limit.line(value(rms(&differences))), max_limit.line(value(peak(&differences)))]
}

/// The averaged ratio Q/P, at the steps at which it is defined in both models.
fn ratio_lines(runs: &Both<History>, peak_p: f64, limits: &Limits) -> [Line; 2] {
    let floor = limits.ratio_floor * peak_p;
    let ratios = runs.map(|run| averaged_ratio(run, limits.ratio_window_s, floor));
    let defined = ratios.simple.iter().zip(&ratios.solid).filter_map(|(a, b)| Some((*a)? - (*b)?));
    let (differences, steps): (Vec<f64>, usize) = (defined.collect(), runs.simple.rows.len());
    let line = |criterion: Criterion, measure: fn(&[f64]) -> f64| {
        let line = criterion.line((!differences.is_empty()).then(|| measure(&differences)));
        if differences.len() == steps {
            return line;
        }
        line.noted(format!(
            "both models have an averaged P above {} of the solid's peak at {} of {steps} steps",
            limits.ratio_floor,
            differences.len(),
        ))
    };
    [line(limits.ratio_rms(), rms), line(limits.ratio_max(), peak)]
}

/// The drift of the energy balance, of the models that have one.
fn energy_check(runs: &Both<History>, limits: &Limits) -> Check {
    let criterion = limits.energy_drift();
    let drift = |history: &History| {
        let balances: Option<Vec<EnergyBalance>> = history.rows.iter().map(|row| row.energy).collect();
        let balances = balances.filter(|_| has_steps(history.rows.len()))?;
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

/// Times and number of the separations. Times can be compared only where both models separate.
fn separation_checks(separations: &Both<Vec<Separation>>, limits: &Limits) -> [Check; 3] {
    let (pairs, unmatched) = pair_separations(separations, limits.ratio_window_s);
    let time_check = |criterion: Criterion, time: fn(&Separation) -> f64| {
        let difference = pairs.iter().map(|(a, b)| (time(a) - time(b)).abs()).max_by(f64::total_cmp);
        match difference {
            Some(value) => Ok(criterion.line(Some(value))),
            None if unmatched == 0 => Err(criterion.not_applicable("neither model separates")),
            None => Err(criterion.not_applicable(
                "no separation of one model meets one of the other; each counts as unmatched",
            )),
        }
    };
    [
        time_check(limits.separation_begin_s(), |s| s.begin_s),
        time_check(limits.separation_end_s(), |s| s.end_s),
        Ok(limits.separations_unmatched().line(Some(unmatched as f64))),
    ]
}

/// Fractions of time in each contact mode, over `rows` states.
fn mode_lines(modes: &Both<ModeFractions>, rows: usize, limits: &Limits) -> [Line; 3] {
    type Fraction = fn(&ModeFractions) -> f64;
    let fractions: [(&str, Fraction); 3] = [
        ("Time sticking, difference of the fractions", |m| m.stick),
        ("Time sliding, difference of the fractions", |m| m.slip),
        ("Time separated, difference of the fractions", |m| m.separated),
    ];
    fractions.map(|(meaning, of)| {
        let difference = (of(&modes.simple) - of(&modes.solid)).abs();
        Criterion { meaning, ..limits.mode_fraction() }.line(has_steps(rows).then_some(difference))
    })
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

fn column(history: &History, value: impl Fn(&HistoryRow) -> f64) -> Vec<f64> {
    history.rows.iter().map(value).collect()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Largest magnitude; not a number if any value is not.
fn peak(values: &[f64]) -> f64 {
    let finite_or_nan = |largest: f64, v: &f64| {
        if largest.is_nan() || v.is_nan() { f64::NAN } else { largest.max(v.abs()) }
    };
    values.iter().fold(0.0, finite_or_nan)
}

#[cfg(test)]
mod tests;
