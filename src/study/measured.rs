//! The keys that say which running surface a rail or wheel has.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use railspring_profiles::error::{Error, InputError};
use railspring_profiles::input;
use railspring_profiles::profile_file::{
    LARGEST_FILE, ProfileKind, ProfileSource, ReadOptions, Smoothing, parse,
};
use railspring_profiles::profile_placement::{PlaceOptions, in_words, resembled};
use railspring_profiles::units::MILLIMETRE;

use super::check::nearest;
use super::collect::Collector;
use super::document::{SurfaceKeys, UnitKey};
use super::pair::{MeasuredSurface, SectionFile};
use super::source::{MISSING, Source};

/// The keys of one body.
pub(super) struct Surface<'a> {
    /// `rail` or `wheel`.
    pub section: &'static str,
    /// The standard profiles.
    pub names: &'static [&'static str],
    /// What the standard profile is, for messages.
    pub meaning: &'static str,
    pub keys: &'a SurfaceKeys,
}

impl Surface<'_> {
    /// Name of the standard profile, and the measured one if there is one; of a measured one the standard may be left open.
    pub fn resolve(
        &self,
        source: &Source,
        collector: &mut Collector,
    ) -> Option<(Option<String>, Option<MeasuredSurface>)> {
        let section = self.section;
        let key = |leaf: &str| format!("{section}.{leaf}");
        let missing = |leaf: &str, meaning: &str| {
            InputError::new(
                key(leaf),
                MISSING,
                format!("a text in quotes, one of {}", self.names.join(", ")),
                format!("add this key to [{section}]: {meaning}"),
            )
        };
        let reads = [key("profile"), key("profile_file"), key("standard")];
        let reads = reads.each_ref().map(String::as_str);
        let Some(file) = self.keys.profile_file.as_deref() else {
            // Beside a section of its own, that a standard is too much has been said.
            let standard = self.keys.standard.as_deref().filter(|_| self.keys.section_file.is_none());
            let alone = [
                ("standard", standard.map(|name| format!("{name:?}"))),
                ("profile_part", self.keys.profile_part.as_deref().map(|part| format!("{part:?}"))),
                ("profile_smoothing_mm", self.keys.profile_smoothing_mm.map(|value| value.to_string())),
                ("profile_aligned", self.keys.profile_aligned.map(|value| value.to_string())),
                ("profile_unit", self.keys.profile_unit.map(|unit| format!("{:?}", unit.name()))),
                ("profile_mirrored", self.keys.profile_mirrored.map(|value| value.to_string())),
            ];
            for (leaf, value) in alone.into_iter().filter_map(|(leaf, value)| Some((leaf, value?))) {
                let mistake = InputError::new(
                    key(leaf),
                    value,
                    format!("{section}.profile_file beside it"),
                    "the key belongs to a measured profile: give its file, or remove the key",
                );
                collector.add(&reads, mistake);
            }
            if self.keys.section_file.is_some() {
                return Some((None, None));
            }
            let name = self
                .keys
                .profile
                .as_deref()
                .ok_or_else(|| missing("profile", &format!("{}; or give profile_file", self.meaning)));
            let name = collector.take(&reads, name)?;
            return collector.take(&reads, self.known("profile", name)).map(|name| (Some(name), None));
        };
        if let (Some(name), None) = (self.keys.profile.as_deref(), self.keys.section_file.as_deref()) {
            let mistake = InputError::new(
                key("profile"),
                format!("{name:?}"),
                format!("either {section}.profile or {section}.profile_file"),
                "for a measured profile name the body with `standard`",
            );
            collector.add(&reads, mistake);
        }
        let (path, content) = self.read("profile_file", file, source);
        let standard = self.keys.standard.as_deref().filter(|_| self.keys.section_file.is_none());
        let standard = standard.map(|name| self.known("standard", name)).transpose();
        let standard = standard
            .map_err(|mistake| self.with_nearest(mistake, &path, content.as_deref().unwrap_or_default()));
        let standard = collector.take(&reads, standard)?;
        let content = collector.take(&[&key("profile_file")], content);
        let chosen = ProfileSource::of(&path, content?, self.keys.profile_part.as_deref(), Some(self.kind()))
            .map_err(|error| {
                let (leaf, value) = self
                    .keys
                    .profile_part
                    .as_deref()
                    .map_or(("profile_file", file), |part| ("profile_part", part));
                let (expected, remedy) = match error {
                    Error::Input(error) => {
                        let error = source.with_keys(error);
                        (format!("{}; {} = {}", error.expected, error.key, error.value), error.remedy)
                    }
                    other => (other.to_string(), "check the file".into()),
                };
                InputError::new(key(leaf), format!("{value:?}"), expected, remedy)
            });
        let chosen = collector.take(&[&key("profile_file"), &key("profile_part")], chosen)?;
        let measured = MeasuredSurface {
            file: file.to_owned(),
            path: chosen.path,
            content: chosen.content.into(),
            part: chosen.part,
            findings: chosen.findings,
            smoothing: Smoothing::of(self.keys.profile_smoothing_mm.map(|mm| mm * MILLIMETRE)),
            aligned: self.keys.profile_aligned,
            unit: self.keys.profile_unit.map(UnitKey::metres),
            mirrored: self.keys.profile_mirrored,
        };
        Some((standard, Some(measured)))
    }

    /// Rail or wheel.
    fn kind(&self) -> ProfileKind {
        if self.section == "rail" { ProfileKind::Rail } else { ProfileKind::Wheel }
    }

    /// A mistake about the standard, with those that the measured profile resembles, if it does.
    fn with_nearest(&self, mistake: InputError, path: &Path, content: &[u8]) -> InputError {
        let kind = Some(self.kind());
        let read = || {
            let chosen =
                ProfileSource::of(path, content.to_vec(), self.keys.profile_part.as_deref(), kind).ok()?;
            let options = ReadOptions {
                kind,
                unit: self.keys.profile_unit.map(UnitKey::metres),
                mirror_y: self.keys.profile_mirrored,
                part: chosen.part,
                ..ReadOptions::default()
            };
            parse(&chosen.path.display().to_string(), &chosen.content, &options).ok()
        };
        let near = read().map_or_else(Vec::new, |profile| {
            resembled(&profile, kind, PlaceOptions { side_known: self.keys.profile_mirrored.is_some() })
        });
        if near.is_empty() {
            return mistake;
        }
        let file = self.keys.profile_file.as_deref().unwrap_or_default();
        let remedy = format!("{}; nearest to {file:?} are {}", mistake.remedy, in_words(&near));
        InputError { remedy, ..mistake }
    }

    /// The body's own section, which takes the place of a standard one.
    pub fn own_section(&self, file: &str, source: &Source, collector: &mut Collector) -> Option<SectionFile> {
        let key = |leaf: &str| format!("{}.{leaf}", self.section);
        for (leaf, name) in
            [("profile", self.keys.profile.as_deref()), ("standard", self.keys.standard.as_deref())]
        {
            let Some(name) = name else { continue };
            let mistake = InputError::new(
                key(leaf),
                format!("{name:?}"),
                format!("either {} or {}", key(leaf), key("section_file")),
                "the file is the whole section: remove one of the two keys",
            );
            collector.add(&[&key("section_file")], mistake);
        }
        let (path, content) = self.read("section_file", file, source);
        let content = collector.take(&[&key("section_file")], content)?;
        Some(SectionFile { file: file.to_owned(), path, content: Arc::from(content), read: None })
    }

    /// A file that a key names relative to the study: where it lies, and its content.
    fn read(&self, leaf: &str, file: &str, source: &Source) -> (PathBuf, Result<Vec<u8>, InputError>) {
        let path = source.path().parent().unwrap_or(Path::new("")).join(file);
        let content = input::read(&path, LARGEST_FILE).map_err(|cause| {
            InputError::new(
                format!("{}.{leaf}", self.section),
                format!("{file:?}"),
                format!("a readable file; {}: {cause}", path.display()),
                "give its path relative to the study",
            )
        });
        (path, content)
    }

    /// The name, if it is one of the standard profiles.
    fn known(&self, leaf: &str, name: &str) -> Result<String, InputError> {
        if self.names.contains(&name) {
            return Ok(name.to_owned());
        }
        let remedy = match nearest(name, self.names.iter().copied()) {
            Some(near) => format!("did you mean {near:?}? `railspring profile list` describes them"),
            None => format!(
                "choose a standard; `railspring profile list` describes them. A profile of your own is a file: \
                 `{}.profile_file`",
                self.section
            ),
        };
        Err(InputError::new(
            format!("{}.{leaf}", self.section),
            format!("{name:?}"),
            format!("one of {}", self.names.join(", ")),
            remedy,
        ))
    }
}
