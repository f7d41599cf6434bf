//! Reading the files that a user names.
//!
//! A device or a pipe never ends or never begins; a file larger than anything that could be meant fills the memory.
//! Both are refused before they are read, and so is what the system makes up under `/proc` and `/sys`: it calls itself a file, and may never end.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Folders of what the system makes up, on Linux.
const OF_THE_SYSTEM: [&str; 2] = ["/proc", "/sys"];

/// Opens a regular file of at most `most` bytes.
///
/// # Errors
/// What the system says; a folder, a device, a pipe or a socket; a file that is larger.
pub fn open(path: &Path, most: u64) -> Result<File> {
    let place = path.canonicalize()?;
    if cfg!(target_os = "linux") && OF_THE_SYSTEM.iter().any(|folder| place.starts_with(folder)) {
        return Err(Error::new(ErrorKind::InvalidInput, "it is made up by the system, not a file of a user"));
    }
    // Before it is opened: opening a pipe waits for somebody who writes.
    check(&std::fs::metadata(path)?, most)?;
    let file = File::open(path)?;
    check(&file.metadata()?, most)?;
    Ok(file)
}

/// Content of a regular file of at most `most` bytes.
///
/// # Errors
/// As [`open`]; a file that grows beyond `most` while it is read.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    let file = open(path, most)?;
    let mut bytes = Vec::new();
    // What a file says of its size need not be so.
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(bytes) }
}

/// As [`read`], for text in UTF-8.
///
/// # Errors
/// As [`read`]; a file that is no text.
pub fn read_text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read(path, most)?)
        .map_err(|_| Error::new(ErrorKind::InvalidData, "the file is not text in UTF-8"))
}

fn check(metadata: &std::fs::Metadata, most: u64) -> Result<()> {
    if metadata.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "it is a folder, not a file"));
    }
    if !metadata.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "it is a device, a pipe or a socket, not a file"));
    }
    if metadata.len() > most { Err(too_large(most)) } else { Ok(()) }
}

fn too_large(most: u64) -> Error {
    Error::new(ErrorKind::FileTooLarge, format!("it is larger than {} MiB", most >> 20))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_of_a_bounded_size_are_read() {
        let folder = std::env::temp_dir().join(format!("railspring-input-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("file");
        std::fs::write(&path, vec![b'x'; 3 << 20]).unwrap();
        assert_eq!(read(&path, 3 << 20).unwrap().len(), 3 << 20);
        let said = |path: &Path, most| read(path, most).unwrap_err().to_string();
        assert_eq!(said(&path, 2 << 20), "it is larger than 2 MiB");
        assert_eq!(said(&folder, 1 << 20), "it is a folder, not a file");
        #[cfg(unix)]
        assert_eq!(said(Path::new("/dev/zero"), 1 << 20), "it is a device, a pipe or a socket, not a file");
        #[cfg(target_os = "linux")]
        for file in ["/proc/kmsg", "/proc/self/status", "/sys/kernel/notes"] {
            let refused = said(Path::new(file), 1 << 20);
            assert!(
                refused.contains("made up by the system") || refused.contains("os error 2"),
                "{file}: {refused}"
            );
        }
        std::fs::write(&path, [0xff, b'a']).unwrap();
        assert_eq!(read_text(&path, 10).unwrap_err().to_string(), "the file is not text in UTF-8");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
