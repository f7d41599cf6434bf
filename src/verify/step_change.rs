//! Numerical uncertainty of a run: how far it changes with steps of another length.

use railspring_simulate::time::history::History;
use railspring_simulate::time::steps::InnerSteps;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::model_change::RunChange;

/// How far a run changes with steps of another length, as long as its motion is determined ([`super::Spread`]).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StepChange {
    /// Length of the longest and of the shortest steps of the run, s.
    pub steps_s: [f64; 2],
    /// The same of the other run, s: half as long with the condensed element, otherwise twice as long where there are longer ones.
    pub other_steps_s: [f64; 2],
    /// What changes.
    #[serde(flatten)]
    pub of: RunChange,
}

impl StepChange {
    /// From a run to the same with other steps within its time steps (s), where one of them ends early over the times of both, and before
    /// the time from which the motion is not determined (s).
    ///
    /// # Errors
    /// How a run ended that has no time step.
    pub fn between(
        [run, other]: [&History; 2],
        steps: [InnerSteps; 2],
        time_step: f64,
        determined_until: Option<f64>,
    ) -> Result<Self, String> {
        Ok(Self {
            steps_s: steps[0].lengths(time_step),
            other_steps_s: steps[1].lengths(time_step),
            of: RunChange::between([run, other], determined_until)?,
        })
    }
}

impl std::fmt::Display for StepChange {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let length = |[longest, shortest]: [f64; 2]| match longest == shortest {
            true => format!("{:.4} ms", 1e3 * longest),
            false => format!("{:.4} to {:.4} ms", 1e3 * shortest, 1e3 * longest),
        };
        let (steps, others) = (length(self.steps_s), length(self.other_steps_s));
        write!(f, "steps of {steps}; with {others} {}", self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::tests::forces_alone;
    use railspring_simulate::time::history::Ending;

    /// ROUNDOFF: quotients and means of numbers of order one.
    const ROUNDOFF: f64 = 1e-12;
    const TWO_AND_ONE: [InnerSteps; 2] = [InnerSteps::Equal(2), InnerSteps::Equal(1)];

    /// P of 100 kN but 120 kN in the middle, Q of `share` of it, N, at `count` times of 1 ms.
    fn run(count: usize, share: f64, last: f64) -> History {
        let row = |n: usize| {
            let vertical_force = if n == 4 { 120e3 } else { 100e3 } + if n + 1 == count { last } else { 0.0 };
            forces_alone(n as f64 * 1e-3, vertical_force, share * vertical_force)
        };
        History { rows: (0..count).map(row).collect(), degrees_of_freedom: 1, ending: Ending::Completed }
    }

    /// Goal: changes are over the largest force of the run itself, the largest and the RMS one of the times that both have; that of the averaged
    /// ratio is a difference; the sentence names both lengths. Accuracy: ROUNDOFF.
    #[test]
    fn changes_are_over_the_runs_own_largest() {
        let near = |a: f64, b: f64| (a - b).abs() < ROUNDOFF;
        let change =
            StepChange::between([&run(9, 0.5, 0.0), &run(9, 0.5, 12e3)], TWO_AND_ONE, 1e-3, None).unwrap();
        assert!(near(change.of.change.p_max, 0.1) && near(change.of.change.p_rms, 0.1 / 3.0), "{change:?}");
        assert!(near(change.of.change.q_max, 0.1) && near(change.of.change.q_rms, 0.1 / 3.0), "{change:?}");
        assert!(
            near(change.of.change.ratio_max.unwrap(), 0.0) && near(change.of.until_s, 8e-3),
            "{change:?}"
        );
        let change =
            StepChange::between([&run(9, 0.5, 0.0), &run(7, 0.6, 0.0)], TWO_AND_ONE, 1e-3, None).unwrap();
        assert!(
            near(change.of.change.p_max, 0.0)
                && near(change.of.change.q_max, 0.2)
                && near(change.of.until_s, 6e-3),
            "{change:?}"
        );
        assert!(
            near(change.of.change.ratio_max.unwrap(), 0.1) && near(change.of.change.ratio_rms.unwrap(), 0.1),
            "{change:?}"
        );
        assert!(
            change.to_string().starts_with("steps of 0.5000 ms; with 1.0000 ms P changes by 0.00 %"),
            "{change}"
        );
        let still = run(5, 0.0, 0.0);
        let change = StepChange::between([&still, &still], [InnerSteps::Equal(1); 2], 1e-3, None).unwrap();
        assert_eq!(
            (change.of.change.q_rms, change.of.change.q_max, change.of.change.ratio_max),
            (0.0, 0.0, Some(0.0))
        );
        // without a time step there is nothing to compare, and no change of zero
        let unknown = StepChange::between([&still, &run(1, 0.5, 0.0)], TWO_AND_ONE, 1e-3, None).unwrap_err();
        assert!(unknown.starts_with("one of the two runs has no time step: ran to"), "{unknown}");
    }
}
