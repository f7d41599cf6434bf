//! The tables of the report.

use railspring_simulate::time::history::Ending;
use serde::Serialize;

use crate::report::number::number;
use crate::results::run::figures::ScenarioRun;
use crate::results::run::record::RunRecord;
use crate::results::springs::assumed_record::OtherRecord;
use crate::results::springs::band_record::BandPointRecord;
use crate::results::springs::record::StiffnessRecord;
use crate::results::verdict::input_bands::InputBands;
use crate::results::verdict::record::{ElementVerdict, ScenarioVerdict, VerificationRecord};
use crate::study::ResolvedKey;
use crate::verify::{self, HeldBy, Kind, Line};

/// The keys of one section.
#[derive(Debug, Serialize)]
pub(crate) struct Group {
    section: String,
    rows: Vec<ResolvedKey>,
}

/// Keys grouped by section, in their order.
pub(crate) fn grouped(inputs: &[ResolvedKey]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for row in inputs {
        match groups.iter_mut().find(|group| group.section == row.section) {
            Some(group) => group.rows.push(row.clone()),
            None => groups.push(Group { section: row.section.clone(), rows: vec![row.clone()] }),
        }
    }
    groups
}

/// A line of the verdict as text.
#[derive(Debug, Serialize)]
pub(crate) struct LineText {
    subject: String,
    meaning: String,
    kind: &'static str,
    over: String,
    value: String,
    limit: String,
    solid_uncertainty: String,
    simple_uncertainty: String,
    holds: bool,
    verdict: &'static str,
    note: Option<String>,
}

/// All lines of the verdict.
pub(crate) fn lines(verdict: &VerificationRecord) -> Vec<LineText> {
    verdict.lines().map(|(subject, line)| line_text(subject, line)).collect()
}

/// What has to be known about the runs, each once with the scenarios that it concerns.
pub(crate) fn notes(verdict: &VerificationRecord) -> Vec<(String, String)> {
    let mut notes: Vec<(String, String)> = Vec::new();
    for (subject, note) in verdict.notes() {
        match notes.iter_mut().find(|(_, known)| *known == note) {
            Some((subjects, _)) => *subjects = format!("{subjects}, {subject}"),
            None => notes.push((subject.into(), note)),
        }
    }
    notes
}

/// Degrees of freedom of the models, and modes of the solid one, as rows of text: scenario, simple, solid.
pub(crate) fn models(verdict: &VerificationRecord) -> Vec<[String; 3]> {
    let size = |run: Option<&RunRecord>| {
        let Some(run) = run else { return "not run".into() };
        let size = number(run.degrees_of_freedom as f64);
        let Some(reduction) = &run.reduction else { return size };
        let percent = |change: f64| format!("{} %", number(100.0 * change));
        format!(
            "{size}, reduced to {} modes of the rail and {} of the wheel; against {} and {} of them P changes by {} and Q by {} of the peak",
            reduction.rail_modes,
            reduction.wheel_modes,
            reduction.against_modes[0],
            reduction.against_modes[1],
            percent(reduction.vertical_change),
            percent(reduction.lateral_change)
        )
    };
    verdict
        .scenarios
        .iter()
        .map(|s| [s.scenario.clone(), size(Some(&s.simple)), size(s.solid.as_ref())])
        .collect()
}

/// How the runs ended, where one did not reach its end.
pub(crate) fn endings(run: &ScenarioRun<'_>) -> Vec<String> {
    let elements = run.elements.iter().map(|of| (format!("Simple model, {} element", of.name), of));
    let solid = run.solid.iter().map(|of| ("Solid model".into(), of));
    let ends = elements.chain(solid).map(|(name, of)| (name, of.history.ending));
    ends.filter(|(_, ending)| *ending != Ending::Completed)
        .map(|(name, ending)| format!("{name}: {ending}"))
        .collect()
}

/// The contact elements beside the solid, as rows of text; none without a solid run.
pub(crate) fn elements(judged: &ScenarioVerdict) -> Vec<Vec<String>> {
    let none = || "\u{2013}".to_string();
    let percent = |value: Option<f64>| value.map_or_else(none, |v| format!("{:.1} %", 1e2 * v));
    let plain = |value: Option<f64>| value.map_or_else(none, number);
    let time = |value: Option<f64>| value.map_or_else(none, |v| format!("{} ms", number(1e3 * v)));
    let row = |(n, of): (usize, &ElementVerdict)| {
        let d = of.differences?;
        let name = if n == 0 { format!("{} (the study's)", of.element) } else { of.element.clone() };
        Some(vec![
            name,
            percent(d.vertical_rms),
            percent(d.lateral_rms),
            plain(d.ratio_rms),
            plain(d.ratio_max),
            plain(d.separations_unmatched),
            time(d.separation_begin_s),
            time(d.separation_end_s),
            d.over_s.map_or_else(none, |over| over.map(|t| number(1e3 * t)).join(" to ") + " ms"),
        ])
    };
    judged.elements.iter().enumerate().filter_map(row).collect()
}

/// Why an element did not run, a sentence for each that did not.
pub(crate) fn missing_elements(judged: &ScenarioVerdict) -> Vec<String> {
    let sentence = |of: &ElementVerdict| {
        let reason = of.missing.as_ref()?;
        Some(format!("The {} element has no run: {reason}.", of.element))
    };
    judged.elements.iter().filter_map(sentence).collect()
}

/// What uncertain inputs change in a load case, as the page shows it.
#[derive(Debug, Serialize)]
pub(crate) struct Inputs {
    /// Why that is not known.
    missing: Option<String>,
    /// How many samples there are.
    counts: String,
    /// What they leave out.
    left_out: String,
    /// Sentences.
    lines: Vec<String>,
    /// Values that each run has once: what, nominal, band, mostly from.
    rows: Vec<[String; 5]>,
}

/// What uncertain inputs change in a load case.
pub(crate) fn inputs(judged: &ScenarioVerdict) -> Inputs {
    let bands = judged.input_uncertainty.as_ref();
    Inputs {
        missing: judged.input_uncertainty_missing.clone(),
        counts: bands.map_or_else(String::new, |bands| bands.of.counts()),
        left_out: bands.map_or_else(String::new, |bands| bands.of.left_out.join("; ")),
        lines: bands.map_or_else(Vec::new, InputBands::sentences),
        rows: bands.map_or_else(Vec::new, |bands| bands.of.extremes()),
    }
}

pub(crate) fn line_text(subject: &str, line: &Line) -> LineText {
    let with_unit = |value: f64| match line.unit.as_str() {
        "1" => number(value),
        "s" => format!("{} ms", number(value * 1e3)),
        unit => format!("{} {unit}", number(value)),
    };
    LineText {
        subject: subject.into(),
        meaning: line.meaning.clone(),
        kind: match line.kind {
            Kind::Consistency => "consistency",
            Kind::Verification => "verification",
            Kind::CrossCode => "cross-code",
            Kind::Acceptance => "acceptance",
        },
        over: line.over().unwrap_or_default(),
        value: line.value.map_or_else(|| "no value".into(), with_unit),
        limit: with_unit(line.limit),
        solid_uncertainty: line.solid_uncertainty.map(with_unit).unwrap_or_default(),
        simple_uncertainty: line.simple_uncertainty.map(with_unit).unwrap_or_default(),
        holds: line.holds,
        verdict: match line.held_by {
            None => "fails",
            Some(HeldBy::Limit) => "holds",
            Some(HeldBy::SolidUncertainty) => "holds only within the solid's numerical uncertainty",
        },
        note: line.note.clone(),
    }
}

/// The force under which a wheel counts as separated, N: as the verdict has it, or beside the first model where there is no solid.
fn least_contact(run: &ScenarioRun<'_>) -> f64 {
    let reference = run.solid.iter().chain(&run.elements).next();
    reference.map_or(0.0, |of| verify::least_contact(of.history))
}

/// The separations of all models, as rows of text: number, then one column for each model.
pub(crate) fn separations(run: &ScenarioRun<'_>) -> Vec<Vec<String>> {
    let times = |s: Option<&verify::Separation>| match s {
        Some(s) => format!("{:.1} to {:.1} ms", s.begin_s * 1e3, s.end_s * 1e3),
        None => "none".into(),
    };
    let models = run.elements.iter().chain(&run.solid);
    let least = least_contact(run);
    let all: Vec<Vec<verify::Separation>> =
        models.map(|of| verify::separations(of.history, 0.0, least)).collect();
    let rows = all.iter().map(Vec::len).max().unwrap_or(0);
    let row = |n: usize| {
        let number = (n + 1).to_string();
        [number].into_iter().chain(all.iter().map(|of| times(of.get(n)))).collect()
    };
    (0..rows).map(row).collect()
}

/// The fractions of time in each mode, as rows of text: mode, then one column for each model.
pub(crate) fn modes(run: &ScenarioRun<'_>) -> Vec<Vec<String>> {
    let models = run.elements.iter().chain(&run.solid);
    let least = least_contact(run);
    let all: Vec<verify::ModeFractions> =
        models.map(|of| verify::mode_fractions(of.history, least)).collect();
    let percent = |value: f64| format!("{:.1} %", value * 100.0);
    let row = |name: &str, value: fn(&verify::ModeFractions) -> f64| {
        [name.to_string()].into_iter().chain(all.iter().map(|of| percent(value(of)))).collect()
    };
    vec![row("sticking", |m| m.stick), row("sliding", |m| m.slip), row("separated", |m| m.separated)]
}

/// Caption of the figure of the law.
pub(crate) fn law_caption(stiffness: &StiffnessRecord) -> String {
    let foot_held = stiffness.references.iter().any(|law| law.reference == "foot");
    let compared = if foot_held {
        ""
    } else {
        ", which is to be compared with that against the held foot (`calibration.foot_held`)"
    };
    format!(
        "Tangent stiffness over load: points of the solid with each displacement reference, the laws fitted to them, \
         the Hertz solution for the curvatures at the first touch, and the published law{compared}. In use: reference {}.",
        stiffness.reference
    )
}

/// Error bands of the law in use, as the page shows them.
#[derive(Debug, Serialize)]
pub(crate) struct LawErrors {
    /// Sentences.
    lines: Vec<String>,
    /// Load, kN, and in per cent: grid, meshes, scatter and band of the displacement, the same of the tangent.
    rows: Vec<[String; 9]>,
}

/// What was assumed of measured profiles, as the page shows it.
#[derive(Debug, Serialize)]
pub(crate) struct AssumedRows {
    /// The keys that say it otherwise.
    keys: String,
    /// Part, what it is, and in per cent the changes of displacement and tangent with the reference in use and of the approach alone, and of the horizontal
    /// stiffness.
    rows: Vec<[String; 7]>,
}

/// What other bodies and places do, if anything was assumed.
pub(crate) fn assumed(stiffness: &StiffnessRecord) -> Option<AssumedRows> {
    let record = stiffness.assumed.as_ref()?;
    let percent =
        |change: Option<f64>| change.map_or_else(|| "\u{2013}".into(), |change| number(1e2 * change));
    let of = |changes: &[(String, f64)], reference: &str| {
        percent(changes.iter().find(|(name, _)| name == reference).map(|(_, change)| *change))
    };
    let row = |other: &OtherRecord| {
        let in_use = &stiffness.reference;
        [
            other.part.clone(),
            other.name.clone(),
            of(&other.displacement, in_use),
            of(&other.tangent, in_use),
            of(&other.displacement, "local"),
            of(&other.tangent, "local"),
            percent(other.horizontal),
        ]
    };
    Some(AssumedRows { keys: record.keys.join(", "), rows: record.others.iter().map(row).collect() })
}

/// The error band of the law in use, if there is one.
pub(crate) fn law_errors(stiffness: &StiffnessRecord) -> Option<LawErrors> {
    let band = stiffness.error_band.as_ref()?;
    let row = |p: &BandPointRecord| {
        let displacement = [p.grid_displacement, p.mesh_displacement, p.scatter_displacement];
        let [grid, mesh, scatter, band] = percent_of_band(displacement, p.displacement);
        let tangent = [p.grid_tangent, p.mesh_tangent, p.scatter_tangent];
        let [tangent_grid, tangent_mesh, tangent_scatter, tangent_band] = percent_of_band(tangent, p.tangent);
        let force = number(p.force_kn);
        [force, grid, mesh, scatter, band, tangent_grid, tangent_mesh, tangent_scatter, tangent_band]
    };
    let rows = band.of(&stiffness.reference)?.points.iter().map(row).collect();
    Some(LawErrors { lines: stiffness.law_errors(), rows })
}

/// Relative changes and the band of their sum in per cent, all with the decimals of the band's second digit: a change below that is 0 without a sign.
fn percent_of_band(changes: [Option<f64>; 3], band: Option<f64>) -> [String; 4] {
    let widest = band.or_else(|| changes.into_iter().flatten().map(f64::abs).max_by(f64::total_cmp));
    let power =
        widest.filter(|widest| *widest > 0.0).map_or(-2, |widest| (1e2 * widest).log10().floor() as i32 - 1);
    let decimals = power.clamp(-9, 0).unsigned_abs() as usize;
    let text = |value: Option<f64>| match value {
        None => "\u{2013}".to_string(),
        Some(value) => {
            let text = format!("{:.decimals$}", 1e2 * value.abs());
            let zero = text.chars().all(|c| c == '0' || c == '.');
            format!("{}{text}", if value < 0.0 && !zero { "\u{2212}" } else { "" })
        }
    };
    let [grid, mesh, scatter] = changes.map(text);
    [grid, mesh, scatter, text(band)]
}

#[cfg(test)]
mod tests {
    use super::percent_of_band;

    /// Goal: changes have the decimals that their band has, and none is written as a negative zero.
    #[test]
    fn changes_have_the_digits_of_their_band() {
        let of =
            |grid: f64, mesh: f64, band: f64| percent_of_band([Some(grid), Some(mesh), None], Some(band));
        assert_eq!(of(-0.000_04, 0.0086, 0.008_64), ["0.00", "0.86", "\u{2013}", "0.86"]);
        assert_eq!(of(-0.0012, 0.0231, 0.0243), ["\u{2212}0.1", "2.3", "\u{2013}", "2.4"]);
        assert_eq!(of(0.0, 0.0, 0.0), ["0.00", "0.00", "\u{2013}", "0.00"]);
        assert_eq!(of(-3e-6, 1e-6, 4e-6), ["\u{2212}0.00030", "0.00010", "\u{2013}", "0.00040"]);
        let without = percent_of_band([None, Some(-0.02), Some(0.01)], None);
        assert_eq!(without, ["\u{2013}", "\u{2212}2.0", "1.0", "\u{2013}"]);
    }
}
