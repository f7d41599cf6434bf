//! The text of a study file and the lines on which its keys stand.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use railspring_profiles::error::{InputError, printable};
use toml::de::{DeTable, DeValue};

use super::check::join;
use crate::hash::hash;

/// Shown in a message as the value of a key that has to be given.
pub(super) const MISSING: &str = "(missing)";

/// Where a key was given.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// On a line of the file, counted from one.
    Line(usize),
    /// Beside the file, by an option of the command line.
    Option(String),
}

/// An input error with the place where it stands.
#[derive(Debug, Clone)]
pub struct LocatedError {
    /// The file; empty where there is none.
    pub path: PathBuf,
    /// The line or the option, if the error stands in one.
    pub place: Option<Place>,
    /// What is wrong.
    pub error: InputError,
}

impl fmt::Display for LocatedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = shown_path(&self.path);
        match &self.place {
            None if path.is_empty() => {}
            None => write!(f, "{path}: ")?,
            Some(Place::Line(line)) => write!(f, "{path}:{line}: ")?,
            Some(Place::Option(option)) if path.is_empty() => write!(f, "{option}: ")?,
            Some(Place::Option(option)) => write!(f, "{path} with {option}: ")?,
        }
        write!(f, "{}", self.error)
    }
}

impl std::error::Error for LocatedError {}

/// A path as messages show it.
fn shown_path(path: &Path) -> String {
    /// Longer than most systems allow.
    const LONGEST: usize = 4096;
    printable(path.display().to_string(), LONGEST)
}

/// All mistakes of a study, in the order of the file; at least one.
#[derive(Debug, Clone)]
pub struct Mistakes(Vec<LocatedError>);

impl Mistakes {
    /// Most mistakes that are listed.
    const MOST_LISTED: usize = 50;

    /// A single mistake of the whole file.
    pub(crate) fn of_file(path: &Path, error: InputError) -> Self {
        Self(vec![LocatedError { path: path.to_path_buf(), place: None, error }])
    }

    /// A single mistake of an option.
    pub(super) fn of_option(path: &Path, option: &str, error: InputError) -> Self {
        let place = Some(Place::Option(option.into()));
        Self(vec![LocatedError { path: path.to_path_buf(), place, error }])
    }

    /// Mistakes by line; those of the whole file come first, those of options last, those of one place in the order in which they are given.
    pub(crate) fn sorted(mut mistakes: Vec<LocatedError>) -> Self {
        mistakes.sort_by(|a, b| a.place.cmp(&b.place));
        // Broken syntax can be found again in every character of a line.
        mistakes.dedup_by(|later, first| {
            let same = |mistake: &LocatedError| (mistake.place.clone(), mistake.error.to_string());
            same(later) == same(first)
        });
        Self(mistakes)
    }

    /// The mistakes.
    pub fn all(&self) -> &[LocatedError] {
        &self.0
    }

    /// One message for each mistake, of a long list the first and the number of the others.
    pub fn messages(&self) -> Vec<String> {
        let mut messages: Vec<String> =
            self.0.iter().take(Self::MOST_LISTED).map(ToString::to_string).collect();
        if let (Some(first), more @ 1..) = (self.0.first(), self.0.len().saturating_sub(Self::MOST_LISTED)) {
            messages.push(format!("{}: {more} more mistakes", shown_path(&first.path)));
        }
        messages
    }
}

impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.messages().join("\n"))
    }
}

impl std::error::Error for Mistakes {}

/// Where the lines of a text begin, and the options of which the texts follow it.
pub(super) struct Lines {
    ends: Vec<usize>,
    /// Where the text of each option begins, and the option.
    options: Vec<(usize, String)>,
}

impl Lines {
    /// Looks through the text, once.
    pub(super) fn of(text: &str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect();
        Self { ends, options: Vec::new() }
    }

    /// The same with an option whose text begins at a byte behind all others.
    pub(super) fn with_option(&mut self, begin: usize, option: &str) {
        self.options.push((begin, option.into()));
    }

    /// Line on which a byte stands, or option.
    pub(super) fn place(&self, offset: usize) -> Place {
        match self.options.partition_point(|(begin, _)| *begin <= offset).checked_sub(1) {
            Some(option) => Place::Option(self.options[option].1.clone()),
            None => Place::Line(self.ends.partition_point(|end| *end < offset) + 1),
        }
    }
}

/// Where every key of a study file stands, and what its value was.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    path: Arc<Path>,
    hash: String,
    places: Arc<BTreeMap<String, Place>>,
    /// The files that its texts name, from its folder.
    named: Arc<BTreeSet<PathBuf>>,
}

/// Where keys stand, while they are collected.
struct Noted<'a> {
    lines: &'a Lines,
    places: BTreeMap<String, Place>,
    folder: &'a Path,
    named: BTreeSet<PathBuf>,
}

impl Default for Source {
    fn default() -> Self {
        Self {
            path: Arc::from(Path::new("")),
            hash: String::new(),
            places: Arc::default(),
            named: Arc::default(),
        }
    }
}

impl Noted<'_> {
    fn table(&mut self, table: &DeTable<'_>, path: &str) {
        for (key, value) in table.iter() {
            let full = join(path, key.get_ref());
            self.places.insert(full.clone(), self.lines.place(key.span().start));
            self.value(value.get_ref(), &full);
        }
    }

    fn value(&mut self, value: &DeValue<'_>, full: &str) {
        match value {
            DeValue::Table(inner) => self.table(inner, full),
            DeValue::Array(items) => {
                for (index, item) in items.iter().enumerate() {
                    let full = format!("{full}[{index}]");
                    if item.get_ref().is_table() {
                        self.places.insert(full.clone(), self.lines.place(item.span().start));
                    }
                    self.value(item.get_ref(), &full);
                }
            }
            // whatever its key is: a text that is the path of a file names it
            DeValue::String(text) => {
                let file = self.folder.join(text.as_ref());
                if file.is_file() {
                    self.named.insert(file);
                }
            }
            _ => {}
        }
    }
}

impl Source {
    /// Remembers the places of all keys of a parsed document.
    pub(super) fn new(path: &Path, text: &str, lines: &Lines, document: &DeTable<'_>) -> Self {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut noted = Noted { lines, places: BTreeMap::new(), folder, named: BTreeSet::new() };
        noted.table(document, "");
        let Noted { places, named, .. } = noted;
        let hash = hash(text.as_bytes());
        Self { path: Arc::from(path), hash, places: Arc::new(places), named: Arc::new(named) }
    }

    /// Holds what another source has alike together with it.
    pub(super) fn share(&mut self, other: &Self) {
        if self.path == other.path {
            self.path = Arc::clone(&other.path);
        }
        if self.places == other.places {
            self.places = Arc::clone(&other.places);
        }
    }

    /// BLAKE3 hash of the text, without the options beside it.
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// The file itself and the files that its texts name: all that is read with it.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(self.path()).chain(self.named.iter().map(PathBuf::as_path))
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Line or option of a dotted key, or of the nearest section around it that is given.
    pub fn place(&self, key: &str) -> Option<Place> {
        let mut key = key;
        loop {
            if let Some(place) = self.places.get(key) {
                return Some(place.clone());
            }
            key = key.rsplit_once(['.', '['])?.0;
        }
    }

    /// Whether the file or an option has this key, of an entry of a list that list.
    pub fn gives(&self, key: &str) -> bool {
        self.places.contains_key(key) || self.places.contains_key(key.split('[').next().unwrap_or(key))
    }

    /// Adds file and place to an error of any stage, by its key.
    pub fn locate(&self, mut error: InputError) -> LocatedError {
        if !self.gives(&error.key) && error.value != MISSING {
            error.value = format!("{} (default)", error.value);
        }
        LocatedError { path: self.path.to_path_buf(), place: self.place(&error.key), error }
    }
}
