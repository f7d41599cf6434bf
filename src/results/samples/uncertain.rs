//! A made-up load case with uncertain inputs.

use railspring_profiles::units::KILONEWTON;

use super::{history, stiffness};
use crate::results::run::uncertain_record::{
    ExtremeRecord, HalfWidthRecord, UncertainRow, UncertainRun, UncertainRunRecord,
};

/// Bands about the run of [`history`], 6 kN broad for P and 3 kN for Q; Q/P has none in the first 20 ms.
pub(crate) fn uncertain_run() -> UncertainRun {
    let about = |value: f64, half: f64| Some([-1.0, -0.5, 0.0, 0.5, 1.0].map(|part| value + part * half));
    let nominal = history(0.001);
    let rows = nominal.rows.iter().map(|row| UncertainRow {
        time: row.time,
        samples: 63.0,
        p: about(row.vertical_force / KILONEWTON, 3.0),
        q: about(row.lateral_force / KILONEWTON, 1.5),
        ratio: (row.time > 0.02).then(|| about(0.6, 0.1)).flatten(),
        separated: if row.contacts.is_empty() { 0.9 } else { 0.1 },
    });
    let half = |rms: f64| HalfWidthRecord { rms, largest: rms };
    let extreme = |nominal: f64, low: f64, high: f64| ExtremeRecord {
        nominal: Some(nominal),
        quantiles: [low, 0.5 * (low + high), high],
        range: [low, high],
        shares: vec![0.8, 0.01],
    };
    let record = UncertainRunRecord {
        element: "condensed".into(),
        samples: 64,
        failed: 1,
        ended_early: 0,
        inputs: stiffness().input_uncertainty.expect("the sample has some").inputs,
        p_kn: half(3.0),
        q_kn: half(1.5),
        q_over_p: Some(half(0.1)),
        largest_p_kn: extreme(73.0, 70.0, 78.0),
        largest_q_kn: extreme(21.0, 19.0, 23.0),
        largest_q_over_p: Some(extreme(0.6, 0.5, 0.7)),
        separating: 63,
        first_separation_s: Some(extreme(0.147, 0.14, 0.15)),
        left_out: vec!["law and horizontal stiffness depart to first order".into()],
    };
    UncertainRun { rows: rows.collect(), record }
}
