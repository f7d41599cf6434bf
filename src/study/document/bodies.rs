//! The keys of the two bodies.

use std::collections::BTreeMap;

use railspring_profiles::field::InputField;
use railspring_profiles::units::MILLIMETRE;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::material::{BodyMaterialKeys, GroupMaterialKeys};

/// The profile of a rail or wheel: a standard, a section file, or a measured profile.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct SurfaceKeys {
    /// Name of the standard section of the rail, for instance `60E1` or `UIC60`, or of the running profile of the wheel, for instance `S1002`. Give this, `section_file` or `profile_file`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1), extend("x-field" = "{section}_name"))]
    pub profile: Option<String>,
    /// File of a closed section of your own (lines and arcs, DXF, columns of points), relative to the study, in the place of a standard one; that of a wheel lies on one side of its axle, with its bore. A `profile_file` beside it is joined to it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub section_file: Option<String>,
    /// File of a measured profile (Simpack, MiniProf, text or CSV, lines and arcs, DXF, slices of CONTACT), relative to the study.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1), extend("x-field" = "{section}_profile"))]
    pub profile_file: Option<String>,
    /// Part of the profile file that is the profile, where it has several: the name or number of a slice (CONTACT's `.slcs` and `.slcw`) or of a block of points, the layer of a drawing. Its message lists the parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1), extend("x-field" = "{section}_profile_part"))]
    pub profile_part: Option<String>,
    /// Name of the standard that the measured profile is joined to; none beside `section_file`. Left out, the standard that fits within 0.2 mm where wear leaves the profile alone. Where none does, a rail has a body like the nearest one, moved to the measured head; a wheel has the profile by itself, with a flange and a chamfer like those of the nearest one where it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1), extend("x-field" = "{section}_name"))]
    pub standard: Option<String>,
    /// Smoothing of the measured profile: waves of this length are halved, mm; with 0 the points stay where they are. Left out, their scatter is measured, and smoothed as much as it takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 20.0))]
    pub profile_smoothing_mm: Option<f64>,
    /// Unit of the profile file; left out, what the file says or what its size shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-field" = "{section}_profile_unit"))]
    pub profile_unit: Option<UnitKey>,
    /// Whether y counts towards the track centre in the profile file, as in that of a left rail or wheel: it is then turned over. Left out, what the file says, its format has by convention, or the wheel's flange shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile_mirrored: Option<bool>,
    /// Whether the measured profile is placed on the standard, or taken as it stands. Placed, its origin,
    /// rotation and side are those of `railspring profile place`. As it stands, the origin of a rail is at
    /// the unworn top, on the axis, and the rail is not inclined; that of a wheel is at the tape circle, and
    /// the wheel is not turned. Left out, the profile is taken as it stands, and placed if it evidently lies
    /// elsewhere. Of no standard, a rail has its highest point as its top and is turned upright if its two
    /// sides are inclined; a wheel is moved to its flange back.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-field" = "{section}_aligned"))]
    pub profile_aligned: Option<bool>,
}

/// A mesh from a file in the place of the tool's own, and the material of the body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct MeshFileKeys {
    /// File of a mesh of hexahedra that takes the place of the tool's own (Gmsh, Abaqus, VTU, all that meshio reads), relative to the study. The rail as it lies in the track: x along it from the middle, y from the track centre to the field side, z down from the highest point of the inclined rail. The whole wheel: y along the axle to the field side, from the tape circle; z down, the contact below the axle; x along the track. The profile stays the study's: it carries the gap, the mesh the stiffness.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1), extend("x-field" = "{section}_mesh"))]
    pub mesh_file: Option<String>,
    /// Unit of the mesh file's coordinates; left out, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-field" = "{section}_mesh_unit"))]
    pub mesh_unit: Option<UnitKey>,
    /// Name of the running surface in the mesh file: a Gmsh physical surface, an Abaqus node set, or a mask of point or cell data. Its nodes form a swept grid on the study's profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1), extend("x-field" = "{section}_contact_surface"))]
    pub contact_surface: Option<String>,
    /// Name of the held nodes in the mesh file, a group as `contact_surface`: those at the foot of the rail, or at the bore of the wheel, which follow the hub.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1), extend("x-field" = "{section}_held_nodes"))]
    pub held_nodes: Option<String>,
    /// Materials of the mesh by the names of its groups of hexahedra (Gmsh physical volumes, Abaqus element sets, masks of cells): `[rail.materials.NAME]`, `[wheel.materials.NAME]`, for pads under a rail, the rubber of a resilient wheel, the cast iron of its brake discs. Every hexahedron is in one of them. The section of the rail has the rail's material, which is that of its beam; one group of a wheel is under the running surface. Left out, all has the material of the body.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(extend("x-field" = "{section}_materials"))]
    pub materials: BTreeMap<String, GroupMaterialKeys>,
    /// The material of the body, of the rail's beam or the wheel's axle, and of the groups of its mesh that have none of their own.
    #[serde(skip_serializing_if = "BodyMaterialKeys::is_empty")]
    pub material: BodyMaterialKeys,
}

/// The rail: its section, how it is laid and how long a piece is modelled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RailKeys {
    /// Its profile.
    #[serde(flatten)]
    pub surface: SurfaceKeys,
    /// The body under a measured head of no `standard`: the name of a standard or of a catalogue's rail (`136RE`, `R65`, `CHN60`), or the dimensions of one. Left out, that of the nearest standard.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-field" = InputField::RailBody.name()))]
    pub body: Option<RailBodyKey>,
    /// Inclination towards the track centre, as a ratio `"1:40"` or as a slope `0.025`. Left out, 1:40; of a measured head that its file evidently has inclined, as it is there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-field" = InputField::Inclination.name()))]
    pub inclination: Option<Inclination>,
    /// Length of the modelled piece, m; both its ends are held.
    #[serde(default = "default_rail_length")]
    #[schemars(range(min = 0.1, max = 20.0), extend("x-field" = InputField::RailLength.name()))]
    pub length_m: f64,
    /// Its mesh and material.
    #[serde(flatten)]
    pub mesh: MeshFileKeys,
}

/// A rail inclination.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Inclination {
    /// Slope, for instance `0.025`.
    Slope(#[schemars(range(min = -0.2, max = 0.2))] f64),
    /// Ratio, for instance `"1:40"`.
    Ratio(String),
}

impl Inclination {
    /// That of most tracks.
    pub fn usual() -> Self {
        Self::Ratio("1:40".into())
    }
}

/// The body under a measured head.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum RailBodyKey {
    /// Name of a standard or of a catalogue's rail.
    Name(#[schemars(length(min = 1))] String),
    /// Dimensions of a section.
    Dimensions(RailDimensionKeys),
}

/// The dimensions of a flat-bottom rail that catalogues give, mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RailDimensionKeys {
    /// Height, mm.
    pub height_mm: f64,
    /// Width of the foot, mm.
    pub foot_mm: f64,
    /// Width of the head 14 mm below its top, mm.
    pub head_mm: f64,
    /// Least thickness of the web, mm.
    pub web_mm: f64,
    /// Depth of the head, from its top to where the slopes of its underside meet on the axis, mm; left out, 0.28 of the height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head_depth_mm: Option<f64>,
    /// Depth of the foot, from where the slopes of its top meet on the axis to its bottom, mm; left out, 0.175 of the height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub foot_depth_mm: Option<f64>,
}

fn default_rail_length() -> f64 {
    0.555
}

/// The wheel: its running profile, its flange and its generic body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WheelKeys {
    /// Its profile.
    #[serde(flatten)]
    pub surface: SurfaceKeys,
    /// Distance of the tape circle from the flange back, mm, for a profile or section file that counts from there: MiniProf, columns, drawings. Left out, that of the standard or of the section file beside a profile file (70; 72.231 for the wheels of APTA), and 70 for a section file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 50.0, max = 100.0), extend("x-field" = InputField::TapeCircle.name()))]
    pub tape_circle_mm: Option<f64>,
    /// Diameter at the tape circle, m.
    #[serde(default = "default_tape_diameter")]
    #[schemars(range(min = 0.3, max = 1.5), extend("x-field" = InputField::TapeDiameter.name()))]
    pub tape_diameter_m: f64,
    /// Diameter at the tape circle when the wheel was new, m: what was turned off since is missing from the rim, whose depth is that of the new wheel then. Left out, the wheel is new.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.3, max = 1.5))]
    pub new_diameter_m: Option<f64>,
    /// Height of the flange, mm: 28, 30 or 32.
    #[serde(default = "default_flange_height")]
    #[schemars(range(min = 28.0, max = 32.0), extend("x-field" = InputField::FlangeHeight.name()))]
    pub flange_height_mm: f64,
    /// Thickness of the flange, mm; 28.5 to 33, S1002 up to 32.5.
    #[serde(default = "default_flange_thickness")]
    #[schemars(range(min = 28.5, max = 33.0), extend("x-field" = InputField::FlangeThickness.name()))]
    pub flange_thickness_mm: f64,
    /// Course of the web.
    #[serde(default)]
    pub body: WebKey,
    /// Diameter of the bore, mm.
    #[serde(default = "default_bore")]
    #[schemars(range(min = 40.0, max = 400.0), extend("x-field" = InputField::BoreDiameter.name()))]
    pub bore_mm: f64,
    /// Diameter of the hub, mm.
    #[serde(default = "default_hub_diameter")]
    #[schemars(range(min = 60.0, max = 800.0), extend("x-field" = InputField::HubDiameter.name()))]
    pub hub_diameter_mm: f64,
    /// Depth of the rim below the tread at the tape circle, mm; with `new_diameter_m` that of the new wheel.
    #[serde(default = "default_rim_depth")]
    #[schemars(range(min = 30.0, max = 150.0), extend("x-field" = InputField::RimDepth.name()))]
    pub rim_depth_mm: f64,
    /// Thickness of the web where it is thinnest, mm, the rest of it in proportion; left out, 24, and 22 of an S web.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 8.0, max = 60.0), extend("x-field" = InputField::WebThickness.name()))]
    pub web_thickness_mm: Option<f64>,
    /// Middle of a conical web at the surface of the hub, mm from the tape circle to the field side; with `body = "conical-web"`.
    #[serde(default = "default_web_hub_y")]
    #[schemars(range(min = -80.0, max = 80.0), extend("x-field" = InputField::WebHubY.name()))]
    pub web_hub_y_mm: f64,
    /// Middle of a conical web at the inner side of the rim, mm from the tape circle to the field side; with `body = "conical-web"`.
    #[serde(default = "default_web_rim_y")]
    #[schemars(range(min = -80.0, max = 80.0), extend("x-field" = InputField::WebRimY.name()))]
    pub web_rim_y_mm: f64,
    /// Its mesh and material.
    #[serde(flatten)]
    pub mesh: MeshFileKeys,
}

/// Course of a wheel's web.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WebKey {
    /// Straight.
    #[default]
    StraightWeb,
    /// S-shaped.
    SWeb,
    /// Straight, but inclined: from `web_hub_y_mm` to `web_rim_y_mm`.
    ConicalWeb,
}

fn default_tape_diameter() -> f64 {
    0.858
}

fn default_flange_height() -> f64 {
    28.0
}

fn default_flange_thickness() -> f64 {
    32.5
}

fn default_bore() -> f64 {
    192.0
}

fn default_hub_diameter() -> f64 {
    270.0
}

fn default_web_hub_y() -> f64 {
    -20.0
}

fn default_web_rim_y() -> f64 {
    10.0
}

fn default_rim_depth() -> f64 {
    65.0
}

/// Unit of a file's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum UnitKey {
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetre,
    /// Metres.
    #[serde(rename = "m")]
    Metre,
    /// Inches.
    #[serde(rename = "in")]
    Inch,
}

impl UnitKey {
    /// Name in the study file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Metre => "m",
            Self::Inch => "in",
        }
    }

    /// Length of the unit, m.
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => MILLIMETRE,
            Self::Metre => 1.0,
            Self::Inch => 25.4 * MILLIMETRE,
        }
    }
}
