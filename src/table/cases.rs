//! The cases of a table: each is a study, made of the keys of its wheel, its rail and all that is varied.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use railspring_profiles::error::InputError;
use railspring_profiles::units::KILONEWTON;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::bodies::{Bodies, product};
use super::document::{Keys, TableDocument};
use super::files::beside;
use super::metadata::{Metadata, TAPE_DIAMETER};
use super::pairs::{Pair, pairs};
use crate::hash::hash;
use crate::results::springs::make;
use crate::study::{LocatedError, Mistakes, Source, Study, parsed, parts, schema_of, text_of};

/// What messages call a table.
const WHOLE: &str = "table";
/// Wrong cases behind which no more are looked at: of thousands of files each would have the same mistake, and take its time.
const WRONG: usize = 20;
/// Sections of a study that the cases of a table have.
const SECTIONS: [&str; 8] =
    ["rail", "wheel", "track", "material", "mesh", "contact", "calibration", "uncertainty"];
/// Keys that a table sets itself, and with what.
const OF_THE_TABLE: [(&str, &str); 4] = [
    ("track.lateral_shift_mm", "the shifts of a table are `shifts_mm`"),
    ("calibration.shifts_mm", "the shifts of a table are `shifts_mm`"),
    ("calibration.elements", "a table has laws alone; `railspring fit` makes the elements of a pair"),
    ("mesh.target_error", "a table takes the meshes as they are; give `mesh.contact_element_mm`"),
];
/// Keys that say which profile a body has: those of a table's wheel or rail replace all of the base's.
const OF_THE_PROFILE: [&str; 3] = ["profile", "standard", "section_file"];

/// A pair of a wheel and a rail.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name of the wheel.
    pub wheel: String,
    /// Name of the rail.
    pub rail: String,
    /// Dotted keys that take several values in the table, and those of this case.
    pub varied: BTreeMap<String, Value>,
    /// The study of the pair; that of standard profiles in the place of files which cannot be read.
    pub study: Study,
    /// Why its places have no laws: what is wrong with a file of a folder.
    pub refused: Option<InputError>,
    /// What is known of the measurements of the wheel and the rail.
    pub metadata: [Arc<Metadata>; 2],
    /// Keys of the wheel, of the rail, and of the rest of what its springs depend on.
    pub parts: [String; 3],
    /// Its keys as they were given, in TOML.
    pub(super) text: String,
}

impl Case {
    /// Its keys as they were given.
    pub(super) fn keys(&self) -> Map<String, Value> {
        toml::from_str(&self.text).expect("the text was made of keys")
    }
}

/// A checked table.
#[derive(Debug, Clone)]
pub struct Table {
    /// Its keys.
    pub document: TableDocument,
    /// The cases, in the order of the wheels and then of the rails.
    pub cases: Vec<Case>,
    /// What there is to say of the files of its folders.
    pub notices: Vec<String>,
    /// The files that are read: its own, its base's, and those that their keys name.
    pub files: Vec<PathBuf>,
}

impl Table {
    /// Reads and checks a table.
    ///
    /// # Errors
    /// [`Mistakes`] for a file that cannot be read, is not TOML, has keys or values that it cannot have, or cases that are no studies.
    pub fn read(path: &Path) -> Result<Self, Mistakes> {
        Self::parse(path, &text_of(path, WHOLE)?)
    }

    /// Checks the text of a table; files are looked for beside `path`.
    ///
    /// # Errors
    /// As [`Table::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, Mistakes> {
        let parsed = parsed::<TableDocument>(path, text, &[], WHOLE, &schema_of::<TableDocument>())?;
        if !parsed.mistakes.is_empty() {
            return Err(Mistakes::sorted(parsed.mistakes));
        }
        let (document, source) = (parsed.document, parsed.source);
        let base = Base::of(path, document.base.as_deref(), &source)?;
        let mut mistakes = Vec::new();
        let mut mistaken = |mistake: InputError| mistakes.push(source.locate(mistake));
        of_the_lists(&document).into_iter().for_each(&mut mistaken);
        let bodies = Bodies::of(path, &document, &mut mistaken);
        let pairs = pairs(path, &document, &bodies, &mut mistaken);
        if !mistakes.is_empty() {
            return Err(Mistakes::sorted(mistakes));
        }
        let sweeps = product(document.sweep.iter().map(|(key, values)| (key.as_str(), values.as_slice())));
        let mut cases: Vec<Case> = Vec::new();
        let mut wrong = 0;
        for (wheel, rail) in pairs {
            for swept in &sweeps {
                let located =
                    |mistake: &LocatedError| relocated(mistake, &source, &base, [&wheel.entry, &rail.entry]);
                match case(path, &document, &base, (wheel, rail), swept, &located) {
                    Ok(mut case) => {
                        case.study.as_one_of_many(cases.last().map(|last| &last.study));
                        cases.push(case);
                    }
                    Err(found) => {
                        mistakes.extend(found.all().iter().map(located));
                        wrong += 1;
                    }
                }
            }
            if wrong > WRONG {
                break;
            }
        }
        if !mistakes.is_empty() {
            return Err(Mistakes::sorted(mistakes));
        }
        // of thousands of cases the room for more is tens of megabytes
        cases.shrink_to_fit();
        let named = bodies.wheels.iter().chain(&bodies.rails).flat_map(|body| body.files(path));
        let given = source.files().chain(base.source.files()).map(Path::to_path_buf);
        let files = given.chain(named).collect();
        let notices = bodies.notices;
        Ok(Self { document, cases, notices, files })
    }
}

/// The study that all cases begin with.
#[derive(Default)]
struct Base {
    keys: Map<String, Value>,
    source: Source,
}

impl Base {
    fn of(table: &Path, file: Option<&str>, source: &Source) -> Result<Self, Mistakes> {
        let Some(file) = file else { return Ok(Self::default()) };
        let path = beside(table, file);
        if !path.is_file() {
            let expected = format!("a study file; {} is none", path.display());
            let mistake =
                InputError::new("base", format!("{file:?}"), expected, "give its path relative to the table");
            return Err(Mistakes::sorted(vec![source.locate(mistake)]));
        }
        let text = text_of(&path, "study")?;
        // with all its keys as they are; what is wrong with them is said of the first case
        Study::parse(&path, &text)?;
        let (keys, source) = parsed_plainly::<Keys>(&path, &text)?;
        let mut keys: Map<String, Value> = keys.into_iter().map(|(key, value)| (key, value.into())).collect();
        keys.retain(|section, _| SECTIONS.contains(&section.as_str()));
        for body in ["rail", "wheel"] {
            let Some(keys) = keys.get_mut(body).and_then(Value::as_object_mut) else { continue };
            for (key, value) in keys {
                if let (true, Some(file_of_base)) = (key.ends_with("_file"), value.as_str()) {
                    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
                    *value = folder.join(file_of_base).to_string_lossy().into_owned().into();
                }
            }
        }
        Ok(Self { keys, source })
    }
}

/// The keys of a TOML text as they stand, and where.
fn parsed_plainly<T: DeserializeOwned>(path: &Path, text: &str) -> Result<(T, Source), Mistakes> {
    let anything = Value::Object(Map::from_iter([("additionalProperties".to_string(), Value::Bool(true))]));
    parsed::<T>(path, text, &[], "study", &anything).map(|parsed| (parsed.document, parsed.source))
}

/// What is wrong with lists and with keys that a table does not take.
fn of_the_lists(document: &TableDocument) -> Vec<InputError> {
    let mut mistakes = Vec::new();
    for (key, list) in [("shifts_mm", &document.shifts_mm), ("stiffness_at_kn", &document.stiffness_at_kn)] {
        if let Some(pair) = list.windows(2).find(|pair| pair[1] <= pair[0]) {
            let value = format!("{}, {}", pair[0], pair[1]);
            mistakes.push(InputError::new(
                key,
                value,
                "ascending values without repetition",
                "sort the list",
            ));
        }
    }
    if let [first, second] = document.sides[..]
        && first == second
    {
        let value = format!("{:?} twice", first.name());
        mistakes.push(InputError::new("sides", value, "different sides", "leave one of them out"));
    }
    let given = document.study.iter().flat_map(|(section, keys)| {
        let keys = keys.keys().map(move |key| (format!("study.{section}.{key}"), format!("{section}.{key}")));
        keys.chain([(format!("study.{section}"), section.clone())])
    });
    let swept = document.sweep.keys().map(|key| (format!("sweep.{key}"), key.clone()));
    for (place, key) in given.chain(swept) {
        let section = key.split('.').next().unwrap_or_default();
        if !SECTIONS.contains(&section) {
            let expected = format!("a key of the sections {}", SECTIONS.join(", "));
            mistakes.push(InputError::new(
                place,
                section,
                expected,
                "the springs do not depend on it: remove it",
            ));
        } else if let Some((_, remedy)) = OF_THE_TABLE.iter().find(|(known, _)| *known == key) {
            mistakes.push(InputError::new(place, "given", "a key that a table leaves to its study", *remedy));
        }
    }
    for (key, values) in &document.sweep {
        let place = format!("sweep.{key}");
        if values.is_empty() {
            mistakes.push(InputError::new(
                place,
                "[]",
                "at least one value",
                "list the values, or remove the key",
            ));
        } else if key.split('.').count() != 2 {
            let expected = "a key with its section, such as `\"contact.friction\"`";
            mistakes.push(InputError::new(
                place,
                "given",
                expected,
                "write section and key with a dot between them",
            ));
        }
    }
    mistakes
}

/// The case of a wheel on a rail with values of the swept keys; `located` makes a mistake in its study one of the table.
fn case(
    path: &Path,
    document: &TableDocument,
    base: &Base,
    (wheel, rail): Pair<'_, '_>,
    swept: &BTreeMap<&str, Value>,
    located: &dyn Fn(&LocatedError) -> LocatedError,
) -> Result<Case, Mistakes> {
    let mut keys = base.keys.clone();
    for (name, common) in &document.study {
        section(&mut keys, name)
            .extend(common.iter().map(|(key, value)| (key.clone(), value.clone().into())));
    }
    section(&mut keys, "calibration").insert("shifts_mm".into(), Value::Array(Vec::new()));
    for (name, body) in [("wheel", wheel), ("rail", rail)] {
        let section = section(&mut keys, name);
        if body.keys.keys().any(|key| is_of_the_profile(key)) {
            section.retain(|key, _| !is_of_the_profile(key));
        }
        section.extend(body.keys.clone());
    }
    for (key, value) in swept {
        let (name, leaf) = key.split_once('.').expect("a key with its section");
        section(&mut keys, name).insert(leaf.into(), value.clone());
    }
    keys.insert("name".into(), document.name.clone().into());
    let text = text_of_keys(&keys);
    let (mut study, refused) = match Study::parse(path, &text) {
        Ok(study) => (study, None),
        Err(found) => {
            let Some(stand_in) = stand_in(keys, &found, (wheel, rail)) else { return Err(found) };
            let reason = located(&found.all()[0]).error;
            (Study::parse(path, &text_of_keys(&stand_in))?, Some(reason))
        }
    };
    let swept_diameter = swept.contains_key(format!("wheel.{TAPE_DIAMETER}").as_str());
    study.wheel.diameter_measured = wheel.diameter_of_file && !swept_diameter;
    let of_a_case = |mistake: InputError| Mistakes::sorted(vec![study.source.locate(mistake)]);
    if let Err(railspring_profiles::error::Error::Input(mistake)) = make::check_friction(study.statics()) {
        return Err(of_a_case(mistake));
    }
    in_range(document, &study).map_err(of_a_case)?;
    let mut varied: BTreeMap<String, Value> =
        swept.iter().map(|(key, value)| ((*key).to_string(), value.clone())).collect();
    for (section, body) in [("wheel", wheel), ("rail", rail)] {
        varied.extend(body.varied.iter().map(|(key, value)| (format!("{section}.{key}"), value.clone())));
    }
    let mut parts = parts(&study.statics());
    if let Some(reason) = &refused {
        // not those of the bodies that stand in
        parts[..2].iter_mut().for_each(|part| *part = hash(format!("{part} {reason}").as_bytes()));
    }
    Ok(Case {
        wheel: wheel.name.clone(),
        rail: rail.name.clone(),
        varied,
        study,
        refused,
        metadata: [Arc::clone(&wheel.metadata), Arc::clone(&rail.metadata)],
        parts,
        text,
    })
}

/// The keys of a case with standard profiles in the place of files of folders, if nothing else is wrong than these files.
fn stand_in(
    mut keys: Map<String, Value>,
    found: &Mistakes,
    (wheel, rail): Pair<'_, '_>,
) -> Option<Map<String, Value>> {
    let is_of_a_file = |section: &str, mistake: &LocatedError| {
        let leaf = mistake.error.key.strip_prefix(section).and_then(|rest| rest.strip_prefix('.'));
        leaf.is_some_and(|leaf| ["profile_file", "profile_part"].contains(&leaf))
    };
    let mut left = found.all().len();
    for (name, body, usual) in [("wheel", wheel, "S1002"), ("rail", rail, "60E1")] {
        let count = found.all().iter().filter(|mistake| is_of_a_file(name, mistake)).count();
        if count == 0 || !body.of_folder {
            continue;
        }
        left -= count;
        let section = section(&mut keys, name);
        // beside a file alone
        section.retain(|key, _| !key.starts_with("profile_") && (name, key.as_str()) != ("rail", "body"));
        let standard = section.remove("standard").unwrap_or_else(|| usual.into());
        if !section.contains_key("section_file") {
            section.remove("tape_circle_mm");
            section.insert("profile".into(), standard);
        }
    }
    (left == 0).then_some(keys)
}

/// The text of a study with given keys.
pub(super) fn text_of_keys(keys: &impl Serialize) -> String {
    toml::to_string(keys).expect("keys of TOML files are TOML")
}

/// The keys of a section, which is made if there is none.
fn section<'k>(keys: &'k mut Map<String, Value>, name: &str) -> &'k mut Map<String, Value> {
    let section = keys.entry(name).or_insert_with(|| Map::new().into());
    section.as_object_mut().expect("a section of a study")
}

fn is_of_the_profile(key: &str) -> bool {
    OF_THE_PROFILE.contains(&key) || key.starts_with("profile_")
}

/// Refuses loads of the columns that the loads of the study do not reach.
fn in_range(document: &TableDocument, study: &Study) -> Result<(), InputError> {
    let loads = &study.calibration.loads;
    let range = [loads[0], loads[loads.len() - 1]].map(|load| load / KILONEWTON);
    match document.stiffness_at_kn.iter().find(|load| !(range[0]..=range[1]).contains(*load)) {
        None => Ok(()),
        Some(load) => Err(InputError::new(
            "stiffness_at_kn",
            load,
            format!("loads from {} to {} kN, those of the calibration", range[0], range[1]),
            "leave it out, or set `load_min_kn` and `load_max_kn` in [study.calibration]",
        )),
    }
}

/// A mistake in the study of a case, as one of the table.
fn relocated(mistake: &LocatedError, table: &Source, base: &Base, entries: [&String; 2]) -> LocatedError {
    let mut error = mistake.error.clone();
    let key = error.key.clone();
    let swept = format!("sweep.{key}");
    let common = format!("study.{key}");
    let of_body = ["wheel", "rail"].iter().zip(entries).find_map(|(section, entry)| {
        key.strip_prefix(section)
            .and_then(|rest| rest.strip_prefix('.'))
            .map(|rest| format!("{entry}.{rest}"))
    });
    let in_entry = of_body.filter(|place| table.gives(place) || !base.source.gives(&key));
    if !key.contains('.') && table.gives(&key) {
        // its own key, such as the name
    } else if table.gives(&swept) {
        error.key = swept;
    } else if let Some(place) = in_entry {
        error.key = place;
    } else if table.gives(&common) {
        error.key = common;
    } else if base.source.gives(&key) {
        let place = base.source.place(&key);
        return LocatedError { path: base.source.path().to_path_buf(), place, error };
    }
    let place = table.place(&error.key);
    LocatedError { path: table.path().to_path_buf(), place, error }
}
