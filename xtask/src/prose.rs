//! `cargo xtask prose`: how long the sentences of documents and doc comments are, and whether a page begins with its question and the answer.
//!
//! Counted are the sentences of paragraphs and list items. Headings, code blocks, tables, pictures and the targets of links are left out. Code within
//! a sentence is one word.

mod sentences;
mod sources;

use std::path::Path;

use clap::Args;
use railspring::cli::output::say;
use railspring_profiles::error::Result;

pub use sentences::Sentence;

use crate::workspace::workspace;

pub use sources::{Group, Source};

/// Most words of a sentence on average, for a document and for a group of files.
pub const MEAN: f64 = 20.0;
/// Most words of a single sentence.
pub const LONGEST: usize = 45;

/// Which sentences are printed.
#[derive(Debug, Args)]
pub struct ProseArgs {
    /// Print every sentence with more words than this; its mean and longest sentence of every file are printed as well
    #[arg(long, value_name = "WORDS", default_value_t = LONGEST)]
    over: usize,
    /// Print the groups and the faults alone
    #[arg(short, long)]
    quiet: bool,
}

/// The number of sentences, and how long they are.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Lengths {
    /// Number of sentences.
    pub sentences: usize,
    /// Words of all.
    pub words: usize,
    /// Words of the longest one.
    pub longest: usize,
}

impl Lengths {
    /// Words of a sentence on average; 0 without sentences.
    pub fn mean(&self) -> f64 {
        if self.sentences == 0 { 0.0 } else { self.words as f64 / self.sentences as f64 }
    }

    fn add(&mut self, words: usize) {
        self.sentences += 1;
        self.words += words;
        self.longest = self.longest.max(words);
    }
}

/// The lengths of sentences.
pub fn lengths<'a>(sentences: impl IntoIterator<Item = &'a Sentence>) -> Lengths {
    let mut lengths = Lengths::default();
    sentences.into_iter().for_each(|sentence| lengths.add(sentence.words));
    lengths
}

/// What does not hold in some files, a line each: means of a document and of all files, long sentences, pages that do not begin with a question and
/// an answer.
pub fn faults(group: Group, sources: &[Source]) -> Vec<String> {
    let mut faults = Vec::new();
    for source in sources {
        let place = source.path.display();
        let mean = lengths(&source.sentences).mean();
        if group == Group::Documents && mean > MEAN {
            faults.push(format!("{place}: {mean:.1} words a sentence on average, at most {MEAN} wanted"));
        }
        let long = source.sentences.iter().filter(|sentence| sentence.words > LONGEST);
        faults.extend(
            long.map(|s| {
                format!("{place}:{}: {} words, at most {LONGEST} wanted: {}", s.line, s.words, s.text)
            }),
        );
        faults.extend(source.opening.as_ref().map(|fault| format!("{place}: {fault}")));
    }
    let mean = lengths(sources.iter().flat_map(|source| &source.sentences)).mean();
    if mean > MEAN {
        let name = group.name();
        faults.push(format!("{name}: {mean:.1} words a sentence on average, at most {MEAN} wanted"));
    }
    faults
}

/// Prints mean and longest sentence of the files and groups, and what does not hold; whether all holds.
///
/// # Errors
/// Files that cannot be read.
pub fn run(args: &ProseArgs) -> Result<bool> {
    let workspace = workspace()?;
    let mut all_faults = Vec::new();
    for group in Group::ALL {
        let sources = sources::read(&workspace, group)?;
        if !args.quiet {
            for source in &sources {
                say(&row(&lengths(&source.sentences), &source.path))?;
                for s in source.sentences.iter().filter(|s| s.words > args.over) {
                    say(&format!("  line {}, {} words: {}", s.line, s.words, s.text))?;
                }
            }
        }
        let of_all = lengths(sources.iter().flat_map(|source| &source.sentences));
        say(&row(&of_all, Path::new(group.name())))?;
        all_faults.extend(faults(group, &sources));
    }
    for fault in &all_faults {
        say(fault)?;
    }
    Ok(all_faults.is_empty())
}

/// A line of the table: mean, longest sentence, number of sentences, name.
fn row(lengths: &Lengths, name: &Path) -> String {
    let Lengths { sentences, longest, .. } = lengths;
    format!("mean {:5.1}  longest {longest:3}  of {sentences:5}  {}", lengths.mean(), name.display())
}

/// The sentences of a group, for the tests of this package.
///
/// # Errors
/// Files that cannot be read.
pub fn read(group: Group) -> Result<Vec<Source>> {
    sources::read(&workspace()?, group)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(name: &str, words: &[usize]) -> Source {
        let sentence = |&words: &usize| Sentence { line: 1, words, text: "a".into() };
        Source { path: name.into(), sentences: words.iter().map(sentence).collect(), opening: None }
    }

    /// Goal: a long document, a long sentence, a wrong opening and a long group are faults; what is at the limits is none. Exactly.
    #[test]
    fn what_does_not_hold_is_a_fault() {
        let at_the_limits = [source("a.md", &[45, 10, 5]), source("b.md", &[20])];
        assert_eq!(faults(Group::Documents, &at_the_limits), Vec::<String>::new());

        let mut wrong = [source("a.md", &[21]), source("b.md", &[46, 1, 1, 1, 1]), source("c.md", &[])];
        wrong[2].opening = Some("no question".into());
        let found = faults(Group::Documents, &wrong);
        let begins: Vec<&str> = found.iter().map(|fault| fault.split(',').next().unwrap()).collect();
        assert_eq!(
            begins,
            ["a.md: 21.0 words a sentence on average", "b.md:1: 46 words", "c.md: no question"]
        );
        // a file of sources may be above the mean that all files keep
        let sources = [source("a.rs", &[21]), source("b.rs", &[19])];
        assert_eq!(faults(Group::DocComments, &sources), Vec::<String>::new());
        let found = faults(Group::DocComments, &[source("a.rs", &[22]), source("b.rs", &[19])]);
        assert_eq!(found, ["doc comments: 20.5 words a sentence on average, at most 20 wanted"]);
    }
}
