//! Profiles from files: Simpack, MiniProf, text and CSV, lines and arcs, DXF, slices of CONTACT; what is wrong with them, and how it is repaired.
//!
//! [`read`] gives the points of a file in the profile frame (y to the field side, z down, m), each with its
//! line. [`prepare`] checks and repairs them and makes the curve. [`write()`] writes a profile in any of the
//! formats. Nothing is changed silently: every stage adds [`Finding`]s.

mod finding;
mod format;
mod options;
mod text;
mod measured;
mod part;
mod raw;
mod rows;
mod blocks;
mod several;
mod columns;
mod miniprof;
mod simpack;
mod slices;
mod dxf;
mod loops;
mod check;
mod kinks;
mod shape;
mod heads;
mod sentinels;
mod orient;
mod scatter;
mod wavelength;
mod corners;
mod smooth;
mod local_wavelength;
mod replicates;
mod drawn;
mod recognition;
mod entries;
mod section;
mod prepare;

use std::path::{Path, PathBuf};

use self::part::{Part, part_field};
use self::recognition::{recognised, toml_section};
use crate::error::{InputError, Result};
use crate::input;

pub use crate::profile::{ProfileKind, Sketch};
pub use entries::header_entries;
pub use finding::{Action, Finding, FindingKind};
pub use format::{ProfileFormat, format_of_ending};
pub use measured::{MeasuredPoint, MeasuredProfile};
pub use options::ReadOptions;
pub use prepare::{PrepareOptions, Prepared, Smoothing, prepare, repaired};
pub use recognition::format_of;
pub use replicates::{REPLICATES, standard_uncertainty};
pub use scatter::{Scatter, scatter};
pub use section::{ClosedSection, parse_rail_section, parse_wheel_section, sketch_section};
pub use slices::{SliceFile, slice_files};
pub use smooth::{Smoothed, smooth};
pub use text::{LARGEST_FILE, decode};

/// Reads a profile file.
///
/// # Errors
/// [`InputError`] with the file's line and column for a file that cannot be read or understood; with the file's
/// name where it stays open whether it is a wheel or a rail, or what its unit is.
pub fn read(path: &Path, options: &ReadOptions) -> Result<MeasuredProfile> {
    read_drawn(path, options, &mut Sketch::default())
}

/// As [`read`]; with the line of a drawing or of a table of lines and arcs that is refused because it steps, and the place.
pub fn read_sketched(path: &Path, options: &ReadOptions) -> (Sketch, Result<MeasuredProfile>) {
    let mut sketch = Sketch::default();
    let profile = read_drawn(path, options, &mut sketch);
    (sketch, profile)
}

fn read_drawn(path: &Path, options: &ReadOptions, sketch: &mut Sketch) -> Result<MeasuredProfile> {
    let name = path.display().to_string();
    let bytes = input::read(path, LARGEST_FILE)
        .map_err(|cause| InputError::new(&name, cause, "a readable profile file", "check the path"))?;
    let source = ProfileSource::of(path, bytes, options.part.as_deref(), options.kind)?;
    let options = ReadOptions { kind: options.kind.or(source.kind), part: source.part, ..options.clone() };
    let mut profile = parse_drawn(&source.path.display().to_string(), &source.content, &options, sketch)?;
    profile.findings.splice(0..0, source.findings);
    Ok(profile)
}

/// The file that a profile is in: the given one, or of a list of slices the chosen one.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileSource {
    /// The file.
    pub path: PathBuf,
    /// Its content.
    pub content: Vec<u8>,
    /// The part of it that is wanted.
    pub part: Option<String>,
    /// What a list of slices says that they are.
    pub kind: Option<ProfileKind>,
    /// What is said about the choice of a slice.
    pub findings: Vec<Finding>,
}

impl ProfileSource {
    /// The file with the profile, where `content` is that of the file at `path` and `part` the slice or the part of
    /// the file that is wanted.
    ///
    /// # Errors
    /// [`InputError`] with file and line for a list of slices that is not understood, that has no such slice, or
    /// whose slice cannot be read.
    pub fn of(path: &Path, content: Vec<u8>, part: Option<&str>, kind: Option<ProfileKind>) -> Result<Self> {
        let Some(listed) = slices::kind(path) else {
            let (path, part) = (path.to_owned(), part.map(str::to_owned));
            return Ok(Self { path, content, part, kind: None, findings: Vec::new() });
        };
        let wanted = Part { name: part, field: part_field(kind) };
        let (path, content, finding) = slices::choose(path, &content, listed, &wanted)?;
        Ok(Self { path, content, part: None, kind: Some(listed), findings: vec![finding] })
    }
}

/// As [`read`], from the content of a file. `name` is used in messages, and its ending tells the format where the
/// content does not.
///
/// # Errors
/// As [`read`].
///
/// ```
/// use railspring_profiles::profile_file::{ProfileKind, ReadOptions, parse};
/// let text = "y_mm;z_mm\n-36;14,3\n-26;2,3\n-10,2;0,2\n0;0\n10,2;0,2\n26;2,3\n36;14,3\n";
/// let rail = parse("head.csv", text.as_bytes(), &ReadOptions::default())?;
/// assert_eq!(rail.kind, ProfileKind::Rail);
/// assert_eq!((rail.points[0].point.x, rail.points[0].line), (-0.036, 2));
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn parse(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<MeasuredProfile> {
    parse_drawn(name, bytes, options, &mut Sketch::default())
}

fn parse_drawn(
    name: &str,
    bytes: &[u8],
    options: &ReadOptions,
    sketch: &mut Sketch,
) -> Result<MeasuredProfile> {
    dxf::refuse_binary(name, bytes)?;
    let text = text::decode(name, bytes)?;
    let ending = Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if let Some((line, shown)) = toml_section(&text) {
        return Err(text::error_on(
            name,
            line,
            shown,
            "the rows of a profile",
            "this is a TOML file such as a study: give the profile file that it names",
        ));
    }
    if slices::kind(Path::new(name)).is_some() {
        let remedy = "its slices are files of their own: read it by its path, with the slice that is wanted";
        return Err(text::error_on(name, 1, &ending, "the points of a profile", remedy));
    }
    let part = Part { name: options.part.as_deref(), field: part_field(options.kind) };
    let raw = match recognised(&text, &ending) {
        Some(ProfileFormat::LinesAndArcs) => return drawn::read(name, &text, options, sketch),
        Some(ProfileFormat::Dxf) => dxf::parse(name, &text, &part, sketch),
        Some(ProfileFormat::Simpack) => simpack::parse(name, &text, &ending, &part),
        Some(ProfileFormat::MiniProf) => miniprof::parse(name, &text, &ending, &part),
        Some(ProfileFormat::Text | ProfileFormat::Csv) | None => columns::parse(name, &text, &ending, &part),
    };
    orient::orient(name, raw?, options)
}

/// A profile as a file of the format: points in the profile frame, m.
///
/// Simpack, text and DXF files hold millimetres; MiniProf files have the axes that this format has by convention.
pub fn write(format: ProfileFormat, kind: ProfileKind, points: &[MeasuredPoint], comment: &str) -> String {
    let comment: String =
        comment.chars().map(|c| if c.is_control() || c == '\'' { ' ' } else { c }).collect();
    match format {
        ProfileFormat::Simpack => simpack::write(kind, points, &comment),
        ProfileFormat::MiniProf => miniprof::write(kind, points, &comment),
        ProfileFormat::Text => columns::write(kind, points, &comment, "\t"),
        ProfileFormat::Csv | ProfileFormat::LinesAndArcs => columns::write(kind, points, &comment, ","),
        ProfileFormat::Dxf => dxf::write(points, &comment),
    }
}

#[cfg(test)]
mod tests;
