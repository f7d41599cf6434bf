//! A wheel and a rail as the command line names them: standards or profile files.

use std::path::Path;

use railspring_calibrate::error::{Error, InputError};
use railspring_calibrate::profile::rails::RAIL_NAMES;
use railspring_calibrate::profile::wheels::WHEEL_NAMES;
use railspring_calibrate::profile_file::{ProfileKind, ReadOptions, read};
use railspring_calibrate::profile_placement::{PlaceOptions, in_words, resembled};

use super::Failure;
use super::shapes::unknown_profile;
use crate::study::document::ProfileUnitKey;
use crate::study::{SECTIONS, Setting, Study};
use crate::template::{Body, Pair};

/// A pair, its study without load cases, and what has to be known about it.
pub(super) struct Named {
    pub pair: Pair,
    pub study: Study,
    pub notes: Vec<String>,
}

/// One body of the command line.
#[derive(Clone, Copy)]
pub(super) struct Given<'a> {
    kind: ProfileKind,
    /// What messages call it.
    argument: &'a str,
    text: &'a str,
}

impl<'a> Given<'a> {
    /// The wheel.
    pub fn wheel(argument: &'a str, text: &'a str) -> Self {
        Self { kind: ProfileKind::Wheel, argument, text }
    }

    /// The rail.
    pub fn rail(argument: &'a str, text: &'a str) -> Self {
        Self { kind: ProfileKind::Rail, argument, text }
    }

    fn section(&self) -> &'static str {
        self.kind.name()
    }

    /// The value of a key of its section that a setting gives.
    fn set(&self, settings: &[Setting], key: &str) -> Option<String> {
        let key = format!("{}.{key}", self.section());
        settings.iter().rev().find(|setting| setting.key() == key).and_then(Setting::toml)
    }

    /// The body, and for a file whose standard was not given what is said about it.
    fn body(&self, settings: &[Setting]) -> Result<(Body, Option<String>), InputError> {
        let names: &[&str] = if self.kind == ProfileKind::Rail { &RAIL_NAMES } else { &WHEEL_NAMES };
        if names.contains(&self.text) {
            return Ok((Body { standard: self.text.into(), file: None }, None));
        }
        let path = Path::new(self.text);
        if !path.exists() {
            return Err(unknown_profile(self.argument, self.text, names));
        }
        let on = |standard: &str| Body { standard: standard.into(), file: Some(path.to_path_buf()) };
        if let Some(standard) = self.set(settings, "standard") {
            return Ok((on(standard.trim_matches('"')), None));
        }
        let unit = self.set(settings, "profile_unit");
        let unit = unit.and_then(|unit| serde_json::from_str::<ProfileUnitKey>(&unit).ok());
        let mirror_y = self.set(settings, "profile_mirrored").map(|mirrored| mirrored == "true");
        let part = self.set(settings, "profile_part").map(|part| part.trim_matches('"').to_owned());
        let options = ReadOptions {
            kind: Some(self.kind),
            unit: unit.map(ProfileUnitKey::metres),
            mirror_y,
            mirror_z: None,
            part,
            tape_circle: None,
        };
        // what is wrong with the file is said of the study's keys, on any standard
        let Ok(profile) = read(path, &options) else { return Ok((on(names[0]), None)) };
        let near = resembled(&profile, Some(self.kind), PlaceOptions { side_known: mirror_y.is_some() });
        let option = format!("--set {}.standard=NAME", self.section());
        match near.first().filter(|first| first.placed.size.is_one()) {
            Some(first) => {
                let (section, text) = (self.section(), self.text);
                let taken =
                    format!("{section}: {text} is taken as measured on {}, the nearest of", first.name);
                Ok((on(first.name), Some(format!("{taken} {}; {option} for another", in_words(&near)))))
            }
            None => Err(InputError::new(
                self.argument,
                format!("{:?}", self.text),
                format!(
                    "a {} near a standard; it resembles {}",
                    self.section(),
                    match near.is_empty() {
                        true => "none".to_owned(),
                        false => in_words(&near),
                    }
                ),
                format!(
                    "name the standard whose body it has with {option}, and see `railspring profile place {}`",
                    self.text
                ),
            )),
        }
    }
}

/// The pair of the command line, with `settings` in the place of other keys of its study; its name is `name` or that of wheel and rail.
///
/// # Errors
/// Names and files that are none, and what a study with these keys cannot have, with the argument or option in the place of the line.
pub(super) fn named(
    name: Option<&str>,
    [wheel, rail]: [Given<'_>; 2],
    settings: &[Setting],
) -> Result<Named, Failure> {
    let (wheel_body, wheel_note) = wheel.body(settings)?;
    let (rail_body, rail_note) = rail.body(settings)?;
    let name = name.map_or_else(|| format!("{}-on-{}", plain(wheel.text), plain(rail.text)), str::to_owned);
    let pair = Pair { name, wheel: wheel_body, rail: rail_body };
    let option = |key: &str| match key.split('.').next() {
        Some("wheel") => format!("{} {}", wheel.argument, wheel.text),
        Some("rail") => format!("{} {}", rail.argument, rail.text),
        _ => "NAME".to_owned(),
    };
    let mut all = pair.settings(&option);
    all.extend_from_slice(settings);
    let study = Study::parse_with(Path::new(""), "", &all)?;
    Ok(Named { pair, study, notes: wheel_note.into_iter().chain(rail_note).collect() })
}

/// The name of a profile in that of a study.
fn plain(profile: &str) -> String {
    let stem = match Path::new(profile).exists() {
        true => Path::new(profile).file_stem().unwrap_or_default().to_string_lossy(),
        false => profile.into(),
    };
    let plain: String =
        stem.chars().map(|c| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect();
    plain.chars().take(30).collect()
}

/// What is wrong with keys that the command line gives, with how to give others.
pub(super) fn by_option(failure: Failure) -> Failure {
    const HOW: &str = "keys are given with `--set KEY=VALUE`";
    let with_how = |mut error: InputError| {
        error.remedy = format!("{}; {HOW}", error.remedy);
        error
    };
    match failure {
        Failure::Located(mut located) => {
            located.error = with_how(located.error);
            Failure::Located(located)
        }
        Failure::Plain(Error::Input(error)) if is_of_section(&error.key) => {
            Failure::Plain(with_how(error).into())
        }
        other => other,
    }
}

/// Whether a key is one of a section of the study; that of an error may also be a place in a file.
fn is_of_section(key: &str) -> bool {
    key.split_once('.').is_some_and(|(section, _)| SECTIONS.contains(&section))
}
