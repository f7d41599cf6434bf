//! Signals and statistics of EN 14363:2016: forces below 20 Hz, the mean of their ratio over 2 m of track, percentiles.
//!
//! The standard's Q and Y are P and Q here. Its filter is a low-pass with −3 dB at 20 Hz and 24 dB an octave. It is a Butterworth filter of fourth order here, run once
//! from the start, as in a measuring chain: signals come later by 2.613/(2π · 20 Hz) = 21 ms, both forces alike. Before the start the forces are those of the first row.

use std::f64::consts::PI;

use railspring_simulate::time::history::{History, HistoryRow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::line::{Criterion, Kind, Line, NotApplicable};
use super::statistics::quantile;

/// Frequency at which the low-pass has −3 dB, Hz.
const CUTOFF: f64 = 20.0;
/// Fewest steps in a period of that frequency.
const LEAST_STEPS: f64 = 10.0;
/// Length over which the ratio is averaged, m.
pub const WINDOW: f64 = 2.0;
/// Distance of the windows, m.
const APART: f64 = 0.5;
/// Shares of the values below the percentiles.
const SHARES: [f64; 3] = [0.0015, 0.5, 0.9985];

/// Why a wheel has no mean over a length of track.
const STANDS: &str = "the wheel stands: a mean over 2 m of track is not defined";

/// Why there is no mean though the wheel travels far enough.
const NO_LOAD: &str = "P below 20 Hz is not positive throughout any 2 m of track";

/// Percentiles of a signal; of fewer than 700 values the outer ones lie between the last two values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Percentiles {
    /// Below it are 0.15 % of the values.
    pub percentile_0_15: f64,
    /// The median.
    pub percentile_50: f64,
    /// Below it are 99.85 % of the values.
    pub percentile_99_85: f64,
}

/// Statistics of a run by EN 14363:2016.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunningStatistics {
    /// P below 20 Hz, kN.
    pub p_kn: Percentiles,
    /// Q below 20 Hz, kN.
    pub q_kn: Percentiles,
    /// Q/P of these, averaged over 2 m of track every 0.5 m; none where the wheel stands or where the run is shorter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub q_over_p_2m: Option<Percentiles>,
    /// Of how many windows.
    pub windows: usize,
    /// How many are left out because P is not positive throughout, as that at the start of a load case.
    pub windows_left_out: usize,
    /// Why there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub q_over_p_missing: Option<String>,
}

impl Percentiles {
    fn of(mut values: Vec<f64>) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        values.sort_by(f64::total_cmp);
        let [percentile_0_15, percentile_50, percentile_99_85] =
            SHARES.map(|share| quantile(&values, share).unwrap_or(f64::NAN));
        Some(Self { percentile_0_15, percentile_50, percentile_99_85 })
    }

    fn scaled(self, factor: f64) -> Self {
        Self {
            percentile_0_15: factor * self.percentile_0_15,
            percentile_50: factor * self.percentile_50,
            percentile_99_85: factor * self.percentile_99_85,
        }
    }

    /// The larger size of both outer percentiles.
    pub fn largest(&self) -> f64 {
        self.percentile_0_15.abs().max(self.percentile_99_85.abs())
    }
}

impl RunningStatistics {
    /// Of a run with the wheel's `speed` (m/s); `None` where its time steps are unequal or too long for the low-pass.
    pub fn of(history: &History, speed: f64) -> Option<Self> {
        const KILONEWTON: f64 = 1e3;
        let rows = &history.rows;
        let times: Vec<f64> = rows.iter().map(|row| row.time).collect();
        let of = |force: fn(&HistoryRow) -> f64| low_passed(&times, rows.iter().map(force).collect());
        let (p, q) = (of(|row| row.vertical_force)?, of(|row| row.lateral_force)?);
        let step = equal_step(&times)?;
        let means = ratio_means(&p, &q, step, speed);
        let (kept, windows_left_out) = means.clone().unwrap_or_default();
        Some(Self {
            p_kn: Percentiles::of(p)?.scaled(1.0 / KILONEWTON),
            q_kn: Percentiles::of(q)?.scaled(1.0 / KILONEWTON),
            windows: kept.len(),
            windows_left_out,
            q_over_p_missing: means.err().or_else(|| kept.is_empty().then(|| NO_LOAD.into())),
            q_over_p_2m: Percentiles::of(kept),
        })
    }
}

/// Whether the mean of Q/P over 2 m keeps a limit of the user's, on each of these models: the largest size of the outer percentiles. The line fails where
/// one of them has none.
///
/// # Errors
/// That it does not apply, as the wheel stands.
pub fn accepted(
    limit: f64,
    speed: f64,
    models: &[(&str, Option<&RunningStatistics>)],
) -> Result<Line, NotApplicable> {
    let criterion = Criterion {
        quantity: "ratio_2m",
        meaning: "Q/P below 20 Hz, mean over 2 m (EN 14363), largest size of the 0.15 and 99.85 % percentiles",
        kind: Kind::Acceptance,
        unit: "1",
        limit,
    };
    if speed <= 0.0 {
        return Err(criterion.not_applicable(STANDS));
    }
    /// The size and the windows left out, or why there is none.
    type Size = Result<(f64, usize), String>;
    let of = |statistics: Option<&RunningStatistics>| match statistics {
        None => Err("time steps are unequal or longer than 5 ms".to_string()),
        Some(statistics) => match (&statistics.q_over_p_2m, &statistics.q_over_p_missing) {
            (Some(ratio), _) => Ok((ratio.largest(), statistics.windows_left_out)),
            (None, reason) => Err(reason.clone().unwrap_or_else(|| "none".into())),
        },
    };
    let found: Vec<(&str, Size)> = models.iter().map(|(name, statistics)| (*name, of(*statistics))).collect();
    let values: Option<Vec<f64>> =
        found.iter().map(|(_, value)| value.as_ref().ok().map(|(value, _)| *value)).collect();
    let largest = values.and_then(|values| values.into_iter().reduce(f64::max));
    let text = |(name, value): &(&str, Size)| match value {
        Ok((value, 0)) => format!("{name} {value:.4}"),
        Ok((value, left_out)) => {
            format!("{name} {value:.4}, windows left out as P is not positive: {left_out}")
        }
        Err(reason) => format!("{name}: {reason}"),
    };
    let note = found.iter().map(text).collect::<Vec<_>>().join(", ");
    Ok(criterion.line(largest).noted(note))
}

/// A force at these times (s) below 20 Hz; `None` where the steps are unequal or longer than 5 ms.
pub fn low_passed(times: &[f64], force: Vec<f64>) -> Option<Vec<f64>> {
    let step = equal_step(times).filter(|step| step * CUTOFF * LEAST_STEPS <= 1.0)?;
    Some(low_pass(force.into_iter(), step))
}

/// The time step, s, of equal steps.
fn equal_step(times: &[f64]) -> Option<f64> {
    /// ROUNDOFF: times are written with twelve digits.
    const ROUNDOFF: f64 = 1e-6;
    let [first, .., last] = times else { return None };
    let step = (last - first) / (times.len() - 1) as f64;
    let equal = times.windows(2).all(|pair| ((pair[1] - pair[0]) / step - 1.0).abs() < ROUNDOFF);
    (step > 0.0 && equal).then_some(step)
}

/// Values `step` (s) apart through the low-pass: two sections of second order by the bilinear transform, exact at the cutoff.
fn low_pass(values: impl Iterator<Item = f64>, step: f64) -> Vec<f64> {
    let k = (PI * CUTOFF * step).tan();
    let mut values: Vec<f64> = values.collect();
    for angle in [PI / 8.0, 3.0 * PI / 8.0] {
        let damping = 2.0 * angle.cos() * k;
        let whole = 1.0 + damping + k * k;
        let (gain, one, two) = (k * k / whole, 2.0 * (k * k - 1.0) / whole, (1.0 - damping + k * k) / whole);
        let Some(&first) = values.first() else { return values };
        let (mut before, mut after) = ([first; 2], [first; 2]);
        for value in &mut values {
            let new = gain * (*value + 2.0 * before[0] + before[1]) - one * after[0] - two * after[1];
            before = [*value, before[0]];
            after = [new, after[0]];
            *value = new;
        }
    }
    values
}

/// Q/P along places, straight between its values.
pub struct RatioAlong<'a> {
    places: &'a [f64],
    ratio: Vec<f64>,
    /// Of the ratio, from the first place to each.
    integral: Vec<f64>,
    /// Rows before each, and after the last, whose P is not positive.
    unloaded: Vec<usize>,
}

impl<'a> RatioAlong<'a> {
    /// Of as many forces as `places`, which do not fall.
    pub fn new(places: &'a [f64], p: &[f64], q: &[f64]) -> Self {
        let ratio: Vec<f64> = p.iter().zip(q).map(|(p, q)| if *p > 0.0 { q / p } else { 0.0 }).collect();
        let (mut integral, mut unloaded) = (vec![0.0], vec![0]);
        for (places, ratio) in places.windows(2).zip(ratio.windows(2)) {
            let area = 0.5 * (places[1] - places[0]) * (ratio[0] + ratio[1]);
            integral.push(integral[integral.len() - 1] + area);
        }
        unloaded.extend(p.iter().scan(0, |count, p| {
            *count += usize::from(!(*p > 0.0));
            Some(*count)
        }));
        Self { places, ratio, integral, unloaded }
    }

    /// Integral from the first place to one between the rows `row` and `row + 1`.
    fn up_to(&self, row: usize, place: f64) -> f64 {
        let width = self.places[row + 1] - self.places[row];
        let u = if width > 0.0 { (place - self.places[row]) / width } else { 0.0 };
        let [from, to] = [self.ratio[row], self.ratio[row + 1]];
        self.integral[row] + u * width * (from + 0.5 * u * (to - from))
    }

    /// Mean over a `length` from the place `from` on, which ends at the row `last` or between the row before and that; none where P is not positive throughout, and
    /// where the rows do not reach so far back.
    pub fn mean(&self, from: f64, length: f64, last: usize) -> Option<f64> {
        /// ROUNDOFF: of places, beside the length.
        const ROUNDOFF: f64 = 1e-9;
        let tolerance = ROUNDOFF * length;
        if last == 0 || from < self.places[0] - tolerance {
            return None;
        }
        let first = self.places.partition_point(|place| *place <= from + tolerance);
        let first = first.saturating_sub(1).min(last - 1);
        if self.unloaded[last + 1] > self.unloaded[first] {
            return None;
        }
        let to = (from + length).min(self.places[last]);
        Some((self.up_to(last - 1, to) - self.up_to(first, from)) / length)
    }
}

/// Means of Q/P over 2 m of track, every 0.5 m. Windows in which P is not positive throughout are left out, and counted.
///
/// # Errors
/// Why there is none.
fn ratio_means(p: &[f64], q: &[f64], step: f64, speed: f64) -> Result<(Vec<f64>, usize), String> {
    /// ROUNDOFF: of the last window's end, in steps.
    const ROUNDOFF: f64 = 1e-6;
    if speed <= 0.0 {
        return Err(STANDS.into());
    }
    // places in steps
    let places: Vec<f64> = (0..p.len()).map(|row| row as f64).collect();
    let last = p.len() - 1;
    let [window, apart] = [WINDOW, APART].map(|length| length / (speed * step));
    if last == 0 || window > last as f64 + ROUNDOFF {
        let length = last as f64 * step * speed;
        return Err(format!("the wheel travels {length:.2} m, less than the 2 m of the mean"));
    }
    let along = RatioAlong::new(&places, p, q);
    let begins =
        (0..).map(|i| f64::from(i) * apart).take_while(|begin| begin + window <= last as f64 + ROUNDOFF);
    // a window that ends on a row has it, and none after it
    let row_at = |end: f64| ((end - ROUNDOFF).ceil() as usize).min(last);
    let found: Vec<Option<f64>> =
        begins.map(|begin| along.mean(begin, window, row_at(begin + window))).collect();
    let means: Vec<f64> = found.iter().copied().flatten().collect();
    let left_out = found.len() - means.len();
    Ok((means, left_out))
}

#[cfg(test)]
mod tests {
    use railspring_simulate::time::history::Ending;

    use super::*;

    const STEP: f64 = 5e-4;

    fn run(count: usize, forces: impl Fn(f64) -> [f64; 2]) -> History {
        let row = |i: usize| {
            let time = i as f64 * STEP;
            let [vertical_force, lateral_force] = forces(time);
            HistoryRow {
                time,
                vertical_force,
                lateral_force,
                wheel_y: 0.0,
                wheel_z: 0.0,
                load_y: 0.0,
                energy: None,
                contacts: Vec::new(),
            }
        };
        History { rows: (0..count).map(row).collect(), degrees_of_freedom: 6, ending: Ending::Completed }
    }

    /// Source: the Butterworth filter of fourth order, 1/√(1 + (f/20 Hz)⁸), and with the frequencies that the bilinear transform bends, tan(π f h) for π f h.
    /// Goal: amplitude of sines of 5 to 80 Hz after 2 s. Accuracy: SOLVER, what is left of the start and a sine's phase over the last whole period, 1e-9 of the input;
    /// DISCRETISATION against the plain formula, (tan x/x)⁴ − 1 with x = π f h.
    #[test]
    fn the_low_pass_has_the_amplitude_of_butterworth() {
        const SOLVER: f64 = 1e-9;
        for frequency in [5.0, 10.0, 20.0, 40.0, 80.0] {
            let omega = 2.0 * PI * frequency;
            let out = low_pass((0..6000).map(|i| (omega * f64::from(i) * STEP).sin()), STEP);
            // fit over 0.2 s, whole periods of all these
            let [mut sine, mut cosine] = [0.0; 2];
            for (i, value) in out.iter().enumerate().skip(5600) {
                let angle = omega * i as f64 * STEP;
                sine += value * angle.sin() / 200.0;
                cosine += value * angle.cos() / 200.0;
            }
            let found = f64::hypot(sine, cosine);
            let response = |ratio: f64| 1.0 / (1.0 + ratio.powi(8)).sqrt();
            let bent = response((PI * frequency * STEP).tan() / (PI * CUTOFF * STEP).tan());
            assert!((found - bent).abs() < SOLVER, "{frequency}: {found} {bent}");
            let x = PI * frequency * STEP;
            let plain = response(frequency / CUTOFF);
            assert!(
                (found / plain - 1.0).abs() < (x.tan() / x).powi(4) - 1.0 + SOLVER,
                "{frequency}: {found} {plain}"
            );
        }
        // a constant force goes through unchanged from the start on
        assert!(
            low_pass(std::iter::repeat_n(3.0, 100), STEP).iter().all(|value| (value - 3.0).abs() < 1e-12)
        );
    }

    /// Source: a signal by hand. Goal: means over 2 m every 0.5 m of a ratio that grows by 0.1 a metre, at 40 m/s: 0.1 (x + 1 m) at windows from x on, of a run of 4 m: five of
    /// them. Accuracy: ROUNDOFF.
    #[test]
    fn means_over_two_metres_of_a_straight_line() {
        const ROUNDOFF: f64 = 1e-12;
        let q: Vec<f64> = (0..=200).map(|i| 0.1 * 40.0 * STEP * f64::from(i)).collect();
        let (means, left_out) = ratio_means(&[1.0; 201], &q, STEP, 40.0).unwrap();
        assert_eq!((means.len(), left_out), (5, 0));
        for (i, mean) in means.iter().enumerate() {
            assert!((mean - 0.1 * (0.5 * i as f64 + 1.0)).abs() < ROUNDOFF, "{means:?}");
        }
        // windows that begin between two rows
        let (means, _) = ratio_means(&[1.0; 201], &q, STEP, 37.0).unwrap();
        for (i, mean) in means.iter().enumerate() {
            let expected = 0.1 * (40.0 / 37.0) * (0.5 * i as f64 + 1.0);
            assert!((mean - expected).abs() < ROUNDOFF, "{mean} {expected}");
        }
        let reason = |speed: f64| ratio_means(&[1.0; 201], &q, STEP, speed).unwrap_err();
        assert!(reason(0.0).contains("the wheel stands"));
        assert!(reason(10.0).contains("travels 1.00 m"));
        // 50 rows a metre: no load at the start leaves out the window from there on, at 0.9 m those from 0 and 0.5 m on, in the middle all
        for (row, expected) in [(0, 1), (45, 2), (100, 5)] {
            let mut p = [1.0; 201];
            p[row] = 0.0;
            let (means, left_out) = ratio_means(&p, &q, STEP, 40.0).unwrap();
            assert_eq!((means.len(), left_out), (5 - expected, expected), "{row}");
        }
    }

    /// Source: a slow run by hand, P = 50 kN and Q from 0 to 20 kN within 2 s. Goal: percentiles of the forces in kN, the ratio's sizes. Accuracy
    /// (MODEL): Q comes 21 ms late, which is 0.21 kN; the start bends it by less.
    #[test]
    fn statistics_of_a_slow_run() {
        const MODEL: f64 = 0.01;
        let slow = run(4001, |time| [50e3, -1e4 * time]);
        let found = RunningStatistics::of(&slow, 10.0).unwrap();
        assert!((found.p_kn.percentile_0_15 - 50.0).abs() < 1e-9 && found.p_kn.largest() < 50.0 + 1e-9);
        let late = 2.613 / (2.0 * PI * CUTOFF);
        assert!((found.q_kn.percentile_50 + 10.0 * (1.0 - late)).abs() < MODEL, "{found:?}");
        assert!((found.q_kn.percentile_0_15 + 10.0 * (2.0 * 0.9985 - late)).abs() < MODEL, "{found:?}");
        // 20 m: windows begin at 0 to 18 m; the largest mean is at 1.9 s
        assert_eq!(found.windows, 37);
        let ratio = found.q_over_p_2m.unwrap();
        assert!((ratio.largest() - 0.2 * (1.9 - late)).abs() < MODEL, "{found:?}");
        assert!((ratio.percentile_50 + 0.2 * (1.0 - late)).abs() < MODEL, "{found:?}");
        let unloaded = RunningStatistics::of(&run(4001, |_| [0.0, 1.0]), 10.0).unwrap();
        assert_eq!((unloaded.windows, unloaded.windows_left_out), (0, 37));
        assert!(unloaded.q_over_p_missing.unwrap().contains("not positive"));
        let standing = RunningStatistics::of(&slow, 0.0).unwrap();
        assert_eq!((standing.windows, standing.q_over_p_2m), (0, None));
        assert!(standing.q_over_p_missing.as_deref().unwrap().contains("stands"));
        // a limit: kept, missed, without a value of one model, and of a wheel that stands
        let line = |limit: f64, models: &[(&str, Option<&RunningStatistics>)]| accepted(limit, 10.0, models);
        let kept = line(0.4, &[("simple model", Some(&found))]).unwrap();
        assert!(
            kept.holds && kept.value.is_some_and(|value| (value - ratio.largest()).abs() < 1e-6),
            "{kept:?}"
        );
        assert!(!line(0.3, &[("simple model", Some(&found))]).unwrap().holds);
        let short = line(0.4, &[("simple model", Some(&found)), ("solid model", None)]).unwrap();
        assert!(!short.holds && short.note.unwrap().contains("solid model: time steps are unequal"));
        let models = [("simple model", Some(&standing))];
        assert!(accepted(0.4, 0.0, &models).unwrap_err().reason.contains("stands"));
        // unequal steps, and steps of a tenth of a period of the cutoff and more
        let mut unequal = slow.clone();
        unequal.rows[7].time += 1e-4;
        assert_eq!(RunningStatistics::of(&unequal, 10.0), None);
        let mut long = slow;
        long.rows = long.rows.into_iter().step_by(12).collect();
        assert_eq!(RunningStatistics::of(&long, 10.0), None);
    }
}
