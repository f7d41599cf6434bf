//! Hashes of contents, and the keys of what is made from inputs.

use serde::Serialize;

/// BLAKE3 hash of a content, as hexadecimal digits.
pub fn hash(content: &[u8]) -> String {
    blake3::hash(content).to_hex().to_string()
}

/// Key of what this version of the program makes from some inputs: the hash of both. The names of a map are sorted, so that their order does not count.
pub fn key(inputs: &impl Serialize) -> String {
    let inputs = serde_json::to_value(inputs).expect("inputs are plain data");
    hash(format!("{}\n{inputs}", env!("CARGO_PKG_VERSION")).as_bytes())
}
