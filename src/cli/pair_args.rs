//! A wheel and a rail as the command line names them: standards or profile files.

use std::path::Path;
use std::sync::Arc;

use railspring_profiles::error::{Error, InputError};
use railspring_profiles::input;
use railspring_profiles::profile::rails::RAIL_NAMES;
use railspring_profiles::profile::wheels::WHEEL_NAMES;
use railspring_profiles::profile_file::{ClosedSection, LARGEST_FILE, ProfileKind, sketch_section};

use super::failure::Failure;
use super::shapes::unknown_profile;
use crate::study::{SECTIONS, SectionFile, Setting, Study};
use crate::template::{Body, Pair};

/// A pair, and its study without load cases.
pub(super) struct Named {
    pub pair: Pair,
    pub study: Study,
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

    /// The body: a standard, or a file, whose standard is found where none is set; with the section in a file of one.
    fn body(&self) -> Result<(Body, Option<Read>), InputError> {
        let names: &[&str] = if self.kind == ProfileKind::Rail { &RAIL_NAMES } else { &WHEEL_NAMES };
        if names.contains(&self.text) {
            return Ok((Body::Standard(self.text.into()), None));
        }
        let path = Path::new(self.text);
        if !path.exists() {
            return Err(unknown_profile(self.argument, self.text, names));
        }
        let read = closed_section(path, self.kind);
        let path = path.to_path_buf();
        Ok((if read.is_some() { Body::Section(path) } else { Body::File(path) }, read))
    }
}

/// The content of a file, and the closed section in it.
struct Read {
    content: Vec<u8>,
    section: ClosedSection,
}

impl Read {
    /// Leaves the section to the study that names the file, unless its settings name another one.
    fn leave_to(self, file: &mut SectionFile) {
        if *file.content == *self.content {
            file.read = Some(Arc::new(self.section));
        }
    }
}

/// The closed section of a body, if a file holds one and no running surface alone.
fn closed_section(path: &Path, kind: ProfileKind) -> Option<Read> {
    let content = input::read(path, LARGEST_FILE).ok()?;
    let section = sketch_section(&path.display().to_string(), &content, kind, None).1.ok()?;
    Some(Read { content, section })
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
    let ((wheel_body, wheel_read), (rail_body, rail_read)) = (wheel.body()?, rail.body()?);
    let name = name.map_or_else(|| format!("{}-on-{}", plain(wheel.text), plain(rail.text)), str::to_owned);
    let pair = Pair { name, wheel: wheel_body, rail: rail_body };
    let option = |key: &str| match key.split('.').next() {
        Some("wheel") => format!("{} {}", wheel.argument, wheel.text),
        Some("rail") => format!("{} {}", rail.argument, rail.text),
        _ => "NAME".to_owned(),
    };
    let mut all = pair.settings(&option);
    all.extend_from_slice(settings);
    let mut study = Study::parse_with(Path::new(""), "", &all)?;
    // What was read to see what the files hold is not read again.
    for (file, read) in [(&mut study.wheel.section, wheel_read), (&mut study.rail.section, rail_read)] {
        if let Some((file, read)) = file.as_mut().zip(read) {
            read.leave_to(file);
        }
    }
    Ok(Named { pair, study })
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

/// What is wrong with keys that the command line gives, with how to give others: by the `option` that gives keys.
pub(super) fn by_option(failure: Failure, option: &str) -> Failure {
    let with_how = |mut error: InputError| {
        error.remedy = format!("{}; keys are given with `{option} KEY=VALUE`", error.remedy);
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
