//! What result files say of a study.

use std::collections::HashSet;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One key of a resolved study.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
pub struct ResolvedKey {
    /// Section, for instance `track`; empty for the top level.
    pub section: String,
    /// Key with its unit, for instance `gauge_mm`.
    pub key: String,
    /// The value as text.
    pub value: String,
    /// Whether the file says so itself, or the default applies.
    pub given: bool,
}

/// All keys of a resolved study; many studies hold once what is the same in them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ResolvedKeys(Vec<Arc<ResolvedKey>>);

impl ResolvedKeys {
    /// The keys, in their order.
    pub fn iter(&self) -> impl Iterator<Item = &ResolvedKey> {
        self.0.iter().map(AsRef::as_ref)
    }

    /// The keys by themselves.
    pub fn to_vec(&self) -> Vec<ResolvedKey> {
        self.iter().cloned().collect()
    }

    /// Those that all of some studies have with the same values, in the order of the first one.
    pub fn common<'a>(mut studies: impl Iterator<Item = &'a Self>) -> Vec<&'a ResolvedKey> {
        let mut common: Vec<&ResolvedKey> = studies.next().into_iter().flat_map(Self::iter).collect();
        for study in studies {
            let keys: HashSet<&ResolvedKey> = study.iter().collect();
            common.retain(|key| keys.contains(key));
        }
        common
    }

    /// Holds what another study has at the same place together with it.
    pub(super) fn share(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().zip(&other.0).filter(|(own, other)| own == other) {
            *own = Arc::clone(other);
        }
        self.0.shrink_to_fit();
    }
}

impl From<Vec<ResolvedKey>> for ResolvedKeys {
    fn from(keys: Vec<ResolvedKey>) -> Self {
        Self(keys.into_iter().map(Arc::new).collect())
    }
}

/// The pair that a law was calibrated for. The rail's length is no part of it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PairRecord {
    /// The pair in words.
    pub name: String,
    /// Hash of profiles, bodies, their places in the track and the material.
    pub hash: String,
}
