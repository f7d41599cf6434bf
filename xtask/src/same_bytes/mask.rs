//! What differs between two builds by nature, and is masked before their files are compared.

use std::collections::BTreeSet;

/// What stands in the place of a masked value.
const MASK: &str = "MASKED";
/// Keys of all JSON files that say which program made them, or hold a hash that depends on it.
const OF_THE_PROGRAM: [&str; 5] = ["version", "commit", "input_hash", "content_blake3", "element_blake3"];
/// Further keys of single files: addresses in the store, and hashes of files that say their program.
const OF_SINGLE_FILES: [(&str, &[&str]); 3] = [
    ("results.json", &["key", "blake3"]),
    ("inputs.json", &["calibration"]),
    ("verification.json", &["stiffness.json", "stiffness_by_angle.json"]),
];
/// The section of the report that has times and memory.
const MEASURED: [&str; 2] = ["<section id=\"measured\">", "</section>"];
/// Fewer characters of a masked value are not looked for in pages: a version stands in other words as well.
const LEAST: usize = 10;

/// A text without what differs by nature. `program` is the build in words, as it is printed by `--version`; `hashes` are the
/// values that were masked in the JSON files beside a page.
pub fn masked(name: &str, text: &str, program: &str, hashes: &BTreeSet<String>) -> String {
    match name.rsplit_once('.') {
        Some((_, "json")) => json(name, text).0,
        Some((_, "html")) => page(text, program, hashes),
        _ => text.to_string(),
    }
}

/// The values of a JSON file that are masked in it and may stand in pages.
pub fn hashes(name: &str, text: &str) -> BTreeSet<String> {
    json(name, text).1.into_iter().filter(|value| value.len() >= LEAST).collect()
}

/// The text with its masked values replaced, and these values.
fn json(name: &str, text: &str) -> (String, BTreeSet<String>) {
    let of_file = OF_SINGLE_FILES.iter().find(|(file, _)| *file == name).map_or(&[][..], |(_, keys)| keys);
    let (mut text, mut values) = (text.to_string(), BTreeSet::new());
    for key in OF_THE_PROGRAM.iter().chain(of_file) {
        let name = format!("\"{key}\":");
        let mut parts = text.split(&name);
        let mut made = parts.next().unwrap_or_default().to_string();
        for part in parts {
            made += &name;
            let value = part.trim_start();
            let blank = &part[..part.len() - value.len()];
            match value.strip_prefix('"').and_then(|rest| rest.split_once('"')) {
                Some((value, rest)) => {
                    values.insert(value.to_string());
                    made += &format!("{blank}\"{MASK}\"{rest}");
                }
                None => made += part,
            }
        }
        text = made;
    }
    (text, values)
}

/// The page without the times, the program and the hashes.
fn page(text: &str, program: &str, hashes: &BTreeSet<String>) -> String {
    let [begin, end] = MEASURED;
    let mut text = match text.split_once(begin) {
        Some((before, rest)) => {
            let after = rest.split_once(end).map_or("", |(_, after)| after);
            format!("{before}{begin}{MASK}{end}{after}")
        }
        None => text.to_string(),
    };
    for said in std::iter::once(program).chain(hashes.iter().map(String::as_str)) {
        if !said.is_empty() {
            text = text.replace(said, MASK);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: version, commit and hashes are masked whatever the layout, a value that is no text stays, and so does a key of another file.
    #[test]
    fn what_says_the_program_is_masked() {
        let none = BTreeSet::new();
        let text =
            "{\"commit\":\"abc\",\n  \"input_hash\": \"12\", \"version\": 3, \"key\": \"k\", \"x\": 1.5}";
        let expected = "{\"commit\":\"MASKED\",\n  \"input_hash\": \"MASKED\", \"version\": 3, \"key\": \"k\", \"x\": 1.5}";
        assert_eq!(masked("stiffness.json", text, "", &none), expected);
        let listed = masked("results.json", text, "", &none);
        assert!(listed.contains("\"key\": \"MASKED\"") && listed.ends_with("\"x\": 1.5}"), "{listed}");
        let verdict = "{\"stiffness.json\": \"ab\", \"history.csv\": \"cd\"}";
        let expected = "{\"stiffness.json\": \"MASKED\", \"history.csv\": \"cd\"}";
        assert_eq!(masked("verification.json", verdict, "", &none), expected);
        assert_eq!(masked("law.csv", text, "", &none), text);
    }

    /// Goal: of a page the times, the program and the hashes of the files beside it are masked; nothing else.
    #[test]
    fn a_page_is_masked_but_for_its_results() {
        let hashes = hashes("a.json", "{\"input_hash\": \"0123456789abcdef\", \"version\": \"0.1.0\"}");
        assert_eq!(hashes.len(), 1);
        let text = "<p>1.5</p><section id=\"measured\"><p>3 s</p></section><p>by railspring 0.1.0 (commit a) from 0123456789abcdef</p>";
        let found = masked("report.html", text, "railspring 0.1.0 (commit a)", &hashes);
        assert_eq!(found, "<p>1.5</p><section id=\"measured\">MASKED</section><p>by MASKED from MASKED</p>");
    }
}
