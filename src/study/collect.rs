//! Collects the mistakes of a study, so that all of them are reported together.

use std::collections::BTreeSet;

use railspring_profiles::error::InputError;

use super::check::Finding;
use super::source::{LocatedError, Source};

/// The mistakes found so far.
pub(super) struct Collector<'a> {
    source: &'a Source,
    /// Keys with a finding of the schema.
    wrong: BTreeSet<String>,
    /// The sections around them.
    around: BTreeSet<String>,
    /// Sections with a key that they do not have: it may stand for any other that is missed there.
    unsure: BTreeSet<String>,
    mistakes: Vec<LocatedError>,
}

impl<'a> Collector<'a> {
    /// Begins after the check against the schema with the findings of which `mistakes` come.
    pub(super) fn new(source: &'a Source, findings: &[Finding], mistakes: Vec<LocatedError>) -> Self {
        let (mut wrong, mut around, mut unsure) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
        for finding in findings {
            let key = &finding.error.key;
            around.extend(key.match_indices(['.', '[']).map(|(end, _)| key[..end].to_string()));
            wrong.insert(key.clone());
            if finding.unknown {
                unsure.extend(key.rsplit_once('.').map(|(section, _)| section.to_string()));
            }
        }
        Self { source, wrong, around, unsure, mistakes }
    }

    /// Whether a key or something around it is wrong, with `.*` anything in it: what follows from it is no news.
    fn is_wrong(&self, read: &str) -> bool {
        let key = read.trim_end_matches(".*");
        let inside = key != read && self.around.contains(key);
        let mut sections = key.match_indices('.').map(|(end, _)| &key[..end]);
        let outside = |section: &str| self.wrong.contains(section) || self.unsure.contains(section);
        inside || self.wrong.contains(key) || sections.any(outside)
    }

    /// Adds a mistake, unless one of the keys on which it rests is wrong already: keys, or with `.*` whole sections.
    pub(super) fn add(&mut self, reads: &[&str], mistake: InputError) {
        if !reads.iter().any(|key| self.is_wrong(key)) {
            self.mistakes.push(self.source.locate(mistake));
        }
    }

    /// The value, or its mistake is added as by [`Self::add`].
    pub(super) fn take<T>(&mut self, reads: &[&str], result: Result<T, InputError>) -> Option<T> {
        result.map_err(|mistake| self.add(reads, mistake)).ok()
    }

    /// The mistakes.
    pub(super) fn into_mistakes(self) -> Vec<LocatedError> {
        self.mistakes
    }
}
