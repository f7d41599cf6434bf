//! Statistics of EN 14363 of a load case, as a table of the report.

use serde::Serialize;

use crate::results::verdict::record::ScenarioVerdict;
use crate::verify::{Percentiles, RunningStatistics};

/// The statistics of both models.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Running {
    /// Quantity, model, and the percentiles.
    rows: Vec<[String; 5]>,
    /// What has to be known of the mean over 2 m, a sentence for each model.
    notes: Vec<String>,
}

/// The table of a load case; none where no model has statistics.
pub(crate) fn running(judged: &ScenarioVerdict) -> Option<Running> {
    let both = judged.running.as_ref()?;
    let models: Vec<(&str, &RunningStatistics)> = [("simple", &both.simple), ("solid", &both.solid)]
        .into_iter()
        .filter_map(|(name, of)| Some((name, of.as_ref()?)))
        .collect();
    type Quantity = (&'static str, usize, fn(&RunningStatistics) -> Option<Percentiles>);
    let quantities: [Quantity; 3] = [
        ("P below 20 Hz, kN", 2, |of| Some(of.p_kn)),
        ("Q below 20 Hz, kN", 2, |of| Some(of.q_kn)),
        ("Q/P below 20 Hz, mean over 2 m", 4, |of| of.q_over_p_2m),
    ];
    let rows = quantities.into_iter().flat_map(|(what, digits, take)| {
        models.iter().filter_map(move |(name, of)| {
            let Percentiles { percentile_0_15, percentile_50, percentile_99_85 } = take(of)?;
            let [low, middle, high] =
                [percentile_0_15, percentile_50, percentile_99_85].map(|value| format!("{value:.digits$}"));
            Some([what.into(), (*name).into(), low, middle, high])
        })
    });
    let notes = models.iter().map(|(name, of)| match &of.q_over_p_missing {
        Some(reason) => format!("{name} model, no mean over 2 m: {reason}"),
        None => format!("{name} model: {} windows, {} left out", of.windows, of.windows_left_out),
    });
    let table = Running { rows: rows.collect(), notes: notes.collect() };
    (!models.is_empty()).then_some(table)
}
