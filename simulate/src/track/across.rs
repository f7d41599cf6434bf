//! A load case of a wheelset across the track, and what its run gives.

use crate::element::published::{Derailment, WheelContact, WheelsetContact};

use super::irregularity::{Irregularity, Unevenness};
use super::rails::{RailSeen, TwoRails};
use super::swaying::{SuspensionForce, SwayingWheelset};
use super::way::Way;
use crate::time::function::TimeFunction;

/// How a run across the track begins. The rails are at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StartAcross {
    /// Weights and forces in balance with track and contacts, without friction.
    Equilibrium,
    /// The wheelset above rails that carry nothing.
    Above {
        /// How far above where it just touches, m.
        height: f64,
        /// Velocities to the right and down, m/s.
        velocity: [f64; 2],
    },
}

/// What is uneven under a wheel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UnevenRail {
    /// Heights of rail and wheel.
    pub vertical: Unevenness,
    /// How far the rail lies towards its field side, m.
    pub lateral: Vec<Irregularity>,
}

/// A moment about the axis of a rail.
#[derive(Debug, Clone, PartialEq)]
pub struct RailTorsion {
    /// Rail: 0 the right one, 1 the left.
    pub rail: usize,
    /// Place, m from the rail's first end.
    pub x: f64,
    /// N·m, positive tilts the head to the field side.
    pub moment: TimeFunction,
}

/// A place of a rail whose motion is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeAcross {
    /// Name.
    pub name: String,
    /// Rail: 0 the right one, 1 the left.
    pub rail: usize,
    /// Place, m from the rail's first end.
    pub x: f64,
}

/// A load case of a wheelset on two rails.
#[derive(Debug, Clone)]
pub struct AcrossCase {
    /// The rails; none do not move.
    pub rails: Option<TwoRails>,
    /// The wheelset.
    pub wheelset: SwayingWheelset,
    /// How it touches the rails.
    pub contact: WheelsetContact,
    /// What is uneven under each wheel: the right one first.
    pub uneven: [UnevenRail; 2],
    /// Rows of the history after the first.
    pub steps: usize,
    /// Time between them, s.
    pub time_step: f64,
    /// Steps of the integration in each.
    pub inner_steps: usize,
    /// Gravity on what runs, m/s².
    pub gravity: f64,
    /// Force to the right on the mass above, or on the axle without one, N.
    pub lateral_force: TimeFunction,
    /// Force down on the same, N.
    pub vertical_force: TimeFunction,
    /// Moment about the track on the same, N·m, positive presses on the right wheel.
    pub roll: TimeFunction,
    /// Moments on the rails.
    pub torsion: Vec<RailTorsion>,
    /// Acceleration of the ground to the right and down, m/s².
    pub ground: [TimeFunction; 2],
    /// Where the wheelset is.
    pub way: Way,
    /// How it begins.
    pub start: StartAcross,
    /// Places whose motion is recorded.
    pub probes: Vec<ProbeAcross>,
}

/// How a run across the track ended; one that ends early is a result with all rows before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AcrossEnding {
    /// All steps were done.
    Completed,
    /// The wheelset came to an end of the rails.
    RailEnd {
        /// End of the first step that has it beyond, s.
        time: f64,
    },
    /// A wheel is off its rail.
    Derailed {
        /// End of the first step that has it off, s.
        time: f64,
        /// Wheel: 0 the right one, 1 the left.
        wheel: usize,
        /// How it came there.
        how: Derailment,
    },
    /// A contact came to the end of a rail's profile, with the wheel still on it.
    EndOfProfile {
        /// End of the first step that has it there, s.
        time: f64,
        /// Wheel: 0 the right one, 1 the left.
        wheel: usize,
    },
}

/// A wheel at the end of a step, in the directions of its side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WheelAcross {
    /// Its forces and contacts.
    pub contact: WheelContact,
    /// Displacement of the rail's node line to the field side and down, m, and its rotation, rad.
    pub rail: [f64; 3],
}

/// The end of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct AcrossRow {
    /// Time, s.
    pub time: f64,
    /// Place of the wheels, m from the rails' first end.
    pub x: f64,
    /// Displacement of the axle to the right and down against the ground, m, and its roll (positive where the right side goes down), rad.
    pub axle: [f64; 3],
    /// The same of the mass above.
    pub above: Option<[f64; 3]>,
    /// Its acceleration to the right and down with that of the ground, m/s².
    pub above_acceleration: [f64; 2],
    /// Forces of the suspensions on the axle, right and left, each to the right and down along the axle's axes, N.
    pub suspension: [SuspensionForce; 2],
    /// The wheels, right and left.
    pub wheels: [WheelAcross; 2],
    /// Each probe.
    pub probes: Vec<RailSeen>,
}

/// Work of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AcrossWork {
    /// Steps of the integration.
    pub steps: usize,
    /// Iterations of all of them.
    pub iterations: usize,
    /// Steps that were done in two halves.
    pub halved: usize,
    /// Short steps with the friction limits of their start.
    pub with_last_limits: usize,
}

/// A run across the track.
#[derive(Debug, Clone, PartialEq)]
pub struct AcrossRun {
    /// Rows, the first at t = 0.
    pub rows: Vec<AcrossRow>,
    /// How it ended.
    pub ending: AcrossEnding,
    /// Unknowns of the model.
    pub unknowns: usize,
    /// What it took.
    pub work: AcrossWork,
}

impl AcrossCase {
    /// The mirror image: right and left are exchanged, and what points to the right points to the left.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        self.contact.sides.reverse();
        self.uneven.reverse();
        let [lateral, _] = &mut self.ground;
        for function in [&mut self.lateral_force, &mut self.roll, lateral] {
            *function = std::mem::take(function).scaled(-1.0);
        }
        self.torsion.iter_mut().for_each(|torsion| torsion.rail = 1 - torsion.rail);
        self.probes.iter_mut().for_each(|probe| probe.rail = 1 - probe.rail);
        if let StartAcross::Above { velocity: [right, _], .. } = &mut self.start {
            *right = -*right;
        }
        self
    }

    /// How long it takes, s.
    pub fn duration(&self) -> f64 {
        self.steps as f64 * self.time_step
    }

    /// Length of a step of the integration, s.
    pub fn inner_step(&self) -> f64 {
        self.time_step / self.inner_steps as f64
    }
}
