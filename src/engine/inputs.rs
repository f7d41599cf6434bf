//! The files that a command reads. None of them is ever written, replaced or removed: the one place that compares outputs with inputs.

use std::collections::BTreeMap;
use std::fs::DirEntry;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::profile_file::slice_files;

/// Files that a command reads, found again under any name that leads to them.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// The names that were given, by the path without links.
    by_path: Arc<BTreeMap<PathBuf, PathBuf>>,
    /// The same by device and number of the file, which names that share a file have alike.
    by_number: Arc<BTreeMap<(u64, u64), PathBuf>>,
}

impl Inputs {
    /// No files: the command reads none that a user has named.
    pub fn none() -> Self {
        Self::default()
    }

    /// Those of these paths that are files, with the slices that a list of slices names.
    pub fn of<P: AsRef<Path>>(paths: impl IntoIterator<Item = P>) -> Self {
        let (mut by_path, mut by_number) = (BTreeMap::new(), BTreeMap::new());
        let mut add = |path: &Path| {
            if !path.is_file() {
                return;
            }
            if let Ok(place) = path.canonicalize() {
                by_path.entry(place).or_insert_with(|| path.to_path_buf());
            }
            if let Some(number) = number(path) {
                by_number.entry(number).or_insert_with(|| path.to_path_buf());
            }
        };
        for path in paths {
            add(path.as_ref());
            slice_files(path.as_ref()).iter().for_each(|slice| add(&slice.path));
        }
        Self { by_path: Arc::new(by_path), by_number: Arc::new(by_number) }
    }

    /// Refuses a file that is to be written or removed and is an input, whatever links lead to it.
    ///
    /// # Errors
    /// [`InputError`] whose key is the output, with the name of the input.
    pub fn check(&self, output: &Path) -> Result<()> {
        match self.input_at(output) {
            Some(input) => Err(refused(output, input).into()),
            None => Ok(()),
        }
    }

    /// Refuses a folder in which an input, or another name of its file, has a name that a command writes.
    ///
    /// # Errors
    /// As [`Inputs::check`].
    pub fn check_folder(&self, folder: &Path, is_output: impl Fn(&str) -> bool) -> Result<()> {
        let names = names_in(folder);
        names.iter().filter(|name| is_output(name)).try_for_each(|name| self.check(&folder.join(name)))
    }

    fn input_at(&self, output: &Path) -> Option<&Path> {
        let by_path = self.by_path.get(&resolved(output));
        let by_number = || self.by_number.get(&number(output)?);
        by_path.or_else(by_number).map(PathBuf::as_path)
    }
}

/// Names of the files of a folder and of the folders in it, in order, with `/` between the two. No command writes deeper.
pub(super) fn names_in(folder: &Path) -> Vec<String> {
    let entries = |folder: &Path| std::fs::read_dir(folder).into_iter().flatten().flatten();
    let name = |entry: &DirEntry| entry.file_name().to_string_lossy().into_owned();
    let mut names = Vec::new();
    for entry in entries(folder) {
        match entry.path().is_dir() {
            true => {
                names.extend(entries(&entry.path()).map(|inner| format!("{}/{}", name(&entry), name(&inner))))
            }
            false => names.push(name(&entry)),
        }
    }
    names.sort();
    names
}

fn refused(output: &Path, input: &Path) -> InputError {
    InputError::new(
        output.display().to_string(),
        format!("the same file as the input {}", input.display()),
        "an output that is none of the files that the command reads",
        "choose another name or folder for the output, or move the input",
    )
}

/// A path without links; of one that does not exist with those of the nearest folder that does.
fn resolved(path: &Path) -> PathBuf {
    if let Ok(place) = path.canonicalize() {
        return place;
    }
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    match (parent, path.file_name()) {
        (Some(parent), Some(name)) => resolved(parent).join(name),
        (None, Some(name)) => {
            Path::new(".").canonicalize().map_or_else(|_| path.to_path_buf(), |here| here.join(name))
        }
        _ => path.to_path_buf(),
    }
}

/// Device and number of a file, where the system has them.
fn number(path: &Path) -> Option<(u64, u64)> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let of = std::fs::metadata(path).ok()?;
        Some((of.dev(), of.ino()))
    }
    #[cfg(not(unix))]
    {
        let _ = path;
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: an input is found under its name, through a link to it, through a link to its folder, through `..` and under a second name of the
    /// same file; another file, new or old, is none. Each refusal names both.
    #[cfg(unix)]
    #[test]
    fn an_input_is_found_under_every_name() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        std::fs::create_dir_all(at("data/inner")).unwrap();
        std::fs::write(at("data/rail.prr"), "x").unwrap();
        std::fs::write(at("data/other.prr"), "x").unwrap();
        symlink(at("data/rail.prr"), at("link.prr")).unwrap();
        symlink(at("data"), at("folder")).unwrap();
        std::fs::hard_link(at("data/rail.prr"), at("twin.prr")).unwrap();
        for input in ["data/rail.prr", "link.prr"] {
            let inputs = Inputs::of([at(input), at("missing.prr")]);
            for output in
                ["data/rail.prr", "link.prr", "folder/rail.prr", "data/inner/../rail.prr", "twin.prr"]
            {
                let said = inputs.check(&at(output)).unwrap_err().to_string();
                assert!(
                    said.contains(output) && said.contains(&format!("input {}", at(input).display())),
                    "{said}"
                );
            }
            for output in ["data/other.prr", "missing.prr", "new/deeper/rail.prr"] {
                inputs.check(&at(output)).unwrap();
            }
            let of_folder = |folder: &str, name: &'static str| {
                inputs.check_folder(&at(folder), move |inside| inside == name)
            };
            assert!(of_folder("folder", "rail.prr").is_err() && of_folder("data", "rail.prr").is_err());
            assert!(of_folder("data", "other.prr").is_ok() && of_folder("new", "rail.prr").is_ok());
            // under other names of the same file, in the folder and one deeper
            assert!(of_folder(".", "twin.prr").is_err() && of_folder(".", "data/rail.prr").is_err());
        }
        assert!(Inputs::none().check(&at("data/rail.prr")).is_ok());
    }

    /// Goal: the slices that a list of slices names are inputs, too.
    #[test]
    fn slices_are_inputs() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        std::fs::write(at("rail.slcs"), "0 1\n2\n0 0 0\n1\n0 'a.prr'\n1000 'b.prr'\n").unwrap();
        std::fs::write(at("b.prr"), "x").unwrap();
        assert!(Inputs::of([at("rail.slcs")]).check(&at("b.prr")).is_err());
    }
}
