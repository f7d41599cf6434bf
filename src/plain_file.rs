//! Files of the program's own folders, in which others may have put links, pipes or devices: only regular files are opened, and no link is followed.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{Error, ErrorKind, Read, Result, Write};
use std::path::Path;

/// Replacements of a file that [`open`] sits out, each between its look at the name and its opening of it.
const REPLACEMENTS: usize = 100;

/// Opens a regular file with `options`; no link is followed. A file that another process replaces at the same time is opened as it is afterwards.
///
/// # Errors
/// What the system says; a link, a folder, a device, a pipe or a socket; a file that is replaced at each of 100 tries.
pub(crate) fn open(path: &Path, options: &OpenOptions) -> Result<File> {
    let other = |what: &str| Error::new(ErrorKind::InvalidInput, format!("it is {what}, not a regular file"));
    for _ in 0..REPLACEMENTS {
        let before = path.symlink_metadata()?;
        if before.is_symlink() {
            return Err(other("a link"));
        }
        // before it is opened: opening a pipe waits for somebody at its other end
        if !before.is_file() {
            return Err(other("a folder, a device, a pipe or a socket"));
        }
        let file = options.open(path)?;
        if is_same(&before, &file.metadata()?) {
            return Ok(file);
        }
    }
    Err(Error::new(ErrorKind::ResourceBusy, "others replace it again and again"))
}

/// Content of a regular file.
///
/// # Errors
/// As [`open`].
pub(crate) fn read(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path, OpenOptions::new().read(true))?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A lock that other processes wait for until the value is dropped: an empty regular file, made if there is none. Nothing is cut off that is there.
///
/// # Errors
/// As [`open`]; a file that cannot be made or locked.
pub(crate) fn lock(path: &Path) -> Result<File> {
    let made = OpenOptions::new().write(true).create_new(true).open(path);
    let file = match made {
        Err(cause) if cause.kind() == ErrorKind::AlreadyExists => open(path, OpenOptions::new().write(true)),
        made => made,
    }?;
    file.lock()?;
    Ok(file)
}

/// Writes a file in the place of what is there; a link is replaced, not followed.
///
/// # Errors
/// A folder that cannot be written.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut whole = tempfile::NamedTempFile::new_in(folder)?;
    whole.write_all(content)?;
    whole.persist(path).map(drop).map_err(|cause| cause.error)
}

/// Whether both are the same regular file.
fn is_same(before: &Metadata, opened: &Metadata) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        opened.is_file() && (before.dev(), before.ino()) == (opened.dev(), opened.ino())
    }
    #[cfg(not(unix))]
    {
        let _ = before;
        opened.is_file()
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    /// Goal: links, also to devices that never end, pipes and folders are neither read nor locked, and what a link leads to stays as it is; a regular file is
    /// read, locked without being cut off, and written in the place of a link.
    #[test]
    fn regular_files_alone_are_opened() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        std::fs::write(at("target"), "a user's").unwrap();
        symlink(at("target"), at("link")).unwrap();
        symlink("/dev/zero", at("endless")).unwrap();
        symlink(at("nowhere"), at("dangling")).unwrap();
        std::fs::create_dir(at("folder")).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(at("pipe")).status().unwrap().success());
        for name in ["link", "endless", "dangling", "folder", "pipe"] {
            assert!(read(&at(name)).is_err() && lock(&at(name)).is_err(), "{name}");
        }
        assert!(!at("nowhere").exists());
        assert_eq!(std::fs::read(at("target")).unwrap(), b"a user's");
        drop(lock(&at("target")).unwrap());
        assert_eq!(read(&at("target")).unwrap(), b"a user's");
        drop(lock(&at("new")).unwrap());
        write(&at("link"), b"own").unwrap();
        assert_eq!(std::fs::read(at("target")).unwrap(), b"a user's");
        assert_eq!(read(&at("link")).unwrap(), b"own");
    }

    /// Goal: a file that another thread replaces all the time is read whole, each time.
    #[test]
    fn a_file_that_is_replaced_is_read() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("file");
        write(&path, b"whole").unwrap();
        std::thread::scope(|scope| {
            let writer = scope.spawn(|| (0..3000).for_each(|_| write(&path, b"whole").unwrap()));
            while !writer.is_finished() {
                assert_eq!(read(&path).unwrap(), b"whole");
            }
        });
    }
}
