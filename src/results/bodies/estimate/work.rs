//! What a command is going to do with the solids.

use railspring_simulate::time::steps::InnerSteps;

use crate::python::Purpose;
use crate::results::bodies::input::SolidsInput;

/// Steps of the integration in a time step of a published load case in the mean, where they adapt themselves.
const ADAPTED_STEPS: f64 = 3.0;

/// What a command is going to do with the solids.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Work {
    /// Whether it calibrates, or answers the questions of a cross-check, which takes as much.
    pub calibrate: bool,
    /// Load cases of the solid model: name and steps of the integration.
    pub solids: Vec<(String, usize)>,
    /// Whether its places are those of a table: under all loads of the calibration, and without fields.
    pub in_table: bool,
    /// The questions to the reference.
    pub reference: Option<Purpose>,
}

impl Work {
    /// What the study asks for: with or without the calibration, with or without its load cases.
    pub fn of(input: &SolidsInput<'_>, calibrate: bool, solids: bool) -> Self {
        let cases = input.cases.iter().filter(|(_, case)| solids && case.solid);
        let solids = cases
            .map(|(name, case)| {
                (name.clone(), (case.scenario.steps as f64 * steps_in_each(input)).ceil() as usize)
            })
            .collect();
        Self { calibrate, solids, ..Self::default() }
    }

    /// The tool's part of a cross-check, and that of the reference.
    pub fn of_crosscheck(reference: Purpose) -> Self {
        Self { calibrate: true, reference: Some(reference), ..Self::default() }
    }
}

/// Steps of the integration in a time step.
pub(super) fn steps_in_each(input: &SolidsInput<'_>) -> f64 {
    match input.solid.steps() {
        InnerSteps::Equal(count) => count as f64,
        InnerSteps::Adaptive(control) => ADAPTED_STEPS.min(control.most as f64),
    }
}
