//! What may be used, how far, and who answers for it: the first screen of the report.

use serde_json::{Value, json};

use crate::report::number::number;
use crate::results::page::data::ReportData;
use crate::results::run::record::SpringsSource;
use crate::results::springs::record::{LawRecord, StiffnessRecord};
use crate::results::verdict::reasons::reason;
use crate::results::verdict::record::{ScenarioVerdict, VerdictOn, VerdictSubject};
use crate::results::verdict::tables;
use crate::rounding::{rounded_to, significant};
use crate::study::{ContactElementKey, ResolvedKey};
use crate::verify::Kind;

/// The springs in use, the limits that fail, and what the springs are valid for.
pub(crate) fn first_screen(data: &ReportData<'_>) -> Value {
    json!({
        "springs": springs(data.stiffness),
        "verdicts": verdicts(data),
        "forms": forms(data),
        "changed_limits": data.verdict.changed_limits.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "law_notes": law_notes(data),
        "programs": programs(data),
        "failing": failing(data),
        "valid": valid(data),
        "purpose": data.intended_use.purpose,
        "required": required(data),
        "author": data.review.author,
        "reviewer": data.review.reviewer,
        "independent_of": data.review.independent_of,
    })
}

/// What the intended use asks for, a sentence each.
fn required(data: &ReportData<'_>) -> Vec<String> {
    let of = data.intended_use;
    let parts = [
        ("displacement", of.displacement_percent),
        ("tangent stiffness", of.tangent_percent),
        ("horizontal stiffness", of.horizontal_percent),
    ];
    let known = parts.into_iter().filter_map(|(what, percent)| Some((what, percent?)));
    known.map(|(what, percent)| format!("{what} within \u{b1}{} % (95 %)", number(percent))).collect()
}

/// A, b and c of a law, rounded to their standard errors; a and b in kN/m.
pub(crate) fn constants(law: &LawRecord) -> [String; 3] {
    constants_in(law, "")
}

/// The same with a unit behind a and b.
fn constants_in(law: &LawRecord, unit: &str) -> [String; 3] {
    let LawRecord { constants, at_bound, .. } = law;
    let text = |value: f64, error: f64, bound: bool, unit: &str| match (bound, rounded_to(value, error)) {
        (true, _) => format!("{}{unit}, at its bound", number(value)),
        (false, (value, Some(error))) => format!("{value} \u{b1} {error}{unit}"),
        (false, (value, None)) => format!("{value}{unit}"),
    };
    [
        text(constants.a_kn_per_m, law.a_standard_error_kn_per_m, at_bound.a, unit),
        text(constants.b_kn_per_m, law.b_standard_error_kn_per_m, at_bound.b, unit),
        text(constants.c, law.c_standard_error, at_bound.c, ""),
    ]
}

/// The verdicts, the one that decides first: on what, the lines counted, for which loads and uses it holds and for which not.
fn verdicts(data: &ReportData<'_>) -> Vec<Value> {
    let row = |of: &VerdictOn| {
        let what = match of.on {
            VerdictSubject::Element => "condensed contact element",
            VerdictSubject::Lumped => "lumped contact element: bodies, bushings, strips",
            VerdictSubject::Springs => "springs: law, horizontal stiffness, published element",
        };
        json!({ "on": what, "counts": of.counts(), "fails": of.fail > 0, "holds_for": of.holds_for, "not_for": of.not_for })
    };
    data.verdict.verdicts.iter().map(row).collect()
}

/// What each contact element loses on each load case beside the solid: load case, element, P, Q, averaged Q/P and its largest difference.
fn forms(data: &ReportData<'_>) -> Vec<[String; 6]> {
    let percent = |value: Option<f64>| {
        value.map_or_else(|| "\u{2013}".into(), |value| format!("{} %", significant(1e2 * value, 2)))
    };
    let plain = |value: Option<f64>| value.map_or_else(|| "\u{2013}".into(), |value| significant(value, 2));
    let of_case = |judged: &'_ ScenarioVerdict| -> Vec<[String; 6]> {
        let row = |element: ContactElementKey| {
            let of = judged.elements.iter().find(|of| of.element == element.name())?;
            let d = of.differences?;
            Some([
                judged.scenario.clone(),
                element.name().into(),
                percent(d.vertical_rms),
                percent(d.lateral_rms),
                plain(d.ratio_rms),
                plain(d.ratio_max),
            ])
        };
        ContactElementKey::ALL.into_iter().rev().filter_map(row).collect()
    };
    data.verdict.scenarios.iter().flat_map(of_case).collect()
}

/// In which respects load cases ran with springs that are not those of this study.
fn law_notes(data: &ReportData<'_>) -> Vec<String> {
    let springs = data.verdict.scenarios.iter().filter_map(|judged| judged.simple.springs.as_ref());
    let others = springs.filter(|springs| springs.source != SpringsSource::Calibrated);
    let mut notes: Vec<String> = others.flat_map(|springs| springs.notes.clone()).collect();
    notes.dedup();
    notes
}

/// The programs that made the files of the result.
fn programs(data: &ReportData<'_>) -> String {
    let mut all = data.programs.to_vec();
    all.dedup();
    all.join(", ")
}

/// An error band in per cent.
fn band_text(band: Option<f64>) -> String {
    band.map_or_else(|| "not known".into(), |band| format!("\u{b1} {} %", significant(1e2 * band, 2)))
}

/// The horizontal stiffness with its error band, or why there is none.
pub(crate) fn horizontal(stiffness: &StiffnessRecord) -> String {
    let band = stiffness.horizontal.as_ref().and_then(|all| all.error_band.as_ref()?.band);
    match (stiffness.horizontal_kn_per_m, &stiffness.horizontal_missing) {
        (Some(value), _) => format!("{} kN/m, error band {}", significant(value, 3), band_text(band)),
        (None, Some(reason)) => format!("none: {reason}"),
        (None, None) => "none".into(),
    }
}

/// Name, value and unit of what a simple model takes.
fn springs(stiffness: &StiffnessRecord) -> Vec<[String; 2]> {
    let law = &stiffness.law;
    let [a, b, c] = constants_in(law, " kN/m");
    let band = stiffness.error_band.as_ref().and_then(|band| band.of(&stiffness.reference));
    let row = |name: &str, value: String| [name.to_string(), value];
    let mut rows = vec![
        row("a", a),
        row("b", b),
        row("c", c),
        row("f0", format!("{} kN", number(law.constants.f0_kn))),
        row("range", format!("{} to {} kN", number(law.range_kn[0]), number(law.range_kn[1]))),
        row("error band, displacement", band_text(band.and_then(|band| band.displacement))),
        row("error band, tangent", band_text(band.and_then(|band| band.tangent))),
        row(
            "error of the law against the solid's tangents",
            format!(
                "{} % (RMS), {} % at most",
                significant(1e2 * law.rms_rel_error, 2),
                significant(1e2 * law.max_rel_error, 2)
            ),
        ),
        row("horizontal stiffness", horizontal(stiffness)),
    ];
    let uncertain = stiffness.input_uncertainty.as_ref().and_then(|of| of.middle());
    rows.extend(uncertain.map(|point| {
        let load = number((10.0 * point.force_kn).round() / 10.0);
        row(&format!("uncertainty of the tangent at {load} kN (95 %)"), point.tangent.sentence())
    }));
    let assumed = stiffness.assumed.as_ref();
    rows.extend(
        assumed.map(|assumed| row("with other bodies and places", assumed.ranges(&stiffness.reference))),
    );
    rows
}

/// The limits that fail, the worst first: text, reason and place in the table of all.
fn failing(data: &ReportData<'_>) -> Vec<Value> {
    let all: Vec<_> = data.verdict.lines().collect();
    let failing = data.verdict.failing();
    let item = |(subject, line): &(&str, &crate::verify::Line)| {
        let at = all.iter().position(|(_, other)| std::ptr::eq(*other, *line)).map_or(0, |at| at + 1);
        json!({
            "line": tables::line_text(subject, line),
            "at": at,
            "why": match line.kind {
                Kind::Acceptance => "the study asks for it".into(),
                _ => reason(&line.quantity).replace('`', ""),
            },
        })
    };
    failing.iter().map(item).collect()
}

/// What the springs are valid for, and what they do not cover, a sentence each.
fn valid(data: &ReportData<'_>) -> [Vec<String>; 2] {
    let StiffnessRecord { law, reference, pair, touch, .. } = data.stiffness;
    let key = |section: &str, name: &str| {
        let found = |key: &&ResolvedKey| key.section == section && key.key == name;
        data.inputs.iter().find(found).map_or_else(|| "not known".into(), |key| key.value.clone())
    };
    let mut holds = vec![
        format!("The pair {}.", pair.name),
        format!(
            "Vertical forces from {} to {} kN; displacement against {reference}.",
            number(law.range_kn[0]),
            number(law.range_kn[1])
        ),
        format!(
            "Lateral shift {} mm, contact angle {}\u{b0} at the first touch; friction {}.",
            key("track", "lateral_shift_mm"),
            significant(touch.angle_deg, 2),
            key("contact", "friction")
        ),
    ];
    if let Some(laws) = data.by_angle {
        let shifts = laws.shifts.iter().map(|shift| shift.shift_mm);
        let [least, most] = shifts.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], shift| {
            [least.min(shift), most.max(shift)]
        });
        if least <= most {
            holds.push(format!(
                "At other shifts, from {} to {} mm, the laws by contact angle, not this one.",
                number(least),
                number(most)
            ));
        }
    }
    let mut not = vec![
        "Other profiles, or these with other wear; other loads: nothing is extrapolated.".to_string(),
        "Plastic flow, roughness, an angle of attack of the wheel, and creep forces of rolling, which are no springs.".to_string(),
    ];
    if data.scenarios.iter().all(|scenario| scenario.solid.is_none()) {
        not.push("Motion: no load case was compared with the solid model.".into());
    }
    [holds, not]
}
