//! The load cases on the simple model as stages, and what the runs of both models have in common.

use std::fmt::Display;
use std::path::Path;

use railspring_profiles::error::{Error, Result, or_reason};
use railspring_simulate::time::history::{Ending, History};

use crate::engine::list::NewFile;
use crate::engine::output::to_json;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact, unreadable};
use crate::results::bodies::in_work::Solids;
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::names::OF_THE_RUNS;
use crate::results::run::input::SimpleRunInput;
use crate::results::run::record::{RUN_NOTE, RunRecord, SpringsRecord};
use crate::results::run::uncertain_record::UncertainRun;
use crate::results::run::{history_csv, make, springs};
use crate::study::{ContactElementKey, StudyScenario};
use crate::verify::ModelRun;

/// Part of an artefact: the rows as the output folder has them.
const ROWS: &str = "history.csv";
/// Part of an artefact: the model's size, its springs and how the run ended.
const RECORD: &str = "run.json";
/// Parts of an artefact: the same of the run with an input that is 0.1 % larger.
const DISTURBED: [&str; 2] = ["history_disturbed.csv", "run_disturbed.json"];
/// Names of the files of both models' runs, and of the runs with a larger input.
pub(crate) const SIMPLE: [&str; 2] = ["history", "history_disturbed"];
pub(crate) const SOLID: [&str; 2] = ["solid_history", "solid_history_disturbed"];
/// Part of an artefact: why an element that the study has not chosen did not run.
const FAILURE: &str = "failure.txt";

/// Names of the files of a contact element that the study has not chosen.
pub(crate) fn of_element(element: ContactElementKey) -> [String; 2] {
    SIMPLE.map(|stem| match stem.split_once('_') {
        Some((history, of)) => format!("{history}_{}_{of}", element.name()),
        None => format!("{stem}_{}", element.name()),
    })
}

/// A history and what belongs to it.
pub(crate) struct Run {
    pub history: History,
    pub record: RunRecord,
    /// The run with an input that is 0.1 % larger, if it could be done.
    pub disturbed: Option<History>,
}

impl Run {
    /// The run with what has to be known of its load case, which follows from the study's file and not from what the run is made of.
    fn noted(mut self, scenario: &StudyScenario) -> Self {
        self.record.notes.splice(0..0, scenario.notes.iter().cloned());
        self.record.tables = scenario.tables.clone();
        self
    }

    /// The run with its uncertainty.
    pub fn model(&self) -> ModelRun<'_> {
        self.record.model(&self.history, self.disturbed.as_ref())
    }
}

/// A load case on the simple model.
pub(crate) struct Simulate<'s, 'a> {
    pub solids: &'s mut Solids<'a>,
    pub input: SimpleRunInput<'s>,
    pub name: &'s str,
    pub scenario: &'s StudyScenario,
    pub springs: &'s SpringsRecord,
}

/// The same in a contact element that the study has not chosen, with its springs.
pub(crate) struct SimulateOther<'s, 'a>(pub Simulate<'s, 'a>);

/// A contact element that the study has not chosen.
pub(crate) struct Other {
    pub element: ContactElementKey,
    /// Its run, or why there is none.
    pub run: std::result::Result<Run, String>,
}

/// The runs of a scenario: the simple model with the study's contact element, the same with each other one and with other inputs, and the solid model.
pub(crate) struct Runs {
    pub simple: Run,
    pub others: Vec<Other>,
    /// The simple model with inputs that are not known exactly, or why there is no band by them.
    pub uncertain: std::result::Result<UncertainRun, String>,
    pub solid: Option<Run>,
}

impl Stage for Simulate<'_, '_> {
    type Value = Run;

    fn name(&self) -> String {
        format!("simple model, {}", self.name)
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        Ok(self.input.address(self.springs))
    }

    fn make(&mut self, _: &mut Engine<'_>) -> Result<StageOutput> {
        self.run().map(StageOutput::whole)
    }

    fn value(&mut self, artefact: &Artefact, _: &str) -> Result<Run> {
        run(artefact).map(|run| run.noted(self.scenario))
    }

    fn files(&self, artefact: &Artefact, value: &Run, key: &str) -> Vec<NewFile> {
        files(history_files(self.solids.input.main_case, self.name, SIMPLE), artefact, value, key)
    }

    fn outdates(&self) -> &'static [&'static str] {
        &OF_THE_RUNS
    }
}

impl Stage for SimulateOther<'_, '_> {
    type Value = std::result::Result<Run, String>;

    fn name(&self) -> String {
        format!("{}, {} element", self.0.name(), springs::element(self.0.springs).name())
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        Ok(self.0.input.other_address(self.0.springs))
    }

    fn make(&mut self, _: &mut Engine<'_>) -> Result<StageOutput> {
        let failed = |reason| Artefact::default().with(FAILURE, reason);
        Ok(StageOutput::whole(or_reason(self.0.run())?.unwrap_or_else(failed)))
    }

    fn value(&mut self, artefact: &Artefact, _: &str) -> Result<Self::Value> {
        match artefact.part(FAILURE) {
            Some(_) => Ok(Err(artefact.text(FAILURE)?.into())),
            None => run(artefact).map(|run| Ok(run.noted(self.0.scenario))),
        }
    }

    fn files(&self, artefact: &Artefact, value: &Self::Value, key: &str) -> Vec<NewFile> {
        let names = of_element(springs::element(self.0.springs));
        let Ok(run) = value else { return Vec::new() };
        files(history_files(self.0.solids.input.main_case, self.0.name, names), artefact, run, key)
    }

    fn outdates(&self) -> &'static [&'static str] {
        &OF_THE_RUNS
    }
}

impl Simulate<'_, '_> {
    /// The run as an artefact.
    fn run(&mut self) -> Result<Artefact> {
        let Self { solids: at, input, name, springs, .. } = self;
        let used = springs::springs(springs)?;
        let geometry = at.geometry()?;
        let (history, tried) = make::simulate(input, &geometry, &used, at.resources.monitor)
            .map_err(|error| at.input.source.in_scenario(name, error))?;
        let runs_with = format!("simple model: the {} contact element", springs::element(springs).name());
        let notes = [runs_with].into_iter().chain(springs::range_note(springs, &history)).collect();
        let record = RunRecord {
            wheel_mass_kg: Some(input.case.wheel_mass.unwrap_or(used.mass())),
            ..RunRecord::new(&history, Some(springs), tried.uncertainty, notes)
        };
        Ok(artefact(&history, &record, tried.disturbed.as_ref()))
    }
}

/// The load case in each contact element that the study has not chosen, as far as it can run beside `springs`. Nothing of it is an error of the study.
///
/// # Errors
/// An interruption, and files that cannot be written or removed.
pub(crate) fn other_elements(
    engine: &mut Engine<'_>,
    solids: &mut Solids<'_>,
    (input, name, scenario): (SimpleRunInput<'_>, &str, &StudyScenario),
    springs: &SpringsRecord,
    laws: Option<&StiffnessByAngleRecord>,
) -> Result<Vec<Other>> {
    let chosen = springs::element(springs);
    let mut others = Vec::new();
    for element in chosen.others() {
        let run = match springs::in_element(springs, laws, element) {
            Ok(springs) => {
                let solids = &mut *solids;
                engine.get(&mut SimulateOther(Simulate {
                    solids,
                    input,
                    name,
                    scenario,
                    springs: &springs,
                }))?
            }
            Err(reason) => Err(reason),
        };
        others.push(Other { element, run });
    }
    // what an earlier command has left of an element that does not run beside this one
    let failed = others.iter().filter(|other| other.run.is_err()).map(|other| other.element);
    let gone: Vec<String> = [chosen]
        .into_iter()
        .chain(failed)
        .flat_map(|element| history_files(solids.input.main_case, name, of_element(element)))
        .collect();
    engine.results.withdraw(&gone, &OF_THE_RUNS)?;
    Ok(others)
}

/// A run as an artefact, with the one that has a larger input.
pub(crate) fn artefact(history: &History, record: &RunRecord, disturbed: Option<&History>) -> Artefact {
    let of = |artefact: Artefact, [rows, size]: [&str; 2], history, record| {
        artefact.with(rows, history_csv::write(history)).with(size, to_json(record))
    };
    let artefact = of(Artefact::default(), [ROWS, RECORD], history, record);
    match disturbed {
        Some(history) => of(artefact, DISTURBED, history, &RunRecord::bare(history)),
        None => artefact,
    }
}

/// The run of an artefact.
pub(crate) fn run(artefact: &Artefact) -> Result<Run> {
    let (history, record) = part(artefact, [ROWS, RECORD])?;
    let has_other = artefact.part(DISTURBED[0]).is_some();
    let disturbed = has_other.then(|| Ok::<_, Error>(part(artefact, DISTURBED)?.0)).transpose()?;
    Ok(Run { history, record, disturbed })
}

/// A history of an artefact with its record.
fn part(artefact: &Artefact, [rows, size]: [&str; 2]) -> Result<(History, RunRecord)> {
    let record: RunRecord = artefact.json(size)?;
    let ending: Ending = record.ending().ok_or_else(|| unreadable(size, "an unknown ending"))?;
    let text = artefact.text(rows)?;
    let history = history_csv::read(Path::new(rows), text, record.degrees_of_freedom, ending)?;
    Ok((history, record))
}

/// The files of a run with their names.
pub(crate) fn files([name, other]: [String; 2], artefact: &Artefact, run: &Run, key: &str) -> Vec<NewFile> {
    let file = |name, part, record: &RunRecord| {
        let rows = artefact.part(part).unwrap_or_default().to_vec();
        NewFile::new(name, rows, key).noted(RUN_NOTE, record)
    };
    let disturbed = run.disturbed.as_ref().map(|run| file(other, DISTURBED[0], &RunRecord::bare(run)));
    [file(name, ROWS, &run.record)].into_iter().chain(disturbed).collect()
}

/// Names of the history files of a load case: plain for the `main` one, else with its name.
pub fn history_files<const N: usize>(
    main: Option<&str>,
    case: &str,
    stems: [impl Display; N],
) -> [String; N] {
    stems.map(|stem| match main == Some(case) {
        true => format!("{stem}.csv"),
        false => format!("{stem}-{case}.csv"),
    })
}
