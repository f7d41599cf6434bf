//! The files whose sentences are counted.

use std::path::{Path, PathBuf};

use railspring_profiles::error::{InputError, Result};

use super::sentences::{Sentence, opening, sentences};
use crate::workspace::{Workspace, files_below};

/// Documents in the root of the project.
const IN_ROOT: [&str; 3] = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"];
/// Pages of `docs/` that are lists or are made from the program, whose sentences are doc comments.
const MADE: [&str; 4] = ["SUMMARY.md", "reference-commands.md", "reference-files.md", "reference-keys.md"];
/// Pages of `docs/` that lead to others, and answer no question.
const DOORS: [&str; 2] = ["introduction.md", "README.md"];
/// Folders of a package that have sources.
const SOURCES: [&str; 4] = ["src", "tests", "benches", "examples"];

/// Files that have limits in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// README, ARCHITECTURE, CONTRIBUTING, the pages of `docs/`, and the READMEs of packages and data.
    Documents,
    /// Comments that document items and modules, of all packages.
    DocComments,
}

impl Group {
    /// All groups.
    pub const ALL: [Self; 2] = [Self::Documents, Self::DocComments];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Documents => "documents",
            Self::DocComments => "doc comments",
        }
    }
}

/// A file with its sentences.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Its path below the root of the workspace.
    pub path: PathBuf,
    /// Its sentences.
    pub sentences: Vec<Sentence>,
    /// What is wrong with how a page of the book begins.
    pub opening: Option<String>,
}

/// The files of a group, in their order.
///
/// # Errors
/// Files that cannot be read.
pub(super) fn read(workspace: &Workspace, group: Group) -> Result<Vec<Source>> {
    let files = match group {
        Group::Documents => documents(workspace)?,
        Group::DocComments => rust_files(workspace)?,
    };
    let mut sources = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).map_err(|cause| {
            InputError::new("source", file.display(), "a file that can be read", cause.to_string())
        })?;
        let path = file.strip_prefix(&workspace.root).unwrap_or(&file).to_path_buf();
        sources.push(match group {
            Group::Documents => Source {
                sentences: sentences(&text, 1),
                opening: is_page(&path).then(|| opening(&text)).flatten(),
                path,
            },
            Group::DocComments => {
                let comments = comments(&text);
                let sentences = comments.iter().flat_map(|(line, comment)| sentences(comment, *line));
                Source { sentences: sentences.collect(), opening: None, path }
            }
        });
    }
    Ok(sources)
}

/// Whether a document is a page of the book that answers a question.
fn is_page(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    path.starts_with("docs") && !DOORS.iter().any(|door| name == *door)
}

fn documents(workspace: &Workspace) -> Result<Vec<PathBuf>> {
    let root = &workspace.root;
    let is_markdown = |file: &PathBuf| file.extension().is_some_and(|ending| ending == "md");
    let mut files: Vec<PathBuf> = IN_ROOT.iter().map(|name| root.join(name)).collect();
    for folder in ["docs", "data"] {
        let found = files_below(&root.join(folder))?.into_iter().filter(is_markdown);
        files.extend(found.filter(|file| !MADE.iter().any(|made| file.ends_with(made))));
    }
    let folders = workspace.packages.iter().filter(|folder| *folder != root).cloned();
    let readmes = folders.chain([root.join("python")]).map(|folder| folder.join("README.md"));
    files.extend(readmes.filter(|file| file.is_file()));
    Ok(files)
}

fn rust_files(workspace: &Workspace) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for package in &workspace.packages {
        for folder in SOURCES.map(|name| package.join(name)).iter().filter(|folder| folder.is_dir()) {
            let found = files_below(folder)?;
            files.extend(
                found.into_iter().filter(|file| file.extension().is_some_and(|ending| ending == "rs")),
            );
        }
    }
    Ok(files)
}

/// Doc comments of a source: the line of each, from 1, and its text in Markdown.
fn comments(text: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut last = None;
    for (n, line) in text.lines().enumerate() {
        let line = line.trim_start();
        let of = ["///", "//!"].into_iter().find(|mark| line.starts_with(mark) && !line.starts_with("////"));
        if let Some(mark) = of {
            let said = line[mark.len()..].strip_prefix(' ').unwrap_or(&line[mark.len()..]);
            match found.last_mut().filter(|_| last == of) {
                Some((_, comment)) => *comment = format!("{comment}\n{said}"),
                None => found.push((n + 1, said.to_string())),
            }
        }
        last = of;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: comments of items and modules are taken with their lines, each by itself; other comments and texts of programs are not.
    #[test]
    fn doc_comments_are_found() {
        let lines = [
            "//! Of the file.",
            "//!",
            "//! More.",
            "/// Of an item",
            "///   indented.",
            "struct A; // no comment of it",
            "    ///Close.",
            "    //// no doc comment",
            "    // nor this",
            "    let text = \"/// nor this\";",
        ];
        let expected = [(1, "Of the file.\n\nMore."), (4, "Of an item\n  indented."), (7, "Close.")];
        let found = comments(&lines.join("\n"));
        let found: Vec<(usize, &str)> = found.iter().map(|(line, text)| (*line, text.as_str())).collect();
        assert_eq!(found, expected);
    }

    /// Goal: pages of the book answer questions; doors to them and documents elsewhere need not.
    #[test]
    fn pages_are_told_from_other_documents() {
        assert!(is_page(Path::new("docs/laws.md")) && is_page(Path::new("docs/design/store.md")));
        for other in ["README.md", "docs/introduction.md", "docs/design/README.md", "data/studies/README.md"]
        {
            assert!(!is_page(Path::new(other)), "{other}");
        }
    }
}
