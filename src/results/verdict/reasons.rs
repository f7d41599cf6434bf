//! Why every limit is what it is: the table of `docs/verdict.md`, which is the one place where the reasons stand.

/// The page of the limits.
const PAGE: &str = include_str!("../../../docs/verdict.md");
/// Heading above the table.
const HEADING: &str = "## The limits";

/// Why the limit of a quantity is what it is.
pub(crate) fn reason(quantity: &str) -> &'static str {
    /// Lines that count something have no key.
    const COUNTED: &str = "the event must not occur";
    rows().find(|(keys, _)| keys.split('`').any(|key| key == quantity)).map_or(COUNTED, |(_, why)| why)
}

/// Keys and reason of each row.
fn rows() -> impl Iterator<Item = (&'static str, &'static str)> {
    let table = PAGE.split_once(HEADING).map_or("", |(_, table)| table);
    table.lines().filter_map(|line| {
        let mut cells = line.strip_prefix("| `")?.split(" | ");
        let keys = cells.next()?;
        Some((keys, cells.nth(1)?.trim_end_matches(" |")))
    })
}

#[cfg(test)]
mod tests {
    use super::{reason, rows};
    use crate::verify::Limits;

    /// Goal: every key of the limits has a reason, and each is one of the table.
    #[test]
    fn every_limit_has_a_reason() {
        let limits = serde_json::to_value(Limits::default()).unwrap();
        for key in limits.as_object().unwrap().keys() {
            assert!(rows().any(|(_, why)| why == reason(key)), "{key}");
        }
        assert_eq!(reason("beam_missing"), "twice the 1 % that the mesh of the rail is off in bending");
        assert_eq!(reason("touches"), "the event must not occur");
    }
}
