//! The forces of the tool over time against those of a reference solver, with limits and their causes.

use std::iter::zip;

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::history::History;
use serde::Deserialize;

use super::input::InTimeInput;
use super::tool::ToolRuns;
use crate::engine::output::{OutputFolder, read_json};
use crate::results::crosscheck::compare::DISCRETISATION_TANGENT;
use crate::results::crosscheck::record::{Cause, Check, ForcesInTime, Limit, Provenance, RunInTime};

/// Change of a force with steps twice as long, RMS over its peak: both schemes are of second order, so that a third of it is left of the
/// steps themselves, 0.1 %.
pub const STEPS: f64 = 3e-3;
/// A force of one program against the other, RMS over its peak: half of the tangent's
/// [difference](crate::results::crosscheck::compare::DISCRETISATION_TANGENT) of two contact formulations on the same nodes, with whose root the force of an
/// impact goes, and the steps of either.
pub const FORCES: f64 = 0.5 * DISCRETISATION_TANGENT + 2.0 * STEPS / 3.0;

/// What the reference wrote.
#[derive(Debug, Clone, Deserialize)]
pub struct ReferenceRuns {
    runs: Vec<ReferenceRun>,
    /// Unknowns of its bodies.
    pub degrees_of_freedom: usize,
    /// Versions, hash, date, time.
    pub provenance: Provenance,
}

#[derive(Debug, Clone, Deserialize)]
struct ReferenceRun {
    inner_steps: usize,
    time_s: Vec<f64>,
    vertical_n: Vec<f64>,
    lateral_n: Vec<f64>,
}

impl ReferenceRuns {
    /// Reads `in_time.json` of an exchange folder.
    ///
    /// # Errors
    /// A file that is absent or of another layout.
    pub fn read(folder: &OutputFolder) -> Result<Self> {
        read_json(&folder.file("in_time.json"), "crosscheck")
    }

    /// Name of the reference solver with its version.
    pub fn solver_name(&self) -> String {
        let version = self.provenance.packages.get("scikit-fem").map_or("", String::as_str);
        format!("scikit-fem {version}")
    }
}

/// The forces of all runs: of the tool, then of the reference, each with longer steps after those of the study.
///
/// # Errors
/// A reference that has not run what was asked, and times that are not those of the tool.
pub fn forces(input: &InTimeInput<'_>, tool: &ToolRuns, reference: &ReferenceRuns) -> Result<ForcesInTime> {
    const ROUNDOFF: f64 = 1e-9;
    let steps = [input.inner_steps, input.inner_steps / 2];
    let step_us = |inner: usize| 1e6 * input.case.time_step / inner as f64;
    let own = |history: &History, inner: usize| RunInTime {
        program: "railspring".into(),
        step_us: step_us(inner),
        p_kn: history.rows.iter().map(|row| row.vertical_force / KILONEWTON).collect(),
        q_kn: history.rows.iter().map(|row| row.lateral_force / KILONEWTON).collect(),
    };
    let times: Vec<f64> = tool.history.rows.iter().map(|row| row.time).collect();
    let mut runs = vec![own(&tool.history, steps[0]), own(&tool.longer, steps[1])];
    for inner in steps {
        let run = reference.runs.iter().find(|run| run.inner_steps == inner);
        let same = |run: &&ReferenceRun| {
            let columns = [&run.time_s, &run.vertical_n, &run.lateral_n];
            columns.iter().all(|column| column.len() == times.len())
                && zip(&run.time_s, &times).all(|(a, b)| (a - b).abs() < ROUNDOFF)
        };
        let Some(run) = run.filter(same) else {
            return InputError::refuse(
                "in_time.json",
                format!("no run of {} time steps with {inner} steps in each", input.case.steps),
                "every run that was asked for",
                "run `railspring crosscheck --in-time` again",
            );
        };
        let in_kn = |values: &[f64]| values.iter().map(|force| force / KILONEWTON).collect();
        runs.push(RunInTime {
            program: reference.solver_name(),
            step_us: step_us(inner),
            p_kn: in_kn(&run.vertical_n),
            q_kn: in_kn(&run.lateral_n),
        });
    }
    let time_ms = times.iter().map(|time| 1e3 * time).collect();
    Ok(ForcesInTime { case: input.name.into(), time_ms, runs })
}

/// A force of a run.
type Force = fn(&RunInTime) -> &[f64];
/// P and Q.
const FORCE_OF: [(&str, Force); 2] = [("P", |run| &run.p_kn), ("Q", |run| &run.q_kn)];

/// All checks: the forces of both programs, and the change of each with longer steps.
pub fn checks(forces: &ForcesInTime) -> Vec<Check> {
    let [tool, longer, reference, reference_longer] = &forces.runs[..] else {
        unreachable!("two runs of each program");
    };
    let problem = format!("load case {} in time", forces.case);
    let mut checks = Vec::new();
    let mut check = |quantity: String, of: Force, runs: [&RunInTime; 2], limit| {
        let [a, b] = runs.map(of);
        let size = peak(b);
        let (values, solver) = ((peak(a), size), &reference.program);
        let difference = rms(a, b) / size;
        checks.push(Check::new(
            &problem,
            &quantity,
            None,
            "kN",
            values,
            solver,
            difference,
            (limit, Cause::Discretisation),
        ));
    };
    for (name, of) in FORCE_OF {
        check(format!("{name}, RMS difference over its peak"), of, [tool, reference], FORCES);
    }
    for (name, of) in FORCE_OF {
        for (whose, runs) in [("the tool", [tool, longer]), ("the reference", [reference, reference_longer])]
        {
            let quantity = format!("{name}, RMS change over its peak with steps of {whose} twice as long");
            check(quantity, of, runs, STEPS);
        }
    }
    checks
}

/// The limits that the checks use.
pub fn limits() -> Vec<Limit> {
    [
        (
            FORCES,
            "P and Q of both programs over time",
            "half of the difference of the tangents of two contact formulations on the same nodes, 1 %, with whose root the \
             force of an impact goes; the steps of either program, 0.1 % each",
        ),
        (
            STEPS,
            "P and Q of each program with steps twice as long",
            "schemes of second order: a third of the change is left of the steps themselves, 0.1 %",
        ),
    ]
    .map(|(value, applies_to, derivation)| Limit {
        cause: Cause::Discretisation,
        value,
        applies_to: applies_to.into(),
        derivation: derivation.into(),
    })
    .into()
}

/// The largest value without its sign.
fn peak(force: &[f64]) -> f64 {
    force.iter().map(|f| f.abs()).fold(0.0, f64::max)
}

/// Root of the mean square of a difference; not a number of runs that are not of one length.
fn rms(a: &[f64], b: &[f64]) -> f64 {
    if a.len() != b.len() {
        return f64::NAN;
    }
    (zip(a, b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / a.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(program: &str, p_kn: &[f64], q_kn: &[f64]) -> RunInTime {
        RunInTime { program: program.into(), step_us: 10.0, p_kn: p_kn.into(), q_kn: q_kn.into() }
    }

    /// Source: differences by construction. Goal: P (kN) differs by 1 in one of four times, of a peak of 100, Q by nothing: √(1/4)/100;
    /// a run with fewer times fails, as does a change with longer steps alone. Exact but for ROUNDOFF.
    #[test]
    fn differences_are_those_by_construction() {
        const ROUNDOFF: f64 = 1e-15;
        let reference = run("scikit-fem 11", &[0.0, 100.0, -20.0, 5.0], &[0.0, 10.0, 0.0, 0.0]);
        let tool = run("railspring", &[0.0, 99.0, -20.0, 5.0], &[0.0, 10.0, 0.0, 0.0]);
        let of = |longer: &RunInTime, tool: &RunInTime| {
            let runs = vec![tool.clone(), longer.clone(), reference.clone(), reference.clone()];
            checks(&ForcesInTime { case: "c".into(), time_ms: vec![0.0, 1.0, 2.0, 3.0], runs })
        };
        let found = of(&tool, &tool);
        assert_eq!(found.len(), 6);
        assert!((found[0].difference - 0.005).abs() < ROUNDOFF && found[0].holds, "{:?}", found[0]);
        assert_eq!((found[0].tool, found[0].reference_value), (99.0, 100.0));
        assert!(found[1..].iter().all(|check| check.difference == 0.0 && check.holds), "{found:?}");
        let off = run("railspring", &[0.0, 99.0, -20.0, 6.5], &[0.0, 10.0, 0.0, 0.0]);
        let failing: Vec<usize> = (0..6).filter(|k| !of(&tool, &off)[*k].holds).collect();
        assert_eq!(failing, [0, 2]);
        let failing: Vec<usize> = (0..6).filter(|k| !of(&off, &tool)[*k].holds).collect();
        assert_eq!(failing, [2]);
        let short = run("railspring", &[0.0, 99.0], &[0.0, 10.0]);
        assert!(of(&tool, &short)[..3].iter().all(|check| !check.holds));
        let all = limits();
        assert!(found.iter().all(|check| all.iter().any(|limit| limit.value == check.limit)));
    }
}
