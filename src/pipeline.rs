//! From a study to its result files: which stages a command needs, in which
//! order, and what each leaves in the output folder.
//!
//! Every stage writes its files as soon as it has ended, each complete or not
//! at all, so that a later failure takes nothing away. What a stage reads, it
//! takes only if it was made from the same inputs as it would be now.

mod stored;

use std::collections::BTreeMap;
use std::path::Path;

use railspring_calibrate::error::{Error, InputError, Result, StopReason};
use railspring_calibrate::field::InputField;
use railspring_calibrate::history::History;
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::units::{KILONEWTON_PER_METRE, MILLIMETRE};

use crate::estimate::{self, Budget, Work};
use crate::measure::{Stopwatch, begin};
use crate::output::{OutputFolder, to_json};
use crate::records::crosscheck::{CrosscheckRecord, Differences, SectionDifference};
use crate::records::{
    Measured, RunRecord, ScenarioVerdict, SpringsRecord, StiffnessRecord, VerificationRecord, history_csv,
    to_csv,
};
use crate::report::crosscheck::{Crosscheck, PageData, page};
use crate::report::{self, ReportData, ScenarioRun};
use crate::results::{NewFile, Results, hash};
use crate::springs;
use crate::stages::{self, Calibration, Fields, Geometry, Meshes};
use crate::study::{Study, StudyScenario};
use crate::verify::{self, Line};

use stored::Stored;

/// The laws and the horizontal stiffness.
pub const STIFFNESS: &str = "stiffness.json";
/// The calibrated load curve with the reference in use.
pub const LOAD_CURVE: &str = "load_curve.csv";
/// The verdict.
pub const VERIFICATION: &str = "verification.json";
/// Time, memory and host of the stages.
pub const MEASURED: &str = "measured.json";
/// The report.
pub const REPORT: &str = "report.html";
/// The figures of the report.
const FIGURES: &str = "figures/";
/// What independent programs say.
pub const CROSSCHECK: &str = "crosscheck.json";
/// The page about it.
pub const CROSSCHECK_PAGE: &str = "crosscheck.html";
/// Where on the bodies tool and reference differ.
pub const DIFFERENCES: &str = "crosscheck/differences.json";

/// What is made from springs and histories, and goes when one of them changes.
const OF_THE_RUNS: [&str; 3] = [VERIFICATION, REPORT, FIGURES];
/// What is made from the verdict.
const OF_THE_VERDICT: [&str; 2] = [REPORT, FIGURES];

/// A study on its way through the stages.
pub struct Pipeline<'a> {
    study: &'a Study,
    folder: &'a OutputFolder,
    results: Results<'a>,
    interpreter: Option<&'a Path>,
    monitor: &'a dyn Monitor,
    measured: Measured,
    budget: Budget,
}

/// A history and what belongs to it.
struct Run {
    history: History,
    record: RunRecord,
}

/// Both runs of a scenario.
struct Runs {
    simple: Run,
    solid: Option<Run>,
}

impl<'a> Pipeline<'a> {
    /// Begins with the measures that earlier commands have left in the folder; `interpreter` is the Python that reads
    /// mesh files, `None` that of the cache folder.
    pub fn new(
        study: &'a Study,
        folder: &'a OutputFolder,
        interpreter: Option<&'a Path>,
        monitor: &'a dyn Monitor,
    ) -> Self {
        let earlier = folder.read_json::<Measured>(MEASURED, "run").map(|m| m.stages).unwrap_or_default();
        let measured = Measured { stages: earlier, ..begin() };
        let results = Results::new(folder);
        Self { study, folder, results, interpreter, monitor, measured, budget: Budget::default() }
    }

    /// Keeps to `budget`.
    #[must_use]
    pub fn within(self, budget: Budget) -> Self {
        Self { budget, ..self }
    }

    /// All stages, each anew; the verdict.
    ///
    /// # Errors
    /// Those of the stages.
    pub fn run(mut self) -> Result<VerificationRecord> {
        springs::check_reference(self.study)?;
        self.measured.stages.clear();
        let geometry = self.geometry()?;
        stages::check_loads(self.study, &geometry, self.monitor)?;
        let mut meshes = self.mesh_stage(&geometry, &Work::of(self.study, true, true))?;
        let calibration = self.calibrate_stage(&geometry, &mut meshes)?;
        let springs = springs::own(self.study, &calibration.stiffness)?;
        let mut runs = Vec::new();
        for (name, scenario) in &self.study.scenarios {
            let simple = self.simulate_stage(&geometry, &springs, name, scenario)?;
            let solid = scenario
                .solid
                .then(|| self.solid_stage(&geometry, &mut meshes, name, scenario))
                .transpose()?;
            runs.push((name.clone(), Runs { simple, solid }));
        }
        let verdict = self.verify_stage(Some(&calibration.stiffness), &runs)?;
        self.report_stage(&geometry, &calibration, &runs, &verdict)?;
        Ok(verdict)
    }

    /// Sections and first touch; what was done to measured profiles is said.
    fn geometry(&self) -> Result<Geometry> {
        let geometry = stages::geometry(self.study)?;
        stages::repairs(&geometry.profiles).iter().for_each(|line| self.monitor.notice(line));
        Ok(geometry)
    }

    /// Calibration alone: `stiffness.json`, `load_curve.csv` and the VTU files.
    ///
    /// # Errors
    /// Those of the stage.
    pub fn calibrate(mut self) -> Result<()> {
        let geometry = self.geometry()?;
        stages::check_loads(self.study, &geometry, self.monitor)?;
        let mut meshes = self.mesh_stage(&geometry, &Work::of(self.study, true, false))?;
        self.calibrate_stage(&geometry, &mut meshes)?;
        Ok(())
    }

    /// The meshes alone: `rail.vtu` and `wheel.vtu`.
    ///
    /// # Errors
    /// Those of the stage.
    pub fn mesh(self) -> Result<()> {
        let geometry = self.geometry()?;
        self.budget.check_sizes(self.study, &geometry, &Work::default())?;
        let meshes = stages::meshes(self.study, &geometry, self.interpreter, self.monitor)?;
        let key = hash(format!("mesh {}", self.study.keys.calibration).as_bytes());
        let files = [(&meshes.rail, "rail.vtu"), (&meshes.wheel, "wheel.vtu")]
            .into_iter()
            .map(|(mesh, name)| Ok(NewFile::new(name, stages::mesh_vtu(mesh)?.into_bytes(), &key)))
            .collect::<Result<_>>()?;
        self.results.write(files, &[])
    }

    /// The simple model alone, with the springs of `law` or of the folder; the records of its runs by scenario.
    ///
    /// # Errors
    /// Those of the stage, and springs that are not there or do not suit the study.
    pub fn simulate(mut self, law: Option<&Path>) -> Result<Vec<(String, RunRecord)>> {
        let geometry = stages::geometry(self.study)?;
        let springs = match law {
            Some(path) => springs::from_file(self.study, &geometry, path)?,
            None => springs::own(self.study, &self.stored_stiffness()?)?,
        };
        let mut records = Vec::new();
        for (name, scenario) in &self.study.scenarios {
            let run = self.simulate_stage(&geometry, &springs, name, scenario)?;
            records.push((name.clone(), run.record));
        }
        Ok(records)
    }

    /// The solid model on the load cases of the folder, and the verdict.
    ///
    /// Solid histories that the folder has for these very load cases are taken from there, others are made again.
    ///
    /// # Errors
    /// Those of the stages, and histories of the simple model that are missing or were made from other inputs.
    pub fn verify(mut self) -> Result<VerificationRecord> {
        let (stiffness, simple) = self.stored_simple_runs()?;
        let mut solid_model = None;
        let mut runs = Vec::new();
        for ((name, scenario), simple) in self.study.scenarios.iter().zip(simple) {
            let solid = match scenario.solid {
                false => None,
                true => Some(match self.stored_solid_run(name, scenario) {
                    Ok(run) => run,
                    Err(_) => {
                        if solid_model.is_none() {
                            let geometry = stages::geometry(self.study)?;
                            let meshes = self.mesh_stage(&geometry, &Work::of(self.study, false, true))?;
                            solid_model = Some((geometry, meshes));
                        }
                        let (geometry, meshes) = solid_model.as_mut().expect("made above");
                        self.solid_stage(geometry, meshes, name, scenario)?
                    }
                }),
            };
            runs.push((name.clone(), Runs { simple, solid }));
        }
        self.verify_stage(stiffness.as_ref(), &runs)
    }

    /// The report from the files of the folder.
    ///
    /// # Errors
    /// Files that are missing or were made from other inputs: all of them in one message.
    pub fn report(mut self) -> Result<()> {
        let geometry = stages::geometry(self.study)?;
        let Stored { calibration, runs, verdict } = self.stored_results()?;
        self.report_stage(&geometry, &calibration, &runs, &verdict)
    }

    /// The pages after a cross-check: the report too, if the folder has the study's other results;
    /// whether it has.
    ///
    /// # Errors
    /// As [`Pipeline::report`], and a cross-check that is not there.
    pub fn crosscheck_pages(self) -> Result<bool> {
        if self.stored_results().is_ok() {
            self.report().map(|()| true)
        } else {
            let record = self.folder.read_json(CROSSCHECK, "crosscheck")?;
            self.crosscheck_page(&record, &self.differences(&record), false).map(|()| false)
        }
    }

    /// The cross-check of the folder if it is one of this study: `None` if it is of another study
    /// or has another layout.
    fn own_crosscheck(&self) -> Option<CrosscheckRecord> {
        let record: CrosscheckRecord = self.folder.read_json(CROSSCHECK, "crosscheck").ok()?;
        (record.input_hash == self.study.keys.study).then_some(record)
    }

    /// The sections of that very cross-check; none if they are not there.
    fn differences(&self, record: &CrosscheckRecord) -> Vec<SectionDifference> {
        self.folder
            .read_json::<Differences>(DIFFERENCES, "crosscheck")
            .ok()
            .filter(|d| d.input_hash == record.input_hash && d.begun_utc == record.begun_utc)
            .map_or_else(Vec::new, |d| d.sections)
    }

    fn crosscheck_page(
        &self,
        record: &CrosscheckRecord,
        sections: &[SectionDifference],
        report: bool,
    ) -> Result<()> {
        let data = PageData {
            description: &self.study.description,
            inputs: &self.study.resolved,
            record,
            sections,
            report,
        };
        self.folder.write(CROSSCHECK_PAGE, page(&data).as_bytes())
    }

    /// Meshes for `work`, which must be within the budget.
    fn mesh_stage(&mut self, geometry: &Geometry, work: &Work) -> Result<Meshes> {
        let watch = Stopwatch::start();
        let meshes =
            estimate::meshes(self.study, geometry, work, self.budget, self.interpreter, self.monitor)?;
        // Kept until there is a result: a study that is refused later leaves no file behind.
        self.measured.note(watch.stop("meshes", &self.study.keys.calibration));
        Ok(meshes)
    }

    fn calibrate_stage(&mut self, geometry: &Geometry, meshes: &mut Meshes) -> Result<Calibration> {
        let watch = Stopwatch::start();
        let (study, monitor, budget) = (self.study, self.monitor, self.budget);
        let accept = |larger: &Meshes| {
            budget.check(study, geometry, larger, &Work::of(study, true, false)).map(|_| ())
        };
        let (calibration, pressed) = stages::within_zones(
            study,
            geometry,
            meshes,
            monitor,
            accept,
            |meshes| stages::calibrate(study, geometry, meshes, monitor),
            |(calibration, _)| calibration.horizontal_failure.as_ref(),
        )
        .map_err(|error| uncarried(study, error))?;
        let mut contents =
            vec![(STIFFNESS, to_json(&calibration.stiffness)), (LOAD_CURVE, to_csv(&calibration.load_curve))];
        for (fields, name) in
            [(Fields::Rail, "rail.vtu"), (Fields::Wheel, "wheel.vtu"), (Fields::Contact, "contact.vtu")]
        {
            contents.push((name, stages::fields_vtu(&pressed, fields)?.into_bytes()));
        }
        let key = &self.study.keys.calibration;
        let files = contents.into_iter().map(|(name, content)| NewFile::new(name, content, key)).collect();
        self.results.write(files, &OF_THE_RUNS)?;
        self.note(watch, "calibration", &self.study.keys.calibration)?;
        match calibration.horizontal_failure {
            // what the calibration has finished is written; a study with a stiffness goes on with it
            Some(failure) if self.study.simulation.horizontal.is_none() => Err(failure),
            _ => Ok(calibration),
        }
    }

    fn simulate_stage(
        &mut self,
        geometry: &Geometry,
        springs: &SpringsRecord,
        name: &str,
        scenario: &StudyScenario,
    ) -> Result<Run> {
        let watch = Stopwatch::start();
        let used = springs::springs(springs)?;
        let history = stages::simulate(self.study, geometry, &used, scenario, self.monitor)
            .map_err(|error| self.study.in_scenario(name, error))?;
        let notes = springs::range_note(springs, &history).into_iter().collect();
        let record = RunRecord::new(&history, Some(springs), notes);
        let key = self.study.keys.simple(name, springs);
        self.write_history(&self.file(name, "history"), &history, &record, &key)?;
        self.note(watch, &model("simple", name), &key)?;
        Ok(Run { history, record })
    }

    fn solid_stage(
        &mut self,
        geometry: &Geometry,
        meshes: &mut Meshes,
        name: &str,
        scenario: &StudyScenario,
    ) -> Result<Run> {
        let watch = Stopwatch::start();
        let (study, monitor, budget) = (self.study, self.monitor, self.budget);
        let accept = |larger: &Meshes| {
            budget.check(study, geometry, larger, &Work::of(study, false, true)).map(|_| ())
        };
        let run = |meshes: &Meshes| stages::simulate_solid(study, geometry, meshes, scenario, monitor);
        let history = stages::within_zones(study, geometry, meshes, monitor, accept, run, |_| None)
            .map_err(|error| self.study.in_scenario(name, error))?;
        let record = RunRecord::new(&history, None, Vec::new());
        let key = self.study.keys.solid(name);
        self.write_history(&self.file(name, "solid_history"), &history, &record, &key)?;
        self.note(watch, &model("solid", name), &key)?;
        Ok(Run { history, record })
    }

    fn write_history(&self, file: &str, history: &History, record: &RunRecord, key: &str) -> Result<()> {
        let new =
            NewFile { run: Some(record.clone()), ..NewFile::new(file, history_csv::write(history), key) };
        self.results.write(vec![new], &OF_THE_RUNS)
    }

    /// The verdict. `stiffness` is that of the study, if one of the simple models ran with it.
    fn verify_stage(
        &mut self,
        stiffness: Option<&StiffnessRecord>,
        runs: &[(String, Runs)],
    ) -> Result<VerificationRecord> {
        let calibration = stiffness.map_or_else(Vec::new, |record| calibration_lines(self.study, record));
        let mut scenarios = Vec::new();
        for (name, Runs { simple, solid }) in runs {
            let comparison = solid
                .as_ref()
                .map(|solid| verify::compare(&simple.history, &solid.history, &self.study.limits))
                .transpose()?;
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
            });
        }
        let inputs = self.verdict_inputs(stiffness.is_some());
        let mut verdict = VerificationRecord {
            study: self.study.name.clone(),
            holds: false,
            calibration,
            scenarios,
            input_hash: self.study.keys.verdict(&inputs),
            inputs,
            version: env!("CARGO_PKG_VERSION").into(),
        };
        let holds = verdict.lines().all(|(_, line)| line.holds);
        verdict.holds = holds;
        let file = NewFile::new(VERIFICATION, to_json(&verdict), &verdict.input_hash);
        self.results.write(vec![file], &OF_THE_VERDICT)?;
        Ok(verdict)
    }

    /// The files that a verdict is made from, with the hashes of their contents.
    fn verdict_inputs(&self, with_stiffness: bool) -> BTreeMap<String, String> {
        let histories = self.study.scenarios.iter().flat_map(|(name, scenario)| {
            let solid = scenario.solid.then(|| self.file(name, "solid_history"));
            [Some(self.file(name, "history")), solid].into_iter().flatten()
        });
        let stiffness = with_stiffness.then(|| STIFFNESS.to_owned());
        stiffness
            .into_iter()
            .chain(histories)
            .filter_map(|name| self.results.entry(&name)?.blake3.map(|hash| (name, hash)))
            .collect()
    }

    fn report_stage(
        &mut self,
        geometry: &Geometry,
        calibration: &Calibration,
        runs: &[(String, Runs)],
        verdict: &VerificationRecord,
    ) -> Result<()> {
        let profiles = stages::profiles(geometry);
        let scenarios = runs
            .iter()
            .map(|(name, runs)| {
                let scenario = &self.study.scenarios[name];
                ScenarioRun {
                    name,
                    description: &scenario.description,
                    snapshots: &scenario.snapshots,
                    simple: &runs.simple.history,
                    solid: runs.solid.as_ref().map(|run| &run.history),
                }
            })
            .collect();
        let crosscheck = self.own_crosscheck();
        let sections = crosscheck.as_ref().map_or_else(Vec::new, |record| self.differences(record));
        // The folder may have runs of other load cases.
        let inputs = std::iter::once(STIFFNESS).chain(verdict.inputs.keys().map(String::as_str));
        let keys: Vec<String> = inputs.filter_map(|name| Some(self.results.entry(name)?.key)).collect();
        let mut measured = self.measured.clone();
        measured.stages.retain(|stage| keys.contains(&stage.key));
        let data = ReportData {
            name: &self.study.name,
            description: &self.study.description,
            inputs: &self.study.resolved,
            stiffness: &calibration.stiffness,
            load_curve: &calibration.load_curve,
            profiles: &profiles,
            scenarios,
            ratio_window: self.study.limits.ratio_window_s,
            ratio_floor: self.study.limits.ratio_floor,
            verdict,
            measured: &measured,
            crosscheck: match &crosscheck {
                Some(record) => Crosscheck::Fresh(record, &sections),
                None if self.folder.file(CROSSCHECK).exists() => Crosscheck::Stale,
                None => Crosscheck::Absent,
            },
        };
        let built = report::build(&data);
        let key = &verdict.input_hash;
        let mut files: Vec<NewFile> = built
            .figures
            .into_iter()
            .map(|(name, svg)| NewFile::new(format!("{FIGURES}{name}.svg"), svg.into_bytes(), key))
            .collect();
        // The page shows seconds and the host.
        let page = NewFile { reproducible: false, ..NewFile::new(REPORT, built.html.into_bytes(), key) };
        files.push(page);
        self.results.write(files, &[])?;
        // again, because it now has a report to point to
        crosscheck.map_or(Ok(()), |record| self.crosscheck_page(&record, &sections, true))
    }

    /// Adds a measure, and drops those of results that the folder has no longer.
    fn note(&mut self, watch: Stopwatch, stage: &str, key: &str) -> Result<()> {
        self.measured.note(watch.stop(stage, key));
        let results = &self.results;
        self.measured.stages.retain(|stage| results.has(&stage.key));
        self.folder.write_json(MEASURED, &self.measured)
    }

    /// Name of a history file: plain for the main scenario, else with the scenario's name.
    fn file(&self, scenario: &str, stem: &str) -> String {
        if self.study.main_scenario.as_deref() == Some(scenario) {
            format!("{stem}.csv")
        } else {
            format!("{stem}-{scenario}.csv")
        }
    }
}

/// Name of a model's run in the measures.
fn model(model: &str, scenario: &str) -> String {
    format!("{model} model, {scenario}")
}

/// A contact at the end of a fine zone that cannot be made larger means a load too large for the study; on a
/// profile under the smallest load, a place at which the two profiles have no room for a contact.
fn uncarried(study: &Study, error: Error) -> Error {
    let Error::Numerics(cause) = &error else { return error };
    let given = study.rail.mesh.is_some() || study.wheel.mesh.is_some();
    let load = cause.step.map_or_else(|| "the loads".into(), |step| format!("load number {step}"));
    match cause.reason {
        StopReason::EdgeOfCandidates if cause.step.is_none_or(|step| step == 1) => InputError::new(
            InputField::LateralShift,
            format!("{} mm", study.track.lateral_shift / MILLIMETRE),
            "a place at which the contact of the smallest load lies inside both running surfaces",
            if given {
                "move the wheel, or enlarge the contact surfaces of the mesh files"
            } else {
                "move the wheel, or check gauge and flange back distance"
            },
        )
        .into(),
        StopReason::EdgeOfCandidates | StopReason::EndOfWindow => InputError::new(
            InputField::Loads,
            load,
            "loads whose contact patch stays within the fine zone of the mesh",
            if given {
                "lower the load, or enlarge `window_half_length` and the contact surfaces of the mesh files"
            } else {
                "lower the load, or enlarge `window_half_length`"
            },
        )
        .into(),
        _ => error,
    }
}

/// Lines of the verdict on the springs themselves.
fn calibration_lines(study: &Study, stiffness: &StiffnessRecord) -> Vec<Line> {
    /// Load at which the published law is compared, kN.
    const COMPARED_AT_KN: f64 = 85.0;
    let limits = &study.limits;
    let published = StiffnessLaw::published().tangent(COMPARED_AT_KN * 1e3) / KILONEWTON_PER_METRE;
    let foot = stiffness.references.iter().find(|reference| reference.reference == "foot");
    let difference = foot.map(|foot| (foot.law.tangent(COMPARED_AT_KN) / published - 1.0).abs());
    let law_displacement =
        stiffness.references.iter().map(|r| r.displacement.max_rel_error).max_by(f64::total_cmp);
    let spread = stiffness.horizontal.as_ref().map(|h| h.relative_spread);
    vec![
        limits.law_max().line(Some(stiffness.law.max_rel_error)),
        limits.law_displacement().line(law_displacement),
        limits.beam_missing().line(Some(stiffness.beam.missing)),
        limits.horizontal_spread().line(spread),
        limits.published_stiffness().line(difference),
    ]
}
