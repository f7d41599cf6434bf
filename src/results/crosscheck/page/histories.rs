//! The forces of both programs over time.

use std::iter::zip;

use plotters::prelude::*;

use crate::report::number::WIDTH;
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{BLUE, DARK, Dash, ORANGE, RED, Series};
use crate::results::crosscheck::record::{ForcesInTime, RunInTime};

/// P and Q of the runs with the shortest steps: the tool's line is solid, the reference solver's dashed.
pub fn forces(forces: &ForcesInTime) -> String {
    let force = |of: fn(&RunInTime) -> &[f64]| -> Vec<Series> {
        let looks = [(DARK, Dash::Solid), (RED, Dash::Dashed)];
        zip(forces.runs.iter().step_by(2), looks)
            .map(|(run, (color, dash))| Series::line(&run.program, over_time(forces, of(run)), color, dash))
            .collect()
    };
    let panels = [("P, kN", force(|run| &run.p_kn)), ("Q, kN", force(|run| &run.q_kn))];
    stacked(WIDTH, 260, &panels.map(|(label, series)| Panel::new("time, ms", label, series)))
}

/// What the forces differ by, in per cent of the largest of the reference solver.
pub fn differences(forces: &ForcesInTime) -> String {
    let force = |of: fn(&RunInTime) -> &[f64]| -> Vec<Series> {
        let [tool, tool_longer, reference, reference_longer] = &forces.runs[..] else { return Vec::new() };
        let size = of(reference).iter().map(|f| f.abs()).fold(0.0, f64::max);
        let difference = |name: &str, a: &RunInTime, b: &RunInTime, color: RGBColor, dash| {
            let values: Vec<f64> = zip(of(a), of(b)).map(|(a, b)| 100.0 * (a - b) / size).collect();
            Series::line(name, over_time(forces, &values), color, dash)
        };
        let longer = |run: &RunInTime| format!("{}, steps twice as long", run.program);
        vec![
            difference("reference less tool", reference, tool, RED, Dash::Solid),
            difference(&longer(tool), tool_longer, tool, BLUE, Dash::Dashed),
            difference(&longer(reference), reference_longer, reference, ORANGE, Dash::Dotted),
        ]
    };
    let panels = [("P, %", force(|run| &run.p_kn)), ("Q, %", force(|run| &run.q_kn))];
    stacked(WIDTH, 220, &panels.map(|(label, series)| Panel::new("time, ms", label, series)))
}

fn over_time(forces: &ForcesInTime, values: &[f64]) -> Vec<(f64, f64)> {
    zip(&forces.time_ms, values).map(|(time, value)| (*time, *value)).collect()
}
