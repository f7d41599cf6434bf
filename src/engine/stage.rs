//! What a stage is, and how its result is had: taken from the store, or made and kept there.

use railspring_profiles::error::{Error, Result};
use railspring_profiles::monitor::Monitor;
use serde_json::Value;

use crate::engine::list::{NewFile, Results, not_a_users};
use crate::engine::measure::{Stopwatch, begin};
use crate::engine::measured::Measured;
use crate::engine::output::OutputFolder;
use crate::engine::store::{Address, Artefact, Store};

/// Time, memory and host of the stages.
pub const MEASURED: &str = "measured.json";

/// Refuses a folder in which a file under the name of an output is a user's, before any work.
///
/// # Errors
/// [`railspring_profiles::error::InputError`] whose key is the path of that file.
pub fn check_outputs(folder: &OutputFolder, is_output: impl Fn(&str) -> bool) -> Result<()> {
    let measured = folder.file(MEASURED);
    if measured.exists() && folder.read_json::<Measured>(MEASURED, "run").is_err() {
        return not_a_users(&measured);
    }
    Results::new(folder).check_unlisted(|name| name != MEASURED && is_output(name))
}

/// A stage: what its result is made from, how it is made, and the files that it becomes.
pub trait Stage {
    /// What the stage hands on.
    type Value;

    /// What the terminal and the measures call it.
    fn name(&self) -> String;

    /// Its address: all that it is made from, the program included. The store keeps it there, and the output folder lists its files by it.
    ///
    /// # Errors
    /// Those of what has to be known for it.
    fn address(&mut self, engine: &Engine<'_>) -> Result<Address>;

    /// Whether the store keeps it; not what is made sooner than it is read.
    fn is_kept(&self) -> bool {
        true
    }

    /// What was made of it beside other stages.
    fn background(&self) -> Option<Result<StageOutput>> {
        None
    }

    /// Makes it.
    ///
    /// # Errors
    /// Those of the computation, and an interruption.
    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput>;

    /// What the artefact of an address with this key holds; the same whether it was taken or made.
    ///
    /// # Errors
    /// An artefact that cannot be read.
    fn value(&mut self, artefact: &Artefact, key: &str) -> Result<Self::Value>;

    /// The files that it becomes in the output folder, listed by the key.
    fn files(&self, artefact: &Artefact, value: &Self::Value, key: &str) -> Vec<NewFile>;

    /// Files that are made from these, and go when one of these changes.
    fn outdates(&self) -> &'static [&'static str];

    /// What is noted beside all its files, by name.
    fn note(&self) -> Option<(&'static str, Value)> {
        None
    }

    /// Whether it takes so long that time, memory and where it came from are said.
    fn is_measured(&self) -> bool {
        true
    }
}

/// What a stage has made.
pub struct StageOutput {
    /// Its parts.
    pub artefact: Artefact,
    /// Whether it is the whole result, which follows from its inputs alone.
    pub complete: bool,
    /// Why the command ends here all the same.
    pub failure: Option<Error>,
    /// The time that it took beside other stages, of which it is measured and kept already.
    pub elsewhere: Option<Stopwatch>,
}

impl StageOutput {
    /// A complete result.
    pub fn whole(artefact: Artefact) -> Self {
        Self { artefact, complete: true, failure: None, elsewhere: None }
    }
}

/// Store, output folder and measures of a study, through which every stage goes.
pub struct Engine<'a> {
    /// Name of the study, for lists.
    study: &'a str,
    /// The output folder.
    pub folder: &'a OutputFolder,
    /// The results in it.
    pub results: Results<'a>,
    /// Where artefacts are kept, if anywhere.
    pub store: Option<&'a Store>,
    /// Whether all is made anew.
    pub fresh: bool,
    /// Who hears how far a stage is.
    pub monitor: &'a dyn Monitor,
    /// Time and memory of the stages so far.
    pub measured: Measured,
    /// The time of the stage that is being made.
    pub watch: Option<Stopwatch>,
}

impl<'a> Engine<'a> {
    /// Begins with the measures that earlier commands have left in the folder.
    pub fn new(study: &'a str, folder: &'a OutputFolder, monitor: &'a dyn Monitor) -> Self {
        let earlier = folder.read_json::<Measured>(MEASURED, "run").map(|m| m.stages).unwrap_or_default();
        Self {
            study,
            folder,
            results: Results::new(folder),
            store: None,
            fresh: false,
            monitor,
            measured: Measured { stages: earlier, ..begin() },
            watch: None,
        }
    }

    /// The result of a stage, and its files in the output folder.
    ///
    /// # Errors
    /// Those of making it and of writing its files.
    pub fn get<S: Stage>(&mut self, stage: &mut S) -> Result<S::Value> {
        self.watch = Some(Stopwatch::start());
        let address = stage.address(self)?;
        let key = address.key();
        let background = stage.background().transpose()?;
        let takes = stage.is_kept() && !self.fresh && background.is_none();
        let taken = if takes { self.take(stage, &address) } else { None };
        let is_taken = taken.is_some();
        let (artefact, value, failure) = match taken {
            Some((artefact, value)) => (artefact, value, None),
            None => {
                let made = background.map_or_else(|| stage.make(self), Ok)?;
                let StageOutput { artefact, complete, failure, elsewhere } = made;
                if stage.is_kept() && complete && elsewhere.is_none() {
                    self.keep(&address, &stage.name(), &artefact);
                }
                self.watch = elsewhere.or(self.watch.take());
                let value = stage.value(&artefact, key)?;
                (artefact, value, failure)
            }
        };
        let files = stage.files(&artefact, &value, key).into_iter();
        let note = stage.note();
        let noted = |file: NewFile| match &note {
            Some((name, note)) => file.noted(name, note),
            None => file,
        };
        self.results.write(files.map(noted).collect(), stage.outdates())?;
        if stage.is_measured() {
            self.note(&stage.name(), key, is_taken)?;
            let whence = if is_taken { "taken from the store" } else { "made" };
            self.monitor.notice(&format!("{}: {whence}", stage.name()));
        }
        failure.map_or(Ok(value), Err)
    }

    /// What the store has for a stage; an entry that cannot be used is said and removed.
    fn take<S: Stage>(&self, stage: &mut S, address: &Address) -> Option<(Artefact, S::Value)> {
        let (store, name) = (self.store?, stage.name());
        let read = |artefact: Artefact| stage.value(&artefact, address.key()).map(|value| (artefact, value));
        store.take_as(address, read, &|text| self.monitor.notice(&format!("{name}: {text}")))
    }

    /// Keeps an artefact. A store that cannot be written takes nothing from the result.
    fn keep(&self, address: &Address, name: &str, artefact: &Artefact) {
        let Some(store) = self.store else { return };
        let say = |text| self.monitor.notice(&format!("{name}: {text}"));
        store.keep(address, name, self.study, artefact, &say);
    }

    /// Adds a measure, and drops those of results that the folder has no longer.
    fn note(&mut self, stage: &str, key: &str, taken: bool) -> Result<()> {
        let watch = self.watch.take().unwrap_or_else(Stopwatch::start);
        self.measured.note(watch.stop(stage, key, taken));
        let results = &self.results;
        self.measured.stages.retain(|stage| results.has(&stage.key));
        self.folder.write_json(MEASURED, &self.measured)
    }
}
