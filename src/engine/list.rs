//! `results.json`: which files of an output folder are results, what they were made from, and their content.
//!
//! Every file is complete or absent, but a folder can hold files of several
//! studies, of a run that was killed half way, or files that were edited. So
//! each result is listed with the key of its address, which the store keeps it
//! under too, and with the hash of its content. A reader takes a file only if
//! both are what it expects.
//!
//! The list is written before the files it lists. Whoever is stopped between
//! the two leaves files whose content is not the listed one; they are refused.
//! So every file of this program is listed, and what is not listed is a
//! user's: it is never removed and never replaced.

use std::collections::BTreeMap;
use std::path::Path;

use railspring_profiles::error::{InputError, Result};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::engine::inputs::names_in;
use crate::engine::output::OutputFolder;
use crate::hash::hash;
use crate::version;

/// Name of the list.
pub const RESULTS: &str = "results.json";

/// What is known about one file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Key of its address ([`crate::engine::store::Address`]): the hash of everything that the file was made from, the program included.
    pub key: String,
    /// BLAKE3 hash of the content; none for a page that shows times of day, which no command reads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<String>,
    /// Version of the program that made it.
    pub version: String,
    /// The commit that this program was built from.
    #[serde(default)]
    pub commit: String,
    /// What its stage notes beside it, by name, for instance the run that a history is of.
    #[serde(flatten)]
    pub notes: Notes,
}

/// What stages note beside files: records by name.
pub type Notes = Map<String, Value>;

impl Entry {
    /// The note of a name; none where there is none, or one of another form.
    pub fn note<T: DeserializeOwned>(&self, name: &str) -> Option<T> {
        serde_json::from_value(self.notes.get(name)?.clone()).ok()
    }

    /// The program that made the file.
    pub fn program(&self) -> String {
        format!("railspring {} ({})", self.version, self.commit)
    }
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    files: BTreeMap<String, Entry>,
}

/// A file to be written and listed.
#[derive(Debug, Clone)]
pub struct NewFile {
    /// Name in the folder.
    pub name: String,
    /// Content.
    pub content: Vec<u8>,
    /// Key of its address.
    pub key: String,
    /// What its stage notes beside it.
    pub notes: Notes,
    /// Whether the content follows from the key alone and is listed with its hash.
    pub reproducible: bool,
}

impl NewFile {
    /// A file whose content follows from its key.
    pub fn new(name: impl Into<String>, content: Vec<u8>, key: &str) -> Self {
        Self { name: name.into(), content, key: key.into(), notes: Notes::new(), reproducible: true }
    }

    /// The same with a note beside it.
    #[must_use]
    pub fn noted(mut self, name: &str, record: &impl Serialize) -> Self {
        let record = serde_json::to_value(record).expect("a record is plain data");
        self.notes.insert(name.into(), record);
        self
    }
}

/// The results of an output folder.
#[derive(Debug)]
pub struct Results<'a> {
    folder: &'a OutputFolder,
}

impl<'a> Results<'a> {
    /// The results of a folder.
    pub fn new(folder: &'a OutputFolder) -> Self {
        Self { folder }
    }

    /// What is listed about a file.
    pub fn entry(&self, name: &str) -> Option<Entry> {
        self.list().files.remove(name)
    }

    /// Whether a result that was made from `key` is listed.
    pub fn has(&self, key: &str) -> bool {
        self.list().files.values().any(|entry| entry.key == key)
    }

    /// Writes the files of one stage and lists them together.
    ///
    /// If one of them changes, the listed files `derived` from it are removed first, so that nothing stands beside results
    /// that it was not made from; a name that ends in `/` means all of that folder. What is not listed is a user's and stays.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path of a file that cannot be written or removed, or of one that is a user's.
    pub fn write(&self, files: Vec<NewFile>, derived: &[&str]) -> Result<()> {
        let entries: Vec<(String, Entry, Vec<u8>)> = files
            .into_iter()
            .map(|file| {
                let entry = Entry {
                    key: file.key,
                    blake3: file.reproducible.then(|| hash(&file.content)),
                    version: env!("CARGO_PKG_VERSION").into(),
                    commit: version::COMMIT.into(),
                    notes: file.notes,
                };
                (file.name, entry, file.content)
            })
            .collect();
        let mut list = self.list();
        let unlisted = |(name, ..): &&(String, Entry, Vec<u8>)| !list.files.contains_key(name);
        entries.iter().filter(unlisted).try_for_each(|(name, ..)| not_a_users(&self.folder.file(name)))?;
        if entries.iter().any(|(name, entry, _)| list.files.get(name) != Some(entry)) {
            self.remove(&mut list, derived)?;
        }
        // an earlier one without a hash would pass for the new one if this is stopped
        for (name, entry, _) in &entries {
            if entry.blake3.is_none() && list.files.contains_key(name) {
                self.folder.remove(name)?;
            }
        }
        list.files.extend(entries.iter().map(|(name, entry, _)| (name.clone(), entry.clone())));
        self.folder.write_json(RESULTS, &list)?;
        entries.iter().try_for_each(|(name, _, content)| self.folder.write(name, content))
    }

    /// Removes results that there are no longer, and before them what was `derived` from one that is listed.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path of a file that cannot be removed.
    pub fn withdraw(&self, names: &[String], derived: &[&str]) -> Result<()> {
        let mut list = self.list();
        let listed: Vec<&str> =
            names.iter().map(String::as_str).filter(|name| list.files.contains_key(*name)).collect();
        if listed.is_empty() {
            return Ok(());
        }
        self.remove(&mut list, derived)?;
        self.remove(&mut list, &listed)
    }

    /// Refuses the folder where a file under the name of an output, or the list itself, is a user's.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path of that file.
    pub fn check_unlisted(&self, is_output: impl Fn(&str) -> bool) -> Result<()> {
        let path = self.folder.file(RESULTS);
        if path.exists() && self.folder.read_json::<List>(RESULTS, "run").is_err() {
            return not_a_users(&path);
        }
        let list = self.list();
        let mut names = names_in(self.folder.path()).into_iter();
        let unlisted =
            names.find(|name| is_output(name) && name != RESULTS && !list.files.contains_key(name));
        unlisted.map_or(Ok(()), |name| not_a_users(&self.folder.file(&name)))
    }

    /// Refuses to write a file of this name where there is one that differs from `content` and is not as a command has listed it: one that a user
    /// has written or edited.
    ///
    /// # Errors
    /// [`InputError`] whose key is its path.
    pub fn check_not_edited(&self, name: &str, content: &[u8]) -> Result<()> {
        let path = self.folder.file(name);
        let Ok(there) = std::fs::read(&path) else { return not_a_users(&path) };
        let listed = self.entry(name).and_then(|entry| entry.blake3);
        match there == content || listed == Some(hash(&there)) {
            true => Ok(()),
            false => not_a_users(&path),
        }
    }

    /// The content of a file that `made_by` writes, not yet checked.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path, if the file cannot be read or is no text.
    pub fn text(&self, name: &str, made_by: &str) -> Result<String> {
        crate::engine::output::read_text(&self.folder.file(name), made_by)
    }

    /// What is listed about a file, if it is the result of `key` with the listed content.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path, if the file is not listed, was made from other input or has another
    /// content.
    pub fn check(&self, name: &str, content: &str, key: &str, made_by: &str) -> Result<Entry> {
        let entry = self.entry(name).ok_or_else(|| {
            self.refused(name, format!("not listed in {RESULTS}"), "a result that is listed there", made_by)
        })?;
        let changed = |found: String, expected: String| {
            let mut error = self.refused(name, found, &expected, made_by);
            error.remedy = format!("the study or the program has changed since; {}", error.remedy);
            Err(error.into())
        };
        let program = format!("railspring {}", version::FULL);
        if entry.program() != program {
            return changed(format!("made by {}", entry.program()), format!("a result of {program}"));
        }
        if entry.key != key {
            let found = format!("made from input {}", short(&entry.key));
            return changed(found, format!("a result of this study ({})", short(key)));
        }
        if entry.blake3.as_deref() != Some(&hash(content.as_bytes())) {
            let found = format!("another content than is listed in {RESULTS}");
            let expected = "a file as it was written, by a command that was not stopped";
            return Err(self.refused(name, found, expected, made_by).into());
        }
        Ok(entry)
    }

    fn refused(&self, name: &str, found: String, expected: &str, made_by: &str) -> InputError {
        InputError::new(
            self.folder.file(name).display().to_string(),
            found,
            expected,
            format!("make it again with `railspring {made_by}`"),
        )
    }

    /// A list that cannot be read lists nothing: its files are made again.
    fn list(&self) -> List {
        self.folder.read_json(RESULTS, "run").unwrap_or_default()
    }

    fn remove(&self, list: &mut List, derived: &[&str]) -> Result<()> {
        let is_derived =
            |name: &str| derived.iter().any(|d| *d == name || (d.ends_with('/') && name.starts_with(d)));
        let names: Vec<String> = list.files.keys().filter(|name| is_derived(name)).cloned().collect();
        // first, so that one that stays because this is stopped is still known
        names.iter().try_for_each(|name| self.folder.remove(name))?;
        if !names.is_empty() {
            list.files.retain(|name, _| !is_derived(name));
            self.folder.write_json(RESULTS, list)?;
        }
        Ok(())
    }
}

/// Refuses to replace what is at a path, if anything is there.
///
/// # Errors
/// [`InputError`] whose key is the path.
pub fn not_a_users(path: &Path) -> Result<()> {
    if std::fs::symlink_metadata(path).is_err() {
        return Ok(());
    }
    Err(InputError::new(
        path.display().to_string(),
        "a file that this program has not written, or that was edited since",
        "no file of this name, or one as the command has written it",
        "move or rename it, or choose another folder with -o; it stays as it is",
    )
    .into())
}

/// The first digits of a hash.
fn short(key: &str) -> &str {
    key.get(..12).unwrap_or(key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::inputs::Inputs;

    fn folder() -> (tempfile::TempDir, OutputFolder) {
        let root = tempfile::tempdir().unwrap();
        let folder = OutputFolder::create(&root.path().join("out"), &Inputs::none()).unwrap();
        (root, folder)
    }

    fn refusal(results: &Results<'_>, key: &str) -> String {
        let text = results.text("a.csv", "simulate").unwrap();
        results.check("a.csv", &text, key, "simulate").unwrap_err().to_string()
    }

    /// Goal: a result is taken with its own key and content, and refused with another key, an edited content, another
    /// version, or where it is not listed; each refusal names the file and the command.
    #[test]
    fn results_are_taken_by_key_and_content() {
        let (_root, folder) = folder();
        let results = Results::new(&folder);
        results.write(vec![NewFile::new("a.csv", b"1,2\n".into(), "k1")], &[]).unwrap();
        assert_eq!(results.check("a.csv", "1,2\n", "k1", "simulate").unwrap().key, "k1");
        for (text, reason) in [
            (refusal(&results, "k2"), "made from input k1: expected a result of this study (k2)"),
            (
                {
                    folder.write("a.csv", b"1,3\n").unwrap();
                    refusal(&results, "k1")
                },
                "another content",
            ),
            (
                {
                    let list = std::fs::read_to_string(folder.file(RESULTS)).unwrap();
                    folder
                        .write(RESULTS, list.replace(env!("CARGO_PKG_VERSION"), "0.0.0").as_bytes())
                        .unwrap();
                    refusal(&results, "k1")
                },
                "made by railspring 0.0.0",
            ),
            (
                {
                    folder.write(RESULTS, b"{\"files\": {").unwrap();
                    refusal(&results, "k1")
                },
                "not listed",
            ),
        ] {
            assert!(text.contains(reason), "{reason:?} in {text}");
            assert!(text.contains("a.csv = ") && text.contains("`railspring simulate`"), "{text}");
        }
    }

    /// Goal: a file that is not listed is a user's and is not replaced, before any work or at the end; nor is a list that is none, or a file that was edited where
    /// that is asked for. The user's one stays. What is listed, was not edited, or has the same content is written again.
    #[test]
    fn a_users_file_is_not_replaced() {
        let (_root, folder) = folder();
        let results = Results::new(&folder);
        let write =
            |name: &str, content: &[u8]| results.write(vec![NewFile::new(name, content.into(), "k")], &[]);
        let is_refused = |done: Result<()>, name: &str| {
            let said = done.unwrap_err().to_string();
            assert!(said.contains(name) && said.contains("has not written"), "{said}");
        };
        folder.write("a.csv", b"a user's").unwrap();
        folder.write("figures/law.svg", b"a user's").unwrap();
        for name in ["a.csv", "figures/law.svg"] {
            is_refused(write(name, b"ours"), name);
            is_refused(results.check_unlisted(|output| output == name), name);
            is_refused(results.check_not_edited(name, b"ours"), name);
            assert_eq!(std::fs::read(folder.file(name)).unwrap(), b"a user's");
            results.check_not_edited(name, b"a user's").unwrap();
        }
        results.check_unlisted(|output| output == "b.csv").unwrap();
        for content in [b"1", b"2"] {
            results.check_not_edited("b.csv", content).unwrap();
            write("b.csv", content).unwrap();
            results.check_unlisted(|output| output == "b.csv").unwrap();
        }
        folder.write("b.csv", b"edited").unwrap();
        is_refused(results.check_not_edited("b.csv", b"3"), "b.csv");
        folder.write(RESULTS, b"a user's").unwrap();
        is_refused(results.check_unlisted(|_| false), RESULTS);
    }

    /// Goal: a result that is withdrawn goes with its entry and what was derived from it; a file that is not listed is a user's and stays, with what was
    /// derived from others.
    #[test]
    fn what_is_withdrawn_goes_with_what_was_derived() {
        let (_root, folder) = folder();
        let results = Results::new(&folder);
        let write = |name: &str| results.write(vec![NewFile::new(name, b"1".into(), "k")], &[]).unwrap();
        ["a.csv", "b.csv", "figures/law.svg"].iter().for_each(|name| write(name));
        folder.write("own.csv", b"a user's").unwrap();
        results.withdraw(&["own.csv".into()], &["figures/"]).unwrap();
        assert!(folder.file("own.csv").exists() && folder.file("figures/law.svg").exists());
        results.withdraw(&["a.csv".into(), "own.csv".into()], &["figures/"]).unwrap();
        assert!(!folder.file("a.csv").exists() && results.entry("a.csv").is_none());
        assert!(!folder.file("figures/law.svg").exists() && results.entry("b.csv").is_some());
    }

    /// Goal: what was derived from a file goes when the file changes, and stays when it is written again as it was; a file of such a name that
    /// is not listed is a user's and stays.
    #[test]
    fn a_change_removes_what_was_derived() {
        let (_root, folder) = folder();
        let results = Results::new(&folder);
        let write = |content: &[u8]| {
            results
                .write(
                    vec![NewFile::new("a.csv", content.into(), "k")],
                    &["report.html", "report.pdf", "figures/"],
                )
                .unwrap();
        };
        write(b"1");
        results.write(vec![NewFile::new("report.html", b"x".into(), "r")], &[]).unwrap();
        folder.write("report.pdf", b"a user's").unwrap();
        folder.write("figures/own.svg", b"a user's").unwrap();
        results.write(vec![NewFile::new("figures/law.svg", b"x".into(), "r")], &[]).unwrap();
        write(b"1");
        assert!(folder.file("report.html").exists() && folder.file("figures/law.svg").exists());
        write(b"2");
        assert!(!folder.file("report.html").exists() && !folder.file("figures/law.svg").exists());
        assert!(folder.file("figures/own.svg").exists() && folder.file("report.pdf").exists());
        assert!(results.entry("figures/law.svg").is_none());
    }
}
