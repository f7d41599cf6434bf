//! A run of a model with its numerical uncertainty.

use railspring_simulate::time::history::History;

use super::change::{COVERAGE, scales};
use super::model_change::{ModelChange, RunChange};
use super::signals::Carrying;
use super::spread::Spread;
use super::step_change::StepChange;

/// Error of averaged forces of which nothing else is known, of their largest: differences of sums over as many steps as a run may have.
const ROUNDOFF: f64 = 1e-9;

/// The numerical uncertainty of a run, or why that is not known.
#[derive(Debug, Clone, PartialEq)]
pub struct NumericalUncertainty {
    /// What other steps change.
    pub steps: Result<StepChange, String>,
    /// What an input that is 0.1 % larger changes.
    pub spread: Result<Spread, String>,
    /// What each other discretisation of the model changes.
    pub discretisation: Vec<Result<ModelChange, String>>,
}

/// A run of a model, and what is known of its uncertainty.
#[derive(Debug, Clone, Copy)]
pub struct ModelRun<'a> {
    /// The run.
    pub history: &'a History,
    /// What other steps change.
    pub steps: Option<&'a StepChange>,
    /// The same load case with an input that is 0.1 % larger, and how far that is from the run.
    pub disturbed: Option<(&'a History, &'a Spread)>,
    /// What other discretisations of the model change.
    pub discretisation: &'a [ModelChange],
}

impl<'a> ModelRun<'a> {
    /// A run of which nothing else is known.
    pub fn alone(history: &'a History) -> Self {
        Self { history, steps: None, disturbed: None, discretisation: &[] }
    }

    /// From when on the motion is not determined, s.
    pub fn determined_until(&self) -> Option<f64> {
        self.disturbed.and_then(|(_, spread)| spread.determined_until_s)
    }

    /// What steps and discretisations change, each by itself.
    pub fn changes(&self) -> impl Iterator<Item = &'a RunChange> {
        let steps = self.steps.map(|steps| &steps.of);
        steps.into_iter().chain(self.discretisation.iter().map(|model| &model.of))
    }

    /// Where the averaged P carries Q/P so that it is off by `limit` at most. The errors of the averaged forces are twice the RMS changes with the steps, the
    /// discretisations and the input, together as the root of their squares.
    pub fn carrying(&self, limit: f64) -> Carrying {
        let scales = scales(self.history);
        let by_input = self.disturbed.map(|(_, spread)| &spread.change);
        let all = self.changes().map(|of| &of.change).chain(by_input);
        let squares = all.fold([0.0; 2], |sum, change| {
            let averaged = change.averaged(scales);
            [0, 1].map(|k| sum[k] + averaged[k] * averaged[k])
        });
        let error = |k: usize| (COVERAGE * squares[k].sqrt()).max(ROUNDOFF * scales[k]);
        Carrying { errors: [error(0), error(1)], limit }
    }
}
