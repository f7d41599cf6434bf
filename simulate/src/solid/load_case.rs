//! What a load case says of the steps and of the hub of the solid model.

use crate::time::newmark::Newmark;
use crate::time::scenario::Scenario;
use crate::time::steps::InnerSteps;

/// The scheme of the longest steps of a run: average acceleration.
pub(super) fn longest(scenario: &Scenario) -> Newmark {
    let longest = match scenario.inner_steps {
        InnerSteps::Equal(_) => scenario.shortest_step(),
        InnerSteps::Adaptive(_) => scenario.time_step,
    };
    Newmark::new(longest, 0.0)
}

/// What holds the hub of a wheel in a step.
#[derive(Clone, Copy, Default)]
pub(super) struct HubSprings<'s> {
    /// Its free motions (0 to 5: translations, rotations), none of a body that is held.
    pub free: &'s [usize],
    /// Stiffness against its vertical motion: suspension and suspended mass, N/m.
    pub vertical: f64,
    /// Stiffness against its rotations about the track and about the vertical, N·m/rad.
    pub axle: f64,
}

impl HubSprings<'_> {
    /// The stiffness against a motion.
    pub fn against(&self, motion: usize) -> f64 {
        match motion {
            2 => self.vertical,
            3 | 5 => self.axle,
            _ => 0.0,
        }
    }
}

/// Free motions of the hub (1 to 5: translations y, z, rotations). A wheel that moves along the rail rolls: it turns about its axle as the rail has it.
pub(super) fn hub_motions(scenario: &Scenario) -> &'static [usize] {
    match scenario.rotations_held {
        true if scenario.speed != 0.0 => &[1, 2, 4],
        true => &[1, 2],
        false => &[1, 2, 3, 4, 5],
    }
}
