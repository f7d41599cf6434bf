//! The layout of an entry's file.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::artefact::{Address, Artefact, Kind};
use super::key::StoreKey;
use crate::hash::hash;
use crate::plain_file;

/// First word of an entry; the number changes with the layout.
const MAGIC: &str = "railspring-artefact-1";
/// Largest second line that is read, bytes.
const LARGEST_HEADER: u64 = 1 << 20;

/// The second line of an entry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    kind: Kind,
    key: String,
    /// What was made, as the terminal says it.
    pub(super) name: String,
    /// Name of the study that it was made for first.
    pub(super) study: String,
    version: String,
    /// Names and lengths (bytes) of the parts.
    parts: Vec<(String, usize)>,
}

/// The file of an artefact: its hash with a signature, if there is a key, what it is, and its parts.
pub(super) fn encode(
    address: &Address,
    name: &str,
    study: &str,
    artefact: &Artefact,
    key: Option<&StoreKey>,
) -> Vec<u8> {
    let header = Header {
        kind: address.kind,
        key: address.key.clone(),
        name: name.into(),
        study: study.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        parts: artefact.parts.iter().map(|(name, content)| (name.clone(), content.len())).collect(),
    };
    let mut body = serde_json::to_vec(&header).expect("a header is plain data");
    body.push(b'\n');
    artefact.parts.iter().for_each(|(_, content)| body.extend_from_slice(content));
    let signature = key.map_or_else(String::new, |key| format!(" {}", key.signature(&body)));
    let mut bytes = format!("{MAGIC} {}{signature}\n", hash(&body)).into_bytes();
    bytes.append(&mut body);
    bytes
}

/// Why an entry is not taken.
#[derive(Debug, PartialEq)]
pub(super) enum Refused {
    /// Nobody who has the key made it.
    Unsigned,
    /// It is not what was written.
    Damaged(&'static str),
}

/// The artefact of an entry that is complete, stands where it belongs, and is signed with the key, if there is one.
pub(super) fn decode(
    bytes: &[u8],
    address: &Address,
    key: Option<&StoreKey>,
) -> std::result::Result<Artefact, Refused> {
    const CUT: Refused = Refused::Damaged("it is not complete");
    let end = bytes.iter().position(|byte| *byte == b'\n').ok_or(CUT)?;
    let (first, body) = (&bytes[..end], &bytes[end + 1..]);
    let whole = format!("{MAGIC} {}", hash(body));
    let signature = std::str::from_utf8(first).ok().and_then(|first| first.strip_prefix(&whole));
    let Some(signature) = signature.filter(|rest| rest.is_empty() || rest.starts_with(' ')) else {
        return Err(Refused::Damaged("its content does not have its hash"));
    };
    if key.is_some_and(|key| !key.has_signed(body, signature.trim_start())) {
        return Err(Refused::Unsigned);
    }
    let end = body.iter().position(|byte| *byte == b'\n').ok_or(CUT)?;
    let header: Header =
        serde_json::from_slice(&body[..end]).map_err(|_| Refused::Damaged("it has another layout"))?;
    if (header.kind, &header.key) != (address.kind, &address.key) {
        return Err(Refused::Damaged("it is another artefact"));
    }
    let mut rest = &body[end + 1..];
    let mut artefact = Artefact::default();
    for (name, length) in header.parts {
        let (content, after) = rest.split_at_checked(length).ok_or(CUT)?;
        artefact = artefact.with(name, content);
        rest = after;
    }
    Ok(artefact)
}

/// The second line of an entry that has its length; the content is checked when it is taken.
pub(super) fn read_header(path: &Path, address: &Address, bytes: u64) -> Option<Header> {
    let mut lines = BufReader::new(
        plain_file::open(path, std::fs::File::options().read(true)).ok()?.take(LARGEST_HEADER),
    );
    let (mut first, mut second) = (String::new(), String::new());
    lines.read_line(&mut first).ok()?;
    lines.read_line(&mut second).ok()?;
    let header: Header = serde_json::from_str(&second).ok()?;
    let parts: usize = header.parts.iter().map(|(_, length)| length).sum();
    let whole = first.starts_with(MAGIC)
        && (header.kind, &header.key) == (address.kind, &address.key)
        && (first.len() + second.len() + parts) as u64 == bytes;
    whole.then_some(header)
}
