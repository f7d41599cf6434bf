//! The folders of a fleet.

use std::path::Path;

use railspring_profiles::error::InputError;

/// Bytes of all files in a folder.
pub fn size(folder: &Path) -> u64 {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let of = |entry: std::fs::DirEntry| match entry.metadata() {
        Ok(data) if data.is_dir() => size(&entry.path()),
        Ok(data) => data.len(),
        Err(_) => 0,
    };
    entries.map(of).sum()
}

/// The refusal of a path that cannot be written.
pub fn unwritable(path: &Path, cause: &std::io::Error) -> InputError {
    InputError::new(
        "--output",
        path.display(),
        format!("a folder that can be written: {cause}"),
        "name another one",
    )
}
