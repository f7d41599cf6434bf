//! Formats of profile files, and the endings of their names.

use std::fmt;
use std::path::Path;

use crate::error::{InputError, Result};
use crate::profile::ProfileKind;

/// Format of a profile file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProfileFormat {
    /// Simpack `.prr` and `.prw`.
    Simpack,
    /// MiniProf `.ban` and `.whl`.
    MiniProf,
    /// Columns separated by blanks or tabs.
    Text,
    /// Columns separated by commas or semicolons.
    Csv,
    /// Drawings, as ASCII DXF.
    Dxf,
    /// A table of lines and arcs ([`crate::profile::lines_and_arcs`]); written as CSV columns of points.
    LinesAndArcs,
}

impl fmt::Display for ProfileFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Simpack => "Simpack",
            Self::MiniProf => "MiniProf",
            Self::Text => "text columns",
            Self::Csv => "CSV",
            Self::Dxf => "DXF",
            Self::LinesAndArcs => "lines and arcs",
        })
    }
}

/// The format, and where the ending says so the kind, of a file to be written.
///
/// # Errors
/// [`InputError`] for an unknown ending.
pub fn format_of_ending(path: &Path) -> Result<(ProfileFormat, Option<ProfileKind>)> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    Ok(match ending.as_str() {
        "prr" => (ProfileFormat::Simpack, Some(ProfileKind::Rail)),
        "prw" => (ProfileFormat::Simpack, Some(ProfileKind::Wheel)),
        "ban" => (ProfileFormat::MiniProf, Some(ProfileKind::Rail)),
        "whl" => (ProfileFormat::MiniProf, Some(ProfileKind::Wheel)),
        "txt" | "dat" => (ProfileFormat::Text, None),
        "csv" => (ProfileFormat::Csv, None),
        "dxf" => (ProfileFormat::Dxf, None),
        _ => {
            return InputError::refuse(
                path.display().to_string(),
                format!("ending \"{ending}\""),
                "one of .prr, .prw, .ban, .whl, .txt, .dat, .csv, .dxf",
                "choose an ending that names the format",
            );
        }
    })
}
