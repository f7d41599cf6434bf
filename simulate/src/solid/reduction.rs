//! How many modes a reduced run has, and their error.

use super::beyond::Beyond;
use super::load_case::{HubSprings, hub_motions, longest};
use super::model::{ModeCount, SolidBodies, TransientModel};
use super::reduced::ReducedBody;
use super::run::Run;
use super::transient_run::{OtherRun, Reduction, TransientRun};
use crate::time::history::{Ending, History, HistoryRow};
use crate::time::newmark::Newmark;
use crate::time::scenario::Scenario;
use crate::time::steps::InnerSteps;
use crate::time::suspension::Suspension;
use nalgebra::Vector2;
use railspring_profiles::error::{NumericsError, Result, StopReason, or_reason};
use railspring_profiles::monitor::Monitor;

/// Modes of each body to begin with.
pub const START_MODES: usize = 64;
/// Time over which the change is measured, s. Load cases whose contact comes and goes diverge later, whatever the models: two of
/// them that differ by a thousandth in a force are then as far apart as two models.
const MEASURED_TIME: f64 = 0.06;
/// Share of the modes with which the change is measured.
const FEWER: f64 = 0.75;
/// What the run with these is called.
const FEWER_MODES: &str = "fewer modes";
/// A force is measured against its peak, and against this share of the other one's at least.
const SMALLEST_PEAK: f64 = 0.05;

impl TransientModel<'_> {
    /// The reduced bodies with the first `count` of their modes, for steps of `scheme`.
    pub(super) fn reduced_bodies(
        &self,
        scenario: &Scenario,
        count: usize,
        scheme: &Newmark,
    ) -> Result<[ReducedBody<'_>; 2]> {
        let SolidBodies::Reduced { rail, wheel, .. } = self.bodies else {
            unreachable!("reduced bodies");
        };
        let vertical = Suspension::new(scenario, scheme).stiffness();
        let hub = HubSprings { free: hub_motions(scenario), vertical, axle: self.axle };
        Ok([
            ReducedBody::new(rail, count, self.damping(), scheme, HubSprings::default(), self.path)?,
            ReducedBody::new(wheel, count, self.damping(), scheme, hub, None)?,
        ])
    }
}

/// A run with as many modes as `count` says. Beside it the same is done with steps of the integration that are twice as long, which shows the
/// error of the steps, its first time steps with fewer modes, and all of `other`, if there is such a load case.
pub(super) fn run(
    model: &TransientModel<'_>,
    count: ModeCount,
    scenario: &Scenario,
    other: Option<&Scenario>,
    monitor: &dyn Monitor,
) -> Result<TransientRun> {
    let first = match count {
        ModeCount::Given(count) => count,
        ModeCount::Estimated => START_MODES,
    };
    let mut wanted = first.min(model.most_modes());
    loop {
        let (mut beside, mut of_other) = (None, None);
        // on the threads of the pool alone: a run beside them would wait for these wherever it shares its own work
        let run = rayon::scope(|scope| {
            scope.spawn(|_| beside = Some(others(model, wanted, scenario, monitor)));
            // the longer one last, as a thread goes on with what came last
            if let Some(other) = other {
                let stage = "second load case of the transient solid model";
                let whole = move || Ok(some_modes(model, wanted, other, (stage, monitor))?.0.history);
                let of_other = &mut of_other;
                scope.spawn(move |_| *of_other = Some(or_reason(whole())));
            }
            some_modes(model, wanted, scenario, ("transient solid model", monitor))
        });
        let ((run, modes), beside) = (run?, beside.expect("the scope has ended")?);
        let of_other = of_other.transpose()?;
        let all = match (&beside.all, &beside.longer) {
            (Some(all), _) | (None, Some(Ok(all))) => all,
            _ => &run.history,
        };
        let first = first_of(scenario).steps;
        let steps = compared_steps([&beside.fewer, all], first);
        let reduction = Reduction {
            modes,
            fewer: beside.modes,
            time: steps as f64 * scenario.time_step,
            change: change([&beside.fewer, all].map(|run| &run.rows[..run.rows.len().min(steps + 1)])),
        };
        if count != ModeCount::Estimated || reduction.suffices() {
            return Ok(TransientRun {
                reduction: Some(reduction),
                longer: beside.longer,
                other: of_other,
                ..run
            });
        }
        if model.most_modes() <= wanted {
            return Err(NumericsError::new(
                "modes of the transient solid model",
                StopReason::TooFewModes,
                reduction.change.into_iter().fold(0.0, f64::max),
                0,
            )
            .after(wanted)
            .into());
        }
        wanted = (2 * wanted).min(model.most_modes());
    }
}

/// The same run in other ways.
struct Others {
    /// With longer steps, or why not; none where there are no longer ones.
    longer: Option<OtherRun>,
    /// Its first time steps with all modes, where the run with fewer has the steps of neither that nor the run itself.
    all: Option<History>,
    /// Its first time steps with fewer modes.
    fewer: History,
    /// Those modes of rail and wheel.
    modes: [usize; 2],
}

/// `scenario` with `count` modes and longer steps, and its first time steps with fewer modes: those with the longer steps if these can be done.
/// Steps that adapt themselves are not the same with other modes, and what they change is more than what the modes do; there both
/// have the steps of the history.
fn others(
    model: &TransientModel<'_>,
    count: usize,
    scenario: &Scenario,
    monitor: &dyn Monitor,
) -> Result<Others> {
    let of = |count: usize, scenario: &Scenario, how: &str| -> Result<(History, [usize; 2])> {
        let stage = format!("transient solid model, {how}");
        let (run, modes) = some_modes(model, count, scenario, (&stage, monitor))?;
        Ok((run.history, modes))
    };
    let fewer = (FEWER * count as f64) as usize;
    let first = first_of(scenario);
    let longer = || longer_steps(scenario, |longer| Ok(of(count, longer, "longer steps")?.0));
    if let InnerSteps::Adaptive(_) = scenario.inner_steps {
        let equal = Scenario { inner_steps: InnerSteps::Equal(1), ..first.clone() };
        let both = || rayon::join(|| of(count, &equal, "all modes"), || of(fewer, &equal, FEWER_MODES));
        let (longer, (all, fewer)) = rayon::join(longer, both);
        let (longer, (all, _), (fewer, modes)) = (longer?, all?, fewer?);
        return Ok(Others { longer, all: Some(all), fewer, modes });
    }
    let longer = longer()?;
    let compared = match longer {
        Some(Ok(_)) => Scenario { inner_steps: first.inner_steps.doubled(), ..first },
        _ => first,
    };
    let (fewer, modes) = of(fewer, &compared, FEWER_MODES)?;
    Ok(Others { longer, all: None, fewer, modes })
}

/// A run with `modes` of each body, or all that it has.
pub(super) fn alone(
    model: &TransientModel<'_>,
    modes: usize,
    scenario: &Scenario,
    monitor: &dyn Monitor,
) -> Result<History> {
    Ok(some_modes(model, modes, scenario, ("another transient solid model", monitor))?.0.history)
}

/// The time steps of a scenario over which runs are compared.
pub(super) fn first_of(scenario: &Scenario) -> Scenario {
    let steps = (MEASURED_TIME / scenario.time_step).ceil().min(scenario.steps as f64) as usize;
    Scenario { steps, ..scenario.clone() }
}

/// What `with` makes of `scenario` with steps of the integration that are twice as long, or why it cannot; none where there are no
/// longer ones.
///
/// # Errors
/// An interruption.
pub(super) fn longer_steps(
    scenario: &Scenario,
    with: impl Fn(&Scenario) -> Result<History>,
) -> Result<Option<OtherRun>> {
    let inner_steps = scenario.inner_steps.doubled();
    if inner_steps == scenario.inner_steps {
        return Ok(None);
    }
    or_reason(with(&Scenario { inner_steps, ..scenario.clone() })).map(Some)
}

/// A run with `count` modes of each body, and how many that is of rail and wheel.
fn some_modes(
    model: &TransientModel<'_>,
    count: usize,
    scenario: &Scenario,
    (stage, monitor): (&str, &dyn Monitor),
) -> Result<(TransientRun, [usize; 2])> {
    let with = |scheme: &Newmark| model.reduced_bodies(scenario, count, scheme);
    let bodies = with(&longest(scenario))?;
    let modes = bodies.each_ref().map(ReducedBody::modes);
    let mut run = Run::new(model, scenario, &Vector2::zeros(), bodies.each_ref(), &with);
    let mut beyond = Beyond::new(model, scenario);
    run.finish((stage, monitor), &mut |step| Ok(beyond.reached(step)))?;
    Ok((run.ended(), modes))
}

/// The time steps over which runs are compared of which the first `most` were wanted: those before the contact of one of them has
/// reached the end of the surfaces, beyond which nothing is known of its forces.
fn compared_steps(runs: [&History; 2], most: usize) -> usize {
    let at_the_end = |run: &&History| matches!(run.ending, Ending::EndOfSurface { .. });
    runs.into_iter().filter(at_the_end).map(|run| run.rows.len() - 1).fold(most, usize::min)
}

/// Largest difference of P and of Q over the peaks of the second.
fn change([a, b]: [&[HistoryRow]; 2]) -> [f64; 2] {
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
