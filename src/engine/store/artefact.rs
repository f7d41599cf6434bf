//! What the store keeps: artefacts, and the addresses at which they are found again.

use std::sync::OnceLock;

use railspring_profiles::error::{Error, InputError, Result};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::hash::hash;

/// Ending of an entry's name.
const ENDING: &str = ".artefact";

/// What an artefact is; the first part of its entry's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A body condensed to its contact nodes.
    Body,
    /// Springs, load curve and fields of a pair.
    Calibration,
    /// Laws of a pair by contact angle.
    ByAngle,
    /// A run of the simple model.
    SimpleRun,
    /// What uncertain inputs make of one.
    UncertainRun,
    /// A run of the solid model.
    SolidRun,
    /// What reference solvers say of a study.
    Crosscheck,
    /// A place of a table: a pair at one shift.
    Place,
    /// Meshes alone; made sooner than read, so that no store has them, as what follows.
    Meshes,
    /// A verdict.
    Verdict,
    /// A report.
    Report,
    /// Which bodies a pair of a table has.
    Prepared,
    /// The program's own test.
    SelfTest,
}

impl Kind {
    pub(super) const ALL: [Self; 13] = [
        Self::Body,
        Self::Calibration,
        Self::ByAngle,
        Self::SimpleRun,
        Self::UncertainRun,
        Self::SolidRun,
        Self::Crosscheck,
        Self::Place,
        Self::Meshes,
        Self::Verdict,
        Self::Report,
        Self::Prepared,
        Self::SelfTest,
    ];

    /// The name in file names and lists.
    pub fn name(self) -> &'static str {
        match self {
            Self::Body => "body",
            Self::Calibration => "calibration",
            Self::ByAngle => "stiffness-by-angle",
            Self::SimpleRun => "simple-run",
            Self::UncertainRun => "uncertain-run",
            Self::SolidRun => "solid-run",
            Self::Crosscheck => "crosscheck",
            Self::Place => "place",
            Self::Meshes => "meshes",
            Self::Verdict => "verdict",
            Self::Report => "report",
            Self::Prepared => "prepared",
            Self::SelfTest => "self-test",
        }
    }
}

/// Address of an artefact: its kind, and the hash of all that it is made from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Address {
    pub(super) kind: Kind,
    pub(super) key: String,
}

impl Address {
    /// The address of what this program makes from `inputs`, which is all that it depends on.
    pub fn of(kind: Kind, inputs: &impl Serialize) -> Self {
        // a program whose own file cannot be read is told from others by its commit
        Self::by(kind, inputs, program().unwrap_or(crate::version::FULL))
    }

    pub(super) fn by(kind: Kind, inputs: &impl Serialize, program: &str) -> Self {
        let inputs = serde_json::to_value((kind.name(), inputs, program)).expect("inputs are plain data");
        Self { kind, key: hash(inputs.to_string().as_bytes()) }
    }

    /// The hash: of what the artefact is made from, its kind and the program.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Name of the entry's file in a store's folder; whoever copies the file takes the artefact to another store.
    pub fn file(&self) -> String {
        format!("{}-{}{ENDING}", self.kind.name(), self.key)
    }

    /// The address that a file name says; `None` for a file that is no entry.
    pub(super) fn of_file(name: &str) -> Option<Self> {
        let stem = name.strip_suffix(ENDING)?;
        Kind::ALL.into_iter().find_map(|kind| {
            let key = stem.strip_prefix(kind.name())?.strip_prefix('-')?;
            let is_hash = key.len() == 64 && key.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
            is_hash.then(|| Self { kind, key: key.into() })
        })
    }
}

/// What a stage has made: named parts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Artefact {
    pub(super) parts: Vec<(String, Vec<u8>)>,
}

impl Artefact {
    /// Adds a part.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, content: impl Into<Vec<u8>>) -> Self {
        self.parts.push((name.into(), content.into()));
        self
    }

    /// All parts, in the order in which they were added.
    pub fn parts(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.parts.iter().map(|(name, content)| (name.as_str(), content.as_slice()))
    }

    /// The content of a part.
    pub fn part(&self, name: &str) -> Option<&[u8]> {
        self.parts.iter().find(|(found, _)| found == name).map(|(_, content)| content.as_slice())
    }

    /// The text of a part.
    ///
    /// # Errors
    /// A part that is missing or no text.
    pub fn text(&self, name: &str) -> Result<&str> {
        let content = self.part(name).ok_or_else(|| unreadable(name, "it is missing"))?;
        std::str::from_utf8(content).map_err(|cause| unreadable(name, &cause.to_string()))
    }

    /// The record in a part.
    ///
    /// # Errors
    /// A part that is missing or of another form.
    pub fn json<T: DeserializeOwned>(&self, name: &str) -> Result<T> {
        serde_json::from_str(self.text(name)?).map_err(|cause| unreadable(name, &cause.to_string()))
    }
}

/// The error of a part of an artefact that cannot be read.
pub fn unreadable(part: &str, reason: &str) -> Error {
    InputError::new(part, reason, "a part as this program writes it", "make the result again with --fresh")
        .into()
}

/// Hash of the program's own file.
pub(crate) fn program() -> Option<&'static str> {
    static HASH: OnceLock<Option<String>> = OnceLock::new();
    HASH.get_or_init(|| {
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(std::fs::File::open(crate::program::file()?).ok()?).ok()?;
        Some(hasher.finalize().to_hex().to_string())
    })
    .as_deref()
}
