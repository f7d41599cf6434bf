//! The verdict as a stage.

use std::collections::BTreeMap;

use railspring_calibrate::law::StiffnessLaw;
use railspring_profiles::error::Result;
use railspring_profiles::units::{KILONEWTON_PER_METRE, MILLIMETRE};

use crate::engine::list::{Entry, NewFile, Results};
use crate::engine::output::to_json;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact};
use crate::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use crate::results::names::{OF_THE_VERDICT, STIFFNESS, VERIFICATION};
use crate::results::run::record::{RUN_NOTE, RunRecord};
use crate::results::run::springs;
use crate::results::run::stage::{Other, Run, Runs, SIMPLE, SOLID, history_files, of_element};
use crate::results::run::uncertain_stage;
use crate::results::springs::record::StiffnessRecord;
use crate::results::verdict::input::VerdictInput;
use crate::results::verdict::input_bands::InputBands;
use crate::results::verdict::judged::{Judging, hub_deviations, place};
use crate::results::verdict::law_lines::{law_lines, loads_used};
use crate::results::verdict::record::{
    ElementDifferences, ElementVerdict, ScenarioVerdict, VerdictSubject, VerificationRecord,
};
use crate::results::verdict::requirements::requirements;
use crate::results::verdict::validation::validation;
use crate::rounding::significant;
use crate::study::{ContactElementKey, Wheel};
use crate::verify::{self, Both, Criterion, Limits, Line, RunningStatistics};
use crate::version;

/// The comparison of both models; `stiffness` is that of the study, if one of the simple models ran with it.
pub(crate) struct Verify<'a> {
    pub input: VerdictInput<'a>,
    pub stiffness: Option<&'a StiffnessRecord>,
    /// The laws by contact angle of these springs, if the study wants them.
    pub by_angle: Option<&'a StiffnessByAngleRecord>,
    pub runs: &'a [(String, Runs)],
}

impl Stage for Verify<'_> {
    type Value = VerificationRecord;

    fn name(&self) -> String {
        "verdict".into()
    }

    fn address(&mut self, engine: &Engine<'_>) -> Result<Address> {
        Ok(verdict_address(&self.input, &engine.results, self.stiffness.is_some()))
    }

    fn is_kept(&self) -> bool {
        false
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput> {
        let input = &self.input;
        let mut scenarios = Vec::new();
        for (name, Runs { simple, others, uncertain, solid }) in self.runs {
            let compared = |run: &Run| {
                let solid = solid.as_ref()?;
                Some(verify::compare(&run.model(), &solid.model(), input.limits))
            };
            let comparison = compared(simple).transpose()?;
            let bands = uncertain.as_ref().map_err(Clone::clone).and_then(|run| {
                let beside = (solid.as_ref(), comparison.as_ref());
                let bands = InputBands::of(run, &simple.history, beside, input.limits);
                bands.ok_or_else(|| "no time step that is compared has a band".into())
            });
            let own = ElementVerdict {
                differences: comparison.as_ref().map(ElementDifferences::from),
                ..ElementVerdict::of(chosen(simple))
            };
            let mut elements = vec![own];
            for Other { element, run } in others {
                let of_other = ElementVerdict::of(*element);
                elements.push(match run {
                    Ok(run) => {
                        let comparison = compared(run).transpose()?;
                        ElementVerdict {
                            run: Some(run.record.clone()),
                            differences: comparison.as_ref().map(ElementDifferences::from),
                            lines: comparison
                                .map_or_else(|| verify::run_lines(&run.history, None), |c| c.lines),
                            ..of_other
                        }
                    }
                    Err(reason) => ElementVerdict { missing: Some(reason.clone()), ..of_other },
                });
            }
            let (mut lines, mut not_applicable, compared) = match comparison {
                Some(c) => (c.lines, c.not_applicable, Some(c.compared)),
                None => (verify::run_lines(&simple.history, None), Vec::new(), None),
            };
            let speed = input.cases.get(name).map_or(0.0, |case| case.scenario.speed);
            let running = Both { simple: Some(simple), solid: solid.as_ref() }
                .map(|run| run.and_then(|run| RunningStatistics::of(&run.history, speed)));
            if let Some(limit) = input.ratio_limits.get(name.as_str()) {
                let solid = solid.as_ref().map(|_| ("solid model", running.solid.as_ref()));
                let models: Vec<_> =
                    [("simple model", running.simple.as_ref())].into_iter().chain(solid).collect();
                match verify::accepted(*limit, speed, &models) {
                    Ok(line) => lines.push(line),
                    Err(reason) => not_applicable.push(reason),
                }
            }
            scenarios.push(ScenarioVerdict {
                scenario: name.clone(),
                simple: simple.record.clone(),
                solid: solid.as_ref().map(|run| run.record.clone()),
                lines,
                not_applicable,
                compared,
                running: Some(running),
                elements,
                input_uncertainty_missing: bands.as_ref().err().cloned(),
                input_uncertainty: bands.ok(),
            });
        }
        let all_with = |element| {
            !self.runs.is_empty() && self.runs.iter().all(|(_, runs)| chosen(&runs.simple) == element)
        };
        let decides = [VerdictSubject::Element, VerdictSubject::Lumped]
            .into_iter()
            .find(|on| all_with(on.contact_element()))
            .unwrap_or(VerdictSubject::Springs);
        let of_solids = |on: VerdictSubject| {
            let laws = self.by_angle.filter(|laws| laws.element.is_some());
            self.stiffness
                .zip(laws)
                .map_or_else(Vec::new, |(record, laws)| statics_lines(input.limits, record, laws, on))
        };
        let validation =
            input.measured.zip(self.stiffness).and_then(|(curve, stiffness)| validation(curve, stiffness));
        let mut verdict = VerificationRecord {
            study: input.name.into(),
            holds: false,
            decides,
            verdicts: Vec::new(),
            changed_limits: input.limits.changed(),
            requirements: requirements(input.intended_use, self.stiffness, validation.as_ref()),
            validation,
            calibration: self
                .stiffness
                .map_or_else(Vec::new, |record| calibration_lines(input, record, loads_used(self.runs))),
            statics: of_solids(VerdictSubject::Element),
            lumped_statics: of_solids(VerdictSubject::Lumped),
            scenarios,
            input_hash: String::new(),
            inputs: contents(inputs(input, &engine.results, self.stiffness.is_some())),
            version: env!("CARGO_PKG_VERSION").into(),
            commit: version::COMMIT.into(),
        };
        let holds = verdict.lines().all(|(_, line)| line.holds);
        verdict.holds = holds;
        let judging = Judging { input, stiffness: self.stiffness, by_angle: self.by_angle, runs: self.runs };
        verdict.verdicts = judging.verdicts(&verdict);
        Ok(StageOutput::whole(Artefact::default().with(VERIFICATION, to_json(&verdict))))
    }

    fn value(&mut self, artefact: &Artefact, key: &str) -> Result<VerificationRecord> {
        let verdict: VerificationRecord = artefact.json(VERIFICATION)?;
        Ok(VerificationRecord { input_hash: key.into(), ..verdict })
    }

    fn files(&self, _: &Artefact, value: &VerificationRecord, key: &str) -> Vec<NewFile> {
        vec![NewFile::new(VERIFICATION, to_json(value), key)]
    }

    fn outdates(&self) -> &'static [&'static str] {
        &OF_THE_VERDICT
    }

    fn is_measured(&self) -> bool {
        false
    }
}

/// Address of the verdict on the files of the folder; with the springs if one of the load cases ran with those of the study.
pub(crate) fn verdict_address(
    input: &VerdictInput<'_>,
    results: &Results<'_>,
    with_stiffness: bool,
) -> Address {
    let files: BTreeMap<String, [String; 2]> = inputs(input, results, with_stiffness)
        .into_iter()
        .map(|(name, entry)| (name, [entry.key, entry.blake3.unwrap_or_default()]))
        .collect();
    input.address(&files)
}

/// The hashes of the contents of files.
fn contents(files: BTreeMap<String, Entry>) -> BTreeMap<String, String> {
    files.into_iter().filter_map(|(name, entry)| Some((name, entry.blake3?))).collect()
}

/// What is listed about the files that a verdict is made from.
fn inputs(input: &VerdictInput<'_>, results: &Results<'_>, with_stiffness: bool) -> BTreeMap<String, Entry> {
    let histories = input.cases.iter().flat_map(|(name, scenario)| {
        let files = |stems: [&str; 2]| -> Vec<String> {
            let [file, disturbed] = history_files(input.main_case, name, stems);
            let entry = results.entry(&file).and_then(|entry| entry.note::<RunRecord>(RUN_NOTE));
            let known = entry.is_some_and(|run| run.spread.is_some());
            [file].into_iter().chain(known.then_some(disturbed)).collect()
        };
        let solid = if scenario.solid { files(SOLID) } else { Vec::new() };
        // those of the element that does not run are not there
        let others = ContactElementKey::ALL.map(of_element);
        let others = others.iter().flat_map(|[file, disturbed]| files([file, disturbed]));
        let uncertain = input.wants_samples.then(|| uncertain_stage::file(input.main_case, name));
        files(SIMPLE).into_iter().chain(uncertain).chain(others.collect::<Vec<_>>()).chain(solid)
    });
    let stiffness = with_stiffness.then(|| [STIFFNESS, BY_ANGLE].map(str::to_owned));
    stiffness
        .into_iter()
        .flatten()
        .filter(|name| name != BY_ANGLE || input.wants_by_angle)
        .chain(histories)
        .filter_map(|name| results.entry(&name).map(|entry| (name, entry)))
        .collect()
}

/// The comparison with the published law, which says whose wheel that is; the conical standard wheel is the nearest to it.
fn published_line(wheel: &Wheel, line: Line) -> Line {
    const CONICAL: &str = "EN13715-1in40";
    let name = wheel.name().unwrap_or("a body of its own");
    if name == CONICAL && wheel.measured.is_none() {
        return line;
    }
    let measured = if wheel.measured.is_some() { "measured, on " } else { "" };
    line.noted(format!(
        "another wheel than the published one: {measured}{} of {:.0} mm beside SKS-700, to whose law a conical wheel comes near \
         (data/studies/conical.toml)",
        name,
        wheel.tape_diameter / MILLIMETRE
    ))
}

/// Contact element of a run of the simple model.
fn chosen(run: &Run) -> ContactElementKey {
    run.record.springs.as_ref().map_or(ContactElementKey::Published, springs::element)
}

/// That the springs have all loads of the study, as a line.
fn loads_line(stiffness: &StiffnessRecord) -> Line {
    let loads = verify::LOADS_LEFT_OUT.line(Some(stiffness.loads_left_out() as f64));
    let left_out = stiffness.shortened();
    if left_out.is_empty() { loads } else { loads.noted(left_out.join("; ")) }
}

/// That nothing is left to look at in the measured profiles, as a line; none where nothing is.
fn findings_line(stiffness: &StiffnessRecord) -> Option<Line> {
    let left = stiffness.findings_left();
    let line = verify::PROFILE_FINDINGS.line(Some(left.len() as f64));
    (!left.is_empty()).then(|| line.noted(left.join("; ")))
}

/// Lines of the verdict on the springs themselves.
fn calibration_lines(
    input: &VerdictInput<'_>,
    stiffness: &StiffnessRecord,
    used: Option<[f64; 2]>,
) -> Vec<Line> {
    /// Load at which the published law is compared, kN.
    const COMPARED_AT_KN: f64 = 85.0;
    let limits = input.limits;
    let published = StiffnessLaw::published().tangent(COMPARED_AT_KN * 1e3) / KILONEWTON_PER_METRE;
    let foot = stiffness.references.iter().find(|reference| reference.reference == "foot");
    let against_published = foot.map(|foot| {
        let difference = (foot.law.constants.tangent(COMPARED_AT_KN) / published - 1.0).abs();
        published_line(input.wheel, limits.published_stiffness().line(Some(difference)))
    });
    let [tangent, displacement] = law_lines(input, stiffness, used);
    let lines = [
        loads_line(stiffness),
        tangent,
        displacement,
        limits.beam_missing().line(Some(stiffness.beam.missing)),
        limits.horizontal_spread().line(stiffness.horizontal.as_ref().map(|h| h.relative_spread)),
    ];
    lines.into_iter().chain(against_published).chain(findings_line(stiffness)).collect()
}

/// Lines of the verdict on the condensed or the lumped element under static loads: what the load cases do not see.
pub fn statics_lines(
    limits: &Limits,
    stiffness: &StiffnessRecord,
    laws: &StiffnessByAngleRecord,
    on: VerdictSubject,
) -> Vec<Line> {
    const DIRECTIONS: [&str; 3] = [
        "Lateral flexibility of the element's hub (yy), largest difference from the solid over shifts and loads of one contact",
        "Lateral flexibility of the element's hub under vertical forces (yz), largest difference over shifts and loads of one contact",
        "Vertical flexibility of the element's hub (zz), largest difference from the solid over shifts and loads of one contact",
    ];
    let farthest = match on {
        VerdictSubject::Lumped => laws.lumped.as_ref().and_then(|element| element.displacement),
        _ => laws.element.as_ref().and_then(|element| element.displacement),
    };
    let displacement = limits.law_displacement();
    let displacement = Criterion {
        meaning: "Displacement of the element's hub along the contact normal, largest difference over that under the largest load",
        ..displacement
    };
    let displacement = displacement.line(farthest.map(|at| at.max_rel_error));
    let displacement = match farthest {
        Some(at) => displacement.noted(place(at.shift_mm, at.force_kn)),
        None => displacement.noted("no place and load has a displacement of both"),
    };
    let of_both = hub_deviations(laws, on, false).into_iter().zip(hub_deviations(laws, on, true));
    let hub = of_both.zip(DIRECTIONS).map(|((farthest, shared), meaning)| {
        let line = Criterion { meaning, ..limits.hub_compliance() }.line(farthest.map(|(off, ..)| off));
        match farthest {
            Some((_, shift_mm, force_kn)) => line.noted(place(shift_mm, force_kn) + &where_shared(shared)),
            None => line.noted("no place and load has both"),
        }
    });
    let beam = limits.beam_missing().line(Some(stiffness.beam.missing));
    let findings = findings_line(stiffness);
    [loads_line(stiffness), displacement].into_iter().chain(hub).chain([beam]).chain(findings).collect()
}

/// How far the hub is off where two contacts share the load, which no limit is set for: the element is fitted to single contacts.
fn where_shared(farthest: Option<(f64, f64, f64)>) -> String {
    farthest.map_or_else(String::new, |(off, shift_mm, force_kn)| {
        let off = significant(1e2 * off, 3);
        format!("; without a limit where two contacts share the load: {off} % {}", place(shift_mm, force_kn))
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::study::Study;

    /// Goal: the comparison with the published law says that S1002, and a measured wheel, are other wheels than the published one; beside the
    /// conical standard wheel it says nothing.
    #[test]
    fn another_wheel_than_the_published_one_is_named() {
        let note = |wheel: &str| {
            let text = format!(
                "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"{wheel}\"\ntape_diameter_m = 0.858\n"
            );
            let study = Study::parse(Path::new("x.toml"), &text).map_err(|e| e.to_string()).unwrap();
            published_line(&study.wheel, study.limits.published_stiffness().line(Some(0.3))).note
        };
        let said = note("S1002").unwrap();
        assert!(
            said.contains("another wheel than the published one: S1002 of 858 mm beside SKS-700"),
            "{said}"
        );
        assert_eq!(note("EN13715-1in40"), None);
    }
}
