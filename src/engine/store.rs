//! The store: what stages have made, kept between runs and found again by what it was made from.
//!
//! An entry is one file, so that it is complete or absent: its first line has
//! the hash of all that follows, its second says what it is, and its parts
//! come after. It is written under a temporary name and renamed; of two
//! processes that make the same entry both write the same bytes. Whatever does
//! not have its hash is removed and made again.
//!
//! A key is the hash of an artefact's inputs and of the program itself: a
//! program that was built anew may compute something else under the same
//! version. The output folder lists its files by the same key.

mod artefact;
mod key;
mod entry;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

pub(crate) use artefact::program;
pub use artefact::{Address, Artefact, Kind, unreadable};
use entry::{Refused, decode, encode, read_header};
pub use key::StoreKey;
use railspring_profiles::error::{Error, InputError, Result};

use crate::engine::inputs::Inputs;
use crate::engine::output::{OutputFolder, TEMPORARY};
use crate::plain_file;
use crate::python::cache_folder;

/// A temporary file that has not changed for so long belongs to a process that was killed.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// What the store has at an address.
#[derive(Debug)]
enum Found {
    /// The artefact, complete.
    Whole(Artefact),
    /// An entry that cannot be used, with the reason; it is removed.
    Damaged(String),
    /// An entry without the signature of the key.
    Unsigned,
    /// Nothing.
    Nothing,
}

/// An entry in a list.
#[derive(Debug, Clone, PartialEq)]
pub struct Listed {
    /// What it is.
    pub kind: Kind,
    /// Hash of what it was made from.
    pub key: String,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// When it was last made or taken.
    pub used: SystemTime,
    /// What was made and for which study; `None` if the entry cannot be read.
    pub made: Option<(String, String)>,
    path: PathBuf,
}

/// What is pruned.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Prune {
    /// All entries.
    pub all: bool,
    /// Entries that were not used for so long.
    pub older_than: Option<Duration>,
    /// Entries from the one not used for longest on, until the others have at most so many bytes.
    pub larger_than: Option<u64>,
}

/// A folder of artefacts.
#[derive(Debug)]
pub struct Store {
    folder: OutputFolder,
    program: &'static str,
    /// What entries have to be signed with, and are.
    key: Option<StoreKey>,
}

/// The folder of the store, left to the program: below that of `RAILSPRING_CACHE`, else below the user's cache folder.
///
/// # Errors
/// Those of [`cache_folder`].
pub fn default_folder() -> Result<PathBuf> {
    Ok(cache_folder()?.join("store"))
}

impl Store {
    /// Opens a store, made if need be.
    ///
    /// # Errors
    /// [`InputError`] with key `--cache` if the folder cannot be created or read, or the program's own file, which
    /// is a part of every key, cannot be read. From a folder that cannot be written what is there is taken; that nothing is kept is said
    /// where it would be.
    pub fn open(folder: &Path) -> Result<Self> {
        let refused = |value: String| {
            InputError::new(
                "--cache",
                value,
                "a folder for the store that can be created and written",
                "choose another one, or correct its permissions",
            )
        };
        let program = program().ok_or_else(|| refused("the program's own file cannot be read".into()))?;
        let made = OutputFolder::create(folder, &Inputs::none());
        let made = made.or_else(|error| match std::fs::read_dir(folder) {
            Ok(_) => OutputFolder::to_read(folder),
            Err(_) => Err(error),
        });
        let folder = made.map_err(|error| match error {
            Error::Input(cause) => refused(cause.value).into(),
            other => other,
        })?;
        let store = Self { folder, program, key: None };
        store.remove_abandoned();
        Ok(store)
    }

    /// The same store, of which only entries are taken that were signed with `key`; those that it keeps are.
    #[must_use]
    pub fn signed_with(self, key: Option<StoreKey>) -> Self {
        Self { key, ..self }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Hash of the program, which is a part of every key: what another program makes is never taken.
    pub fn program(&self) -> &'static str {
        self.program
    }

    /// Whether there is an entry, complete or not.
    pub fn has(&self, address: &Address) -> bool {
        self.folder.file(&address.file()).symlink_metadata().is_ok_and(|about| about.is_file())
    }

    /// The artefact at an address; an entry that is not what was written is removed.
    fn take(&self, address: &Address) -> Found {
        let path = self.folder.file(&address.file());
        let bytes = match plain_file::read(&path) {
            Ok(bytes) => bytes,
            Err(cause) if cause.kind() == ErrorKind::NotFound => return Found::Nothing,
            Err(cause) => return self.discard(address, cause.to_string()),
        };
        match decode(&bytes, address, self.key.as_ref()) {
            Ok(artefact) => {
                // What is pruned is what was not used for long; a store that is only read keeps its times.
                let _ = plain_file::open(&path, std::fs::File::options().write(true))
                    .and_then(|file| file.set_modified(SystemTime::now()));
                Found::Whole(artefact)
            }
            // it may be of use to others; what is made here takes its place
            Err(Refused::Unsigned) => Found::Unsigned,
            Err(Refused::Damaged(reason)) => self.discard(address, reason.into()),
        }
    }

    /// What `read` makes of the artefact at an address; `say` hears why an entry cannot be used, which is then removed.
    pub fn take_as<T>(
        &self,
        address: &Address,
        read: impl FnOnce(Artefact) -> Result<T>,
        say: &dyn Fn(String),
    ) -> Option<T> {
        let found = match self.take(address) {
            Found::Whole(artefact) => match read(artefact) {
                Ok(value) => return Some(value),
                Err(cause) => self.discard(address, cause.to_string()),
            },
            found => found,
        };
        match found {
            Found::Damaged(reason) => {
                say(format!("the entry of the store is damaged ({reason}): made again"))
            }
            Found::Unsigned => {
                say("the entry of the store is not signed with the key of --cache-key: made again".into());
            }
            _ => {}
        }
        None
    }

    /// Keeps an artefact, in place of what stands at its address; `name` and `study` are for lists. The result stands without
    /// the store: `say` hears why it is not kept.
    pub fn keep(
        &self,
        address: &Address,
        name: &str,
        study: &str,
        artefact: &Artefact,
        say: &dyn Fn(String),
    ) {
        if let Err(cause) = self.put(address, name, study, artefact) {
            say(format!("not kept in the store: {cause}"));
        }
    }

    /// Removes an entry that cannot be used.
    fn discard(&self, address: &Address, reason: String) -> Found {
        // One that cannot be removed is found damaged again, and is not used then either.
        let _ = self.folder.remove(&address.file());
        Found::Damaged(reason)
    }

    /// Keeps an artefact, in place of what stands at its address; `name` and `study` are for lists.
    ///
    /// # Errors
    /// [`InputError`] if the file cannot be written; the store is then as it was.
    fn put(&self, address: &Address, name: &str, study: &str, artefact: &Artefact) -> Result<()> {
        self.folder.write(&address.file(), &encode(address, name, study, artefact, self.key.as_ref()))
    }

    /// The entries, from the one used last on.
    pub fn list(&self) -> Vec<Listed> {
        let mut listed: Vec<Listed> = std::fs::read_dir(self.path())
            .into_iter()
            .flatten()
            .flatten()
            .filter_map(|entry| {
                let address = Address::of_file(&entry.file_name().to_string_lossy())?;
                let about = entry.path().symlink_metadata().ok().filter(std::fs::Metadata::is_file)?;
                let path = entry.path();
                let made =
                    read_header(&path, &address, about.len()).map(|header| (header.name, header.study));
                let used = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
                let Address { kind, key } = address;
                Some(Listed { kind, key, bytes: about.len(), used, made, path })
            })
            .collect();
        listed.sort_by(|a, b| b.used.cmp(&a.used).then_with(|| a.path.cmp(&b.path)));
        listed
    }

    /// Removes entries, those that cannot be read first; which ones are gone.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path of an entry that cannot be removed.
    pub fn prune(&self, what: Prune) -> Result<Vec<Listed>> {
        self.remove_abandoned();
        let now = SystemTime::now();
        let mut kept = 0;
        let mut gone = Vec::new();
        for entry in self.list() {
            let idle = now.duration_since(entry.used).unwrap_or_default();
            let goes = what.all
                || entry.made.is_none()
                || what.older_than.is_some_and(|age| idle > age)
                || what.larger_than.is_some_and(|most| kept + entry.bytes > most);
            if goes {
                let name = entry.path.file_name().map(|name| name.to_string_lossy().into_owned());
                self.folder.remove(&name.unwrap_or_default())?;
                gone.push(entry);
            } else {
                kept += entry.bytes;
            }
        }
        Ok(gone)
    }

    /// Removes what killed processes have left under temporary names.
    fn remove_abandoned(&self) {
        for entry in std::fs::read_dir(self.path()).into_iter().flatten().flatten() {
            let temporary = entry.file_name().to_string_lossy().starts_with(TEMPORARY);
            let idle =
                entry.metadata().and_then(|about| about.modified()).ok().and_then(|t| t.elapsed().ok());
            if temporary && idle.is_some_and(|idle| idle > ABANDONED) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

#[cfg(test)]
mod tests;
