//! The profile files of a folder and of the folders in it.

use std::collections::BTreeMap;
use std::fs::read_dir;
use std::path::{Path, PathBuf};

use railspring_profiles::error::InputError;
use railspring_profiles::input;
use railspring_profiles::profile_file::{LARGEST_FILE, format_of};

use super::files::beside;

/// Endings under which profiles are kept: such a file counts as one, whatever is in it.
const OF_PROFILES: [&str; 12] =
    ["prr", "prw", "ban", "whl", "mpt", "slcs", "slcw", "dxf", "txt", "dat", "csv", "asc"];

/// A file of a folder.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FolderFile {
    /// Path from the folder on, without ending: `a/b/c`.
    pub stem: String,
    /// The same, with the ending where another file has the same stem.
    pub name: String,
    /// Path from the folder on.
    pub relative: String,
    /// Path as the table would name it.
    pub path: String,
}

/// The files of a folder.
#[derive(Debug, Default)]
pub(super) struct Folder {
    /// Those that are or may be profiles, by their paths.
    pub files: Vec<FolderFile>,
    /// Paths of the others, from the folder on.
    pub others: Vec<String>,
}

impl Folder {
    /// The files in a folder that a table names, and in the folders in it; hidden ones and those of `lists` are left out.
    ///
    /// # Errors
    /// [`InputError`] with key `folder` for a folder that cannot be read, or has no file that may be a profile.
    pub fn read(table: &Path, folder: &str, lists: &[PathBuf]) -> Result<Self, InputError> {
        let root = beside(table, folder);
        let refused = |value: String| {
            let expected = format!("a folder with profile files; {}", root.display());
            InputError::new("folder", value, expected, "give its path relative to the table")
        };
        read_dir(&root).map_err(|cause| refused(format!("{folder:?}: {cause}")))?;
        let mut found = Found {
            lists: lists.iter().filter_map(|list| list.canonicalize().ok()).collect(),
            ..Found::default()
        };
        found.look(&root, "", &mut Vec::new());
        let Found { mut files, mut others, .. } = found;
        files.sort();
        others.sort();
        if files.is_empty() {
            return Err(refused(format!("{folder:?}, which has no profile file")));
        }
        let mut stems: BTreeMap<String, usize> = BTreeMap::new();
        files.iter().for_each(|relative| *stems.entry(stem(relative)).or_default() += 1);
        let file = |relative: String| {
            let stem = stem(&relative);
            let name = if stems[&stem] > 1 { relative.clone() } else { stem.clone() };
            let path = Path::new(folder).join(&relative).to_string_lossy().into_owned();
            FolderFile { stem, name, relative, path }
        };
        Ok(Self { files: files.into_iter().map(file).collect(), others })
    }
}

/// A path without the ending of its file.
fn stem(relative: &str) -> String {
    let from = relative.rfind('/').map_or(0, |at| at + 1);
    match relative[from..].rfind('.').filter(|at| *at > 0) {
        Some(at) => relative[..from + at].to_owned(),
        None => relative.to_owned(),
    }
}

#[derive(Default)]
struct Found {
    /// Files that list others.
    lists: Vec<PathBuf>,
    files: Vec<String>,
    others: Vec<String>,
}

impl Found {
    /// Looks through a folder; `relative` is its path from the first one on, `around` the folders that it lies in.
    fn look(&mut self, folder: &Path, relative: &str, around: &mut Vec<PathBuf>) {
        let here = folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf());
        let entries = match read_dir(folder) {
            // a link to a folder around it leads in a circle
            Ok(_) if around.contains(&here) => return,
            Ok(entries) => entries,
            Err(_) => return self.others.push(format!("{relative} (cannot be read)")),
        };
        around.push(here);
        for entry in entries.flatten() {
            let Ok(name) = entry.file_name().into_string() else {
                self.others.push(format!("{relative}{}", entry.file_name().to_string_lossy()));
                continue;
            };
            if name.starts_with('.') {
                continue;
            }
            let (path, relative) = (entry.path(), format!("{relative}{name}"));
            if path.is_dir() {
                self.look(&path, &format!("{relative}/"), around);
            } else if path.canonicalize().is_ok_and(|path| self.lists.contains(&path)) {
                // it says what the others are
            } else if may_be_a_profile(&path) {
                self.files.push(relative);
            } else {
                self.others.push(relative);
            }
        }
        around.pop();
    }
}

/// Whether a file has an ending of profiles, or the content of one.
fn may_be_a_profile(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if OF_PROFILES.contains(&ending.as_str()) {
        return true;
    }
    let content = input::read(path, LARGEST_FILE);
    content.is_ok_and(|content| format_of(&path.display().to_string(), &content).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: files of all folders in their order, by paths without endings; hidden files, other kinds and lists are no bodies; a link that leads in a circle
    /// ends; files of one stem keep their endings.
    #[test]
    fn a_folder_has_its_profiles() {
        let place = tempfile::tempdir().unwrap();
        let write = |name: &str, content: &[u8]| {
            let path = place.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, content).unwrap();
        };
        let rows = b"0 0\n1 0\n2 0\n3 0\n4 0\n";
        for name in [
            "m/b/late.whl",
            "m/a/x.whl",
            "m/a/x.txt",
            "m/first.ban",
            "m/.hidden.whl",
            "m/b/c/rows.out",
            "m/v1.2.whl",
        ] {
            write(name, rows);
        }
        write("m/a/notes.pdf", b"%PDF-1.4\n\0");
        write("m/fleet.csv", b"file,vehicle\n");
        #[cfg(unix)]
        std::os::unix::fs::symlink(place.path().join("m"), place.path().join("m/b/again")).unwrap();
        let table = place.path().join("table.toml");
        let folder = Folder::read(&table, "m", &[place.path().join("m/fleet.csv")]).unwrap();
        let names: Vec<&str> = folder.files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["a/x.txt", "a/x.whl", "b/c/rows", "b/late", "first", "v1.2"]);
        assert_eq!((folder.files[0].stem.as_str(), folder.files[3].relative.as_str()), ("a/x", "b/late.whl"));
        assert_eq!(Path::new(&folder.files[4].path), Path::new("m").join("first.ban"));
        assert_eq!(folder.others, ["a/notes.pdf"]);
        let none = Folder::read(&table, "m/b/none", &[]).unwrap_err();
        assert_eq!(none.key, "folder");
    }
}
