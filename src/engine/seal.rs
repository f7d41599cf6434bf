//! Records that know whether they are as the program wrote them.

use serde::Serialize;

use crate::engine::output::to_json;

/// A record with the hash of its own content in it. A copy of its file, in any folder, then says whether a number was edited in it; another
/// layout of the same values changes nothing.
pub trait Sealed: Serialize + Clone {
    /// Where the hash stands in it.
    fn seal(&mut self) -> &mut String;

    /// The hash of all else.
    fn content_hash(&self) -> String {
        let mut content = self.clone();
        content.seal().clear();
        blake3::hash(&to_json(&content)).to_hex().to_string()
    }

    /// The same with its hash.
    #[must_use]
    fn sealed(mut self) -> Self {
        *self.seal() = self.content_hash();
        self
    }

    /// Whether it is as it was written.
    fn is_as_written(&self) -> bool {
        *self.clone().seal() == self.content_hash()
    }
}
