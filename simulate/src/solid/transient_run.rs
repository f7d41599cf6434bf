//! What a run of the solid model gives.

use crate::time::history::History;

/// Change of P and of Q with the modes at most, of the peak.
const TOLERANCE: f64 = 3e-3;

/// A finished transient run of the solid model.
pub struct TransientRun {
    /// The states.
    pub history: History,
    /// Mass of the meshed wheel, kg.
    pub wheel_mass: f64,
    /// Steps of the integration.
    pub steps: StepCounts,
    /// The same with steps of the integration that are twice as long, of bodies at full order the first time steps; none where there are no longer ones.
    pub longer: Option<OtherRun>,
    /// The other load case of [`TransientModel::run_beside`](super::TransientModel::run_beside), if there is one.
    pub other: Option<OtherRun>,
    /// The modes of reduced bodies, and their error.
    pub reduction: Option<Reduction>,
}

/// A run that another one is compared with, or why it could not be done.
pub type OtherRun = std::result::Result<History, String>;

/// Steps of the integration of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StepCounts {
    /// Those that the run is made of.
    pub taken: usize,
    /// All that were solved, with those that were taken again because they were too long.
    pub tried: usize,
}

/// The modes of a reduced run, and the change of P and Q that they make: those of a run with fewer modes against its own, over
/// the first steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduction {
    /// Modes of rail and wheel.
    pub modes: [usize; 2],
    /// Modes of the run with fewer.
    pub fewer: [usize; 2],
    /// Time up to which the runs are compared, s.
    pub time: f64,
    /// Largest change of P and of Q, over the peak of each.
    pub change: [f64; 2],
}

impl Reduction {
    /// Whether P and Q change little enough.
    pub fn suffices(&self) -> bool {
        self.change.iter().all(|change| *change < TOLERANCE)
    }
}
