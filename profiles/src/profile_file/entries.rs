//! What the header of a profile file says of the measurement: vehicle, axle, mileage and whatever else its program writes.

use std::path::Path;

use super::format::ProfileFormat;
use super::recognition::recognised;
use super::text::{decode, lines};

/// Longest key of an entry, characters.
const LONGEST_KEY: usize = 60;

/// The entries `key=value` of the header of a MiniProf file, as they stand there, without those that are empty; none of files that have no such header
/// or are no text. `name` is that of the file, whose ending tells the format where the content does not.
///
/// ```
/// use railspring_profiles::profile_file::header_entries;
/// let text = "AxleNo=3\nMileage[km]=12.345\nXYPoints=2\nPosition=\nColumnDef=X,Y\n\n0 0\n1 0\n";
/// let entries = header_entries("a.whl", text.as_bytes());
/// assert_eq!(entries[..2], [("AxleNo".into(), "3".into()), ("Mileage[km]".into(), "12.345".into())]);
/// assert_eq!(entries.len(), 4);
/// ```
pub fn header_entries(name: &str, bytes: &[u8]) -> Vec<(String, String)> {
    let Ok(text) = decode(name, bytes) else { return Vec::new() };
    let ending = Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if recognised(&text, &ending) != Some(ProfileFormat::MiniProf) {
        return Vec::new();
    }
    let around = ['"', '\'', ' ', '\t'];
    let entry = |(_, line): (usize, &str)| {
        let (key, value) = line.split_once('=')?;
        let (key, value) = (key.trim_matches(around), value.trim_matches(around));
        let is_key = key.starts_with(char::is_alphabetic) && key.chars().count() <= LONGEST_KEY;
        (is_key && !value.is_empty()).then(|| (key.to_owned(), value.to_owned()))
    };
    lines(&text).filter_map(entry).collect()
}
