//! A default study that the program has solved in a folder, for tests that run its simple model again in other ways.

use std::path::Path;

use railspring::engine::inputs::Inputs;
use railspring::engine::list as results;
use railspring::engine::output::OutputFolder;
use railspring::results::bodies::estimate::Resources;
use railspring::results::bodies::geometry::{self, Geometry};
use railspring::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use railspring::results::run::input::{SimpleRunInput, SpringsInput};
use railspring::results::run::make::{self, RunWithErrors, Springs};
use railspring::results::run::record::RunRecord;
use railspring::results::run::{history_csv, springs};
use railspring::results::springs::record::StiffnessRecord;
use railspring::results::study_run::StudyRun;
use railspring::results::verdict::record::VerificationRecord;
use railspring::study::{Study, StudyScenario};
use railspring::verify::{Comparison, Limits, ModelRun, compare};
use railspring_profiles::monitor::Silent;
use railspring_simulate::time::history::{Ending, History};
use serde_json::Value;

/// A study with what a run of the program has made of it.
pub struct Solved {
    pub study: Study,
    pub geometry: Geometry,
    /// The springs with the condensed element.
    pub springs: Springs,
    pub stiffness: StiffnessRecord,
    pub laws: StiffnessByAngleRecord,
    pub verdict: VerificationRecord,
    /// The solid's run of each load case that it ran, with its name.
    pub solids: Vec<(String, SolidRun)>,
}

/// A run of the solid model as the output folder has it.
pub struct SolidRun {
    pub history: History,
    disturbed: Option<History>,
    record: RunRecord,
}

impl SolidRun {
    /// With its uncertainty.
    pub fn model(&self) -> ModelRun<'_> {
        self.record.model(&self.history, self.disturbed.as_ref())
    }
}

impl Solved {
    /// Solves the study of `data/studies` with this name.
    pub fn of(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("data/studies/{name}.toml"));
        let study = Study::read(&path).unwrap_or_else(|e| panic!("{name}: {e}"));
        let place = tempfile::tempdir().unwrap();
        let folder = OutputFolder::create(place.path(), &Inputs::none()).unwrap();
        StudyRun::new(&study, &folder, Resources::of_the_machine(&Silent))
            .run()
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let text = |name: &str| std::fs::read_to_string(place.path().join(name)).unwrap();
        let json = |name: &str| serde_json::from_str::<Value>(&text(name)).unwrap();
        let results = json(results::RESULTS);
        let solid = |scenario: &String| {
            let main = study.main_scenario.as_ref() == Some(scenario);
            let of = |stem: &str| if main { format!("{stem}.csv") } else { format!("{stem}-{scenario}.csv") };
            let [file, disturbed] = ["solid_history", "solid_history_disturbed"].map(of);
            let run =
                |name: &str| history_csv::read(Path::new(name), &text(name), 1, Ending::Completed).unwrap();
            let record: RunRecord = serde_json::from_value(results["files"][&file]["run"].clone()).unwrap();
            let disturbed = record.spread.as_ref().map(|_| run(&disturbed));
            SolidRun { history: run(&file), disturbed, record }
        };
        let cases = study.scenarios.iter().filter(|(_, case)| case.solid);
        let solids = cases.map(|(scenario, _)| (scenario.clone(), solid(scenario))).collect();
        let geometry = geometry::geometry(study.statics()).unwrap();
        let record =
            springs::from_file(&SpringsInput::of(&study), &geometry, &place.path().join("stiffness.json"))
                .unwrap();
        Self {
            springs: springs::springs(&record).unwrap(),
            geometry,
            stiffness: serde_json::from_value(json("stiffness.json")).unwrap(),
            laws: serde_json::from_value(json(BY_ANGLE)).unwrap(),
            verdict: serde_json::from_value(json("verification.json")).unwrap(),
            solids,
            study,
        }
    }

    /// Runs the simple model of `study`, this one or another one, with some springs on a load case, and compares it with a run of the solid.
    pub fn compared(
        &self,
        study: &Study,
        springs: &Springs,
        case: &StudyScenario,
        solid: &SolidRun,
        limits: &Limits,
    ) -> Result<(History, Comparison), String> {
        let run = make::simulate(&SimpleRunInput::of(study, case), &self.geometry, springs, &Silent);
        let (history, RunWithErrors { uncertainty, disturbed }) = run.map_err(|error| error.to_string())?;
        let discretisation: Vec<_> = uncertainty.discretisation.into_iter().filter_map(Result::ok).collect();
        let simple = ModelRun {
            history: &history,
            steps: uncertainty.steps.as_ref().ok(),
            disturbed: disturbed.as_ref().zip(uncertainty.spread.as_ref().ok()),
            discretisation: &discretisation,
        };
        let comparison = compare(&simple, &solid.model(), limits).map_err(|error| error.to_string())?;
        Ok((history, comparison))
    }
}
