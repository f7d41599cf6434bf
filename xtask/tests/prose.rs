//! `cargo xtask prose`: documents and doc comments keep to its limits.
//!
//! Goal: at most 20 words a sentence on average, of every document, of all together and of all doc comments. No
//! sentence has more than 45 words. Every page of the book begins with its question and the answer. Exactly, no
//! tolerance. `cargo xtask prose` prints the numbers.

use xtask::prose::{Group, Source, faults, lengths, read};

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

/// Goal: doc comments of all packages keep to the mean of all and to the longest sentence.
#[test]
fn doc_comments_can_be_read() {
    let sources = read(Group::DocComments).unwrap();
    assert!(sentences(&sources) > 10_000);
    assert_eq!(faults(Group::DocComments, &sources), Vec::<String>::new());
}
