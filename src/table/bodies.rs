//! The wheels and the rails of a table: what the entries of its lists stand for.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use railspring_profiles::error::InputError;
use railspring_profiles::profile::ProfileKind;
use serde_json::{Map, Value};

use super::document::{Keys, TableDocument};
use super::files::beside;
use super::folder::{Folder, FolderFile};
use super::metadata::{Metadata, TAPE_DIAMETER};
use super::sources::Sources;

/// Keys of an entry that belong to the table, and not to a study.
const OF_THE_TABLE: [&str; 4] = ["name", "folder", METADATA_FILE, NAME_PATTERN];
/// Key of the list that says more of the files of a folder.
const METADATA_FILE: &str = "metadata_file";
/// Key of the pattern of their names.
const NAME_PATTERN: &str = "name_pattern";

/// A wheel or a rail of the table.
pub(super) struct Body<'a> {
    pub name: String,
    /// Its entry, for messages: `wheel[0]`.
    pub entry: String,
    /// Its keys of a study.
    pub keys: Map<String, Value>,
    /// Those of them that take several values in its entry.
    pub varied: BTreeMap<&'a str, Value>,
    /// Whether its profile is one of the files of a folder, which may be no profiles.
    pub of_folder: bool,
    /// Whether its diameter was measured with its profile.
    pub diameter_of_file: bool,
    /// What is known of its measurement.
    pub metadata: Arc<Metadata>,
}

impl Body<'_> {
    /// The files that its keys name, of the table at `table`.
    pub fn files(&self, table: &Path) -> Vec<PathBuf> {
        let texts = self.keys.values().filter_map(Value::as_str);
        texts.map(|text| beside(table, text)).filter(|file| file.is_file()).collect()
    }
}

/// The bodies of a table, and what there is to say of their files.
pub(super) struct Bodies<'a> {
    pub wheels: Vec<Body<'a>>,
    pub rails: Vec<Body<'a>>,
    pub notices: Vec<String>,
}

impl<'a> Bodies<'a> {
    /// Those of the entries of a table.
    pub fn of(table: &Path, document: &'a TableDocument, mistaken: &mut dyn FnMut(InputError)) -> Self {
        let mut notices = Vec::new();
        let swept = document.sweep.contains_key(&format!("wheel.{TAPE_DIAMETER}"));
        let mut reading =
            Reading { table, lists: lists(table, document), swept, notices: &mut notices, mistaken };
        let wheels = bodies("wheel", &document.wheel, &mut reading);
        let rails = bodies("rail", &document.rail, &mut reading);
        Self { wheels, rails, notices }
    }
}

/// The files of a table that list others: in a folder with profiles they are none.
fn lists(table: &Path, document: &TableDocument) -> Vec<PathBuf> {
    let of_entries = document.wheel.iter().chain(&document.rail);
    let of_entries = of_entries.filter_map(|entry| entry.get(METADATA_FILE)?.as_str());
    of_entries.chain(document.pairs_file.as_deref()).map(|file| beside(table, file)).collect()
}

/// What entries are read with.
struct Reading<'r> {
    table: &'r Path,
    lists: Vec<PathBuf>,
    /// Whether the table takes the diameters of its wheels from a list.
    swept: bool,
    notices: &'r mut Vec<String>,
    mistaken: &'r mut dyn FnMut(InputError),
}

/// The wheels or the rails of the entries of a list.
fn bodies<'a>(list: &str, entries: &'a [Keys], reading: &mut Reading<'_>) -> Vec<Body<'a>> {
    let mut bodies: Vec<Body<'a>> = Vec::new();
    let mut names = BTreeSet::new();
    for (index, keys) in entries.iter().enumerate() {
        let entry = Entry { list, number: index + 1, place: format!("{list}[{index}]"), keys };
        let new = entry.bodies(reading);
        for name in new.iter().map(|body| body.name.clone()).collect::<BTreeSet<String>>() {
            if !names.insert(name.clone()) {
                let expected = format!("a name that no other {list} has");
                let remedy = "give one of them another `name`";
                (reading.mistaken)(InputError::new(
                    format!("{}.name", entry.place),
                    format!("{name:?}"),
                    expected,
                    remedy,
                ));
            }
        }
        bodies.extend(new);
    }
    bodies
}

/// A file of a folder, and what is known of its measurement.
struct KnownFile {
    file: FolderFile,
    metadata: Arc<Metadata>,
    /// Diameter of a wheel at its tape circle, m, where that is known.
    diameter: Option<Value>,
}

/// An entry of a list of bodies.
struct Entry<'a, 'l> {
    /// `wheel` or `rail`.
    list: &'l str,
    /// From 1 on.
    number: usize,
    /// For messages: `wheel[0]`.
    place: String,
    keys: &'a Keys,
}

impl<'a> Entry<'a, '_> {
    /// Its bodies: one for every file of its folder and every choice of the values of its lists.
    fn bodies(&self, reading: &mut Reading<'_>) -> Vec<Body<'a>> {
        let [name, folder] = ["name", "folder"].map(|key| self.text(key, reading.mistaken));
        let Some(files) = self.files(folder.as_deref(), reading) else { return Vec::new() };
        let lists =
            self.keys.iter().filter_map(|(key, value)| Some((key.as_str(), value.as_array()?.as_slice())));
        if let Some((key, _)) = lists.clone().find(|(_, values)| values.is_empty()) {
            let place = format!("{}.{key}", self.place);
            (reading.mistaken)(InputError::new(
                place,
                "[]",
                "a value, or a list of values",
                "list the values",
            ));
        }
        let choices = product(lists);
        let of_file = |file: &Option<KnownFile>| -> Vec<Body<'a>> {
            choices.iter().map(|varied| self.body(name.as_deref(), file.as_ref(), varied)).collect()
        };
        files.iter().flat_map(of_file).collect()
    }

    /// The files of its folder with what is known of each, a single none without a folder; none at all where the folder cannot be read.
    fn files(&self, folder: Option<&str>, reading: &mut Reading<'_>) -> Option<Vec<Option<KnownFile>>> {
        let key = |leaf: &str| format!("{}.{leaf}", self.place);
        let [list, pattern] = [METADATA_FILE, NAME_PATTERN].map(|key| self.text(key, reading.mistaken));
        let Some(folder) = folder else {
            for (leaf, value) in [(METADATA_FILE, &list), (NAME_PATTERN, &pattern)] {
                let Some(value) = value else { continue };
                let expected = format!("{} beside it", key("folder"));
                let remedy = "the key is about the files of a folder: give it, or remove the key";
                (reading.mistaken)(InputError::new(key(leaf), format!("{value:?}"), expected, remedy));
            }
            return Some(vec![None]);
        };
        let kind = if self.list == "wheel" { ProfileKind::Wheel } else { ProfileKind::Rail };
        let read = || {
            let found = Folder::read(reading.table, folder, kind, &reading.lists)
                .map_err(|mistake| InputError { key: key("folder"), ..mistake })?;
            let list = list.as_deref().map(|file| (file, key(METADATA_FILE)));
            let pattern = pattern.as_deref().map(|pattern| (pattern, key(NAME_PATTERN)));
            let sources = Sources::read(reading.table, list, pattern)?;
            Ok((found, sources))
        };
        let (found, sources) = read().map_err(|mistake| (reading.mistaken)(mistake)).ok()?;
        let place = format!("folder {folder:?}");
        if !found.others.is_empty() {
            let shown = listed(&found.others);
            reading.notices.push(format!("{place}: left out, as they are no profiles: {shown}"));
        }
        let known = sources.of_files(reading.table, &found.files);
        reading.notices.extend(known.notices.iter().map(|notice| format!("{place}: {notice}")));
        let known_file = |(file, mut metadata): (FolderFile, Metadata)| {
            let diameter = metadata.remove(TAPE_DIAMETER);
            KnownFile { file, metadata: Arc::new(metadata), diameter }
        };
        let files: Vec<KnownFile> = found.files.into_iter().zip(known.metadata).map(known_file).collect();
        let with_diameter = files.iter().filter(|file| file.diameter.is_some()).count();
        if self.list == "wheel" && with_diameter > 0 {
            let of_files = format!("{with_diameter} of {} wheels", files.len());
            let listed = reading.swept || self.keys.get(TAPE_DIAMETER).is_some_and(|given| given.is_array());
            let taken = if listed { "those that the table lists are taken" } else { "they are taken" };
            reading.notices.push(format!("{place}: {of_files} say their diameters; {taken}"));
        }
        Some(files.into_iter().map(Some).collect())
    }

    /// The text of a key, if it is there and is one.
    fn text(&self, key: &str, mistaken: &mut dyn FnMut(InputError)) -> Option<String> {
        let value = self.keys.get(key)?;
        if value.is_string() {
            return value.as_str().map(str::to_owned);
        }
        let place = format!("{}.{key}", self.place);
        mistaken(InputError::new(place, &**value, "a text in quotes", "write a text"));
        None
    }

    /// The body with a profile of a file of a folder, if there is one, and values of the lists.
    fn body(
        &self,
        name: Option<&str>,
        file: Option<&KnownFile>,
        varied: &BTreeMap<&'a str, Value>,
    ) -> Body<'a> {
        let mut keys: Map<String, Value> =
            self.keys.iter().map(|(k, v)| (k.clone(), v.clone().into())).collect();
        keys.retain(|key, _| !OF_THE_TABLE.contains(&key.as_str()));
        keys.extend(varied.iter().map(|(key, value)| ((*key).to_string(), value.clone())));
        let diameter = file.and_then(|file| file.diameter.as_ref());
        let diameter = diameter.filter(|_| self.list == "wheel" && !varied.contains_key(TAPE_DIAMETER));
        if let Some(KnownFile { file, .. }) = file {
            keys.insert("profile_file".into(), file.path.clone().into());
        }
        if let Some(diameter) = diameter {
            keys.insert(TAPE_DIAMETER.into(), diameter.clone());
        }
        let text = |key: &str| keys.get(key).and_then(Value::as_str);
        let measured =
            || Path::new(text("profile_file")?).file_stem().map(|stem| stem.to_string_lossy().into());
        let name = match (name, file) {
            (Some(name), Some(KnownFile { file, .. })) => format!("{name}/{}", file.name),
            (Some(name), None) => name.to_owned(),
            (None, Some(KnownFile { file, .. })) => file.name.clone(),
            (None, None) => text("profile")
                .map(str::to_owned)
                .or_else(measured)
                .unwrap_or_else(|| format!("{} {}", self.list, self.number)),
        };
        Body {
            name,
            entry: self.place.clone(),
            keys,
            varied: varied.clone(),
            of_folder: file.is_some(),
            diameter_of_file: diameter.is_some(),
            metadata: file.map(|file| Arc::clone(&file.metadata)).unwrap_or_default(),
        }
    }
}

/// Some names, of a long list the first and their number.
pub(super) fn listed(names: &[String]) -> String {
    const MOST: usize = 8;
    match names.len() {
        ..=MOST => names.join(", "),
        count => format!("{}, … {count} in all", names[..MOST].join(", ")),
    }
}

/// Every choice of a value for each key.
pub(super) fn product<'a, V: Clone + Into<Value> + 'a>(
    lists: impl Iterator<Item = (&'a str, &'a [V])>,
) -> Vec<BTreeMap<&'a str, Value>> {
    let mut choices = vec![BTreeMap::new()];
    for (key, values) in lists {
        choices = choices
            .into_iter()
            .flat_map(|choice| {
                values.iter().map(move |value| {
                    let mut choice = choice.clone();
                    choice.insert(key, value.clone().into());
                    choice
                })
            })
            .collect();
    }
    choices
}
