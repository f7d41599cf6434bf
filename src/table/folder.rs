//! The profile files of a folder and of the folders in it.

use std::collections::BTreeMap;
use std::fs::read_dir;
use std::path::{Path, PathBuf};

use railspring_profiles::error::InputError;
use railspring_profiles::input;
use railspring_profiles::profile_file::{LARGEST_FILE, ProfileKind, SliceFile, format_of, slice_files};

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
    /// Where it is among the slices of a list, by the name of a column: along a rail, or around a wheel.
    pub slice_position: Option<(&'static str, f64)>,
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
    /// The files in a folder that a table names, and in the folders in it; hidden ones and those of `lists` are left out. A list of slices of a
    /// `kind` stands for its slices.
    ///
    /// # Errors
    /// [`InputError`] with key `folder` for a folder that cannot be read, or has no file that may be a profile.
    pub fn read(
        table: &Path,
        folder: &str,
        kind: ProfileKind,
        lists: &[PathBuf],
    ) -> Result<Self, InputError> {
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
        let (files, slices) = with_slices(&root, files, kind);
        let mut stems: BTreeMap<String, usize> = BTreeMap::new();
        files.keys().for_each(|relative| *stems.entry(stem(relative)).or_default() += 1);
        let file = |(relative, inside): (String, String)| {
            let stem = stem(&relative);
            let name = if stems[&stem] > 1 { relative.clone() } else { stem.clone() };
            let path = Path::new(folder).join(inside).to_string_lossy().into_owned();
            let slice_position = slices.get(&relative).copied();
            FolderFile { stem, name, relative, path, slice_position }
        };
        Ok(Self { files: files.into_iter().map(file).collect(), others })
    }
}

/// Files by what they are called, with their paths from the folder on; and the positions of those that are slices, with the columns that they stand in.
type Called = (BTreeMap<String, String>, BTreeMap<String, (&'static str, f64)>);

/// Files of a folder at `root`, with the slices of a `kind` in the place of their lists: each once, whether it lies in the folder or not.
/// A list that is not understood stays, and so does one of another kind.
fn with_slices(root: &Path, files: Vec<String>, kind: ProfileKind) -> Called {
    let of_list = |relative: &String| -> Vec<SliceFile> {
        slice_files(&root.join(relative)).into_iter().filter(|slice| slice.kind == kind).collect()
    };
    let (mut lists, mut called) = (Vec::new(), BTreeMap::new());
    for relative in files {
        let slices = of_list(&relative);
        if slices.is_empty() {
            called.insert(relative.clone(), relative);
        } else {
            lists.push((relative, slices));
        }
    }
    let real = |path: &Path| path.canonicalize().ok();
    let mut known: BTreeMap<PathBuf, String> = match lists.is_empty() {
        true => BTreeMap::new(),
        false => called.keys().filter_map(|name| Some((real(&root.join(name))?, name.clone()))).collect(),
    };
    let column = if kind == ProfileKind::Rail { "slice_position_mm" } else { "slice_position_rad" };
    let mut positions = BTreeMap::new();
    for (list, slices) in lists {
        for SliceFile { position, path, .. } in slices {
            let real = real(&path).unwrap_or_else(|| path.clone());
            let name = known.entry(real).or_insert_with(|| {
                let file = path.file_name().unwrap_or_default().to_string_lossy();
                let name = format!("{}/{file}", stem(&list));
                let inside = path.strip_prefix(root).unwrap_or(&path);
                called.insert(name.clone(), inside.to_string_lossy().into_owned());
                name
            });
            positions.entry(name.clone()).or_insert((column, position));
        }
    }
    (called, positions)
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
        let folder =
            Folder::read(&table, "m", ProfileKind::Wheel, &[place.path().join("m/fleet.csv")]).unwrap();
        let names: Vec<&str> = folder.files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["a/x.txt", "a/x.whl", "b/c/rows", "b/late", "first", "v1.2"]);
        assert_eq!((folder.files[0].stem.as_str(), folder.files[3].relative.as_str()), ("a/x", "b/late.whl"));
        assert_eq!(Path::new(&folder.files[4].path), Path::new("m").join("first.ban"));
        assert_eq!(folder.others, ["a/notes.pdf"]);
        let none = Folder::read(&table, "m/b/none", ProfileKind::Wheel, &[]).unwrap_err();
        assert_eq!(none.key, "folder");
    }
    /// Source: the lists of slices of CONTACT, which name a file for each position. Goal: the slices of a list are bodies with their positions, each once, whether it lies in the
    /// folder or beside it; a list that is broken, or of another kind, stays a file.
    #[test]
    fn a_list_of_slices_stands_for_them() {
        let place = tempfile::tempdir().unwrap();
        let write = |name: &str, content: &str| {
            let path = place.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, content).unwrap();
        };
        for name in ["m/a/1.whl", "m/2.whl", "beside/3.whl"] {
            write(name, "0 0\n1 0\n2 0\n3 0\n4 0\n");
        }
        write("m/a/round.slcw", "0 1\n3\n0 0 0\n1\n0 '1.whl'\n1.5 '../2.whl'\n3 '../../beside/3.whl'\n");
        write("m/broken.slcw", "0 1\nmany\n");
        write("m/along.slcs", "0 1\n1\n0 0 0\n1\n0 'a/1.whl'\n");
        let folder = Folder::read(&place.path().join("t.toml"), "m", ProfileKind::Wheel, &[]).unwrap();
        let found: Vec<(&str, Option<f64>)> = folder
            .files
            .iter()
            .map(|file| (file.name.as_str(), file.slice_position.map(|(_, position)| position)))
            .collect();
        let slices = [("2", Some(1.5)), ("a/1", Some(0.0)), ("a/round/3", Some(3.0))];
        assert_eq!(found, [slices[0], slices[1], slices[2], ("along", None), ("broken", None)]);
        for file in &folder.files {
            assert!(place.path().join(&file.path).is_file(), "{}", file.path);
        }
    }
}
