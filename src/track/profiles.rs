//! The profiles of a wheelset across the track: standards by their names, measured ones from files.

use std::path::Path;

use railspring_calibrate::section_analysis::rail_properties;
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile::rails::RAIL_NAMES;
use railspring_profiles::profile::wheels::{WHEEL_NAMES, wheel_profile};
use railspring_profiles::section::{RailSection, rail_section};

use super::excitation::Found;
use crate::results::bodies::sections::{self, repairs};
use crate::study::tables::FileRecord;
use crate::study::{MeasuredSurface, Setting, Study};

type Result<T> = std::result::Result<T, InputError>;

/// A rail with the key that names it, and how far its foot is below its line of shear centres, m.
#[derive(Clone)]
pub(super) struct AnalysedRail {
    pub key: String,
    pub name: String,
    pub section: RailSection,
    pub foot: f64,
}

/// What an error of a library expects.
pub(super) fn expected(error: Error) -> String {
    match error {
        Error::Input(error) => error.expected,
        other => other.to_string(),
    }
}

fn unusable(key: &str, name: &str, error: Error) -> InputError {
    InputError::new(
        key,
        format!("{name:?}"),
        expected(error),
        "`railspring profile list` has the standard profiles",
    )
}

/// What is wrong with a measured profile of a key.
fn broken(key: &str, file: &str, InputError { value, expected, .. }: InputError) -> InputError {
    let value = if value.contains(file) { value } else { format!("{file:?}, {value}") };
    let remedy = format!(
        "`railspring profile check {file}` shows the profile; `railspring profile convert` writes it in another unit, mirrored or placed"
    );
    InputError::new(key, value, expected, remedy)
}

/// What is wrong with the section of a measured profile of a key.
fn of_file(key: &str, file: &str, error: Error) -> InputError {
    match error {
        Error::Input(error) => broken(key, file, error),
        other => unusable(key, file, other),
    }
}

/// A study with a measured profile of one body, the keys of which are those of a profile alone.
fn study(folder: &Path, key: &str, body: &str, file: &str) -> Result<Study> {
    let other = if body == "rail" { ("wheel.profile", "S1002") } else { ("rail.profile", "60E1") };
    let quoted = serde_json::Value::from(file).to_string();
    let of_file = format!("{body}.profile_file");
    let keys = [("name", "profile"), (of_file.as_str(), quoted.as_str()), other];
    let settings: Vec<Setting> =
        keys.iter().filter_map(|(name, value)| Setting::new(key.into(), name, value)).collect();
    Study::parse_with(&folder.join("study.toml"), "", &settings).map_err(|mistakes| {
        let first = mistakes.all().first().map(|mistake| mistake.error.clone());
        let unknown = || InputError::new(key, format!("{file:?}"), "a measured profile", "check the file");
        first.map_or_else(unknown, |error| broken(key, file, error))
    })
}

/// Notes the file of a measured profile with what was done to it.
fn noted(
    found: &mut Found,
    (key, file): (&str, &str),
    measured: Option<&MeasuredSurface>,
    said: impl IntoIterator<Item = String>,
) {
    let blake3 = measured.map(|measured| measured.content.hash().to_owned()).unwrap_or_default();
    found.files.push(FileRecord { key: key.into(), file: file.into(), blake3 });
    found.notes.extend(said);
}

/// Whether a key names a file; a name that is neither a standard nor a file is left to the standards.
fn is_file(folder: &Path, name: &str, standards: &[&str]) -> bool {
    !standards.contains(&name) && folder.join(name).is_file()
}

/// The rail of a key: a standard one, or one of a measured running surface on the body of the standard that it resembles.
///
/// # Errors
/// [`InputError`] of the key for a name that is none, and for a file that is no profile of a rail.
pub(super) fn rail(folder: &Path, key: &str, name: &str, found: &mut Found) -> Result<AnalysedRail> {
    let section = if is_file(folder, name, &RAIL_NAMES) {
        let study = study(folder, key, "rail", name)?;
        let read = sections::rail(study.statics()).map_err(|error| of_file(key, name, error))?;
        noted(found, (key, name), study.rail.measured.as_ref(), repairs(&read.records));
        read.section
    } else {
        rail_section(name).map_err(|error| unusable(key, name, error))?
    };
    let foot = rail_properties(&section).map_err(|error| unusable(key, name, error))?.shear_centre_height;
    Ok(AnalysedRail { key: key.into(), name: name.into(), section, foot })
}

/// The running surface of the wheel of a key: a standard one, or a measured one with the flange of the standard that it resembles where it has none.
///
/// # Errors
/// As [`rail`].
pub(super) fn wheel(folder: &Path, key: &str, name: &str, found: &mut Found) -> Result<ProfileCurve> {
    if !is_file(folder, name, &WHEEL_NAMES) {
        return wheel_profile(name).map_err(|error| unusable(key, name, error));
    }
    let study = study(folder, key, "wheel", name)?;
    let read = sections::wheel(study.statics()).map_err(|error| of_file(key, name, error))?;
    noted(found, (key, name), study.wheel.measured.as_ref(), repairs(&read.records));
    Ok(read.section.running)
}
