//! The keys that say which running surface a rail or wheel has.

use std::path::Path;
use std::sync::Arc;

use railspring_calibrate::error::InputError;
use railspring_calibrate::units::MILLIMETRE;

use super::MeasuredSurface;
use super::source::MISSING;

/// The keys of one body.
pub(super) struct SurfaceKeys<'a> {
    /// `rail` or `wheel`.
    pub section: &'static str,
    /// What the standard profile is, for messages.
    pub meaning: &'static str,
    pub profile: Option<&'a str>,
    pub file: Option<&'a str>,
    pub standard: Option<&'a str>,
    pub smoothing_mm: Option<f64>,
    pub aligned: Option<bool>,
}

impl SurfaceKeys<'_> {
    /// Name of the standard profile, and the measured one if there is one; `study` is the study's file.
    pub fn resolve(&self, study: &Path) -> Result<(String, Option<MeasuredSurface>), InputError> {
        let section = self.section;
        let key = |leaf: &str| format!("{section}.{leaf}");
        let missing = |leaf: &str, meaning: &str| {
            InputError::new(
                key(leaf),
                MISSING,
                "a text in quotes",
                format!("add this key to [{section}]: {meaning}"),
            )
        };
        let Some(file) = self.file else {
            let alone = [
                ("standard", self.standard.map(|name| format!("{name:?}"))),
                ("profile_smoothing_mm", self.smoothing_mm.map(|value| value.to_string())),
                ("profile_aligned", self.aligned.map(|value| value.to_string())),
            ];
            if let Some((leaf, Some(value))) = alone.into_iter().find(|(_, value)| value.is_some()) {
                return Err(InputError::new(
                    key(leaf),
                    value,
                    format!("{section}.profile_file beside it"),
                    "the key belongs to a measured profile: give its file, or remove the key",
                ));
            }
            let name = self.profile.ok_or_else(|| {
                missing("profile", &format!("{}; or give profile_file and standard", self.meaning))
            })?;
            return Ok((name.to_owned(), None));
        };
        if let Some(name) = self.profile {
            return Err(InputError::new(
                key("profile"),
                format!("{name:?}"),
                format!("either {section}.profile or {section}.profile_file"),
                "for a measured profile name the body with `standard`",
            ));
        }
        let standard =
            self.standard.ok_or_else(|| missing("standard", "what the measured profile is joined to"))?;
        let path = study.parent().unwrap_or(Path::new("")).join(file);
        let content = std::fs::read(&path).map_err(|cause| {
            InputError::new(
                key("profile_file"),
                format!("{file:?}"),
                format!("a readable file; {}: {cause}", path.display()),
                "give its path relative to the study",
            )
        })?;
        let measured = MeasuredSurface {
            file: file.to_owned(),
            path,
            content: Arc::from(content),
            smoothing: self.smoothing_mm.map(|mm| mm * MILLIMETRE),
            aligned: self.aligned.unwrap_or(false),
        };
        Ok((standard.to_owned(), Some(measured)))
    }
}

impl MeasuredSurface {
    /// What stands for the file in the hash of the study: its ending, which can tell the format, and its content.
    pub(super) fn fingerprint(&self) -> String {
        let ending = self.path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        format!("{}.{ending}", blake3::hash(&self.content).to_hex())
    }
}
