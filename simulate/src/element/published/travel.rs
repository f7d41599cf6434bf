//! The way of the wheel along its rail during a run.

use crate::time::history::Ending;
use crate::time::scenario::Scenario;
use railspring_calibrate::beam::RailBeam;
use railspring_profiles::placement::Departure;

use super::support::{RailLoad, RailSupport};

/// Where the wheel is on its rail.
pub(crate) struct Travel<'a> {
    scenario: &'a Scenario,
    /// Place at t = 0, m from the first end.
    start: f64,
    /// Length of the rail, m; a rigid one has no ends.
    length: Option<f64>,
}

impl<'a> Travel<'a> {
    pub fn new(scenario: &'a Scenario, support: &RailSupport) -> Self {
        let length = support.beam().map(RailBeam::length);
        let start = scenario.start_x.unwrap_or(length.map_or(0.0, |length| 0.5 * length));
        Self { scenario, start, length }
    }

    /// What acts on the rail at `time` (s), and where.
    pub fn load(&self, time: f64) -> RailLoad {
        RailLoad { x: self.x(time), torsion: self.scenario.rail_torsion.as_ref().map_or(0.0, |t| t.at(time)) }
    }

    /// How a run ends whose wheel is beyond an end of the rail at `time` (s).
    pub fn ending(&self, time: f64) -> Option<Ending> {
        // A step's worth of rounding at the far end does not lead off the rail.
        let x = self.x(time);
        let left = self.length.is_some_and(|length| x < -1e-9 || x > length + 1e-9);
        left.then_some(Ending::Departed { time, departure: Departure::RailEnd })
    }

    fn x(&self, time: f64) -> f64 {
        self.start + self.scenario.speed * time
    }
}
