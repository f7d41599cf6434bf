//! The table as it is in its TOML file.

use std::collections::BTreeMap;

use railspring_calibrate::pair::PressDirection;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::KeyValue;

/// Keys of a section of a study with their values; a list of values stands for as many cases.
pub type Keys = BTreeMap<String, KeyValue>;

/// A table: wheels and rails, what else is varied, and the places at which they are pressed together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableDocument {
    /// Short name of the table; names the output folder. Letters, digits, `-`, `_` and `.`.
    #[schemars(length(min = 1, max = 80))]
    pub name: String,
    /// What the table is about, in a sentence or two; shown on its page.
    #[serde(default)]
    pub description: String,
    /// Study whose keys all cases begin with, relative to the table; its load cases and limits play no part.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub base: Option<String>,
    /// Lateral shifts of the wheelset, mm, ascending; positive towards the right rail.
    #[serde(default = "centred")]
    #[schemars(length(min = 1), inner(range(min = -30.0, max = 30.0)))]
    pub shifts_mm: Vec<f64>,
    /// Sides of the wheelset: the wheel on the left rail is that on the right one under the opposite shift.
    #[serde(default = "right")]
    #[schemars(length(min = 1, max = 2))]
    pub sides: Vec<SideKey>,
    /// Along what the wheel is pressed.
    #[serde(default)]
    pub direction: DirectionKey,
    /// Whose bodies measured profiles are pressed on; left out, `nominal` for a table with a `folder` of rails, `nominal-wheels` for one with a `folder` of
    /// wheels alone, `own` for others.
    #[serde(default)]
    pub bodies: Option<BodiesKey>,
    /// Loads along that direction at which displacement and stiffness have columns, kN, ascending, within the range of the loads of the study.
    #[serde(default = "usual_loads")]
    #[schemars(length(min = 1, max = 20), inner(range(min = 0.1, max = 1000.0)))]
    pub stiffness_at_kn: Vec<f64>,
    /// Sections of a study with keys that all cases have, over those of the base.
    #[serde(default)]
    pub study: BTreeMap<String, Keys>,
    /// The wheels: keys of a study's `[wheel]`, each with a `name`; a list of values stands for as many wheels; `folder` for all the profile files in a folder
    /// and the folders in it. Beside `folder`, `metadata_file` is a CSV file with columns that say more of its files, `name_pattern` what their names say.
    #[schemars(length(min = 1))]
    pub wheel: Vec<Keys>,
    /// The rails: keys of a study's `[rail]`, as those of the wheels.
    #[schemars(length(min = 1))]
    pub rail: Vec<Keys>,
    /// Other keys of a study and the values that they take in turn, for instance `"contact.friction" = [0.2, 0.4]`.
    #[serde(default)]
    pub sweep: BTreeMap<String, Vec<KeyValue>>,
    /// Which wheel stands on which rail; left out, with neither `pairs_file` nor `case`, every wheel on every rail.
    #[serde(default)]
    pub pairs: Option<PairsKey>,
    /// CSV file with the pairs, relative to the table: columns `wheel` and `rail` with their names.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub pairs_file: Option<String>,
    /// The pairs, by the names of wheel and rail.
    #[serde(default)]
    pub case: Vec<CaseKeys>,
}

/// Which wheel stands on which rail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PairsKey {
    /// Every wheel on every rail.
    All,
}

/// One pair of the table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseKeys {
    /// Name of the wheel.
    #[schemars(length(min = 1))]
    pub wheel: String,
    /// Name of the rail.
    #[schemars(length(min = 1))]
    pub rail: String,
}

/// Whose bodies measured profiles are pressed on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BodiesKey {
    /// Those of their standards, whose contact nodes are moved to the measured surface: condensed once, whatever the number of files. A surface that is more than 4 mm
    /// off them has its own.
    Nominal,
    /// Measured wheels on those of their standards, and measured rails on their own: for thousands of wheels on a few rails.
    NominalWheels,
    /// Their own, meshed and condensed for every profile.
    Own,
}

impl TableDocument {
    /// Whose bodies its measured profiles are pressed on.
    pub fn bodies(&self) -> BodiesKey {
        let folder = |list: &[Keys]| list.iter().any(|keys| keys.contains_key("folder"));
        self.bodies.unwrap_or(match (folder(&self.wheel), folder(&self.rail)) {
            (_, true) => BodiesKey::Nominal,
            (true, false) => BodiesKey::NominalWheels,
            (false, false) => BodiesKey::Own,
        })
    }
}

/// Which measured profiles are pressed on bodies of their standards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shared {
    /// Those of rails.
    pub rail: bool,
    /// Those of wheels.
    pub wheel: bool,
}

impl BodiesKey {
    /// Whether a measured rail and a measured wheel are pressed on bodies of their standards.
    pub fn shared(self) -> Shared {
        Shared { rail: self == Self::Nominal, wheel: self != Self::Own }
    }

    /// Its name in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::NominalWheels => "nominal-wheels",
            Self::Own => "own",
        }
    }
}

/// A side of the wheelset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SideKey {
    /// The wheel on the right rail.
    Right,
    /// The wheel on the left rail.
    Left,
}

impl SideKey {
    /// Its name in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }

    /// The shift towards the rail of this side.
    pub fn towards(self, shift: f64) -> f64 {
        match self {
            Self::Right => shift,
            // no negative zero, which would be another place
            Self::Left => 0.0 - shift,
        }
    }
}

/// Along what a wheel is pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DirectionKey {
    /// Vertically down, the hub held laterally: the springs of a study.
    #[default]
    Vertical,
    /// Along the contact normal at the first touch, the hub held across it: the laws by contact angle.
    Normal,
}

impl DirectionKey {
    /// Its name in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vertical => "vertical",
            Self::Normal => "normal",
        }
    }
}

impl From<DirectionKey> for PressDirection {
    fn from(key: DirectionKey) -> Self {
        match key {
            DirectionKey::Vertical => Self::Vertical,
            DirectionKey::Normal => Self::Normal,
        }
    }
}

fn centred() -> Vec<f64> {
    vec![0.0]
}

fn right() -> Vec<SideKey> {
    vec![SideKey::Right]
}

fn usual_loads() -> Vec<f64> {
    vec![10.0, 50.0, 85.0, 120.0]
}
