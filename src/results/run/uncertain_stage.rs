//! The samples of uncertain inputs of a load case on the simple model as a stage.

use railspring_profiles::error::Result;

use crate::engine::list::NewFile;
use crate::engine::output::to_json;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact};
use crate::results::bodies::geometry::track;
use crate::results::bodies::in_work::Solids;
use crate::results::names::OF_THE_RUNS;
use crate::results::run::departed::{Departing, SpringChanges};
use crate::results::run::input::UncertainInput;
use crate::results::run::springs;
use crate::results::run::stage::{Run, history_files};
use crate::results::run::uncertain::{Evaluated, uncertain};
use crate::results::run::uncertain_record::{UNCERTAIN, UNCERTAIN_NOTE, UncertainRun, read, write};
use crate::results::springs::uncertain_inputs::UncertainInputs;

/// Part of an artefact: the bands over time as the output folder has them.
const ROWS: &str = "history_uncertain.csv";
/// Part of an artefact: what else is known of the samples.
const RECORD: &str = "uncertain.json";
/// Part of an artefact: why there is no band.
const FAILURE: &str = "failure.txt";

/// The samples of a load case, or why it has none.
pub(crate) type Uncertain = std::result::Result<UncertainRun, String>;

/// The samples of a load case on the simple model.
struct Samples<'s, 'a> {
    solids: &'s mut Solids<'a>,
    input: UncertainInput<'s>,
    name: &'s str,
    /// The run with the inputs as they are taken to be.
    nominal: &'s Run,
}

impl Stage for Samples<'_, '_> {
    type Value = Uncertain;

    fn name(&self) -> String {
        format!("uncertainty of the inputs, {}", self.name)
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        Ok(self.input.address())
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput> {
        let artefact = match self.run(engine)? {
            Ok(UncertainRun { rows, record }) => {
                Artefact::default().with(ROWS, write(&rows)).with(RECORD, to_json(&record))
            }
            Err(reason) => Artefact::default().with(FAILURE, reason),
        };
        Ok(StageOutput::whole(artefact))
    }

    fn value(&mut self, artefact: &Artefact, _: &str) -> Result<Uncertain> {
        if artefact.part(FAILURE).is_some() {
            return Ok(Err(artefact.text(FAILURE)?.into()));
        }
        Ok(Ok(UncertainRun { rows: read(ROWS, artefact.text(ROWS)?)?, record: artefact.json(RECORD)? }))
    }

    fn files(&self, artefact: &Artefact, value: &Uncertain, key: &str) -> Vec<NewFile> {
        let Ok(run) = value else { return Vec::new() };
        let rows = artefact.part(ROWS).unwrap_or_default().to_vec();
        vec![
            NewFile::new(file(self.solids.input.main_case, self.name), rows, key)
                .noted(UNCERTAIN_NOTE, &run.record),
        ]
    }

    fn outdates(&self) -> &'static [&'static str] {
        &OF_THE_RUNS
    }
}

impl Samples<'_, '_> {
    fn run(&mut self, engine: &Engine<'_>) -> Result<Uncertain> {
        let UncertainInput { run, springs: record, of_springs, statics, window, ratio_max, shortest, .. } =
            self.input;
        let geometry = self.solids.geometry()?;
        let inputs = UncertainInputs::of(statics);
        let with_horizontal = run.simulation.horizontal.is_none();
        let changes = of_springs.and_then(|of| SpringChanges::of(of, &inputs.records(), with_horizontal));
        let used = springs::springs(record)?;
        let left_out = self.left_out(changes.is_some());
        let departing = Departing {
            input: run,
            geometry: &geometry,
            track: track(statics, (-geometry.pair.placed.angle).tan()),
            springs: &used,
            changes,
        };
        let carrying = self.nominal.model().carrying(ratio_max);
        let evaluated = Evaluated { window, carrying, shortest };
        let element = springs::element(record).name();
        let stage = self.name();
        uncertain(
            &departing,
            &inputs,
            (&self.nominal.history, evaluated),
            (statics.uncertainty.samples, element, left_out),
            (&stage, engine.monitor),
        )
    }

    /// What the samples do without, a sentence each.
    fn left_out(&self, with_springs: bool) -> Vec<String> {
        let UncertainInput { springs: record, of_springs, .. } = self.input;
        let of_element = match (&record.element, with_springs) {
            (Some(_), _) => {
                "wheel, head and strips are those of the pair as it is taken to be: Young's modulus scales them, Poisson's ratio the strips, the diameter none"
            }
            (None, true) => {
                "law and horizontal stiffness depart to first order, steps of the integration are twice as long"
            }
            (None, false) => {
                "law and horizontal stiffness do not depart, as their uncertainty is not known; steps of the integration are twice as long"
            }
        };
        let by_effect: Vec<&str> = of_springs
            .iter()
            .flat_map(|of| &of.inputs)
            .filter(|input| input.key.is_none())
            .map(|input| input.name.as_str())
            .collect();
        let known_by_effect = (!by_effect.is_empty()).then(|| {
            format!("inputs that are known by their effect on the springs alone: {}", by_effect.join(", "))
        });
        [of_element.to_owned()].into_iter().chain(known_by_effect).collect()
    }
}

/// Name of the file of a load case.
pub(crate) fn file(main: Option<&str>, case: &str) -> String {
    let [file] = history_files(main, case, [UNCERTAIN]);
    file
}

/// The samples of a load case beside its nominal run, or why it has none. What an earlier command has left goes with them.
///
/// # Errors
/// An interruption, and files that cannot be written or removed.
pub(crate) fn uncertain_run(
    engine: &mut Engine<'_>,
    solids: &mut Solids<'_>,
    input: UncertainInput<'_>,
    name: &str,
    nominal: &Run,
) -> Result<Uncertain> {
    let found = match UncertainInputs::without_samples(input.statics) {
        Some(reason) => Err(reason.to_owned()),
        None => {
            let solids = &mut *solids;
            engine.get(&mut Samples { solids, input, name, nominal })?
        }
    };
    if found.is_err() {
        engine.results.withdraw(&[file(solids.input.main_case, name)], &OF_THE_RUNS)?;
    }
    Ok(found)
}
