//! From a study to its result files: which stages a command wants. A stage is
//! what it needs, its key, how it is made and which files it becomes
//! (`stage::Stage`); it is taken from the store or made.
//!
//! Every stage writes its files as soon as it has ended, each complete or not
//! at all, so that a later failure takes nothing away. What a stage reads, it
//! takes only if it was made from the same inputs as it would be now.

use std::path::Path;

use railspring_calibrate::mesh::MeshSize;
use railspring_profiles::error::{InputError, Result};
use railspring_simulate::time::history::Ending;

use crate::engine::list::NewFile;
use crate::engine::output::{OutputFolder, to_json};
use crate::engine::store::{Address, Kind};
use crate::hash::hash;
use crate::results::bodies::estimate::{Resources, Work};
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::{meshes, sections, zones};
use crate::results::by_angle::input::ByAngleInput;
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::by_angle::stage::ByAngle;
use crate::results::crosscheck::Solvers;
use crate::results::crosscheck::exchange::Case;
use crate::results::crosscheck::in_time::input::InTimeInput;
use crate::results::crosscheck::in_time::stage::CrosscheckInTime;
use crate::results::crosscheck::input::CrosscheckInput;
use crate::results::crosscheck::record::CrosscheckRecord;
use crate::results::crosscheck::stage::Crosscheck;
use crate::results::inputs::{INPUTS, InputsRecord};
use crate::results::names::STIFFNESS;
use crate::results::page::input::PageInput;
use crate::results::page::stage::{Report, crosscheck_alone, write_report};
use crate::results::run::input::{SimpleRunInput, SpringsInput, UncertainInput};
use crate::results::run::record::{RunRecord, SpringsRecord, SpringsSource};
use crate::results::run::solid_stage::{BackgroundRuns, SimulateSolid, SolidRuns};
use crate::results::run::springs;
use crate::results::run::stage::{Other, Run, Runs, Simulate, other_elements};
use crate::results::run::uncertain_stage::{Uncertain, uncertain_run};
use crate::results::springs::make::{self, Calibration};
use crate::results::springs::record::StiffnessRecord;
use crate::results::springs::stage::{Calibrate, CalibratedPair, calibrates, found_springs};
use crate::results::springs::{error_band, fields};
use crate::results::stored::Stored;
use crate::results::study_run::StudyRun;
use crate::results::verdict::input::VerdictInput;
use crate::results::verdict::record::VerificationRecord;
use crate::results::verdict::stage::Verify;
use crate::study::{LawKey, StudyScenario};
use crate::version;

/// The calibration, the laws by contact angle if the study wants them, and each load case on the simple model.
type WithoutSolids = (Calibration, Option<StiffnessByAngleRecord>, Vec<(Run, Vec<Other>, Uncertain)>);

/// What a command has found of a study: as much as it had to look at.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// The springs of the study; none where all load cases ran with those of a file.
    pub stiffness: Option<StiffnessRecord>,
    /// Load cases that were run on the simple model alone.
    pub runs: Vec<(String, RunRecord)>,
    /// The verdict.
    pub verdict: Option<VerificationRecord>,
}

impl Found {
    /// Whether all is as it should be: every limit of the verdict, every run to its last step, every load of the springs, nothing left to
    /// look at in a measured profile.
    pub fn holds(&self) -> bool {
        let is_whole = |of: &StiffnessRecord| of.loads_left_out() == 0 && of.findings_left().is_empty();
        let whole = || self.stiffness.as_ref().is_none_or(is_whole);
        let completed = self.runs.iter().all(|(_, run)| run.ending() == Some(Ending::Completed));
        completed && self.verdict.as_ref().map_or_else(whole, |verdict| verdict.holds)
    }
}

impl<'a> StudyRun<'a> {
    /// All stages; springs and verdict.
    ///
    /// # Errors
    /// Those of the stages.
    pub fn run(mut self) -> Result<Found> {
        springs::check_reference(&SpringsInput::of(self.study))?;
        self.engine.measured.stages.clear();
        self.check_calibration()?;
        let background = BackgroundRuns::new(!self.engine.fresh, self.engine.monitor);
        // all that is done is done by the threads of the pool
        let done = rayon::scope(|scope| {
            let begin = |runs: SolidRuns<'a>| {
                let (store, background) = (runs.store(), &background);
                scope.spawn(move |_| runs.all(store, background));
            };
            let done = self.without_solids(&begin);
            if done.is_err() {
                background.stop();
            }
            done
        });
        let (calibration, by_angle, simple) = done?;
        let mut runs = Vec::new();
        for ((name, scenario), (simple, others, uncertain)) in self.study.scenarios.iter().zip(simple) {
            let solid =
                scenario.solid.then(|| self.solid_run(name, scenario, Some(&background))).transpose()?;
            runs.push((name.clone(), Runs { simple, others, uncertain, solid }));
        }
        let verdict = self.engine.get(&mut Verify {
            input: VerdictInput::of(self.study),
            stiffness: Some(&calibration.stiffness),
            by_angle: by_angle.as_ref(),
            runs: &runs,
        })?;
        self.write_report(&calibration, by_angle.as_ref(), &runs, &verdict)?;
        self.note_inputs()?;
        Ok(Found { stiffness: Some(calibration.stiffness), runs: Vec::new(), verdict: Some(verdict) })
    }

    /// Writes what the results were made from. The hash of the calibration's inputs in it says whether it is of the springs beside it.
    fn note_inputs(&self) -> Result<()> {
        let record = InputsRecord {
            study: self.study.name.clone(),
            description: self.study.description.clone(),
            keys: self.study.resolved.to_vec(),
            calibration: self.solids.input.calibration().key().into(),
            version: env!("CARGO_PKG_VERSION").into(),
            commit: version::COMMIT.into(),
        };
        let content = to_json(&record);
        let key = hash(&content);
        self.engine.results.write(vec![NewFile::new(INPUTS, content, &key)], &[])
    }

    /// The stages but those on the solids in time. As soon as a calibration that is made has the springs, `begin` gets these runs: they need
    /// its bodies, but neither its error bands and fields nor the laws by contact angle.
    fn without_solids(&mut self, begin: &dyn Fn(SolidRuns<'a>)) -> Result<WithoutSolids> {
        let mut found = None;
        if calibrates(&self.solids.input, &self.engine) {
            let springs = found.insert(found_springs(&mut self.solids, &mut self.engine)?);
            if self.solids.room.stages && springs.is_whole() && self.study.modes() > 0 {
                begin(SolidRuns::beside(&mut self.solids, springs)?);
            }
        }
        let calibration = self.calibration(found)?;
        let by_angle = self.by_angle(&calibration.stiffness)?;
        let mut simple = Vec::new();
        // without load cases the law need not suit the simple model
        if !self.study.scenarios.is_empty() {
            let springs = springs::springs_of_study(
                &SpringsInput::of(self.study),
                &calibration.stiffness,
                by_angle.as_ref(),
            )?;
            for (name, scenario) in &self.study.scenarios {
                let run = self.simple_run(name, scenario, &springs)?;
                let others = self.other_elements(name, scenario, &springs, by_angle.as_ref())?;
                let own = Some(&calibration.stiffness);
                let uncertain = self.uncertain_run(name, scenario, (&springs, own), &run)?;
                simple.push((run, others, uncertain));
            }
        }
        Ok((calibration, by_angle, simple))
    }

    /// Calibration alone: `stiffness.json`, `load_curve.csv`, the laws by contact angle and the VTU files; the springs.
    ///
    /// # Errors
    /// Those of the stages.
    pub fn calibrate(mut self) -> Result<Found> {
        self.check_calibration()?;
        let stiffness = self.calibration(None)?.stiffness;
        self.by_angle(&stiffness)?;
        self.note_inputs()?;
        Ok(Found { stiffness: Some(stiffness), ..Found::default() })
    }

    /// The calibration with the laws by contact angle, for a study that wants the elements of the solids.
    ///
    /// # Errors
    /// Those of the stages; [`InputError`] for a study without laws by contact angle.
    pub fn springs_with_elements(mut self) -> Result<(Found, StiffnessByAngleRecord)> {
        self.check_calibration()?;
        let stiffness = self.calibration(None)?.stiffness;
        let laws = self.by_angle(&stiffness)?.ok_or_else(|| {
            let expected = "laws by contact angle, which the element is fitted to";
            InputError::new("calibration.shifts_mm", "[]", expected, "leave it out, or give some shifts")
        })?;
        self.note_inputs()?;
        Ok((Found { stiffness: Some(stiffness), ..Found::default() }, laws))
    }

    /// The calibration; says the error band of its law, and which loads it does not have.
    fn calibration(&mut self, found: Option<CalibratedPair>) -> Result<Calibration> {
        let has_horizontal = self.study.simulation.horizontal.is_some();
        let calibration =
            self.engine.get(&mut Calibrate { solids: &mut self.solids, has_horizontal, found })?;
        for line in calibration.stiffness.shortened().into_iter().chain(calibration.stiffness.law_errors()) {
            self.engine.monitor.notice(&line);
        }
        Ok(calibration)
    }

    /// The laws by contact angle, if the study wants them.
    fn by_angle(&mut self, stiffness: &StiffnessRecord) -> Result<Option<StiffnessByAngleRecord>> {
        let (solids, input) = (&mut self.solids, ByAngleInput::of(self.study));
        let wanted = self.study.wants_by_angle();
        wanted.then(|| self.engine.get(&mut ByAngle { solids, input, stiffness })).transpose()
    }

    /// Says what was done to measured profiles, and checks that the study can be calibrated: friction, and room for the
    /// loads.
    fn check_calibration(&mut self) -> Result<()> {
        make::check_friction(self.study.statics())?;
        error_band::check_target(self.study.statics())?;
        let geometry = self.solids.geometry()?;
        self.say_repairs(&geometry);
        zones::check_loads(self.study.statics(), &geometry, self.engine.monitor)?;
        self.solids.input.say_notes(self.engine.monitor);
        Ok(())
    }

    fn say_repairs(&self, geometry: &Geometry) {
        sections::repairs(&geometry.profiles).iter().for_each(|line| self.engine.monitor.notice(line));
    }

    /// The meshes alone, of rail and wheel: `rail.vtu` and `wheel.vtu`.
    ///
    /// # Errors
    /// Those of the stage.
    pub fn mesh(mut self) -> Result<[MeshSize; 2]> {
        let geometry = self.solids.geometry()?;
        self.say_repairs(&geometry);
        let Resources { budget, interpreter, monitor } = self.solids.resources;
        let memory = budget.bytes().map(|(bytes, _)| bytes);
        budget.check_sizes(&self.solids.input, &geometry, &Work::default())?;
        let options = zones::mesh_options(self.study.statics(), &geometry);
        let meshes =
            meshes::meshes(self.study.statics(), &geometry, options, (interpreter, memory), monitor)?;
        let address = Address::of(Kind::Meshes, &self.study.statics());
        let [of_rail, of_wheel] = [&self.study.rail.mesh, &self.study.wheel.mesh]
            .map(|file| file.as_ref().map_or(&[][..], |file| &file.groups));
        let files = [(&meshes.rail, of_rail, "rail.vtu"), (&meshes.wheel, of_wheel, "wheel.vtu")]
            .into_iter()
            .map(|(mesh, groups, name)| {
                Ok(NewFile::new(name, fields::mesh_vtu(mesh, groups)?.into_bytes(), address.key()))
            })
            .collect::<Result<_>>()?;
        self.engine.results.write(files, &[])?;
        Ok([&meshes.rail, &meshes.wheel].map(MeshSize::of))
    }

    /// The simple model alone, with the springs of `law` or of the folder; its runs.
    ///
    /// # Errors
    /// Those of the stage, and springs that are not there or do not suit the study.
    pub fn simulate(mut self, law: Option<&Path>) -> Result<Found> {
        let (springs, laws) = match law {
            Some(path) => {
                (springs::from_file(&SpringsInput::of(self.study), &*self.solids.geometry()?, path)?, None)
            }
            None => match self.springs_without_calibration()? {
                Some(springs) => (springs, None),
                None => self.stored_springs()?,
            },
        };
        // a copy of the study's own law may lie where its calibration does not
        let calibrated = springs.source == SpringsSource::Calibrated && !self.study.scenarios.is_empty();
        let calibration = if calibrated { self.stored_stiffness().ok() } else { None };
        let mut runs = Vec::new();
        for (name, scenario) in &self.study.scenarios {
            let run = self.simple_run(name, scenario, &springs)?;
            self.other_elements(name, scenario, &springs, laws.as_ref())?;
            // why there are none is said by the verdict
            let _ = self.uncertain_run(name, scenario, (&springs, calibration.as_ref()), &run)?;
            runs.push((name.clone(), run.record));
        }
        self.note_inputs()?;
        let own = law.is_none() && self.study.simulation.law == LawKey::Calibrated;
        let stiffness = own.then(|| self.stored_stiffness()).transpose()?;
        Ok(Found { stiffness, runs, verdict: None })
    }

    /// The springs that need no calibration, if the study has such and the folder has no calibration.
    fn springs_without_calibration(&mut self) -> Result<Option<SpringsRecord>> {
        if self.engine.folder.file(STIFFNESS).exists()
            || !springs::need_no_calibration(&SpringsInput::of(self.study))
        {
            return Ok(None);
        }
        Ok(springs::without_calibration(&SpringsInput::of(self.study), &*self.solids.geometry()?))
    }

    /// The solid model on the load cases of the folder, and the verdict.
    ///
    /// Solid histories that the folder has for these very load cases stay as they are, unless all is to be made anew.
    ///
    /// # Errors
    /// Those of the stages, and histories of the simple model that are missing or were made from other inputs.
    pub fn verify(mut self) -> Result<Found> {
        let (stiffness, simple) = self.stored_simple_runs()?;
        let mut runs = Vec::new();
        for ((name, scenario), (simple, (springs, laws))) in self.study.scenarios.iter().zip(simple) {
            let others = self.other_elements(name, scenario, &springs, laws.as_ref())?;
            let uncertain = self.uncertain_run(name, scenario, (&springs, stiffness.as_ref()), &simple)?;
            let solid = match scenario.solid {
                false => None,
                true => Some(match self.stored_solid_run(name, scenario) {
                    Ok(run) if !self.engine.fresh => run,
                    _ => self.solid_run(name, scenario, None)?,
                }),
            };
            runs.push((name.clone(), Runs { simple, others, uncertain, solid }));
        }
        let by_angle = if stiffness.is_some() { self.stored_by_angle()? } else { None };
        let verdict = self.engine.get(&mut Verify {
            input: VerdictInput::of(self.study),
            stiffness: stiffness.as_ref(),
            by_angle: by_angle.as_ref(),
            runs: &runs,
        })?;
        self.note_inputs()?;
        Ok(Found { stiffness, runs: Vec::new(), verdict: Some(verdict) })
    }

    /// The report from the files of the folder.
    ///
    /// # Errors
    /// Files that are missing or were made from other inputs: all of them in one message.
    pub fn report(mut self) -> Result<Found> {
        let Stored { calibration, by_angle, runs, verdict } = self.stored_results()?;
        self.write_report(&calibration, by_angle.as_ref(), &runs, &verdict)?;
        Ok(Found { stiffness: Some(calibration.stiffness), runs: Vec::new(), verdict: Some(verdict) })
    }

    fn simple_run(&mut self, name: &str, scenario: &StudyScenario, springs: &SpringsRecord) -> Result<Run> {
        let input = SimpleRunInput::of(self.study, scenario);
        self.engine.get(&mut Simulate { solids: &mut self.solids, input, name, scenario, springs })
    }

    fn other_elements(
        &mut self,
        name: &str,
        scenario: &StudyScenario,
        springs: &SpringsRecord,
        laws: Option<&StiffnessByAngleRecord>,
    ) -> Result<Vec<Other>> {
        let input = SimpleRunInput::of(self.study, scenario);
        other_elements(&mut self.engine, &mut self.solids, (input, name, scenario), springs, laws)
    }

    fn uncertain_run(
        &mut self,
        name: &str,
        scenario: &StudyScenario,
        (springs, stiffness): (&SpringsRecord, Option<&StiffnessRecord>),
        nominal: &Run,
    ) -> Result<Uncertain> {
        let case = SimpleRunInput::of(self.study, scenario);
        let input = UncertainInput::of(case, springs, stiffness, (self.study.statics(), &self.study.limits));
        uncertain_run(&mut self.engine, &mut self.solids, input, name, nominal)
    }

    fn solid_run(
        &mut self,
        name: &str,
        scenario: &StudyScenario,
        background: Option<&BackgroundRuns<'a>>,
    ) -> Result<Run> {
        self.engine.get(&mut SimulateSolid { solids: &mut self.solids, background, name, scenario })
    }

    fn write_report(
        &mut self,
        calibration: &Calibration,
        by_angle: Option<&StiffnessByAngleRecord>,
        runs: &[(String, Runs)],
        verdict: &VerificationRecord,
    ) -> Result<()> {
        let input = PageInput::of(self.study);
        let checks = Vec::new();
        let report = Report { solids: &mut self.solids, input, calibration, by_angle, runs, verdict, checks };
        write_report(&mut self.engine, report)
    }

    /// The pages after a cross-check: the report too, if the folder has the study's other results;
    /// whether it has.
    ///
    /// # Errors
    /// As [`StudyRun::report`], and a cross-check that is not there.
    pub fn crosscheck_pages(mut self) -> Result<bool> {
        if self.stored_results().is_ok() {
            self.report().map(|_| true)
        } else {
            crosscheck_alone(&PageInput::of(self.study), self.engine.folder).map(|()| false)
        }
    }

    /// The cross-check with its page, and the report again if the folder has the study's other results; the record says
    /// whether all limits hold. `keep` is a file that gets a copy of it.
    ///
    /// # Errors
    /// A program that is missing, a copy that cannot be written, and those of the stages.
    pub fn crosscheck(
        mut self,
        cases: &[Case],
        calculix: bool,
        keep: Option<&Path>,
    ) -> Result<CrosscheckRecord> {
        // first, so that whatever is missing is reported before anything is computed
        let keep = keep.map(|path| self.kept_in(path)).transpose()?;
        let solvers = Solvers::find(cases, calculix, &self.solids.resources)?;
        let (input, resources) = (CrosscheckInput::of(self.study), self.solids.resources);
        let record = self.engine.get(&mut Crosscheck { input, resources, cases, solvers: &solvers })?;
        self.crosschecked(record, keep)
    }

    /// The same for the first load case in time.
    ///
    /// # Errors
    /// As [`StudyRun::crosscheck`], and [`InputError`] for a load case that the reference does not have.
    pub fn crosscheck_in_time(mut self, keep: Option<&Path>) -> Result<CrosscheckRecord> {
        let keep = keep.map(|path| self.kept_in(path)).transpose()?;
        let (input, resources) = (InTimeInput::of(self.study)?, self.solids.resources);
        let solvers = Solvers::find(&[], false, &resources)?;
        let record = self.engine.get(&mut CrosscheckInTime { input, resources, python: &solvers.python })?;
        self.crosschecked(record, keep)
    }

    /// The pages of a cross-check, and a copy of its record.
    fn crosschecked(
        self,
        record: CrosscheckRecord,
        keep: Option<(OutputFolder, String)>,
    ) -> Result<CrosscheckRecord> {
        if let Some((kept, name)) = keep {
            kept.write_json(&name, &record)?;
        }
        self.crosscheck_pages()?;
        Ok(record)
    }

    /// Folder and name of the copy.
    fn kept_in(&self, path: &Path) -> Result<(OutputFolder, String)> {
        OutputFolder::of_file("--keep", path, self.engine.folder.inputs())
    }
}
