//! From a study to its result files: which stages a command needs, in which
//! order, and what each leaves in the output folder.
//!
//! Every stage writes its files as soon as it has ended, each complete or not
//! at all, so that a later failure takes nothing away.

use std::path::Path;

use railspring_calibrate::error::{Error, InputError, Result, StopReason};
use railspring_calibrate::field::InputField;
use railspring_calibrate::history::History;
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::units::KILONEWTON_PER_METRE;

use crate::measure::{Stopwatch, begin};
use crate::output::{OutputFolder, read_json, read_text};
use crate::records::crosscheck::{CrosscheckRecord, Differences, SectionDifference};
use crate::records::{
    LawRecord, LoadCurveRow, Measured, ScenarioVerdict, StiffnessRecord, VerificationRecord, history_csv,
    to_csv,
};
use crate::report::crosscheck::{Crosscheck, PageData, page};
use crate::report::{self, ReportData, ScenarioRun};
use crate::stages::{self, Calibration, Fields, Geometry, Meshes, Springs};
use crate::study::{LawKey, Study, StudyScenario};
use crate::verify::{self, Kind, Line};

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
/// What independent judges say.
pub const CROSSCHECK: &str = "crosscheck.json";
/// The page about it.
pub const CROSSCHECK_PAGE: &str = "crosscheck.html";
/// Where on the bodies tool and reference differ.
pub const DIFFERENCES: &str = "crosscheck/differences.json";

/// A study on its way through the stages.
pub struct Pipeline<'a> {
    study: &'a Study,
    folder: &'a OutputFolder,
    interpreter: Option<&'a Path>,
    monitor: &'a dyn Monitor,
    measured: Measured,
}

/// Both runs of a scenario.
struct Runs {
    simple: History,
    solid: Option<History>,
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
        Self { study, folder, interpreter, monitor, measured: Measured { stages: earlier, ..begin() } }
    }

    /// All stages; whether all limits hold.
    ///
    /// # Errors
    /// Those of the stages.
    pub fn run(mut self) -> Result<bool> {
        self.measured.stages.clear();
        let geometry = stages::geometry(self.study)?;
        stages::check_loads(self.study, &geometry)?;
        let meshes = self.mesh_stage(&geometry)?;
        let calibration = self.calibrate_stage(&geometry, &meshes)?;
        let mut runs = Vec::new();
        for (name, scenario) in &self.study.scenarios {
            let simple = self.simulate_stage(&geometry, &calibration.stiffness, name, scenario)?;
            let solid =
                scenario.solid.then(|| self.solid_stage(&geometry, &meshes, name, scenario)).transpose()?;
            runs.push((name.clone(), Runs { simple, solid }));
        }
        let verdict = self.verify_stage(&calibration.stiffness, &runs)?;
        self.report_stage(&geometry, &calibration, &runs, Some(&verdict))?;
        Ok(verdict.holds)
    }

    /// Calibration alone: `stiffness.json`, `load_curve.csv` and the VTU files.
    ///
    /// # Errors
    /// Those of the stage.
    pub fn calibrate(mut self) -> Result<()> {
        let geometry = stages::geometry(self.study)?;
        stages::check_loads(self.study, &geometry)?;
        let meshes = self.mesh_stage(&geometry)?;
        self.calibrate_stage(&geometry, &meshes)?;
        Ok(())
    }

    /// The meshes alone: `rail.vtu` and `wheel.vtu`.
    ///
    /// # Errors
    /// Those of the stage.
    pub fn mesh(self) -> Result<()> {
        let geometry = stages::geometry(self.study)?;
        let meshes = stages::meshes(self.study, &geometry, self.interpreter, self.monitor)?;
        for (mesh, name) in [(&meshes.rail, "rail.vtu"), (&meshes.wheel, "wheel.vtu")] {
            self.folder.write(name, stages::mesh_vtu(mesh)?.as_bytes())?;
        }
        Ok(())
    }

    /// The simple model alone, with the springs of `law` or of the folder.
    ///
    /// # Errors
    /// Those of the stage, and springs that are not there.
    pub fn simulate(mut self, law: Option<&Path>) -> Result<()> {
        let geometry = stages::geometry(self.study)?;
        let stiffness = match law {
            Some(path) => read_json(path, "calibrate")?,
            None => self.folder.read_json(STIFFNESS, "calibrate")?,
        };
        for (name, scenario) in &self.study.scenarios {
            self.simulate_stage(&geometry, &stiffness, name, scenario)?;
        }
        Ok(())
    }

    /// The solid model on the load cases of the folder, and the verdict; whether all limits hold.
    ///
    /// Solid histories that the folder has for this very study are taken from there.
    ///
    /// # Errors
    /// Those of the stages, and results of another study in the folder.
    pub fn verify(mut self) -> Result<bool> {
        let stiffness = self.own_stiffness()?;
        let mut solid_model = None;
        let mut runs = Vec::new();
        for (name, scenario) in &self.study.scenarios {
            let simple = self.read_history(&self.file(name, "history"), &model("simple", name))?;
            let file = self.file(name, "solid_history");
            let solid = match scenario.solid {
                false => None,
                true if self.folder.file(&file).exists() => {
                    Some(self.read_history(&file, &model("solid", name))?)
                }
                true => {
                    if solid_model.is_none() {
                        let geometry = stages::geometry(self.study)?;
                        let meshes = self.mesh_stage(&geometry)?;
                        solid_model = Some((geometry, meshes));
                    }
                    solid_model
                        .as_ref()
                        .map(|(geometry, meshes)| self.solid_stage(geometry, meshes, name, scenario))
                        .transpose()?
                }
            };
            runs.push((name.clone(), Runs { simple, solid }));
        }
        Ok(self.verify_stage(&stiffness, &runs)?.holds)
    }

    /// The report from the files of the folder.
    ///
    /// # Errors
    /// Files that are not there, or of another study.
    pub fn report(mut self) -> Result<()> {
        let geometry = stages::geometry(self.study)?;
        let stiffness = self.own_stiffness()?;
        let load_curve = self.read_load_curve()?;
        let mut runs = Vec::new();
        for (name, scenario) in &self.study.scenarios {
            let simple = self.read_history(&self.file(name, "history"), &model("simple", name))?;
            let file = self.file(name, "solid_history");
            let solid =
                scenario.solid.then(|| self.read_history(&file, &model("solid", name))).transpose()?;
            runs.push((name.clone(), Runs { simple, solid }));
        }
        let verdict: VerificationRecord = self.folder.read_json(VERIFICATION, "verify")?;
        self.report_stage(&geometry, &Calibration { stiffness, load_curve }, &runs, Some(&verdict))
    }

    /// The pages after a cross-check: the report too, if the folder has the study's other results;
    /// whether it has.
    ///
    /// # Errors
    /// As [`Pipeline::report`], and a cross-check that is not there.
    pub fn crosscheck_pages(self) -> Result<bool> {
        if self.has_results() {
            self.report().map(|()| true)
        } else {
            let record = self.folder.read_json(CROSSCHECK, "crosscheck")?;
            self.crosscheck_page(&record, &self.differences(&record), false).map(|()| false)
        }
    }

    /// Whether the folder has springs and a verdict of this very study.
    fn has_results(&self) -> bool {
        let verdict = self.folder.read_json::<VerificationRecord>(VERIFICATION, "verify");
        self.own_stiffness().is_ok() && verdict.is_ok_and(|v| v.input_hash == self.study.input_hash)
    }

    /// The cross-check of the folder if it is one of this study: `None` if it is of another study
    /// or has another layout.
    fn own_crosscheck(&self) -> Option<CrosscheckRecord> {
        let record: CrosscheckRecord = self.folder.read_json(CROSSCHECK, "crosscheck").ok()?;
        (record.input_hash == self.study.input_hash).then_some(record)
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

    fn mesh_stage(&mut self, geometry: &Geometry) -> Result<Meshes> {
        let watch = Stopwatch::start();
        let meshes = stages::meshes(self.study, geometry, self.interpreter, self.monitor)?;
        // Kept until there is a result: a study that is refused later leaves no file behind.
        self.measured.note(watch.stop("meshes", None));
        Ok(meshes)
    }

    fn calibrate_stage(&mut self, geometry: &Geometry, meshes: &Meshes) -> Result<Calibration> {
        let watch = Stopwatch::start();
        let (calibration, pressed) = stages::calibrate(self.study, geometry, meshes, self.monitor)
            .map_err(|error| uncarried(self.study, error))?;
        self.folder.write_json(STIFFNESS, &calibration.stiffness)?;
        self.folder.write(LOAD_CURVE, &to_csv(&calibration.load_curve))?;
        for (fields, name) in
            [(Fields::Rail, "rail.vtu"), (Fields::Wheel, "wheel.vtu"), (Fields::Contact, "contact.vtu")]
        {
            self.folder.write(name, stages::fields_vtu(&pressed, fields)?.as_bytes())?;
        }
        self.note(watch, "calibration", None)?;
        Ok(calibration)
    }

    fn simulate_stage(
        &mut self,
        geometry: &Geometry,
        stiffness: &StiffnessRecord,
        name: &str,
        scenario: &StudyScenario,
    ) -> Result<History> {
        let watch = Stopwatch::start();
        let normal = match self.study.simulation.law {
            LawKey::Calibrated => law(&stiffness.law),
            LawKey::Published => StiffnessLaw::published(),
        };
        let horizontal =
            self.study.simulation.horizontal.unwrap_or(stiffness.horizontal_kn_per_m * KILONEWTON_PER_METRE);
        let springs = Springs { normal, horizontal, wheel_mass: stiffness.wheel_mass() };
        let history = stages::simulate(self.study, geometry, &springs, scenario, self.monitor)
            .map_err(|error| self.study.in_scenario(name, error))?;
        self.folder.write(&self.file(name, "history"), &history_csv::write(&history))?;
        self.note(watch, &model("simple", name), Some(history.degrees_of_freedom))?;
        Ok(history)
    }

    fn solid_stage(
        &mut self,
        geometry: &Geometry,
        meshes: &Meshes,
        name: &str,
        scenario: &StudyScenario,
    ) -> Result<History> {
        let watch = Stopwatch::start();
        let history = stages::simulate_solid(self.study, geometry, meshes, scenario, self.monitor)
            .map_err(|error| self.study.in_scenario(name, error))?;
        self.folder.write(&self.file(name, "solid_history"), &history_csv::write(&history))?;
        self.note(watch, &model("solid", name), Some(history.degrees_of_freedom))?;
        Ok(history)
    }

    fn verify_stage(
        &mut self,
        stiffness: &StiffnessRecord,
        runs: &[(String, Runs)],
    ) -> Result<VerificationRecord> {
        let calibration = calibration_lines(self.study, stiffness);
        let mut scenarios = Vec::new();
        for (name, runs) in runs {
            if let Some(solid) = &runs.solid {
                scenarios.push(ScenarioVerdict {
                    scenario: name.clone(),
                    simple_degrees_of_freedom: runs.simple.degrees_of_freedom,
                    solid_degrees_of_freedom: solid.degrees_of_freedom,
                    comparison: verify::compare(&runs.simple, solid, &self.study.limits)?,
                });
            }
        }
        let lines = calibration.iter().chain(scenarios.iter().flat_map(|s| &s.comparison.lines));
        let verdict = VerificationRecord {
            study: self.study.name.clone(),
            holds: lines.into_iter().all(|line| line.holds),
            calibration,
            scenarios,
            input_hash: self.study.input_hash.clone(),
            version: env!("CARGO_PKG_VERSION").into(),
            measured: self.measured.clone(),
        };
        self.folder.write_json(VERIFICATION, &verdict)?;
        Ok(verdict)
    }

    fn report_stage(
        &mut self,
        geometry: &Geometry,
        calibration: &Calibration,
        runs: &[(String, Runs)],
        verdict: Option<&VerificationRecord>,
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
                    simple: &runs.simple,
                    solid: runs.solid.as_ref(),
                    verdict: verdict.and_then(|v| v.scenarios.iter().find(|s| s.scenario == *name)),
                }
            })
            .collect();
        let judged = self.own_crosscheck();
        let sections = judged.as_ref().map_or_else(Vec::new, |record| self.differences(record));
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
            measured: &self.measured,
            crosscheck: match &judged {
                Some(record) => Crosscheck::Fresh(record, &sections),
                None if self.folder.file(CROSSCHECK).exists() => Crosscheck::Stale,
                None => Crosscheck::Absent,
            },
        };
        let built = report::build(&data);
        for (name, svg) in &built.figures {
            self.folder.write(&format!("figures/{name}.svg"), svg.as_bytes())?;
        }
        self.folder.write(REPORT, built.html.as_bytes())?;
        // again, because it now has a report to point to
        judged.map_or(Ok(()), |record| self.crosscheck_page(&record, &sections, true))
    }

    fn note(&mut self, watch: Stopwatch, stage: &str, degrees_of_freedom: Option<usize>) -> Result<()> {
        self.measured.note(watch.stop(stage, degrees_of_freedom));
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

    /// The folder's springs, if this very study has made them.
    fn own_stiffness(&self) -> Result<StiffnessRecord> {
        let stiffness: StiffnessRecord = self.folder.read_json(STIFFNESS, "calibrate")?;
        if stiffness.input_hash == self.study.input_hash {
            return Ok(stiffness);
        }
        Err(InputError::new(
            self.folder.file(STIFFNESS).display().to_string(),
            format!("made from input {}", &stiffness.input_hash.get(..12).unwrap_or_default()),
            format!("results of this study ({})", &self.study.input_hash[..12]),
            "the study or the program has changed since; run it again",
        )
        .into())
    }

    fn read_history(&self, file: &str, model: &str) -> Result<History> {
        let degrees_of_freedom = self.measured.stage(model).and_then(|stage| stage.degrees_of_freedom);
        let path = self.folder.file(file);
        history_csv::read(&path, &read_text(&path, "simulate")?, degrees_of_freedom.unwrap_or(0))
    }

    fn read_load_curve(&self) -> Result<Vec<LoadCurveRow>> {
        let path = self.folder.file(LOAD_CURVE);
        let text = read_text(&path, "calibrate")?;
        csv::Reader::from_reader(text.as_bytes())
            .deserialize()
            .collect::<std::result::Result<_, _>>()
            .map_err(|cause| {
                InputError::new(
                    path.display().to_string(),
                    cause,
                    "a load curve as `railspring calibrate` writes it",
                    "write it again with that command",
                )
                .into()
            })
    }
}

/// Name of a model's run in the measures.
fn model(model: &str, scenario: &str) -> String {
    format!("{model} model, {scenario}")
}

fn law(record: &LawRecord) -> StiffnessLaw {
    StiffnessLaw {
        a: record.a_kn_per_m * KILONEWTON_PER_METRE,
        b: record.b_kn_per_m * KILONEWTON_PER_METRE,
        c: record.c,
    }
}

/// A contact that grows over the edge of the fine zone means a load too large for the study.
fn uncarried(study: &Study, error: Error) -> Error {
    match error {
        Error::Numerics(cause) if cause.reason == StopReason::EdgeOfCandidates => InputError::new(
            InputField::Loads,
            cause.step.map_or_else(|| "the loads".into(), |step| format!("load number {step}")),
            "loads whose contact patch stays within the fine zone of the mesh",
            if study.rail.mesh.is_some() || study.wheel.mesh.is_some() {
                "lower the load, or enlarge `window_half_length` and the contact surfaces of the mesh files"
            } else {
                "lower the load, or enlarge `window_half_length`"
            },
        )
        .into(),
        other => other,
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
    vec![
        Line::judge(
            "law_max",
            "Law against the solid's tangent stiffness, largest relative difference",
            Kind::Consistency,
            "1",
            Some(stiffness.law.max_rel_error),
            limits.law_max,
        ),
        Line::judge(
            "horizontal_spread",
            "Horizontal stiffness, relative spread over the preloads",
            Kind::Consistency,
            "1",
            Some(stiffness.horizontal.relative_spread),
            limits.horizontal_spread,
        ),
        Line::judge(
            "published_stiffness",
            "Foot-referenced tangent stiffness against the published law at 85 kN, relative difference",
            Kind::CrossCode,
            "1",
            difference,
            limits.published_stiffness,
        ),
    ]
}
