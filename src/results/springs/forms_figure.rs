//! How far the laws of all forms are from the solid: figure and table of the report.

use railspring_calibrate::law::Form;
use serde_json::{Value, json};

use crate::report::number::WIDTH;
use crate::report::panel::{Panel, stacked_logarithmic};
use crate::report::plot::{BLUE, DARK, Dash, GREY, Marker, ORANGE, Series};
use crate::results::springs::form::{FarthestRecord, FormRecord, LawErrorRecord};
use crate::results::springs::record::StiffnessRecord;
use crate::rounding::significant;

/// The laws of all forms against the reference in use.
fn forms(stiffness: &StiffnessRecord) -> &[FormRecord] {
    let in_use = stiffness.references.iter().find(|found| found.reference == stiffness.reference);
    in_use.map_or(&[], |found| &found.forms)
}

/// Relative errors of tangent and displacement over the load, per cent; each form with its own dashes and marks.
pub fn errors(stiffness: &StiffnessRecord) -> String {
    let of = |value: &dyn Fn(&LawErrorRecord) -> Option<f64>| {
        let series = |form: &FormRecord| {
            let (color, dash, marker) = match form.law.form() {
                Form::Power => (ORANGE, Dash::Solid, Marker::Square),
                Form::Series => (BLUE, Dash::Dashed, Marker::Triangle),
                Form::Steps => (DARK, Dash::Solid, Marker::Disc),
                Form::Table => (GREY, Dash::Dotted, Marker::Circle),
            };
            let points = form.off.iter().filter_map(|at| Some((at.force_kn, 1e2 * value(at)?))).collect();
            Series::joined(form.law.form().name(), points, color, dash, marker)
        };
        forms(stiffness).iter().map(series).collect::<Vec<_>>()
    };
    let panels = [
        Panel::from_zero("load P, kN", "tangent, %", of(&|at| at.tangent)),
        Panel::from_zero("load P, kN", "displacement, %", of(&|at| Some(at.displacement))),
    ];
    stacked_logarithmic(WIDTH, 240, &panels, &[])
}

/// What the figure shows.
pub fn caption(stiffness: &StiffnessRecord) -> String {
    let line = stiffness.forms_in_a_line().map_or_else(String::new, |line| format!(" In short: {line}."));
    format!(
        "Relative errors of the law against {} in all forms, each over the value of the solid at its load. `power` is the published form, `series` a power and a linear spring in series, \
         `steps` two powers with a step between, `table` the tangents of the solid; its error of the tangent is that of the table of the other loads.{line}",
        stiffness.reference
    )
}

/// The laws of all forms with their largest errors and the loads from which on they keep limits; null without any.
pub fn table(stiffness: &StiffnessRecord) -> Value {
    let forms = forms(stiffness);
    let Some(first) = forms.first() else { return Value::Null };
    let at = |at: Option<FarthestRecord>| {
        at.map_or_else(
            || "not known".into(),
            |at| {
                format!("{} % at {} kN", significant(1e2 * at.max_rel_error, 2), significant(at.force_kn, 3))
            },
        )
    };
    let row = |form: &FormRecord| {
        let within = form.within.iter().map(|within| {
            form.holds_from(within.limit).map_or_else(|| "none".into(), |load| significant(load, 3))
        });
        json!({
            "form": form.law.form().name(),
            "formula": form.law.formula(4),
            "tangent": at(form.tangent),
            "displacement": at(Some(form.displacement)),
            "within": within.collect::<Vec<_>>(),
        })
    };
    json!({
        "limits": first.within.iter().map(|within| significant(1e2 * within.limit, 1)).collect::<Vec<_>>(),
        "rows": forms.iter().map(row).collect::<Vec<_>>(),
    })
}
