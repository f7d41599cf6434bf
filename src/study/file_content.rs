//! The content of a file of a study: held, or read again when it is wanted.

use std::path::Path;
use std::sync::Arc;

use railspring_profiles::error::InputError;
use railspring_profiles::input;
use railspring_profiles::profile_file::LARGEST_FILE;
use serde::{Serialize, Serializer};

use crate::hash::hash;

/// The content of a file. It counts by its hash, and need not be held: thousands of files would fill the memory.
#[derive(Debug, Clone)]
pub struct FileContent {
    hash: String,
    held: Option<Arc<[u8]>>,
}

impl FileContent {
    /// Hash of the content (BLAKE3).
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// The content of the file at `path`.
    ///
    /// # Errors
    /// [`InputError`] with the file for one that is not held and cannot be read any more, or is another one by now.
    pub fn bytes(&self, path: &Path) -> Result<Arc<[u8]>, InputError> {
        if let Some(held) = &self.held {
            return Ok(Arc::clone(held));
        }
        let refused = |value: String| {
            let expected = "the file as it was when the command began";
            InputError::new(path.display().to_string(), value, expected, "run the command again")
        };
        let bytes = input::read(path, LARGEST_FILE).map_err(|cause| refused(cause.to_string()))?;
        match hash(&bytes) == self.hash {
            true => Ok(Arc::from(bytes)),
            false => Err(refused("another content".into())),
        }
    }

    /// Holds the hash alone from now on.
    pub(super) fn let_go(&mut self) {
        self.held = None;
    }
}

impl From<Vec<u8>> for FileContent {
    fn from(bytes: Vec<u8>) -> Self {
        Self { hash: hash(&bytes), held: Some(Arc::from(bytes)) }
    }
}

impl PartialEq for FileContent {
    fn eq(&self, other: &Self) -> bool {
        self.hash == other.hash
    }
}

impl Serialize for FileContent {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.hash)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a content that is let go is read again, and refused once the file is another one or is gone; the hash is the same throughout.
    #[test]
    fn a_content_is_read_again_and_checked() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.whl");
        std::fs::write(&path, "0 0\n").unwrap();
        let held = FileContent::from(b"0 0\n".to_vec());
        let mut content = held.clone();
        content.let_go();
        assert!(content.held.is_none() && content == held);
        assert_eq!(&*content.bytes(&path).unwrap(), b"0 0\n");
        std::fs::write(&path, "0 1\n").unwrap();
        assert!(content.bytes(&path).unwrap_err().to_string().contains("another content"));
        assert_eq!(&*held.bytes(&path).unwrap(), b"0 0\n");
        std::fs::remove_file(&path).unwrap();
        assert!(content.bytes(&path).unwrap_err().key.ends_with("a.whl"));
    }
}
