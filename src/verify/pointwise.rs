//! Two runs beside each other step by step, as long as the motion of the solid model is determined.
//!
//! The same differences are taken of simple and solid model, and of each model with its own disturbed run, so that what a model is worth
//! itself stands beside what the two differ by.

use railspring_calibrate::history::{Ending, History};

use super::change::{FORCES, least_contact, over, peaks, scales, together};
use super::contact::ContactDifference;
use super::limits::Limits;
use super::line::Criterion;
use super::model_run::ModelRun;
use super::signals::{Carrying, averaged_ratio};
use super::{Check, column, peak, rms, rows_before};

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

/// Differences of two runs. None where a comparison cannot be made.
struct Differences {
    /// RMS and largest one of P, then of Q, over the solid's peaks.
    forces: [[Option<f64>; 2]; 2],
    /// RMS and largest one of the averaged Q/P.
    ratio: [Option<f64>; 2],
    /// At how many time steps both have it.
    ratio_steps: usize,
    /// Of separations and contact modes.
    contact: Option<ContactDifference>,
    /// Time at which the wheel leaves the profile, s.
    departure: Option<f64>,
}

impl<'a> Scope<'a> {
    /// Times before `end` (s), or all, beside a run of the solid model.
    pub fn new(solid: &History, limits: &'a Limits, end: Option<f64>) -> Self {
        Self { limits, peaks: peaks(solid), least: least_contact(solid), end }
    }

    fn rows(&self, run: &History) -> usize {
        self.end.map_or(run.rows.len(), |end| rows_before(run, end))
    }

    fn differences(&self, [a, b]: [&History; 2], carrying: [&Carrying; 2]) -> Differences {
        let limits = self.limits;
        let rows = self.rows(a).min(self.rows(b));
        // a comparison needs a step after the initial state
        let known = |value: f64| (rows > 1).then_some(value);
        let forces = [0, 1].map(|k| {
            let [a, b] = [a, b].map(|run| column(run, FORCES[k]));
            let differences: Vec<f64> = (0..rows).map(|n| a[n] - b[n]).collect();
            [rms(&differences), peak(&differences)].map(|value| known(over(value, self.peaks[k])))
        });
        let [of_a, of_b] = [(a, carrying[0]), (b, carrying[1])]
            .map(|(run, carrying)| averaged_ratio(run, limits.ratio_window_s, carrying));
        let ratio: Vec<f64> = (0..rows).filter_map(|n| Some(of_a[n]? - of_b[n]?)).collect();
        let of_ratio = |measure: fn(&[f64]) -> f64| (!ratio.is_empty()).then(|| measure(&ratio));

        let departure = match (a.ending, b.ending) {
            (Ending::Departed { time: a, departure: to }, Ending::Departed { time: b, departure: other }) => {
                (to == other).then_some((a - b).abs())
            }
            _ => None,
        };
        Differences {
            forces,
            ratio: [of_ratio(rms), of_ratio(peak)],
            ratio_steps: ratio.len(),
            contact: (rows > 1).then(|| ContactDifference::between([a, b], rows, self.least, limits)),
            departure,
        }
    }

    /// What a run differs by from itself: with an input that is 0.1 % larger and with other steps, both together as the root of their squares.
    fn worth(&self, run: &ModelRun, carrying: &Carrying) -> Differences {
        let nothing = Differences {
            forces: [[None; 2]; 2],
            ratio: [None; 2],
            ratio_steps: 0,
            contact: None,
            departure: None,
        };
        let mut worth =
            run.disturbed.map_or(nothing, |(other, _)| self.differences([other, run.history], [carrying; 2]));
        let Some(steps) = run.steps else { return worth };
        let by_steps = steps.change.forces(scales(run.history));
        for k in [0, 1] {
            for measure in [0, 1] {
                let by_steps = over(by_steps[k][measure], self.peaks[k]);
                worth.forces[k][measure] = together(worth.forces[k][measure], Some(by_steps));
            }
        }
        for (worth, steps) in worth.ratio.iter_mut().zip([steps.change.ratio_rms, steps.change.ratio_max]) {
            *worth = together(*worth, steps);
        }
        worth.contact = Some(worth.contact.map_or(steps.contact, |contact| contact.with(&steps.contact)));
        worth
    }

    /// The lines on forces, averaged Q/P, separations, modes and departures.
    pub fn checks(&self, simple: &ModelRun, solid: &ModelRun) -> Vec<Check> {
        let limits = self.limits;
        let runs = [simple, solid];
        let carrying = runs.map(|run| run.carrying(limits.ratio_max));
        let found = self.differences(runs.map(|run| run.history), carrying.each_ref());
        let worth = [0, 1].map(|k| self.worth(runs[k], &carrying[k]));
        let rows = runs.map(|run| self.rows(run.history)).into_iter().min().unwrap_or(0);
        let until = rows.checked_sub(1).map_or(0.0, |last| solid.history.rows[last].time);
        let line = |criterion: Criterion, of: &dyn Fn(&Differences) -> Option<f64>| {
            criterion.line_beside(of(&found), worth.each_ref().map(of)).taken_over([0.0, until])
        };
        let mut checks = vec![self.departure(runs.map(|run| run.history), &found, &worth)];
        let forces =
            [[limits.vertical_rms(), limits.vertical_max()], [limits.lateral_rms(), limits.lateral_max()]];
        for (k, [of_rms, of_max]) in forces.into_iter().enumerate() {
            checks.push(Ok(line(of_rms, &|d| d.forces[k][0])));
            checks.push(Ok(line(of_max, &|d| d.forces[k][1])));
        }
        for (measure, criterion) in [limits.ratio_rms(), limits.ratio_max()].into_iter().enumerate() {
            let line = line(criterion, &|d| d.ratio[measure]);
            let all = found.ratio_steps == rows;
            checks.push(Ok(if all { line } else { line.noted(carried(&found, &carrying, rows)) }));
        }
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
        worth: &[Differences; 2],
    ) -> Check {
        let criterion = self.limits.departure_s();
        let not_applicable = |reason| -> Check { Err(criterion.not_applicable(reason)) };
        match (simple.ending, solid.ending) {
            (Ending::Departed { .. }, Ending::Departed { .. }) => {
                let line = criterion.line_beside(found.departure, worth.each_ref().map(|own| own.departure));
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

/// At how many of the steps both models' averaged P carries a ratio, and why not at all.
fn carried(found: &Differences, carrying: &[Carrying; 2], rows: usize) -> String {
    let error =
        |Carrying { errors: [p, q], .. }: &Carrying| format!("{:.2} and {:.2} kN", p * 1e-3, q * 1e-3);
    format!(
        "where P carries it, at {} of {rows} steps: averaged P and Q may be off by {} in the simple and {} in the solid model, which \
         leaves Q/P off by {} at most",
        found.ratio_steps,
        error(&carrying[0]),
        error(&carrying[1]),
        carrying[1].limit
    )
}
