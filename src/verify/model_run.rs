//! A run of a model with what it is worth.

use railspring_calibrate::history::History;

use super::change::scales;
use super::signals::Carrying;
use super::spread::Spread;
use super::step_change::StepChange;

/// Error of averaged forces of which nothing else is known, of their largest: differences of sums over as many steps as a run may have.
const ROUNDOFF: f64 = 1e-9;

/// What a run is worth, or why that is not known.
#[derive(Debug, Clone, PartialEq)]
pub struct Worth {
    /// What other steps change.
    pub steps: Result<StepChange, String>,
    /// What an input that is 0.1 % larger changes.
    pub spread: Result<Spread, String>,
}

/// A run of a model, and what is known of its worth.
#[derive(Debug, Clone, Copy)]
pub struct ModelRun<'a> {
    /// The run.
    pub history: &'a History,
    /// What other steps change.
    pub steps: Option<&'a StepChange>,
    /// The same load case with an input that is 0.1 % larger, and how far that is from the run.
    pub disturbed: Option<(&'a History, &'a Spread)>,
}

impl<'a> ModelRun<'a> {
    /// A run of which nothing else is known.
    pub fn alone(history: &'a History) -> Self {
        Self { history, steps: None, disturbed: None }
    }

    /// From when on the motion is not determined, s.
    pub fn determined_until(&self) -> Option<f64> {
        self.disturbed.and_then(|(_, spread)| spread.determined_until_s)
    }

    /// Where the averaged P carries Q/P so that it is off by `limit` at most. The errors of the averaged forces are the largest changes with the steps and
    /// with the input.
    pub fn carrying(&self, limit: f64) -> Carrying {
        let scales = scales(self.history);
        let [by_steps, by_input] =
            [self.steps.map(|steps| steps.change), self.disturbed.map(|(_, spread)| spread.change)]
                .map(|change| change.map_or([0.0; 2], |change| change.averaged(scales)));
        let error = |k: usize| by_steps[k].hypot(by_input[k]).max(ROUNDOFF * scales[k]);
        Carrying { errors: [error(0), error(1)], limit }
    }
}
