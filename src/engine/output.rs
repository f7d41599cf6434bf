//! The output folder: checked before any work is done, and every file in it
//! either complete or absent.

use std::fs::{File, TryLockError};
use std::io::{BufWriter, ErrorKind, IntoInnerError, Write};
use std::path::{Path, PathBuf};

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::input;
use serde::Serialize;
use serde::de::DeserializeOwned;
use tempfile::TempPath;

use crate::engine::inputs::Inputs;

/// Begin of the temporary names.
pub(crate) const TEMPORARY: &str = ".railspring-";

/// What a file is to have.
pub enum Content<'a> {
    /// These bytes.
    Bytes(Vec<u8>),
    /// What this writes: a text that may be too large to be held.
    Json(Box<Writer<'a>>),
}

/// What writes a file.
type Writer<'a> = dyn Fn(&mut BufWriter<File>) -> std::io::Result<()> + 'a;

impl<'a> Content<'a> {
    /// A value as JSON, indented or in one line.
    pub fn json(value: &'a impl Serialize, indented: bool) -> Self {
        Self::Json(Box::new(move |file| {
            let written = match indented {
                true => serde_json::to_writer_pretty(file, value),
                false => serde_json::to_writer(file, value),
            };
            written.map_err(Into::into)
        }))
    }
}

impl From<Vec<u8>> for Content<'_> {
    fn from(bytes: Vec<u8>) -> Self {
        Self::Bytes(bytes)
    }
}

/// A folder that files are written to, each under a temporary name first.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    /// What the command reads, of which nothing is written here.
    inputs: Inputs,
    /// Folders that did not exist before, outermost first.
    created: Vec<PathBuf>,
}

impl OutputFolder {
    /// Creates the folder if need be and checks that files can be written to it. None of the `inputs` of the command is ever written or
    /// removed in it.
    ///
    /// # Errors
    /// [`InputError`] with key `output folder` if it cannot be created or written.
    pub fn create(path: &Path, inputs: &Inputs) -> Result<Self> {
        let created: Vec<PathBuf> = path
            .ancestors()
            .take_while(|p| !p.as_os_str().is_empty() && !p.exists())
            .map(Path::to_path_buf)
            .collect();
        let created = created.into_iter().rev().collect();
        let folder = Self { path: path.to_path_buf(), inputs: inputs.clone(), created };
        std::fs::create_dir_all(path)
            .and_then(|()| tempfile::NamedTempFile::new_in(path))
            .map_err(|cause| folder.unwritable(&cause))?;
        Ok(folder)
    }

    /// Opens a folder that an earlier stage has written.
    ///
    /// # Errors
    /// As [`OutputFolder::create`]; also if the folder does not exist.
    pub fn open(path: &Path, inputs: &Inputs) -> Result<Self> {
        if !path.is_dir() {
            return Err(InputError::new(
                "output folder",
                path.display(),
                "a folder that `railspring calibrate`, `fit` or `run` has written",
                format!(
                    "run `railspring calibrate` with -o {} first, or name the folder of its results with -o",
                    path.display()
                ),
            )
            .into());
        }
        Self::create(path, inputs)
    }

    /// Opens a folder that is only read.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path if it is no folder.
    pub fn to_read(path: &Path) -> Result<Self> {
        match path.is_dir() {
            true => Ok(Self { path: path.to_path_buf(), inputs: Inputs::none(), created: Vec::new() }),
            false => Err(InputError::new(
                path.display().to_string(),
                if path.exists() { "not a folder" } else { "(does not exist)" },
                "an output folder of `railspring run`, `fit` or `calibrate`",
                "name a folder with results in it",
            )
            .into()),
        }
    }

    /// The folder and the name of a single file to be written, at `path`. The file is refused at once if it is an input.
    ///
    /// # Errors
    /// As [`OutputFolder::create`]; [`InputError`] with key `option` for a path that names no file.
    pub fn of_file(option: &str, path: &Path, inputs: &Inputs) -> Result<(Self, String)> {
        let name = path.file_name().and_then(|name| name.to_str()).filter(|_| !path.is_dir());
        let Some(name) = name else {
            let expected = "the name of a file, not a folder";
            let remedy = "name a file in a folder that can be written";
            return Err(InputError::new(option, path.display(), expected, remedy).into());
        };
        inputs.check(path)?;
        let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Ok((Self::create(folder, inputs)?, name.to_owned()))
    }

    /// What the command reads.
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of a file in the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Keeps other processes from writing results into the folder until the value is dropped; a process that is killed
    /// lets go as well. Where the system cannot lock a folder, nothing is kept away.
    ///
    /// # Errors
    /// [`InputError`] with key `output folder` if another process has it.
    pub fn claim(&self) -> Result<Option<File>> {
        let Ok(folder) = File::open(&self.path) else { return Ok(None) };
        match folder.try_lock() {
            Ok(()) => {
                self.remove_leftovers();
                Ok(Some(folder))
            }
            Err(TryLockError::Error(_)) => Ok(None),
            Err(TryLockError::WouldBlock) => Err(InputError::new(
                "output folder",
                self.path.display(),
                "a folder that no other railspring is writing to",
                "wait for the other one to end, or choose another folder with -o",
            )
            .into()),
        }
    }

    /// Removes what processes that were killed while they wrote have left under temporary names. Another folder in this one may be a store that is in use.
    fn remove_leftovers(&self) {
        for folder in ["", "figures", "fields", "crosscheck"] {
            for entry in std::fs::read_dir(self.path.join(folder)).into_iter().flatten().flatten() {
                if entry.file_name().to_string_lossy().starts_with(TEMPORARY) {
                    let _ = std::fs::remove_file(entry.path());
                }
            }
        }
    }

    /// Removes a file; one that is not there is removed already.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path, if the file cannot be removed or is an input.
    pub fn remove(&self, name: &str) -> Result<()> {
        let path = self.file(name);
        self.inputs.check(&path)?;
        match std::fs::remove_file(&path) {
            Err(cause) if cause.kind() != ErrorKind::NotFound => Err(unwritable_file(&path, &cause).into()),
            _ => Ok(()),
        }
    }

    /// Writes a file at once; a file of that name is replaced only when the new one is complete.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path, if the file cannot be written or is an input.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<()> {
        self.replace(name, |temporary| std::fs::write(temporary, content))
    }

    /// Writes files that belong together: none is replaced before there is room for all of them.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path of the first that cannot be written.
    pub fn write_together(&self, files: &[(&str, Content<'_>)]) -> Result<()> {
        let fill = |(name, content): &(&str, Content<'_>)| {
            self.filled(name, |temporary| match content {
                Content::Bytes(bytes) => std::fs::write(temporary, bytes),
                Content::Json(write) => {
                    let mut file = BufWriter::new(File::create(temporary)?);
                    write(&mut file)?;
                    file.write_all(b"\n")?;
                    file.into_inner().map(drop).map_err(IntoInnerError::into_error)
                }
            })
        };
        let filled = files.iter().map(fill).collect::<Result<Vec<_>>>()?;
        filled.into_iter().try_for_each(Filled::replace)
    }

    /// Lets `fill` write a file under a temporary name in the same folder, then renames it.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path, if `fill` fails or the file cannot be renamed.
    fn replace(&self, name: &str, fill: impl FnOnce(&Path) -> std::io::Result<()>) -> Result<()> {
        self.filled(name, fill)?.replace()
    }

    fn filled(&self, name: &str, fill: impl FnOnce(&Path) -> std::io::Result<()>) -> Result<Filled> {
        let target = self.file(name);
        self.inputs.check(&target)?;
        let parent = target.parent().unwrap_or(&self.path);
        let write = || -> std::io::Result<TempPath> {
            std::fs::create_dir_all(parent)?;
            let temporary = tempfile::Builder::new().prefix(TEMPORARY).tempfile_in(parent)?;
            let temporary = temporary.into_temp_path();
            fill(&temporary)?;
            readable_by_all(&temporary)?;
            Ok(temporary)
        };
        match write() {
            Ok(temporary) => Ok(Filled { temporary, target }),
            Err(cause) => Err(unwritable_file(&target, &cause).into()),
        }
    }

    /// Writes a value as indented JSON.
    ///
    /// # Errors
    /// As [`OutputFolder::write`].
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<()> {
        self.write(name, &to_json(value))
    }

    /// Reads a JSON file of the folder.
    ///
    /// # Errors
    /// As [`read_json`].
    pub fn read_json<T: DeserializeOwned>(&self, name: &str, made_by: &str) -> Result<T> {
        read_json(&self.file(name), made_by)
    }

    fn unwritable(&self, cause: &std::io::Error) -> InputError {
        InputError::new(
            "output folder",
            format!("{} ({cause})", self.path.display()),
            "a folder that can be created and written",
            "choose another one with -o, or correct its permissions",
        )
    }
}

/// A complete file under its temporary name, which is removed unless it becomes the file.
struct Filled {
    temporary: TempPath,
    target: PathBuf,
}

impl Filled {
    fn replace(self) -> Result<()> {
        let Self { temporary, target } = self;
        temporary.persist(&target).map_err(|cause| unwritable_file(&target, &cause.error).into())
    }
}

impl Drop for OutputFolder {
    /// Takes away the folders that were created and stayed empty.
    fn drop(&mut self) {
        for folder in self.created.iter().rev() {
            if std::fs::remove_dir(folder).is_err() {
                break;
            }
        }
    }
}

fn unwritable_file(path: &Path, cause: &std::io::Error) -> InputError {
    InputError::new(
        path.display().to_string(),
        cause,
        "a file that can be written",
        "make room or correct the permissions, or choose another folder with -o",
    )
}

/// A value as indented JSON.
pub fn to_json(value: &impl Serialize) -> Vec<u8> {
    let mut text = serde_json::to_vec_pretty(value).expect("records are plain data");
    text.push(b'\n');
    text
}

/// Largest file of an earlier stage that is read, bytes.
const LARGEST: u64 = 4 << 30;

/// Reads a JSON file.
///
/// # Errors
/// [`InputError`] whose key is the path, if the file is absent or has another content; `made_by`
/// names the command that writes such a file.
pub fn read_json<T: DeserializeOwned>(path: &Path, made_by: &str) -> Result<T> {
    parse_json(path, &read_text(path, made_by)?, made_by)
}

/// Reads the text of a JSON file.
///
/// # Errors
/// As [`read_json`].
pub fn parse_json<T: DeserializeOwned>(path: &Path, text: &str, made_by: &str) -> Result<T> {
    serde_json::from_str(text).map_err(|cause| {
        InputError::new(
            path.display().to_string(),
            cause,
            format!("a file as `railspring {made_by}` writes it"),
            format!("write it again with `railspring {made_by}`"),
        )
        .into()
    })
}

/// Reads a text file that an earlier stage has written.
///
/// # Errors
/// [`InputError`] whose key is the path, if the file cannot be read.
pub fn read_text(path: &Path, made_by: &str) -> Result<String> {
    input::read_text(path, LARGEST).map_err(|cause| {
        InputError::new(
            path.display().to_string(),
            cause,
            format!("a file as `railspring {made_by}` writes it"),
            format!("run `railspring {made_by}` first, or name the right folder with -o"),
        )
        .into()
    })
}

/// A temporary file is private to its owner; a result should have the permissions of any other new file.
pub(crate) fn readable_by_all(path: &Path) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o644))?;
    }
    #[cfg(not(unix))]
    let _ = path;
    Ok(())
}

/// Writes rows as CSV with a heading.
pub fn to_csv<T: Serialize>(rows: &[T]) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).expect("records are plain data");
    }
    writer.into_inner().expect("a vector grows")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let root = tempfile::tempdir().unwrap();
        let folder = OutputFolder::create(&root.path().join("a/b"), &Inputs::none()).unwrap();
        folder.write("x.txt", b"old").unwrap();
        let failed = folder.replace("x.txt", |temporary| {
            std::fs::write(temporary, b"half of the new")?;
            Err(std::io::Error::other("disk full"))
        });
        assert!(failed.is_err());
        assert_eq!(std::fs::read(folder.file("x.txt")).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// Goal: of files that belong together none is replaced where one of them cannot be written, and nothing else is left.
    #[test]
    fn files_that_belong_together_are_replaced_together() {
        let root = tempfile::tempdir().unwrap();
        let folder = OutputFolder::create(root.path(), &Inputs::none()).unwrap();
        let files = |text: &str| ["x.txt", "y/z.txt"].map(|name| (name, text.as_bytes().to_vec().into()));
        folder.write("x.txt", b"old").unwrap();
        std::fs::write(root.path().join("y"), "no folder").unwrap();
        assert!(folder.write_together(&files("new")).is_err());
        assert_eq!(std::fs::read(folder.file("x.txt")).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 2);
        std::fs::remove_file(root.path().join("y")).unwrap();
        folder.write_together(&files("new")).unwrap();
        assert!(["x.txt", "y/z.txt"].iter().all(|name| std::fs::read(folder.file(name)).unwrap() == b"new"));
    }

    #[test]
    fn empty_folders_are_taken_away_and_used_ones_stay() {
        let root = tempfile::tempdir().unwrap();
        drop(OutputFolder::create(&root.path().join("a/b"), &Inputs::none()).unwrap());
        assert!(!root.path().join("a").exists());
        let folder = OutputFolder::create(&root.path().join("a/b"), &Inputs::none()).unwrap();
        folder.write("x.txt", b"x").unwrap();
        drop(folder);
        assert!(root.path().join("a/b/x.txt").exists());
    }

    /// Goal: one process writes into a folder at a time, and what killed ones have left is removed.
    #[test]
    fn a_folder_is_claimed_once() {
        let root = tempfile::tempdir().unwrap();
        let folder = OutputFolder::create(&root.path().join("out"), &Inputs::none()).unwrap();
        let left = [
            ".railspring-x1",
            "figures/.railspring-x2",
            "crosscheck/.railspring-x3",
            "fields/.railspring-x4",
        ];
        let others = ["kept.txt", "store/.railspring-x5"];
        left.iter().chain(&others).for_each(|name| folder.write(name, b"half").unwrap());
        let claim = folder.claim().unwrap();
        assert!(claim.is_some() && !left.iter().any(|name| folder.file(name).exists()));
        assert!(others.iter().all(|name| folder.file(name).exists()));
        let error =
            OutputFolder::open(folder.path(), &Inputs::none()).unwrap().claim().unwrap_err().to_string();
        assert!(error.contains("no other railspring is writing to"), "{error}");
        drop(claim);
        assert!(folder.claim().unwrap().is_some());
    }

    #[test]
    fn a_folder_below_a_file_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("file");
        std::fs::write(&file, b"").unwrap();
        let error = OutputFolder::create(&file.join("out"), &Inputs::none()).unwrap_err();
        assert!(error.to_string().starts_with("output folder = "), "{error}");
    }
}
