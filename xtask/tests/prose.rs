//! `cargo xtask prose`: documents and doc comments keep to its limits.
//!
//! Goal: at most 20 words a sentence on average, of every document and of all together, and none of more than 45; every page of the book begins with
//! its question and the answer. Exactly, no tolerance. `cargo xtask prose` prints the numbers.

use xtask::prose::{Group, Source, faults, lengths, read};

/// Packages whose doc comments have no long sentence.
const HELD: [&str; 4] = ["profiles", "element", "xtask", "testing"];

fn sentences(sources: &[Source]) -> usize {
    lengths(sources.iter().flat_map(|source| &source.sentences)).sentences
}

#[test]
fn documents_can_be_read() {
    let documents = read(Group::Documents).unwrap();
    let number = sentences(&documents);
    assert!(documents.len() > 70 && number > 2000, "{} documents, {number} sentences", documents.len());
    assert_eq!(faults(Group::Documents, &documents), Vec::<String>::new());
}

/// Goal: doc comments keep to the mean in all packages, and to the longest sentence in those of HELD.
#[test]
fn doc_comments_can_be_read() {
    let sources = read(Group::DocComments).unwrap();
    assert!(sentences(&sources) > 10_000);
    let faults = faults(Group::DocComments, &sources);
    let counts = |fault: &&String| {
        let package = fault.split(['/', ':']).next().unwrap_or_default();
        HELD.contains(&package) || package == Group::DocComments.name()
    };
    assert_eq!(faults.iter().filter(counts).collect::<Vec<_>>(), Vec::<&String>::new());
}
