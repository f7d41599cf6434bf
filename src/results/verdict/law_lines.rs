//! Lines of the verdict on the law in use, at the loads that the load cases use.

use railspring_calibrate::law::Form;
use railspring_profiles::units::KILONEWTON;

use crate::results::run::stage::{Run, Runs};
use crate::results::springs::form::{FarthestRecord, FormRecord, LawErrorRecord, farthest};
use crate::results::springs::record::StiffnessRecord;
use crate::results::verdict::input::VerdictInput;
use crate::rounding::significant;
use crate::verify::{Criterion, Line};

/// The form of the law in use: that which the study's load cases run with, beside the published constants the study's own law of their form; without load cases the
/// table, which exports take where no form is named.
pub(crate) fn form_in_use(input: &VerdictInput<'_>) -> Form {
    match input.cases.is_empty() {
        true => Form::Table,
        false => input.law.form().unwrap_or(Form::Power),
    }
}

/// Smallest and largest P (kN) at which the load cases have contact in the published element, which the law drives; none without such a run.
pub(crate) fn loads_used(runs: &[(String, Runs)]) -> Option<[f64; 2]> {
    let published = |runs: &'_ Runs| -> Option<Vec<f64>> {
        let condensed =
            |run: &Run| run.record.springs.as_ref().is_some_and(|springs| springs.element_blake3.is_some());
        let run = [&runs.simple]
            .into_iter()
            .chain(runs.others.iter().filter_map(|other| other.run.as_ref().ok()))
            .find(|run| !condensed(run))?;
        let touching = run.history.rows.iter().skip(1).filter(|row| !row.contacts.is_empty());
        Some(touching.map(|row| (row.vertical_force / KILONEWTON).max(0.0)).collect())
    };
    let loads: Vec<f64> = runs.iter().filter_map(|(_, runs)| published(runs)).flatten().collect();
    let ends =
        loads.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], load| [a.min(*load), b.max(*load)]);
    (ends[0] <= ends[1]).then_some(ends)
}

/// The lines `law_max` and `law_displacement`: the largest relative errors of the law in use at the loads used, with what the whole fitted
/// range says beside them.
pub(crate) fn law_lines(
    input: &VerdictInput<'_>,
    stiffness: &StiffnessRecord,
    used: Option<[f64; 2]>,
) -> [Line; 2] {
    let tangent = |at: &LawErrorRecord| at.tangent;
    let displacement = |at: &LawErrorRecord| Some(at.displacement);
    let Some(form) = stiffness.form(form_in_use(input)) else {
        let missing = |of: Criterion| of.line(None).noted("the calibration has no law of the form in use");
        return [missing(input.limits.law_max()), missing(input.limits.law_displacement())];
    };
    let line =
        |of: Criterion, whole: Option<FarthestRecord>, value: &dyn Fn(&LawErrorRecord) -> Option<f64>| {
            let farthest = farthest(form.over(used).iter(), value);
            let line = of.line(farthest.map(|at| at.max_rel_error));
            line.noted(note(form, used, farthest, whole, (of.limit, form.kept_from(of.limit, value))))
        };
    [
        line(input.limits.law_max(), form.tangent, &tangent),
        line(input.limits.law_displacement(), Some(form.displacement), &displacement),
    ]
}

/// Of which form and loads a line is, and where the law keeps the limit.
fn note(
    form: &FormRecord,
    used: Option<[f64; 2]>,
    farthest: Option<FarthestRecord>,
    whole: Option<FarthestRecord>,
    (limit, kept_from): (f64, Option<f64>),
) -> String {
    let load = |load: f64| significant(load, 3);
    let at = farthest.map_or_else(String::new, |at| format!(" at {} kN", load(at.force_kn)));
    let mut parts = vec![format!("form `{}`{at}", form.law.form().name())];
    let ends = form.off.first().zip(form.off.last());
    let [low, high] = ends.map_or([f64::NAN; 2], |(first, last)| [first.force_kn, last.force_kn]);
    if let Some([least, most]) = used {
        parts.push(format!("the load cases run from {} to {} kN", load(least), load(most)));
    }
    let range = format!("fitted from {} to {} kN", load(low), load(high));
    parts.push(match whole.filter(|whole| Some(*whole) != farthest) {
        Some(at) => {
            format!("{range}, {} % off at {} kN", significant(1e2 * at.max_rel_error, 2), load(at.force_kn))
        }
        None => range,
    });
    let percent = significant(1e2 * limit, 2);
    parts.push(match kept_from {
        Some(from) if from > low => format!("within {percent} % from {} kN on", load(from)),
        Some(_) => format!("within {percent} % over the whole range"),
        None => format!("not within {percent} % at the largest load"),
    });
    parts.join("; ")
}

#[cfg(test)]
mod tests;
