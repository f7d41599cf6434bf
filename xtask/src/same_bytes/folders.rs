//! Two output folders compared file by file.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use railspring_profiles::error::{InputError, Result};

use super::mask::{hashes, masked};
use crate::workspace::files_below;

/// A file that differs by nature: times, memory, date and host.
pub const LEFT_OUT: &str = "measured.json";
/// Most characters of a line that differs.
const SHOWN: usize = 120;
/// Characters before the first one that differs.
const BEFORE: usize = 40;

/// What a file is in both folders.
#[derive(Debug, Clone, PartialEq)]
pub enum Difference {
    /// The same bytes.
    Same,
    /// The same but for what was masked.
    Masked,
    /// Left out: it differs by nature.
    LeftOut,
    /// Another content, or in one folder alone; in words.
    Differs(String),
}

/// One build's results.
#[derive(Debug, Clone, PartialEq)]
pub struct Side {
    /// The output folder.
    pub folder: PathBuf,
    /// The build in words, as it is printed by `--version`.
    pub program: String,
}

/// Compares every file of two output folders, by name.
///
/// # Errors
/// Folders and files that cannot be read.
pub fn compare(old: &Side, new: &Side) -> Result<Vec<(String, Difference)>> {
    let names = [names(&old.folder)?, names(&new.folder)?];
    let masked_values = [values(old, &names[0])?, values(new, &names[1])?];
    let mut found = Vec::new();
    for name in names[0].union(&names[1]) {
        let difference = match names.each_ref().map(|names| names.contains(name)) {
            _ if name == LEFT_OUT => Difference::LeftOut,
            [true, false] => Difference::Differs("only in the old one".into()),
            [false, true] => Difference::Differs("only in the new one".into()),
            _ => {
                let [a, b] = [read(&old.folder.join(name))?, read(&new.folder.join(name))?];
                content(name, [(&a, old, &masked_values[0]), (&b, new, &masked_values[1])])
            }
        };
        found.push((name.clone(), difference));
    }
    Ok(found)
}

/// Compares the content of a file, each with its side and what is masked on it.
fn content(name: &str, sides: [(&[u8], &Side, &BTreeSet<String>); 2]) -> Difference {
    if sides[0].0 == sides[1].0 {
        return Difference::Same;
    }
    let texts = sides.map(|(bytes, side, values)| {
        Some(masked(name, std::str::from_utf8(bytes).ok()?, &side.program, values))
    });
    match texts {
        [Some(a), Some(b)] if a == b => Difference::Masked,
        [Some(a), Some(b)] => Difference::Differs(first_difference(&a, &b)),
        _ => Difference::Differs("other bytes".into()),
    }
}

/// The first line that differs, around the first character that does.
fn first_difference(a: &str, b: &str) -> String {
    let mut lines = a.lines().zip(b.lines()).enumerate();
    let Some((n, (a, b))) = lines.find(|(_, (a, b))| a != b) else {
        return format!("{} and {} lines", a.lines().count(), b.lines().count());
    };
    let same = a.chars().zip(b.chars()).take_while(|(a, b)| a == b).count();
    let part = |line: &str| line.chars().skip(same.saturating_sub(BEFORE)).take(SHOWN).collect::<String>();
    format!("line {}: `{}` and `{}`", n + 1, part(a), part(b))
}

/// The values that are masked in the JSON files of a side.
fn values(side: &Side, names: &BTreeSet<String>) -> Result<BTreeSet<String>> {
    let mut found = BTreeSet::new();
    for name in names.iter().filter(|name| name.ends_with(".json")) {
        found.extend(hashes(name, &String::from_utf8_lossy(&read(&side.folder.join(name))?)));
    }
    Ok(found)
}

/// Names of the files of a folder and of those in it, with `/` between the parts.
fn names(folder: &Path) -> Result<BTreeSet<String>> {
    let files = files_below(folder)?;
    let inside = files.iter().filter_map(|file| file.strip_prefix(folder).ok());
    Ok(inside.map(|name| name.to_string_lossy().replace('\\', "/")).collect())
}

fn read(file: &Path) -> Result<Vec<u8>> {
    std::fs::read(file).map_err(|cause| unreadable(file, &cause).into())
}

fn unreadable(path: &Path, cause: &std::io::Error) -> InputError {
    InputError::new("result", path.display(), "a file that can be read", cause.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: each kind of difference is found, in folders inside too, and the place of the first is shown.
    #[test]
    fn files_are_compared_by_their_content() {
        let place = tempfile::tempdir().unwrap();
        let side = |name: &str, files: &[(&str, &str)]| {
            let folder = place.path().join(name);
            for (file, text) in files {
                let file = folder.join(file);
                std::fs::create_dir_all(file.parent().unwrap()).unwrap();
                std::fs::write(file, text).unwrap();
            }
            Side { folder, program: format!("railspring ({name})") }
        };
        let hash = ["0123456789ab", "ba9876543210"];
        let stiffness = hash.map(|hash| format!("{{\"input_hash\": \"{hash}\"}}"));
        let report = ["old", "new"].map(|name| format!("<p>railspring ({name})</p>"));
        let pages = [0, 1].map(|n| format!("{} {}", report[n], hash[n]));
        let common = [("figures/law.svg", "<svg/>")];
        let old = [
            ("stiffness.json", stiffness[0].as_str()),
            ("report.html", pages[0].as_str()),
            ("measured.json", "1"),
            ("a.csv", "x\n1\n2\n"),
            ("short.csv", "x\n"),
            ("gone.csv", ""),
        ];
        let new = [
            ("stiffness.json", stiffness[1].as_str()),
            ("report.html", pages[1].as_str()),
            ("measured.json", "2"),
            ("a.csv", "x\n1\n3\n"),
            ("short.csv", "x\ny\n"),
        ];
        let [old, new] =
            [side("old", &[&common[..], &old].concat()), side("new", &[&common[..], &new].concat())];
        let found = compare(&old, &new).unwrap();
        let differs = |text: &str| Difference::Differs(text.into());
        let expected = [
            ("a.csv", differs("line 3: `2` and `3`")),
            ("figures/law.svg", Difference::Same),
            ("gone.csv", differs("only in the old one")),
            ("measured.json", Difference::LeftOut),
            ("report.html", Difference::Masked),
            ("short.csv", differs("1 and 2 lines")),
            ("stiffness.json", Difference::Masked),
        ];
        assert_eq!(found, expected.map(|(name, difference)| (name.to_string(), difference)));
    }
}
