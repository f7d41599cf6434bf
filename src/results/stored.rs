//! Results of earlier commands: taken from the folder if they are those of the study as it is now.

use railspring_profiles::error::{Error, InputError, Result};
use railspring_simulate::time::history::{Ending, History};

use crate::engine::list::Entry;
use crate::engine::output::parse_json;
use crate::results::bodies::in_work::REACH_NOTE;
use crate::results::by_angle::input::ByAngleInput;
use crate::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use crate::results::names::{LOAD_CURVE, PATCHES, STIFFNESS, VERIFICATION};
use crate::results::patches::record::PatchesRecord;
use crate::results::run::input::{SimpleRunInput, SpringsInput, UncertainInput};
use crate::results::run::record::{RUN_NOTE, RunRecord, SpringsRecord, SpringsSource};
use crate::results::run::stage::{Other, Run, Runs, SIMPLE, SOLID, history_files, of_element};
use crate::results::run::uncertain_record::{self, UNCERTAIN_NOTE, UncertainRun};
use crate::results::run::uncertain_stage::{self, Uncertain};
use crate::results::run::{history_csv, springs};
use crate::results::springs::make::Calibration;
use crate::results::springs::record::{LoadCurveRow, StiffnessRecord};
use crate::results::springs::stage::load_curve;
use crate::results::springs::uncertain_inputs::UncertainInputs;
use crate::results::study_run::StudyRun;
use crate::results::verdict::input::VerdictInput;
use crate::results::verdict::record::VerificationRecord;
use crate::results::verdict::stage::verdict_address;
use crate::study::{ContactElementKey, StudyScenario};

/// A time further from that of the study than this share of a step belongs to another run. Twelve digits are written,
/// so that a time after a million steps is right to a hundred-thousandth of a step.
const OTHER_STEP: f64 = 1e-3;

/// Springs of the simple model, and the laws by contact angle beside them.
pub(crate) type SpringsAndLaws = (SpringsRecord, Option<StiffnessByAngleRecord>);

/// A run of the simple model with its springs.
pub(crate) type SimpleRun = (Run, SpringsAndLaws);

/// What the report needs.
pub(crate) struct Stored {
    pub calibration: Calibration,
    pub by_angle: Option<StiffnessByAngleRecord>,
    pub runs: Vec<(String, Runs)>,
    pub verdict: VerificationRecord,
}

impl StudyRun<'_> {
    /// The folder's springs, if they were calibrated from this study's inputs.
    pub(crate) fn stored_stiffness(&mut self) -> Result<StiffnessRecord> {
        let text = self.engine.results.text(STIFFNESS, "calibrate")?;
        let stiffness = parse_json(&self.engine.folder.file(STIFFNESS), &text, "calibrate")?;
        let address = self.solids.input.calibration();
        let entry = self.engine.results.check(STIFFNESS, &text, address.key(), "calibrate")?;
        entry.note(REACH_NOTE).into_iter().for_each(|reach| self.solids.go_on_from(reach));
        Ok(stiffness)
    }

    /// The folder's springs as the simple model runs with them.
    pub(crate) fn stored_springs(&mut self) -> Result<SpringsAndLaws> {
        let stiffness = self.stored_stiffness()?;
        self.springs_of(&stiffness)
    }

    fn springs_of(&mut self, stiffness: &StiffnessRecord) -> Result<SpringsAndLaws> {
        let laws = self.stored_by_angle()?;
        Ok((springs::springs_of_study(&SpringsInput::of(self.study), stiffness, laws.as_ref())?, laws))
    }

    /// The folder's laws by contact angle, if the study wants them.
    pub(crate) fn stored_by_angle(&mut self) -> Result<Option<StiffnessByAngleRecord>> {
        if !self.study.wants_by_angle() {
            return Ok(None);
        }
        let text = self.engine.results.text(BY_ANGLE, "calibrate")?;
        let laws = parse_json(&self.engine.folder.file(BY_ANGLE), &text, "calibrate")?;
        let address = ByAngleInput::of(self.study).address(self.solids.reach()?);
        self.engine.results.check(BY_ANGLE, &text, address.key(), "calibrate")?;
        Ok(Some(laws))
    }

    fn stored_load_curve(&self) -> Result<Vec<LoadCurveRow>> {
        let text = self.engine.results.text(LOAD_CURVE, "calibrate")?;
        self.engine.results.check(LOAD_CURVE, &text, self.solids.input.calibration().key(), "calibrate")?;
        load_curve(&self.engine.folder.file(LOAD_CURVE).display().to_string(), &text)
    }

    fn stored_patches(&self) -> Result<PatchesRecord> {
        let text = self.engine.results.text(PATCHES, "calibrate")?;
        let patches = parse_json(&self.engine.folder.file(PATCHES), &text, "calibrate")?;
        self.engine.results.check(PATCHES, &text, self.solids.input.calibration().key(), "calibrate")?;
        Ok(patches)
    }

    /// The runs of the simple model with their springs, and the study's springs if one of them ran with them.
    pub(crate) fn stored_simple_runs(&mut self) -> Result<(Option<StiffnessRecord>, Vec<SimpleRun>)> {
        let all_from_files = !self.study.scenarios.is_empty()
            && self.study.scenarios.keys().all(|name| self.run_from_file(name).is_some());
        let stiffness = if all_from_files { None } else { Some(self.stored_stiffness()?) };
        let runs = self
            .study
            .scenarios
            .iter()
            .map(|(name, scenario)| self.stored_simple_run(stiffness.as_ref(), name, scenario))
            .collect::<Result<_>>()?;
        Ok((stiffness, runs))
    }

    /// What is noted of a run of the simple model with the springs of a law file, if it is one.
    fn run_from_file(&self, case: &str) -> Option<RunRecord> {
        let [file, _] = history_files(self.solids.input.main_case, case, SIMPLE);
        self.engine.results.entry(&file)?.note(RUN_NOTE).filter(from_file)
    }

    /// A run of the simple model with the springs that it should have: those of a law file, as `simulate --law` has
    /// noted them, or else the study's own.
    fn stored_simple_run(
        &mut self,
        stiffness: Option<&StiffnessRecord>,
        name: &str,
        scenario: &StudyScenario,
    ) -> Result<SimpleRun> {
        let files = history_files(self.solids.input.main_case, name, SIMPLE);
        let springs = match (self.run_from_file(name).and_then(|run| run.springs), stiffness) {
            (Some(springs), _) => (springs, None),
            (None, Some(stiffness)) => self.springs_of(stiffness)?,
            (None, None) => self.stored_springs()?,
        };
        let address = SimpleRunInput::of(self.study, scenario).address(&springs.0);
        Ok((self.stored_run(&files, scenario, address.key(), "simulate")?, springs))
    }

    /// The runs in the contact elements that the study has not chosen, or why the verdict has none.
    fn stored_others(
        &mut self,
        name: &str,
        scenario: &StudyScenario,
        springs: &SpringsAndLaws,
        verdict: &VerificationRecord,
    ) -> Result<Vec<Other>> {
        let others = springs::element(&springs.0).others();
        others.map(|element| self.stored_other(element, name, scenario, springs, verdict)).collect()
    }

    /// One of them.
    fn stored_other(
        &mut self,
        element: ContactElementKey,
        name: &str,
        scenario: &StudyScenario,
        (springs, laws): &SpringsAndLaws,
        verdict: &VerificationRecord,
    ) -> Result<Other> {
        let of = |missing: String| Other { element, run: Err(missing) };
        let springs = match springs::in_element(springs, laws.as_ref(), element) {
            Ok(springs) => springs,
            Err(reason) => return Ok(of(reason)),
        };
        let judged = verdict.scenarios.iter().find(|judged| judged.scenario == name);
        let judged = judged.and_then(|s| s.elements.iter().find(|judged| judged.element == element.name()));
        if let Some(reason) = judged.and_then(|judged| judged.missing.clone()) {
            return Ok(of(reason));
        }
        let files = history_files(self.solids.input.main_case, name, of_element(element));
        let address = SimpleRunInput::of(self.study, scenario).other_address(&springs);
        Ok(Other { element, run: Ok(self.stored_run(&files, scenario, address.key(), "simulate")?) })
    }

    /// The samples of uncertain inputs of a load case, or why the verdict has none.
    fn stored_uncertain(
        &self,
        name: &str,
        scenario: &StudyScenario,
        (springs, stiffness): (&SpringsRecord, Option<&StiffnessRecord>),
        verdict: &VerificationRecord,
    ) -> Result<Uncertain> {
        let statics = self.study.statics();
        if let Some(reason) = UncertainInputs::without_samples(statics) {
            return Ok(Err(reason.into()));
        }
        let judged = verdict.scenarios.iter().find(|judged| judged.scenario == name);
        if let Some(reason) = judged.and_then(|judged| judged.input_uncertainty_missing.clone()) {
            return Ok(Err(reason));
        }
        let file = uncertain_stage::file(self.solids.input.main_case, name);
        let text = self.engine.results.text(&file, "simulate")?;
        let rows = uncertain_record::read(&self.engine.folder.file(&file).display().to_string(), &text)?;
        let case = SimpleRunInput::of(self.study, scenario);
        let input = UncertainInput::of(case, springs, stiffness, (statics, &self.study.limits));
        let entry = self.engine.results.check(&file, &text, input.address().key(), "simulate")?;
        let record = entry.note(UNCERTAIN_NOTE).ok_or_else(|| {
            InputError::new(
                self.engine.folder.file(&file).display().to_string(),
                "no samples in results.json",
                "what is known of the samples",
                "make it again with `railspring simulate`",
            )
        })?;
        Ok(Ok(UncertainRun { rows, record }))
    }

    /// A run of the solid model.
    pub(crate) fn stored_solid_run(&mut self, name: &str, scenario: &StudyScenario) -> Result<Run> {
        let files = history_files(self.solids.input.main_case, name, SOLID);
        let address = self.solids.input.run(scenario).address(self.solids.reach()?);
        let run = self.stored_run(&files, scenario, address.key(), "verify")?;
        let entry = self.engine.results.entry(&files[0]);
        entry
            .and_then(|entry| entry.note(REACH_NOTE))
            .into_iter()
            .for_each(|reach| self.solids.go_on_from(reach));
        Ok(run)
    }

    /// A run with the disturbed one, if it has one.
    fn stored_run(
        &self,
        [file, disturbed]: &[String; 2],
        scenario: &StudyScenario,
        key: &str,
        made_by: &str,
    ) -> Result<Run> {
        let (history, record) = self.stored_history(file, scenario, key, made_by)?;
        let other = || Ok::<_, Error>(self.stored_history(disturbed, scenario, key, made_by)?.0);
        let disturbed = record.spread.is_some().then(other).transpose()?;
        Ok(Run { history, record, disturbed })
    }

    fn stored_history(
        &self,
        file: &str,
        scenario: &StudyScenario,
        key: &str,
        made_by: &str,
    ) -> Result<(History, RunRecord)> {
        let text = self.engine.results.text(file, made_by)?;
        let path = self.engine.folder.file(file);
        // First, because it names the line of what was edited.
        let mut history = history_csv::read(&path, &text, 0, Ending::Completed)?;
        let entry: Entry = self.engine.results.check(file, &text, key, made_by)?;
        let known = entry
            .note::<RunRecord>(RUN_NOTE)
            .and_then(|record| record.ending().map(|ending| (record, ending)));
        let (record, ending) = known.ok_or_else(|| {
            InputError::new(
                path.display().to_string(),
                "no known ending in results.json",
                "a run that ended in a known way",
                format!("make it again with `railspring {made_by}`"),
            )
        })?;
        history.degrees_of_freedom = record.degrees_of_freedom;
        history.ending = ending;
        check_times(&path.display().to_string(), &history, scenario, made_by)?;
        Ok((history, record))
    }

    /// The verdict, if it is one on these very files and limits.
    fn stored_verdict(&self, with_stiffness: bool) -> Result<VerificationRecord> {
        let text = self.engine.results.text(VERIFICATION, "verify")?;
        let verdict = parse_json(&self.engine.folder.file(VERIFICATION), &text, "verify")?;
        let address = verdict_address(&VerdictInput::of(self.study), &self.engine.results, with_stiffness);
        self.engine.results.check(VERIFICATION, &text, address.key(), "verify")?;
        Ok(verdict)
    }

    /// Everything that the report needs.
    ///
    /// # Errors
    /// [`InputError`] that names every missing or stale file, and the commands that make them.
    pub(crate) fn stored_results(&mut self) -> Result<Stored> {
        let mut faults = Faults::default();
        let stiffness = faults.note("calibrate", self.stored_stiffness());
        let load_curve = faults.note("calibrate", self.stored_load_curve());
        let patches = faults.note("calibrate", self.stored_patches());
        let by_angle = faults.note("calibrate", self.stored_by_angle());
        let mut found = Vec::new();
        let mut any_calibrated = self.study.scenarios.is_empty();
        for (name, scenario) in &self.study.scenarios {
            // Without springs every history would be stale for the same reason.
            let simple = stiffness.as_ref().and_then(|stiffness| {
                faults.note("simulate", self.stored_simple_run(Some(stiffness), name, scenario))
            });
            let solid = match scenario.solid {
                true => faults.note("verify", self.stored_solid_run(name, scenario)).map(Some),
                false => Some(None),
            };
            if let (Some((simple, springs)), Some(solid)) = (simple, solid) {
                any_calibrated |= !from_file(&simple.record);
                found.push((name, scenario, springs, simple, solid));
            }
        }
        let verdict = faults.note("verify", self.stored_verdict(any_calibrated));
        let mut runs = Vec::new();
        for (name, scenario, springs, simple, solid) in found {
            let Some(verdict) = &verdict else { break };
            let others = self.stored_others(name, scenario, &springs, verdict);
            let uncertain = self.stored_uncertain(name, scenario, (&springs.0, stiffness.as_ref()), verdict);
            let both = (faults.note("simulate", others), faults.note("simulate", uncertain));
            if let (Some(others), Some(uncertain)) = both {
                runs.push((name.clone(), Runs { simple, others, uncertain, solid }));
            }
        }
        match (stiffness, load_curve, patches, by_angle, verdict) {
            (Some(stiffness), Some(load_curve), Some(patches), Some(by_angle), Some(verdict))
                if faults.is_empty() =>
            {
                let calibration = Calibration::kept(stiffness, load_curve, patches);
                Ok(Stored { calibration, by_angle, runs, verdict })
            }
            _ => Err(faults.error(&self.study.name)),
        }
    }
}

fn from_file(run: &RunRecord) -> bool {
    run.springs.as_ref().is_some_and(|springs| matches!(springs.source, SpringsSource::File { .. }))
}

/// What is missing or stale, and the commands that make it.
#[derive(Default)]
struct Faults {
    found: Vec<InputError>,
    other: Option<Error>,
    commands: Vec<&'static str>,
}

impl Faults {
    fn note<T>(&mut self, command: &'static str, result: Result<T>) -> Option<T> {
        match result {
            Ok(value) => return Some(value),
            Err(Error::Input(cause)) => self.found.push(cause),
            Err(other) => self.other = Some(other),
        }
        if !self.commands.contains(&command) {
            self.commands.push(command);
        }
        None
    }

    fn is_empty(&self) -> bool {
        self.found.is_empty() && self.other.is_none()
    }

    fn error(self, study: &str) -> Error {
        if let Some(other) = self.other {
            return other;
        }
        let order = ["calibrate", "simulate", "verify"];
        // What is made later depends on what is made earlier.
        let first = order.iter().position(|command| self.commands.contains(command)).unwrap_or(0);
        let commands: Vec<String> =
            order[first..].iter().map(|command| format!("`railspring {command}`")).collect();
        let mut listed: Vec<String> = self.found.iter().map(|e| format!("{} ({})", e.key, e.value)).collect();
        // one file may be asked for by several results
        listed.dedup();
        InputError::new(
            format!("results of {study}"),
            listed.join(", "),
            "results of this study as it is now: the study or the program has changed since, or a command was stopped",
            format!("run {}, or `railspring run`", commands.join(", ")),
        )
        .into()
    }
}

/// A complete run has all steps of the scenario, one that ended early fewer; each at its time.
fn check_times(path: &str, history: &History, scenario: &StudyScenario, made_by: &str) -> Result<()> {
    let scenario = &scenario.scenario;
    let (rows, all) = (history.rows.len(), scenario.steps + 1);
    let refused = |value: String, expected: String| {
        InputError::new(path, value, expected, format!("make it again with `railspring {made_by}`")).into()
    };
    let fits = if history.ending == Ending::Completed { rows == all } else { rows <= all };
    if !fits {
        return Err(refused(format!("{rows} rows"), format!("{all} rows, one for each time")));
    }
    let step = scenario.time_step;
    let wrong = history
        .rows
        .iter()
        .enumerate()
        .find(|(n, row)| !((row.time - *n as f64 * step).abs() <= OTHER_STEP * step));
    match wrong {
        None => Ok(()),
        Some((n, row)) => Err(refused(
            format!("{} s in row {n}", row.time),
            format!("{} s, a multiple of the time step", n as f64 * step),
        )),
    }
}
