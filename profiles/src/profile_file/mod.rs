//! Profiles from files: Simpack, MiniProf, text and CSV, lines and arcs, DXF, slices of CONTACT; what is wrong with them, and how it is repaired.
//!
//! [`read`] gives the points of a file in the profile frame (y to the field side, z down, m), each with its
//! line. [`prepare`] checks and repairs them and makes the curve. [`write()`] writes a profile in any of the
//! formats. Nothing is changed silently: every stage adds [`Finding`]s.

mod finding;
mod text;
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
mod section;
mod prepare;

use std::fmt;
use std::path::{Path, PathBuf};

use nalgebra::Point2;

use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::input;
use crate::profile::TAPE_CIRCLE_FROM_FLANGE_BACK;
use crate::profile::lines_and_arcs::{self, LinesAndArcs};

pub use crate::profile::{ProfileKind, Sketch};
pub use finding::{Action, Finding, FindingKind};
pub use prepare::{PrepareOptions, Prepared, Smoothing, prepare, repaired};
pub use replicates::{REPLICATES, standard_uncertainty};
pub use scatter::{Scatter, scatter};
pub use section::{ClosedSection, parse_rail_section, parse_wheel_section, sketch_section};
pub use smooth::{Smoothed, smooth};

/// Largest profile file that is read, bytes.
pub const LARGEST_FILE: u64 = 256 << 20;
/// Most points of a profile that are read.
const MOST_POINTS: usize = 5_000_000;

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

/// What the caller knows about a file; the reader determines what is `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Wheel or rail.
    pub kind: Option<ProfileKind>,
    /// Length of the file's unit, m; replaces what the file says.
    pub unit: Option<f64>,
    /// Whether y counts towards the track centre in the file, as in that of a left rail or wheel. What the header of
    /// a Simpack file says comes first: `true` turns over what it leaves.
    pub mirror_y: Option<bool>,
    /// Whether z counts upwards in the file; not for Simpack files, whose header says so.
    pub mirror_z: Option<bool>,
    /// Name or number of the part of the file that is the profile, where a file has several: a slice, a layer of a
    /// drawing, a block of points.
    pub part: Option<String>,
    /// Distance of a wheel's tape circle from its flange back, m, for files that count y from there; `None` is 70 mm.
    pub tape_circle: Option<f64>,
}

impl ReadOptions {
    /// Distance of a wheel's tape circle from its flange back, m.
    fn tape_circle_distance(&self) -> f64 {
        self.tape_circle.unwrap_or(TAPE_CIRCLE_FROM_FLANGE_BACK)
    }
}

/// A point of a profile with the place it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// Position in the profile frame, m.
    pub point: Point2<f64>,
    /// Line of the file, counted from one.
    pub line: usize,
    /// Weight in smoothing, 1 unless the file gives another.
    pub weight: f64,
}

/// A profile as its file gives it, in the profile frame: y to the field side, z down, in order of increasing y.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredProfile {
    /// Name of the file.
    pub name: String,
    /// Format of the file.
    pub format: ProfileFormat,
    /// Wheel or rail.
    pub kind: ProfileKind,
    /// The points; a wheel's run from the flange to the field side, a rail's from the gauge to the field side.
    pub points: Vec<MeasuredPoint>,
    /// What the reader found and did.
    pub findings: Vec<Finding>,
    /// The lines and arcs of a file of that format, of which `points` are samples.
    pub drawn: Option<LinesAndArcs>,
    /// Whether a groove beside the head, which was set aside, told which side of a rail is that of the gauge.
    pub side_by_groove: bool,
}

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
        return Err(text::error_at(
            name,
            line,
            1,
            shown,
            "the rows of a profile",
            "this is a TOML file such as a study: give the profile file that it names",
        ));
    }
    if slices::kind(Path::new(name)).is_some() {
        let remedy = "its slices are files of their own: read it by its path, with the slice that is wanted";
        return Err(text::error_at(name, 1, 1, &ending, "the points of a profile", remedy));
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

/// The format that headings or the ending of the file's name show; none for what can only be columns.
fn recognised(text: &str, ending: &str) -> Option<ProfileFormat> {
    if lines_and_arcs::recognises(text) {
        Some(ProfileFormat::LinesAndArcs)
    } else if dxf::recognises(text, ending) {
        Some(ProfileFormat::Dxf)
    } else if simpack::recognises(text, ending) {
        Some(ProfileFormat::Simpack)
    } else if miniprof::recognises(text, ending) {
        Some(ProfileFormat::MiniProf)
    } else {
        None
    }
}

/// The format of a profile file, if the content, or in some cases the ending of `name`, shows that it is one: headings
/// of Simpack or MiniProf, or nearly nothing but rows of numbers.
pub fn format_of(name: &str, bytes: &[u8]) -> Option<ProfileFormat> {
    /// Lines that are looked at.
    const ENOUGH: usize = 2000;
    /// Share of rows of numbers that makes a file one of columns.
    const MOST: f64 = 0.8;
    let text = text::decode(name, bytes).ok()?;
    let ending = Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if toml_section(&text).is_some() {
        return None;
    }
    let recognised = recognised(&text, &ending);
    if recognised.is_some() {
        return recognised;
    }
    let filled =
        || text::lines(&text).map(|(_, line)| line).filter(|line| !line.trim().is_empty()).take(ENOUGH);
    let rows = filled().filter(|line| text::begins_like_a_number(line) && !line.contains('=')).count();
    if rows < 4 || (rows as f64) < MOST * filled().count() as f64 {
        return None;
    }
    let separated = filled().any(|line| line.contains([',', ';']));
    Some(if separated { ProfileFormat::Csv } else { ProfileFormat::Text })
}

/// The first heading of a TOML file, `[word]` on a line, with its line; `None` for what is no TOML file.
fn toml_section(text: &str) -> Option<(usize, &str)> {
    /// Lines that are looked at.
    const ENOUGH: usize = 2000;
    let word =
        |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || "_-.".contains(c));
    let lines = || text::lines(text).map(|(n, line)| (n, line.trim())).take(ENOUGH);
    let heading = |line: &str| {
        line.strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(']'))
            .is_some_and(|name| word(name) && name.starts_with(|c: char| c.is_ascii_alphabetic()))
    };
    let assignment = |line: &str| line.split_once(" = ").is_some_and(|(key, _)| word(key.trim()));
    lines().any(|(_, line)| assignment(line)).then(|| lines().find(|(_, line)| heading(line))).flatten()
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
            return Err(InputError::new(
                path.display().to_string(),
                format!("ending \"{ending}\""),
                "one of .prr, .prw, .ban, .whl, .txt, .dat, .csv, .dxf",
                "choose an ending that names the format",
            )
            .into());
        }
    })
}

/// The part of a file that is wanted.
struct Part<'a> {
    name: Option<&'a str>,
    /// What it is called in messages.
    field: String,
}

fn part_field(kind: Option<ProfileKind>) -> String {
    match kind {
        Some(ProfileKind::Rail) => format!("`{}`", InputField::RailProfilePart),
        Some(ProfileKind::Wheel) => format!("`{}`", InputField::WheelProfilePart),
        None => format!("`{}`", InputField::ProfilePart),
    }
}

/// What the axes of a file are known to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Convention {
    /// Stated by the file: nothing is turned over.
    Stated,
    /// MiniProf's: a rail's y counts towards the track centre, z upwards; a wheel's y from the flange back.
    MiniProf,
    /// Unknown: y to the field side is assumed, the rest inferred from the shape.
    Free,
}

/// Rows of a file as they stand there, or as its header says.
struct Raw {
    format: ProfileFormat,
    /// What the file itself says.
    kind: Option<ProfileKind>,
    convention: Convention,
    /// Length of the unit, m, and the line that says so (0: the format's own unit).
    unit: Option<(f64, usize)>,
    points: Vec<MeasuredPoint>,
    findings: Vec<Finding>,
}

/// Adds a point.
///
/// # Errors
/// More points than a profile can have.
fn push(name: &str, points: &mut Vec<MeasuredPoint>, y: f64, z: f64, line: usize, weight: f64) -> Result<()> {
    if points.len() >= MOST_POINTS {
        return Err(text::error_at(
            name,
            line,
            1,
            "",
            format!("at most {MOST_POINTS} points"),
            "give a single profile, thinned out",
        ));
    }
    points.push(MeasuredPoint { point: Point2::new(y, z), line, weight });
    Ok(())
}

#[cfg(test)]
mod tests;
