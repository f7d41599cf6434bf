//! The folders of a fleet.

use std::path::{Path, PathBuf};

use railspring_profiles::error::InputError;

use crate::workspace::files_below;

/// Bytes of all files in a folder; none of one that cannot be read.
pub fn size(folder: &Path) -> u64 {
    let of = |path: &PathBuf| path.symlink_metadata().map_or(0, |data| data.len());
    files_below(folder).unwrap_or_default().iter().map(of).sum()
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
