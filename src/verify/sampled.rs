//! Lines on the runs as samples, from where on the motion of the solid model is not determined.

use railspring_simulate::time::history::History;

use super::change::{least_contact, over, peaks};
use super::limits::Limits;
use super::line::{Criterion, Line};
use super::model_run::ModelRun;
use super::series::rows_before;
use super::signals::separations;
use super::statistics::{LEAST_BLOCKS, MOST_BLOCKS, NUMBERS, OF_FORCE, chance, numbers, sample, step};

/// The row from which statistics are compared, if there is one: where the solid's motion is not determined any more, and enough is left.
pub(super) fn begin(simple: &History, solid: &ModelRun, limits: &Limits) -> Option<usize> {
    let first = rows_before(solid.history, solid.determined_until()?);
    let rows = simple.rows.len().min(solid.history.rows.len()).min(solid.disturbed?.0.rows.len());
    let block = rows_of_window(solid.history, limits);
    (rows.saturating_sub(first) >= LEAST_BLOCKS * block).then_some(first)
}

/// Rows over which Q/P is averaged.
fn rows_of_window(run: &History, limits: &Limits) -> usize {
    (limits.ratio_window_s / step(run)).ceil().max(1.0) as usize
}

/// The lines on both runs from a row of [`begin`] on.
pub(super) fn lines(simple: &ModelRun, solid: &ModelRun, limits: &Limits, first: usize) -> Vec<Line> {
    let step = step(solid.history);
    let least = least_contact(solid.history);
    let both = [simple.history, solid.history];
    let end = both.map(|run| run.rows.len()).into_iter().min().unwrap_or(first);
    let [of_simple, of_solid] = both.map(|run| numbers(&sample(run, first..end, limits, least), 0..0, step));
    let own = |run: &ModelRun| {
        let other = run.disturbed?.0;
        let end = run.history.rows.len().min(other.rows.len());
        let blocks = (end.checked_sub(first)? / rows_of_window(run.history, limits)).min(MOST_BLOCKS);
        let samples = || [run.history, other].map(|run| sample(run, first..end, limits, least));
        (blocks >= LEAST_BLOCKS).then(|| chance(samples().each_ref().map(Vec::as_slice), step, blocks))
    };
    let uncertainty = [simple, solid].map(|run| {
        let by_chance = own(run)?;
        let all = |n: usize| {
            let changes = run.changes().filter_map(|of| of.afterwards);
            changes.fold(by_chance[n], |sum, of| sum.hypot(of.statistics[n]))
        };
        Some(std::array::from_fn::<f64, NUMBERS, _>(all))
    });
    let peaks = peaks(solid.history);
    // No count is known better than by one: the ends of the time cut off a separation. Nor is it known whether one is long enough whose length is the
    // shortest but for a step of the history: each of them counts or does not.
    let one = 1.0 / ((end - first) as f64 * step);
    let times = [first, end - 1].map(|row| solid.history.rows[row].time);
    let least_rate = |run: &ModelRun| {
        let unclear = separations(run.history, 0.0, least)
            .iter()
            .filter(|s| s.begin_s >= times[0] && s.begin_s <= times[1])
            .filter(|s| (s.length() - limits.separation_shortest_s).abs() < 1.01 * step)
            .count();
        one * (UNCLEAR_95 * (unclear as f64).sqrt()).hypot(1.0)
    };
    let least_rates = [simple, solid].map(least_rate);
    let rate = of_solid[RATE].max(one);
    let line = |n: usize, criterion: Criterion| {
        let value = |difference: f64| match n {
            n if n < 2 * OF_FORCE => over(difference, peaks[n / OF_FORCE]),
            RATE => difference / rate,
            _ => difference,
        };
        let of = |k: usize| {
            let least = if n == RATE { least_rates[k] } else { 0.0 };
            uncertainty[k].map(|uncertainty| value(uncertainty[n].max(least)))
        };
        let uncertainty = [of(0), of(1)];
        criterion.line_beside(Some(value((of_simple[n] - of_solid[n]).abs())), uncertainty).taken_over(times)
    };
    let forces = OF_FORCES.into_iter().map(|meaning| Criterion { meaning, ..limits.statistics() });
    let modes = OF_MODES.into_iter().map(|meaning| Criterion { meaning, ..limits.mode_fraction() });
    forces.chain([limits.separation_rate()]).chain(modes).enumerate().map(|(n, c)| line(n, c)).collect()
}

/// What the sum of many that count or do not, with even chances, differs by from its mean in 95 of 100 cases, over the root of their number: 1.96/2.
const UNCLEAR_95: f64 = 0.98;

/// Place of the separations a second.
const RATE: usize = 2 * OF_FORCE;

const OF_FORCES: [&str; 2 * OF_FORCE] = [
    "Undetermined motion: mean of P, difference over the solid's peak",
    "Undetermined motion: RMS of P, difference over the solid's peak",
    "Undetermined motion: 5 % quantile of P, difference over the solid's peak",
    "Undetermined motion: median of P, difference over the solid's peak",
    "Undetermined motion: 95 % quantile of P, difference over the solid's peak",
    "Undetermined motion: mean of Q, difference over the solid's peak",
    "Undetermined motion: RMS of Q, difference over the solid's peak",
    "Undetermined motion: 5 % quantile of Q, difference over the solid's peak",
    "Undetermined motion: median of Q, difference over the solid's peak",
    "Undetermined motion: 95 % quantile of Q, difference over the solid's peak",
];

const OF_MODES: [&str; 3] = [
    "Undetermined motion: time sticking, difference of the fractions",
    "Undetermined motion: time sliding, difference of the fractions",
    "Undetermined motion: time separated, difference of the fractions",
];
