//! How far a run changes with one of its inputs, at the times of its history.

use std::ops::Range;

use railspring_simulate::time::history::{History, HistoryRow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits::Limits;
use super::series::{column, peak, rms};
use super::signals::{Carrying, averaged_forces, averaged_ratio};

/// A force is measured against its peak, and against this share of the other one's at least.
const SMALLEST_PEAK: f64 = 0.05;

/// Errors of averaged forces over their RMS changes: what 95 of 100 of them stay within.
pub(super) const COVERAGE: f64 = 2.0;

/// A change of the averaged Q/P is taken where both runs know it so well: the uncertainty of a run does not depend on what a study asks of it.
const KNOWN: f64 = 0.5;

/// Change of a run. Forces are over their largest in the whole run, or over a twentieth of the other one's if
/// that is more. Q/P is averaged over the published window. It counts where the averaged P of both carries
/// it, with twice the RMS changes of averaged P and Q as errors ([`Carrying`]).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Change {
    /// RMS change of the vertical force.
    pub p_rms: f64,
    /// Largest change of the vertical force.
    pub p_max: f64,
    /// RMS change of the lateral force.
    pub q_rms: f64,
    /// Largest change of the lateral force.
    pub q_max: f64,
    /// RMS change of the averaged vertical force.
    pub averaged_p_rms: f64,
    /// RMS change of the averaged lateral force.
    pub averaged_q_rms: f64,
    /// RMS change of the averaged Q/P; none where it is not defined.
    pub ratio_rms: Option<f64>,
    /// Largest change of the averaged Q/P.
    pub ratio_max: Option<f64>,
}

impl Change {
    /// From a run to another one over some of the rows that both have.
    ///
    /// # Errors
    /// A change that is no number, as of a run without any force.
    pub(super) fn between(run: &History, other: &History, rows: Range<usize>) -> Result<Self, String> {
        let limits = Limits::default();
        let peaks = scales(run);
        let changes = |of: &dyn Fn(&History) -> [Vec<f64>; 2]| -> [Vec<f64>; 2] {
            let [a, b] = [run, other].map(of);
            [0, 1].map(|k| rows.clone().map(|n| b[k][n] - a[k][n]).collect())
        };
        let averaged = changes(&|run| averaged_forces(run, limits.ratio_window_s)).map(|change| rms(&change));
        let changes = changes(&|run| FORCES.map(|force| column(run, force)));
        let carrying = Carrying { errors: averaged.map(|rms| COVERAGE * rms), limit: KNOWN };
        let ratios = [run, other].map(|run| averaged_ratio(run, limits.ratio_window_s, &carrying));
        let ratio: Vec<f64> = rows.clone().filter_map(|n| Some(ratios[1][n]? - ratios[0][n]?)).collect();
        let of_ratio = |measure: fn(&[f64]) -> f64| (!ratio.is_empty()).then(|| measure(&ratio));
        let change = Self {
            p_rms: over(rms(&changes[0]), peaks[0]),
            p_max: over(peak(&changes[0]), peaks[0]),
            q_rms: over(rms(&changes[1]), peaks[1]),
            q_max: over(peak(&changes[1]), peaks[1]),
            averaged_p_rms: over(averaged[0], peaks[0]),
            averaged_q_rms: over(averaged[1], peaks[1]),
            ratio_rms: of_ratio(rms),
            ratio_max: of_ratio(peak),
        };
        let forces = [change.p_rms, change.p_max, change.q_rms, change.q_max];
        if forces.iter().all(|share| share.is_finite()) {
            return Ok(change);
        }
        Err("one of the two runs has forces that are no numbers, or no force at all".into())
    }

    /// RMS and largest change of both forces, in this order, N; `scales` are those of the run.
    pub(super) fn forces(&self, scales: [f64; 2]) -> [[f64; 2]; 2] {
        let [p, q] = scales;
        [[self.p_rms * p, self.p_max * p], [self.q_rms * q, self.q_max * q]]
    }

    /// RMS change of averaged P and Q, N.
    pub(super) fn averaged(&self, scales: [f64; 2]) -> [f64; 2] {
        [self.averaged_p_rms * scales[0], self.averaged_q_rms * scales[1]]
    }
}

/// P and Q.
pub(super) const FORCES: [fn(&HistoryRow) -> f64; 2] = [|row| row.vertical_force, |row| row.lateral_force];

/// The largest P and Q of a run, N.
pub(super) fn peaks(run: &History) -> [f64; 2] {
    FORCES.map(|force| peak(&column(run, force)))
}

/// Share of the largest P of a run under which a contact does not count. Its patch is hardly wider than an
/// element of the solid's contact grid (Hertz, 75 N: a semi-axis of 0.5 mm). The places of the grid's nodes
/// then decide whether it is found.
const LEAST_CONTACT: f64 = 1e-3;

/// The force under which a wheel counts as separated beside a run, N.
pub fn least_contact(run: &History) -> f64 {
    LEAST_CONTACT * peaks(run)[0]
}

/// What changes of P and Q are shares of, N.
pub(super) fn scales(run: &History) -> [f64; 2] {
    let peaks = peaks(run);
    let least = SMALLEST_PEAK * peaks[0].max(peaks[1]);
    peaks.map(|peak| peak.max(least))
}

/// A change over a peak. Without any force two runs agree only if the other has none either: 0/0 counts as 0, and anything else over
/// 0 is infinite and fails.
pub(super) fn over(change: f64, peak: f64) -> f64 {
    if change == 0.0 { 0.0 } else { change / peak }
}

/// What two causes that have nothing to do with each other change together, as far as either is known: the root of their squares.
pub(super) fn together(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.hypot(b)),
        (one, other) => one.or(other),
    }
}

impl std::fmt::Display for Change {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "P changes by {:.2} % of its largest (RMS) and {:.2} % at most, Q by {:.2} % and {:.2} %",
            1e2 * self.p_rms,
            1e2 * self.p_max,
            1e2 * self.q_rms,
            1e2 * self.q_max
        )?;
        match (self.ratio_rms, self.ratio_max) {
            (Some(rms), Some(max)) => write!(f, ", the averaged Q/P by {rms:.4} and {max:.4}"),
            _ => Ok(()),
        }
    }
}
