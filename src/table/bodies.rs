//! The wheels and the rails of a table: what the entries of its lists stand for.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use railspring_profiles::error::InputError;
use serde_json::{Map, Value};

use super::document::Keys;

/// A wheel or a rail of the table.
pub(super) struct Body<'a> {
    pub name: String,
    /// Its entry, for messages: `wheel[0]`.
    pub entry: String,
    /// Its keys of a study.
    pub keys: Map<String, Value>,
    /// Those of them that take several values in its entry.
    pub varied: BTreeMap<&'a str, Value>,
}

/// The wheels or the rails of the entries of a list.
pub(super) fn bodies<'a>(
    table: &Path,
    list: &str,
    entries: &'a [Keys],
    mistaken: &mut dyn FnMut(InputError),
) -> Vec<Body<'a>> {
    let mut bodies: Vec<Body<'a>> = Vec::new();
    let mut names = BTreeSet::new();
    for (index, keys) in entries.iter().enumerate() {
        let entry = Entry { list, number: index + 1, place: format!("{list}[{index}]"), keys };
        let new = entry.bodies(table, mistaken);
        for name in new.iter().map(|body| body.name.clone()).collect::<BTreeSet<String>>() {
            if !names.insert(name.clone()) {
                let expected = format!("a name that no other {list} has");
                let remedy = "give one of them another `name`";
                mistaken(InputError::new(
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
    fn bodies(&self, table: &Path, mistaken: &mut dyn FnMut(InputError)) -> Vec<Body<'a>> {
        let [name, folder] = ["name", "folder"].map(|key| self.text(key, mistaken));
        let files: Vec<Option<(String, String)>> = match &folder {
            None => vec![None],
            Some(folder) => match files_of(table, folder) {
                Ok(files) => files.into_iter().map(Some).collect(),
                Err(mut mistake) => {
                    mistake.key = format!("{}.folder", self.place);
                    mistaken(mistake);
                    return Vec::new();
                }
            },
        };
        let lists =
            self.keys.iter().filter_map(|(key, value)| Some((key.as_str(), value.as_array()?.as_slice())));
        if let Some((key, _)) = lists.clone().find(|(_, values)| values.is_empty()) {
            let place = format!("{}.{key}", self.place);
            mistaken(InputError::new(place, "[]", "a value, or a list of values", "list the values"));
        }
        let choices = product(lists);
        let of_file = |file: &Option<(String, String)>| -> Vec<Body<'a>> {
            choices.iter().map(|varied| self.body(name.as_deref(), file.as_ref(), varied)).collect()
        };
        files.iter().flat_map(of_file).collect()
    }

    /// The text of a key, if it is there and is one.
    fn text(&self, key: &str, mistaken: &mut dyn FnMut(InputError)) -> Option<String> {
        let value = self.keys.get(key)?;
        if value.is_string() {
            return value.as_str().map(str::to_owned);
        }
        let place = format!("{}.{key}", self.place);
        mistaken(InputError::new(place, value, "a text in quotes", "write a text"));
        None
    }

    /// The body with a profile of a file (stem and path), if there is one, and values of the lists.
    fn body(
        &self,
        name: Option<&str>,
        file: Option<&(String, String)>,
        varied: &BTreeMap<&'a str, Value>,
    ) -> Body<'a> {
        let mut keys: Map<String, Value> = self.keys.iter().map(|(k, v)| (k.clone(), v.clone())).collect();
        keys.retain(|key, _| key != "name" && key != "folder");
        keys.extend(varied.iter().map(|(key, value)| ((*key).to_string(), value.clone())));
        if let Some((_, path)) = file {
            keys.insert("profile_file".into(), path.clone().into());
        }
        let text = |key: &str| keys.get(key).and_then(Value::as_str);
        let measured =
            || Path::new(text("profile_file")?).file_stem().map(|stem| stem.to_string_lossy().into());
        let name = match (name, file) {
            (Some(name), Some((stem, _))) => format!("{name}/{stem}"),
            (Some(name), None) => name.to_owned(),
            (None, Some((stem, _))) => stem.clone(),
            (None, None) => text("profile")
                .map(str::to_owned)
                .or_else(measured)
                .unwrap_or_else(|| format!("{} {}", self.list, self.number)),
        };
        Body { name, entry: self.place.clone(), keys, varied: varied.clone() }
    }
}

/// A file as the table names it.
pub(super) fn beside(table: &Path, file: &str) -> std::path::PathBuf {
    table.parent().unwrap_or(Path::new("")).join(file)
}

/// The files in a folder, by name: stem, and path as the table would name it.
fn files_of(table: &Path, folder: &str) -> Result<Vec<(String, String)>, InputError> {
    let path = beside(table, folder);
    let refused = |value: String| {
        let expected = format!("a folder with profile files; {}", path.display());
        InputError::new("folder", value, expected, "give its path relative to the table")
    };
    let entries = std::fs::read_dir(&path).map_err(|cause| refused(format!("{folder:?}: {cause}")))?;
    let mut files: Vec<(String, String)> = entries
        .filter_map(|entry| {
            let file = entry.ok()?;
            let name = file.file_name().into_string().ok()?;
            let stem = Path::new(&name).file_stem()?.to_string_lossy().into_owned();
            let is_one = file.path().is_file() && !name.starts_with('.');
            is_one.then(|| (stem, Path::new(folder).join(&name).to_string_lossy().into_owned()))
        })
        .collect();
    files.sort_by(|a, b| a.1.cmp(&b.1));
    if files.is_empty() {
        return Err(refused(format!("{folder:?}, which has no file")));
    }
    // files of one stem keep their endings
    let stems: Vec<String> = files.iter().map(|(stem, _)| stem.clone()).collect();
    for (stem, path) in &mut files {
        if stems.iter().filter(|other| *other == stem).count() > 1 {
            *stem = Path::new(path).file_name().unwrap_or_default().to_string_lossy().into_owned();
        }
    }
    Ok(files)
}

/// Every choice of a value for each key.
pub(super) fn product<'a>(
    lists: impl Iterator<Item = (&'a str, &'a [Value])>,
) -> Vec<BTreeMap<&'a str, Value>> {
    let mut choices = vec![BTreeMap::new()];
    for (key, values) in lists {
        choices = choices
            .into_iter()
            .flat_map(|choice| {
                values.iter().map(move |value| {
                    let mut choice = choice.clone();
                    choice.insert(key, value.clone());
                    choice
                })
            })
            .collect();
    }
    choices
}
