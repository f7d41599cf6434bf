//! A quantity over the time steps of a run.

use railspring_simulate::time::history::{History, HistoryRow};

/// The number of rows before a time (s).
pub(super) fn rows_before(run: &History, time: f64) -> usize {
    // times are written with twelve digits
    run.rows.partition_point(|row| row.time < time * (1.0 - 1e-9))
}

/// A value of every row.
pub(super) fn column(history: &History, value: impl Fn(&HistoryRow) -> f64) -> Vec<f64> {
    history.rows.iter().map(value).collect()
}

/// Root of the mean square.
pub(super) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Largest magnitude; not a number if any value is not.
pub(super) fn peak(values: &[f64]) -> f64 {
    let finite_or_nan = |largest: f64, v: &f64| {
        if largest.is_nan() || v.is_nan() { f64::NAN } else { largest.max(v.abs()) }
    };
    values.iter().fold(0.0, finite_or_nan)
}
