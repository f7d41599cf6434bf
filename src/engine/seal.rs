//! Records that know whether they are as the program wrote them.

use std::path::Path;

use railspring_profiles::error::{InputError, Result};
use serde::Serialize;

/// A record with the hash of its own content in it. A copy of its file, in any folder, then says whether a number was edited in it; another
/// layout of the same values changes nothing.
pub trait Sealed: Serialize + Clone {
    /// Where the hash stands in it.
    fn seal(&mut self) -> &mut String;

    /// The hash of all else.
    ///
    /// # Errors
    /// Those of parts that are read while it is formed.
    fn try_content_hash(&self) -> serde_json::Result<String> {
        let mut content = self.clone();
        content.seal().clear();
        // as it is formed: the text of a large table would fill the memory
        let mut hasher = blake3::Hasher::new();
        serde_json::to_writer_pretty(&mut hasher, &content)?;
        hasher.update(b"\n");
        Ok(hasher.finalize().to_hex().to_string())
    }

    /// The same of plain data.
    fn content_hash(&self) -> String {
        self.try_content_hash().expect("records are plain data")
    }

    /// The same with its hash, of a record whose parts are read while it is formed.
    ///
    /// # Errors
    /// [`InputError`] with the reason of such a part.
    fn try_sealed(mut self) -> Result<Self> {
        *self.seal() = self.try_content_hash().map_err(|cause| {
            let expected = "results that stay as they are until they are written";
            InputError::new("results", cause, expected, "run the command again")
        })?;
        Ok(self)
    }

    /// The same with its hash.
    #[must_use]
    fn sealed(mut self) -> Self {
        *self.seal() = self.content_hash();
        self
    }

    /// Refuses one that is not as it was written; `file` is where it stands, and `made_by` the command that writes it.
    ///
    /// # Errors
    /// [`InputError`] whose key is the file.
    fn check_as_written(&self, file: &Path, made_by: &str) -> Result<()> {
        match self.is_as_written() {
            true => Ok(()),
            false => Err(InputError::new(
                file.display().to_string(),
                "edited after it was written, or written by another version",
                format!("a file as `railspring {made_by}` wrote it, whose hash is that of its content"),
                format!("make it again with `railspring {made_by}`"),
            )
            .into()),
        }
    }

    /// Whether it is as it was written.
    fn is_as_written(&self) -> bool {
        *self.clone().seal() == self.content_hash()
    }
}
