//! Rail and wheel of a study in SI units, their place on the track, and their files.
//!
//! A file counts by its content and its ending, wherever it lies and whatever it is called.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use railspring_calibrate::solid::{Material, Materials};
use railspring_profiles::profile::rail_catalogue::RailDimensions;
use railspring_profiles::profile::wheels::Flange;
use railspring_profiles::profile_file::{ClosedSection, Finding, Smoothing};
use railspring_profiles::section::WheelBody;
use serde::{Serialize, Serializer};

use super::file_content::FileContent;
use crate::hash::hash;

/// The rail.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rail {
    /// Name of the standard section; `None` for one of the study's own, and of a measured head where its standard is to be found.
    pub profile: Option<String>,
    /// The body under a measured head of no standard, if the study gives one.
    pub body: Option<RailBody>,
    /// The study's own section, in the place of a standard one.
    pub section: Option<SectionFile>,
    /// The measured head that takes the place of the standard's.
    pub measured: Option<MeasuredSurface>,
    /// Inclination as a slope.
    pub inclination: f64,
    /// Whether it holds whatever a measured head says: the study gives it, or the rail is no measured one.
    pub inclination_given: bool,
    /// Length of the modelled piece, m.
    pub length: f64,
    /// The mesh that takes the place of the tool's own.
    pub mesh: Option<MeshFile>,
    /// Its material, which its section and its beam have, and of a mesh the groups without another.
    pub material: Material,
    /// The materials of its mesh's groups, or its own alone.
    pub materials: Materials,
}

impl Rail {
    /// Name of its section: that of the standard, or the file of the study's own as the study names it.
    pub fn name(&self) -> Option<&str> {
        name(self.section.as_ref(), self.profile.as_deref())
    }
}

/// The body under a measured head.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum RailBody {
    /// That of a standard.
    Standard(String),
    /// Drawn from dimensions: what they are called, and the dimensions.
    Drawn(String, RailDimensions),
}

/// The wheel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Wheel {
    /// Name of the standard running profile; `None` beside a section of the study's own, and of a measured one where its standard is to be found.
    pub profile: Option<String>,
    /// The study's own section, in the place of a standard profile on a generic body.
    pub section: Option<SectionFile>,
    /// The measured profile that takes the place of the standard's.
    pub measured: Option<MeasuredSurface>,
    /// Distance of the tape circle from the flange back in files that count from there, m; `None` takes that of the standard.
    pub tape_circle: Option<f64>,
    /// Diameter at the tape circle, m.
    pub tape_diameter: f64,
    /// The same of the new wheel, where the study gives it, m: what was turned off since is missing from the rim.
    #[serde(skip)]
    pub new_diameter: Option<f64>,
    /// Whether that was measured with the profile, so that each wheel of a fleet has another one.
    #[serde(skip)]
    pub diameter_measured: bool,
    /// Size of the flange.
    pub flange: Flange,
    /// Rim, web and hub.
    pub body: WheelBody,
    /// Whether they are known: the study gives anything of them, or the wheel is no measured one.
    pub body_given: bool,
    /// The mesh that takes the place of the tool's own.
    pub mesh: Option<MeshFile>,
    /// Its material, which its axle has, and of a mesh the groups without another.
    pub material: Material,
    /// The materials of its mesh's groups, or its own alone.
    pub materials: Materials,
}

impl Wheel {
    /// Name of its section: that of the standard, or the file of the study's own as the study names it.
    pub fn name(&self) -> Option<&str> {
        name(self.section.as_ref(), self.profile.as_deref())
    }

    /// The wheel with another diameter at its tape circle, m: turned to it where the study gives that of the new wheel.
    pub fn with_tape_diameter(self, tape_diameter: f64) -> Self {
        let turned = self.new_diameter.map_or(0.0, |_| 0.5 * (tape_diameter - self.tape_diameter));
        let body = WheelBody { rim_depth: self.body.rim_depth + turned, ..self.body };
        Self { tape_diameter, body, ..self }
    }
}

fn name<'a>(own: Option<&'a SectionFile>, standard: Option<&'a str>) -> Option<&'a str> {
    own.map(|own| own.file.as_str()).or(standard)
}

/// A closed section in a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SectionFile {
    /// The file as the study names it.
    #[serde(skip)]
    pub file: String,
    /// The file as it was found; its ending can determine the format.
    #[serde(rename = "ending", serialize_with = "ending")]
    pub path: PathBuf,
    /// Its content.
    #[serde(serialize_with = "hashed")]
    pub content: Arc<[u8]>,
    /// The section in it, where it was read already to see whether the file holds one: of a wheel with a tape circle 70 mm from the flange back.
    #[serde(skip)]
    pub read: Option<Arc<ClosedSection>>,
}

/// A measured profile: the content of its file, and how it is prepared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredSurface {
    /// The file as the study names it.
    #[serde(skip)]
    pub file: String,
    /// The file as it was found, of slices the chosen one; its ending can determine the format.
    #[serde(rename = "ending", serialize_with = "ending")]
    pub path: PathBuf,
    /// Its content.
    pub content: FileContent,
    /// Name or number of the part of it that is the profile.
    pub part: Option<String>,
    /// What is said about the choice of a slice.
    #[serde(skip)]
    pub findings: Vec<Finding>,
    /// What is done about the scatter of its points.
    pub smoothing: Smoothing,
    /// Whether it is placed on the standard first; `None` takes it as it stands unless it is evidently misplaced.
    pub aligned: Option<bool>,
    /// Length of the file's unit, m; `None` leaves it to the file.
    pub unit: Option<f64>,
    /// Whether y counts towards the track centre in the file; `None` leaves it to the file.
    pub mirrored: Option<bool>,
}

/// A mesh in a file, and what its groups are called.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshFile {
    /// The file as the study names it.
    #[serde(skip)]
    pub file: String,
    /// The file as it was found; its ending determines the format.
    #[serde(rename = "ending", serialize_with = "ending")]
    pub path: PathBuf,
    /// Hash of its content.
    pub hash: String,
    /// Unit of its coordinates, m.
    pub unit: f64,
    /// Name of the running surface.
    pub contact: String,
    /// Name of the held nodes: at the foot of a rail, at the bore of a wheel.
    pub held: String,
    /// Names of its groups of hexahedra, in the order of the body's materials; none where all is of one.
    pub groups: Vec<String>,
}

/// Where the wheel is on the track; lengths in m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Track {
    /// Track gauge.
    pub gauge: f64,
    /// Depth below the top of the rail at which the gauge is measured.
    pub gauge_height: f64,
    /// Distance between the flange backs.
    pub flange_back: f64,
    /// Lateral shift towards the modelled rail.
    pub lateral_shift: f64,
}

/// A content by its hash.
fn hashed<S: Serializer>(content: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&hash(content))
}

/// A file by the ending of its name.
fn ending<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    serializer.serialize_str(&ending)
}
