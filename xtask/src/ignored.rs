//! The tests that are ignored unless they are asked for, with what their sources say about them.

use std::path::{Path, PathBuf};

use railspring_profiles::error::{InputError, Result};

use crate::workspace::{Workspace, files_below};

/// A test that is ignored, as its source describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct IgnoredTest {
    /// Folder of its package.
    pub package: PathBuf,
    /// Its file.
    pub file: PathBuf,
    /// Name of its function.
    pub function: String,
    /// What it proves: the goal that stands over it or else over its file.
    pub proves: String,
}

/// All ignored tests of the workspace, read from its sources.
///
/// # Errors
/// Sources that cannot be read.
pub fn ignored_tests(workspace: &Workspace) -> Result<Vec<IgnoredTest>> {
    let mut found = Vec::new();
    for package in &workspace.packages {
        for folder in ["src", "tests"].map(|name| package.join(name)).iter().filter(|folder| folder.is_dir())
        {
            let sources = files_below(folder)?;
            for file in sources.into_iter().filter(|file| file.extension().is_some_and(|of| of == "rs")) {
                let text = std::fs::read_to_string(&file).map_err(|cause| unreadable(&file, &cause))?;
                found.extend(marked(&text).into_iter().map(|(function, head)| IgnoredTest {
                    package: package.clone(),
                    file: file.clone(),
                    function,
                    proves: goal(&head),
                }));
            }
        }
    }
    Ok(found)
}

fn unreadable(path: &Path, cause: &std::io::Error) -> InputError {
    InputError::new("source", path.display(), "a file that can be read", cause.to_string())
}

/// Functions of a source that are ignored as tests, with what stands over them, or else over the file.
fn marked(text: &str) -> Vec<(String, String)> {
    let of_file = text.lines().map_while(|line| line.strip_prefix("//!")).map(str::trim);
    let of_file = of_file.collect::<Vec<_>>().join(" ");
    let (mut head, mut ignored, mut found) = (Vec::new(), false, Vec::new());
    for line in text.lines().map(str::trim) {
        if let Some(said) = line.strip_prefix("///") {
            head.push(said.trim());
        } else if line.starts_with("#[") {
            ignored |= line.starts_with("#[ignore");
        } else {
            let function = line.strip_prefix("fn ").and_then(|rest| Some(rest.split_once('(')?.0));
            if let Some(function) = function.filter(|_| ignored) {
                let head = if head.is_empty() { of_file.clone() } else { head.join(" ") };
                found.push((function.to_string(), head));
            }
            head.clear();
            ignored = false;
        }
    }
    found
}

/// The goal in the head of a test, or else the head, as far as its first sentence goes.
fn goal(head: &str) -> String {
    let goal = head.split_once("Goal: ").map_or(head, |(_, goal)| goal);
    let end = goal.match_indices(". ").map(|(at, _)| at).find(|at| {
        // no sentence begins with a small letter
        goal[at + 2..].starts_with(|c: char| !c.is_lowercase())
    });
    goal[..end.unwrap_or(goal.len())].trim_end_matches('.').to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: ignored tests are found with their heads, and neither other tests nor what stands between them.
    #[test]
    fn marked_tests_are_found_with_their_heads() {
        let lines = [
            "//! What a file",
            "//! is about.",
            "/// Of nothing.",
            "const A: f64 = 1.0;",
            "/// Source: a table. Goal: all are",
            "/// read, e.g. twice. Accuracy: exact.",
            "#[test]",
            "#[ignore = \"a minute\"]",
            "fn long() {",
            "    fn inner() {}",
            "}",
            "/// Another.",
            "#[test]",
            "fn short() {}",
            "#[ignore]",
            "fn bare() {}",
        ];
        let found = marked(&lines.join("\n"));
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["long", "bare"]);
        assert_eq!(goal(&found[0].1), "all are read, e.g. twice");
        assert_eq!(
            (found[1].1.as_str(), goal("No goal. More.").as_str()),
            ("What a file is about.", "No goal")
        );
    }
}
