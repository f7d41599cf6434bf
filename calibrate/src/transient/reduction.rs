//! How many modes a reduced run has, and what they are worth.

use super::reduced::ReducedBody;
use super::run::{Run, Step};
use super::{TransientModel, TransientRun};
use crate::error::{NumericsError, Result, StopReason};
use crate::history::HistoryRow;
use crate::monitor::Monitor;
use crate::scenario::Scenario;
use nalgebra::Vector2;

/// Modes of each body to begin with.
pub const START_MODES: usize = 64;
/// Change of P and of Q with the modes at most, of the peak.
const TOLERANCE: f64 = 3e-3;
/// Time over which the change is measured, s. Load cases whose contact comes and goes diverge later, whatever the models: two of
/// them that differ by a thousandth in a force are then as far apart as two models.
const MEASURED_TIME: f64 = 0.06;
/// Share of the modes with which the change is measured.
const FEWER: f64 = 0.75;
/// A force is measured against its peak, and against this share of the other one's at least.
const SMALLEST_PEAK: f64 = 0.05;

/// How many modes of its bodies a reduced run uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModeCount {
    /// As many as it takes until P and Q change by less than 0.3 % of their peaks.
    Estimated,
    /// So many of each body, or all that it has.
    Given(usize),
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

/// A run with as many modes as `count` says.
pub(super) fn run(
    model: &TransientModel<'_>,
    count: ModeCount,
    scenario: &Scenario,
    monitor: &dyn Monitor,
    observe: &mut dyn FnMut(&Step) -> Result<()>,
) -> Result<TransientRun> {
    let first = match count {
        ModeCount::Given(count) => count,
        ModeCount::Estimated => START_MODES,
    };
    let steps = (MEASURED_TIME / scenario.time_step).ceil().min(scenario.steps as f64) as usize;
    let rest = Vector2::zeros();
    let mut wanted = first.min(model.most_modes());
    loop {
        let bodies = model.reduced_bodies(scenario, wanted)?;
        let modes = bodies.each_ref().map(ReducedBody::modes);
        let fewer = (FEWER * wanted as f64) as usize;
        let fewer = model.reduced_bodies(scenario, fewer)?;
        let mut less = Run::new(model, scenario, &rest, fewer.each_ref());
        less.to(steps, monitor, &mut |_| Ok(()))?;
        let mut run = Run::new(model, scenario, &rest, bodies.each_ref());
        run.to(steps, monitor, observe)?;
        let reduction = Reduction {
            modes,
            fewer: fewer.each_ref().map(ReducedBody::modes),
            time: steps as f64 * scenario.time_step,
            change: change(less.rows(), run.rows()),
        };
        if count != ModeCount::Estimated || reduction.suffices() {
            run.to(scenario.steps, monitor, observe)?;
            return Ok(run.ended(Some(reduction)));
        }
        if model.most_modes() <= wanted {
            return Err(NumericsError {
                stage: "modes of the transient solid model".into(),
                step: None,
                iteration: wanted,
                residual: reduction.change.into_iter().fold(0.0, f64::max),
                active: 0,
                reason: StopReason::TooFewModes,
            }
            .into());
        }
        wanted = (2 * wanted).min(model.most_modes());
    }
}

/// Largest difference of P and of Q over the peaks of the second.
fn change(a: &[HistoryRow], b: &[HistoryRow]) -> [f64; 2] {
    let of = [|row: &HistoryRow| row.vertical_force, |row: &HistoryRow| row.lateral_force];
    let peak = |force: fn(&HistoryRow) -> f64| b.iter().map(|row| force(row).abs()).fold(0.0, f64::max);
    let peaks = of.map(peak);
    let smallest = SMALLEST_PEAK * peaks[0].max(peaks[1]);
    [0, 1].map(|k| {
        // a wheel that has left the rail in one of them has no force there
        let force = |rows: &[HistoryRow], n: usize| rows.get(n).map_or(0.0, of[k]);
        let differences = (0..a.len().max(b.len())).map(|n| (force(a, n) - force(b, n)).abs());
        let most = differences.fold(0.0, f64::max);
        if most == 0.0 { 0.0 } else { most / peaks[k].max(smallest) }
    })
}
