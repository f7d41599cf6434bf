//! The annex of the report: what was verified, what was validated, with a value for each line and where it stands (ASME V&V 10 and V&V 20, EN 14363).

use serde::Serialize;
use serde_json::{Value, json};

use super::data::ReportData;
use crate::report::collector::Collector;
use crate::report::number::number;
use crate::results::springs::uncertainty_record::UncertainRecord;
use crate::results::verdict::record::{ScenarioVerdict, VerdictOn};
use crate::results::verdict::validation_figure;
use crate::rounding::significant;
use crate::self_test::Check;
use crate::verify::Line;
use crate::version;

/// What is known to be wrong with the program, a line each.
const DEFECTS: &str = include_str!("../../../docs/known-defects.md");

/// A line: what it is about, what was done or is known, and where the report has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Row {
    topic: &'static str,
    value: String,
    /// Place in the report, without `#`; empty for none.
    at: String,
    /// Whether it is a warning.
    fails: bool,
}

fn row(topic: &'static str, value: impl Into<String>, at: impl Into<String>) -> Row {
    Row { topic, value: value.into(), at: at.into(), fails: false }
}

/// What the template shows. `crosscheck` is the chapter on independent programs.
pub(crate) fn annex(data: &ReportData<'_>, crosscheck: &Value, collected: &mut Collector) -> Value {
    let groups = [
        ("Intended use", intended_use(data)),
        ("Verification of the program", of_program(data)),
        ("Verification of the solution", of_solution(data, crosscheck)),
        ("Uncertainty (95 %)", uncertainty(data)),
        ("Validation", validation(data)),
        ("Limits of use", limits_of_use()),
        ("Review and provenance", review(data)),
    ];
    let groups: Vec<Value> =
        groups.into_iter().map(|(name, rows)| json!({ "name": name, "rows": rows })).collect();
    let measured = data.verdict.validation.as_ref();
    let figure = measured.and_then(|of| {
        Some(collected.add("validation", validation_figure::figure(of)?, validation_figure::caption(of)))
    });
    json!({
        "groups": groups,
        "checks": data.checks.iter().map(check).collect::<Vec<_>>(),
        "figure": figure,
        "validation": measured.map(|of| of.points.iter().map(|p| {
            [p.force_kn, p.measured_mm, p.model_mm, p.error_mm, p.numerical_mm, p.input_mm, p.measurement_mm, p.validation_mm]
                .map(|value| significant(value, 3))
        }).collect::<Vec<_>>()),
        "defects": defects(),
    })
}

/// Purpose and requirements, each requirement with what came out.
fn intended_use(data: &ReportData<'_>) -> Vec<Row> {
    let purpose = match data.intended_use.purpose.trim() {
        "" => "not stated: intended_use.purpose of the study",
        stated => stated,
    };
    let mut rows = vec![row("Use", purpose, "use")];
    if data.verdict.requirements.is_empty() {
        rows.push(row(
            "Accuracy requirement",
            "none stated (intended_use.tangent_percent and others); the limits of the verdict are those of the program",
            "limits",
        ));
    }
    // they are the first lines of the verdict
    rows.extend(data.verdict.requirements.iter().enumerate().map(|(n, line)| {
        let found = known(line.value);
        let state = if line.holds { "kept" } else { "NOT kept" };
        let value = format!("{}: {found} of {} allowed, {state}", line.meaning, percent(line.limit));
        Row { fails: !line.holds, ..row("Accuracy requirement", value, format!("limit-{}", n + 1)) }
    }));
    rows
}

/// The program's own checks.
fn of_program(data: &ReportData<'_>) -> Vec<Row> {
    const ORDER: &str = "observed order";
    let (orders, others): (Vec<&Check>, Vec<&Check>) =
        data.checks.iter().partition(|check| check.name.starts_with(ORDER));
    let counted = |topic, of: &[&Check]| {
        let held = of.iter().filter(|check| check.holds()).count();
        let mut sources: Vec<&str> = of.iter().map(|check| check.source.as_str()).collect();
        sources.dedup();
        let value = format!("{held} of {} values hold ({})", of.len(), sources.join(", "));
        Row { fails: held < of.len(), ..row(topic, value, "self-test") }
    };
    let (published, closed): (Vec<&Check>, Vec<&Check>) =
        others.into_iter().partition(|check| check.source.starts_with("CONTACT"));
    let mut rows =
        vec![counted("Closed solutions", &closed), counted("Another program's published case", &published)];
    rows.extend(orders.into_iter().map(|check| Row {
        fails: !check.holds(),
        ..row(
            "Observed order",
            format!(
                "{}: {}, {} expected",
                check.name.trim_start_matches(ORDER).trim_start_matches(" of "),
                significant(check.found, 3),
                number(check.expected)
            ),
            "self-test",
        )
    }));
    rows
}

/// What grids, meshes, steps and modes change, and other models and programs.
fn of_solution(data: &ReportData<'_>, crosscheck: &Value) -> Vec<Row> {
    let stiffness = data.stiffness;
    let bands = stiffness.error_band.as_ref().and_then(|band| band.of(&stiffness.reference));
    let springs = match bands.and_then(|band| Some([band.displacement?, band.tangent?])) {
        Some([displacement, tangent]) => format!(
            "half the spacing of the contact's grid, elements twice as large: displacement \u{b1}{}, tangent \u{b1}{} at most",
            percent(displacement),
            percent(tangent)
        ),
        None => "not known: no error band".into(),
    };
    let mut rows = vec![
        row("Discretisation of the springs", springs, "springs"),
        row("Horizontal stiffness", super::first_screen::horizontal(stiffness), "springs"),
    ];
    for (n, judged) in data.verdict.scenarios.iter().enumerate() {
        let at = format!("scenario-{}", n + 1);
        rows.extend(
            numerical_uncertainty(judged)
                .map(|value| row("Steps, meshes and inputs of a load case", value, at.clone())),
        );
        rows.extend(models(judged).map(|value| row("Simple beside solid model", value, at)));
    }
    let counts = data.verdict.verdicts.first().map(VerdictOn::counts);
    rows.extend(counts.map(|counts| row("Limits of the verdict", counts, "limits")));
    let programs = match crosscheck["state"].as_str() {
        Some("fresh") => crosscheck["verdict"].as_str().unwrap_or("none").to_owned(),
        Some("stale") => "of another study or version; `railspring crosscheck` makes it again".into(),
        _ => "none made; `railspring crosscheck` makes it".into(),
    };
    rows.push(row("Same solids by independent programs", programs, "crosscheck"));
    rows
}

/// Numerical uncertainty of the models of a load case, RMS of P and Q over the solid's peak.
fn numerical_uncertainty(judged: &ScenarioVerdict) -> Option<String> {
    let of = |quantity: &str| judged.lines.iter().find(|line| line.quantity == quantity);
    let both = [of("vertical_rms")?, of("lateral_rms")?];
    let pair = |take: fn(&Line) -> Option<f64>| {
        let [p, q] = both.map(|line| known(take(line)));
        format!("P {p}, Q {q}")
    };
    Some(format!(
        "{}: solid model {}; simple model {} (RMS over the peak)",
        judged.scenario,
        pair(|line| line.solid_uncertainty),
        pair(|line| line.simple_uncertainty)
    ))
}

/// What simple and solid model differ by.
fn models(judged: &ScenarioVerdict) -> Option<String> {
    let differences = judged.elements.first()?.differences.as_ref()?;
    let ratio = differences.ratio_max.map_or_else(|| "not known".into(), |value| significant(value, 2));
    Some(format!(
        "{}: P {}, Q {} (RMS over the peak), averaged Q/P {ratio} at most",
        judged.scenario,
        known(differences.vertical_rms),
        known(differences.lateral_rms)
    ))
}

/// Parts of the uncertainty at the load in the middle.
fn uncertainty(data: &ReportData<'_>) -> Vec<Row> {
    let found = data.stiffness.input_uncertainty.as_ref();
    let missing = || {
        let reason = found.and_then(|of| of.missing.clone());
        reason.map_or_else(|| "not known: no error bands".into(), |reason| format!("not known: {reason}"))
    };
    let Some((of, point)) = found.and_then(|of| Some((of, of.middle()?))) else {
        return vec![row("Inputs", missing(), "springs")];
    };
    let load = format!("{} kN", significant(point.force_kn, 3));
    let values = [
        ("displacement", Some(&point.displacement)),
        ("tangent", Some(&point.tangent)),
        ("k_h", of.horizontal.as_ref()),
    ];
    let all = |take: &dyn Fn(&UncertainRecord) -> Option<f64>| {
        let texts = values.iter().filter_map(|(name, of)| {
            let value = take((*of)?);
            Some(format!(
                "{name} {}",
                value.map_or_else(|| "not known".into(), |value| format!("\u{b1}{}", percent(value)))
            ))
        });
        texts.collect::<Vec<_>>().join(", ")
    };
    let leading: Vec<&str> =
        point.tangent.ranked().into_iter().take(3).map(|input| of.inputs[input].name.as_str()).collect();
    let of_springs = [
        row("Numerical, u_num", format!("at {load}: {}", all(&|of| of.numerical)), "springs"),
        row(
            "Inputs, u_input",
            format!("at {load}: {}; mostly from {}", all(&|of| Some(of.input)), leading.join(", ")),
            "springs",
        ),
        row(
            "Both, \u{221a}(num\u{b2} + input\u{b2})",
            format!("at {load}: {}", all(&|of| of.combined)),
            "springs",
        ),
    ];
    let of_cases = data.verdict.scenarios.iter().enumerate().filter_map(|(n, judged)| {
        let said = judged.input_uncertainty.as_ref()?.sentences().join("; ");
        let at = format!("scenario-{}", n + 1);
        Some(row("Inputs in a load case", format!("{}: {said}", judged.scenario), at))
    });
    of_springs.into_iter().chain(of_cases).collect()
}

fn validation(data: &ReportData<'_>) -> Vec<Row> {
    match &data.verdict.validation {
        Some(of) => vec![row("Measured curve", of.sentence(), "validation")],
        None => vec![row(
            "Against measurement",
            "none made; validation.measured names a curve of force and displacement",
            "",
        )],
    }
}

fn limits_of_use() -> Vec<Row> {
    vec![
        row("Not covered", "what the springs do not have at all", "not-covered"),
        row("Known defects", format!("{} of the program", defects().len()), "defects"),
    ]
}

fn review(data: &ReportData<'_>) -> Vec<Row> {
    let of = data.review;
    let stated = |value: &Option<String>, key: &str| {
        value.clone().unwrap_or_else(|| format!("not stated: review.{key} of the study"))
    };
    let failed = data.checks.iter().filter(|check| !check.holds()).count();
    let machine =
        data.measured.machine.processor.as_deref().unwrap_or("a processor that the system does not name");
    let test = format!(
        "railspring {}: {} of {} checks of `railspring self-test` hold on {machine}",
        version::FULL,
        data.checks.len() - failed,
        data.checks.len()
    );
    vec![
        row("Author", stated(&of.author, "author"), ""),
        row("Reviewer", stated(&of.reviewer, "reviewer"), ""),
        row("Independent of", stated(&of.independent_of, "independent_of"), ""),
        Row { fails: failed > 0, ..row("Program and its test", test, "self-test") },
    ]
}

/// A check as a row of text.
fn check(of: &Check) -> Value {
    json!({
        "name": of.name,
        "source": of.source,
        "found": in_digits(of.found),
        "expected": in_digits(of.expected),
        "off": format!("{:+.1e}", of.relative_error()),
        "tolerance": format!("{:.1e}", of.tolerance),
        "holds": of.holds(),
    })
}

/// A value with six digits, with a power of ten where it is far from one.
fn in_digits(value: f64) -> String {
    if (1e-2..1e3).contains(&value.abs()) { significant(value, 6) } else { format!("{value:.5e}") }
}

/// Title and text of each known defect.
fn defects() -> Vec<[String; 2]> {
    let plain = |text: &str| {
        // a link is its text
        let mut parts = text.split("[");
        let first = parts.next().unwrap_or_default().to_owned();
        parts.fold(first, |all, part| {
            let (name, rest) = part.split_once("](").unwrap_or((part, ""));
            all + name + rest.split_once(')').map_or("", |(_, rest)| rest)
        })
    };
    DEFECTS
        .lines()
        .filter_map(|line| line.strip_prefix("- **")?.split_once("** "))
        .map(|(title, text)| [title.trim_end_matches('.').into(), plain(text)])
        .collect()
}

/// A value in per cent, or that it is not known.
fn known(value: Option<f64>) -> String {
    value.map_or_else(|| "not known".into(), percent)
}

fn percent(value: f64) -> String {
    format!("{} %", significant(1e2 * value, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: docs/known-defects.md. Goal: every item of the list is a defect with title and text, without the marks of links.
    #[test]
    fn the_list_of_defects_is_whole() {
        let all = defects();
        assert_eq!(all.len(), DEFECTS.lines().filter(|line| line.starts_with("- ")).count());
        assert!(all.len() > 3);
        for [title, text] in all {
            assert!(!title.contains('*') && !text.contains("](") && text.ends_with('.'), "{title}: {text}");
        }
    }
}
