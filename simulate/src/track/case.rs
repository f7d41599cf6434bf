//! A load case on a track.

use railspring_calibrate::law::NormalLaw;

use super::irregularity::Unevenness;
use super::running::Running;
use super::structure::{Carrier, Track};
use super::way::Way;
use crate::time::function::TimeFunction;

/// How a run begins. The rail is at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// Weights and forces in balance with track and contacts.
    Equilibrium,
    /// The wheels above the rail that carries nothing.
    Above {
        /// How far, m; 0 just touches.
        height: f64,
        /// Velocity downwards, m/s.
        velocity: f64,
    },
}

/// A place whose motion is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name.
    pub name: String,
    /// Beam.
    pub of: Carrier,
    /// Wheel on whose rail it is: 0 the right one, 1 the left.
    pub rail: usize,
    /// Place, m from the rail's first end.
    pub x: f64,
}

/// How the wheels touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Wheels {
    /// Force over the approach of hub and rail.
    pub law: NormalLaw,
    /// Damper beside it while they touch, N·s/m.
    pub damping: f64,
    /// What is uneven under each wheel: the right one first.
    pub unevenness: Vec<Unevenness>,
}

/// A load case.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackCase {
    /// The track, that of either side; none is a rail that does not move.
    pub track: Option<Track>,
    /// What runs on it.
    pub running: Running,
    /// How it touches the rail.
    pub wheels: Wheels,
    /// Rows of the history after the first.
    pub steps: usize,
    /// Time between them, s.
    pub time_step: f64,
    /// Steps of the integration in each.
    pub inner_steps: usize,
    /// Gravity on what runs, m/s²; the track's own weight is taken as carried already.
    pub gravity: f64,
    /// Vertical force on the mass above, or on the wheels without one, N, down.
    pub force: TimeFunction,
    /// Moment about the track on the same, N·m, positive presses on the right wheel; of a wheelset alone.
    pub roll: TimeFunction,
    /// Acceleration of the ground downwards, m/s².
    pub ground: TimeFunction,
    /// Where the wheels are.
    pub way: Way,
    /// How it begins.
    pub start: Start,
    /// Places whose motion is recorded.
    pub probes: Vec<Probe>,
}

impl TrackCase {
    /// How long it takes, s.
    pub fn duration(&self) -> f64 {
        self.steps as f64 * self.time_step
    }

    /// Length of a step of the integration, s.
    pub fn inner_step(&self) -> f64 {
        self.time_step / self.inner_steps as f64
    }
}
