//! The text of a study file and the lines on which its keys stand.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

use railspring_calibrate::error::InputError;
use toml::de::{DeTable, DeValue};

use super::check::join;

/// What stands in a message for the value of a key that has to be given.
pub(super) const MISSING: &str = "(missing)";

/// An input error with the place where it stands.
#[derive(Debug, Clone)]
pub struct LocatedError {
    /// The file.
    pub path: PathBuf,
    /// The line, counted from one, if the error stands on one.
    pub line: Option<usize>,
    /// What is wrong.
    pub error: InputError,
}

impl fmt::Display for LocatedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}", self.error)
    }
}

impl std::error::Error for LocatedError {}

/// Where every key of a study file stands, and what its value was.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Source {
    path: PathBuf,
    lines: BTreeMap<String, usize>,
}

impl Source {
    /// Remembers the places of all keys of a parsed document.
    pub(super) fn new(path: &Path, text: &str, document: &DeTable<'_>) -> Self {
        let mut source = Self { path: path.to_path_buf(), ..Self::default() };
        source.note(text, document, "");
        source
    }

    fn note(&mut self, text: &str, table: &DeTable<'_>, path: &str) {
        for (key, value) in table.iter() {
            let full = join(path, key.get_ref());
            self.lines.insert(full.clone(), line_of(text, key.span().start));
            if let DeValue::Table(inner) = value.get_ref() {
                self.note(text, inner, &full);
            }
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Line of a dotted key, or of the nearest section around it that is in the file.
    pub fn line(&self, key: &str) -> Option<usize> {
        let mut key = key.split('[').next().unwrap_or(key);
        loop {
            if let Some(line) = self.lines.get(key) {
                return Some(*line);
            }
            key = key.rsplit_once('.')?.0;
        }
    }

    /// Whether the file itself has this key.
    pub fn gives(&self, key: &str) -> bool {
        self.lines.contains_key(key.split('[').next().unwrap_or(key))
    }

    /// Adds file and line to an error of any stage, by its key.
    pub fn locate(&self, mut error: InputError) -> LocatedError {
        if !self.gives(&error.key) && error.value != MISSING {
            error.value = format!("{} (default)", error.value);
        }
        LocatedError { path: self.path.clone(), line: self.line(&error.key), error }
    }
}

/// Line on which a byte stands, counted from one.
pub(super) fn line_of(text: &str, offset: usize) -> usize {
    text.as_bytes().iter().take(offset).filter(|byte| **byte == b'\n').count() + 1
}
