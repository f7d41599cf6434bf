//! The study: from a TOML file with units in its keys to checked values in SI
//! units, which is the only form the stages see.

pub mod document;

mod record;
mod check;
mod source;
mod settings;
mod explain;
mod collect;
mod content;
mod fields;
mod measured;
mod mesh_file;
mod case_notes;
mod resolve;
mod statics;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::solid::{Material, Materials};
use railspring_profiles::error::InputError;
use railspring_profiles::profile::rail_catalogue::RailDimensions;
use railspring_profiles::profile::wheels::Flange;
use railspring_profiles::profile_file::{ClosedSection, Finding, Smoothing};
use railspring_profiles::section::WheelBody;
use railspring_simulate::element::condensed::CondensedModel;
use railspring_simulate::element::published::MovingModel;
use railspring_simulate::solid::START_MODES;
use railspring_simulate::time::scenario::Scenario;
use railspring_simulate::time::steps::InnerSteps;
use serde::Serialize;
use serde::de::DeserializeOwned;
use source::Lines;
use toml::de::DeTable;

use crate::verify::Limits;

pub(crate) use check::nearest;
pub use document::{
    ContactElementKey, ElementKey, EnforcementKey, FieldKey, LawAcceptedKey, LawKey, OutputKeys,
    ReferenceKey, SlidingMatrixKey, SolidKeys, SolidLoadsKey, SpacingKey, StudyDocument, TransientKey,
    VerticalKey,
};
pub use explain::{KeyText, SectionText, explain, sections};
pub use fields::with_keys;
pub use record::{PairRecord, ResolvedKey};
pub use settings::Setting;
pub use source::{LocatedError, Mistakes, Place, Source};
pub use statics::{Statics, parts};

/// A checked study, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Short name; names the output folder.
    pub name: String,
    /// What the study is about.
    pub description: String,
    /// The rail.
    pub rail: Rail,
    /// The wheel.
    pub wheel: Wheel,
    /// Damping of both bodies, s ([`Material::damping`]): that of their materials here is zero, because statics have none.
    pub damping: f64,
    /// Where the wheel is on the track.
    pub track: Track,
    /// The solid meshes.
    pub mesh: MeshOptions,
    /// Formulation of the eight-node brick.
    pub element: ElementKey,
    /// Wanted error band of the law in use, relative.
    pub target_error: Option<f64>,
    /// Contact between the solids.
    pub contact: ContactSettings,
    /// Loads and reference of the law.
    pub calibration: CalibrationSettings,
    /// Lateral shifts of the laws by contact angle, m, ascending; `None` leaves them to the program.
    pub shifts: Option<Vec<f64>>,
    /// The simple model.
    pub simulation: SimulationSettings,
    /// The solid model in time.
    pub solid: SolidKeys,
    /// Load cases by name.
    pub scenarios: BTreeMap<String, StudyScenario>,
    /// Name of the load case whose histories have the plain file names.
    pub main_scenario: Option<String>,
    /// Limits of the verdict.
    pub limits: Limits,
    /// Files for other programs.
    pub output: OutputKeys,
    /// All keys with their values, defaults filled in; the keys of each section by name.
    pub resolved: Vec<ResolvedKey>,
    /// The file the study came from.
    pub source: Source,
}

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

/// A closed section in a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SectionFile {
    /// The file as the study names it.
    #[serde(skip)]
    pub file: String,
    /// The file as it was found; its ending can determine the format.
    #[serde(rename = "ending", serialize_with = "statics::ending")]
    pub path: PathBuf,
    /// Its content.
    #[serde(serialize_with = "statics::hashed")]
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
    #[serde(rename = "ending", serialize_with = "statics::ending")]
    pub path: PathBuf,
    /// Its content.
    #[serde(serialize_with = "statics::hashed")]
    pub content: Arc<[u8]>,
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
    #[serde(rename = "ending", serialize_with = "statics::ending")]
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

/// Contact between the solids.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ContactSettings {
    /// Where the contact lives.
    pub field: FieldKey,
    /// Exact or penalty.
    pub enforcement: EnforcementKey,
    /// Penalty stiffness, N/m.
    pub penalty: f64,
    /// Coulomb friction coefficient.
    pub friction: f64,
}

/// Loads and reference of the law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationSettings {
    /// The loads, N, ascending.
    pub loads: Vec<f64>,
    /// What the displacement of the law in use is measured against.
    pub reference: ReferenceKey,
    /// Whether there are laws against the held foot as well: the study wants them, or its reference is that.
    pub foot_held: bool,
    /// Whether the laws, those by contact angle too, get their error bands.
    pub error_band: bool,
    /// Preloads of the horizontal stiffness, N, ascending.
    pub horizontal_preloads: Vec<f64>,
}

/// The simple model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SimulationSettings {
    /// Which contact element it has, if the study says so: [`Study::element`].
    pub element: Option<ContactElementKey>,
    /// Which normal law drives the published element.
    pub law: LawKey,
    /// Horizontal stiffness, N/m; `None` takes the calibrated one.
    pub horizontal: Option<f64>,
    /// Number of beam elements of the rail.
    pub rail_elements: usize,
    /// Penalty stiffness between spline and nodes, N/m.
    pub contact_penalty: f64,
    /// Distance between the rail's surface nodes, m.
    pub rail_node_spacing: f64,
    /// Matrix of a sliding contact.
    pub sliding_matrix: SlidingMatrixKey,
    /// Steps of the integration within each time step of a scenario, where their number is given: [`SimulationSettings::steps`].
    pub inner_steps: Option<usize>,
    /// In which respects a law may be another's.
    pub law_accepted: Vec<LawAcceptedKey>,
}

impl SimulationSettings {
    /// Steps of the integration with a contact element.
    pub fn steps(&self, element: ContactElementKey) -> InnerSteps {
        match (self.inner_steps, element) {
            (Some(count), _) => InnerSteps::Equal(count),
            (None, ContactElementKey::Published) => MovingModel::STEPS,
            (None, ContactElementKey::Condensed) => CondensedModel::STEPS,
        }
    }
}

/// One load case of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyScenario {
    /// What happens.
    pub description: String,
    /// The load case itself.
    pub scenario: Scenario,
    /// Whether the solid model runs too.
    pub solid: bool,
    /// Times at which the report draws the contact positions, s.
    pub snapshots: Vec<f64>,
    /// What has to be known before it runs: values of the publication that it takes, the end of the rail, loads beyond the calibration.
    pub notes: Vec<String>,
}

/// Sections of the study file, in their order.
pub const SECTIONS: [&str; 12] = [
    "rail",
    "wheel",
    "track",
    "material",
    "mesh",
    "contact",
    "calibration",
    "simulation",
    "solid",
    "scenario",
    "verification",
    "output",
];

impl Study {
    /// What the statics of the pair are made from.
    pub fn statics(&self) -> Statics<'_> {
        Statics {
            rail: &self.rail,
            wheel: &self.wheel,
            track: self.track,
            mesh: &self.mesh,
            target_error: self.target_error,
            window_given: self.source.gives("mesh.window_half_length_mm"),
            element: self.element,
            contact: self.contact,
            calibration: &self.calibration,
            beam_elements: self.simulation.rail_elements,
        }
    }

    /// Whether there are to be laws by contact angle.
    pub fn wants_by_angle(&self) -> bool {
        self.shifts.as_ref().is_none_or(|shifts| !shifts.is_empty())
    }

    /// Contact element of the simple model.
    pub fn element(&self) -> ContactElementKey {
        let SimulationSettings { element, law, horizontal, .. } = &self.simulation;
        let of_own_springs = *law == LawKey::Calibrated && horizontal.is_none();
        element.unwrap_or(match self.wants_by_angle() && of_own_springs {
            true => ContactElementKey::Condensed,
            false => ContactElementKey::Published,
        })
    }

    /// Whether the condensed element is made: the simple model runs with it, or it stands beside the published one.
    pub fn wants_condensed(&self) -> bool {
        self.wants_by_angle() && !self.scenarios.is_empty()
    }

    /// Modes that the bodies are condensed with: those that reduced runs begin with, and the condensed element has; none where there is
    /// neither.
    pub fn modes(&self) -> usize {
        let reduced = self.solid.transient == TransientKey::Reduced;
        let runs = self.scenarios.values().any(|case| case.solid);
        match reduced && runs {
            true => self.solid.modes.unwrap_or(START_MODES),
            false if self.wants_condensed() => START_MODES,
            false => 0,
        }
    }

    /// Reads and checks a study file.
    ///
    /// # Errors
    /// [`Mistakes`] for a file that cannot be read, is not TOML, has unknown, missing or mistyped keys, or values
    /// out of range.
    pub fn read(path: &Path) -> Result<Self, Mistakes> {
        Self::read_with(path, &[])
    }

    /// Reads and checks a study file with `settings` in the place of its keys.
    ///
    /// # Errors
    /// As [`Study::read`]; of a key that a setting gives with the option in the place of the line.
    pub fn read_with(path: &Path, settings: &[Setting]) -> Result<Self, Mistakes> {
        Self::parse_with(path, &text_of(path, WHOLE)?, settings)
    }

    /// Checks the text of a study file; `path` is only named in messages.
    ///
    /// # Errors
    /// As [`Study::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, Mistakes> {
        Self::parse_with(path, text, &[])
    }

    /// Checks the text of a study file with `settings` in the place of its keys.
    ///
    /// # Errors
    /// As [`Study::read_with`].
    pub fn parse_with(path: &Path, text: &str, settings: &[Setting]) -> Result<Self, Mistakes> {
        let Parsed { document, source, findings, mistakes } =
            parsed(path, text, settings, WHOLE, study_schema())?;
        resolve::resolve(document, source, &findings, mistakes).map_err(Mistakes::sorted)
    }

    /// Whether a dotted key belongs to the study file, so that a message can name its line.
    pub fn owns(&self, key: &str) -> bool {
        let section = key.split(['.', '[']).next().unwrap_or_default();
        section == "name" || SECTIONS.contains(&section)
    }
}

/// The JSON schema of the study file.
pub fn schema() -> serde_json::Value {
    study_schema().clone()
}

fn study_schema() -> &'static serde_json::Value {
    static SCHEMA: OnceLock<serde_json::Value> = OnceLock::new();
    SCHEMA.get_or_init(schema_of::<StudyDocument>)
}

/// What messages call a study.
const WHOLE: &str = "study";

/// The JSON schema of a document.
pub(crate) fn schema_of<T: schemars::JsonSchema>() -> serde_json::Value {
    serde_json::to_value(schemars::schema_for!(T)).expect("a schema is plain JSON")
}

/// The text of a TOML file; `whole` is what messages call its content.
///
/// # Errors
/// [`Mistakes`] for a file that cannot be read or is no text.
pub(crate) fn text_of(path: &Path, whole: &str) -> Result<String, Mistakes> {
    content::read(path, whole).map_err(|error| Mistakes::of_file(path, error))
}

/// A document that was checked against its schema.
pub(crate) struct Parsed<T> {
    /// Its keys, without those that are wrong.
    pub document: T,
    /// Where they stand.
    pub source: Source,
    findings: Vec<check::Finding>,
    /// What is wrong.
    pub mistakes: Vec<LocatedError>,
}

/// The document of a TOML text with `settings` in the place of its keys, checked against its `schema`; `path` is only named in messages, and
/// `whole` is what they call it.
///
/// # Errors
/// [`Mistakes`] for a text that is not TOML, for settings that are none, and for keys without which there is no document.
pub(crate) fn parsed<T: DeserializeOwned>(
    path: &Path,
    text: &str,
    settings: &[Setting],
    whole: &str,
    schema: &serde_json::Value,
) -> Result<Parsed<T>, Mistakes> {
    let mut lines = Lines::of(text);
    let set = settings::texts(text.len(), settings, schema, &mut lines);
    let at = |offset: Option<usize>, error: InputError| LocatedError {
        path: path.to_path_buf(),
        place: offset.map(|offset| lines.place(offset)),
        error,
    };
    let syntax = |cause: toml::de::Error| {
        let said = cause.message().replace('\n', ", ");
        let key = format!("{whole} file");
        let error = InputError::new(key, said, "a TOML file", "correct the syntax on this line");
        at(cause.span().map(|span| span.start), error)
    };
    let (mut parsed, broken) = DeTable::parse_recoverable(text);
    if !broken.is_empty() {
        if let Some(foreign) = content::foreign(path, text) {
            return Err(Mistakes::of_file(path, foreign));
        }
        return Err(Mistakes::sorted(broken.into_iter().map(syntax).collect()));
    }
    for (setting, text) in settings.iter().zip(&set) {
        settings::put(parsed.get_mut(), setting, text)
            .map_err(|error| Mistakes::of_option(path, setting.option(), error))?;
    }
    let findings = check::check(parsed.get_ref(), schema, whole);
    let source = Source::new(path, text, &lines, parsed.get_ref());
    let mistakes: Vec<LocatedError> =
        findings.iter().map(|finding| at(finding.offset, finding.error.clone())).collect();
    // Without the keys that are wrong, the others can still be checked against each other.
    let wrong = findings.iter().filter_map(|finding| finding.key).collect();
    let sound = toml::de::Deserializer::from(check::without(parsed, &wrong));
    match T::deserialize(sound) {
        Ok(document) => Ok(Parsed { document, source, findings, mistakes }),
        Err(_) if !mistakes.is_empty() => Err(Mistakes::sorted(mistakes)),
        Err(cause) => Err(Mistakes::sorted(vec![syntax(cause)])),
    }
}

#[cfg(test)]
mod tests;
