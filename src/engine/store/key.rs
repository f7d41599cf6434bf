//! The key of a site, with which the entries of a shared store are signed.

use std::path::Path;

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::input;

/// Context from which the key of entries is derived, so that the file may serve other purposes as well.
const CONTEXT: &str = "railspring 2026 entries of a store";
/// Least content of a key file, bytes.
const LEAST: usize = 32;
/// Largest one.
const LARGEST: u64 = 1 << 20;

/// A secret that those have who may write into a store: a keyed hash (BLAKE3) of an entry shows that one of them made it.
#[derive(Clone)]
pub struct StoreKey([u8; 32]);

impl std::fmt::Debug for StoreKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("StoreKey")
    }
}

impl StoreKey {
    /// The key in a file of at least 32 bytes, for instance `head -c 32 /dev/urandom`.
    ///
    /// # Errors
    /// [`InputError`] with key `--cache-key` for a file that cannot be read or is too short to be a secret.
    pub fn read(path: &Path) -> Result<Self> {
        let refused = |value: String| {
            let expected = format!("a file with at least {LEAST} random bytes");
            InputError::new(
                "--cache-key",
                value,
                expected,
                "make one with `head -c 32 /dev/urandom`, for its owner alone",
            )
        };
        let content =
            input::read(path, LARGEST).map_err(|cause| refused(format!("{} ({cause})", path.display())))?;
        if content.len() < LEAST {
            return Err(refused(format!("{} ({} bytes)", path.display(), content.len())).into());
        }
        Ok(Self(blake3::derive_key(CONTEXT, &content)))
    }

    /// The signature of the body of an entry.
    pub(super) fn signature(&self, body: &[u8]) -> String {
        blake3::keyed_hash(&self.0, body).to_hex().to_string()
    }

    /// Whether a signature is that of the body of an entry; in the same time, whatever differs.
    pub(super) fn has_signed(&self, body: &[u8], signature: &str) -> bool {
        blake3::Hash::from_hex(signature)
            .is_ok_and(|signature| signature == blake3::keyed_hash(&self.0, body))
    }
}
