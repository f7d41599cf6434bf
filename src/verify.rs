//! The verdict: how far the simple model is from the solid model.
//!
//! Both models ran the same load case with the same time steps. Forces are
//! compared step by step over the peak of the solid; the derailment
//! coefficient Q/P is compared as averages over a window of time
//! (publication, equation 16); times without contact are paired by overlap.

use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::history::{ContactMode, History, HistoryRow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Limits of the verdict, as keys of the study. A line fails when its value exceeds its limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// RMS difference of P over the solid's peak of P.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub vertical_rms: f64,
    /// Largest difference of P over the solid's peak of P.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub vertical_max: f64,
    /// RMS difference of Q over the solid's peak of Q.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub lateral_rms: f64,
    /// Largest difference of Q over the solid's peak of Q.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub lateral_max: f64,
    /// RMS difference of the averaged Q/P.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub ratio_rms: f64,
    /// Largest difference of the averaged Q/P.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub ratio_max: f64,
    /// Time over which Q and P are averaged before they are divided, s; 2 m at 300 km/h.
    #[schemars(range(min = 1e-6, max = 1e3))]
    pub ratio_window_s: f64,
    /// Averaged P below this share of the solid's peak of P leaves Q/P undefined.
    #[schemars(range(min = 1e-6, max = 1.0))]
    pub ratio_floor: f64,
    /// Largest difference of the times at which separation begins, s.
    #[schemars(range(min = 0.0, max = 1e3))]
    pub separation_begin_s: f64,
    /// Largest difference of the times at which separation ends, s.
    #[schemars(range(min = 0.0, max = 1e3))]
    pub separation_end_s: f64,
    /// Number of separations that only one of the models has.
    #[schemars(range(min = 0, max = 1000000))]
    pub separations_unmatched: usize,
    /// Separations shorter than this are left out of the times, s.
    #[schemars(range(min = 0.0, max = 1e3))]
    pub separation_shortest_s: f64,
    /// Difference of the fraction of time in each contact mode.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub mode_fraction: f64,
    /// Largest relative deviation of the law from the solid's tangent stiffness.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub law_max: f64,
    /// Relative spread of the horizontal stiffness over the preloads.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub horizontal_spread: f64,
    /// Relative difference of the foot-referenced tangent stiffness from the published law at 85 kN.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub published_stiffness: f64,
}

impl Default for Limits {
    /// What a simple model can be asked for when impacts and weakly damped vibrations are in the load case: the
    /// derailment coefficient, averaged, within the margin a safety case leaves (0.15, and 0.5 for a moment);
    /// the forces, whose vibrations lose phase after the first impact, within 0.15 of the peak in the mean
    /// and 0.75 at an instant; impacts within 5 ms. The law within 15 % of the solid: a half-space program's own curve
    /// of S1002 on UIC60 is 8 % off any law of this form between 0.5 and 200 kN, and patches of a few contact elements
    /// add steps of the same size. The published law belongs to another wheel and bounds only the order of magnitude.
    fn default() -> Self {
        Self {
            vertical_rms: 0.15,
            vertical_max: 0.75,
            lateral_rms: 0.15,
            lateral_max: 0.75,
            ratio_rms: 0.15,
            ratio_max: 0.50,
            ratio_window_s: 0.024,
            ratio_floor: 0.05,
            separation_begin_s: 0.005,
            separation_end_s: 0.005,
            separations_unmatched: 0,
            separation_shortest_s: 0.002,
            mode_fraction: 0.10,
            law_max: 0.15,
            horizontal_spread: 0.10,
            published_stiffness: 1.0,
        }
    }
}

/// What a line of the verdict can prove.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The program agrees with itself.
    Consistency,
    /// The simple model agrees with an independent model of the same physics.
    Verification,
    /// The result agrees with one that another program printed.
    CrossCode,
}

/// One line of the verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Name of the quantity, the same as the key of its limit.
    pub quantity: String,
    /// What is compared, in words.
    pub meaning: String,
    /// What the line can prove.
    pub kind: Kind,
    /// Unit of value and limit; `1` for ratios.
    pub unit: String,
    /// The value; `None` where the comparison has no meaning, for instance without any separation.
    pub value: Option<f64>,
    /// The limit.
    pub limit: f64,
    /// Whether the value is within the limit; a line without a value holds.
    pub holds: bool,
}

impl Line {
    /// A line, judged. A value that is not a number fails.
    pub fn judge(
        quantity: &str,
        meaning: &str,
        kind: Kind,
        unit: &str,
        value: Option<f64>,
        limit: f64,
    ) -> Self {
        let holds = value.is_none_or(|value| value <= limit);
        let value = value.filter(|value| value.is_finite()).map(rounded);
        Self {
            quantity: quantity.into(),
            meaning: meaning.into(),
            kind,
            unit: unit.into(),
            value,
            limit,
            holds,
        }
    }
}

/// Six significant digits: more would be noise of the arithmetic.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// A time without contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Separation {
    /// First time without contact, s.
    pub begin_s: f64,
    /// First time with contact again, s; the end of the run if there is none.
    pub end_s: f64,
}

/// Fractions of time in each contact mode; together 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ModeFractions {
    /// Some contact sticks.
    pub stick: f64,
    /// All contacts slide.
    pub slip: f64,
    /// No contact.
    pub separated: f64,
}

/// A value of each model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Both<T> {
    /// Of the simple model.
    pub simple: T,
    /// Of the solid model.
    pub solid: T,
}

/// How far apart the two models are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The lines.
    pub lines: Vec<Line>,
    /// The solid's largest vertical and lateral force, kN, which the differences are divided by.
    pub solid_peak_p_kn: f64,
    /// See `solid_peak_p_kn`.
    pub solid_peak_q_kn: f64,
    /// Times without contact.
    pub separations: Both<Vec<Separation>>,
    /// Fractions of time in each contact mode.
    pub mode_fractions: Both<ModeFractions>,
}

/// Compares the simple with the solid run.
///
/// # Errors
/// [`InputError`] with key `history` if the two have different time steps or fewer than two rows.
pub fn compare(simple: &History, solid: &History, limits: &Limits) -> Result<Comparison> {
    check_times(simple, solid)?;
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
    let floor = limits.ratio_floor * peak_p;
    let ratio = Both {
        simple: averaged_ratio(simple, limits.ratio_window_s, floor),
        solid: averaged_ratio(solid, limits.ratio_window_s, floor),
    };
    let ratio_differences: Vec<f64> =
        ratio.simple.iter().zip(&ratio.solid).filter_map(|(a, b)| Some((*a)? - (*b)?)).collect();
    let separations = Both {
        simple: separations(simple, limits.separation_shortest_s),
        solid: separations(solid, limits.separation_shortest_s),
    };
    let (pairs, unmatched) = pair_separations(&separations, limits.ratio_window_s);
    let modes = Both { simple: mode_fractions(simple), solid: mode_fractions(solid) };

    let verification = |quantity: &str, meaning: &str, unit: &str, value: Option<f64>, limit: f64| {
        Line::judge(quantity, meaning, Kind::Verification, unit, value, limit)
    };
    // Without any force in the solid the two agree only if the simple model has none either;
    // 0/0 counts as 0, and anything else over 0 is infinite and fails.
    let over = |value: f64, peak: f64| Some(if value == 0.0 { 0.0 } else { value / peak });
    let delta_p = differences(&p);
    let delta_q = differences(&q);
    let of_pairs = |difference: fn(&(Separation, Separation)) -> f64| {
        pairs.iter().map(difference).map(f64::abs).max_by(f64::total_cmp)
    };
    let lines = vec![
        verification(
            "vertical_rms",
            "P, RMS difference over the solid's peak",
            "1",
            over(rms(&delta_p), peak_p),
            limits.vertical_rms,
        ),
        verification(
            "vertical_max",
            "P, largest difference over the solid's peak",
            "1",
            over(peak(&delta_p), peak_p),
            limits.vertical_max,
        ),
        verification(
            "lateral_rms",
            "Q, RMS difference over the solid's peak",
            "1",
            over(rms(&delta_q), peak_q),
            limits.lateral_rms,
        ),
        verification(
            "lateral_max",
            "Q, largest difference over the solid's peak",
            "1",
            over(peak(&delta_q), peak_q),
            limits.lateral_max,
        ),
        verification(
            "ratio_rms",
            "Averaged Q/P, RMS difference",
            "1",
            some_of(&ratio_differences, rms),
            limits.ratio_rms,
        ),
        verification(
            "ratio_max",
            "Averaged Q/P, largest difference",
            "1",
            some_of(&ratio_differences, peak),
            limits.ratio_max,
        ),
        verification(
            "separation_begin_s",
            "Separation begins, largest difference",
            "s",
            of_pairs(|(a, b)| a.begin_s - b.begin_s),
            limits.separation_begin_s,
        ),
        verification(
            "separation_end_s",
            "Separation ends, largest difference",
            "s",
            of_pairs(|(a, b)| a.end_s - b.end_s),
            limits.separation_end_s,
        ),
        verification(
            "separations_unmatched",
            "Separations that only one model has",
            "1",
            Some(unmatched as f64),
            limits.separations_unmatched as f64,
        ),
        verification(
            "mode_fraction",
            "Time sticking, difference of the fractions",
            "1",
            Some((modes.simple.stick - modes.solid.stick).abs()),
            limits.mode_fraction,
        ),
        verification(
            "mode_fraction",
            "Time sliding, difference of the fractions",
            "1",
            Some((modes.simple.slip - modes.solid.slip).abs()),
            limits.mode_fraction,
        ),
        verification(
            "mode_fraction",
            "Time separated, difference of the fractions",
            "1",
            Some((modes.simple.separated - modes.solid.separated).abs()),
            limits.mode_fraction,
        ),
    ];
    Ok(Comparison {
        lines,
        solid_peak_p_kn: rounded(peak_p * 1e-3),
        solid_peak_q_kn: rounded(peak_q * 1e-3),
        separations,
        mode_fractions: modes,
    })
}

/// Q averaged over a window of time, divided by P averaged over the same window
/// (publication, equation 16); the window ends at the time of the value.
///
/// Before a whole window has passed, the average is over the time since the start. Where the
/// averaged P is not above `floor` (N), the ratio is undefined. The averages are integrals of the
/// piecewise linear forces.
pub fn averaged_ratio(history: &History, window: f64, floor: f64) -> Vec<Option<f64>> {
    let p = window_averages(history, window, |row| row.vertical_force);
    let q = window_averages(history, window, |row| row.lateral_force);
    p.iter().zip(&q).map(|(p, q)| (*p > floor && *p > 0.0).then(|| q / p)).collect()
}

fn window_averages(history: &History, window: f64, value: impl Fn(&HistoryRow) -> f64) -> Vec<f64> {
    let rows = &history.rows;
    // Integral from the first row, by the trapezoidal rule.
    let mut integral = vec![0.0; rows.len()];
    for i in 1..rows.len() {
        let mean = 0.5 * (value(&rows[i - 1]) + value(&rows[i]));
        integral[i] = integral[i - 1] + mean * (rows[i].time - rows[i - 1].time);
    }
    let mut first = 0;
    rows.iter()
        .enumerate()
        .map(|(i, row)| {
            if i == 0 {
                return value(row);
            }
            let begin = (row.time - window).max(rows[0].time);
            while first + 1 < i && rows[first + 1].time <= begin {
                first += 1;
            }
            let (a, b) = (&rows[first], &rows[first + 1]);
            let t = (begin - a.time) / (b.time - a.time);
            let at_begin = value(a) + t * (value(b) - value(a));
            let before = integral[first] + 0.5 * (value(a) + at_begin) * (begin - a.time);
            (integral[i] - before) / (row.time - begin)
        })
        .collect()
}

/// Times without contact that last at least `shortest` seconds.
pub fn separations(history: &History, shortest: f64) -> Vec<Separation> {
    let mut found = Vec::new();
    let mut begin = None;
    for row in &history.rows {
        match (row.mode() == ContactMode::Separated, begin) {
            (true, None) => begin = Some(row.time),
            (false, Some(start)) => {
                found.push(Separation { begin_s: start, end_s: row.time });
                begin = None;
            }
            _ => {}
        }
    }
    if let (Some(begin_s), Some(last)) = (begin, history.rows.last()) {
        found.push(Separation { begin_s, end_s: last.time });
    }
    found.retain(|s| s.end_s - s.begin_s >= shortest);
    found
}

/// Fractions of the time steps in each mode; the initial state does not count.
pub fn mode_fractions(history: &History) -> ModeFractions {
    let rows = history.rows.get(1..).unwrap_or_default();
    let share = |mode: ContactMode| {
        rows.iter().filter(|row| row.mode() == mode).count() as f64 / rows.len().max(1) as f64
    };
    ModeFractions {
        stick: share(ContactMode::Stick),
        slip: share(ContactMode::Slip),
        separated: share(ContactMode::Separated),
    }
}

/// Pairs separations of the two models that overlap, or lie no more than `reach` apart; in order,
/// each used once. Also the number of those left over.
fn pair_separations(both: &Both<Vec<Separation>>, reach: f64) -> (Vec<(Separation, Separation)>, usize) {
    let mut pairs = Vec::new();
    let (mut i, mut j) = (0, 0);
    while let (Some(a), Some(b)) = (both.simple.get(i), both.solid.get(j)) {
        if a.end_s + reach < b.begin_s {
            i += 1;
        } else if b.end_s + reach < a.begin_s {
            j += 1;
        } else {
            pairs.push((*a, *b));
            i += 1;
            j += 1;
        }
    }
    let unmatched = both.simple.len() + both.solid.len() - 2 * pairs.len();
    (pairs, unmatched)
}

fn check_times(simple: &History, solid: &History) -> Result<()> {
    let same = simple.rows.len() == solid.rows.len()
        && simple.rows.len() > 1
        // Times that differ by more than this share of a step belong to other runs.
        && simple.rows.iter().zip(&solid.rows).all(|(a, b)| (a.time - b.time).abs() < 1e-9);
    if same {
        return Ok(());
    }
    Err(InputError::new(
        "history",
        format!("{} rows of the simple and {} of the solid model", simple.rows.len(), solid.rows.len()),
        "two runs of at least one step over the same times",
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

fn some_of(values: &[f64], measure: fn(&[f64]) -> f64) -> Option<f64> {
    (!values.is_empty()).then(|| measure(values))
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
