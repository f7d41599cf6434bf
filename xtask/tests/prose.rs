//! `cargo xtask prose`: the documents keep to its limits.
//!
//! Goal: at most 20 words a sentence on average, of every document and of all together, and none of more than 45; every page of the book begins with
//! its question and the answer. Exactly, no tolerance. `cargo xtask prose` prints the numbers.

use xtask::prose::{Group, faults, lengths, read};

#[test]
fn the_documents_can_be_read() {
    let documents = read(Group::Documents).unwrap();
    let sentences = lengths(documents.iter().flat_map(|document| &document.sentences)).sentences;
    assert!(documents.len() > 70 && sentences > 2000, "{} documents, {sentences} sentences", documents.len());
    assert_eq!(faults(Group::Documents, &documents), Vec::<String>::new());
}
