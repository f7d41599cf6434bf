//! What is compared of a run besides its forces: averaged ratios, separations, contact modes.

use railspring_simulate::time::history::{ContactMode, History, HistoryRow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A time without contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Separation {
    /// First time without contact, s.
    pub begin_s: f64,
    /// First time with contact again, s; the end of the run if there is none.
    pub end_s: f64,
}

impl Separation {
    /// How long it is, s; times are written with twelve digits.
    pub(super) fn length(&self) -> f64 {
        (self.end_s - self.begin_s) * (1.0 + 1e-9)
    }
}

/// Fractions of time in each contact mode; together 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModeFractions {
    /// Some contact sticks.
    pub stick: f64,
    /// All contacts slide.
    pub slip: f64,
    /// No contact.
    pub separated: f64,
}

/// Wheel contacts nearer to the flange than this lateral position are counted as flange contacts, m: the tread of the standard profiles ends there.
pub const FLANGE_SIDE: f64 = -0.026;

/// Whether the wheel touches with its flange at any step of a run.
pub fn touches_with_flange(history: &History) -> bool {
    history.rows.iter().flat_map(|row| &row.contacts).any(|contact| contact.wheel.x < FLANGE_SIDE)
}

/// A value of each model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Both<T> {
    /// Of the simple model.
    pub simple: T,
    /// Of the solid model.
    pub solid: T,
}

impl<T> Both<T> {
    /// The same of each model.
    pub fn map<U>(&self, of: impl Fn(&T) -> U) -> Both<U> {
        Both { simple: of(&self.simple), solid: of(&self.solid) }
    }
}

/// Where an averaged P carries a ratio Q/P: where the ratio is known well enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carrying {
    /// How far averaged P and Q may be off, N.
    pub errors: [f64; 2],
    /// How far the ratio may be off at most.
    pub limit: f64,
}

impl Carrying {
    /// Of forces without errors: every positive P.
    pub const EXACT: Self = Self { errors: [0.0; 2], limit: 0.0 };

    /// Q/P, unless it may be off by more than the limit. With errors e of both forces it is off by (e_Q + |Q/P|·e_P)/(P - e_P) at most.
    fn ratio(&self, p: f64, q: f64) -> Option<f64> {
        let ([of_p, of_q], ratio) = (self.errors, q / p);
        let least = p - of_p;
        (least > 0.0 && ratio.is_finite() && of_q + ratio.abs() * of_p <= self.limit * least).then_some(ratio)
    }
}

/// Q averaged over a window of time, divided by P averaged over the same window
/// (publication, equation 16); the window ends at the time of the value.
///
/// Before a whole window has passed, the average is over the time since the start. The ratio is undefined where P does not carry
/// it. The averages are integrals of the piecewise linear forces.
pub fn averaged_ratio(history: &History, window: f64, carrying: &Carrying) -> Vec<Option<f64>> {
    let [p, q] = averaged_forces(history, window);
    p.iter().zip(&q).map(|(p, q)| carrying.ratio(*p, *q)).collect()
}

/// P and Q averaged over the window that ends at each time, N.
pub(super) fn averaged_forces(history: &History, window: f64) -> [Vec<f64>; 2] {
    [|row: &HistoryRow| row.vertical_force, |row: &HistoryRow| row.lateral_force]
        .map(|force| window_averages(history, window, force))
}

fn window_averages(history: &History, window: f64, value: fn(&HistoryRow) -> f64) -> Vec<f64> {
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
            // Times that do not grow leave nothing to average over.
            if !(row.time > begin) {
                return value(row);
            }
            while first + 1 < i && rows[first + 1].time <= begin {
                first += 1;
            }
            let (a, b) = (&rows[first], &rows[first + 1]);
            let t = if b.time > a.time { (begin - a.time) / (b.time - a.time) } else { 0.0 };
            let at_begin = value(a) + t * (value(b) - value(a));
            let before = integral[first] + 0.5 * (value(a) + at_begin) * (begin - a.time);
            (integral[i] - before) / (row.time - begin)
        })
        .collect()
}

/// The contact mode of a step, separated under less than a force (N).
pub(super) fn mode(row: &HistoryRow, least: f64) -> ContactMode {
    let force = row.vertical_force.hypot(row.lateral_force);
    if force < least { ContactMode::Separated } else { row.mode() }
}

/// Times with less than a force (N) that last at least `shortest` seconds.
pub fn separations(history: &History, shortest: f64, least: f64) -> Vec<Separation> {
    let mut found = Vec::new();
    let mut begin = None;
    for row in &history.rows {
        match (mode(row, least) == ContactMode::Separated, begin) {
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
    found.retain(|s| s.length() >= shortest);
    found
}

/// Fractions of the time steps in each mode, separated under less than a force (N); the initial state does not count.
pub fn mode_fractions(history: &History, least: f64) -> ModeFractions {
    fractions_of(history.rows.get(1..).unwrap_or_default(), least)
}

/// Fractions of some time steps in each mode.
pub(super) fn fractions_of(rows: &[HistoryRow], least: f64) -> ModeFractions {
    let share = |of: ContactMode| {
        rows.iter().filter(|row| mode(row, least) == of).count() as f64 / rows.len().max(1) as f64
    };
    ModeFractions {
        stick: share(ContactMode::Stick),
        slip: share(ContactMode::Slip),
        separated: share(ContactMode::Separated),
    }
}
