//! The verdict as a stage.

use std::collections::BTreeMap;

use railspring_calibrate::error::Result;
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::units::{KILONEWTON_PER_METRE, MILLIMETRE};

use super::runs::{Other, Run, SIMPLE, SOLID, of_element};
use super::stage::{Made, Stage};
use super::{OF_THE_VERDICT, Pipeline, STIFFNESS, VERIFICATION, history_file, part_json};
use crate::output::to_json;
use crate::records::{
    ElementDifferences, ElementVerdict, HubDeviationRecord, ScenarioVerdict, StiffnessRecord,
    VerificationRecord,
};
use crate::results::{Entry, NewFile, Results};
use crate::store::{Address, Artefact, Kind};
use crate::study::{ContactElementKey, Study};
use crate::verify::{self, Line};

/// The runs of a scenario: the simple model with the study's contact element, the same with the other one, and the solid model.
pub(super) struct Runs {
    pub simple: Run,
    pub other: Other,
    pub solid: Option<Run>,
}

/// The comparison of both models; `stiffness` is that of the study, if one of the simple models ran with it.
pub(super) struct Verify<'a> {
    pub stiffness: Option<&'a StiffnessRecord>,
    pub runs: &'a [(String, Runs)],
}

impl Stage for Verify<'_> {
    type Value = VerificationRecord;

    fn name(&self) -> String {
        "verdict".into()
    }

    fn address(&self, at: &mut Pipeline<'_>) -> Result<Address> {
        Ok(verdict_address(at, self.stiffness.is_some()))
    }

    fn is_kept(&self) -> bool {
        false
    }

    fn make(&self, at: &mut Pipeline<'_>) -> Result<Made> {
        let study = at.study;
        let mut scenarios = Vec::new();
        for (name, Runs { simple, other, solid }) in self.runs {
            let compared = |run: &Run| {
                let solid = solid.as_ref()?;
                Some(verify::compare(&run.model(), &solid.model(), &study.limits))
            };
            let comparison = compared(simple).transpose()?;
            let own = ElementVerdict {
                element: other.element.other().name().into(),
                run: None,
                missing: None,
                differences: comparison.as_ref().map(ElementDifferences::from),
            };
            let other = match &other.run {
                Ok(run) => ElementVerdict {
                    element: other.element.name().into(),
                    run: Some(run.record.clone()),
                    missing: None,
                    differences: compared(run).transpose()?.as_ref().map(ElementDifferences::from),
                },
                Err(reason) => ElementVerdict {
                    element: other.element.name().into(),
                    run: None,
                    missing: Some(reason.clone()),
                    differences: None,
                },
            };
            let (lines, not_applicable, compared) = match comparison {
                Some(c) => (c.lines, c.not_applicable, Some(c.compared)),
                None => (verify::run_lines(&simple.history, None), Vec::new(), None),
            };
            scenarios.push(ScenarioVerdict {
                scenario: name.clone(),
                simple: simple.record.clone(),
                solid: solid.as_ref().map(|run| run.record.clone()),
                lines,
                not_applicable,
                compared,
                elements: vec![own, other],
            });
        }
        let mut verdict = VerificationRecord {
            study: study.name.clone(),
            holds: false,
            calibration: self
                .stiffness
                .map_or_else(Vec::new, |record| calibration_lines(study, record, self.runs)),
            scenarios,
            input_hash: String::new(),
            inputs: contents(inputs(study, &at.results, self.stiffness.is_some())),
            version: env!("CARGO_PKG_VERSION").into(),
        };
        let holds = verdict.lines().all(|(_, line)| line.holds);
        verdict.holds = holds;
        Ok(Made::whole(Artefact::default().with(VERIFICATION, to_json(&verdict))))
    }

    fn value(&self, artefact: &Artefact, key: &str, _: &mut Pipeline<'_>) -> Result<VerificationRecord> {
        let verdict: VerificationRecord = part_json(artefact, VERIFICATION)?;
        Ok(VerificationRecord { input_hash: key.into(), ..verdict })
    }

    fn files(&self, _: &Artefact, value: &VerificationRecord, key: &str, _: &Pipeline<'_>) -> Vec<NewFile> {
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
pub(super) fn verdict_address(at: &Pipeline<'_>, with_stiffness: bool) -> Address {
    let Pipeline { study, results, .. } = at;
    let files: BTreeMap<String, [String; 2]> = inputs(study, results, with_stiffness)
        .into_iter()
        .map(|(name, entry)| (name, [entry.key, entry.blake3.unwrap_or_default()]))
        .collect();
    Address::of(Kind::Verdict, &(&study.name, &study.limits, files))
}

/// The hashes of the contents of files.
fn contents(files: BTreeMap<String, Entry>) -> BTreeMap<String, String> {
    files.into_iter().filter_map(|(name, entry)| Some((name, entry.blake3?))).collect()
}

/// What is listed about the files that a verdict is made from.
fn inputs(study: &Study, results: &Results<'_>, with_stiffness: bool) -> BTreeMap<String, Entry> {
    let histories = study.scenarios.iter().flat_map(|(name, scenario)| {
        let files = |stems: [&str; 2]| -> Vec<String> {
            let [file, disturbed] = stems.map(|stem| history_file(study, name, stem));
            let entry = results.entry(&file).and_then(|entry| entry.run);
            let known = entry.is_some_and(|run| run.spread.is_some());
            [file].into_iter().chain(known.then_some(disturbed)).collect()
        };
        let solid = if scenario.solid { files(SOLID) } else { Vec::new() };
        // those of the element that does not run are not there
        let others = [ContactElementKey::Condensed, ContactElementKey::Published].map(of_element);
        let others = others.iter().flat_map(|[file, disturbed]| files([file, disturbed]));
        files(SIMPLE).into_iter().chain(others.collect::<Vec<_>>()).chain(solid)
    });
    let stiffness = with_stiffness.then(|| STIFFNESS.to_owned());
    stiffness
        .into_iter()
        .chain(histories)
        .filter_map(|name| results.entry(&name).map(|entry| (name, entry)))
        .collect()
}

/// The comparison with the published law, which says whose wheel that is; the conical standard wheel is the nearest to it.
fn published_line(study: &Study, line: Line) -> Line {
    const CONICAL: &str = "EN13715-1in40";
    let wheel = &study.wheel;
    if wheel.profile == CONICAL && wheel.measured.is_none() {
        return line;
    }
    let measured = if wheel.measured.is_some() { "measured, on " } else { "" };
    line.noted(format!(
        "another wheel than the published one: {measured}{} of {:.0} mm beside SKS-700, to whose law a conical wheel comes near \
         (data/studies/conical.toml)",
        wheel.profile,
        wheel.tape_diameter / MILLIMETRE
    ))
}

/// Where the condensed element of a run is farthest from the solid, as far as it is known; none of a run with the published element.
fn condensed(runs: &Runs) -> Option<Option<HubDeviationRecord>> {
    let springs = runs.simple.record.springs.as_ref()?;
    springs.element_blake3.is_some().then_some(springs.element_displacement)
}

/// Lines of the verdict on the springs themselves.
fn calibration_lines(study: &Study, stiffness: &StiffnessRecord, runs: &[(String, Runs)]) -> Vec<Line> {
    /// Load at which the published law is compared, kN.
    const COMPARED_AT_KN: f64 = 85.0;
    let limits = &study.limits;
    let published = StiffnessLaw::published().tangent(COMPARED_AT_KN * 1e3) / KILONEWTON_PER_METRE;
    let foot = stiffness.references.iter().find(|reference| reference.reference == "foot");
    let against_published = foot.map(|foot| {
        let difference = (foot.law.constants.tangent(COMPARED_AT_KN) / published - 1.0).abs();
        published_line(study, limits.published_stiffness().line(Some(difference)))
    });
    let of_condensed: Vec<HubDeviationRecord> =
        runs.iter().filter_map(|run| condensed(&run.1)).flatten().collect();
    let all_condensed = !runs.is_empty() && runs.iter().all(|run| condensed(&run.1).is_some());
    let of_law = stiffness.references.iter().map(|r| r.displacement.max_rel_error).max_by(f64::total_cmp);
    let spread = stiffness.horizontal.as_ref().map(|h| h.relative_spread);
    let loads = verify::LOADS_LEFT_OUT.line(Some(stiffness.loads_left_out() as f64));
    let left_out = stiffness.shortened();
    let loads = if left_out.is_empty() { loads } else { loads.noted(left_out.join("; ")) };
    let beam = limits.beam_missing().line(Some(stiffness.beam.missing));
    if all_condensed {
        // it has neither a law of this form nor a constant horizontal stiffness
        let farthest = of_condensed.into_iter().max_by(|a, b| a.max_rel_error.total_cmp(&b.max_rel_error));
        let line = limits.law_displacement().line(farthest.map(|at| at.max_rel_error));
        let line = match farthest {
            Some(at) => line.noted(format!(
                "of the condensed element, with the wheelset {} mm aside under {} kN",
                (at.shift_mm * 1e3).round() / 1e3,
                at.force_kn
            )),
            None => line.noted("no place and load has a displacement of both"),
        };
        return [loads, line, beam].into_iter().chain(against_published).collect();
    }
    let lines = [
        loads,
        limits.law_max().line(Some(stiffness.law.max_rel_error)),
        limits.law_displacement().line(of_law),
        beam,
        limits.horizontal_spread().line(spread),
    ];
    lines.into_iter().chain(against_published).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// Goal: the comparison with the published law says that S1002, and a measured wheel, are other wheels than the published one; beside the
    /// conical standard wheel it says nothing.
    #[test]
    fn another_wheel_than_the_published_one_is_named() {
        let note = |wheel: &str| {
            let text = format!(
                "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"{wheel}\"\ntape_diameter_m = 0.858\n"
            );
            let study = Study::parse(Path::new("x.toml"), &text).map_err(|e| e.to_string()).unwrap();
            published_line(&study, study.limits.published_stiffness().line(Some(0.3))).note
        };
        let said = note("S1002").unwrap();
        assert!(
            said.contains("another wheel than the published one: S1002 of 858 mm beside SKS-700"),
            "{said}"
        );
        assert_eq!(note("EN13715-1in40"), None);
    }
}
