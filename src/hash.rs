//! Hashes of contents.

/// BLAKE3 hash of a content, as hexadecimal digits.
pub fn hash(content: &[u8]) -> String {
    blake3::hash(content).to_hex().to_string()
}
