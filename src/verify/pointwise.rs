//! Two runs beside each other step by step, as long as the motion of the solid model is determined.
//!
//! The same differences are taken of simple and solid model, and of each model with its own disturbed run, so that what a model is worth
//! itself stands beside what the two differ by.

use std::ops::Range;

use railspring_simulate::time::history::{Ending, History};

use super::change::{FORCES, least_contact, over, peaks, scales, together};
use super::contact::ContactDifference;
use super::limits::Limits;
use super::line::{Check, Criterion, Line};
use super::model_change::RunChange;
use super::model_run::ModelRun;
use super::series::{column, peak, rms, rows_before};
use super::signals::{Carrying, averaged_forces, averaged_ratio};

/// What is compared, and over what.
pub(super) struct Scope<'a> {
    limits: &'a Limits,
    /// The largest P and Q of the solid, N.
    peaks: [f64; 2],
    /// Under which a wheel counts as separated, N.
    least: f64,
    /// Times before this are compared, s.
    end: Option<f64>,
}

/// A wheel whose averaged P is this share of the largest P carries a load.
const LOADED: f64 = 0.1;

/// Which part of a run is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PartOfRun {
    /// As long as its motion is determined.
    Determined,
    /// From then on.
    Undetermined,
}

/// Differences of two runs. None where a comparison cannot be made.
struct Differences {
    /// RMS and largest one of P, then of Q, over the solid's peaks.
    forces: [[Option<f64>; 2]; 2],
    /// Of separations and contact modes.
    contact: Option<ContactDifference>,
    /// Time at which the wheel leaves the profile, s.
    departure: Option<f64>,
}

/// Differences of the averaged Q/P of two runs over some rows.
#[derive(Debug, Clone, Copy)]
struct Ratio {
    /// RMS and largest one.
    values: [Option<f64>; 2],
    /// At how many time steps the second run's P carries it.
    steps: usize,
    /// At how many its averaged P is a load, and at how many of these it carries the ratio.
    loaded: [usize; 2],
}

impl<'a> Scope<'a> {
    /// Times before `end` (s), or all, beside a run of the solid model.
    pub fn new(solid: &History, limits: &'a Limits, end: Option<f64>) -> Self {
        Self { limits, peaks: peaks(solid), least: least_contact(solid), end }
    }

    fn rows(&self, run: &History) -> usize {
        self.end.map_or(run.rows.len(), |end| rows_before(run, end))
    }

    /// Differences of Q/P over some rows, where P of the second run carries it; no value where the first one has none there.
    fn ratio(&self, [a, b]: [&History; 2], carrying: &Carrying, rows: Range<usize>) -> Ratio {
        let window = self.limits.ratio_window_s;
        let of_a = averaged_ratio(a, window, &Carrying::EXACT);
        let of_b = averaged_ratio(b, window, carrying);
        let [p, _] = averaged_forces(b, window);
        let loaded: Vec<usize> = rows.clone().filter(|n| p[*n] >= LOADED * self.peaks[0]).collect();
        let loaded = [loaded.len(), loaded.iter().filter(|n| of_b[**n].is_some()).count()];
        let carried = rows.filter_map(|n| Some((of_a[n], of_b[n]?)));
        let differences: Vec<Option<f64>> = carried.map(|(a, b)| Some(a? - b)).collect();
        let steps = differences.len();
        let differences: Option<Vec<f64>> = differences.into_iter().collect();
        let differences = differences.filter(|all| !all.is_empty());
        let values = [rms as fn(&[f64]) -> f64, peak].map(|of| differences.as_deref().map(of));
        Ratio { values, steps, loaded }
    }

    /// What a run's Q/P differs by from itself over some rows: with the larger input there, and with other steps and discretisations.
    fn ratio_uncertainty(
        &self,
        run: &ModelRun,
        carrying: &Carrying,
        rows: Range<usize>,
        of: PartOfRun,
    ) -> [Option<f64>; 2] {
        let by_input = run.disturbed.map_or([None; 2], |(other, _)| {
            let rows = rows.start.min(other.rows.len())..rows.end.min(other.rows.len());
            self.ratio([other, run.history], carrying, rows).values
        });
        let changes = run.changes().filter_map(|change| match of {
            PartOfRun::Determined => Some([change.change.ratio_rms, change.change.ratio_max]),
            PartOfRun::Undetermined => change.afterwards.map(|of| [of.ratio_rms, of.ratio_max]),
        });
        changes.fold(by_input, |sum, of| [0, 1].map(|n| together(sum[n], of[n])))
    }

    /// The lines on Q/P over some rows, each with what goes before its meaning, and that on the steps at which it is not compared.
    pub fn ratio_lines(
        &self,
        simple: &ModelRun,
        solid: &ModelRun,
        rows: Range<usize>,
        of: PartOfRun,
    ) -> Vec<Line> {
        let limits = self.limits;
        let runs = [simple, solid];
        let carrying = runs.map(|run| run.carrying(limits.ratio_max));
        let found = self.ratio(runs.map(|run| run.history), &carrying[1], rows.clone());
        let uncertainty = [0, 1].map(|k| self.ratio_uncertainty(runs[k], &carrying[k], rows.clone(), of));
        let times = [rows.start, rows.end.max(1) - 1].map(|row| solid.history.rows[row].time);
        let meanings = match of {
            PartOfRun::Determined => {
                [limits.ratio_rms(), limits.ratio_max(), limits.ratio_left_out()].map(|c| c.meaning)
            }
            PartOfRun::Undetermined => [
                "Undetermined motion: averaged Q/P, RMS difference",
                "Undetermined motion: averaged Q/P, largest difference",
                "Undetermined motion: loaded time at which the averaged Q/P of the solid is not known",
            ],
        };
        let mut lines = Vec::new();
        for (n, criterion) in [limits.ratio_rms(), limits.ratio_max()].into_iter().enumerate() {
            let criterion = Criterion { meaning: meanings[n], ..criterion };
            let line = criterion.line_beside(found.values[n], uncertainty.map(|of| of[n])).taken_over(times);
            lines.push(match found.values[n] {
                None if found.steps > 0 => {
                    line.noted("the simple model has no P where the solid's carries it")
                }
                _ => line,
            });
        }
        let [loaded, carrying_load] = found.loaded;
        let left_out = (loaded > 0).then(|| 1.0 - carrying_load as f64 / loaded as f64);
        let criterion = Criterion { meaning: meanings[2], ..limits.ratio_left_out() };
        let line = criterion.line(left_out).taken_over(times);
        let all = rows.len();
        lines.push(if found.steps == all { line } else { line.noted(carried(&found, &carrying[1], all)) });
        lines
    }

    fn differences(&self, [a, b]: [&History; 2]) -> Differences {
        let limits = self.limits;
        let rows = self.rows(a).min(self.rows(b));
        // a comparison needs a step after the initial state
        let known = |value: f64| (rows > 1).then_some(value);
        let forces = [0, 1].map(|k| {
            let [a, b] = [a, b].map(|run| column(run, FORCES[k]));
            let differences: Vec<f64> = (0..rows).map(|n| a[n] - b[n]).collect();
            [rms(&differences), peak(&differences)].map(|value| known(over(value, self.peaks[k])))
        });
        let departure = match (a.ending, b.ending) {
            (Ending::Departed { time: a, departure: to }, Ending::Departed { time: b, departure: other }) => {
                (to == other).then_some((a - b).abs())
            }
            _ => None,
        };
        Differences {
            forces,
            contact: (rows > 1).then(|| ContactDifference::between([a, b], rows, self.least, limits)),
            departure,
        }
    }

    /// What a run differs by from itself: with an input that is 0.1 % larger, with other steps and with other discretisations, together as the root of
    /// their squares.
    fn uncertainty(&self, run: &ModelRun) -> Differences {
        let nothing = Differences { forces: [[None; 2]; 2], contact: None, departure: None };
        let mut uncertainty =
            run.disturbed.map_or(nothing, |(other, _)| self.differences([other, run.history]));
        for RunChange { change, contact, .. } in run.changes() {
            let changed = change.forces(scales(run.history));
            for k in [0, 1] {
                for measure in [0, 1] {
                    let changed = over(changed[k][measure], self.peaks[k]);
                    uncertainty.forces[k][measure] = together(uncertainty.forces[k][measure], Some(changed));
                }
            }
            uncertainty.contact = Some(uncertainty.contact.map_or(*contact, |known| known.with(contact)));
        }
        uncertainty
    }

    /// The lines on forces, averaged Q/P, separations, modes and departures.
    pub fn checks(&self, simple: &ModelRun, solid: &ModelRun) -> Vec<Check> {
        let limits = self.limits;
        let runs = [simple, solid];
        let found = self.differences(runs.map(|run| run.history));
        let uncertainty = runs.map(|run| self.uncertainty(run));
        let rows = runs.map(|run| self.rows(run.history)).into_iter().min().unwrap_or(0);
        let until = rows.checked_sub(1).map_or(0.0, |last| solid.history.rows[last].time);
        let line = |criterion: Criterion, of: &dyn Fn(&Differences) -> Option<f64>| {
            criterion.line_beside(of(&found), uncertainty.each_ref().map(of)).taken_over([0.0, until])
        };
        let mut checks = vec![self.departure(runs.map(|run| run.history), &found, &uncertainty)];
        let forces =
            [[limits.vertical_rms(), limits.vertical_max()], [limits.lateral_rms(), limits.lateral_max()]];
        for (k, [of_rms, of_max]) in forces.into_iter().enumerate() {
            checks.push(Ok(line(of_rms, &|d| d.forces[k][0])));
            checks.push(Ok(line(of_max, &|d| d.forces[k][1])));
        }
        checks.extend(self.ratio_lines(simple, solid, 0..rows, PartOfRun::Determined).into_iter().map(Ok));
        let times = [limits.separation_begin_s(), limits.separation_end_s()];
        let contact = found.contact.unwrap_or_default();
        for (n, criterion) in times.into_iter().enumerate() {
            checks.push(match contact.times()[n] {
                Some(_) => Ok(line(criterion, &|d| d.contact.and_then(|contact| contact.times()[n]))),
                None => Err(criterion.not_applicable(match (contact.unmatched, contact.begin_s) {
                    (_, Some(_)) => "none ends while the motion is determined",
                    (0, None) => "neither model separates",
                    (_, None) => {
                        "no separation of one model meets one of the other; each counts as unmatched"
                    }
                })),
            });
        }
        let unmatched = |d: &Differences| d.contact.map(|contact| contact.unmatched as f64);
        checks.push(Ok(line(limits.separations_unmatched(), &unmatched)));
        let meanings = [
            "Time sticking, difference of the fractions",
            "Time sliding, difference of the fractions",
            "Time separated, difference of the fractions",
        ];
        for (n, meaning) in meanings.into_iter().enumerate() {
            let criterion = Criterion { meaning, ..limits.mode_fraction() };
            checks.push(Ok(line(criterion, &|d| d.contact.map(|contact| contact.modes[n]))));
        }
        checks
    }

    /// The times at which the two wheels leave the profile. Both of them have to, to the same side; a single one fails in
    /// [`super::run_lines`] already, as both do: the times only say whether the models derail alike.
    fn departure(
        &self,
        [simple, solid]: [&History; 2],
        found: &Differences,
        uncertainty: &[Differences; 2],
    ) -> Check {
        let criterion = self.limits.departure_s();
        let not_applicable = |reason| -> Check { Err(criterion.not_applicable(reason)) };
        match (simple.ending, solid.ending) {
            (Ending::Departed { .. }, Ending::Departed { .. }) => {
                let line =
                    criterion.line_beside(found.departure, uncertainty.each_ref().map(|own| own.departure));
                Ok(if found.departure.is_some() { line } else { line.noted("to different sides") })
            }
            (Ending::EndOfSurface { .. }, _) | (_, Ending::EndOfSurface { .. }) => {
                not_applicable("a run ended at the end of its model's surfaces")
            }
            (Ending::Completed, Ending::Completed) => not_applicable("neither model leaves the profile"),
            _ => not_applicable("only one model leaves the profile"),
        }
    }
}

/// At how many of the steps the solid's averaged P carries a ratio, and why not at all.
fn carried(found: &Ratio, Carrying { errors: [p, q], limit }: &Carrying, rows: usize) -> String {
    let (steps, [loaded, carrying_load]) = (found.steps, found.loaded);
    format!(
        "P of the solid carries it at {steps} of {rows} steps, {carrying_load} of the {loaded} with an averaged P of a tenth of the peak: averaged P and Q of the solid may be off by {:.2} and {:.2} kN, which leaves Q/P off by \
         {limit} at most there",
        p * 1e-3,
        q * 1e-3
    )
}
