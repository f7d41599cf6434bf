//! A load case with inputs that are not known exactly: quasi-random samples of them through the simple model.

use std::sync::atomic::{AtomicUsize, Ordering};

use railspring_calibrate::uncertainty::{
    Distribution, departures, first_order_indices, is_enough, percentile,
};
use railspring_profiles::error::{Result, unless_interrupted};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::history::{Ending, History, HistoryRow};
use rayon::prelude::*;

use crate::results::run::departed::Departing;
use crate::results::run::uncertain_record::{
    ExtremeRecord, HalfWidthRecord, QUANTILES, Quantiles, UncertainRow, UncertainRun, UncertainRunRecord,
    band,
};
use crate::results::springs::uncertain_inputs::UncertainInputs;
use crate::verify::{Carrying, averaged_ratio, least_contact, separations};

/// Most samples of a load case: the first ones of those that go through the springs.
pub const MOST_SAMPLES: usize = 128;

/// How runs are evaluated: as the verdict does it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Evaluated {
    /// Time over which Q and P are averaged, s.
    pub window: f64,
    /// Where an averaged P carries Q/P.
    pub carrying: Carrying,
    /// Shortest separation that counts, s.
    pub shortest: f64,
}

/// What is kept of a sample's run.
struct Sample {
    by: Vec<f64>,
    times: Vec<f64>,
    /// P and Q, kN.
    forces: [Vec<f64>; 2],
    ratio: Vec<Option<f64>>,
    separated: Vec<bool>,
    first_separation: Option<f64>,
    completed: bool,
}

/// Tells how far all samples are, and stops each of them.
struct Watched<'a> {
    stage: &'a str,
    done: AtomicUsize,
    total: usize,
    monitor: &'a dyn Monitor,
}

impl Monitor for Watched<'_> {
    fn progress(&self, _: &str, _: usize, _: usize) -> Result<()> {
        self.monitor.progress(self.stage, self.done.load(Ordering::Relaxed), self.total)
    }
}

/// The samples of a load case beside its `nominal` run; why there is no band, if so. The result does not depend on the threads. `left_out` says what the samples do without.
///
/// # Errors
/// An interruption.
pub(crate) fn uncertain(
    departing: &Departing<'_>,
    inputs: &UncertainInputs,
    (nominal, evaluated): (&History, Evaluated),
    (samples, element, left_out): (usize, &str, Vec<String>),
    (stage, monitor): (&str, &dyn Monitor),
) -> Result<std::result::Result<UncertainRun, String>> {
    let distributions: Vec<Distribution> =
        inputs.inputs().into_iter().map(|input| input.distribution).collect();
    let least = least_contact(nominal);
    let samples = samples.min(MOST_SAMPLES);
    let watched = Watched { stage, done: AtomicUsize::new(0), total: samples, monitor };
    let runs: Vec<std::result::Result<Sample, String>> = departures(&distributions, samples)
        .into_par_iter()
        .map(|by| {
            let run = unless_interrupted(departing.run(&inputs.departure(&by), &by, &watched))?;
            watched.done.fetch_add(1, Ordering::Relaxed);
            let history = match run {
                Ok(history) => history,
                Err(error) => return Ok(Err(error.to_string())),
            };
            Ok(Ok(Sample::of(by, &history, evaluated, least)))
        })
        .collect::<Result<_>>()?;
    monitor.progress(stage, samples, samples)?;
    let failure = runs.iter().find_map(|run| run.as_ref().err().cloned());
    let found: Vec<Sample> = runs.into_iter().filter_map(std::result::Result::ok).collect();
    if !is_enough(found.len(), samples) {
        let first = failure.map_or_else(String::new, |reason| format!("; the first: {reason}"));
        let failed = samples - found.len();
        return Ok(Err(format!("{failed} of {samples} samples of the inputs have no run{first}")));
    }
    let rows = rows(&found, samples);
    let of_nominal = Sample::of(Vec::new(), nominal, evaluated, least);
    let width = |of: fn(&UncertainRow) -> Quantiles| half_width(rows.iter().filter_map(of));
    let (Some(p_kn), Some(q_kn)) = (width(|row| row.p), width(|row| row.q)) else {
        return Ok(Err(format!("no time step is reached by enough of the {samples} samples of the inputs")));
    };
    let extreme = |of: fn(&Sample) -> Option<f64>| extreme(&found, samples, of, of(&of_nominal));
    let (Some(largest_p_kn), Some(largest_q_kn)) = (
        extreme(|of| peak(of.forces[0].iter().copied())),
        extreme(|of| peak(of.forces[1].iter().map(|q| q.abs()))),
    ) else {
        return Ok(Err("the samples of the inputs have no time step".into()));
    };
    let record = UncertainRunRecord {
        element: element.into(),
        samples,
        failed: samples - found.len(),
        ended_early: found.iter().filter(|sample| !sample.completed).count(),
        inputs: inputs.records(),
        p_kn,
        q_kn,
        q_over_p: width(|row| row.ratio),
        largest_p_kn,
        largest_q_kn,
        largest_q_over_p: extreme(|of| peak(of.ratio.iter().copied().flatten())),
        separating: found.iter().filter(|sample| sample.first_separation.is_some()).count(),
        first_separation_s: extreme(|of| of.first_separation),
        left_out,
    };
    Ok(Ok(UncertainRun { rows, record }))
}

impl Sample {
    fn of(by: Vec<f64>, history: &History, evaluated: Evaluated, least: f64) -> Self {
        let Evaluated { window, carrying, shortest } = evaluated;
        let apart = separations(history, shortest, least);
        let force =
            |of: fn(&HistoryRow) -> f64| history.rows.iter().map(|row| of(row) / KILONEWTON).collect();
        let separated = |row: &HistoryRow| apart.iter().any(|of| (of.begin_s..of.end_s).contains(&row.time));
        Self {
            by,
            times: history.rows.iter().map(|row| row.time).collect(),
            forces: [force(|row| row.vertical_force), force(|row| row.lateral_force)],
            ratio: averaged_ratio(history, window, &carrying),
            separated: history.rows.iter().map(separated).collect(),
            first_separation: apart.first().map(|of| of.begin_s),
            completed: history.ending == Ending::Completed,
        }
    }
}

/// Largest of some values.
fn peak(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.max_by(f64::total_cmp)
}

/// The bands over time, of so many samples as were tried.
fn rows(found: &[Sample], samples: usize) -> Vec<UncertainRow> {
    let longest = found.iter().map(|sample| &sample.times).max_by_key(|times| times.len());
    let row = |(n, time): (usize, &f64)| {
        let here = || found.iter().filter(move |sample| n < sample.times.len());
        let count = here().count();
        let separated = here().filter(|sample| sample.separated[n]).count();
        UncertainRow {
            time: *time,
            samples: count as f64,
            p: quantiles(here().map(|sample| sample.forces[0][n]), samples),
            q: quantiles(here().map(|sample| sample.forces[1][n]), samples),
            ratio: quantiles(here().filter_map(|sample| sample.ratio[n]), samples),
            separated: separated as f64 / count as f64,
        }
    };
    longest.map_or_else(Vec::new, |times| times.iter().enumerate().map(row).collect())
}

/// Quantiles of the values of enough of all samples.
fn quantiles(values: impl Iterator<Item = f64>, samples: usize) -> Quantiles {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    is_enough(values.len(), samples).then(|| QUANTILES.map(|share| percentile(&values, share)))
}

/// Half width of the bands of 95 %; none where there are none.
fn half_width(quantiles: impl Iterator<Item = [f64; 5]>) -> Option<HalfWidthRecord> {
    let halves: Vec<f64> = quantiles
        .map(|of| {
            let [low, high] = band(of);
            0.5 * (high - low)
        })
        .collect();
    let largest = peak(halves.iter().copied())?;
    let squares: f64 = halves.iter().map(|half| half * half).sum();
    Some(HalfWidthRecord { rms: (squares / halves.len() as f64).sqrt(), largest })
}

/// A value that each run has once, where enough of all samples have it.
fn extreme(
    found: &[Sample],
    samples: usize,
    of: fn(&Sample) -> Option<f64>,
    nominal: Option<f64>,
) -> Option<ExtremeRecord> {
    let (departures, values): (Vec<Vec<f64>>, Vec<f64>) =
        found.iter().filter_map(|sample| Some((sample.by.clone(), of(sample)?))).unzip();
    let [low, _, median, _, high] = quantiles(values.iter().copied(), samples)?;
    let inputs = departures.first().map_or(0, Vec::len);
    // a curved dependence where there are samples enough, else a straight one
    let shares =
        [2, 1].into_iter().find_map(|degree| first_order_indices(&departures, &values, (inputs, degree)));
    Some(ExtremeRecord {
        nominal,
        quantiles: [low, median, high],
        range: [values.iter().copied().fold(f64::INFINITY, f64::min), peak(values.iter().copied())?],
        shares: shares.unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests;
