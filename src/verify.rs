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

mod limits;
mod line;
mod signals;

use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::history::{Ending, History, HistoryRow};
use serde::{Deserialize, Serialize};

pub use limits::Limits;
pub use line::{Kind, Line, NotApplicable};
pub use signals::{Both, ModeFractions, Separation, averaged_ratio, mode_fractions, separations};

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

/// Lines on the runs of a load case themselves: each reaches its last step, and the wheel touches the rail in each.
/// Without them a load case that compares nothing would pass.
pub fn run_lines(simple: &History, solid: Option<&History>) -> Vec<Line> {
    let runs = || [("simple model", Some(simple)), ("solid model", solid)];
    let count = |quantity: &str, meaning: &str, reasons: Vec<String>| {
        let line = Line::check(quantity, meaning, Kind::Verification, "1", Some(reasons.len() as f64), 0.0);
        if reasons.is_empty() { line } else { line.noted(reasons.join("; ")) }
    };
    let of = |reason: fn(&History) -> Option<String>| {
        runs().into_iter().filter_map(|(name, run)| Some(format!("{name}: {}", reason(run?)?))).collect()
    };
    vec![
        count(
            "runs_to_end",
            "Models whose run ends before the last step",
            of(|run| (run.ending != Ending::Completed).then(|| run.ending.to_string())),
        ),
        count(
            "touches",
            "Models in which the wheel never touches the rail",
            of(|run| (!touches(run)).then(|| "no contact at any step".into())),
        ),
    ]
}

/// Whether any step after the initial state has contact.
fn touches(history: &History) -> bool {
    history.rows.iter().skip(1).any(|row| !row.contacts.is_empty())
}

/// Compares the simple with the solid run. Where one of them left the profile, the steps before that are compared, and
/// the line `runs_to_end` fails.
///
/// # Errors
/// [`InputError`] with key `history` if the two have different time steps.
pub fn compare(simple: &History, solid: &History, limits: &Limits) -> Result<Comparison> {
    check_times(simple, solid)?;
    let mut lines = run_lines(simple, Some(solid));
    let mut not_applicable = Vec::new();
    let (departures, none_left) = departure_line(simple, solid, limits);
    lines.extend(departures);
    not_applicable.extend(none_left);

    let common = simple.rows.len().min(solid.rows.len());
    let first = |history: &History| History { rows: history.rows[..common].to_vec(), ..history.clone() };
    let (simple, solid) = (&first(simple), &first(solid));
    let p = Both {
        simple: column(simple, |row| row.vertical_force),
        solid: column(solid, |row| row.vertical_force),
    };
    let q = Both {
        simple: column(simple, |row| row.lateral_force),
        solid: column(solid, |row| row.lateral_force),
    };
    let peak_p = peak(&p.solid);
    let peak_q = peak(&q.solid);
    let separations = Both {
        simple: separations(simple, limits.separation_shortest_s),
        solid: separations(solid, limits.separation_shortest_s),
    };
    let modes = Both { simple: mode_fractions(simple), solid: mode_fractions(solid) };

    let line = |quantity: &str, meaning: &str, value: f64, limit: f64| {
        Line::check(quantity, meaning, Kind::Verification, "1", (common > 1).then_some(value), limit)
    };
    // Without any force in the solid the two agree only if the simple model has none either;
    // 0/0 counts as 0, and anything else over 0 is infinite and fails.
    let over = |value: f64, peak: f64| if value == 0.0 { 0.0 } else { value / peak };
    let delta_p = differences(&p);
    let delta_q = differences(&q);
    lines.extend([
        line(
            "vertical_rms",
            "P, RMS difference over the solid's peak",
            over(rms(&delta_p), peak_p),
            limits.vertical_rms,
        ),
        line(
            "vertical_max",
            "P, largest difference over the solid's peak",
            over(peak(&delta_p), peak_p),
            limits.vertical_max,
        ),
        line(
            "lateral_rms",
            "Q, RMS difference over the solid's peak",
            over(rms(&delta_q), peak_q),
            limits.lateral_rms,
        ),
        line(
            "lateral_max",
            "Q, largest difference over the solid's peak",
            over(peak(&delta_q), peak_q),
            limits.lateral_max,
        ),
    ]);
    lines.extend(ratio_lines(simple, solid, peak_p, limits));
    let (times, without) = separation_lines(&separations, limits);
    lines.extend(times);
    not_applicable.extend(without);
    lines.extend([
        line(
            "mode_fraction",
            "Time sticking, difference of the fractions",
            (modes.simple.stick - modes.solid.stick).abs(),
            limits.mode_fraction,
        ),
        line(
            "mode_fraction",
            "Time sliding, difference of the fractions",
            (modes.simple.slip - modes.solid.slip).abs(),
            limits.mode_fraction,
        ),
        line(
            "mode_fraction",
            "Time separated, difference of the fractions",
            (modes.simple.separated - modes.solid.separated).abs(),
            limits.mode_fraction,
        ),
    ]);
    Ok(Comparison {
        lines,
        not_applicable,
        compared: Compared {
            solid_peak_p_kn: rounded(peak_p * 1e-3),
            solid_peak_q_kn: rounded(peak_q * 1e-3),
            separations,
            mode_fractions: modes,
        },
    })
}

/// The times at which the two wheels leave the profile. Both of them have to, to the same side; a single one has failed
/// in [`run_lines`] already, as both have: the times only say whether the models derail alike.
fn departure_line(
    simple: &History,
    solid: &History,
    limits: &Limits,
) -> (Option<Line>, Option<NotApplicable>) {
    const QUANTITY: &str = "departure_s";
    const MEANING: &str = "Wheel leaves the profile, difference of the times";
    match (simple.ending.time(), solid.ending.time()) {
        (Some(a), Some(b)) => {
            let alike = simple.ending.name() == solid.ending.name();
            let value = alike.then_some((a - b).abs());
            let line = Line::check(QUANTITY, MEANING, Kind::Verification, "s", value, limits.departure_s);
            (Some(if alike { line } else { line.noted("to different sides") }), None)
        }
        (None, None) => (None, Some(without(QUANTITY, MEANING, "neither model leaves the profile"))),
        _ => (None, Some(without(QUANTITY, MEANING, "only one model leaves the profile"))),
    }
}

/// The averaged ratio Q/P, at the steps at which it is defined in both models.
fn ratio_lines(simple: &History, solid: &History, peak_p: f64, limits: &Limits) -> [Line; 2] {
    let floor = limits.ratio_floor * peak_p;
    let of = |history: &History| averaged_ratio(history, limits.ratio_window_s, floor);
    let differences: Vec<f64> =
        of(simple).iter().zip(of(solid)).filter_map(|(a, b)| Some((*a)? - b?)).collect();
    let line = |quantity: &str, meaning: &str, measure: fn(&[f64]) -> f64, limit: f64| {
        let value = (!differences.is_empty()).then(|| measure(&differences));
        let line = Line::check(quantity, meaning, Kind::Verification, "1", value, limit);
        if differences.len() == simple.rows.len() {
            return line;
        }
        line.noted(format!(
            "both models have an averaged P above {} of the solid's peak at {} of {} steps",
            limits.ratio_floor,
            differences.len(),
            simple.rows.len()
        ))
    };
    [
        line("ratio_rms", "Averaged Q/P, RMS difference", rms, limits.ratio_rms),
        line("ratio_max", "Averaged Q/P, largest difference", peak, limits.ratio_max),
    ]
}

/// Times and number of the separations. Times can be compared only where both models separate.
fn separation_lines(separations: &Both<Vec<Separation>>, limits: &Limits) -> (Vec<Line>, Vec<NotApplicable>) {
    let (pairs, unmatched) = pair_separations(separations, limits.ratio_window_s);
    let line = |quantity: &str, meaning: &str, unit: &str, value: f64, limit: f64| {
        Line::check(quantity, meaning, Kind::Verification, unit, Some(value), limit)
    };
    let (mut lines, mut not_applicable) = (Vec::new(), Vec::new());
    type Time = fn(&Separation) -> f64;
    let times: [(&str, &str, Time, f64); 2] = [
        (
            "separation_begin_s",
            "Separation begins, largest difference",
            |s| s.begin_s,
            limits.separation_begin_s,
        ),
        ("separation_end_s", "Separation ends, largest difference", |s| s.end_s, limits.separation_end_s),
    ];
    for (quantity, meaning, time, limit) in times {
        match pairs.iter().map(|(a, b)| (time(a) - time(b)).abs()).max_by(f64::total_cmp) {
            Some(value) => lines.push(line(quantity, meaning, "s", value, limit)),
            None if unmatched == 0 => {
                not_applicable.push(without(quantity, meaning, "neither model separates"));
            }
            None => {
                let reason = "no separation of one model meets one of the other; each counts as unmatched";
                not_applicable.push(without(quantity, meaning, reason));
            }
        }
    }
    lines.push(line(
        "separations_unmatched",
        "Separations that only one model has",
        "1",
        unmatched as f64,
        limits.separations_unmatched as f64,
    ));
    (lines, not_applicable)
}

fn without(quantity: &str, meaning: &str, reason: &str) -> NotApplicable {
    NotApplicable { quantity: quantity.into(), meaning: meaning.into(), reason: reason.into() }
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

fn differences(both: &Both<Vec<f64>>) -> Vec<f64> {
    both.simple.iter().zip(&both.solid).map(|(a, b)| a - b).collect()
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
